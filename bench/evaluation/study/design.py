"""Who sees what in which order (R153): tasks, methods and pairs are drawn independently of each other, and balanced over all raters.

Methods follow a Williams design (Aust. J. Sci. Res. A 2 (1949) 149): in every block each method stands at each place equally often and
comes after each other one equally often, so that neither place nor neighbour favours one. Blocks are relabelled and shuffled by seed, and go on from
one rater to the next: whoever stops early unbalances one block at most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

__all__ = ["Step", "Study", "williams"]


@dataclass(frozen=True)
class Step:
    """One page of a rater: the films of a task to be rated, or two of them to be compared."""

    kind: str
    """`rate` or `pair`."""
    task: str
    methods: tuple[str, ...]
    """In the order in which their films are shown."""


@dataclass(frozen=True)
class Study:
    """The plan of a study; everything follows from it and the number of a rater."""

    methods: tuple[str, ...]
    tasks: tuple[str, ...]
    tasks_each: int = 8
    pairs_each: int = 8
    seed: int = 1

    def steps(self, rater: int) -> tuple[Step, ...]:
        """Pages of a rater.

        Args:
            rater: number, from 0.
        """
        each = min(self.tasks_each, len(self.tasks))
        tasks = self._tasks(rater, each)
        rows = [self._order(rater * each + k) for k in range(each)]
        rated = [Step("rate", task, tuple(self.methods[m] for m in row)) for task, row in zip(tasks, rows, strict=True)]
        pairs = [self._pair(rater * self.pairs_each + k) for k in range(self.pairs_each)]
        told = [Step("pair", tasks[k % each], tuple(self.methods[m] for m in pair)) for k, pair in enumerate(pairs)]
        return (*rated, *told)

    def _random(self, what: str, number: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, number, *what.encode()])

    def _tasks(self, rater: int, each: int) -> list[str]:
        """So many tasks, without one twice: of as many raters as there are tasks, each task has equally many."""
        block, place = divmod(rater, len(self.tasks))
        drawn = self._random("tasks", block)
        names, steps = drawn.permutation(len(self.tasks)), drawn.permutation(len(self.tasks))[:each]
        found = [self.tasks[names[(place + step) % len(self.tasks)]] for step in steps]
        return [found[k] for k in self._random("order", rater).permutation(each)]

    def _order(self, number: int) -> tuple[int, ...]:
        """Methods of the page of this number, over all raters."""
        square = williams(len(self.methods))
        block, row = divmod(number, len(square))
        drawn = self._random("methods", block)
        names, rows = drawn.permutation(len(self.methods)), drawn.permutation(len(square))
        return tuple(int(names[m]) for m in square[rows[row]])

    def _pair(self, number: int) -> tuple[int, int]:
        """Methods of the pair of this number: all pairs before any comes again, then again with sides exchanged."""
        pairs = list(combinations(range(len(self.methods)), 2))
        block, place = divmod(number, len(pairs))
        drawn = self._random("sides", block // 2)
        swapped = drawn.integers(2, size=len(pairs)).astype(bool) ^ bool(block % 2)
        chosen = int(self._random("pairs", block).permutation(len(pairs))[place])
        first, second = pairs[chosen]
        return (second, first) if swapped[chosen] else (first, second)

    def told(self) -> dict[str, Any]:
        """The plan as plain data."""
        return {
            "methods": list(self.methods),
            "tasks": list(self.tasks),
            "tasks_each": self.tasks_each,
            "pairs_each": self.pairs_each,
            "seed": self.seed,
        }


def williams(count: int) -> Sequence[tuple[int, ...]]:
    """Orders of so many things in which each stands at each place, and after each other one, equally often: `count` rows, twice as many where it is odd."""
    first = [0]
    for k in range(1, count):
        first.append((count - (k // 2)) % count if k % 2 == 0 else (k + 1) // 2)
    rows = [tuple((v + shift) % count for v in first) for shift in range(count)]
    return rows if count % 2 == 0 else [*rows, *(tuple(reversed(row)) for row in rows)]

"""Kernels prepared once and launched often: slices over threads on a CPU, plain launches or one graph on a GPU.

`geometry/launch.py` launches single kernels; a step of a liquid launches a hundred small ones over the same arrays, so their
arguments are packed once here and only replayed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from operator import is_
from typing import Any

from ....geometry.launch import cores, load, warp

__all__ = ["Chain", "Pass", "Passes"]

SMALLEST = 256
"""Elements below which a slice is not worth a thread."""
SLICES = 2
"""Slices of one thread: another one takes the second where the first is held up."""


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max(1, cores() - 1))


class Pass:
    """One kernel with its arguments over `count` elements; call it to run it."""

    def __init__(self, kernel: Any, count: int, inputs: Sequence[Any], device: str) -> None:
        load(kernel, device)
        wp = warp()
        self.name = str(kernel.key)
        self.inputs = tuple(inputs)
        self.count = count
        parts = max(1, min(SLICES * cores(), count // SMALLEST)) if device == "cpu" and cores() > 1 else 1
        cuts = [count * k // parts for k in range(parts + 1)]
        self.launches = [
            wp.launch(kernel, dim=end - first, inputs=[first, *inputs], device=device, record_cmd=True)
            for first, end in pairwise(cuts)
            if end > first
        ]

    def __call__(self) -> None:
        """Run over all elements; on a CPU it has ended when this returns, on a GPU it is queued."""
        if len(self.launches) <= 1:
            for one in self.launches:
                one.launch()
            return
        waiting = deque(self.launches)

        def work() -> None:
            while True:
                try:
                    one = waiting.popleft()
                except IndexError:
                    return
                one.launch()

        others = [_pool().submit(work) for _ in range(min(cores(), len(self.launches)) - 1)]
        work()
        for other in others:
            other.result()

    def fits(self, count: int, inputs: Sequence[Any]) -> bool:
        """Whether it was prepared for just these arguments."""
        return (
            count == self.count
            and len(inputs) == len(self.inputs)
            and all(a is b or (isinstance(a, int | float) and a == b) for a, b in zip(inputs, self.inputs, strict=True))
        )


class Passes:
    """Prepared passes by name; of each the two last ones are kept, since a step reads what the next one writes and back."""

    def __init__(self, device: str) -> None:
        self.device = device
        self.graphs = device != "cpu"
        """Whether chains run as graphs."""
        self._chains: dict[str, list[Chain]] = {}
        self._known: dict[str, list[Pass]] = {}

    def __call__(self, name: str, kernel: Any, count: int, inputs: Sequence[Any]) -> Pass:
        """The pass of this name with these arguments."""
        known = self._known.setdefault(name, [])
        for one in known:
            if one.fits(count, inputs):
                return one
        made = Pass(kernel, count, inputs, self.device)
        self._known[name] = [*known[-1:], made]
        return made

    def chain(self, name: str, passes: Sequence[Callable[[], None]]) -> Chain:
        """Passes to run after each other; the graph of the same ones is used again."""
        known = self._chains.setdefault(name, [])
        for one in known:
            if one.graph == self.graphs and len(one.passes) == len(passes) and all(map(is_, one.passes, passes)):
                return one
        made = Chain(passes, self.device, graph=self.graphs)
        self._chains[name] = [*known[-1:], made]
        return made


class Chain:
    """Passes that always run after each other: one graph on a GPU."""

    def __init__(self, passes: Sequence[Callable[[], None]], device: str, *, graph: bool) -> None:
        self.passes = list(passes)
        self.device, self.graph = device, graph
        self._graph: Any = None

    def __call__(self) -> None:
        """Run all passes in order."""
        if not self.graph:
            for one in self.passes:
                one()
            return
        wp = warp()
        if self._graph is None:
            with wp.ScopedCapture(device=self.device, force_module_load=False) as capture:
                for one in self.passes:
                    one()
            self._graph = capture.graph
        wp.capture_launch(self._graph)

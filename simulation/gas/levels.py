"""Pressure solve of a whole box of cells: conjugate gradients, preconditioned by one multigrid cycle (as `simulation/grids/multigrid.py`,
which numbers the wet cells of a liquid; a gas fills its box, so that neighbours follow from places)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ...geometry.launch import warp
from ..grids import row_kernels
from ..grids.multigrid import BOTTOM, DEPTH, FEWEST, Solution
from ..passes import Waves
from . import box_kernels as boxes
from . import level_kernels as kernels
from .coarse_kernels import coarse_weights

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..grids.runner import Runner
    from ..passes import Pass

__all__ = ["Level", "Levels"]

LEAST, LEAST_OF_CELLS = 1e-4, 1e-6
"""Least sum of the weights around a block, and around a cell of the finest level."""
SWEEPS = 2
"""Measured (`bench gas`): the residual falls by a decade per two iterations, which one sweep misses at 128^3."""
SOME = 16384
"""Own choice: cells of a sweep worth a thread of a CPU: some 20 microseconds."""


@dataclass
class Level:
    """Fields of one level."""

    box: Any
    """`Box` of the kernels; only its cells and whether axes are periodic count."""
    shape: tuple[int, int, int]
    weights: list[Any]
    """Weights of the lower faces along x, y, z."""
    inverse: Any
    """1 over the sum of the weights around a cell."""
    right: Any
    x: Any
    left: Any
    """Residuals."""

    @property
    def elements(self) -> int:
        """Elements of a field."""
        return math.prod(n + 1 for n in self.shape)

    @property
    def system(self) -> list[Any]:
        """Matrix of a level, as kernels take it."""
        return [*self.weights, self.inverse]


def _level(run: Runner, box: Any, shape: tuple[int, int, int], depth: int) -> Level:
    elements = math.prod(n + 1 for n in shape)
    weights = [run.field(f"levels/weight/{axis}/{depth}", elements) for axis in range(3)]
    names = ("inverse", "right", "x", "left")
    return Level(box, shape, weights, *(run.field(f"levels/{name}/{depth}", elements) for name in names))


class Levels:
    """Levels of a box, and launches of its solve, prepared once.

    Args:
        run: arrays and launches.
        box: of the finest level.
        shape: its cells.
        sweeps: over each level on the way down, and as many on the way up.
    """

    def __init__(self, run: Runner, box: Any, shape: tuple[int, int, int], *, sweeps: int = SWEEPS) -> None:
        self.run, self.box, self.shape, self.sweeps = run, box, shape, sweeps
        self.all = [_level(run, box, shape, 0)]
        while math.prod(shape) > FEWEST and len(self.all) < DEPTH:
            coarse = boxes.Box()
            shape = tuple((n + 1) // 2 for n in shape)  # type: ignore[assignment]
            coarse.nx, coarse.ny, coarse.nz = shape
            coarse.wraps = box.wraps
            self.all.append(_level(run, coarse, shape, len(self.all)))
        fine = self.fine = self.all[0]
        self.elements = fine.elements
        self.blocks = -(-self.elements // run.block)
        self._p, self._ap = run.field("levels/p", self.elements), run.field("levels/ap", self.elements)
        self._sums, self._tops = (
            run.array(n, self.blocks, t) for n, t in (("levels/sums", warp().float64), ("levels/tops", warp().float32))
        )
        self._cycle = self._prepare_cycle()
        least = [LEAST_OF_CELLS, *[LEAST] * len(self.all)]
        self._weighing = [[self._rows(kernels.invert, one, [least[depth], *one.system])] for depth, one in enumerate(self.all)]
        """Passes of each level that take over the weights of the one below."""
        for (a, b), calls in zip(pairwise(self.all), self._weighing[1:], strict=True):
            calls[:0] = [self._rows(coarse_weights, b, [a.box, axis, a.weights[axis], b.weights[axis]]) for axis in range(3)]
        many = [self.elements, run.block]
        self._inner = self._flat(row_kernels.inner, [*many, fine.right, fine.x, self._sums])
        self._along = self._flat(row_kernels.inner, [*many, self._p, self._ap, self._sums])
        self._direct = self._flat(row_kernels.next_direction, [*many, 0.0, fine.x, self._p])
        self._multiply = self._rows(kernels.multiply, fine, [*fine.system, fine.right, self._p, self._ap])

    def _flat(self, kernel: Any, inputs: list[Any]) -> Pass:
        return self.run.prepare(kernel, self.blocks, inputs, grain=max(1, 65536 // self.run.block))

    def _rows(self, kernel: Any, level: Level, inputs: list[Any]) -> Pass:
        """A pass over runs of cells along z."""
        row = level.shape[2] + 1
        span = self.run.span(row)
        return self.run.prepare(
            kernel, level.elements // row * -(-row // span), [level.box, span, *inputs], grain=max(1, SOME // span)
        )

    def refresh(self, *, coarser: bool = True) -> None:
        """Take over new weights of the finest level; `coarser`: in the others too, which only guide the solve."""
        for calls in self._weighing[: None if coarser else 1]:
            for call in calls:
                call()

    def _prepare_cycle(self) -> list[Callable[[], None]]:
        """One V-cycle from `right` to `x` of the finest level, symmetric."""
        down: list[Callable[[], None]] = []
        up: list[list[Callable[[], None]]] = []
        for depth, level in enumerate(self.all):
            system = [*level.system, level.right, level.x]
            red, black = (self._rows(kernels.relax, level, [colour, *system]) for colour in (0, 1))
            first = [self._rows(kernels.start_red, level, system[3:]), black, *[red, black] * (self.sweeps - 1)]
            if depth + 1 == len(self.all):
                down += [*first, *self._prepare_bottom(level, red, black)]
                continue
            coarse = self.all[depth + 1]
            first.append(self._rows(kernels.residuals, level, [*system, level.left]))
            last = [self._rows(kernels.return_up, level, [coarse.box, coarse.x, level.x]), *[black, red] * self.sweeps]
            layer = level.elements // (level.shape[0] + 1) // self.run.span(level.shape[2] + 1)
            # Neighbours of the first layer where it repeats lie in the last one.
            waves = not level.box.wraps[0] and self.run.device == "cpu"
            down += [Waves(first, layer)] if waves else first
            down.append(self._rows(kernels.collect, coarse, [level.box, level.left, coarse.right]))
            up.append([Waves(last, layer)] if waves else [*last])
        return down + [one for calls in reversed(up) for one in calls]

    def _prepare_bottom(self, level: Level, red: Pass, black: Pass) -> list[Pass]:
        """Sweeps on the coarsest level, red and black, then black and red."""
        if self.run.device == "cpu":
            return [self.run.prepare(kernels.rest, 1, [level.box, BOTTOM, *level.system, level.right, level.x])]
        return [black if (n % 2 == 1) == (n < 2 * BOTTOM) else red for n in range(4 * BOTTOM)]

    def largest(self, values: Any) -> float:
        """Largest size of a field of the finest level."""
        self.run(
            row_kernels.greatest,
            self.blocks,
            [self.elements, self.run.block, values, self._tops],
            grain=max(1, 65536 // self.run.block),
        )
        return float(self.run.read(self._tops, self.blocks).max())

    def solve(self, right: Any, x: Any, bound: float, cap: int) -> Solution:
        """Solve the finest level's system from x = 0 until no residual exceeds `bound`; `fine.right` holds the residual."""
        run, fine = self.run, self.fine
        x.zero_()
        self._p.zero_()
        warp().copy(fine.right, right)
        largest = self.largest(fine.right)
        update = self._flat(row_kernels.advance, [self.elements, run.block, 0.0, self._p, self._ap, x, fine.right, self._tops])
        before = 0.0
        for iteration in range(cap):
            if largest <= bound:
                return Solution(iteration, largest, False)
            for call in self._cycle:
                call()
            self._inner()
            now = float(run.read(self._sums, self.blocks).sum())
            self._direct({3: now / before if before > 0.0 else 0.0})
            before = now
            self._multiply()
            self._along()
            along = float(run.read(self._sums, self.blocks).sum())
            if not along > 0.0:
                break
            update({3: now / along})
            largest = float(run.read(self._tops, self.blocks).max())
        return Solution(cap, largest, largest > bound)

"""Gaps thinner than a cell between a freely moving body and what it lies on: their cells carry the pressure of the liquid beside them.

Real water wets such a gap and lifts the body by all that it displaces. No particle gets in, and no cell has its centre there.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry.launch import warp
from ...grids.runner import Runner
from . import cut_kernels as cuts
from . import distance_kernels as distances
from . import gap_fill_kernels as filling
from . import gap_kernels as kernels

if TYPE_CHECKING:
    from .grid import Grid
    from .solids import Solids

__all__ = ["Gaps"]

MOST_TURNS = 256
"""Cells over which liquid wets a gap from its rim."""


class Gaps:
    """The gaps of one step."""

    def __init__(self, run: Runner, solids: Solids) -> None:
        self.run, self.solids = run, solids
        free = [int(b.motion == "dynamic") for b in solids.setup.boundaries]
        self._any = any(free)
        self.free = run.upload("gap/free", np.array([*free, 0], np.int32), warp().int32)
        self.count = 0
        """Cells at gaps."""

    def _of(self, grid: Grid, name: str, kind: Any) -> Any:
        return self.run.array(f"gap/{name}", grid.cells + 1, kind)

    def find(self, grid: Grid, points: Any, walls: list[Any], opening: Any, thin: Any) -> None:
        """Find the gaps and open their faces.

        Args:
            grid: of the step.
            points: distances of `corner_distances`.
            walls: lower and upper closed sides of the domain [cells].
            opening: open shares of faces, changed.
            thin: of `cut_kernels.close_thin`, changed.
        """
        self.count = 0
        if not self._any:
            return
        wp, run, total = warp(), self.run, grid.cells
        at = kernels.Near()
        at.grid, at.near, at.points = grid.columns, grid.near, points
        at.fixed, at.fixed_owner = run.array("fixed", total, distances.vec8), run.array("fixed_owner", total, wp.vec4i)
        at.mover = run.array("mover", total, wp.vec4i)
        at.lower, at.upper = walls
        gap, held, flag = (self._of(grid, name, wp.int32) for name in ("mark", "held", "flag"))
        width = self._of(grid, "width", wp.float32)
        run(kernels.find_gaps, total, [at, self.free, opening, thin, gap, held, width, flag])
        flag[total : total + 1].zero_()
        before = self._of(grid, "before", wp.int32)
        self.count = run.scan(flag, before, total + 1)
        if not self.count:
            return
        run(kernels.list_gaps, total, [flag, before, run.array("gap/listed", self.count, wp.int32)])
        run(kernels.open_gaps, total, [at, self.free, gap, held, opening, thin])
        fixed_halves = self._of(grid, "halves", cuts.vec6)
        run(kernels.cut_fixed, total, [at, fixed_halves], grain=1024)
        state = [at, self.free, run.array("halves", total, cuts.vec6), fixed_halves, gap, held, opening]
        run(kernels.split_faces, total, [*state, *self.parts(grid)])

    def flood(self, grid: Grid, opening: Any, solid: Any, phi: Any, wet: Any, red: Any, inside: Any) -> None:
        """Fill the gaps from the liquid beside them, and cells with their centre in a gap with what is found."""
        if not self.count:
            return
        wp, run = warp(), self.run
        level, since = self._of(grid, "level", wp.float32), self._of(grid, "since", wp.int32)
        moving = self.solids.moving
        reach = float(np.max(run.read(moving.box_high, moving.count) - run.read(moving.box_low, moving.count)))
        state = [run.array("gap/listed", self.count, wp.int32), grid.near, self._of(grid, "mark", wp.int32)]
        for turn in range(min(MOST_TURNS, math.ceil(0.5 * reach)) + 2):
            run(filling.flood, self.count, [turn, *state, opening, solid, phi, wet, level, since])
        self._settle(grid, 0, phi, wet, red, inside)

    def settle(self, grid: Grid, opening: Any, phi: Any, wet: Any, red: Any, inside: Any) -> None:
        """Give what `flood` found to cells with their centre in a solid, and close what would leak into air."""
        if not self.count:
            return
        wp, run = warp(), self.run
        self._settle(grid, 1, phi, wet, red, inside)
        gap, since = self._of(grid, "mark", wp.int32), self._of(grid, "since", wp.int32)
        run(filling.close_gaps, grid.cells, [grid.near, gap, since, wet, opening])

    def _settle(self, grid: Grid, hidden: int, phi: Any, wet: Any, red: Any, inside: Any) -> None:
        wp, run = warp(), self.run
        marks = [self._of(grid, name, wp.int32) for name in ("mark", "held")]
        found = [self._of(grid, "level", wp.float32), self._of(grid, "since", wp.int32)]
        listed = run.array("gap/listed", self.count, wp.int32)
        run(filling.settle, self.count, [hidden, listed, grid.columns, *marks, *found, phi, wet, red, inside])

    def parts(self, grid: Grid) -> list[Any]:
        """Share of the first owner in what closes each face, -1 where there is one owner only, and both owners."""
        wp = warp()
        return [self._of(grid, "part", wp.vec3), *(self._of(grid, name, wp.vec3i) for name in ("one", "other"))]

    def seal(self, grid: Grid, face_owner: Any, walls: Any, was: Any, ratio: float, faces: list[Any]) -> None:
        """Close gaps that are too narrow for particles to them; `faces` of `solid_kernels.constrain`, changed."""
        if self.count:
            wp = warp()
            state = [grid.columns, grid.near, self._of(grid, "mark", wp.int32), self._of(grid, "width", wp.float32)]
            self.run(filling.seal, grid.cells, [*state, face_owner, *self.parts(grid), walls, was, ratio, *faces])

    def quiet(self, grid: Grid, row: Any, right: Any, excess: Any) -> None:
        """Take cells of gaps with their centre in a solid out of the correction of density."""
        if self.count:
            wp, run = warp(), self.run
            listed, held = run.array("gap/listed", self.count, wp.int32), self._of(grid, "held", wp.int32)
            run(filling.quiet, self.count, [listed, held, row, right, excess])

"""Cells of the grid of a liquid: what boundaries and the domain leave open of them, which hold liquid, and the rows of its equations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ....geometry.launch import chosen_device, warp
from ....worlds.errors import LimitError
from ...grids import columns, multigrid
from ...grids.runner import Runner
from ..engine import LiquidSetup
from . import cut_kernels as cuts
from . import distance_kernels as distances
from . import exchange_kernels as exchanges
from . import grid_kernels as cells
from . import solid_kernels as walls
from .gaps import Gaps
from .grid import Grid
from .settings import FlipSettings
from .solids import Solids
from .sources import Sources

__all__ = ["CutCells"]

PAD = 2
"""Cells below the domain, for faces beyond its walls; above there is one more."""
FAR = 1e9
SLIVER = 0.05
"""Share of a cell below which what a closed side leaves of it is no cell of its own."""
KARMAN = 0.41


class CutCells:
    """The domain of a liquid in cells, cut by its boundaries.

    Args:
        setup: the liquid.
        settings: of its engine.

    Attributes:
        volume: of the liquid as the grid sees it [m^3]: what lies under the surface at the start of the last step.

    Raises:
        LimitError: the domain has more cells than can be numbered.
    """

    def __init__(self, setup: LiquidSetup, settings: FlipSettings) -> None:
        self.setup, self.settings = setup, settings
        self.device = chosen_device(setup.device)
        self.run = Runner(self.device)
        wp = warp()
        self._cell = float(setup.spacing)
        self._origin = np.asarray(setup.lower, dtype=np.float64) - PAD * self._cell
        size = (np.asarray(setup.upper, dtype=np.float64) - self._origin) / self._cell
        self._shape = tuple(math.ceil(n - 1e-6) + PAD + 1 for n in size)
        if np.prod(np.array(self._shape, dtype=np.float64)) >= 2**31 - 1:
            raise LimitError(
                f"the liquid's domain has {' x '.join(map(str, self._shape))} cells of {self._cell:g} m, more than 2^31; "
                "enlarge the resolution or shrink the domain"
            )
        self._box = [wp.vec3(float(PAD), float(PAD), float(PAD)), wp.vec3(*size)]
        self._sides = columns.vec6i(*(int(side == "open") for side in setup.sides))
        closed = np.array([side == "closed" for side in setup.sides]).reshape(3, 2)
        self._walls = np.where(closed, np.array([np.full(3, float(PAD)), size]).T, (-FAR, FAR)).T
        """Lower and upper walls of the domain [cells]; far away where a side is open."""
        # A closed side may cut its last cell: that one holds liquid wherever its centre is.
        self._top = wp.vec3(*np.where(closed[:, 1], np.ceil(size - SLIVER), size))
        self.solids = Solids(self.run, setup, self._origin)
        self.gaps = Gaps(self.run, self.solids)
        self.sources = Sources(self.run, setup, self._origin)
        self.volume = 0.0
        self._dt = 0.0
        """Length of the present step [s]."""

    def _faces(self, grid: Grid, *names: str) -> list[Any]:
        return [self.run.array(name, grid.cells, warp().vec3) for name in names]

    def _of(self, grid: Grid, *names: str) -> list[Any]:
        return [self.run.array(name, grid.cells, warp().float32) for name in names]

    def _owners(self, grid: Grid) -> Any:
        return self.run.array("face_owner", grid.cells, warp().vec3i)

    def _cut(self, grid: Grid, mouths: Any) -> None:
        """Open shares of faces and cells: the domain, boundaries, openings of inflows."""
        wp, run, total = warp(), self.run, grid.cells
        (opening,), (room, spread, solid) = self._faces(grid, "opening"), self._of(grid, "room", "spread", "solid")
        box = [wp.vec3(*limits) for limits in self._walls]
        run(
            cells.open_box,
            self._shape[0] * self._shape[1],
            [grid.columns, *box, opening, room, spread, self._owners(grid)],
            grain=256,
        )
        if self.solids.count:
            many = self._shape[0] * self._shape[1] + 1
            before = columns.Columns()
            before.nx, before.ny, before.nz = self._shape
            before.low, before.start = run.array("low/before", many, wp.int32), run.array("start/before", many, wp.int32)
            before.column = grid.columns.column
            for name in ("fixed", "fixed_owner"):
                run.swap(name, name + "/before")
            owner, owner_before = run.array("fixed_owner", total, wp.vec4i), run.array("fixed_owner/before", 1, wp.vec4i)
            fixed, points = (run.array(name, total, distances.vec8) for name in ("fixed", "points"))
            fixed_before = run.array("fixed/before", 1, distances.vec8)
            halves = run.array("halves", total, cuts.vec6)
            assert self.solids.fixed is not None
            nearest = run.array("owner", total, wp.vec4i)
            inputs = [grid.columns, before, self.solids.reuse, *self.solids.fixed, fixed_before, owner_before, self.solids.moving]
            found = [fixed, owner, points, nearest, run.array("mover", total, wp.vec4i)]
            run(distances.corner_distances, total, [*inputs, *found], grain=256)
            self.solids.reuse = 1
            run(cuts.find_halves, total, [grid.near, points, halves, room, spread, solid], grain=1024)
            run(cuts.cut_faces, total, [grid.near, nearest, halves, opening, self._owners(grid)])
            thin = run.array("thin", total, wp.vec3)
            run(cuts.close_thin, total, [grid.near, solid, opening, thin])
            self.gaps.find(grid, points, box, opening, thin)
        if self.settings.roughness > 0.0:
            self._rub(grid)
        if self.sources.mouths:
            inputs = [grid.columns, len(self.sources.mouths), self.solids.count, *self.sources.shape(), mouths]
            inputs += [grid.near, *box, int(self.solids.count > 0), solid]
            run(walls.open_mouths, total, [*inputs, opening, self._owners(grid)])

    def _rub(self, grid: Grid) -> None:
        """Friction by the law of the wall: shear stress density (karman u / ln(z / z0))^2 in a layer of one cell."""
        rough = self.settings.roughness
        law = (KARMAN / math.log((0.5 * self._cell + rough) / rough)) ** 2
        state = [grid.columns, grid.near, *self._box, self._sides, int(self.solids.count > 0), *self._of(grid, "solid")]
        self.run(walls.rub, grid.cells, [*state, law * self._dt / self._cell, *self._faces(grid, "new", "new2")])
        self.run.swap("new", "new2")

    def _build_rows(self, grid: Grid) -> multigrid.Solver:
        """Surface, and the system of equations with its coarser levels."""
        wp, run, total = warp(), self.run, grid.cells
        red, wet = run.array("red", total + 1, wp.int32), run.array("wet", total + 1, wp.int32)
        (phi,) = self._of(grid, "phi")
        run(
            cells.find_surface,
            total,
            [grid.columns, *self._of(grid, "density", "spread"), self._box[0], self._top, phi, red, wet],
        )
        if self.solids.count:
            inputs = [
                grid.columns,
                grid.near,
                *self._of(grid, "solid"),
                *self._faces(grid, "opening"),
                self._owners(grid),
                wet,
                phi,
                red,
            ]
            (opening,), inside = self._faces(grid, "opening"), run.array("inside", total, wp.int32)
            (solid,) = self._of(grid, "solid")
            self.gaps.flood(grid, opening, solid, phi, wet, red, inside)
            phi, hidden = self.run.array("phi2", total, wp.float32), run.array("wet2", total + 1, wp.int32)
            run(cells.find_hidden, total, [*inputs, hidden, phi, inside])
            self.gaps.settle(grid, opening, phi, hidden, red, inside)
            run.swap("phi", "phi2")
            run(cells.close_buried, total, [grid.near, phi, *self._faces(grid, "opening")])
            wet = hidden
        row, _, rows, reds = multigrid.number(run, run.array, total, red, wet)
        level = multigrid.rows_of(run.array, grid.columns, total, row, rows, reds)
        self._fill_rows(grid, level)
        many = -(-total // run.block)
        sums = run.array("volume/sums", many, wp.float64)
        run(cells.measure, many, [total, run.block, phi, *self._of(grid, "room"), sums], grain=16)
        self.volume = float(run.read(sums, many).sum()) * self._cell**3
        return multigrid.Solver(run, multigrid.hierarchy(run, level))

    def _shut(self, grid: Grid, level: multigrid.Level) -> Any:
        """Walls that close faces of the liquid's cells."""
        wp, run = warp(), self.run
        shut = exchanges.Shut()
        shut.phi = self._of(grid, "phi")[0]
        shut.near, shut.row, shut.cell = grid.near, level.row, run.array("cell", level.rows, wp.int32)
        shut.opening, shut.owner, shut.solids = self._faces(grid, "opening")[0], self._owners(grid), int(self.solids.count > 0)
        shut.gaps = int(self.gaps.count > 0)
        shut.part, shut.one, shut.other = self.gaps.parts(grid)
        shut.inside, shut.thin = run.array("inside", grid.cells, wp.int32), run.array("thin", grid.cells, wp.vec3)
        return shut

    def _fill_rows(self, grid: Grid, level: multigrid.Level) -> None:
        """Couplings and right sides of the liquid's cells."""
        wp, run, rows = warp(), self.run, level.rows
        right, airy = run.array("pressure_right", rows, wp.float32), run.array("airy", rows, wp.int32)
        system = [level.link, level.coefficient, level.diagonal, right, airy]
        state = [grid.near, run.array("cell", rows, wp.int32), level.row, *self._of(grid, "phi")]
        run(cells.build_rows, rows, [*state, *self._faces(grid, "opening", "new"), *system])

"""The grid engine: marker particles carry the liquid, a staggered grid keeps its volume."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....geometry.launch import chosen_device, warp
from ....worlds.errors import LimitError
from ..engine import BodyState, LiquidSetup, Particles, StepReport
from . import column_kernels as columns
from . import grid_kernels as cells
from . import multigrid, seeding
from . import multigrid_kernels as blocks
from . import transfer_kernels as transfer
from .run import Runner
from .settings import FlipSettings

__all__ = ["Flip"]

PAD = 2
"""Cells around the domain, for faces beyond its walls."""


@dataclass
class Grid:
    """The sparse grid of one step and what lives in its cells."""

    columns: Any
    cells: int
    near: Any
    head: Any
    """First particle of each column."""


class Flip:
    """Engine of `LiquidSetup`s of one liquid, after Zhu and Bridson (2005), doi:10.1145/1073204.1073298.

    Raises:
        InputError: the setup asks for what a grid of one liquid cannot do; the text says what to use instead.
        LimitError: the domain has more cells than can be numbered.
    """

    def __init__(self, setup: LiquidSetup, settings: FlipSettings | None = None) -> None:
        self.setup = setup
        self.settings = settings or FlipSettings()
        self.device = chosen_device(setup.device)
        self.run = Runner(self.device)
        seeding.check(setup)
        self._cell = float(setup.spacing)
        self._origin = np.asarray(setup.lower, dtype=np.float64) - PAD * self._cell
        size = (np.asarray(setup.upper, dtype=np.float64) - self._origin) / self._cell
        self._shape = tuple(math.ceil(n - 1e-6) + PAD for n in size)
        if np.prod(np.array(self._shape, dtype=np.float64)) >= 2**31 - 1:
            raise LimitError(
                f"the liquid's domain has {' x '.join(map(str, self._shape))} cells of {self._cell:g} m, more than 2^31; "
                "enlarge the resolution or shrink the domain"
            )
        self._lower = np.full(3, float(PAD))
        self._upper = size
        self._density = setup.fluids[0].density
        self._reach = math.ceil(self.settings.cfl) + 1
        start = seeding.seed(setup, self.settings.particles_per_cell)
        self._set(start)
        self._time = 0.0
        self._speed = float(np.linalg.norm(start.velocity, axis=1).max(initial=0.0))

    def _set(self, start: Particles) -> None:
        """Take particles over."""
        wp = warp()
        n = len(start.position)
        self._count = n
        position = np.empty((n, 4), dtype=np.float32)
        position[:, :3] = (start.position - self._origin) / self._cell
        position[:, 3] = start.volume / self._cell**3
        velocity = np.zeros((n, 4), dtype=np.float32)
        velocity[:, :3] = start.velocity
        self.run.upload("position", position, wp.vec4)
        self.run.upload("velocity", velocity, wp.vec4)
        self.run.upload("slot", np.arange(n, dtype=np.int32), wp.int32)
        self.run.upload("affine", np.zeros((n, 3, 3), dtype=np.float32), wp.mat33)
        self._identity = start.identity.copy()
        self._fluid = start.fluid.copy()
        self._volume = start.volume.copy()
        self._temperature = start.temperature.copy()
        self._next = int(start.identity.max(initial=-1)) + 1

    def stable_dt(self) -> float:
        """Largest stable step in the present state [s]: the fastest particle, sped up by gravity, crosses `cfl` cells."""
        fall = float(np.linalg.norm(self.setup.gravity))
        way = self.settings.cfl * self._cell
        return min(self.settings.max_step, 2.0 * way / (self._speed + math.sqrt(self._speed**2 + 4.0 * fall * way) + 1e-12))

    def step(self, limit: float, bodies: BodyState) -> StepReport:
        """One step of at most `limit` seconds; shorter where that makes the steps to `limit` equal.

        Raises:
            EngineError: a particle's state is no longer finite.
        """
        dt = limit / max(1, math.ceil(limit / self.stable_dt() - 1e-6))
        grid = self._build_grid()
        self._to_faces(grid, dt)
        levels = self._build_rows(grid)
        solution = self._press(levels, dt)
        moved, excess = self._correct(grid, levels)
        self._finish(grid, levels[0], dt)
        self._advance(grid, dt)
        self._time += dt
        none = np.zeros((len(self.setup.boundaries), 6))
        return StepReport(
            dt,
            none,
            none.copy(),
            {},
            {},
            (solution.iterations, moved.iterations),
            int(solution.capped) + int(moved.capped),
            excess,
        )

    def _build_grid(self) -> Grid:
        """Sort the particles by cell and lay columns of cells around them."""
        wp, run, n = warp(), self.run, self._count
        nx, ny, nz = self._shape
        many = nx * ny
        keys, order = run.array("keys", 2 * n, wp.int32), run.array("order", 2 * n, wp.int32)
        run(columns.find_keys, n, [run.array("position", n, wp.vec4), nx, ny, nz, keys, order], grain=16384)
        wp.utils.radix_sort_pairs(keys, order, n)
        self._permute(order)
        head = run.array("head", many + 1, wp.int32)
        head.zero_()
        run(columns.find_heads, n, [keys, n, nz, many, head], grain=16384)
        low, high = run.array("low", many + 1, wp.int32), run.array("high", many + 1, wp.int32)
        low2, high2 = run.array("low2", many + 1, wp.int32), run.array("high2", many + 1, wp.int32)
        run(columns.find_ranges, many, [head, keys, nz, low, high])
        run(columns.dilate, many, [low, high, nx, ny, 0, self._reach, low2, high2])
        run(columns.dilate, many, [low2, high2, nx, ny, 1, self._reach, low, high])
        count, start = run.array("count", many + 1, wp.int32), run.array("start", many + 1, wp.int32)
        run(columns.count_cells, many + 1, [nz, self._reach, many, low, high, count])
        total = run.scan(count, start, many + 1)
        grid = columns.Columns()
        grid.nx, grid.ny, grid.nz = nx, ny, nz
        grid.low, grid.start = low, start
        grid.column = run.array("column", total, wp.int32)
        run(blocks.name_columns, many, [grid, grid.column])
        near = run.array("near", total, columns.vec6i)
        run(columns.link, total, [grid, near])
        return Grid(grid, total, near, head)

    def _permute(self, order: Any) -> None:
        wp, run, n = warp(), self.run, self._count
        before = [run.array(name, n, kind) for name, kind in (("position", wp.vec4), ("velocity", wp.vec4), ("slot", wp.int32))]
        after = [run.array(name, n, kind) for name, kind in (("position2", wp.vec4), ("velocity2", wp.vec4), ("slot2", wp.int32))]
        run(transfer.permute, n, [order, *before, *after], grain=16384)
        for name in ("position", "velocity", "slot"):
            run.swap(name, name + "2")
        if self.settings.transfer == "apic":
            affine, other = run.array("affine", n, wp.mat33), run.array("affine2", n, wp.mat33)
            run(transfer.permute_affine, n, [order, affine, other], grain=16384)
            run.swap("affine", "affine2")

    def _to_faces(self, grid: Grid, dt: float) -> None:
        """Velocities of faces and densities of cells from the particles, after gravity."""
        wp, run, n = warp(), self.run, self._count
        sums = run.array("scratch", grid.cells * transfer.SUMS, wp.float32)
        apic = int(self.settings.transfer == "apic")
        state = [run.array("position", n, wp.vec4), run.array("velocity", n, wp.vec4), run.array("affine", n, wp.mat33)]
        nx, ny, _ = self._shape
        run(transfer.add_up, nx * ny, [grid.columns, grid.head, *state, apic, sums], grain=64)
        kick = wp.vec3(*(float(g) * dt for g in self.setup.gravity))
        run(
            transfer.gather,
            grid.cells,
            [
                grid.columns,
                sums,
                kick,
                *self._faces(grid, "old", "weight"),
                *self._of(grid, "density"),
                *self._faces(grid, "new"),
            ],
        )

    def _faces(self, grid: Grid, *names: str) -> list[Any]:
        return [self.run.array(name, grid.cells, warp().vec3) for name in names]

    def _of(self, grid: Grid, *names: str) -> list[Any]:
        return [self.run.array(name, grid.cells, warp().float32) for name in names]

    def _build_rows(self, grid: Grid) -> list[multigrid.Level]:
        """Open shares, surface, and the system of equations with its coarser levels."""
        wp, run, total = warp(), self.run, grid.cells
        box = [wp.vec3(*self._lower), wp.vec3(*self._upper)]
        sides = columns.vec6i(*(int(side == "open") for side in self.setup.sides))
        run(cells.open_box, total, [grid.columns, *box, sides, *self._faces(grid, "open"), *self._of(grid, "room", "spread")])
        red, wet = run.array("red", total + 1, wp.int32), run.array("wet", total + 1, wp.int32)
        phi = self._of(grid, "phi")[0]
        run(cells.find_surface, total, [grid.columns, *self._of(grid, "density", "spread", "room"), *box, phi, red, wet])
        row, cell, rows, reds = multigrid.number(run, run.array, total, red, wet)
        level = multigrid.rows_of(run.array, grid.columns, total, row, rows, reds)
        right, airy = run.array("pressure_right", rows, wp.float32), run.array("airy", rows, wp.int32)
        open_, new = self._faces(grid, "open", "new")
        run(
            cells.build_rows,
            rows,
            [grid.near, cell, row, phi, open_, new, level.link, level.coefficient, level.diagonal, right, airy],
        )
        return multigrid.hierarchy(run, level)

    def _press(self, levels: list[multigrid.Level], dt: float) -> multigrid.Solution:
        wp, run, rows = warp(), self.run, levels[0].rows
        bound = self.settings.pressure_error * self._cell / dt
        right, q = run.array("pressure_right", rows, wp.float32), run.array("q", rows, wp.float32)
        return multigrid.solve(run, levels, right, q, bound, self.settings.iterations)

    def _correct(self, grid: Grid, levels: list[multigrid.Level]) -> tuple[multigrid.Solution, tuple[float, float]]:
        """Displacement potential that undoes compression; mean and largest compression found."""
        wp, run, rows = warp(), self.run, levels[0].rows
        right, push = run.array("push_right", rows, wp.float32), run.array("push", rows, wp.float32)
        excess, airy = run.array("excess", rows, wp.float32), run.array("airy", rows, wp.int32)
        share = self.settings.volume_correction
        run(
            cells.rate_density,
            rows,
            [run.array("cell", rows, wp.int32), *self._of(grid, "density", "spread"), airy, share, right, excess],
        )
        found = run.read(excess, rows)
        bounds = (float(np.abs(found).mean()), float(found.max())) if rows else (0.0, 0.0)
        if share == 0.0:
            push.zero_()
            return multigrid.Solution(0, 0.0, False), bounds
        return multigrid.solve(run, levels, right, push, 10.0 * self.settings.pressure_error, self.settings.iterations), bounds

    def _finish(self, grid: Grid, level: multigrid.Level, dt: float) -> None:
        """Velocities after pressure, extended beyond the liquid."""
        wp, run, total, rows = warp(), self.run, grid.cells, level.rows
        known, known2 = run.array("known", total, wp.vec3i), run.array("known2", total, wp.vec3i)
        q, push = run.array("q", rows, wp.float32), run.array("push", rows, wp.float32)
        run(
            cells.project,
            total,
            [
                grid.near, level.row, *self._of(grid, "phi"), *self._faces(grid, "open"), q, push, self._cell / dt,
                self._density * self._cell / dt, *self._of(grid, "density", "spread"), *self._faces(grid, "weight", "new", "drift"),
                known, *self._of(grid, "pressure"),
            ],
        )  # fmt: skip
        for step in (2, 1, 1):
            new, drift, new2, drift2 = self._faces(grid, "new", "drift", "new2", "drift2")
            run(cells.extend, total, [grid.near, step, known, new, drift, known2, new2, drift2])
            known, known2 = known2, known
            run.swap("new", "new2")
            run.swap("drift", "drift2")

    def _advance(self, grid: Grid, dt: float) -> None:
        wp, run, n = warp(), self.run, self._count
        sides = columns.vec6i(*(int(side == "open") for side in self.setup.sides))
        left = run.array("left", n, wp.int32)
        run(
            transfer.advance,
            n,
            [
                grid.columns, *self._faces(grid, "old", "new", "drift"), *self._of(grid, "pressure"), self.settings.flip_ratio,
                int(self.settings.transfer == "apic"), dt / self._cell, float(self._reach - 1), wp.vec3(*self._lower),
                wp.vec3(*self._upper), sides, run.array("position", n, wp.vec4), run.array("velocity", n, wp.vec4),
                run.array("affine", n, wp.mat33), left,
            ],
        )  # fmt: skip
        velocity = run.read(run.array("velocity", n, wp.vec4), n)[:, :3]
        self._speed = float(np.sqrt((velocity.astype(np.float64) ** 2).sum(axis=1).max(initial=0.0)))

    def particles(self) -> Particles:
        """The marker particles, in the order of their cells."""
        wp, run, n = warp(), self.run, self._count
        position, velocity = run.read(run.array("position", n, wp.vec4), n), run.read(run.array("velocity", n, wp.vec4), n)
        slot = run.read(run.array("slot", n, wp.int32), n)
        return Particles(
            self._origin + self._cell * position[:, :3].astype(np.float64),
            velocity[:, :3].astype(np.float64),
            self._identity[slot],
            self._fluid[slot],
            self._volume[slot],
            np.full(n, self._density),
            velocity[:, 3].astype(np.float64),
            self._temperature[slot],
        )

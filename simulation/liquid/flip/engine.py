"""The grid engine: marker particles carry the liquid, a staggered grid keeps its volume."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from ....geometry.launch import chosen_device, warp
from ....worlds.arrays import F64
from ....worlds.errors import EngineError, EvidenceError, LimitError
from ..engine import BodyState, LiquidSetup, Particles, StepReport
from ..zones import Zones
from . import column_kernels as columns
from . import cut_kernels as cuts
from . import distance_kernels as distances
from . import grid_kernels as cells
from . import multigrid, seeding
from . import multigrid_kernels as blocks
from . import solid_kernels as walls
from . import transfer_kernels as transfer
from .exchange import Exchange
from .markers import Markers, from_bytes, to_bytes
from .run import Runner
from .settings import FlipSettings
from .solids import Solids
from .sources import Sources

__all__ = ["Flip"]

PAD = 2
"""Cells below the domain, for faces beyond its walls; above there is one more."""
KARMAN = 0.41
FALL = 0.25
"""Way that gravity adds in a step, in cells: the first steps from rest are of first order in time."""


@dataclass
class Grid:
    """The sparse grid of one step."""

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
        self._density = setup.fluids[0].density
        self._reach = math.ceil(self.settings.cfl) + 1
        apic = self.settings.transfer == "apic"
        self._ratio = 0.0 if apic else self.settings.flip_ratio
        self.markers = Markers(self.run, self._origin, self._cell, self._density, apic=apic)
        start = seeding.seed(setup, self.settings.particles_per_cell)
        self.markers.add(start)
        self.solids = Solids(self.run, setup, self._origin)
        self.sources = Sources(self.run, setup, self._origin)
        self.zones = Zones(setup, self._origin, self.device)
        self.time = 0.0
        self._begun = False
        self._speed = float(np.linalg.norm(start.velocity, axis=1).max(initial=0.0))
        self._speed = max(self._speed, *(i.speed for i in setup.inflows), 0.0)
        self.volume = float(start.volume.sum())
        """Of the liquid as the grid sees it [m^3]: what lies under the surface at the start of the last step."""

    def stable_dt(self) -> float:
        """Largest stable step in the present state [s].

        The fastest particle, sped up by gravity, crosses at most `cfl` cells, and a cell falls by at most FALL of its size.
        """
        gravity = float(np.linalg.norm(self.setup.gravity))
        way = self.settings.cfl * self._cell
        fast = 2.0 * way / (self._speed + math.sqrt(self._speed**2 + 4.0 * gravity * way) + 1e-12)
        fall = math.sqrt(FALL * self._cell / gravity) if gravity > 0.0 else math.inf
        return min(self.settings.max_step, fast, fall)

    def step(self, limit: float, bodies: BodyState) -> StepReport:
        """One step of at most `limit` seconds; shorter where that makes the steps to `limit` equal.

        Raises:
            EngineError: a particle's state is no longer finite; the text names the place.
            InputError: the bodies do not fit the boundaries, or an inflow lies in a solid.
        """
        if not self._begun:
            self.sources.clear_solids(lambda points: self.solids.distance(points, bodies))
            self._begun = True
        fast = float(np.linalg.norm(bodies.velocity, axis=1).max(initial=0.0))
        self._speed = max(self._speed, fast)
        dt = limit / max(1, math.ceil(limit / self.stable_dt() - 1e-6))
        self.solids.update(bodies)
        if self.markers.live == 0:
            self.markers.total = self.markers.dead = 0
            return self._close(dt, np.zeros((self.solids.count, 6)), np.zeros((self.solids.count, 6)), (0, 0), 0, (0.0, 0.0))
        grid = self._build_grid()
        self._dt = dt
        driven = self._pull(dt)
        self._to_faces(grid, dt)
        mouths, half = self.sources.speeds(self.time, dt)
        self._cut(grid, half)
        levels = self._build_rows(grid)
        fine, run = levels[0], self.run
        near, cell = grid.near, run.array("cell", fine.rows, warp().int32)
        exchange = Exchange(
            run, self.solids, bodies, fine, grid.columns, [near, cell, *self._faces(grid, "opening"), self._owners(grid)], mouths
        )
        exchange.mass = self._density * self._cell**3
        pressed = self._press(levels, exchange, dt)
        moved, excess = self._correct(grid, levels)
        q = run.array("q", fine.rows, warp().float32)
        impulse = exchange.end(q)
        change = self._finish(grid, fine, exchange, dt)
        reaction = exchange.felt(impulse, change)
        self._advance(grid, exchange, dt)
        capped = int(pressed.capped) + int(moved.capped)
        iterations = (pressed.iterations, moved.iterations)
        report = self._close(dt, impulse[: self.solids.count], reaction, iterations, capped, excess)
        return replace(report, driven=driven)

    def _pull(self, dt: float) -> F64:
        """Draw particles in zones of waves towards them."""
        markers = self.markers
        state = [self._cell, self._density * self._cell**3, markers.position, markers.velocity]
        return self.zones.pull(partial(self.run, grain=8), "pull_cells", markers.total, state, self.time, dt)

    def _close(
        self, dt: float, impulse: F64, reaction: F64, iterations: tuple[int, int], capped: int, excess: tuple[float, float]
    ) -> StepReport:
        """Take out what left, let in what came, and find the fastest particle."""
        wp, run, markers = warp(), self.run, self.markers
        removed = self.sources.take_out(markers, run.array("left", max(1, markers.total), wp.int32))
        added = self.sources.let_in(markers, self.time, dt)
        self.time += dt
        many = -(-markers.total // run.block)
        top = run.array("top", max(1, many), wp.float64)
        run(transfer.fastest, many, [markers.total, run.block, markers.velocity, top], grain=16)
        most = float(run.read(top, many).max(initial=0.0))
        if not math.isfinite(most):
            self._fail()
        inflow = max((i.speed for i in self.setup.inflows), default=0.0)
        self._speed = max(math.sqrt(most), inflow)
        return StepReport(dt, impulse, reaction, added, removed, iterations, capped, excess)

    def _fail(self) -> None:
        velocity = self.run.read(self.markers.velocity, self.markers.total)
        bad = int(np.flatnonzero(~np.isfinite(velocity).all(axis=1))[0])
        place = self._origin + self._cell * self.run.read(self.markers.position, self.markers.total)[bad, :3]
        raise EngineError(
            f"the grid liquid is no longer finite at t = {self.time:.4g} s: particle {self.markers.identity[bad]} near "
            f"({', '.join(f'{x:.3g}' for x in place)}) m; shorten max_step or lower cfl (now {self.settings.cfl:g})"
        )

    def _build_grid(self) -> Grid:
        """Sort the particles by cell and lay columns of cells around them."""
        wp, run, markers = warp(), self.run, self.markers
        n = markers.total
        nx, ny, nz = self._shape
        many = nx * ny
        keys, order = run.array("keys", 2 * n, wp.int32), run.array("order", 2 * n, wp.int32)
        run(columns.find_keys, n, [markers.position, nx, ny, nz, keys, order], grain=16384)
        wp.utils.radix_sort_pairs(keys, order, n)
        head = run.array("head", many + 1, wp.int32)
        run(columns.find_heads, n, [keys, n, nz, many, head], grain=16384)
        markers.sort(order)
        run.swap("low", "low/before")
        run.swap("start", "start/before")
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
        grid.base = run.array("base", many, wp.int32)
        run(columns.find_bases, many, [grid, grid.base], grain=16384)
        near = run.array("near", total, columns.vec6i)
        run(columns.link, total, [grid, near])
        return Grid(grid, total, near, head)

    def _to_faces(self, grid: Grid, dt: float) -> None:
        """Velocities of faces and densities of cells from the particles, after gravity."""
        wp, run, markers = warp(), self.run, self.markers
        sums = run.array("scratch", grid.cells * transfer.SUMS, wp.float32)
        nx, ny, _ = self._shape
        state = [markers.position, markers.velocity, markers.affine, int(markers.apic)]
        run(transfer.add_up, nx * ny, [grid.columns, grid.head, *state, sums], grain=64)
        kick = wp.vec3(*(float(g) * dt for g in self.setup.gravity))
        faces = [*self._faces(grid, "old", "weight"), *self._of(grid, "density"), *self._faces(grid, "new")]
        run(transfer.gather, nx * ny, [grid.columns, sums, kick, *faces], grain=64)

    def _faces(self, grid: Grid, *names: str) -> list[Any]:
        return [self.run.array(name, grid.cells, warp().vec3) for name in names]

    def _of(self, grid: Grid, *names: str) -> list[Any]:
        return [self.run.array(name, grid.cells, warp().float32) for name in names]

    def _owners(self, grid: Grid) -> Any:
        return self.run.array("face_owner", grid.cells, warp().vec3i)

    def _cut(self, grid: Grid, mouths: Any) -> None:
        """Open shares of faces and cells: the domain, boundaries, mouths of inflows."""
        wp, run, total = warp(), self.run, grid.cells
        (opening,), (room, spread, solid) = self._faces(grid, "opening"), self._of(grid, "room", "spread", "solid")
        run(cells.open_box, total, [grid.columns, *self._box, self._sides, opening, room, spread, self._owners(grid)])
        if self.solids.count:
            many = self._shape[0] * self._shape[1] + 1
            before = columns.Columns()
            before.nx, before.ny, before.nz = self._shape
            before.low, before.start = run.array("low/before", many, wp.int32), run.array("start/before", many, wp.int32)
            before.column = grid.columns.column
            for name in ("fixed", "fixed_owner"):
                run.swap(name, name + "/before")
            owner, owner_before = run.array("fixed_owner", total, wp.int32), run.array("fixed_owner/before", 1, wp.int32)
            fixed, points = (run.array(name, total, distances.vec8) for name in ("fixed", "points"))
            fixed_before = run.array("fixed/before", 1, distances.vec8)
            halves = run.array("halves", total, cuts.vec6)
            assert self.solids.fixed is not None
            distance, nearest = self._of(grid, "distance")[0], run.array("owner", total, wp.int32)
            inputs = [grid.columns, before, self.solids.reuse, *self.solids.fixed, fixed_before, owner_before, self.solids.moving]
            run(distances.corner_distances, total, [*inputs, fixed, owner, points, distance, nearest], grain=256)
            self.solids.reuse = 1
            run(cuts.find_halves, total, [grid.near, points, halves, room, solid], grain=1024)
            run(cuts.cut_faces, total, [grid.near, distance, nearest, halves, opening, self._owners(grid)])
            run(cuts.close_thin, total, [grid.near, solid, opening])
            run(cuts.near_solid, total, [grid.columns, solid, halves, spread])
        if self.settings.roughness > 0.0:
            self._rub(grid)
        if self.sources.mouths:
            inputs = [grid.columns, len(self.sources.mouths), self.solids.count, *self.sources.shape(), mouths]
            run(walls.open_mouths, total, [*inputs, opening, self._owners(grid)])

    def _rub(self, grid: Grid) -> None:
        """Friction by the law of the wall: shear stress density (karman u / ln(z / z0))^2 in a layer of one cell."""
        rough = self.settings.roughness
        law = (KARMAN / math.log((0.5 * self._cell + rough) / rough)) ** 2
        state = [grid.columns, grid.near, *self._box, self._sides, int(self.solids.count > 0), *self._of(grid, "solid")]
        self.run(walls.rub, grid.cells, [*state, law * self._dt / self._cell, *self._faces(grid, "new", "new2")])
        self.run.swap("new", "new2")

    def _build_rows(self, grid: Grid) -> list[multigrid.Level]:
        """Surface, and the system of equations with its coarser levels."""
        wp, run, total = warp(), self.run, grid.cells
        red, wet = run.array("red", total + 1, wp.int32), run.array("wet", total + 1, wp.int32)
        (phi,) = self._of(grid, "phi")
        run(cells.find_surface, total, [grid.columns, *self._of(grid, "density", "spread"), *self._box, phi, red, wet])
        if self.solids.count:
            inputs = [grid.columns, grid.near, *self._of(grid, "solid"), *self._faces(grid, "opening"), wet, phi, red]
            phi, hidden = self.run.array("phi2", total, wp.float32), run.array("wet2", total + 1, wp.int32)
            run(cells.find_hidden, total, [*inputs, hidden, phi])
            run.swap("phi", "phi2")
            run(cells.close_buried, total, [grid.near, phi, *self._faces(grid, "opening")])
            wet = hidden
        row, cell, rows, reds = multigrid.number(run, run.array, total, red, wet)
        level = multigrid.rows_of(run.array, grid.columns, total, row, rows, reds)
        right, airy = run.array("pressure_right", rows, wp.float32), run.array("airy", rows, wp.int32)
        system = [level.link, level.coefficient, level.diagonal, right, airy]
        run(cells.build_rows, rows, [grid.near, cell, row, phi, *self._faces(grid, "opening", "new"), *system])
        many = -(-total // run.block)
        sums = run.array("volume/sums", many, wp.float64)
        run(cells.measure, many, [total, run.block, phi, *self._of(grid, "room"), sums], grain=16)
        self.volume = float(run.read(sums, many).sum()) * self._cell**3
        return multigrid.hierarchy(run, level)

    def _press(self, levels: list[multigrid.Level], exchange: Exchange, dt: float) -> multigrid.Solution:
        wp, run, rows = warp(), self.run, levels[0].rows
        bound = self.settings.pressure_error * self._cell / dt
        right, q = run.array("pressure_right", rows, wp.float32), run.array("q", rows, wp.float32)
        exchange.start(right, dt)
        return multigrid.solve(run, levels, right, q, bound, self.settings.iterations, exchange.add)

    def _correct(self, grid: Grid, levels: list[multigrid.Level]) -> tuple[multigrid.Solution, tuple[float, float]]:
        """Displacement potential that undoes compression; mean compression inside the liquid and the largest one."""
        wp, run, rows = warp(), self.run, levels[0].rows
        right, push = run.array("push_right", rows, wp.float32), run.array("push", rows, wp.float32)
        excess, airy = run.array("excess", rows, wp.float32), run.array("airy", rows, wp.int32)
        share = self.settings.volume_correction
        state = [run.array("cell", rows, wp.int32), *self._of(grid, "density", "spread"), airy, share, right, excess]
        run(cells.rate_density, rows, state)
        found, inner = run.read(excess, rows), run.read(airy, rows) == 0
        bounds = (float(found[inner].mean()) if inner.any() else 0.0, float(found.max(initial=0.0)))
        if share == 0.0:
            push.zero_()
            return multigrid.Solution(0, 0.0, False), bounds
        return multigrid.solve(run, levels, right, push, 10.0 * self.settings.pressure_error, self.settings.iterations), bounds

    def _finish(self, grid: Grid, level: multigrid.Level, exchange: Exchange, dt: float) -> F64:
        """Velocities after pressure, extended beyond the liquid; the change of momentum that the pressure made."""
        wp, run, total, rows = warp(), self.run, grid.cells, level.rows
        known, known2 = run.array("known", total, wp.vec3i), run.array("known2", total, wp.vec3i)
        q, push = run.array("q", rows, wp.float32), run.array("push", rows, wp.float32)
        scale = self._density * self._cell / dt
        state = [grid.columns, grid.near, level.row, *self._of(grid, "phi"), *self._faces(grid, "opening"), self._owners(grid)]
        after = [*self._faces(grid, "new2", "drift"), known, *self._of(grid, "pressure")]
        run(
            cells.project,
            total,
            [*state, exchange.walls, q, push, self._cell / dt, scale, *self._faces(grid, "weight", "new"), *after],
        )
        change = np.zeros(6)
        if self.solids.count:
            many = -(-total // run.block)
            sums = run.array("momentum/sums", many, walls.vec6d)
            run(walls.momentum, many, [total, run.block, *state[:5], *self._faces(grid, "new", "new2"), sums], grain=16)
            change = run.read(sums, many).sum(axis=0) * self._density * self._cell**3
            change[3:] *= self._cell
        run.swap("new", "new2")
        for step in (2, 1, 1):
            new, drift, new2, drift2 = self._faces(grid, "new", "drift", "new2", "drift2")
            run(cells.extend, total, [grid.near, step, known, new, drift, known2, new2, drift2])
            known, known2 = known2, known
            run.swap("new", "new2")
            run.swap("drift", "drift2")
        state = [grid.columns, grid.near, *self._box, self._sides, int(self.solids.count > 0), *self._of(grid, "solid")]
        state += [*self._faces(grid, "opening"), self._owners(grid), exchange.walls]
        state += [*self._faces(grid, "old"), self._ratio]
        run(walls.constrain, total, [*state, *self._faces(grid, "new", "drift", "new2", "drift2", "given")])
        run.swap("new", "new2")
        run.swap("drift", "drift2")
        return np.asarray(change)

    def _advance(self, grid: Grid, exchange: Exchange, dt: float) -> None:
        """Velocities and places of the particles."""
        wp, run, markers = warp(), self.run, self.markers
        n, way = markers.total, dt / self._cell
        left = run.array("left", n, wp.int32)
        fields = [grid.columns, *self._faces(grid, "given", "drift"), *self._of(grid, "pressure")]
        how = [self._ratio, int(markers.apic), way, float(self._reach - 1), *self._box, self._sides]
        run(transfer.advance, n, [*fields, *how, markers.position, markers.velocity, markers.affine, left])
        if self.solids.count:
            state = [grid.columns, *self._of(grid, "distance"), run.array("owner", grid.cells, wp.int32), exchange.walls]
            run(distances.push_out, n, [*state, way, *self._box, self._sides, markers.position])

    def particles(self) -> Particles:
        """The marker particles, in the order of their cells."""
        return self.markers.particles()

    def checkpoint(self) -> bytes:
        """The full state; the engine itself continues from exactly these bytes."""
        travel = np.array([[mouth.travel, mouth.layers] for mouth in self.sources.mouths]).reshape(-1, 2)
        return to_bytes({**self.markers.dump(), "clock": np.array([self.time, self._speed, self.volume]), "travel": travel})

    def restore(self, state: bytes) -> None:
        """Continue from a checkpoint.

        Raises:
            EvidenceError: the bytes are no checkpoint of this engine.
        """
        try:
            found = from_bytes(state)
            self.markers.load(found)
            self.time, self._speed, self.volume = (float(value) for value in found["clock"])
            for mouth, (travel, layers) in zip(self.sources.mouths, found["travel"], strict=True):
                mouth.travel, mouth.layers = float(travel), int(layers)
        except (KeyError, ValueError, OSError) as error:
            raise EvidenceError(f"these bytes are no checkpoint of the grid engine ({error}); start from another one") from error

"""The grid engine: marker particles carry the liquid, a staggered grid keeps its volume."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ....worlds.errors import EngineError
from ...boundaries import BodyState
from ...grids import multigrid
from ...sealed import from_bytes, to_bytes
from ..blowing import Blowing
from ..engine import LiquidReport, LiquidSetup, Particles, by_inflow
from ..zones import Zones
from . import distance_kernels as distances
from . import exchange_kernels as exchanges
from . import grid_kernels as cells
from . import seeding
from . import solid_kernels as walls
from . import transfer_kernels as transfer
from . import viscous_kernels as thick
from .cut_cells import CutCells
from .exchange import Exchange
from .grid import Grid, build
from .markers import Markers
from .settings import FlipSettings
from .solids import reacting
from .supports import let_go, supports
from .viscosity import Rubbed, Viscosity

__all__ = ["Flip"]

FALL = 0.25
"""Way that gravity adds in a step, in cells: the first steps from rest are of first order in time."""


class Flip(CutCells):
    """Engine of `LiquidSetup`s of one liquid, after Zhu and Bridson (2005), doi:10.1145/1073204.1073298.

    Raises:
        InputError: the setup asks for what a grid of one liquid cannot do; the text says what to use instead.
        LimitError: the domain has more cells than can be numbered.
    """

    def __init__(self, setup: LiquidSetup, settings: FlipSettings | None = None) -> None:
        seeding.check(setup)
        super().__init__(setup, settings or FlipSettings())
        self._density = setup.fluids[0].density
        self._reach = math.ceil(self.settings.cfl) + 1
        apic = self.settings.transfer == "apic"
        self._ratio = 0.0 if apic else self.settings.flip_ratio
        self.markers = Markers(self.run, self._origin, self._cell, self._density, apic=apic)
        start = seeding.seed(setup, self.settings.particles_per_cell)
        self.markers.add(start)
        self.zones = Zones(setup, self._origin, self.device)
        self.blowing = Blowing(setup)
        self.viscosity = Viscosity(self.run, setup)
        self.time = 0.0
        self._begun = False
        self._speed = float(np.linalg.norm(start.velocity, axis=1).max(initial=0.0))
        self._speed = max(self._speed, *(i.speed for i in setup.inflows), 0.0)
        self.volume = float(start.volume.sum())

    def stable_dt(self) -> float:
        """Largest stable step in the present state [s].

        The fastest particle, sped up by gravity, crosses at most `cfl` cells, and a cell falls by at most FALL of its size.
        """
        gravity = float(np.linalg.norm(self.setup.gravity))
        way = self.settings.cfl * self._cell
        fast = 2.0 * way / (self._speed + math.sqrt(self._speed**2 + 4.0 * gravity * way) + 1e-12)
        fall = math.sqrt(FALL * self._cell / gravity) if gravity > 0.0 else math.inf
        return min(self.settings.max_step, fast, fall)

    def step(self, limit: float, bodies: BodyState) -> LiquidReport:
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
        self.sources.look(self.markers, dt)
        if self.markers.live == 0:
            self.markers.total = self.markers.dead = 0
            return self._close(dt, np.zeros((self.solids.count, 6)), np.zeros((self.solids.count, 6)), (0, 0), 0, (0.0, 0.0))
        grid = self._build_grid()
        self._dt = dt
        driven, blown = self._pull(dt), self._blow(bodies, dt)
        self._to_faces(grid, dt)
        mouths, half = self.sources.speeds(self.time, dt)
        self._cut(grid, half)
        solver = self._build_rows(grid)
        fine, run = solver.levels[0], self.run
        exchange, impulse, iterations, capped = self._project_first(grid, solver, bodies, mouths)
        calm, ratio = self.viscosity.look(self.markers, dt), self._ratio
        viscous = calm is not None
        if calm is not None:
            ratio *= calm
            rubbed = self._resist(grid, solver, exchange)
            pressed = self._press(solver, exchange)
            impulse += rubbed.impulse + exchange.end(run.array("q", fine.rows, warp().float32))
            iterations += pressed.iterations
            capped += int(pressed.capped) + int(rubbed.capped)
        moved, excess = self._correct(grid, solver)
        capped += int(moved.capped)
        change = self._finish(grid, fine, exchange, viscous, ratio)
        reaction = exchange.felt(impulse, change)
        self._advance(grid, exchange, ratio)
        report = self._close(dt, impulse[: self.solids.count], reaction, (iterations, moved.iterations), capped, excess)
        return replace(report, driven=driven, blown=blown)

    def _project_first(
        self, grid: Grid, solver: multigrid.Solver, bodies: BodyState, mouths: F64
    ) -> tuple[Exchange, F64, int, int]:
        """The first projection: its exchange, the impulses, iterations, and how many solves were capped.

        A body that something bears is held along that first. Where the lift is more than what bears it, that lets it go, and
        it is solved for once more, free: contacts push and do not pull.
        """
        run, fine, dt = self.run, solver.levels[0], self._dt
        gravity = np.asarray(self.setup.gravity)
        borne, iterations, capped = supports(bodies, gravity, reacting(self.setup.boundaries, bodies)), 0, 0
        while True:
            exchange = Exchange(run, self.solids, bodies, fine, grid.columns, self._shut(grid, fine), mouths)
            exchange.mass, exchange.supports = self._density * self._cell**3, borne
            exchange.start(run.array("pressure_right", fine.rows, warp().float32), self._faces(grid, "new")[0], dt)
            pressed = self._press(solver, exchange)
            iterations, capped = iterations + pressed.iterations, capped + int(pressed.capped)
            impulse = exchange.end(run.array("q", fine.rows, warp().float32))
            lifted = [n for n, s in borne.items() if impulse[n, :3] @ s.way > s.most * dt]
            if not lifted:
                return exchange, impulse, iterations, capped
            borne = {n: s for n, s in borne.items() if n not in lifted}
            bodies = let_go(bodies, lifted, gravity)
            self._fill_rows(grid, fine)

    def _pull(self, dt: float) -> F64:
        """Draw particles in zones of waves towards them."""
        markers = self.markers
        state = [self._cell, self._density * self._cell**3, markers.position, markers.velocity]
        return self.zones.pull(partial(self.run, grain=8), "pull_cells", markers.total, state, self.time, dt)

    def _blow(self, bodies: BodyState, dt: float) -> F64:
        """Let force fields act on the markers; momentum and energy that they gave, (4,)."""
        if not self.blowing.acts(self.time, dt):
            return np.zeros(4)
        markers, count = self.markers, self.markers.total
        place, speed = self.run.read(markers.position, count), self.run.read(markers.velocity, count)
        rows = np.flatnonzero(place[:, 3] > 0)
        volume = place[rows, 3].astype(np.float64) * self._cell**3
        fluid = markers.fluid[self.run.read(markers.slot, count)[rows]].astype(np.int64)
        world = place[rows, :3].astype(np.float64) * self._cell + markers.origin
        found = self.blowing.kick(
            world, speed[rows, :3].astype(np.float64), volume, fluid, np.ones(len(rows)), bodies, self.time, dt
        )
        speed[rows, :3] += found.change.astype(np.float32)
        markers.velocity.assign(speed)
        return found.given

    def _close(
        self, dt: float, impulse: F64, reaction: F64, iterations: tuple[int, int], capped: int, excess: tuple[float, float]
    ) -> LiquidReport:
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
        return LiquidReport(
            dt=dt, impulse=impulse, reaction=reaction, added=added, removed=removed, iterations=iterations, capped=capped,
            density_error=excess,
        )  # fmt: skip

    def _fail(self) -> None:
        velocity = self.run.read(self.markers.velocity, self.markers.total)
        bad = int(np.flatnonzero(~np.isfinite(velocity).all(axis=1))[0])
        place = self._origin + self._cell * self.run.read(self.markers.position, self.markers.total)[bad, :3]
        raise EngineError(
            f"the grid liquid is no longer finite at t = {self.time:.4g} s: particle {self.markers.identity[bad]} near "
            f"({', '.join(f'{x:.3g}' for x in place)}) m; shorten max_step or lower cfl (now {self.settings.cfl:g})"
        )

    def _build_grid(self) -> Grid:
        """Sort the particles by column and lay columns of cells around them."""
        head = self.markers.sort(*self._shape[:2])
        return build(self.run, head, self.markers.position, self._shape, self._reach, self.solids.moving, self.gaps.free)

    def _to_faces(self, grid: Grid, dt: float) -> None:
        """Velocities of faces and densities of cells from the particles, after gravity."""
        wp, run, markers = warp(), self.run, self.markers
        nx, ny, _ = self._shape
        sums = run.array("sums/faces", grid.places * int(transfer.FACES), wp.vec4)
        weights = run.array("sums/centres", grid.places * int(transfer.CENTRES), wp.vec2)
        state = [markers.position, markers.velocity, markers.affine, int(markers.apic)]
        run(transfer.add_up, nx * ny, [ny, grid.head, grid.low, grid.room, *state, sums, weights], grain=64)
        kick = wp.vec3(*(float(g) * dt for g in self.setup.gravity))
        faces = [*self._faces(grid, "old", "weight"), *self._of(grid, "density"), *self._faces(grid, "new")]
        run(transfer.gather, nx * ny, [grid.columns, grid.low, grid.room, sums, weights, kick, *faces], grain=64)

    def _press(self, solver: multigrid.Solver, exchange: Exchange) -> multigrid.Solution:
        wp, run, rows = warp(), self.run, solver.rows
        bound = self.settings.pressure_error * self._cell / self._dt
        right, q = run.array("pressure_right", rows, wp.float32), run.array("q", rows, wp.float32)
        return solver(right, q, bound, self.settings.iterations, exchange.add)

    def _resist(self, grid: Grid, solver: multigrid.Solver, exchange: Exchange) -> Rubbed:
        """Viscosity between two projections: without the first, liquid at rest would rub against its walls as it begins to fall."""
        wp, run, total = warp(), self.run, grid.cells
        fine = solver.levels[0]
        wp.copy(run.array("kicked", total, wp.vec3), run.array("new", total, wp.vec3), count=total)
        run.array("push", fine.rows, wp.float32).zero_()
        self._project(grid, fine, exchange)
        run.swap("new", "new2")
        run.swap("pressure", "pressure/first")
        rubbed = self.viscosity.apply(grid, exchange, self.markers, fine.row, self._dt, 4 * self.settings.iterations)
        self._fill_rows(grid, fine)
        exchange.again(run.array("pressure_right", fine.rows, wp.float32), self._faces(grid, "new")[0])
        return rubbed

    def _correct(self, grid: Grid, solver: multigrid.Solver) -> tuple[multigrid.Solution, tuple[float, float]]:
        """Displacement potential that undoes compression; mean compression inside the liquid and the largest one."""
        wp, run, rows = warp(), self.run, solver.rows
        right, push = run.array("push_right", rows, wp.float32), run.array("push", rows, wp.float32)
        excess, (airy, inner) = run.array("excess", rows, wp.float32), (run.array(n, rows, wp.int32) for n in ("airy", "inner"))
        share, fine = self.settings.volume_correction, solver.levels[0]
        state = [run.array("cell", rows, wp.int32), *self._of(grid, "density", "spread"), fine.link, fine.coefficient, airy]
        state += [int(self.solids.count > 0), *self._of(grid, "solid")]
        run(cells.rate_density, rows, [*state, share, right, excess, inner])
        self.gaps.quiet(grid, fine.row, right, excess)
        found, within = run.read(excess, rows), run.read(inner, rows) == 1
        bounds = (float(found[within].mean()) if within.any() else 0.0, float(found.max(initial=0.0)))
        if share == 0.0:
            push.zero_()
            return multigrid.Solution(0, 0.0, False), bounds
        return solver(right, push, 10.0 * self.settings.pressure_error, self.settings.iterations), bounds

    def _project(self, grid: Grid, level: multigrid.Level, exchange: Exchange) -> None:
        """Velocities after pressure (`new2`) and those that move particles (`drift`)."""
        wp, run, total = warp(), self.run, grid.cells
        q, push = run.array("q", level.rows, wp.float32), run.array("push", level.rows, wp.float32)
        scales = [self._cell / self._dt, self._density * self._cell / self._dt]
        state = [grid.columns, grid.near, level.row, *self._of(grid, "phi"), *self._faces(grid, "opening"), self._owners(grid)]
        state.append(self._shut(grid, level))
        inside = [int(self.solids.count > 0), *self._of(grid, "solid")]
        after = [*self._faces(grid, "new2", "drift"), run.array("known", total, wp.vec3i), *self._of(grid, "pressure")]
        run(
            cells.project, total, [*state, exchange.walls, q, push, *inside, *scales, *self._faces(grid, "weight", "new"), *after]
        )

    def _finish(self, grid: Grid, level: multigrid.Level, exchange: Exchange, viscous: bool, ratio: float) -> F64:
        """Velocities extended beyond the liquid; the change of momentum that pressure and viscosity made."""
        wp, run, total = warp(), self.run, grid.cells
        self._project(grid, level, exchange)
        if viscous:
            run(thick.add, total, self._of(grid, "pressure/first", "pressure"), grain=65536)
        known = run.array("known", total, wp.vec3i)
        change = np.zeros(6)
        if self.solids.count:
            many = -(-total // run.block)
            sums = run.array("momentum/sums", many, exchanges.vec6d)
            state = [grid.columns, self._shut(grid, level)]
            speeds = self._faces(grid, "kicked" if viscous else "new", "new2")
            run(exchanges.momentum, many, [total, run.block, *state, *speeds, sums], grain=16)
            change = run.read(sums, many).sum(axis=0) * self._density * self._cell**3
            change[3:] *= self._cell
        run.swap("new", "new2")
        for least, mark in ((2, 3), (1, 4), (1, 5)):
            run(cells.extend, total, [grid.near, least, mark, known, *self._faces(grid, "new", "drift")])
        state = [grid.columns, grid.near, *self._box, self._sides, int(self.solids.count > 0), *self._of(grid, "solid")]
        state += [*self._faces(grid, "opening"), self._owners(grid), exchange.walls]
        state += [*self._faces(grid, "old"), ratio, int(viscous), self.viscosity.friction]
        run(walls.constrain, total, [*state, *self._faces(grid, "new", "drift", "new2", "drift2", "given")])
        (was,), moved = self._faces(grid, "old"), self._faces(grid, "new2", "drift2", "given")
        self.gaps.seal(grid, self._owners(grid), exchange.walls, was, ratio, moved)
        run.swap("new", "new2")
        run.swap("drift", "drift2")
        return np.asarray(change)

    def _advance(self, grid: Grid, exchange: Exchange, ratio: float) -> None:
        """Velocities and places of the particles."""
        wp, run, markers = warp(), self.run, self.markers
        n, way = markers.total, self._dt / self._cell
        left = run.array("left", n, wp.int32)
        fields = [grid.columns, *self._faces(grid, "given", "drift"), *self._of(grid, "pressure")]
        how = [ratio, int(markers.apic), way, float(self._reach - 1), *self._box, self._sides]
        run(transfer.advance, n, [*fields, *how, markers.position, markers.velocity, markers.affine, left])
        if self.solids.count:
            points = run.array("points", grid.cells, distances.vec8)
            state = [grid.columns, points, run.array("owner", grid.cells, wp.vec4i), exchange.path()]
            run(distances.push_out, n, [*state, way, *self._box, self._sides, markers.position, markers.velocity])

    def particles(self) -> Particles:
        """The marker particles, in the order of their cells."""
        return self.markers.particles()

    def checkpoint(self) -> bytes:
        """The full state; the engine itself continues from exactly these bytes."""
        travel = np.array([[mouth.travel, mouth.layers] for mouth in self.sources.mouths]).reshape(-1, 2)
        inflows = np.array([mouth.inflow.name for mouth in self.sources.mouths], dtype=str)
        clock = np.array([self.time, self._speed, self.volume])
        held = self.sources.stages.held
        return to_bytes({**self.markers.dump(), "clock": clock, "travel": travel, "inflows": inflows, "stage": held})

    def restore(self, state: bytes) -> None:
        """Continue from a checkpoint of the same liquid, or with inflows that this one lacks: they give nothing more.

        Raises:
            EngineError: the bytes are no checkpoint of this engine.
            ValueError: it is of another liquid.
        """
        found = from_bytes(state, ("position", "clock", "travel", "inflows", "stage"))
        travels = by_inflow(found["inflows"], found["travel"], self.setup.inflows)
        self.sources.stages.held[:] = by_inflow(found["inflows"], found["stage"], self.setup.inflows)
        self.markers.load(found)
        self.time, self._speed, self.volume = (float(value) for value in found["clock"])
        for mouth, (travel, layers) in zip(self.sources.mouths, travels, strict=True):
            mouth.travel, mouth.layers = float(travel), int(layers)

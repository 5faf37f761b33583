"""The particle engine: one step of divergence-free smoothed particle hydrodynamics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ....geometry.launch import chosen_device, warp
from ....worlds.arrays import F64
from ....worlds.errors import EngineError
from ...boundaries import BodyState
from ...passes import Pass, Passes
from ..blowing import Blowing
from ..engine import LiquidReport, LiquidSetup, Particles
from ..zones import Zones
from .bodies import Coupling
from .dissipation import Dissipation
from .flow import Mouth, Outlets, reasons
from .keep_out import KeepOut
from .pressure import PressureSolves
from .samples import sampled_boundaries
from .settings import DfsphSettings
from .state import pack, unpack
from .store import FIELDS, Store, Work, cells_of
from .tension import Tension
from .viscosity import Viscosity

__all__ = ["Dfsph"]

SUPPORT = 2.0
"""Support of the kernel in spacings."""
STEEPEST = 5.1
"""Largest slope of the cubic spline times the fourth power of its support."""
CELLS_PER_PARTICLE = 8
LEAST_CELLS = 1 << 16


PRESSED = 0.5
"""Pressure from which on walls bear a particle in full, in units of the weight of one spacing of liquid: what one on the floor under
another one has; drops and films on a wall have less and slide."""
RATTLE = 0.3
"""Longest step in spacings over the square root of pressure by density: particles under pressure swing between their neighbours at about
that rate, and swung up with 0.5 (measured on a column 80 spacings deep; with 0.3 it stands still)."""
EASING = 0.9
"""Least factor on that root in one step: a first solve that stops early must not lengthen the next step."""
PACKING_EVERY = 5
"""Steps between two looks at how the particles are packed."""
PACKING_SAMPLES = 2000
PACKING_RATE = 0.2
EVEN = 0.1
"""Largest unevenness of what counts as deep in the liquid; at a free surface it is about 1."""
LEAST_DEEP = 30
FULL_RANGE = (0.9, 1.02)
"""Fill of liquid at rest: 1 on a lattice, 0.94 when it has flowed."""


class Dfsph:
    """A liquid of particles (the `Engine` protocol).

    Args:
        setup: what does not change.
        settings: bounds of steps and errors.
    """

    def __init__(self, setup: LiquidSetup, settings: DfsphSettings | None = None) -> None:
        wp = warp()
        self.setup, self.settings = setup, settings or DfsphSettings()
        self.device = chosen_device(setup.device)
        self.origin: F64 = 0.5 * (np.asarray(setup.lower, dtype=float) + np.asarray(setup.upper, dtype=float))
        self.h = SUPPORT * setup.spacing
        self.time, self.steps, self.lost = 0.0, 0, 0
        self.full = 1.0
        self.store = Store(self.device, self._first())
        self.next_identity = self.store.count
        self.speed = float(np.sqrt((np.asarray(setup.velocity) ** 2).sum(axis=1).max(initial=0.0)))
        self.pressed = float(np.sqrt(np.ptp(setup.position @ np.asarray(setup.gravity)))) if self.store.count else 0.0
        """Square root of the largest pressure over density [m/s], were it linear as in liquid at rest; at first by the depth."""
        self.mouths = [Mouth(one, setup.spacing) for one in setup.inflows]
        self.layers = [0] * len(self.mouths)
        self.passes = Passes(self.device)
        most = max(LEAST_CELLS, CELLS_PER_PARTICLE * self.store.count)
        size = cells_of(setup.lower, setup.upper, self.h, most)
        self._cells = int(np.prod(size))
        lower, upper = (np.asarray(corner, dtype=float) - self.origin for corner in (setup.lower, setup.upper))
        self._grid = [wp.vec3(*(lower - self.h)), 1.0 / self.h, wp.vec3i(*size)]
        closed = [float(side == "closed") for side in setup.sides]
        self._sides = [wp.vec3(*lower), wp.vec3(*upper), wp.vec3(*closed[0::2]), wp.vec3(*closed[1::2])]
        self._density = wp.array([f.density for f in setup.fluids], dtype=wp.float32, device=self.device)
        self._gravity = wp.vec3(*(float(g) for g in setup.gravity))
        self._pressed = max(PRESSED * float(np.linalg.norm(setup.gravity)) * setup.spacing, 1e-9)
        self._outlets = Outlets(setup, self.origin, self.device)
        self.coupling = Coupling(setup, sampled_boundaries(setup), self.origin, self.passes, self._cells)
        self.keep_out = KeepOut(setup, self.origin, self.passes)
        self.tension = Tension(setup, self.passes)
        self.viscosity = Viscosity(setup, self._density, self.passes)
        self.dissipation = Dissipation(setup, self.passes)
        self.zones = Zones(setup, self.origin, self.device)
        self.blowing = Blowing(setup)
        self.solves = PressureSolves(self.passes, self.coupling, self.settings)
        self._work: Work | None = None
        self._sorted = 0
        self._leavers = 0

    def _first(self) -> dict[str, Any]:
        s, n = self.setup, len(self.setup.position)
        warmth = np.array([f.temperature for f in s.fluids])
        return {
            "x": np.asarray(s.position, dtype=float).reshape(n, 3) - self.origin,
            "v": np.asarray(s.velocity).reshape(n, 3),
            "identity": np.arange(n),
            "fluid": s.fluid,
            "volume": s.volume,
            "temperature": warmth[np.asarray(s.fluid, dtype=int)],
            "pressure": np.zeros(n),
            "push": np.zeros(n),
            "held": np.full(n, -1.0),
        }

    @property
    def work(self) -> Work:
        """Arrays of the step, with room for all particles."""
        if self._work is None or self._work.capacity < self.store.count:
            room = {"room": self._work.room} if self._work else {}
            largest = max(float(np.max(self.setup.volume, initial=0.0)), *(m.volume for m in self.mouths), 0.0)
            steepest = largest * STEEPEST / self.h**4
            self._work = Work(self.passes, self.store.capacity, self._cells, steepest=steepest, **room)
            self._sorted = 0
        return self._work

    def stable_dt(self) -> float:
        """Largest stable step in the present state [s]."""
        return self._stable(self.speed)

    def _stable(self, speed: float) -> float:
        reach = self.settings.cfl * self.setup.spacing
        fall = float(np.linalg.norm(self.setup.gravity))
        dt = min(self.settings.max_step, self.tension.longest)
        if self.pressed > 0:
            dt = min(dt, RATTLE * self.setup.spacing / self.pressed)
        if speed > 0 or fall > 0:  # (speed + fall dt) dt <= reach
            dt = min(dt, 2.0 * reach / (speed + float(np.sqrt(speed**2 + 4.0 * fall * reach))))
        return dt

    def step(self, limit: float, bodies: BodyState) -> LiquidReport:
        """One step of at most `limit` seconds, with bodies as they are at its start; shorter where that makes the steps to `limit` equal.

        Were it as long as it may be, what is left of a frame could be any part of that, a microsecond too. What happens in so short a
        step counts as a thousandfold pressure, and as a millionfold acceleration of bodies that touch; the steps after it pay for that.
        """
        from . import step_kernels as kernels

        added = self._let_in()
        stable = min(self._stable(self.speed), self._stable(self.coupling.fastest(bodies)))
        dt = limit / max(1, math.ceil(limit / min(stable, self.coupling.soft.longest(bodies)) - 1e-6))
        w, n = self.work, self.store.count
        w.put(DT=dt, COUNT=max(n, 1), BETA=0.0, NESTEROV=1.0, ERROR=0.0, OMEGA=0.0, TIME=self.time, FULL=self.full)
        w.send()
        if n == 0:
            self.time += dt
            self.steps += 1
            none = {row: np.zeros((len(ease), 3)) for row, ease in bodies.vertex_lightness.items()}
            given, taken = self.coupling.wrenches()
            return LiquidReport(dt=dt, impulse=given, reaction=taken, added=added, vertex_impulse=none)
        self._meet(w, bodies, n, dt)
        s, run = self.store.now, self.passes
        driven, blown, thin = self._accelerate(s, w, bodies, n, dt)
        self.solves.solve(w, s, n, density=False)
        self.solves.solve(w, s, n, density=True)
        self.keep_out.apply(w, s, self.coupling, n)
        run("travel", kernels.travel, n, [w.way, w.settings, s.x])()
        margin = self.setup.spacing
        run(
            "leave",
            kernels.leave,
            n,
            [s.x, *self._sides, margin, len(self.setup.outflows), self._outlets.boxes(s, n), w.leaving],
        )()
        error = self._census(w)
        spread, pressed = self.solves.ended(w)
        self.time += dt
        self.steps += 1
        given, taken = self.coupling.wrenches()
        capped = int(pressed.capped) + int(spread.capped) + int(not thin)
        return LiquidReport(
            dt=dt, impulse=given, reaction=taken, added=added, removed=self._let_out(w),
            vertex_impulse=self.coupling.soft.given(given, dt), iterations=(pressed.iterations, spread.iterations), capped=capped,
            density_error=error, driven=driven, blown=blown,
        )  # fmt: skip

    def _meet(self, w: Work, bodies: BodyState, n: int, dt: float) -> None:
        """Bring particles into order and find who is near whom, bodies too.

        A GPU works on the particles' lists while the host prepares the bodies; it waits for both together.
        """
        self._sort(w)
        self._search(w)
        self.coupling.begin(bodies, self._grid, dt)
        self.keep_out.place(self.coupling)
        s = self.store.now
        self.coupling.count_pairs(w, s.x, s.volume, self.h, n)
        most, self.coupling.total = (int(one) for one in w.most.numpy())
        if most > w.room:
            w.grow(8 * (-(-(most + 4) // 8)))
            self._search(w)
        self._walls(w)
        if self.steps % PACKING_EVERY == 0:
            self._measure_packing(w)
        self.coupling.meet(w, w.lift, self.keep_out.surfaces, self.h)

    def _accelerate(self, s: Any, w: Work, bodies: BodyState, n: int, dt: float) -> tuple[F64, F64, bool]:
        """Everything but pressure acts; what zones of waves and fields gave, each (4,), and whether viscosity was solved for."""
        from . import step_kernels as kernels

        run, pull = self.passes, [s.x, s.volume, w.lightness, s.v]
        driven = self.zones.pull(lambda k, many, of: run("zones", k, many, of)(), "pull_particles", n, pull, self.time, dt)
        blown = self._blow(s, w, bodies, n, dt)
        run("fall", kernels.fall, n, [w.lightness, self._gravity, w.settings, s.v])()
        self.tension.apply(w, s, self.coupling, self._grid, self._sides, self.h, n)
        self.coupling.advance()
        self.coupling.bear(s.v)
        thin = self.viscosity.apply(
            w, s, self.coupling, self.h, n, dt, tolerance=self.settings.viscosity_error, most=self.settings.iterations
        )
        self.viscosity.conduct(w, s, self.h, n, dt)
        self.dissipation.apply(w, s, n, dt)
        self.coupling.soft.kick()
        return driven, blown, thin

    def _blow(self, s: Any, w: Work, bodies: BodyState, n: int, dt: float) -> F64:
        """Let force fields act on the particles; momentum and energy that they gave, (4,)."""
        if not self.blowing.acts(self.time, dt):
            return np.zeros(4)
        place, v = s.x.numpy()[:n].astype(np.float64) + self.origin, s.v.numpy().copy()
        volume, fluid = s.volume.numpy()[:n].astype(np.float64), s.fluid.numpy()[:n].astype(np.int64)
        free = (w.lightness.numpy()[:n] > 0).astype(np.float64)
        found = self.blowing.kick(place, v[:n].astype(np.float64), volume, fluid, free, bodies, self.time, dt)
        v[:n] += found.change.astype(np.float32)
        s.v.assign(v)
        return found.given

    def _sort(self, w: Work) -> None:
        """Bring the particles into the order of their cells; those that leave are dropped."""
        from . import grid_kernels as kernels

        s, n = self.store, self.store.count
        if self._sorted:
            self.passes("clear", kernels.clear_spans, self._sorted, [w.key, w.span])()
        else:
            w.span.zero_()
            w.leaving.zero_()
        self.passes("keys", kernels.keys, n, [s.now.x, w.leaving, *self._grid, w.key, w.index])()
        warp().utils.radix_sort_pairs(w.key, w.index, n)
        self.passes("reorder", kernels.reorder, n, [w.index, s.now, s.spare])()
        s.swap()
        self.passes("spans", kernels.spans, n, [n, w.key, w.span])()
        self._sorted = n

    def _search(self, w: Work) -> None:
        """List neighbours; the longest list is the first of `w.most`."""
        from . import grid_kernels, step_kernels

        s, n, run = self.store.now, self.store.count, self.passes
        run(
            "lighten",
            step_kernels.lighten,
            n,
            [s.fluid, s.held, self._density, w.settings, s.pressure, self._gravity, self._pressed, w.lightness, w.lift],
        )()
        lists = [w.room, *w.lists, w.fill, w.lean, w.stiffness]
        run("search", grid_kernels.search, n, [s.x, s.volume, w.lightness, w.span, *self._grid, self.h, *lists])()
        for one in run.seek_greatest("most", w.count, n, w.longest, w.most):
            one()

    def _walls(self, w: Work) -> None:
        """Add the closed sides of the domain."""
        from . import domain_kernels

        s, n = self.store.now, self.store.count
        walls = [s.x, *self._sides, self.setup.spacing, self.h, w.fill, w.lean, w.lift, w.borne]
        self.passes("walls", domain_kernels.walls, n, walls)()

    def _let_in(self) -> dict[str, float]:
        """Add the layers of inflows that are due."""
        added: dict[str, float] = {}
        new: list[dict[str, Any]] = []
        for k, mouth in enumerate(self.mouths):
            fluid = self.setup.fluids[mouth.inflow.fluid]
            for place, held in mouth.layers(self.layers[k], self.time):
                n = len(place)
                new.append(
                    {
                        "x": place - self.origin,
                        "v": np.tile(mouth.inflow.speed * mouth.normal, (n, 1)),
                        "identity": self.next_identity + np.arange(n),
                        "fluid": np.full(n, mouth.inflow.fluid),
                        "volume": np.full(n, mouth.volume),
                        "temperature": np.full(n, fluid.temperature),
                        "pressure": np.zeros(n),
                        "push": np.zeros(n),
                        "held": np.full(n, held),
                    }
                )
                self.next_identity += n
                self.layers[k] += 1
                added[mouth.inflow.name] = added.get(mouth.inflow.name, 0.0) + n * mouth.volume * fluid.density
                self.speed = max(self.speed, mouth.inflow.speed)
        if new:
            self.store.append({name: np.concatenate([one[name] for one in new]) for name in FIELDS})
        return added

    def _let_out(self, w: Work) -> dict[str, float]:
        """Take away what left, and sum its mass by the way it took."""
        from .grid_kernels import GONE

        gone, self._leavers = self._leavers, 0
        if not gone:
            return {}
        self._sort(w)
        w.leaving.zero_()
        n = self.store.count
        code = GONE - w.key[n - gone : n].numpy()
        old = self.store.drop(gone)
        mass = old["volume"].astype(float) * np.array([f.density for f in self.setup.fluids])[old["fluid"]]
        names = reasons(self.setup)
        self.lost += int((code == names.index("lost")).sum())
        return {names[c]: float(mass[code == c].sum()) for c in np.unique(code)}

    def _measure_packing(self, w: Work) -> None:
        """Follow the fill of liquid at rest: that of particles deep in the liquid over the liquid that truly lies around them."""
        from . import step_kernels as kernels

        s, n = self.store.now, self.store.count
        step = max(1, n // PACKING_SAMPLES)
        samples = n // step
        wp = warp()
        out = wp.zeros(samples, dtype=wp.vec3, device=self.device)
        inputs = [step, s.x, s.volume, w.span, *self._grid, *self._sides[:2], self.h, w.fill, out]
        Pass(kernels.packing, samples, inputs, self.device)()
        dense, uneven, fill = out.numpy().astype(float).T
        deep = (uneven < EVEN) & (dense > 0.8)
        if deep.sum() >= LEAST_DEEP:
            found = float(np.clip(fill[deep].mean() / dense[deep].mean(), *FULL_RANGE))
            self.full += PACKING_RATE * (found - self.full)
            w.put(FULL=self.full)
            w.send()

    def _census(self, w: Work) -> tuple[float, float]:
        """Mean and largest compression, on the positions that the step started from; the largest speed; who leaves."""
        from . import step_kernels as kernels

        s, n = self.store.now, self.store.count
        self.passes.fold(
            "census", kernels.census, n, [s.x, s.v, s.pressure, w.lightness, w.fill, w.leaving, w.settings, w.tallies]
        )()
        self.passes.close("close_census", kernels.close_census, n, [w.tallies, w.tally])()
        total, worst, fastest, wrong, leavers, pushed = (float(one) for one in w.tally.numpy()[0])
        if wrong >= 0:
            i = int(wrong)
            where = ", ".join(f"{c:.4g}" for c in s.x[i : i + 1].numpy()[0] + self.origin)
            raise EngineError(
                f"step {self.steps} of the liquid at {self.time:.4f} s: particle {int(s.identity[i : i + 1].numpy()[0])} at ({where}) m "
                "has no finite velocity; use a shorter max_step or a finer resolution"
            )
        self.speed = float(np.sqrt(fastest))
        self.pressed = max(float((3.0 * pushed / n) ** 0.25), EASING * self.pressed)
        self._leavers = int(leavers)
        return total / n, worst

    def particles(self) -> Particles:
        """Copies of the present state; density and pressure are those of the last step."""
        c, n = self.store.columns(), self.store.count
        rest = np.array([f.density for f in self.setup.fluids])[c["fluid"]]
        known = self._work is not None and self._sorted == n
        fill = self._work.fill[:n].numpy().astype(float) if known and self._work is not None else np.ones(n)
        return Particles(
            c["x"].astype(float) + self.origin,
            c["v"].astype(float),
            c["identity"],
            c["fluid"],
            c["volume"].astype(float),
            fill / self.full * rest,
            np.maximum(c["pressure"].astype(float) - self.tension.inner[c["fluid"]], 0.0),
            c["temperature"].astype(float),
        )

    def checkpoint(self) -> bytes:
        """The full state; the engine itself continues from exactly these bytes."""
        return pack(self)

    def restore(self, state: bytes) -> None:
        """Continue from a checkpoint."""
        unpack(self, state)
        self._sorted = 0

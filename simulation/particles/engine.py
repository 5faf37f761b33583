"""Grains: steps of Hertz-Mindlin contacts with histories, on a CPU or a GPU. method.md has scheme and sources."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...geometry.launch import chosen_device, warp
from ...physics.grains import rayleigh_time
from ...worlds.arrays import F64
from ...worlds.errors import EngineError
from ..boundaries import BodyState
from ..passes import ALONE, Passes
from .lists import FIELDS, Buffer
from .setup import GrainReport, GrainSetup, law_of, wall_law
from .walls import Walls

__all__ = ["Grains"]

SKIN = 0.3
"""Share of the mean radius by which lists reach farther than contact."""
USED = 0.4
"""Share of the skin: the way of a grain or of a surface after which lists are made anew."""
TRAVEL = 0.09
"""Share of the skin: the longest way of a grain in one step."""
COLLISION = 20.0
"""Steps in which the fastest grain's collision with its like is resolved, at least."""
BATCH = 8
"""Steps that queue up before the device is asked."""
SPREAD = 4.0
"""Places reach so many half extents of the domain."""
LEAST_CELLS = 4096
CELLS_PER_GRAIN = 4


class Grains:
    """All grains of one instance."""

    def __init__(self, setup: GrainSetup) -> None:
        from . import grain_kernels, law_kernels

        wp = warp()
        law_type: Any = law_kernels.Law
        self._clock_type: Any = grain_kernels.Clock
        self.setup = setup
        self.device = chosen_device(setup.device)
        self.passes = Passes(self.device)
        self.origin = 0.5 * (np.asarray(setup.lower, dtype=float) + np.asarray(setup.upper, dtype=float))
        half = 0.5 * float(np.max(np.asarray(setup.upper) - np.asarray(setup.lower)))
        self.unit = SPREAD * half / 2.0**31
        self.time = 0.0
        self.count = len(setup.radius)
        radius = np.asarray(setup.radius, dtype=np.float64)
        self.skin = SKIN * float(radius.mean()) if self.count else 1.0
        self.largest, self.smallest = (float(f(radius)) if self.count else 1.0 for f in (np.max, np.min))
        self.speed = float(np.sqrt((np.asarray(setup.velocity) ** 2).sum(axis=1).max(initial=0.0)))
        self._density = np.array([k.density for k in setup.kinds])
        self.walls = Walls(setup, self.origin, self.device)
        capacity = max(self.count, 1)
        self.now, self.spare = Buffer(self.device, capacity), Buffer(self.device, capacity)
        self._grid(capacity)
        laws = np.zeros((len(setup.kinds), len(setup.kinds)), dtype=law_type.numpy_dtype())
        for a, one in enumerate(setup.kinds):
            for b, two in enumerate(setup.kinds):
                laws[a, b] = _row(setup.pairs.get((min(a, b), max(a, b))) or law_of(one, two))
        self.laws = wp.array(laws, dtype=law_type, device=self.device)
        self.rolls = int(any(k.rolling > 0 for k in setup.kinds))
        rows = np.zeros((max(len(setup.boundaries), 1), len(setup.kinds)), dtype=law_type.numpy_dtype())
        for b, boundary in enumerate(setup.boundaries):
            for k, kind in enumerate(setup.kinds):
                rows[b, k] = _row(
                    setup.walls.get((b, k)) or wall_law(kind, max(boundary.friction, kind.friction), kind.restitution)
                )
        self.wall_laws = wp.array(rows, dtype=law_type, device=self.device)
        self._densities = wp.array(self._density.astype(np.float32), dtype=wp.float32, device=self.device)
        self.dt = wp.zeros(1, dtype=wp.float32, device=self.device)
        self._clock = wp.zeros(1, dtype=self._clock_type, device=self.device)
        self.force, self.torque = (wp.zeros(capacity, dtype=wp.vec3d, device=self.device) for _ in range(2))
        parts = self.passes.parts(capacity)
        self._partial = wp.zeros((3, parts), dtype=wp.float32, device=self.device)
        self._result = wp.zeros(3, dtype=wp.float32, device=self.device)
        self._counts = wp.zeros(parts, dtype=wp.int32, device=self.device)
        self._most = wp.zeros(1, dtype=wp.int32, device=self.device)
        self._key, self._index = (wp.zeros(2 * capacity, dtype=wp.int32, device=self.device) for _ in range(2))
        self._fresh = False
        self._known = False
        self._sorted = 0
        self._blows = 0
        self.left = np.zeros(5)
        self.blown_at: tuple[Any, F64] = (np.zeros(0, np.int32), np.zeros((0, 3)))
        """Identities of grains, and what fields gave them in the last exchange [N s]."""
        self.rebuilds = 0
        self._take_first()

    def _grid(self, capacity: int) -> None:
        wp = warp()
        self._size = 2.0 * self.largest + self.skin
        extent = np.asarray(self.setup.upper) - np.asarray(self.setup.lower)
        size = [max(3, math.ceil(float(e) / self._size) + 1) for e in extent]
        most = max(LEAST_CELLS, CELLS_PER_GRAIN * capacity)
        while math.prod(size) > most and max(size) > 3:
            longest = size.index(max(size))
            size[longest] = max(3, (size[longest] + 1) // 2)
        low, high = (
            np.round((np.asarray(c) - self.origin) / self.unit).astype(int) for c in (self.setup.lower, self.setup.upper)
        )
        self._low, self._high = wp.vec3i(*map(int, low)), wp.vec3i(*map(int, high))
        self._shift = self.unit / self._size
        self._cells = wp.vec3i(*size)
        self._span = wp.zeros(math.prod(size), dtype=wp.vec2i, device=self.device)

    def _take_first(self) -> None:
        s, n = self.setup, self.count
        self.take(np.asarray(s.position, dtype=float), np.asarray(s.velocity), np.zeros((n, 3)), s.radius, s.kind, np.arange(n))

    def take(self, position: F64, velocity: F64, spin: F64, radius: Any, kind: Any, identity: Any) -> None:
        """Take these grains; nothing is known of their contacts."""
        n = self.count = len(radius)
        place = np.zeros((n, 4), dtype=np.int32)
        exact = (position - self.origin) / self.unit
        place[:, :3] = np.round(exact)
        place[:, 3] = np.asarray(radius, dtype=np.float32).view(np.int32)
        motion = np.zeros((n, 4), dtype=np.float32)
        motion[:, :3] = velocity
        motion[:, 3] = np.asarray(kind, dtype=np.int32).view(np.float32)
        columns = {name: np.zeros((n, width) if width > 1 else n, dtype=dtype) for name, (_, dtype, width) in FIELDS.items()}
        columns |= {"place": place, "motion": motion, "spin": spin, "identity": identity, "left": exact - place[:, :3]}
        columns["rest"] = velocity - motion[:, :3]
        self.now.assign(columns)
        self._fresh = self._known = False

    # ------------------------------------------------------------------ steps

    def stable_dt(self, speed: float | None = None) -> float:
        """Longest stable step at a speed [m/s] (default: the fastest grain's) [s]."""
        fastest = max(self.speed if speed is None else speed, 1e-3)
        longest = math.inf
        for kind in self.setup.kinds:
            r = self.smallest
            rayleigh = rayleigh_time(r, kind.density, kind.young, kind.poisson)
            mass = 2.0 / 3.0 * math.pi * kind.density * r**3
            young = 0.5 * kind.young / (1 - kind.poisson**2)
            collision = 2.87 * (mass**2 / (0.5 * r * young**2 * fastest)) ** 0.2
            longest = min(longest, self.setup.step_share * rayleigh, collision / COLLISION)
        return min(longest, TRAVEL * self.skin / fastest)

    def set_air(self, velocity: F64, rate: F64, pull: F64) -> None:
        """Medium and accelerations at the grains in their present order, until told anew.

        Args:
            velocity: of the medium (n, 3) [m/s].
            rate: of its drag (n,) [1/s].
            pull: acceleration (n, 3) [m/s^2].
        """
        n = self.count
        if n:
            self.now.state.air[:n].assign(np.column_stack([velocity, rate]).astype(np.float32))
            self.now.state.pull[:n].assign(np.asarray(pull, dtype=np.float32))
        self._blows = 1

    def step(self, seconds: float, bodies: BodyState | None = None) -> GrainReport:
        """Go on by `seconds`, in as many steps as it takes, with bodies as they are at its start; free ones give way.

        Raises:
            EngineError: a grain has no finite velocity any more.
        """
        fastest = self.walls.begin(bodies)
        self.left = np.zeros(5)
        done, speed = 0, 0.0
        remaining, taken = seconds, 0
        while self.count and remaining > 1e-12 * seconds:
            bound = max(self.speed, fastest) + 1e-2 * math.sqrt(9.81 * self.smallest)
            steps = max(1, math.ceil(remaining / self.stable_dt(bound) * (1 - 1e-9)))
            dt = remaining / steps
            self.dt.fill_(dt)
            if not self._fresh:
                self._make_lists()
                if not self.count:
                    break
            batch = BATCH if steps >= BATCH else 1
            done = self._run(batch)
            taken += done
            remaining = 0.0 if done == steps else remaining - done * dt
            speed = max(speed, self.speed)
        self.time += seconds
        impulse = self.walls.end()
        reaction = self.walls.taken(self.passes, self.now)
        blown, work = self._blown()
        return GrainReport(
            dt=seconds, impulse=impulse, reaction=reaction[:, :6], vertex_impulse=self.walls.soft.given(), steps=taken, fastest=speed,
            blown=blown, work=work, wall_work=float(reaction[:, 6].sum()), left=self.left,
        )  # fmt: skip

    def _run(self, batch: int) -> int:
        """Queue steps; how many were done before the lists were used up."""
        from . import grain_kernels as kernels

        now, run, n = self.now, self.passes, self.count
        clock: Any = np.zeros(1, dtype=self._clock_type.numpy_dtype())
        clock["wrong"] = -1
        self._clock.assign(clock)
        unit, steps = float(self.unit), []
        contacts = [
            now.state, now.count, now.near, now.spring, now.roll, now.row, now.stride, self.laws, self._densities, unit, self.dt,
            self._clock, self.rolls, self.force, self.torque,
        ]  # fmt: skip
        steps.append(run("forces", kernels.forces, n, contacts))
        steps += self.walls.passes(run, now, self.wall_laws, self._densities, self.unit, self.dt, self._clock)
        p = now.pairs
        gravity = warp().vec3d(*map(float, self.setup.gravity))
        motion = [
            now.state, self.force, self.torque, now.wall_first, now.wall_count, now.at, p.force, p.torque, self._densities,
            self._kept("gravity", gravity), unit, self.dt, self._clock, self._blows,
        ]  # fmt: skip
        steps.append(run("integrate", kernels.integrate, n, motion))
        steps += self.walls.moves(run, now, self.dt, self._clock)
        steps.append(run.fold("census", kernels.census, n, [now.state, unit, self._clock, self._partial]))
        steps.append(run.close("close_census", kernels.close_census, n, [self._partial, self._result]))
        most = (USED * self.skin) ** 2
        steps.append(run("tick", kernels.tick, 1, [self._result, self.walls.drift, most, self._clock], smallest=ALONE))
        run.chain(f"batch_{batch}", steps * batch)()
        found = self._clock.numpy()[0]
        if found["wrong"] >= 0:
            where = self.positions()[int(found["wrong"])]
            raise EngineError(
                f"a grain at ({', '.join(f'{c:.4g}' for c in where)}) m has no finite velocity at {self.time:.4f} s; lower step_share"
            )
        self.speed = float(np.sqrt(found["speed"]))
        self._fresh = not found["stop"]
        return int(found["done"])

    def _kept(self, name: str, value: Any) -> Any:
        """The same object at every call, so that passes know their arguments again."""
        return self.__dict__.setdefault("_constants", {}).setdefault(name, value)

    # ------------------------------------------------------------------ lists

    def _make_lists(self) -> None:
        """Sort the grains by cells and list who may meet whom; what has left the domain goes."""
        from . import list_kernels as kernels

        wp, run = warp(), self.passes
        old, new, n = self.now, self.spare, self.count
        self.walls.settle(run, old)
        if self._sorted:
            run("clear", kernels.clear_spans, self._sorted, [self._key, self._span])()
        else:
            self._span.zero_()
        grid = [self._low, self._shift, self._cells]
        run("keys", kernels.keys, n, [old.state, self._low, self._high, self._shift, self._cells, self._key, self._index])()
        wp.utils.radix_sort_pairs(self._key, self._index, n)
        run("reorder", kernels.reorder, n, [self._index, old.state, new.state])()
        self._sorted = n
        gone = self._gone(n)
        if gone:
            self._drop(new, n - gone, n)
            n = self.count = n - gone
        self.now, self.spare = new, old
        if not n:
            return
        run("spans", kernels.spans, n, [n, self._key, self._span])()
        old_row = old.row if self._known else 0
        while True:
            inputs = [
                new.state, self._span, *grid, float(self.unit), self.skin, self._index, old.count, old.near, old.spring, old.roll,
                old_row, old.stride, self.rolls, new.room, new.row, new.stride, new.count, new.near, new.spring, new.roll,
            ]  # fmt: skip
            run("search", kernels.search, n, inputs)()
            most = self.greatest(new.count, n)
            if most <= new.room:
                break
            new.grow(4 * (-(-(most + 2) // 4)))
        self.walls.list_pairs(self, old, new, known=self._known)
        self._fresh = self._known = True
        self.rebuilds += 1

    def greatest(self, counts: Any, n: int) -> int:
        """The greatest of the first n counts."""
        return self.passes.greatest("most", counts, n, self._counts, self._most)

    def _gone(self, n: int) -> int:
        """Number of grains that have left; they sort last."""
        from .list_kernels import GONE

        if int(self._key[n - 1 : n].numpy()[0]) != GONE:
            return 0
        return int((self._key[:n].numpy() == GONE).sum())

    def _drop(self, buffer: Buffer, first: int, end: int) -> None:
        place, motion = (getattr(buffer.state, k)[first:end].numpy() for k in ("place", "motion"))
        mass = self._masses(place, motion)
        self.left += [len(mass), mass.sum(), *(mass @ motion[:, :3].astype(float))]

    # ------------------------------------------------------------------ state

    @property
    def listed(self) -> bool:
        """True if lists of contacts are there."""
        return self._known

    def forget_lists(self) -> None:
        """Make the lists anew before the next step, from the contacts that the present ones hold."""
        self._fresh, self._known, self._sorted = False, True, 0
        self.walls.span.zero_()

    def checkpoint(self) -> bytes:
        """The full state; the engine itself continues from exactly these bytes."""
        from .state import pack

        return pack(self)

    def restore(self, state: bytes) -> None:
        """Continue from a checkpoint."""
        from .state import unpack

        unpack(self, state)

    def push(self, velocity: F64) -> None:
        """Add velocities to the grains in the order of their identities [m/s], shape (n, 3)."""
        c = self.now.columns(self.count)
        total = c["motion"][:, :3].astype(float) + c["rest"] + velocity[c["identity"]]
        c["motion"][:, :3] = total
        c["rest"] = total - c["motion"][:, :3]
        self.now.assign(c)
        self.speed = float(np.sqrt((total**2).sum(axis=1).max(initial=0.0)))

    def _masses(self, place: Any, motion: Any) -> F64:
        radius = np.ascontiguousarray(place[:, 3]).view(np.float32).astype(float)
        kind = np.ascontiguousarray(motion[:, 3]).view(np.int32)
        result: F64 = 4.0 / 3.0 * np.pi * self._density[kind] * radius**3
        return result

    def _blown(self) -> tuple[F64, float]:
        """Impulse of fields since the exchange began, and their work by the velocities at its end less half of what they gave."""
        if not self._blows or not self.count:
            return np.zeros((len(self._density), 3)), 0.0
        n = self.count
        state = self.now.state
        place, motion, blown = (getattr(state, k)[:n].numpy() for k in ("place", "motion", "blown"))
        impulse = self._masses(place, motion)[:, None] * blown.astype(float)
        work = float((impulse * (motion[:, :3] - 0.5 * blown)).sum())
        state.blown.zero_()
        kind = np.ascontiguousarray(motion[:, 3]).view(np.int32)
        total: F64 = np.zeros((len(self._density), 3))
        np.add.at(total, kind, impulse)
        self.blown_at = state.identity[:n].numpy().copy(), impulse
        return total, work

    def positions(self) -> F64:
        """Positions of the grains in their present order [m], shape (n, 3)."""
        c = self.now.columns(self.count)
        result: F64 = (c["place"][:, :3].astype(float) + c["left"]) * self.unit + self.origin
        return result

    def columns(self) -> dict[str, Any]:
        """The present state: position, velocity, spin, radius, kind, identity, mass."""
        c = self.now.columns(self.count)
        return {
            "position": (c["place"][:, :3].astype(float) + c["left"]) * self.unit + self.origin,
            "velocity": c["motion"][:, :3].astype(float) + c["rest"],
            "spin": c["spin"].astype(float) + c["rest_spin"],
            "radius": np.ascontiguousarray(c["place"][:, 3]).view(np.float32).astype(float),
            "kind": np.ascontiguousarray(c["motion"][:, 3]).view(np.int32).copy(),
            "identity": c["identity"],
            "mass": self._masses(c["place"], c["motion"]),
        }


def _row(law: Any) -> tuple[float, ...]:
    return (law.young, law.shear, law.damping, law.friction, law.rolling, law.pull)

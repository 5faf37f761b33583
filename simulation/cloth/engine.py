"""The cloth engine: sheets with real stiffness, contacts by impulses, and nothing that crosses."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64
from ...worlds.errors import EngineError
from ..sealed import from_bytes, to_bytes
from . import bound_kernels as bounds
from . import step_kernels as steps
from .batches import Batches
from .contacts import Contacts
from .folds import Folds, OutranError
from .forces import ClothForces
from .grips import Grips
from .near_lists import Surfaces
from .pace import fastest_point, stiffened, stiffening, stretched
from .setup import ClothReport, ClothSetup
from .soft_solids import Patience
from .stability import highest_frequency, longest_step
from .strides import Strides

if TYPE_CHECKING:
    from ..boundaries import BodyState

__all__ = ["Cloth"]

BREATH = 1e-3
"""Longest time over which explicit steps take the air as it was [s]."""

SAFE = 0.9
"""Share of the longest stable step that is taken: a sheet is stiffer where it is bent or squeezed."""
DAMPED = 0.03
"""Least damping of a sheet that may meet something, times its highest frequency: contacts in folds feed its highest swings, whose steps
are near the limit. Measured: without, a sheet thrown down gained three times the energy that was left."""
QUICK = 0.2
"""Share of what vertices may move between two searches for contacts that one may move in a step."""
CATCH = 0.3
"""Share of the distance of contact that a solid may move in a step."""
HALVINGS = 6
"""Most times that explicit steps are taken again, half as long, where a vertex outran the search for contacts: what slips off an edge under
tension, or is struck, moves at once many times as fast as anything moved when the step was chosen."""
STIFFENING = 4
"""Calls between two looks at how much stretch stiffens the sheets."""


class Cloth(ClothForces):
    """Sheets of one instance.

    Args:
        setup: what does not change.
    """

    def __init__(self, setup: ClothSetup) -> None:
        highest = [highest_frequency(s) for s in setup.sheets]
        if setup.self_collision or any(len(b.mesh.faces) for b in setup.boundaries):
            sheets = tuple(s.damped(DAMPED / f) for s, f in zip(setup.sheets, highest, strict=True))
            setup = replace(setup, sheets=sheets)
        super().__init__(setup)
        beta = max(float(s.modulus[:, 3].max()) for s in setup.sheets)
        self.longest = min(SAFE * min(longest_step(f, beta) for f in highest), setup.max_step)
        self.contacts = self._make_contacts(setup)
        self.folds: Folds | None = None
        if self.device == "cpu" and self.contacts.active:
            self.folds = Folds(self, self.contacts, self.forces, self.carry if self.carries else None)
        self.batches = None if self.device == "cpu" else Batches(self, self.contacts)
        self._strides = Strides(self) if setup.integrator == "implicit" and self.device == "cpu" else None
        self.grips = Grips(self, self._strides) if self._strides is not None and not self._soft.rows else None
        self.time, self.steps_done = 0.0, 0
        self._known = False
        self._patience = Patience(setup.exchange, max(setup.shell))
        self._last_span = 0.0
        self._looks, self._stiffness = 0, 1.0

    def _make_contacts(self, setup: ClothSetup) -> Contacts:
        state = {
            "x": self.x, "u": self.u, "v": self.v, "inverse": self.inverse, "mass": self.masses, "radius": self._radius,
            "clock": self.clock, "center": self._center, "velocity": self._velocity,
            "held": self._array(self.held, warp().int32), "reaction": self.reaction,
        }  # fmt: skip
        shell = max(setup.shell)
        surfaces = Surfaces(self.faces, self.n, self.solid_faces, self.solid_body, self.holder, self._kin(setup))
        friction = np.asarray(setup.friction, dtype=np.float64)
        return Contacts(
            self.passes, state, surfaces, friction, shortest=min(float(s.edge_length.min()) for s in setup.sheets),
            touch=(2 * shell, shell), setup=setup, soft=bool(self._soft.rows),
        )  # fmt: skip

    # ------------------------------------------------------------------ step

    def stable_dt(self) -> float:
        """Longest time that one call of `step` takes [s]."""
        return self.setup.exchange

    def place_solids(self, bodies: BodyState) -> None:
        """Put every solid's vertices where its body is."""
        super().place_solids(bodies)
        self._known = True
        self.contacts.fresh = False

    def step(self, limit: float, bodies: BodyState, time: float) -> ClothReport:
        """Go on for at most `limit` seconds, with bodies that go on as they move at its start.

        Raises:
            EngineError: a vertex moved further in one step than the search for contacts allows, however short the step.
        """
        if not self._known:
            self.place_solids(bodies)
        if self._soft.rows and bodies.vertex_lightness and self._last_span:
            self._patience.learn(self._last_span, self._soft.missed(bodies, self.x.numpy()[self.n :]))
        longest = min(self.setup.exchange, self.setup.max_step)
        if self._soft.rows and bodies.vertex_lightness:
            longest = min(longest, self._patience.seconds)
        span = limit / max(1, math.ceil(limit / longest - 1e-6))
        self._last_span = span
        self._take_bodies(bodies, span)
        if self.batches is None:
            self.clock.assign(np.array([0.0, 0.0, float(self.clock.numpy()[2])]))
        solid_speed = fastest_point(self.setup.boundaries, self.solid_place, self.solid_row, bodies)
        if self._soft.rows:
            solid_speed = max(solid_speed, self._soft.fastest(self.u.numpy()[self.n :]))
        start, air = self.x.numpy()[: self.n].copy(), np.zeros(4)
        total, count = np.zeros((len(self.setup.boundaries), 6)), 0
        if self._strides is not None and self._strides.take(span, time, solid_speed, air):
            count = 1
        else:
            done = 0.0
            if self.grips is not None and self.contacts.active:
                total, count, done = self.grips.run(span, time, solid_speed, air)
            if done < span - 1e-12:
                parts = max(1, math.ceil((span - done) / BREATH - 1e-6))
                each = (span - done) / parts
                for k in range(parts):
                    if self.batches is not None:
                        given, steps_taken = self._short_in_batches(self.batches, each, k * each, time + k * each, solid_speed)
                    else:
                        given, steps_taken = self._short(each, time + done + k * each, solid_speed, air)
                    total += given
                    count += steps_taken
                if self.batches is not None:
                    air += self.batches.take_air(each)
        pressed, worked = self.contacts.felt_by_vertices()
        self.steps_done += count
        return self._report(span, bodies, start, air, total, pressed, worked, count)

    def _short(self, span: float, time: float, solid_speed: float, air: F64) -> tuple[F64, int]:
        """Take explicit steps; impulses given to the bodies (b, 6), and how many they were. Count into `air` what air and fields gave."""
        start, speed = self.x.numpy()[: self.n].copy(), self.v.numpy().copy()
        push = self.blow(time, start)
        count = max(1, math.ceil(span / self._longest(speed, push, span, solid_speed) - 1e-6))
        before = self._moment()
        total, count = self._retaken(span, count, lambda dt, many: self._run(dt, many, solid_speed), lambda: self._back(before))
        given = self.mass[:, None] * push
        air += [*(given.sum(0) * span), float((given * (self.x.numpy()[: self.n] - start)).sum())]
        return total, count

    def _short_in_batches(self, batches: Batches, span: float, since: float, time: float, solid_speed: float) -> tuple[F64, int]:
        """The same on a GPU, `since` seconds after bodies' states were given; `Batches.take_air` tells what air and fields gave."""
        self.breathe(time, lambda: self.x.numpy()[: self.n])
        fastest, push, drift, stretch = batches.look()
        longest = self._longest_now(fastest + push * span, drift, solid_speed, lambda: stretch)
        count = max(1, math.ceil(span / longest - 1e-6))
        total, count = self._retaken(span, count, lambda dt, many: self._batched(batches, dt, many, since), batches.take_back)
        batches.finish()
        return total, count

    def _retaken(self, span: float, count: int, run: Callable[[float, int], F64], back: Callable[[], None]) -> tuple[F64, int]:
        """Impulses of `run`, which takes `count` steps over `span` (length [s], number), and how many they were: where one outran the
        search for contacts all are taken `back` and run again, half as long."""
        for halving in range(HALVINGS + 1):
            try:
                return run(span / count, count), count
            except OutranError as error:
                if halving == HALVINGS:
                    raise EngineError(str(error)) from None
                back()
                count *= 2
        raise AssertionError

    def _moment(self) -> tuple[Any, ...]:
        """All that explicit steps change, for `_back`."""
        arrays = (self.x, self.v, self.u, self.clock, self.reaction, self.contacts.held_back)
        return (*((a, warp().clone(a)) for a in arrays), self.contacts.books())

    def _back(self, moment: tuple[Any, ...]) -> None:
        """Return to a moment; what has been looked for since is looked for anew."""
        *arrays, books = moment
        for array, values in arrays:
            warp().copy(array, values)
        self.contacts.reopen(books)

    def _longest(self, speed: F64, push: F64, span: float, solid_speed: float) -> float:
        """Longest step [s] of vertices with these velocities and pushes of the air."""
        drift = self.mass @ speed / self.mass.sum()
        fastest = float(np.sqrt(((speed - drift) ** 2).sum(1).max())) + float(np.linalg.norm(push, axis=1).max()) * span
        return self._longest_now(
            fastest,
            float(np.linalg.norm(drift)),
            solid_speed,
            lambda: stretched(self.x.numpy(), self.host_edges, self.host_lengths),
        )

    def _longest_now(self, fastest: float, drift: float, solid_speed: float, stretch: Callable[[], tuple[float, float]]) -> float:
        """Longest step [s]: stable, and such that no vertex outruns in one step what the search for contacts leaves between its
        soft and its hard bounds.

        Args:
            fastest: greatest speed against the mean velocity [m/s].
            drift: that one.
            solid_speed: of the fastest solid.
            stretch: greatest and least length of edges over that at rest, where they are looked at.
        """
        contacts = self.contacts
        dt = self.longest / self._stiffer(stretch)
        if contacts.self_collision:
            dt = min(dt, QUICK * contacts.margins(fastest, drift)[0] / max(fastest, 1e-9))
        if contacts.solid is not None:
            dt = min(dt, CATCH * contacts.touch[1] / max(solid_speed, 1e-9))
        return dt

    def pace(self) -> float:
        """Time in which the fastest swing of the sheets turns by less than two radians [s]: an explicit step is 2 over its frequency at most."""
        return 0.6 * self.longest / math.sqrt(stiffening(self.x.numpy(), self.host_edges, self.host_lengths))

    def _stiffer(self, stretch: Callable[[], tuple[float, float]]) -> float:
        """Factor by which the highest frequency exceeds that at rest, looked at now and then."""
        if self._looks % STIFFENING == 0:
            self._stiffness = stiffened(*stretch())
        self._looks += 1
        return math.sqrt(self._stiffness)

    def _run(self, dt: float, count: int, solid_speed: float) -> F64:
        """Take `count` steps on a CPU; the impulses given to the bodies by contact, (b, 6)."""
        if self.folds is not None:
            try:
                return self.folds.run(dt, count, solid_speed)
            except OutranError:
                raise OutranError(self._outran(dt)) from None
        clock, p = self.clock.numpy(), self.passes
        clock[0], clock[2] = dt, 0.0
        passes = [*self.forces(), p("stride", bounds.stride, self.n, [self.clock, self.u, self.x, self.v])]
        if self.carries:
            passes.append(self.carry())
        passes.append(p("tick", steps.tick, 1, [self.clock]))
        for _ in range(count):
            for one in passes:
                one()
        return np.zeros((len(self.setup.boundaries), 6))

    def _batched(self, batches: Batches, dt: float, count: int, since: float) -> F64:
        """Take `count` steps on a GPU; as `_run`."""
        try:
            return batches.run(dt, count, since)
        except OutranError:
            raise OutranError(self._outran(dt)) from None

    def _outran(self, dt: float) -> str:
        """Words on the vertex that went farthest from where contacts were last looked for, and what it touches."""
        scheme = self.folds or self.batches
        assert scheme is not None
        worst = scheme.farthest()
        place = np.round(self.x.numpy()[worst], 3).tolist()
        rows = scheme.solids_at(worst)
        touched = [self.setup.boundaries[row].name for row in rows]
        where = f"between {' and '.join(touched[:3])}" if len(rows) > 1 else f"at {touched[0]}" if rows else "at no solid"
        cure = (
            "what presses a sheet from two sides throws it: give it room, or let it pass through one of them by `ignores`"
            if len(rows) > 1
            else "a sheet snaps back at its stretch times sqrt(stretch_stiffness / area_density): let what holds it give way, let it tear at a "
            "lower strength, or lower its stretch_stiffness"
        )
        speed = float(np.linalg.norm(self.v.numpy()[worst]))
        return f"cloth at {place} m moves at {speed:.3g} m/s {where}, further in a step of {dt:g} s than contacts are looked for; {cure}"

    def _report(
        self, span: float, bodies: BodyState, start: F64, air: F64, total: F64, pressed: F64, worked: F64, count: int
    ) -> ClothReport:
        x = self.x.numpy()[: self.n]
        if not np.isfinite(x).all():
            raise EngineError("the cloth's coordinates are not finite; shorten max_step")
        moved, load = x - start, np.zeros(4)
        if self.loads is not None:
            load = np.array([*(self.loads.sum(0) * span), float((self.loads * moved).sum())])
        air = air - load
        reaction = np.zeros(4)
        impulse = total.copy()
        if len(self.held):
            felt = self.reaction.numpy()[self.held]
            reaction[:3] = -felt.sum(0)
            reaction[3] = -float((felt * moved[self.held]).sum()) / span
            for row in np.unique(self.holder[self.held]):
                if row >= 0:
                    own = self.holder[self.held] == row
                    middle = bodies.center[row] + 0.5 * span * bodies.velocity[row]
                    arm = 0.5 * (start + x)[self.held[own]] - middle
                    impulse[row, :3] += felt[own].sum(0)
                    impulse[row, 3:] += np.cross(arm, felt[own]).sum(0)
            self.reaction.zero_()
        back = self.contacts.held_back
        lost = back.numpy()
        cut = np.array([*lost.sum(0), float(((lost[:, 0] != 0) | (lost[:, 1] != 0) | (lost[:, 2] != 0)).sum())])
        if cut[3]:
            back.zero_()
        work = 0.0
        if len(total):
            twist = np.concatenate([bodies.velocity, bodies.angular_velocity], axis=1)
            soft = np.array([b.deforming for b in self.setup.boundaries])
            work = -float(np.where(soft, worked, (total * twist).sum(axis=1)).sum())
        square = self.v.numpy() ** 2
        fastest = float(np.sqrt((square[:, 0] + square[:, 1] + square[:, 2]).max()))
        return ClothReport(
            dt=span, impulse=impulse, vertex_impulse=self._soft.given(pressed), steps=count, fastest=fastest, contact=total,
            air=air, held=reaction, cut=cut, load=load, work=work, contacts=self.contacts.looked_at,
        )  # fmt: skip

    # ------------------------------------------------------------------ state

    def vertices(self) -> tuple[F64, F64]:
        """Places and velocities of all sheets' vertices, (n, 3) each, copied."""
        return self.x.numpy()[: self.n].copy(), self.v.numpy().copy()

    def checkpoint(self) -> bytes:
        """The full state of the sheets."""
        x, v = self.vertices()
        return to_bytes({"x": x, "v": v})

    def restore(self, state: bytes) -> None:
        """Continue from a checkpoint; solids come with the next step.

        Raises:
            EngineError: these are not the bytes of such a checkpoint.
            ValueError: it is of another cloth.
        """
        found = from_bytes(state, ("x", "v"))
        if len(found["x"]) != self.n:
            raise ValueError(f"{len(found['x'])} vertices for a cloth of {self.n}")
        whole = self.x.numpy().copy()
        whole[: self.n] = found["x"]
        self.x.assign(whole)
        self.v.assign(found["v"])
        self._known = False
        self._patience.restart()
        self._last_span = 0.0
        self._looks = 0
        if self._strides is not None:
            self._strides.begin()
        if self.grips is not None:
            self.grips.begin()
        if self.batches is not None:
            self.batches.begin()
        self.contacts.fresh = False
        self.reaction.zero_()
        self.contacts.held_back.zero_()

"""An instance of grains as a coupled solver."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...physics.drag import sphere_drag_rate
from ...worlds.arrays import F64
from ...worlds.fields import Answer, Dragged
from ..boundaries import BodyState, Surround
from ..sealed import from_bytes, to_bytes
from .energy import Elastic, elastic
from .engine import Grains
from .frames import FramedParticles
from .scene import build_grains
from .setup import GrainReport

__all__ = ["SolverGrains"]

COLLISION_SHARE = 8.0
"""Exchanges in a collision with a vertex that gives way: with 1.6, grains shook the cloth they fell on to 120 m/s (measured)."""

NEAR = 1.25
"""Own choice: distance in radii of the largest grain, and what both can come in an exchange, from which on grains count as at a surface."""


class _Felt(NamedTuple):
    """Grains that a medium was asked about."""

    answer: Answer
    identity: Any
    change: F64
    """Change of its velocity at all grains [m/s]."""
    pull: F64
    """Force of fields that are no medium on those asked about [N]."""

    def take(self, blown: tuple[Any, F64], seconds: float) -> None:
        """Take what drag gave them, of what all fields gave to each grain that is still there (identities, impulses [N s])."""
        identities, impulse = blown
        given = np.zeros((len(self.identity), 3))
        if len(identities):
            order = np.argsort(identities)
            at = order[np.minimum(np.searchsorted(identities, self.identity, sorter=order), len(order) - 1)]
            there = identities[at] == self.identity
            given[there] = impulse[at[there]] - seconds * self.pull[there]
        self.answer.take(given)


class SolverGrains(FramedParticles):
    """Grains with Hertz-Mindlin contacts."""

    @property
    def surround(self) -> Surround:
        """The bodies that it meets."""
        return self.scene.surround

    def set_up(self) -> None:
        """Fill the volume and make the engine."""
        self.scene = build_grains(self.spec, self.built, self.name)
        self.engine = Grains(self.scene.setup)
        self._longest = self._exchange = float(getattr(self.instance.settings, "exchange", 1e-3))
        coupled = not self._caches and bool(self.surround.soft)
        self._short = min(self._longest, self._yielding() / COLLISION_SHARE) if coupled else self._longest
        """Exchange while grains can meet what gives way [s]."""
        self._widest = float(self.scene.setup.radius.max(initial=0.0))

    def begin_motion(self) -> None:
        """Add the declared velocities."""
        declared = np.array([self.physics(k).linear_velocity for k in range(len(self.members))], dtype=np.float64)
        if declared.any():
            c = self.engine.columns()
            given = np.zeros((int(c["identity"].max(initial=-1)) + 1, 3))
            given[c["identity"]] = declared[c["kind"]]
            self.engine.push(given)

    def _yielding(self) -> float:
        """Time of a collision at 1 m/s of a grain with the lightest vertex of a surface that deforms [s] (Hertz, as in the engine)."""
        lightest = 0.5 * min(float(s.mass.min()) for s in self.surround.soft.values())
        setup, times = self.scene.setup, []
        for kind in setup.kinds:
            modulus = 0.5 * kind.young / (1.0 - kind.poisson**2)
            times.append(2.87 * (lightest**2 / (float(setup.radius.min()) * modulus**2)) ** 0.2)
        return float(min(times))

    def max_stable_dt(self) -> float:
        """Longest exchange in the state of the last step [s]."""
        return self._exchange

    def step(self, limit: float, bodies: BodyState, time: float) -> GrainReport:
        """One exchange; short ones where a surface that deforms is so close that grains can meet it within a long one."""
        self._exchange = self._short if self._short < self._longest and self._close(bodies) else self._longest
        return super().step(limit, bodies, time)

    def _close(self, bodies: BodyState) -> bool:
        """True where the box of the grains and that of a surface that deforms can touch before a long exchange ends."""
        if not bodies.vertices:
            return False
        c = self.engine.columns()
        if not len(c["position"]):
            return False
        low, high = c["position"].min(axis=0), c["position"].max(axis=0)
        pull = self._longest * float(np.linalg.norm(self.spec.simulation.gravity))
        fastest = float(np.sqrt((c["velocity"] ** 2).sum(axis=1).max()))
        for place, speed in bodies.vertices.values():
            most = fastest + pull + float(np.sqrt((speed**2).sum(axis=1).max(initial=0.0)))
            reach = NEAR * self._widest + self._longest * most
            if (place.min(axis=0) - reach <= high).all() and (place.max(axis=0) + reach >= low).all():
                return True
        return False

    def exchange(self, seconds: float, bodies: BodyState, time: float) -> GrainReport:
        """Go on by `seconds` from `time`, or less where a medium that feels the grains would stop in that time."""
        felt, seconds = self._feel(time, seconds)
        report = self.engine.step(seconds, bodies)
        if felt is not None:
            felt.take(self.engine.blown_at, seconds)
        return report

    def _feel(self, time: float, seconds: float) -> tuple[_Felt | None, float]:
        """Tell the engine what fields do at its grains; what a medium that feels them is asked, and the time for which that holds [s]."""
        if not any(self.fields) or time < 0:
            return None, seconds
        c = self.engine.columns()
        velocity, pull = np.zeros((2, len(c["mass"]), 3))
        rate = np.zeros(len(c["mass"]))
        for k, fields in enumerate(self.fields):
            own = np.flatnonzero(c["kind"] == k)
            if not fields or not len(own):
                continue
            pull[own] = fields.acceleration(c["position"][own], time)
            if fields.has_medium:
                medium = fields.medium(c["position"][own], time)
                velocity[own] = medium.velocity
                rate[own] = sphere_drag_rate(medium, c["radius"][own], c["mass"][own], c["velocity"][own])
        felt = None
        if any(f.carriers for f in self.fields):
            felt, seconds = self._asked(c, rate, pull, time, seconds)
        self.engine.set_air(velocity if felt is None else velocity + felt.change, rate, pull)
        return felt, seconds

    def _asked(self, c: dict[str, Any], rate: F64, pull: F64, time: float, seconds: float) -> tuple[_Felt | None, float]:
        """Answer of a medium to all grains that it carries, for a time in which these could not stop it if they stood."""
        carried = [k for k, f in enumerate(self.fields) if f.carriers]
        own = np.flatnonzero(np.isin(c["kind"], carried))

        def ask(span: float) -> Answer | None:
            dragged = Dragged(c["velocity"][own], c["mass"][own], -np.expm1(-rate[own] * span), rate[own], span)
            return self.fields[carried[0]].answer(c["position"][own], time, dragged)

        answer = ask(seconds)
        if answer is not None and answer.stopping * seconds > 1.0:
            seconds = 1.0 / answer.stopping
            answer = ask(seconds)
        if answer is None:
            return None, seconds
        change = np.zeros((len(c["mass"]), 3))
        change[own] = answer.change
        return _Felt(answer, c["identity"][own], change, c["mass"][own, None] * pull[own]), seconds

    def columns(self) -> dict[str, Any]:
        """The present state."""
        return self.engine.columns()

    def elastic(self) -> Elastic:
        """Elastic energy of contacts."""
        return elastic(self.engine)

    def pack(self) -> bytes:
        """State of the engine."""
        return self.engine.checkpoint()

    def rested(self, state: bytes) -> bytes:
        """A state with the grains where they are and what their contacts store, at rest."""
        found = from_bytes(state, ("motion", "spin", "rest", "rest_spin", "time", "speed"))
        found["motion"][:, :3] = 0.0  # the last column is no speed
        zero = {name: np.zeros_like(found[name]) for name in ("spin", "rest", "rest_spin", "time", "speed")}
        return to_bytes({**found, **zero})

    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""
        self.engine.restore(state)

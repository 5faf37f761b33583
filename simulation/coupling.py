"""Two-way coupling of a rigid instance with partners: liquids, cloth, grains (R66-R68). They step together and exchange impulses.

At every sub-step a partner gets the bodies as they are, with their inverse mass and inertia and their acceleration without it,
so that its solve can let them give way (which keeps light bodies stable). What it gave them over the step is applied to the
MuJoCo bodies as a constant wrench over the same time, in which they make their own steps. Both sides are recorded, each
counted by itself: `exchange/impulse` and `exchange/reaction` in the partner's cache, `exchange/impulse` of what MuJoCo
integrated in the rigid one's.

Surfaces that deform are met at their vertices: those of elastic members of the rigid instance, and those of cloth for the
other partners. Impulses at vertices are taken to what carries them, nodes or the cloth's vertices, over the same time. Cloth
steps last of the partners, so that it has all that the others gave it.

A frame at whose end surfaces of bodies could overlap is redone by all instances with half the rigid step, from their
states at its start; so every frame starts from checkpoint bytes, and a resumed run equals an unbroken one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from ..worlds.arrays import F64
from .bodies import lay_vertices, resting
from .boundaries import BodyState, MovingSurface, Surround
from .protocol import SHORTEST, Solver, Within, stepping
from .rigid.coupled import MovingBodies, RigidBodies
from .rigid.solver import SolverRigid

__all__ = ["CoupledRun", "Partner", "Stepped"]


class Stepped(Protocol):
    """What one step of a partner did."""

    @property
    def dt(self) -> float:
        """[s]"""

    @property
    def impulse(self) -> F64:
        """Given to each boundary, linear and angular about `BodyState.center` (b, 6) [N s, N m s]."""

    @property
    def vertex_impulse(self) -> Mapping[int, F64]:
        """Of that, what each vertex of the deforming boundaries that react got: row -> (v, 3) [N s]."""


class Partner(Solver, Protocol):
    """A solver that can step together with a rigid instance. `prepare` and `advance` do the same by themselves."""

    @property
    def surround(self) -> Surround:
        """The bodies that it meets; one row each in states and impulses."""

    def begin_run(self) -> None:
        """Set up, at the start of the preroll."""

    def start_frames(self) -> None:
        """The present state is frame 0: ledgers of flows start here."""

    def begin_frame(self, frame: int) -> None:
        """Start the next frame."""

    def step(self, limit: float, bodies: BodyState, time: float) -> Stepped:
        """One step of at most `limit` seconds from `time`, counted into the frame."""

    def end_frame(self) -> None:
        """The frame that was begun is reached."""


@runtime_checkable
class Deforms(Protocol):
    """A partner whose vertices are boundaries of other partners."""

    @property
    def members(self) -> tuple[str, ...]:
        """Its entities."""

    def surface(self, entity: str) -> MovingSurface:
        """An entity's vertices at present."""

    def load(self, forces: Mapping[str, F64]) -> None:
        """Forces at the vertices of its entities from now on, each (v, 3) [N]."""


class _Soft(NamedTuple):
    """A deforming boundary of a partner."""

    row: int
    entity: str
    owner: int
    """The partner that it belongs to; -1: the rigid instance."""


class CoupledRun:
    """A rigid instance and the partners that it exchanges forces with."""

    def __init__(self, rigid: SolverRigid, partners: Sequence[Partner]) -> None:
        self.rigid = rigid
        self.partners = tuple(sorted(partners, key=lambda p: isinstance(p, Deforms)))
        self.frame = 0
        self._frame_time = 1.0 / rigid.spec.simulation.fps

    def prepare(self, *, resumed: bool = False) -> None:
        """Set all up and run the preroll together: the state at frame 0."""
        self.rigid.compile()
        for partner in self.partners:
            partner.begin_run()
        self._bodies = RigidBodies(self.rigid)
        self._rest = [resting(partner.surround) for partner in self.partners]
        self._rows = [self._moving_rows(partner) for partner in self.partners]
        self._soft = [self._soft_rows(partner) for partner in self.partners]
        preroll = self.rigid.spec.simulation.preroll
        if preroll > 0 and not resumed:
            self.rigid.begin_attempt(0)
            self.rigid.time = -preroll
            self._exchange(-preroll, 0.0)
        self.rigid.start_frames()
        for partner in self.partners:
            partner.start_frames()
        self.frame = 0

    def _moving_rows(self, partner: Partner) -> list[tuple[int, int]]:
        """(row among the partner's boundaries, row among the moving bodies)."""
        known = {name: row for row, name in enumerate(self.rigid.rigid.bodies)}
        return [(k, known[b.name]) for k, b in enumerate(partner.surround.boundaries) if b.name in known]

    def _soft_rows(self, partner: Partner) -> list[_Soft]:
        """Deforming boundaries of a partner, and who moves them."""
        owners = {m: k for k, p in enumerate(self.partners) if isinstance(p, Deforms) for m in p.members}
        return [_Soft(row, s.entity, owners.get(s.entity, -1)) for row, s in partner.surround.soft.items()]

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance all from frame - 1 to `frame`; `tell` takes how far that is.

        Raises:
            InputError: not the next frame.
            EngineError: a state is not finite.
        """
        rigid = self.rigid
        rigid.begin_frame(frame)
        states = [partner.checkpoint() for partner in self.partners]
        for level in range(rigid.settings.refine + 1):
            if level > 0:
                for partner, state in zip(self.partners, states, strict=True):
                    partner.restore(state, frame - 1)
            rigid.begin_attempt(level)
            for partner in self.partners:
                partner.begin_frame(frame)
            again = f"{rigid.repeats()}, " if level > 0 else ""
            self._exchange((frame - 1) * self._frame_time, frame * self._frame_time, tell=tell, again=again)
            if rigid.end_attempt():
                break
        rigid.end_frame()
        for partner in self.partners:
            partner.end_frame()
        self.frame = frame

    def _exchange(self, start: float, end: float, *, tell: Within | None = None, again: str = "") -> None:
        """Step all from `start` to `end` [s]; the first partner sets the pace. `tell` takes how far it is, after the words `again`."""
        time = start
        while time < end - SHORTEST:
            bodies, surfaces = self._bodies.state(), self._bodies.surfaces()
            wrench = np.zeros((len(self.rigid.rigid.bodies), 6))
            given_to: dict[int, dict[str, F64]] = {}
            taken = 0.0
            for number, partner in enumerate(self.partners):
                if isinstance(partner, Deforms):
                    partner.load({n: j / taken for n, j in given_to.get(number, {}).items()})
                given = self._bodies_of(number, bodies, surfaces)
                if number == 0:
                    report = partner.step(end - time, given, time)
                    taken, impulse, at_vertices = report.dt, report.impulse, dict(report.vertex_impulse)
                else:
                    impulse, at_vertices = _steps(partner, given, time, taken)
                for boundary, body in self._rows[number]:
                    wrench[body] += impulse[boundary]
                for soft in self._soft[number]:
                    held = given_to.setdefault(soft.owner, {})
                    held[soft.entity] = held.get(soft.entity, 0.0) + at_vertices[soft.row]
            until = end if end - time - taken < SHORTEST else time + taken
            loads = {n: j / (until - time) for n, j in given_to.get(-1, {}).items()}
            self.rigid.step_to(until, wrench / (until - time), start=time, loads=loads)
            time = until
            if tell is not None:
                tell((time - start) / (end - start), again + stepping(taken))

    def _bodies_of(self, number: int, moving: MovingBodies, surfaces: Mapping[str, MovingSurface]) -> BodyState:
        """States of one partner's boundaries: those at rest at their places, the others as they are."""
        rest, rows = self._rest[number], self._rows[number]
        found = BodyState(
            rest.position.copy(), rest.rotation.copy(), rest.center.copy(), rest.velocity.copy(), rest.angular_velocity.copy(),
            rest.inverse_mass.copy(), rest.inverse_inertia.copy(), rest.acceleration.copy(),
        )  # fmt: skip
        if rows:
            own, other = (list(k) for k in zip(*rows, strict=True))
            for field in MovingBodies._fields:
                getattr(found, field)[own] = getattr(moving, field)[other]
        for soft in self._soft[number]:
            owner = self.partners[soft.owner]
            now = owner.surface(soft.entity) if soft.owner >= 0 and isinstance(owner, Deforms) else surfaces[soft.entity]
            lay_vertices(found, soft.row, self.partners[number].surround.soft[soft.row], now.places, now.speeds)
            found.vertex_lightness[soft.row], found.vertex_give[soft.row] = now.lightness, now.give
            found.vertex_pace[soft.row] = now.pace
        return found


def _steps(partner: Partner, bodies: BodyState, time: float, seconds: float) -> tuple[F64, dict[int, F64]]:
    """Let a partner step for `seconds` from `time`; the impulses that it gave, shape (b, 6), and those at vertices."""
    total: F64 = np.zeros((len(partner.surround.boundaries), 6))
    at_vertices: dict[int, F64] = {}
    done = 0.0
    while done < seconds - SHORTEST:
        report = partner.step(seconds - done, bodies, time + done)
        total += report.impulse
        for row, given in report.vertex_impulse.items():
            at_vertices[row] = at_vertices.get(row, 0.0) + given
        done += report.dt
    return total, at_vertices

"""Two-way coupling of a rigid instance with partners: liquids, cloth, grains (R66, R67). They step together and exchange impulses.

At every sub-step a partner gets the bodies as they are, with their inverse mass and inertia and their acceleration without it,
so that its solve can let them give way (which keeps light bodies stable). What it gave them over the step is applied to the
MuJoCo bodies as a constant wrench over the same time, in which they make their own steps. Both sides are recorded, each
counted by itself: `exchange/impulse` and `exchange/reaction` in the partner's cache, `exchange/impulse` of what MuJoCo
integrated in the rigid one's.

A frame at whose end surfaces of bodies could overlap is redone by all instances with half the rigid step, from their
states at its start; so every frame starts from checkpoint bytes, and a resumed run equals an unbroken one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ..worlds.arrays import F64
from .bodies import resting
from .boundaries import BodyState, Surround
from .protocol import SHORTEST, Solver
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


class CoupledRun:
    """A rigid instance and the partners that it exchanges forces with."""

    def __init__(self, rigid: SolverRigid, partners: Sequence[Partner]) -> None:
        self.rigid, self.partners = rigid, tuple(partners)
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

    def advance(self, frame: int) -> None:
        """Advance all from frame - 1 to `frame`.

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
            self._exchange((frame - 1) * self._frame_time, frame * self._frame_time)
            if rigid.end_attempt():
                break
        rigid.end_frame()
        for partner in self.partners:
            partner.end_frame()
        self.frame = frame

    def _exchange(self, start: float, end: float) -> None:
        """Step all from `start` to `end` [s]; the first partner sets the pace."""
        time = start
        while time < end - SHORTEST:
            bodies = self._bodies.state()
            wrench = np.zeros((len(self.rigid.rigid.bodies), 6))
            taken = 0.0
            for number, partner in enumerate(self.partners):
                given = self._bodies_of(number, bodies)
                if number == 0:
                    report = partner.step(end - time, given, time)
                    taken, impulse = report.dt, report.impulse
                else:
                    impulse = _steps(partner, given, time, taken)
                for boundary, body in self._rows[number]:
                    wrench[body] += impulse[boundary]
            until = end if end - time - taken < SHORTEST else time + taken
            self.rigid.step_to(until, wrench / (until - time), start=time)
            time = until

    def _bodies_of(self, number: int, moving: MovingBodies) -> BodyState:
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
        return found


def _steps(partner: Partner, bodies: BodyState, time: float, seconds: float) -> F64:
    """Let a partner step for `seconds` from `time`; the impulse that it gave, shape (b, 6)."""
    total: F64 = np.zeros((len(partner.surround.boundaries), 6))
    done = 0.0
    while done < seconds - SHORTEST:
        report = partner.step(seconds - done, bodies, time + done)
        total += report.impulse
        done += report.dt
    return total

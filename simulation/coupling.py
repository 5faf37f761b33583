"""Two-way coupling of a rigid instance with liquids (R66, R67): they step together and exchange impulses.

At every sub-step the liquid gets the bodies as they are, with their inverse mass and inertia and their acceleration without the
liquid, so that its pressure solve can let them give way (which keeps light bodies stable). What it gave them over the step
is applied to the MuJoCo bodies as a constant wrench over the same time, in which they make their own steps. Both sides are
recorded, each counted by itself: `exchange/impulse` and `exchange/reaction` in the liquid's cache, `exchange/impulse` of
what MuJoCo integrated in the rigid one's.

A frame at whose end surfaces of bodies could overlap is redone by all instances with half the rigid step, from their
states at its start; so every frame starts from checkpoint bytes, and a resumed run equals an unbroken one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..worlds.arrays import F64
from .bodies import resting
from .liquid.engine import BodyState
from .liquid.solver import SHORTEST, SolverLiquid
from .rigid.coupled import MovingBodies, RigidBodies
from .rigid.solver import SolverRigid

__all__ = ["CoupledRun"]


class CoupledRun:
    """A rigid instance and the liquids that it exchanges forces with."""

    def __init__(self, rigid: SolverRigid, liquids: Sequence[SolverLiquid]) -> None:
        self.rigid, self.liquids = rigid, tuple(liquids)
        self.frame = 0
        self._frame_time = 1.0 / rigid.spec.simulation.fps

    def prepare(self, *, resumed: bool = False) -> None:
        """Set all up and run the preroll together: the state at frame 0."""
        self.rigid.compile()
        for liquid in self.liquids:
            liquid.begin_run()
        self._bodies = RigidBodies(self.rigid)
        self._rest = [resting(liquid.scene) for liquid in self.liquids]
        self._rows = [self._moving_rows(liquid) for liquid in self.liquids]
        preroll = self.rigid.spec.simulation.preroll
        if preroll > 0 and not resumed:
            self.rigid.begin_attempt(0)
            self.rigid.time = -preroll
            self._exchange(-preroll, 0.0)
        self.rigid.start_frames()
        for liquid in self.liquids:
            liquid.start_frames()
        self.frame = 0

    def _moving_rows(self, liquid: SolverLiquid) -> list[tuple[int, int]]:
        """(row among the liquid's boundaries, row among the moving bodies)."""
        known = {name: row for row, name in enumerate(self.rigid.rigid.bodies)}
        return [(k, known[b.name]) for k, b in enumerate(liquid.scene.setup.boundaries) if b.name in known]

    def advance(self, frame: int) -> None:
        """Advance all from frame - 1 to `frame`.

        Raises:
            InputError: not the next frame.
            EngineError: a state is not finite.
        """
        rigid = self.rigid
        rigid.begin_frame(frame)
        states = [liquid.checkpoint() for liquid in self.liquids]
        for level in range(rigid.settings.refine + 1):
            if level > 0:
                for liquid, state in zip(self.liquids, states, strict=True):
                    liquid.restore(state, frame - 1)
            rigid.begin_attempt(level)
            for liquid in self.liquids:
                liquid.begin_frame(frame)
            self._exchange((frame - 1) * self._frame_time, frame * self._frame_time)
            if rigid.end_attempt():
                break
        rigid.end_frame()
        for liquid in self.liquids:
            liquid.end_frame()
        self.frame = frame

    def _exchange(self, start: float, end: float) -> None:
        """Step all from `start` to `end` [s]; the first liquid sets the pace."""
        time = start
        while time < end - SHORTEST:
            bodies = self._bodies.state()
            wrench = np.zeros((len(self.rigid.rigid.bodies), 6))
            taken = 0.0
            for number, liquid in enumerate(self.liquids):
                given = self._bodies_of(number, bodies)
                if number == 0:
                    report = liquid.step(end - time, given, time)
                    taken, impulse = report.dt, report.impulse
                else:
                    impulse = _steps(liquid, given, time, taken)
                for boundary, body in self._rows[number]:
                    wrench[body] += impulse[boundary]
            until = end if end - time - taken < SHORTEST else time + taken
            self.rigid.step_to(until, wrench / (until - time), start=time)
            time = until

    def _bodies_of(self, number: int, moving: MovingBodies) -> BodyState:
        """States of one liquid's boundaries: those at rest at their places, the others as they are."""
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


def _steps(liquid: SolverLiquid, bodies: BodyState, time: float, seconds: float) -> F64:
    """Let a liquid step for `seconds` from `time`; the impulse that it gave, shape (b, 6)."""
    total: F64 = np.zeros((len(liquid.scene.setup.boundaries), 6))
    done = 0.0
    while done < seconds - SHORTEST:
        report = liquid.step(seconds - done, bodies, time + done)
        total += report.impulse
        done += report.dt
    return total

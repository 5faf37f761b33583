"""Rigid bodies, joints and ropes on MuJoCo (R61). See README.md for limits, method.md for the scheme."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.cache import CacheIndex
from ...worlds.errors import EngineError, InputError
from ..fracture import Breakage
from ..protocol import Within, repeated
from ..sealed import Stamp, seal, unseal
from .checkpoint import at_rest, read_state, write_state
from .contact_law import set_contact_law
from .distances import nearest, settle_kinematics
from .output import frame_channels, index_of
from .records import velocities
from .runaway import gave_up
from .stepper import Stepper

__all__ = ["SolverRigid"]


class SolverRigid(Stepper):
    """One MuJoCo instance. Between two checkpoints, equal bytes and settings give equal frames.

    `coupled`: others push its bodies inside the frame (`step_to`), and what they gave is recorded.
    """

    frame = 0
    refined = 0
    """Halvings of the step that the present frame took."""
    time = 0.0
    """Where the present frame stands [s]."""
    _overflows = 0
    _joint_error = 0.0

    def prepare(self, *, resumed: bool = False) -> None:
        """Compile, open the skins, run the preroll, set the declared velocities: the state at frame 0.

        Args:
            resumed: a checkpoint is restored next, so that the preroll is not run.

        Raises:
            InputError: the model cannot be built.
            EngineError: bodies overlap so much at frame 0 that the skins cannot open.
        """
        self.compile()
        start = -self.spec.simulation.preroll
        if start < 0 and not resumed:
            self._run(start, 0.0, self.settings.step)
        self.start_frames()

    def start_frames(self) -> None:
        """The present state, with the declared velocities, is frame 0."""
        self.drivers.set_model(0.0)
        settle_kinematics(self.model, self.data)
        self.drivers.start_velocities(self.data)
        if self.flexes is not None:
            self.flexes.start(self.data)
        self._adopt_contacts(0.0)
        self._work = 0.0
        self.restore(self._bytes(), 0)
        self.ledger.begin()
        self.fields.begin()
        # What coupled solvers gave during the preroll is of no frame, as in their own ledgers.
        self._exchange.begin()
        self._finish_frame(0, self.settings.step)

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance from frame - 1 to `frame`; a frame whose visible surfaces could overlap at its end is redone finer.

        `tell` takes when it is.

        Raises:
            InputError: not the next frame.
            EngineError: the motion ran away, with the shortest step too.
        """
        self.begin_frame(frame)
        for level in range(self.settings.refine + 1):
            self.begin_attempt(level)
            if tell is not None and level > 0:
                tell(0.0, self.repeats())
            try:
                self.step_to(frame * self._frame_time)
            except EngineError:
                if level == self.settings.refine:
                    raise
                continue
            if self.end_attempt():
                break
        self.end_frame()

    def begin_frame(self, frame: int) -> None:
        """Start the next frame and remember where it starts, to redo it.

        Raises:
            InputError: not the next frame.
        """
        if frame != self.frame + 1:
            raise InputError(f"advance({frame}) after frame {self.frame}; the next frame is {self.frame + 1}")
        self._mj.mj_copyData(self._saved, self.model, self.data)
        self._begun, self._bonds, self._sleepers = self._now, self.breakage.memory(), self.breakage.sleepers()
        self._memory, self._work_before = self.monitor.memory(), self._work

    def begin_attempt(self, level: int) -> None:
        """Go through the frame that was begun with a step halved `level` times."""
        if level > 0:
            self.breakage.recall(self._bonds)
            self._install(self._begun)
            self.breakage.lay(self._sleepers)
            self._mj.mj_copyData(self.data, self.model, self._saved)
            self.monitor.recall(self._memory)
            self._work = self._work_before
        self.monitor.begin()
        self.ledger.begin()
        if self.flexes is not None:
            self.flexes.begin()
        self.breakage.begin()
        if self.rigid.law.kin is not None:
            self.rigid.law.kin.forget()
        self.refined, self._taken = level, 0
        self.time = self.frame * self._frame_time
        self._before = None
        self._exchange.begin()
        self.fields.begin()

    def repeats(self) -> str:
        """Progress text while a frame is retried."""
        return repeated(self.refined, self.settings.refine, self.settings.step / 2**self.refined)

    def step_to(
        self,
        end: float,
        wrench: F64 | None = None,
        *,
        start: float | None = None,
        loads: Mapping[str, F64] | None = None,
    ) -> None:
        """Step on to `end` [s] under a constant wrench on the moving bodies.

        Args:
            end: [s].
            wrench: force and torque about the centre of mass, world axes, per entry of `rigid.bodies`, shape (n, 6) [N, N m].
            start: where time stands; default: where the last call of this frame ended.
            loads: forces at the simulation vertices of elastic entities, each (v, 3) [N].

        Raises:
            EngineError: MuJoCo gave up, as it does where a motion runs away.
        """
        begin = self.time if start is None else start
        self._exchange.give(self.data, wrench, loads)
        step = self.settings.step / 2**self.refined
        try:
            with self.breakage.alone():
                self._taken += self._run(begin, end, step, self._before)
        except (self._mj.FatalError, ZeroDivisionError) as error:
            raise gave_up(self.model, self.data, error, frame=self.frame + 1, step=step, solver=self.name) from error
        self._exchange.end(self.data)
        self.time = end

    def end_attempt(self) -> bool:
        """True if the frame may end like this; else it is to be attempted again with half the step."""
        self._joint_error = self.ledger.joint_error(self.data)
        last = self.refined == self.settings.refine or not np.isfinite(self.data.qpos).all()
        slow = self.flexes is None or self.flexes.slow_enough
        return bool(last or (slow and nearest(self.rigid, self.data) >= 0.0))

    def end_frame(self) -> None:
        """The frame that was begun is reached."""
        self.frame += 1
        self._finish_frame(self._taken, self.settings.step / 2**self.refined)

    # ------------------------------------------------------------------ state

    def _bytes(self) -> bytes:
        sums = {"work": self._work, "overflows": self._overflows, "relaxation": self.relaxation}
        memory = {"bonds": self.breakage.memory().decode(), "contacts": self.monitor.memory().decode()}
        return seal(self._stamp(self.frame), {**sums, **memory}, read_state(self.model, self.data).tobytes())

    def _stamp(self, frame: int) -> Stamp:
        return Stamp("mujoco", self.name, frame)

    def checkpoint(self) -> bytes:
        """The full state; the solver itself continues from exactly these bytes (all bodies awake)."""
        self.monitor.wake_all(self.frame * self._frame_time)
        state = self._bytes()
        self.restore(state, self.frame)
        return state

    def stop(self) -> None:
        """Take all speeds away."""
        self.data.qvel[:] = 0.0
        settle_kinematics(self.model, self.data)

    def end_of_settling(self) -> bytes:
        """The present state as one at rest.

        Raises:
            EngineError: a bond broke.
        """
        if self.breakage and self.breakage.memory() != Breakage(self.spec, self.built, self.members).memory():
            raise EngineError(
                f"something of {self.name!r} broke while it settled; place it nearer to where it rests, or leave it out of simulation.settle"
            )
        return at_rest(self.data, self.relaxation)

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`.

        Raises:
            EngineError: the bytes are damaged, or not a checkpoint of this instance at this frame.
        """
        held, numbers = unseal(self._stamp(frame), state)
        time = frame * self._frame_time
        with self._stamp(frame).fits():
            if self.breakage.recall(held["bonds"].encode()):
                self._split(time)
            self.breakage.bind(self.rigid)  # solutions and sleepers are no part of a checkpoint
            write_state(self.model, self.data, np.frombuffer(numbers))
            self.monitor.recall(held["contacts"].encode())
        self.drivers.set_model(time)
        set_contact_law(self.rigid, self.settings.contact_steps, self.settings.step)
        if self.drivers.kinematic:
            self.drivers.plan_paths(time, self.settings.step, 0)
            self.drivers.follow_paths(self.data, 0, self.settings.step)
        settle_kinematics(self.model, self.data)
        self.work.stand(time)
        self.monitor.wake_all(time)
        self._work, self._overflows, self.relaxation = (held[k] for k in ("work", "overflows", "relaxation"))
        self.frame = frame

    # ------------------------------------------------------------------ output

    def _finish_frame(self, taken: int, step: float) -> None:
        data, soft = self.data, self._exchange.soft
        speeds = velocities(self.model, data)
        # An engine warning is an overflow or a bad state, never noise.
        self._overflows += int(sum(w.number for w in data.warning))
        for warning in data.warning:
            warning.number = 0
        records = {
            **self.ledger.measure(data, speeds, step),
            "driver_work": self._work,
            "steps": taken,
            "step": step,
            "contacts_max": self.monitor.max_contacts,
            "contact_gain": self.monitor.gain.most,
            "iterations_max": self.monitor.iterations,
            "iterations_capped": self.monitor.capped,
            "overflows": self._overflows,
            "joint_error": self._joint_error,
            **({} if soft is None else {"soft_exchange_work": soft.work}),
            **({"fracture_energy": self.breakage.energy} if self.breakage else {}),
        }
        span = max(0, self.frame - 1) * self._frame_time, self.frame * self._frame_time
        told = frame_channels(self._now, speeds, span, self.breakage, self._exchange, coupled=self._coupled)
        self._data = {**told, **{f"record/{name}": np.float64(value) for name, value in records.items()}}

    def frame_data(self) -> Mapping[str, Any]:
        """Channels and records of the present frame."""
        return self._data

    def index(self) -> CacheIndex:
        """Names behind the channels' rows."""
        return index_of(self.spec, self._now, self.name, self.breakage.names)

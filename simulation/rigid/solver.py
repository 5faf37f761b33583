"""Rigid bodies, joints and ropes on MuJoCo (R61). See README.md for scheme, limits and sources."""

from __future__ import annotations

import hashlib
import io
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.built import BuiltEntity
from ...worlds.cache import CacheIndex
from ...worlds.errors import EngineError, InputError
from ...worlds.spec import ElasticPhysics, RigidSettings, WorldSpec
from ..fracture import Breakage, Fate
from ..protocol import Channel, Intervention, Port
from .channels import BROKEN, CHANNELS, EXCHANGED, FIELDS
from .contact_law import rest_speed, set_contact_law
from .fields import FieldForces
from .flex import SOFT_CHANNELS, hear
from .flex_fields import SOFT_FIELDS, FlexFields
from .flex_loads import SOFT_EXCHANGED, SoftLoads
from .holds import FIXED
from .parts import Parts, carry_over, make_parts
from .records import velocities
from .relax import open_skins
from .rows import row_velocities, spread
from .sides import sides_of

__all__ = ["SolverRigid"]

ADOPTED = 1.2
"""Bodies within this many summed skins of each other count as touching at frame 0 and at a release."""
GUARD = 2e-4
"""Listed contacts closer than this [m] are measured again before a frame is accepted."""
CLEAR = 1e-7
"""Least accepted distance of visible surfaces at a frame [m]: covers the tolerance of GJK (1e-6 of it matters nowhere)."""
MAGIC = b"WARS3"
SEAL_BYTES = 32
"""A checkpoint is MAGIC, the SHA-256 of what follows, and that."""


class SolverRigid:
    """One MuJoCo instance. Between two checkpoints, equal bytes and settings give equal frames.

    `coupled`: others push its bodies inside the frame (`step_to`), and what they gave is recorded.
    """

    def __init__(
        self,
        spec: WorldSpec,
        built: Mapping[str, BuiltEntity],
        name: str,
        intervention: Intervention | None = None,
        *,
        coupled: bool = False,
    ) -> None:
        self.spec, self.built, self.name = spec, built, name
        self._intervention = intervention or Intervention()
        instance = spec.simulation.rigid[name]
        self.members = tuple(dict.fromkeys(instance.members))
        self.settings: RigidSettings = instance.settings
        self._frame_time = 1.0 / spec.simulation.fps
        self._work = 0.0
        self._overflows = 0
        self.relaxation = 0.0
        """Largest displacement of a body when the skins were opened [m]."""
        self.frame = 0
        self.refined = 0
        """Halvings of the step that the present frame took."""
        self.time = 0.0
        """Where the present frame stands [s]."""
        self._coupled = coupled
        self._asked: F64 | None = None
        self._wrench: F64 | None = None
        self._absorbed: F64 | None = None
        self._before: frozenset[str] | None = None

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

    def compile(self) -> None:
        """The model and the state at the start of the preroll."""
        import mujoco

        self._mj = mujoco
        # Warnings are counted in the `overflows` record; the engine would also write a log file into the working directory.
        mujoco.set_mju_user_warning(hear)
        self.breakage = Breakage(self.spec, self.built, self.members)
        self._install(self._parts())
        start = -self.spec.simulation.preroll
        self.drivers.remember_poses(self.data)
        self.drivers.set_model(start, free=True)
        self.drivers.plan_paths(start, self.settings.step, 0)
        self.drivers.follow_paths(self.data, 0, self.settings.step)
        self.relaxation = open_skins(self.rigid, self.data, self.settings)
        self.drivers.remember_poses(self.data)
        self._received = np.zeros((len(self.rigid.bodies), 6))
        self._soft = None if self.flexes is None or not self._coupled else SoftLoads(self.flexes)

    def _parts(self) -> Parts:
        """A model of the present clusters."""
        whole = self.breakage.whole()
        return make_parts(self.spec, self.built, self.members, self.settings, self._intervention, whole)

    def _install(self, parts: Parts) -> None:
        """Work with this model from now on."""
        self._now, self.rigid, self.model, self.data = parts, parts.rigid, parts.rigid.model, parts.data
        self._saved, self.drivers, self.work, self.gyration = parts.saved, parts.drivers, parts.work, parts.gyration
        self.monitor, self.ledger, self.fields, self.flexes = parts.monitor, parts.ledger, parts.fields, parts.flexes
        self.breakage.bind(self.rigid)

    def _split(self, time: float) -> None:
        """Go on from `time` [s] with the present clusters."""
        parts = self._parts()
        carry_over(self._now, parts, time)
        self._install(parts)
        self._settle_kinematics()

    def start_frames(self) -> None:
        """The present state, with the declared velocities, is frame 0."""
        self.drivers.set_model(0.0)
        self._settle_kinematics()
        self.drivers.start_velocities(self.data)
        if self.flexes is not None:
            self.flexes.start(self.data)
        self._adopt_contacts(0.0)
        self._work = 0.0
        self.restore(self._bytes(), 0)
        self.ledger.begin()
        self.fields.begin()
        self._finish_frame(0, self.settings.step)

    def _adopt_contacts(self, time: float) -> None:
        """Bodies that touch, or nearly do, when the monitor starts to look at them make no event."""
        model = self.model
        margins, pair_margins = model.geom_margin.copy(), model.pair_margin.copy()
        model.geom_margin[:], model.pair_margin[:] = margins * ADOPTED, pair_margins * ADOPTED
        self._collide_all()
        self.monitor.adopt(self.data, time)
        model.geom_margin[:], model.pair_margin[:] = margins, pair_margins

    def max_stable_dt(self) -> float:
        """Step in which the fastest body crosses the summed skins; at least 20 us [s]."""
        speed = float(np.linalg.norm(velocities(self.model, self.data)[0], axis=1).max(initial=0.0))
        return max(2e-5, 2 * self.settings.skin / speed) if speed > 0 else self.settings.step

    # ------------------------------------------------------------------ stepping

    def _run(self, start: float, end: float, step: float, held: frozenset[str] | None = None) -> int:
        """Step from `start` to `end` [s], switching drivers exactly at their times; returns the steps taken.

        `held` tells who was held right before `start`.
        """
        taken = 0
        held = self.drivers.held(start) if held is None else held
        stops = [start, *self.drivers.switch_times(start, end), end]
        for t0, t1 in itertools.pairwise(stops):
            count = max(1, math.ceil((t1 - t0) / step * (1 - 1e-9)))
            dt = (t1 - t0) / count
            self._set(t0, t0, dt, count)
            if held - self.drivers.held(t0):
                self._adopt_contacts(t0)
            held = self.drivers.held(t0)
            done, retakes = 0, 0
            while done < count:
                if done or retakes:
                    self._set(t0, t0 + done * dt, dt, count - done)
                steps, fate = self._segment(t0 + done * dt, dt, count - done, retakes)
                done += steps
                retakes = (retakes if steps == 0 else 0) + 1 if fate is Fate.AGAIN else 0
                if fate is not Fate.WHOLE:
                    self._split(t0 + done * dt)
            taken += count
        self._before = held
        return taken

    def _set(self, since: float, now: float, dt: float, count: int) -> None:
        """Write what holds from `since` on into model and state, for `count` steps of `dt` from `now` [s]."""
        set_contact_law(self.rigid, self.settings.contact_steps, dt)
        self.drivers.set_model(since)
        self.drivers.set_data(self.data, since)
        if self._asked is not None:
            # Bodies on paths, and pieces that the world holds, take what they are given without giving way: the engine need not
            # know of it, nor their drivers' work.
            absorbs = np.array([name.split("/", 1)[0] in self.drivers.kinematic for name in self.rigid.bodies], dtype=bool)
            absorbs |= self.model.body_dofnum[self.rigid.body_ids] == 0
            self._wrench = np.where(absorbs[:, None], 0.0, self._asked)
            self._absorbed = np.where(absorbs[:, None], self._asked, 0.0)
            self.data.xfrc_applied += self._from_others()
        self.drivers.plan_paths(now, dt, count)

    def _segment(self, start: float, dt: float, count: int, retakes: int) -> tuple[int, Fate]:
        """Up to `count` steps of `dt` [s] within which no driver switches.

        Args:
            start: of the first [s].
            dt: step [s].
            count: of steps.
            retakes: how often the first of them was taken already.

        Returns:
            Steps taken before clusters fell apart, and whether they did, in the last of these steps or in one to be taken again.
        """
        mujoco, model, data = self._mj, self.model, self.data
        first, watch_contacts, watch_sleep = mujoco.mj_step1, self.monitor.watch_contacts, self.monitor.watch_sleep
        authored, contact_law, solve = bool(self.drivers.kinematic), self.rigid.law.apply, self.rigid.law.solve
        gyration, ropes, watch = self.gyration.apply, self.drivers.has_ropes, self.ledger.watch
        fields = [f for f in (self.fields, None if self.flexes is None else self.flexes.fields) if f]
        held = self.drivers.held(start) if fields else frozenset()
        working = self.work.begin(data, velocities(model, data), self._outside())
        slowest = rest_speed(float(np.linalg.norm(model.opt.gravity)), dt)
        breaks, still, fate, taken = bool(self.breakage), self.drivers.held(start), Fate.WHOLE, 0
        while taken < count and fate is Fate.WHOLE:
            k = taken
            if authored:
                self.drivers.follow_paths(data, k, dt)
            if ropes:
                self.drivers.slacken(data)
            first(model, data)
            watch(data)
            for field in fields:
                field.apply(data, start + k * dt, dt, held)
            gyration(data, dt)
            contact_law(data, dt, slowest)
            if self.flexes is not None:
                # Elastic members take the discrete integrator, which has no stage of its own; nothing sleeps beside them.
                mujoco.mj_step2(model, data)
                watch_contacts(data, start + (k + 1) * dt, dt)
                self.flexes.watch(data, dt)
            else:
                # The stages of `mj_step2`, so that forces are read before the integration.
                solve(data)
                mujoco.mj_checkAcc(model, data)
                if breaks:
                    retakes = retakes if k == 0 else 0
                    fate = self.breakage.watch(data, start + (k + 1) * dt, dt, still, retakes=retakes, others=self._asked)
                    if fate is Fate.AGAIN:
                        self._undo(fields, working, dt)
                        return k, fate
                watch_contacts(data, start + (k + 1) * dt, dt)
                mujoco.mj_implicit(model, data)
                watch_sleep(data, start + (k + 1) * dt)
            if working:
                self.work.after_step(data, dt)
            if self._wrench is not None:
                # Of what the engine integrated, less what drivers and fields pushed: counted here, not taken from who gave it.
                self._received += dt * self._taken_in()
            taken += 1
        if authored:
            self.drivers.follow_paths(data, taken, dt)
        self._settle_kinematics()
        for field in fields:
            field.end(data)
        if working:
            self._work += self.work.end(velocities(model, data), dt)
        if self._soft is not None:
            self._soft.take(data.xfrc_applied - self.work.pushes, data, taken * dt)
        return taken, fate

    def _undo(self, fields: Sequence[FieldForces | FlexFields], working: bool, dt: float) -> None:
        """Take back what the present step began: it is taken again."""
        for field in fields:
            field.undo(self.data)
        if working:
            self._work += self.work.end(velocities(self.model, self.data), dt)

    def _taken_in(self) -> F64:
        """Wrenches of others that the engine integrates in this step, per row."""
        assert self._wrench is not None
        applied, ids = self.data.xfrc_applied - self.work.pushes, self.rigid.body_ids
        own = applied[ids]
        if self._soft is not None:
            own -= self._soft.wrench[ids]
        if self.fields:
            own[:, :3] -= self.fields.present
        pieces = self.rigid.kin_rows
        if pieces.any():
            # Pieces of one cluster are pushed together: what the cluster got is theirs as it was given, and its first one's if more.
            own[pieces] = self._wrench[pieces]
            total = np.zeros((self.model.nbody, 3))
            np.add.at(total, ids, own[:, :3] + (self.fields.present if self.fields else 0.0))
            bodies, first = np.unique(np.where(pieces, ids, -1), return_index=True)
            own[first[bodies > 0], :3] += (applied[:, :3] - total)[bodies[bodies > 0]]
        return np.asarray(own + self._absorbed)

    def advance(self, frame: int) -> None:
        """Advance from frame - 1 to `frame`; a frame whose visible surfaces could overlap at its end is redone finer.

        Raises:
            InputError: not the next frame.
        """
        self.begin_frame(frame)
        for level in range(self.settings.refine + 1):
            self.begin_attempt(level)
            self.step_to(frame * self._frame_time)
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
        self._authored = self.ledger.authored_energy(self.data)

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
        self._received[:] = 0.0
        if self._soft is not None:
            self._soft.begin()
        self.fields.begin()

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
        """
        begin = self.time if start is None else start
        self._asked = wrench
        step = self.settings.step / 2**self.refined
        if self._soft is not None:
            self._soft.lay(self.data, loads or {})
        self._taken += self._run(begin, end, step, self._before)
        if self._soft is not None:
            self._soft.lift(self.data)
        self._asked = self._wrench = None
        self.time = end

    def end_attempt(self) -> bool:
        """Whether the frame may end like this; else it is to be attempted again with half the step."""
        self._joint_error = self.ledger.joint_error(self.data)
        last = self.refined == self.settings.refine or not np.isfinite(self.data.qpos).all()
        slow = self.flexes is None or self.flexes.slow_enough
        return bool(last or (slow and self._nearest() >= 0.0))

    def end_frame(self) -> None:
        """The frame that was begun is reached."""
        self._work -= self.ledger.authored_energy(self.data) - self._authored
        self.frame += 1
        self._finish_frame(self._taken, self.settings.step / 2**self.refined)

    def _outside(self) -> F64 | None:
        """What others apply to all bodies, shape (nbody, 6): its work is no driver's."""
        if self._wrench is None:
            return None
        return self._from_others()

    def _from_others(self) -> F64:
        assert self._wrench is not None
        found = spread(self.rigid, self.data, self._wrench)
        return found if self._soft is None else found + self._soft.wrench

    _joint_error = 0.0

    def _settle_kinematics(self) -> None:
        """Bring positions and velocities of bodies up to date with the state, sleeping ones included."""
        mujoco, model, data = self._mj, self.model, self.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        if model.nflex:
            mujoco.mj_flex(model, data)
        if model.ntendon:
            mujoco.mj_tendon(model, data)

    def _collide_all(self) -> None:
        """List the contacts of the present positions, those among sleeping bodies included."""
        flags = self.model.opt.enableflags
        self.model.opt.enableflags = flags & ~int(self._mj.mjtEnableBit.mjENBL_SLEEP)
        self._mj.mj_collision(self.model, self.data)
        self.model.opt.enableflags = flags

    def _nearest(self) -> float:
        """Smallest distance [m] of collision shapes at the present positions, less what visible surfaces stick out.

        What the collision functions list as closer than `GUARD` is measured again by GJK and EPA, which are exact. Pieces of one
        breakable body may lie in one another as deep as crumbles.
        """
        self._collide_all()
        data, model = self.data, self.model
        if not data.ncon:
            return np.inf
        geoms = sides_of(model, data.contact).copy()
        fixed = (np.append(model.geom_contype, model.flex_contype)[geoms] == FIXED[0]).all(axis=1)
        kin = self.rigid.law.kin
        slack = np.zeros(len(geoms)) if kin is None else kin.overlap_of(geoms)
        gaps = data.contact.dist - self.rigid.excess[geoms].sum(axis=1) + slack
        close = np.unique(geoms[(gaps < GUARD) & ~fixed], axis=0)
        nearest, witness = np.inf, np.zeros(6)
        height_field = int(self._mj.mjtGeom.mjGEOM_HFIELD)
        for g, h in close.tolist():
            # Of height fields and elastic bodies there is no more than what is listed.
            if max(g, h) >= model.ngeom or height_field in (model.geom_type[g], model.geom_type[h]):
                mine = (geoms == (g, h)).all(axis=1)
                gap = float(gaps[mine].min())
            else:
                gap = self._mj.mj_geomDistance(model, data, g, h, 2 * GUARD, witness) - float(self.rigid.excess[[g, h]].sum())
                gap += 0.0 if kin is None else float(kin.overlap_of(np.array([[g, h]]))[0])
            nearest = min(nearest, gap - CLEAR)
        return nearest

    # ------------------------------------------------------------------ state

    def _bytes(self) -> bytes:
        mujoco = self._mj
        spec = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        state = np.empty(mujoco.mj_stateSize(self.model, spec))
        mujoco.mj_getState(self.model, self.data, state, spec)
        buffer = io.BytesIO()
        np.lib.format.write_array(buffer, state, allow_pickle=False)
        bonds = self.breakage.memory().decode()
        head = {"work": self._work, "overflows": self._overflows, "relaxation": self.relaxation, "bonds": bonds}
        memory, front = self.monitor.memory(), json.dumps(head).encode()
        sizes = len(front).to_bytes(4, "little"), len(memory).to_bytes(4, "little")
        held = b"".join((sizes[0], front, sizes[1], memory, buffer.getvalue()))
        return b"".join((MAGIC, hashlib.sha256(held).digest(), held))

    def checkpoint(self) -> bytes:
        """The full state; the solver itself continues from exactly these bytes (all bodies awake)."""
        state = self._bytes()
        self.restore(state, self.frame)
        return state

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`.

        Raises:
            EngineError: the bytes are damaged, or not a checkpoint of this model.
        """
        mujoco = self._mj
        if state[: len(MAGIC)] != MAGIC:
            raise EngineError("not a checkpoint of a rigid instance; delete the candidate's checkpoints and bake again")
        start = len(MAGIC) + SEAL_BYTES
        if hashlib.sha256(state[start:]).digest() != state[len(MAGIC) : start]:
            raise EngineError(f"the checkpoint of frame {frame} is damaged; delete it and bake again")
        size = int.from_bytes(state[start : start + 4], "little")
        at = start + 4 + size
        head = json.loads(state[start + 4 : at])
        length = int.from_bytes(state[at : at + 4], "little")
        memory = state[at + 4 : at + 4 + length]
        values = np.lib.format.read_array(io.BytesIO(state[at + 4 + length :]), allow_pickle=False)
        if self.breakage.recall(head["bonds"].encode()):
            self._split(frame * self._frame_time)
        self.breakage.bind(self.rigid)  # solutions and sleepers are no part of a checkpoint
        spec = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        if len(values) != mujoco.mj_stateSize(self.model, spec):
            raise EngineError("checkpoint belongs to another model; delete the candidate's checkpoints and bake again")
        time = frame * self._frame_time
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, values, spec)
        self.drivers.set_model(time)
        set_contact_law(self.rigid, self.settings.contact_steps, self.settings.step)
        if self.drivers.kinematic:
            self.drivers.plan_paths(time, self.settings.step, 0)
            self.drivers.follow_paths(self.data, 0, self.settings.step)
        self._settle_kinematics()
        self.monitor.recall(memory)
        self.monitor.wake_all(time)
        self._work, self._overflows, self.relaxation = head["work"], head["overflows"], head["relaxation"]
        self.frame = frame

    # ------------------------------------------------------------------ output

    def _finish_frame(self, taken: int, step: float) -> None:
        data = self.data
        ids = self.rigid.body_ids
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
            "iterations_max": self.monitor.iterations,
            "iterations_capped": self.monitor.capped,
            "overflows": self._overflows,
            "joint_error": self._joint_error,
            **({} if self._soft is None else {"soft_exchange_work": self._soft.work}),
            **({"fracture_energy": self.breakage.energy} if self.breakage else {}),
        }
        start = max(0, self.frame - 1) * self._frame_time
        self._data = {
            "position": data.xpos[ids] - np.einsum("nij,nj->ni", data.xmat[ids].reshape(-1, 3, 3), self.rigid.offsets),
            "quaternion": data.xquat[ids].copy(),
            "velocity": row_velocities(self.rigid, data, speeds),
            "angular_velocity": speeds[1][ids],
            "asleep": (data.body_awake[ids] == 0).astype(np.uint8) if len(ids) else np.zeros(0, dtype=np.uint8),
            "joint": data.qpos[self.rigid.joint_qpos].copy() if self.rigid.joints else np.zeros(0),
            "driver/active": self.drivers.active(start, self.frame * self._frame_time),
            **({"exchange/impulse": self._received.copy()} if self._coupled else {}),
            **({"field/impulse": self.fields.impulse.copy()} if self.fields else {}),
            **self.monitor.arrays(),
            **({} if self.flexes is None else self.flexes.channels(data)),
            **({} if self._soft is None else {"exchange/soft": self._soft.impulse.copy()}),
            **(self.breakage.arrays() if self.breakage else {}),
            **{f"record/{name}": np.float64(value) for name, value in records.items()},
        }

    def frame_data(self) -> Mapping[str, Any]:
        """Channels and records of the present frame."""
        return self._data

    def channels(self) -> tuple[Channel, ...]:
        """What `frame_data` holds, records apart."""
        soft = () if self.flexes is None else (*SOFT_CHANNELS, *((SOFT_FIELDS,) if self.flexes.fields else ()))
        soft = soft if self._soft is None else (*soft, SOFT_EXCHANGED)
        more = (*((EXCHANGED,) if self._coupled else ()), *((FIELDS,) if self.fields else ()))
        return (*CHANNELS, *soft, *more, *(BROKEN if self.breakage else ()))

    def index(self) -> CacheIndex:
        """Names behind the channels' rows."""
        return CacheIndex(
            solver=self.name,
            engine="mujoco",
            fps=self.spec.simulation.fps,
            frames=self.spec.simulation.frames,
            bodies=self.rigid.bodies,
            colliders=self.rigid.colliders,
            joints=self.rigid.joints,
            drivers=self.drivers.names,
            settings="",
            breakables=self.breakage.names,
            versions={"mujoco": self._mj.__version__, "numpy": np.__version__},
            deformables=tuple(f"{f.entity}/{f.part}" for f in self.rigid.flexes),
            vertices=tuple(len(f.lattice.mesh.vertices) for f in self.rigid.flexes),
        )

    def ports(self) -> tuple[Port, ...]:
        """Every part of every free body takes wrenches and gives motion."""
        return tuple(
            Port(entity, part.part, "wrench", "both")
            for entity in self.members
            if self.spec.entities[entity].motion == "dynamic"
            and not isinstance(self.spec.entities[entity].physics, ElasticPhysics)
            for part in self.built[entity].parts
        )

    def respond(self, port: Port, wrench: F64) -> F64:
        """Acceleration (6,) [linear, angular] of the port's body under a wrench (6,) at its centre of mass."""
        mujoco, model, data = self._mj, self.model, self.data
        part = next(p for p in self.built[port.entity].parts if p.part == port.part)
        body = int(self.rigid.body_ids[self.rigid.bodies.index(f"{port.entity}/{part.body}")])
        force = np.zeros(model.nv)
        mujoco.mj_crb(model, data)
        mujoco.mj_factorM(model, data)
        mujoco.mj_applyFT(model, data, wrench[:3], wrench[3:], data.xipos[body], body, force)
        answer = np.zeros((1, model.nv))
        mujoco.mj_solveM(model, data, answer, force[None])
        linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jacBodyCom(model, data, linear, angular, body)
        return np.concatenate([linear @ answer[0], angular @ answer[0]])

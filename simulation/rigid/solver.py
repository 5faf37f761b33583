"""Rigid bodies, joints and ropes on MuJoCo (R61). See README.md for scheme, limits and sources."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.built import BuiltEntity
from ...worlds.cache import CacheIndex
from ...worlds.errors import EngineError, InputError
from ...worlds.spec import RigidSettings, WorldSpec
from ..protocol import Channel, Port
from .drivers import Drivers
from .model import RigidModel, build_model, set_contact_law
from .monitor import ContactMonitor

__all__ = ["SolverRigid"]

RELAX_STEPS = 400
"""Most overdamped steps that open the collision skins at frame 0."""
RELAX_TOLERANCE = 0.02
"""Relaxation ends when no contact lies deeper inside its skin than this fraction of it."""
CHANNELS = (
    Channel("position", "f8", "m", ("bodies", "3"), "body"),
    Channel("quaternion", "f8", "1", ("bodies", "4"), "body"),
    Channel("velocity", "f8", "m/s", ("bodies", "3"), "body"),
    Channel("angular_velocity", "f8", "rad/s", ("bodies", "3"), "body"),
    Channel("asleep", "u1", "1", ("bodies",), "body"),
    Channel("joint", "f8", "rad or m", ("joints",), "joint"),
    Channel("contact/pair", "i4", "1", ("pairs", "2"), "pair"),
    Channel("contact/impulse", "f8", "N s", ("pairs",), "pair"),
    Channel("contact/max_force", "f8", "N", ("pairs",), "pair"),
    Channel("contact/min_gap", "f8", "m", ("pairs",), "pair"),
    Channel("event/time", "f8", "s", ("events",), "event"),
    Channel("event/pair", "i4", "1", ("events", "2"), "event"),
    Channel("event/point", "f8", "m", ("events", "3"), "event"),
    Channel("event/speed", "f8", "m/s", ("events",), "event"),
    Channel("event/impulse", "f8", "N s", ("events",), "event"),
    Channel("driver/active", "u1", "1", ("drivers",), "frame"),
)


class SolverRigid:
    """One MuJoCo instance. Between two checkpoints, equal bytes and settings give equal frames."""

    def __init__(self, spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str) -> None:
        self.spec, self.built, self.name = spec, built, name
        instance = spec.simulation.solvers[name]
        self.members = tuple(dict.fromkeys(instance.members))
        self.settings: RigidSettings = instance.settings
        self._frame_time = 1.0 / spec.simulation.fps
        self._work = 0.0
        self._refined = 0
        self._overflows = 0
        self.relaxation = 0.0
        """Largest displacement of a body when the skins were opened [m]."""

    def prepare(self) -> None:
        """Compile, open the skins, run the preroll, set the declared velocities: the state at frame 0.

        Raises:
            InputError: the model cannot be built.
            EngineError: bodies overlap so much at frame 0 that the skins cannot open.
        """
        import mujoco

        self._mj = mujoco
        self.rigid: RigidModel = build_model(self.spec, self.built, self.members, self.settings)
        self.model = self.rigid.model
        self.data = mujoco.MjData(self.model)
        self.drivers = Drivers(self.spec, self.rigid, frozenset(self.members))
        self.monitor = ContactMonitor(self.rigid)
        kinematic = [b.split("/", 1)[0] in self.drivers.kinematic for b in self.rigid.bodies]
        self._free = self.rigid.body_ids[~np.array(kinematic, dtype=bool)] if kinematic else self.rigid.body_ids
        self._kinematic_dofs = np.array(
            [d for e in sorted(self.drivers.kinematic) for d in self.drivers._dofs[e]], dtype=np.int64
        )
        preroll = self.spec.simulation.preroll
        start = -preroll
        self._relax(start)
        if preroll > 0:
            self._run(start, 0.0, self.settings.step)
        self.drivers.set_model(0.0)
        mujoco.mj_kinematics(self.model, self.data)
        self.drivers.start_velocities(self.data)
        self.drivers.follow_paths(self.data, 0.0)
        self.frame = 0
        self._work = 0.0
        self.monitor.begin()
        self.restore(self._bytes(), 0)
        self._finish_frame(0, self.settings.step)

    def _relax(self, start: float) -> None:
        """Open the skins: overdamped steps without gravity until no contact lies inside its skin.

        Bodies placed exactly in contact would start inside the skin and be thrown apart; this moves each by at
        most about one skin per contact below it, and is listed in the approximation register.
        """
        mujoco, model, data = self._mj, self.model, self.data
        if self.settings.skin == 0:
            return
        self.drivers.set_model(start, free=True)
        self.drivers.follow_paths(data, start)
        gravity = model.opt.gravity.copy()
        flags, damping = model.opt.enableflags, model.geom_solref.copy()
        pair_damping, margins = model.pair_solref.copy(), model.geom_margin.copy()
        pair_margins = model.pair_margin.copy()
        model.opt.gravity[:] = 0.0
        model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        set_contact_law(self.rigid, self.settings.contact_steps, self.settings.step)
        mujoco.mj_forward(model, data)
        before = data.xpos.copy()
        for k in range(RELAX_STEPS):
            grow = min(1.0, (k + 1) / (RELAX_STEPS / 4))
            model.geom_margin[:] = margins * grow
            model.pair_margin[:] = pair_margins * grow
            mujoco.mj_step(model, data)
            data.qvel[:] = 0.0
            deepest = float((data.contact.dist - 2 * self.settings.skin).min()) if data.ncon else 0.0
            if grow == 1.0 and deepest > -2 * RELAX_TOLERANCE * self.settings.skin:
                break
        model.opt.gravity[:] = gravity
        model.opt.enableflags = flags
        model.geom_margin[:], model.pair_margin[:] = margins, pair_margins
        model.geom_solref[:], model.pair_solref[:] = damping, pair_damping
        mujoco.mj_kinematics(model, data)
        moved = np.linalg.norm(data.xpos - before, axis=1)
        if not np.isfinite(moved).all():
            raise EngineError("opening the collision skins at frame 0 diverged; check interpenetration at frame 0")
        self.relaxation = float(moved[self.rigid.body_ids].max(initial=0.0))
        data.qacc_warmstart[:] = 0.0
        data.time = 0.0

    def max_stable_dt(self) -> float:
        """Step at which the fastest body crosses half a skin's worth of contact: skin / (1.5 v); at least 20 us [s]."""
        speed = float(np.abs(self._velocities()[0]).max(initial=0.0))
        skin = 2 * max(self.settings.skin, 1e-5)
        return max(2e-5, skin / (1.5 * speed)) if speed > 0 else self.settings.step

    # ------------------------------------------------------------------ stepping

    def _run(self, start: float, end: float, step: float) -> int:
        """Step from `start` to `end` [s], switching drivers exactly at their times; returns the steps taken."""
        mujoco, model, data, taken = self._mj, self.model, self.data, 0
        stops = [start, *self.drivers.switch_times(start, end), end]
        track_work = len(self._kinematic_dofs) > 0 or model.nu > 0 or bool(self.drivers.names)
        for t0, t1 in zip(stops, stops[1:], strict=False):
            count = max(1, round((t1 - t0) / step))
            dt = (t1 - t0) / count
            if dt > step * 1.0001:
                count += 1
                dt = (t1 - t0) / count
            set_contact_law(self.rigid, self.settings.contact_steps, dt)
            self.drivers.set_model(t0)
            self.drivers.set_data(data, t0)
            for k in range(count):
                if len(self._kinematic_dofs):
                    self.drivers.follow_paths(data, t0 + k * dt)
                mujoco.mj_step(model, data)
                self.monitor.after_step(data, t0 + (k + 1) * dt, dt)
                if track_work:
                    self._work += self._power() * dt
            taken += count
        if len(self._kinematic_dofs):
            self.drivers.follow_paths(data, end)
        return taken

    def _power(self) -> float:
        """Power of drivers into the free bodies [W]."""
        data = self.data
        power = 0.0
        if len(self._kinematic_dofs):
            dofs = self._kinematic_dofs
            power -= float(data.qfrc_constraint[dofs] @ data.qvel[dofs])
        if self.model.nu:
            power += float(data.actuator_force @ data.actuator_velocity)
        if data.xfrc_applied.any():
            power += float((data.xfrc_applied * self._body_twists()).sum())
        return power

    def _body_twists(self) -> F64:
        linear, angular = self._velocities()
        return np.concatenate([linear, angular], axis=1)

    def _velocities(self) -> tuple[F64, F64]:
        """Velocities of all bodies' centres of mass and angular velocities, world axes, each (nbody, 3)."""
        data, model = self.data, self.model
        angular = data.cvel[:, :3]
        arm = data.xipos - data.subtree_com[model.body_rootid]
        return data.cvel[:, 3:] + np.cross(angular, arm), angular.copy()

    def advance(self, frame: int) -> None:
        """Advance from frame - 1 to `frame`; a frame whose collision shapes overlap at its end is redone finer.

        Raises:
            InputError: not the next frame.
            EngineError: the state is no longer finite.
        """
        if frame != self.frame + 1:
            raise InputError(f"advance({frame}) after frame {self.frame}; the next frame is {self.frame + 1}")
        mujoco, model = self._mj, self.model
        start, end = (frame - 1) * self._frame_time, frame * self._frame_time
        saved = mujoco.MjData(model) if self._spare is None else self._spare
        mujoco.mj_copyData(saved, model, self.data)
        memory, work = self.monitor.memory(), self._work
        for level in range(self.settings.refine + 1):
            self.monitor.begin()
            step = self.settings.step / 2**level
            taken = self._run(start, end, step)
            self._settle_kinematics()
            if not np.isfinite(self.data.qpos).all() or self._nearest() >= 0.0:
                break
            if level < self.settings.refine:
                mujoco.mj_copyData(self.data, model, saved)
                self.monitor.recall(memory)
                self._work = work
        self._spare = saved
        self._refined = level
        self.frame = frame
        self._finish_frame(taken, step)

    _spare: Any = None

    def _settle_kinematics(self) -> None:
        """Bring positions and velocities of bodies up to date with the state, sleeping ones included."""
        mujoco, model, data = self._mj, self.model, self.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)

    def _nearest(self) -> float:
        """Smallest distance of collision shapes in the present positions [m]; +inf without near pairs.

        Uses the contacts of the last step as the list of near pairs: what is not within a skin then cannot overlap
        one step later.
        """
        data, model = self.data, self.model
        if not data.ncon:
            return np.inf
        pairs = np.unique(data.contact.geom[data.contact.dist < self.settings.skin], axis=0)
        nearest, witness = np.inf, np.zeros(6)
        for g, h in pairs:
            if g >= 0 and h >= 0:
                nearest = min(nearest, self._mj.mj_geomDistance(model, data, int(g), int(h), 2 * self.settings.skin, witness))
        return nearest

    # ------------------------------------------------------------------ state

    def _bytes(self) -> bytes:
        mujoco = self._mj
        spec = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        state = np.empty(mujoco.mj_stateSize(self.model, spec))
        mujoco.mj_getState(self.model, self.data, state, spec)
        buffer = io.BytesIO()
        np.lib.format.write_array(buffer, state, allow_pickle=False)
        head = {"work": self._work, "overflows": self._overflows, "relaxation": self.relaxation}
        memory = self.monitor.memory()
        front = json.dumps(head).encode()
        return b"WARS1" + len(front).to_bytes(4, "little") + front + len(memory).to_bytes(4, "little") + memory + buffer.getvalue()

    def checkpoint(self) -> bytes:
        """The full state; the solver itself continues from exactly these bytes (all bodies awake)."""
        state = self._bytes()
        self.restore(state, self.frame)
        return state

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`.

        Raises:
            EngineError: the bytes are not a checkpoint of this model.
        """
        mujoco = self._mj
        if state[:5] != b"WARS1":
            raise EngineError("not a checkpoint of a rigid instance; delete the candidate's checkpoints and bake again")
        size = int.from_bytes(state[5:9], "little")
        head = json.loads(state[9 : 9 + size])
        at = 9 + size
        length = int.from_bytes(state[at : at + 4], "little")
        memory = state[at + 4 : at + 4 + length]
        values = np.lib.format.read_array(io.BytesIO(state[at + 4 + length :]), allow_pickle=False)
        spec = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        if len(values) != mujoco.mj_stateSize(self.model, spec):
            raise EngineError("checkpoint belongs to another model; delete the candidate's checkpoints and bake again")
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, values, spec)
        self.drivers.set_model(frame * self._frame_time)
        set_contact_law(self.rigid, self.settings.contact_steps, self.settings.step)
        self._settle_kinematics()
        self.monitor.recall(memory)
        self._work, self._overflows, self.relaxation = head["work"], head["overflows"], head["relaxation"]
        self.frame = frame

    # ------------------------------------------------------------------ output

    def _finish_frame(self, taken: int, step: float) -> None:
        self._settle_kinematics()
        data, model = self.data, self.model
        ids = self.rigid.body_ids
        linear, angular = self._velocities()
        if not np.isfinite(data.qpos).all() or not np.isfinite(data.qvel).all():
            linear = np.where(np.isfinite(linear), linear, np.nan)
        # An engine warning is an overflow or a bad state, never noise.
        self._overflows += int(sum(w.number for w in data.warning))
        for warning in data.warning:
            warning.number = 0
        free, mass = self._free, model.body_mass[self._free]
        spin = np.einsum("nji,nj->ni", data.ximat[free].reshape(-1, 3, 3), angular[free])
        kinetic = 0.5 * float(mass @ (linear[free] ** 2).sum(1)) + 0.5 * float((model.body_inertia[free] * spin**2).sum())
        potential = -float(mass @ (data.xipos[free] @ model.opt.gravity))
        potential += self._spring_energy()
        momentum = mass @ linear[free] if len(free) else np.zeros(3)
        speed = float(np.linalg.norm(linear[ids], axis=1).max(initial=0.0))
        reach = np.zeros(model.nbody)
        np.maximum.at(reach, model.geom_bodyid, model.geom_rbound + np.linalg.norm(model.geom_pos, axis=1))
        surface = np.linalg.norm(linear, axis=1) + np.linalg.norm(angular, axis=1) * reach
        asleep = (data.body_awake[ids] == 0).astype(np.uint8) if len(ids) else np.zeros(0, dtype=np.uint8)
        start = max(0, self.frame - 1) * self._frame_time
        self._data = {
            "position": data.xpos[ids].copy(),
            "quaternion": data.xquat[ids].copy(),
            "velocity": linear[ids],
            "angular_velocity": angular[ids],
            "asleep": asleep,
            "joint": data.qpos[self.rigid.joint_qpos].copy() if self.rigid.joints else np.zeros(0),
            "driver/active": self.drivers.active(start, self.frame * self._frame_time),
            **self.monitor.arrays(),
            **{
                f"record/{name}": np.float64(value)
                for name, value in {
                    "kinetic_energy": kinetic,
                    "potential_energy": potential,
                    "driver_work": self._work,
                    "momentum_x": momentum[0],
                    "momentum_y": momentum[1],
                    "momentum_z": momentum[2],
                    "mass": float(mass.sum()),
                    "body_count": len(ids),
                    "max_speed": speed,
                    "max_travel_per_step": float(surface[ids].max(initial=0.0)) * step,
                    "steps": taken,
                    "step": step,
                    "contacts_max": self.monitor.max_contacts,
                    "iterations_max": self.monitor.iterations,
                    "iterations_capped": self.monitor.capped,
                    "overflows": self._overflows,
                    "joint_error": self._joint_error(),
                }.items()
            },
        }

    def _spring_energy(self) -> float:
        """Energy stored in joint springs and tendons [J]."""
        mujoco, model, data = self._mj, self.model, self.data
        if not model.jnt_stiffness.any() and not model.ntendon:
            return 0.0
        mujoco.mj_tendon(model, data)
        gravity = model.opt.gravity.copy()
        model.opt.gravity[:] = 0.0
        mujoco.mj_energyPos(model, data)
        model.opt.gravity[:] = gravity
        return float(data.energy[0])

    def _joint_error(self) -> float:
        """Largest gap of a weld or connect constraint [m]; joints of the kinematic tree are exact."""
        data, mujoco = self.data, self._mj
        if not data.ne:
            return 0.0
        rows = data.efc_type[: data.nefc] == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        return float(np.abs(data.efc_pos[: data.nefc][rows]).max(initial=0.0))

    def frame_data(self) -> Mapping[str, Any]:
        """Channels and records of the present frame."""
        return self._data

    def channels(self) -> tuple[Channel, ...]:
        """What `frame_data` holds, records apart."""
        return CHANNELS

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
            versions={"mujoco": self._mj.__version__, "numpy": np.__version__},
        )

    def ports(self) -> tuple[Port, ...]:
        """Every part of every free body takes wrenches and gives motion."""
        return tuple(
            Port(entity, part.part, "wrench", "both")
            for entity in self.members
            if self.spec.entities[entity].motion == "dynamic"
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



"""Authored drivers on a MuJoCo model: holds, kinematic paths, forces, motors, switches (R18)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64, pose_of, quaternion_product
from ...worlds.errors import InputError
from ...worlds.spec import DetachDriver, ForceDriver, MotorDriver, PathDriver, ReleaseDriver, RigidPhysics, WorldSpec
from .model import RigidModel

__all__ = ["HOLD_FACTOR", "Drivers"]

HOLD_FACTOR = 1e10
"""Armature of a held or kinematic body, in multiples of its own mass and inertia: 1e-9 m of sag in 10 s."""
_SLACK = 1e-9


class Path:
    """Poses over time: shape-preserving cubic in position, slerp in orientation."""

    def __init__(self, driver: PathDriver) -> None:
        from scipy.interpolate import PchipInterpolator
        from scipy.spatial.transform import Rotation, Slerp

        keys = sorted(driver.keys.values(), key=lambda k: k.time)
        times = np.array([k.time for k in keys])
        if (np.diff(times) <= 0).any():
            raise InputError(f"path of {driver.entity!r}: key times must differ; got {times.tolist()}")
        poses = [pose_of(k.pose) for k in keys]
        self.first, self.last = float(times[0]), float(times[-1])
        self._position = PchipInterpolator(times, np.array([p.position for p in poses]))
        self._velocity = self._position.derivative()
        quats = np.array([p.quaternion for p in poses])
        self._turn = Slerp(times, Rotation.from_quat(quats[:, [1, 2, 3, 0]]))

    def at(self, time: float) -> tuple[F64, F64, F64, F64]:
        """Position (3,), quaternion (4,), velocity (3,), angular velocity in body axes (3,) at `time` [s]."""
        t = min(max(time, self.first), self.last)
        quaternion = self._turn(t).as_quat()[[3, 0, 1, 2]]
        if not self.first <= time < self.last:
            return self._position(t), quaternion, np.zeros(3), np.zeros(3)
        step = min(1e-4, self.last - t)
        turn = (self._turn(t).inv() * self._turn(t + step)).as_rotvec() / step
        return self._position(t), quaternion, self._velocity(t), turn


class Drivers:
    """Applies all drivers of one instance; holds are part of the model's armature, so they survive any state."""

    def __init__(self, spec: WorldSpec, rigid: RigidModel, members: frozenset[str]) -> None:
        self.rigid, self.spec = rigid, spec
        model = rigid.model
        self.names = tuple(
            n
            for n, d in spec.simulation.drivers.items()
            if (getattr(d, "entity", None) in members) or (getattr(d, "joint", None) in spec.simulation.joints)
        )
        self._drivers = {n: spec.simulation.drivers[n] for n in self.names}
        self._dofs: dict[str, Any] = {}
        for row, body in enumerate(rigid.bodies):
            entity = body.split("/", 1)[0]
            start, count = model.body_dofadr[rigid.body_ids[row]], model.body_dofnum[rigid.body_ids[row]]
            self._dofs.setdefault(entity, []).extend(range(start, start + count))
        self._qpos = {e: int(model.jnt_qposadr[model.dof_jntid[d[0]]]) for e, d in self._dofs.items() if d}
        self._native_armature = model.dof_armature.copy()
        self._weight = self._inertia_scale()
        self._paths = {d.entity: (n, Path(d)) for n, d in self._drivers.items() if isinstance(d, PathDriver)}
        for entity in self._paths:
            if spec.entities[entity].motion != "kinematic":
                raise InputError(f"path driver moves {entity!r}, which must have motion 'kinematic', not {spec.entities[entity].motion!r}")
        self._native_eq = model.eq_active0.copy()
        self._stiffness = model.tendon_stiffness.copy()
        self._tendon_damping = model.tendon_damping.copy()
        self._effort = model.actuator_forcerange.copy()
        self._release: dict[str, float] = {}
        for driver in self._drivers.values():
            if isinstance(driver, ReleaseDriver):
                self._release[driver.entity] = max(driver.time, self._release.get(driver.entity, 0.0))
        for entity, contract in spec.entities.items():
            moving = isinstance(contract.physics, RigidPhysics) and any((*contract.physics.linear_velocity, *contract.physics.angular_velocity))
            if entity in self._dofs and moving:
                self._release.setdefault(entity, 0.0)
        self.kinematic = frozenset(e for e in self._dofs if spec.entities[e].motion == "kinematic")

    def _inertia_scale(self) -> F64:
        """Mass or inertia seen by each degree of freedom, shape (nv,)."""
        import mujoco

        data = mujoco.MjData(self.rigid.model)
        mujoco.mj_forward(self.rigid.model, data)
        full = np.zeros((self.rigid.model.nv, self.rigid.model.nv))
        mujoco.mj_fullM(self.rigid.model, data, full)
        return np.maximum(np.diag(full), 1e-9)

    def held(self, time: float) -> frozenset[str]:
        """Entities that a hold or path fixes at `time`."""
        return self.kinematic | {e for e, t in self._release.items() if time < t - _SLACK}

    def switch_times(self, start: float, end: float) -> list[float]:
        """Times in (start, end) at which a driver switches, sorted."""
        times: set[float] = set(self._release.values())
        for driver in self._drivers.values():
            if isinstance(driver, ForceDriver | MotorDriver):
                times |= {driver.start, driver.end}
            elif isinstance(driver, DetachDriver):
                times.add(driver.time)
        return sorted(t for t in times if start + _SLACK < t < end - _SLACK)

    def set_model(self, time: float, *, free: bool = False) -> None:
        """Write everything that `time` decides into the model; `free` opens all holds but paths (for relaxation)."""
        model = self.rigid.model
        model.dof_armature[:] = self._native_armature
        for entity in self.kinematic if free else self.held(time):
            dofs = self._dofs.get(entity, [])
            model.dof_armature[dofs] = HOLD_FACTOR * self._weight[dofs]
        for name, driver in self._drivers.items():
            if isinstance(driver, MotorDriver) and name in self.rigid.actuator_of:
                row = self.rigid.actuator_of[name]
                on = driver.start - _SLACK <= time < driver.end - _SLACK
                model.actuator_forcerange[row] = self._effort[row] if on else (0.0, 0.0)
            if isinstance(driver, DetachDriver) and driver.joint in self.rigid.tendon_of and time >= driver.time - _SLACK:
                row = self.rigid.tendon_of[driver.joint]
                model.tendon_stiffness[row] = 0.0
                model.tendon_damping[row] = 0.0
            elif isinstance(driver, DetachDriver) and driver.joint in self.rigid.tendon_of:
                row = self.rigid.tendon_of[driver.joint]
                model.tendon_stiffness[row] = self._stiffness[row]
                model.tendon_damping[row] = self._tendon_damping[row]

    def set_data(self, data: Any, time: float) -> None:
        """Write forces, controls and switches that hold from `time` on."""
        model = self.rigid.model
        data.xfrc_applied[:] = 0.0
        data.eq_active[:] = self._native_eq
        for name, driver in self._drivers.items():
            if isinstance(driver, ForceDriver) and driver.start - _SLACK <= time < driver.end - _SLACK:
                row = self.rigid.bodies.index(f"{driver.entity}/body")
                data.xfrc_applied[self.rigid.body_ids[row]] += (*driver.force, *driver.torque)
            elif isinstance(driver, MotorDriver) and name in self.rigid.actuator_of:
                data.ctrl[self.rigid.actuator_of[name]] = driver.velocity
            elif isinstance(driver, DetachDriver) and driver.joint in self.rigid.eq_of and time >= driver.time - _SLACK:
                data.eq_active[self.rigid.eq_of[driver.joint]] = 0
        for entity in self.held(time) - self.kinematic:
            dofs = self._dofs.get(entity, [])
            data.qvel[dofs] = 0.0
        del model

    def follow_paths(self, data: Any, time: float) -> None:
        """Put kinematic bodies on their paths, with their velocities, at `time`."""
        for entity in self.kinematic:
            if entity not in self._paths:
                data.qvel[self._dofs[entity]] = 0.0
                continue
            position, quaternion, velocity, turn = self._paths[entity][1].at(time)
            at, dof = self._qpos[entity], self._dofs[entity][0]
            data.qpos[at : at + 3], data.qpos[at + 3 : at + 7] = position, quaternion
            data.qvel[dof : dof + 3], data.qvel[dof + 3 : dof + 6] = velocity, turn

    def start_velocities(self, data: Any) -> None:
        """Set the declared velocities at frame 0."""
        model = self.rigid.model
        for entity, contract in self.spec.entities.items():
            dofs = self._dofs.get(entity)
            if not dofs or not isinstance(contract.physics, RigidPhysics) or entity in self.kinematic:
                continue
            linear, angular = np.array(contract.physics.linear_velocity), np.array(contract.physics.angular_velocity)
            if not linear.any() and not angular.any():
                continue
            if model.dof_jntid[dofs[0]] < 0 or len(dofs) != 6:
                raise InputError(f"entity {entity!r} hangs on a joint; give it its motion with a motor or force driver")
            at = self._qpos[entity]
            conjugate = data.qpos[at + 3 : at + 7] * np.array([1.0, -1.0, -1.0, -1.0])
            local = quaternion_product(quaternion_product(conjugate, np.array([0.0, *angular])), data.qpos[at + 3 : at + 7])[1:]
            body = model.dof_bodyid[dofs[0]]
            arm = data.xpos[body] - data.xipos[body]
            data.qvel[dofs[:3]] = linear + np.cross(angular, arm)
            data.qvel[dofs[3:6]] = local

    def active(self, start: float, end: float) -> Any:
        """Which drivers acted during [start, end], u1, shape (drivers,)."""
        flags = []
        for driver in self._drivers.values():
            if isinstance(driver, ReleaseDriver | DetachDriver):
                flags.append(start - _SLACK <= driver.time < end - _SLACK)
            elif isinstance(driver, PathDriver):
                times = [k.time for k in driver.keys.values()]
                flags.append(min(times) < end and max(times) > start)
            else:
                flags.append(driver.start < end - _SLACK and driver.end > start + _SLACK)
        return np.array(flags, dtype=np.uint8)

"""Authored drivers on a MuJoCo model: holds, kinematic paths, forces, motors, switches (R18)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...worlds.arrays import F64, pose_of
from ...worlds.errors import InputError
from ...worlds.fields import acting_on
from ...worlds.spec import DetachDriver, FieldDriver, ForceDriver, MotorDriver, PathDriver, ReleaseDriver, WorldSpec
from ..protocol import Intervention
from .flex_contacts import part_flexes
from .holds import Holds
from .model import RigidModel
from .start import set_velocities

__all__ = ["Drivers"]

_SLACK = 1e-9
"""[s] Times this close are equal."""
_MIN_AWAKE = 10
"""MuJoCo's `mjMINAWAKE`: steps at rest before a body may sleep."""
_TURN_STEP = 1e-4
"""[s] Interval over which the angular velocity of a path is taken."""


@dataclass(frozen=True)
class PathSamples:
    """Path of one body at the ends of n steps: arrays of n + 1 rows."""

    qpos: int
    dof: int
    poses: F64
    """Position and quaternion, shape (n + 1, 7)."""
    twists: F64
    """Velocity in world axes and angular velocity in body axes, shape (n + 1, 6)."""


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

    def sample(self, times: F64) -> tuple[F64, F64]:
        """Poses (n, 7) and twists (n, 6) at `times` [s], shape (n,); at rest before the first key and from the last on."""
        t = np.clip(times, self.first, self.last)
        ahead = np.minimum(t + _TURN_STEP, self.last)
        here = self._turn(t)
        spin = (here.inv() * self._turn(ahead)).as_rotvec() / np.maximum(ahead - t, 1e-12)[:, None]
        twists = np.concatenate([self._velocity(t), spin], axis=1)
        twists[(times < self.first) | (times >= self.last)] = 0.0
        return np.concatenate([self._position(t), here.as_quat()[:, [3, 0, 1, 2]]], axis=1), twists


def _moved(rigid: RigidModel) -> tuple[dict[str, list[int]], dict[str, list[int]]]:
    """Degrees of freedom, and bodies of the model, per moving entity."""
    model = rigid.model
    dofs: dict[str, list[int]] = {}
    bodies: dict[str, list[int]] = {}
    known: set[int] = set()
    for row, body in enumerate(rigid.bodies):
        entity, own = body.split("/", 1)[0], int(rigid.body_ids[row])
        start, count = int(model.body_dofadr[own]), int(model.body_dofnum[own])
        of_entity, its_bodies = dofs.setdefault(entity, []), bodies.setdefault(entity, [])
        if count and own not in known:  # pieces bonded to one another share a body, pieces bonded to the world have none
            of_entity.extend(range(start, start + count))
            its_bodies.append(own)
            known.add(own)
    for soft in rigid.flexes:
        # Releases and interventions hold an elastic body by its nodes.
        nodes = [model.body(n).id for n in soft.own]
        dofs[soft.entity] = [int(model.body_dofadr[n]) + k for n in nodes for k in range(3)]
        bodies[soft.entity] = nodes
    return dofs, bodies


def _welded(rigid: RigidModel) -> tuple[dict[str, str], dict[str, list[int]]]:
    """Whom entities are welded to that move with another one's degrees of freedom, and their own bodies of the model."""
    model, owner = rigid.model, {int(rigid.body_ids[row]): body.split("/", 1)[0] for row, body in enumerate(rigid.bodies)}
    carrier: dict[str, str] = {}
    bodies: dict[str, list[int]] = {}
    for own, entity in owner.items():
        root = int(model.body_weldid[own])
        if not int(model.body_dofnum[own]) and owner.get(root, entity) != entity:
            carrier[entity] = owner[root]
            bodies.setdefault(entity, []).append(own)
    return carrier, bodies


class Drivers:
    """Applies all drivers of one instance.

    Args:
        spec: the specification.
        rigid: the compiled model.
        members: entities of the instance.
        intervention: drivers taken away and entities held from outside.

    Raises:
        InputError: a driver acts on what cannot follow it.
    """

    def __init__(
        self, spec: WorldSpec, rigid: RigidModel, members: frozenset[str], intervention: Intervention | None = None
    ) -> None:
        self.rigid, self.spec = rigid, spec
        done = intervention or Intervention()
        self._carrier, welded = _welded(rigid)
        held = frozenset(self._carrier.get(e, e) for e in done.held & members)
        self._without, self._stopped, self._since = done.without, held, done.since
        model, plan = rigid.model, spec.simulation
        self.names = tuple(
            n
            for n, d in plan.drivers.items()
            if (getattr(d, "entity", None) in members)
            or (isinstance(d, FieldDriver) and not members.isdisjoint(acting_on(spec, d)))
            or (getattr(d, "joint", None) in plan.joints and plan.joints[d.joint].child in members)  # type: ignore[union-attr]
        )
        self._drivers = {n: plan.drivers[n] for n in self.names}
        self._dofs, self._bodies = _moved(rigid)
        self._pushed = self._bodies | welded
        """Bodies of the model that a force on an entity pushes."""
        free = {e: d[0] for e, d in self._dofs.items() if d and self._is_free(d[0])}
        self._free = {e: int(model.jnt_qposadr[model.dof_jntid[d]]) for e, d in free.items()}
        self.kinematic = frozenset(e for e in self._dofs if spec.entities[e].motion == "kinematic")
        self.kinematic_dofs = np.array([d for e in sorted(self.kinematic) for d in self._dofs[e]], dtype=np.int64)
        self._require_followable()
        self._paths = {d.entity: Path(d) for d in self._drivers.values() if isinstance(d, PathDriver)}
        # Times [s] at which an intervention stops a path: at its first key where its driver is taken away.
        self._until = dict.fromkeys(self._stopped & self._paths.keys(), self._since)
        self._until |= {
            d.entity: self._paths[d.entity].first
            for n, d in self._drivers.items()
            if n in self._without and isinstance(d, PathDriver)
        }
        self.holds = Holds(model, self._dofs, self._bodies)
        self._native_eq = model.eq_active0.copy()
        self._stiffness, self._tendon_damping = model.tendon_stiffness.copy(), model.tendon_damping.copy()
        self._effort = model.actuator_forcerange.copy()
        self._excludes = model.exclude_signature.copy()
        self._release = self._releases()
        ropes = [(rigid.tendon_of[n], n) for n in rigid.tendon_of if getattr(plan.joints[n], "rope", False)]
        self._ropes = np.array([row for row, _ in ropes if self._tendon_damping[row] > 0], dtype=np.int64)
        self.has_ropes = len(self._ropes) > 0
        """True if `slacken` has anything to do."""
        self._pose: Any = None
        self._samples: list[PathSamples] = []

    def _releases(self) -> dict[str, float]:
        """Time [s] until which each entity is held: to its release, or to frame 0 where it starts with a speed."""
        found: dict[str, float] = {}
        for name, driver in self._drivers.items():
            if isinstance(driver, ReleaseDriver):
                time = np.inf if name in self._without else driver.time
                held = self._carrier.get(driver.entity, driver.entity)
                found[held] = max(time, found.get(held, 0.0))
        for entity, contract in self.spec.entities.items():
            physics = contract.physics
            moving = any((*getattr(physics, "linear_velocity", ()), *getattr(physics, "angular_velocity", ())))
            if entity in self._dofs and moving:
                found.setdefault(entity, 0.0)
        return found

    def _is_free(self, dof: int) -> bool:
        return bool(self.rigid.model.jnt_type[self.rigid.model.dof_jntid[dof]] == 0)

    def _require_followable(self) -> None:
        paths: set[str] = set()
        for name, driver in self._drivers.items():
            if isinstance(driver, PathDriver):
                motion = self.spec.entities[driver.entity].motion
                if motion != "kinematic":
                    raise InputError(f"path driver moves {driver.entity!r}, which must have motion 'kinematic', not {motion!r}")
                if driver.entity in paths:
                    raise InputError(f"entity {driver.entity!r} follows two paths; join their keys in one path driver")
                paths.add(driver.entity)
            elif isinstance(driver, ForceDriver | ReleaseDriver):
                motion = self.spec.entities[driver.entity].motion
                if motion != "dynamic":
                    raise InputError(
                        f"driver {name!r} acts on {driver.entity!r}, which must have motion 'dynamic', not {motion!r}"
                    )
            elif isinstance(driver, MotorDriver) and name not in self.rigid.actuator_of:
                raise InputError(f"motor {name!r} needs a hinge or slide joint; {driver.joint!r} is none")
            elif isinstance(driver, DetachDriver) and driver.joint not in (self.rigid.eq_of | self.rigid.tendon_of):
                raise InputError(f"driver {name!r} can detach only a weld or a spring; {driver.joint!r} is none")

    # ------------------------------------------------------------------ what time decides

    def remember_poses(self, data: Any) -> None:
        """Take the present coordinates as those that held bodies keep."""
        self._pose = data.qpos.copy()

    def keep_poses(self, poses: Any) -> None:
        """Let held bodies keep these coordinates, given as `qpos`."""
        self._pose = poses

    def kept_poses(self) -> Any:
        """Coordinates that held bodies keep, as `qpos`."""
        return self._pose

    def held(self, time: float) -> frozenset[str]:
        """Entities that a hold or path fixes at `time`."""
        stopped = self._stopped if time >= self._since - _SLACK else frozenset()
        return self.kinematic | stopped | {e for e, t in self._release.items() if time < t - _SLACK}

    def switch_times(self, start: float, end: float) -> list[float]:
        """Times in (start, end) at which a driver switches, sorted."""
        times: set[float] = {*self._release.values(), *([self._since] if self._stopped else [])}
        for driver in self._drivers.values():
            if isinstance(driver, ForceDriver | MotorDriver):
                times |= {driver.start, driver.end}
            elif isinstance(driver, DetachDriver):
                times.add(driver.time)
            elif isinstance(driver, FieldDriver):
                times |= {driver.start, driver.start + driver.rise, np.inf if driver.end is None else driver.end}
        return sorted(t for t in times if start + _SLACK < t < end - _SLACK)

    def switches_at(self, time: float) -> bool:
        """True if a driver switches at `time`."""
        return bool(self.switch_times(time - 10 * _SLACK, time + 10 * _SLACK))

    def set_model(self, time: float, *, free: bool = False) -> None:
        """Write everything that `time` decides into the model; `free` opens all holds but paths (for relaxation)."""
        model = self.rigid.model
        self.holds.fix(self.kinematic if free else self.held(time))
        if self.rigid.parted:
            part_flexes(self.rigid)
        model.exclude_signature[:] = self._excludes
        for name, driver in self._drivers.items():
            if isinstance(driver, MotorDriver):
                row = self.rigid.actuator_of[name]
                on = driver.start - _SLACK <= time < driver.end - _SLACK and name not in self._without
                model.actuator_forcerange[row] = self._effort[row] if on else (0.0, 0.0)
            elif isinstance(driver, DetachDriver):
                cut = time >= driver.time - _SLACK and name not in self._without
                if driver.joint in self.rigid.tendon_of:
                    row = self.rigid.tendon_of[driver.joint]
                    model.tendon_stiffness[row] = 0.0 if cut else self._stiffness[row]
                    model.tendon_damping[row] = 0.0 if cut else self._tendon_damping[row]
                elif cut and driver.joint in self.rigid.exclude_of:
                    # The list is sorted and merged by MuJoCo; repeating a neighbour takes an entry out.
                    row = self.rigid.exclude_of[driver.joint]
                    model.exclude_signature[row] = model.exclude_signature[row - 1] if row else 0

    def set_data(self, data: Any, time: float) -> None:
        """Write forces, controls and switches that hold from `time` on."""
        data.xfrc_applied[:] = self.wrenches(time)
        data.qfrc_applied[:] = 0.0
        data.eq_active[:] = self._native_eq
        if self._stopped and abs(time - self._since) <= 10 * _SLACK:
            self._keep(data)
        for name, driver in self._drivers.items():
            if name in self._without:
                continue
            if isinstance(driver, MotorDriver):
                data.ctrl[self.rigid.actuator_of[name]] = driver.velocity
            elif isinstance(driver, DetachDriver) and driver.joint in self.rigid.eq_of and time >= driver.time - _SLACK:
                data.eq_active[self.rigid.eq_of[driver.joint]] = 0
        for entity in self.held(time) - self.kinematic:
            data.qvel[self._dofs[entity]] = 0.0
            for at in self._coordinates(entity):
                data.qpos[at] = self._pose[at]
        if self.switches_at(time):
            # A sleeping body does not notice that what held it is gone; a negative zero wakes it and moves nothing. A body
            # about to fall asleep starts its countdown anew.
            data.qvel[data.qvel == 0.0] = -0.0
            data.tree_asleep[data.tree_asleep < 0] = -(1 + _MIN_AWAKE)

    def wrenches(self, time: float) -> F64:
        """Force and torque of force drivers on each body of the model from `time` on, shape (nbody, 6) [N, N m]."""
        found: F64 = np.zeros((self.rigid.model.nbody, 6))
        for name, driver in self._drivers.items():
            if (
                name not in self._without
                and isinstance(driver, ForceDriver)
                and driver.start - _SLACK <= time < driver.end - _SLACK
            ):
                bodies = self._pushed[driver.entity]
                for body in bodies:
                    found[body] += np.array([*driver.force, *driver.torque]) / len(bodies)
        return found

    def _coordinates(self, entity: str) -> list[slice]:
        """Slices of `qpos` that belong to an entity."""
        model = self.rigid.model
        starts = [(int(model.jnt_qposadr[j]), int(model.jnt_type[j])) for j in np.unique(model.dof_jntid[self._dofs[entity]])]
        return [slice(at, at + (7, 4, 1, 1)[kind]) for at, kind in starts]

    def _keep(self, data: Any) -> None:
        """Remember where those that an intervention holds from now on are."""
        for entity in self._stopped & self._dofs.keys():
            for at in self._coordinates(entity):
                self._pose[at] = data.qpos[at]

    def slacken(self, data: Any) -> None:
        """Take the damping from ropes that are slack: they only pull."""
        rows, model = self._ropes, self.rigid.model
        taut = (data.ten_length[rows] > model.tendon_lengthspring[rows, 1]) & (model.tendon_stiffness[rows] > 0)
        model.tendon_damping[rows] = np.where(taut, self._tendon_damping[rows], 0.0)

    # ------------------------------------------------------------------ paths

    def plan_paths(self, start: float, dt: float, count: int) -> None:
        """Sample all paths at `count` steps of `dt` from `start` [s]."""
        times: F64 = start + dt * np.arange(count + 1, dtype=np.float64)
        self._samples = []
        for entity in sorted(self.kinematic):
            qpos, dof = self._free[entity], self._dofs[entity][0]
            if entity in self._paths:
                until = self._until.get(entity, np.inf)
                poses, twists = self._paths[entity].sample(np.minimum(times, until))
                twists[times >= until - _SLACK] = 0.0
            else:
                poses, twists = np.tile(self._pose[qpos : qpos + 7], (count + 1, 1)), np.zeros((count + 1, 6))
            self._samples.append(PathSamples(qpos, dof, poses, twists))

    def follow_paths(self, data: Any, step: int, dt: float) -> None:
        """Put kinematic bodies on their paths at the planned step.

        The force that the path's acceleration takes is applied too, so that what hangs on such a body feels it.
        """
        for path in self._samples:
            at, dof = path.qpos, path.dof
            data.qpos[at : at + 7] = path.poses[step]
            data.qvel[dof : dof + 6] = path.twists[step]
            if step + 1 < len(path.twists):
                dofs = slice(dof, dof + 6)
                data.qfrc_applied[dofs] = self.holds.armature(dofs) * (path.twists[step + 1] - path.twists[step]) / dt

    def start_velocities(self, data: Any) -> None:
        """Set the declared velocities at frame 0.

        Raises:
            InputError: joints do not allow a declared velocity.
        """
        set_velocities(self.spec, self.rigid.model, data, self._dofs, self._bodies, self.kinematic)

    def active(self, start: float, end: float) -> Any:
        """Which drivers acted during [start, end), u1, shape (drivers,)."""
        flags = []
        for name, driver in self._drivers.items():
            if name in self._without:
                flags.append(False)
            elif isinstance(driver, ReleaseDriver | DetachDriver):
                flags.append(start - _SLACK <= driver.time < end - _SLACK)
            elif isinstance(driver, PathDriver):
                times = [k.time for k in driver.keys.values()]
                flags.append(min(times) < end and max(times) > start)
            elif isinstance(driver, ForceDriver | MotorDriver | FieldDriver):
                until = np.inf if driver.end is None else driver.end
                flags.append(driver.start < end - _SLACK and until > start + _SLACK)
        return np.array(flags, dtype=np.uint8)

"""Entities, joints and ropes of one solver instance, put into a MuJoCo specification."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of
from ...worlds.built import BuiltEntity, BuiltPart, Convex
from ...worlds.errors import InputError
from ...worlds.spec import (
    DetachDriver,
    HingeJoint,
    RigidPhysics,
    RigidSettings,
    Rope,
    SlideJoint,
    SpringJoint,
    WeldJoint,
    WorldSpec,
)
from ..fracture.clusters import clusters_of, elimination
from .flex import SOLIMP, FlexBody, is_soft
from .holds import FIXED, MOVING

__all__ = ["ORIGIN", "ROLLING_DEFAULT", "ModelBuilder", "free_count"]

DENSE_LIMIT = 60
"""Degrees of freedom up to which the Jacobian is dense. 4.0.0 is said to have a wrong sparse Hessian (issue 3767); on
contacts, joints, ropes and springs it agrees with the dense one to 1e-7 in equal iterations, which a test keeps watching.
CG, the usual way around, ends at its iteration cap with accelerations wrong by up to 7 %."""
ROLLING_DEFAULT = 1e-6
SLEEP_ACCELERATION = 0.005
"""[m/s^2] A body falls asleep when it is slower than this gives in ten steps, for ten steps. MuJoCo's default of 1 mm/s
froze boxes on inclines just above the friction angle and dropped momentum of heavy, slow bodies."""
LEAST_MEMORY, DOF_MEMORY = 64 << 20, 96 << 10
"""[bytes] Own choice, for contacts and their rows: at least, and for each degree of freedom."""
PAIR_MEMORY = 704
"""[bytes] What MuJoCo 4.0 takes for a pair of geoms whose bounds meet (measured: 640 to 672); 119,000 pairs of a room in which a bookcase
tips did not fit into 64 MB."""
MOST_MEMORY = 2 << 30
"""[bytes] Own choice: most that pairs may bring it to."""
ORIGIN = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


def _stands(body: Any) -> bool:
    """True for a body of the model that nothing moves, the world included."""
    while body.name != "world":
        if len(body.joints):
            return False
        body = body.parent
    return True


def _joint_tree(spec: WorldSpec, members: frozenset[str]) -> dict[str, str]:
    """Joint id per child entity that hangs in the kinematic tree; springs and detachable welds do not."""
    detachable = {d.joint for d in spec.simulation.drivers.values() if isinstance(d, DetachDriver)}
    tree: dict[str, str] = {}
    for name, joint in spec.simulation.joints.items():
        if isinstance(joint, SpringJoint) or (isinstance(joint, WeldJoint) and name in detachable) or joint.child not in members:
            continue
        if joint.child in tree:
            raise InputError(
                f"entity {joint.child!r} is the child of joints {tree[joint.child]!r} and {name!r}; "
                "a body hangs on one joint, so make one of them a spring or swap parent and child"
            )
        if spec.entities[joint.child].motion != "dynamic":
            raise InputError(f"joint {name!r}: child {joint.child!r} must be dynamic; swap parent and child")
        tree[joint.child] = name
    for start in tree:
        seen, at = {start}, start
        while at in tree:
            parent = spec.simulation.joints[tree[at]].parent
            if parent is None:
                break
            if parent in seen:
                raise InputError(f"joints form a loop through {sorted(seen)}; open it with a spring joint")
            seen.add(parent)
            at = parent
    return tree


class ModelBuilder:
    """A MuJoCo specification that grows entity by entity, and the maps from names to what was made of them."""

    def __init__(
        self,
        spec: WorldSpec,
        built: Mapping[str, BuiltEntity],
        members: tuple[str, ...],
        settings: RigidSettings,
        apart: frozenset[frozenset[str]],
        whole: Mapping[str, Any],
    ) -> None:
        import mujoco

        self.mj = mujoco
        self.apart, self.whole = apart, whole
        self.spec, self.built, self.members, self.settings = spec, built, members, settings
        self.out = mujoco.MjSpec()
        self.kinds = {
            "box": mujoco.mjtGeom.mjGEOM_BOX,
            "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
            "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
            "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
            "hull": mujoco.mjtGeom.mjGEOM_MESH,
            "heightfield": mujoco.mjtGeom.mjGEOM_HFIELD,
        }
        self.out.compiler.degree = False
        self.tree = _joint_tree(spec, frozenset(members))
        self.made: dict[str, Any] = {}
        self.world_pose: dict[str, RigidPose] = {}
        self.geom_entity: dict[str, str] = {}
        self.geom_material: dict[str, str] = {}
        self.geom_excess: dict[str, float] = {}
        self.geoms_of: dict[str, list[str]] = {m: [] for m in members}
        self.dragged: dict[str, float] = {}
        self.body_names: list[str] = []
        self.body_of: dict[str, str] = {}
        """Name of the model's body per piece of a breakable entity."""
        self.offsets: list[F64] = []
        self.centers: list[F64] = []
        self.joint_names: list[str] = []
        self.flexes: list[FlexBody] = []

    def options(self, dof_estimate: int) -> None:
        """Set how the engine integrates and solves, for about so many degrees of freedom."""
        mujoco, option = self.mj, self.out.option
        option.timestep = self.settings.step
        option.gravity = self.spec.simulation.gravity
        # `discrete` solves the gyroscopic and contact terms implicitly and damps both; elastic members need it.
        soft = any(is_soft(self.spec, name) for name in self.members)
        option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE if soft else mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        dense = dof_estimate <= DENSE_LIMIT
        option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE if dense else mujoco.mjtJacobian.mjJAC_SPARSE
        option.iterations = self.settings.iterations
        option.tolerance = self.settings.tolerance
        option.impratio = self.settings.impratio
        option.sleep_tolerance = 10 * SLEEP_ACCELERATION * self.settings.step
        option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET) | int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
        if self.settings.sleep and not soft:
            option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        if self.settings.speculative:
            option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SPECULATIVE)
        self._dof = dof_estimate

    def room(self) -> None:
        """Set the memory of a step, once all geoms are there: for rows of contacts, and for all pairs of geoms that may come near at once.

        The engine touches no more of it than it needs, so that what is never used costs nothing.
        """
        alone = Counter("" if _stands(g.parent) else g.parent.name for g in self.out.geoms)
        pairs = (alone.total() ** 2 - sum(n * n for n in alone.values())) // 2
        rows = max(LEAST_MEMORY, self._dof * DOF_MEMORY)
        self.out.memory = max(rows, min(rows + pairs * PAIR_MEMORY, MOST_MEMORY))

    def _geom(self, body: Any, name: str, piece: Convex, entity: str, part: BuiltPart, *, fixed: bool) -> None:
        mujoco = self.mj
        matter = self.spec.materials[part.material]
        geom = body.add_geom(name=name, type=self.kinds[piece.kind], pos=piece.pose.position, quat=piece.pose.quaternion)
        if piece.kind == "hull":
            mesh = self.out.add_mesh(name=name)
            mesh.uservert = piece.points.ravel().tolist()
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            geom.meshname = name
        elif piece.kind == "heightfield":
            if self.spec.entities[entity].motion != "static":
                raise InputError(f"entity {entity!r} is a height field, which cannot move; make it static or a mesh")
            low, span = float(piece.points.min()), float(np.ptp(piece.points)) or 1e-6
            field_ = self.out.add_hfield(name=name, nrow=piece.points.shape[0], ncol=piece.points.shape[1])
            field_.size = [piece.params[0], piece.params[1], span, piece.params[2]]
            field_.userdata = ((piece.points - low) / span).ravel().tolist()
            geom.hfieldname = name
            geom.pos = piece.pose.apply(np.array([[0.0, 0.0, low]]))[0]
        else:
            geom.size = [*piece.params, *([0.0] * (3 - len(piece.params)))]
        geom.mass = 0.0
        geom.condim = 6 if matter.rolling_friction > 0 else 3
        geom.friction = [
            matter.friction_at_rest,
            max(matter.rolling_friction, ROLLING_DEFAULT),
            max(matter.rolling_friction, ROLLING_DEFAULT),
        ]
        # Where the visible surface reaches outside the collision shape, the skin grows by as much.
        geom.margin = self.settings.skin + part.deviation[1]
        geom.solimp = SOLIMP
        geom.contype, geom.conaffinity = FIXED if fixed else MOVING
        self.geom_entity[name], self.geom_material[name] = entity, part.material
        self.geom_excess[name] = part.deviation[1]
        self.geoms_of[entity].append(name)

    def _fill(self, body: Any, entity: str, name: str, offset: F64) -> None:
        built = self.built[entity]
        mass = next(b for b in built.bodies if b.name == name)
        body.explicitinertial = True
        body.mass = mass.mass
        body.ipos = mass.center - offset
        i = mass.inertia
        body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
        for part in built.parts_of(name):
            self._geoms(body, entity, part, offset, fixed=self.spec.entities[entity].motion == "static")

    def _geoms(self, body: Any, entity: str, part: BuiltPart, offset: F64, *, fixed: bool) -> None:
        for k, piece in enumerate(part.collision):
            moved = RigidPose(piece.pose.position - offset, piece.pose.quaternion)
            placed = Convex(piece.kind, piece.params, moved, piece.points)
            self._geom(body, f"{entity}/{part.part}/{k}", placed, entity, part, fixed=fixed)

    def _child(self, parent: Any, parent_pose: RigidPose, name: str, pose: RigidPose) -> Any:
        local = compose(parent_pose.inverse(), pose)
        return parent.add_body(name=name, pos=local.position, quat=local.quaternion)

    def _joint(self, body: Any, name: str, pose: RigidPose) -> None:
        mujoco, joint = self.mj, self.spec.simulation.joints[name]
        if isinstance(joint, WeldJoint | SpringJoint):
            return
        inverse = pose.inverse()
        anchor = inverse.apply(np.array([joint.anchor]))[0]
        kinds = {"hinge": mujoco.mjtJoint.mjJNT_HINGE, "slide": mujoco.mjtJoint.mjJNT_SLIDE, "ball": mujoco.mjtJoint.mjJNT_BALL}
        made = body.add_joint(name=name, type=kinds[joint.kind], pos=anchor)
        made.damping[0] = joint.damping
        made.stiffness[0] = joint.stiffness
        if isinstance(joint, HingeJoint | SlideJoint):
            axis = inverse.apply(np.array([joint.axis]))[0] - inverse.position
            length = float(np.linalg.norm(axis))
            if length < 1e-9:
                raise InputError(f"joint {name!r}: axis must not be zero")
            made.axis = axis / length
            made.frictionloss = joint.friction
            if joint.range is not None:
                if joint.range[0] >= joint.range[1]:
                    raise InputError(f"joint {name!r}: range {joint.range} must have first < second")
                made.limited = mujoco.mjtLimited.mjLIMITED_TRUE
                made.range = joint.range
            self.joint_names.append(name)

    def entity(self, name: str) -> None:
        """Add an entity, its parent first."""
        if name in self.made:
            return
        entity, built = self.spec.entities[name], self.built[name]
        base = pose_of(entity.pose)
        if built.bonds is not None:
            self._pieces(name, base)
            return
        if entity.generator is not None:
            if name in self.tree:
                raise InputError(
                    f"joint {self.tree[name]!r}: a rope cannot be a child; use attach_start and attach_end of its generator"
                )
            if entity.motion != "dynamic":
                raise InputError(f"rope {name!r} must have motion 'dynamic', not {entity.motion!r}")
            self._rope(name, base)
            return
        # The engine's frame sits in the centre of mass: momentum of a free body is then kept to rounding.
        center = built.bodies[0].center if entity.motion == "dynamic" else np.zeros(3)
        pose = compose(compose(base, built.bodies[0].pose), RigidPose(center, ORIGIN.quaternion))
        joint = self.spec.simulation.joints.get(self.tree.get(name, ""))
        parent_name = getattr(joint, "parent", None)
        if parent_name is not None:
            if parent_name not in self.members:
                raise InputError(f"joint parent {parent_name!r} is not a member of the same solver instance; add it to members")
            self.entity(parent_name)
        parent = self.made[parent_name] if parent_name is not None else self.out.worldbody
        parent_pose = self.world_pose[parent_name] if parent_name is not None else ORIGIN
        body = self._child(parent, parent_pose, name, pose)
        if entity.motion != "static":
            if name in self.tree:
                self._joint(body, self.tree[name], pose)
            else:
                body.add_freejoint(name=f"free/{name}")
            self.body_names.append(f"{name}/body")
        self._fill(body, name, "body", center)
        if entity.motion != "static":
            self.offsets.append(center)
            self.centers.append(built.bodies[0].center)
        self.made[name], self.world_pose[name] = body, pose

    def _pieces(self, name: str, base: RigidPose) -> None:
        """One body per cluster of bonded pieces; welded to the world where the world holds one of them."""
        built = self.built[name]
        if name in self.tree or self.spec.entities[name].motion != "dynamic":
            raise InputError(
                f"breakable entity {name!r} must be dynamic and hang on no joint; fix its sides with breakable.fixed"
            )
        centers = [b.pose.position for b in built.bodies]
        rows: dict[int, F64] = {}
        parts: dict[str, list[BuiltPart]] = {}
        for made in built.parts:
            parts.setdefault(made.body, []).append(made)
        clusters = clusters_of(built, self.whole.get(name, np.ones(len(built.bonds or ()), dtype=bool)))
        places = base.apply(np.array([c.center for c in clusters]))
        # The engine eliminates the last degrees of freedom first.
        fixed = [k for k, c in enumerate(clusters) if c.fixed]
        for index in (*fixed, *reversed(elimination(built, clusters))):
            cluster, place = clusters[index], places[index]
            pose = RigidPose(place, base.quaternion)
            body = self.out.worldbody.add_body(name=cluster.name, pos=pose.position, quat=pose.quaternion)
            if not cluster.fixed:
                body.add_freejoint(name=f"free/{cluster.name}")
            self.made.setdefault(name, body)
            self.world_pose.setdefault(name, pose)
            body.explicitinertial, body.mass, i = True, cluster.mass, cluster.inertia
            body.ipos = [0.0, 0.0, 0.0]
            body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
            for k in cluster.pieces:
                piece = built.bodies[k]
                rows[k] = cluster.center - centers[k]
                self.body_of[f"{name}/{piece.name}"] = cluster.name
                for part in parts[piece.name]:
                    self._geoms(body, name, part, rows[k], fixed=cluster.fixed)
        for k, piece in enumerate(built.bodies):
            self.body_names.append(f"{name}/{piece.name}")
            self.offsets.append(rows[k])
            self.centers.append(np.zeros(3))

    def _rope(self, name: str, base: RigidPose) -> None:
        mujoco, rope = self.mj, self.spec.entities[name].generator
        assert rope is not None
        parent, parent_pose = self.out.worldbody, ORIGIN
        for end in (rope.attach_start, rope.attach_end):
            if end not in (None, "world") and (end not in self.members or self.spec.entities[str(end)].generator is not None):
                raise InputError(f"rope {name!r} is attached to {end!r}, which is no body of the same solver instance")
        near = self._near_segments(name, rope)
        for k, part in enumerate(self.built[name].bodies):
            pose = compose(base, part.pose)
            half = _half_length(self.built[name], part.name)
            if k == 0 and rope.attach_start not in (None, "world"):
                self.entity(str(rope.attach_start))
                parent, parent_pose = self.made[str(rope.attach_start)], self.world_pose[str(rope.attach_start)]
            body = self._child(parent, parent_pose, f"{name}/{part.name}", pose)
            if k == 0 and rope.attach_start is None:
                body.add_freejoint(name=f"free/{name}")
            else:
                joint = body.add_joint(name=f"{name}/{part.name}", type=mujoco.mjtJoint.mjJNT_BALL, pos=[0, 0, -half])
                joint.stiffness[0], joint.damping[0] = rope.stiffness, rope.damping
            self._fill(body, name, part.name, np.zeros(3))
            self.offsets.append(np.zeros(3))
            self.centers.append(part.center)
            self.body_names.append(f"{name}/{part.name}")
            for back in range(max(0, k - near), k):
                other = self.built[name].bodies[back].name
                self.out.add_exclude(bodyname1=f"{name}/{other}", bodyname2=f"{name}/{part.name}")
            parent, parent_pose = body, pose
        self.made[name], self.world_pose[name] = parent, parent_pose
        if rope.attach_end is not None:
            last = self.built[name].bodies[-1]
            tip = _half_length(self.built[name], last.name)
            equality = self.out.add_equality(name=f"end/{name}", type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY)
            equality.name1 = f"{name}/{last.name}"
            if rope.attach_end != "world":
                self.entity(rope.attach_end)
                equality.name2 = rope.attach_end
            equality.data[:3] = [0, 0, tip]
        segments = [b.name for b in self.built[name].bodies]
        for end, touching in ((rope.attach_start, segments[:near]), (rope.attach_end, segments[-near:])):
            for segment in touching if end not in (None, "world") else ():
                self.out.add_exclude(bodyname1=f"{name}/{segment}", bodyname2=str(end))

    def _near_segments(self, name: str, rope: Rope) -> int:
        """Number of segments on that touch a segment by construction."""
        length = 2 * min(_half_length(self.built[name], b.name) for b in self.built[name].bodies)
        return 1 + math.ceil((2 * rope.radius + 2 * self.settings.skin) / max(length, 1e-9))

    def bodies_of(self, name: str) -> list[str]:
        """Names of an entity's bodies in the model."""
        if self.built[name].bonds is not None:
            return sorted({self.body_of[f"{name}/{b.name}"] for b in self.built[name].bodies})
        return [name] if self.spec.entities[name].generator is None else [f"{name}/{b.name}" for b in self.built[name].bodies]

    def drag(self) -> None:
        """Viscous drag of free bodies."""
        for name in self.members:
            entity = self.spec.entities[name]
            physics = entity.physics
            if not isinstance(physics, RigidPhysics) or physics.linear_damping == 0 or entity.motion != "dynamic":
                continue
            if name in self.tree or entity.generator is not None:
                raise InputError(f"entity {name!r}: linear_damping works on free bodies only; give its joint a damping instead")
            self.dragged[f"free/{name}"] = physics.linear_damping


def _half_length(built: BuiltEntity, body: str) -> float:
    return float(built.parts_of(body)[0].collision[0].params[1])


def free_count(built: BuiltEntity, whole: Any) -> int:
    """Bodies of an entity that can move."""
    if built.bonds is None:
        return len(built.bodies)
    held = np.ones(len(built.bonds), dtype=bool) if whole is None else whole
    return sum(not c.fixed for c in clusters_of(built, held))

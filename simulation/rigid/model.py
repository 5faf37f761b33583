"""Specification and built entities -> MuJoCo model.

Every entity becomes bodies; static ones are welded to the world, kinematic and held ones are free bodies that `holds`
makes immovable.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of
from ...worlds.built import BuiltEntity, BuiltPart, Convex
from ...worlds.errors import InputError
from ...worlds.spec import (
    DetachDriver,
    HingeJoint,
    MotorDriver,
    RigidPhysics,
    RigidSettings,
    Rope,
    SlideJoint,
    SpringJoint,
    WeldJoint,
    WorldSpec,
)
from ..fracture.clusters import clusters_of
from .contact_law import ContactLaw, set_contact_law
from .crumbling import make_crumbling
from .flex import SOLIMP, FlexBody, add_flex, is_soft, node_count, part_flexes
from .holds import FIXED, MOVING

__all__ = ["RigidModel", "build_model"]

DENSE_LIMIT = 60
"""Degrees of freedom up to which the Jacobian is dense. 4.0.0 is said to have a wrong sparse Hessian (issue 3767); on
contacts, joints, ropes and springs it agrees with the dense one to 1e-7 in equal iterations, which a test keeps watching.
CG, the usual way around, ends at its iteration cap with accelerations wrong by up to 7 %."""
MAX_PAIR_GEOMS = 2000
ROLLING_DEFAULT = 1e-6
SOFTEST = 200.0
"""Contacts are as soft as those of a body this many times lighter than the heaviest one, at most."""
SLEEP_ACCELERATION = 0.005
"""[m/s^2] A body falls asleep when it is slower than this gives in ten steps, for ten steps. MuJoCo's default of 1 mm/s
froze boxes on inclines just above the friction angle and dropped momentum of heavy, slow bodies."""


@dataclass
class RigidModel:
    """A compiled model and the maps between the specification's names and its indices."""

    model: Any
    colliders: tuple[str, ...]
    bodies: tuple[str, ...]
    """`entity/body` of every moving body, in cache order."""
    body_ids: Any
    """MuJoCo body id per entry of `bodies`; pieces that are bonded to one another share theirs."""
    offsets: F64
    """Origin of MuJoCo's frame in the body's own frame [m], shape (n, 3)."""
    centers: F64
    """Centre of mass in the body's own frame [m], shape (n, 3)."""
    geom_collider: Any
    """Collider index per side of a contact (geoms, then elastic bodies), shape (sides,)."""
    joints: tuple[str, ...]
    joint_qpos: Any
    """qpos address per entry of `joints`."""
    law: ContactLaw
    excess: F64
    """How far the visible surface reaches outside the collision shape, per side of a contact [m], shape (sides,)."""
    flexes: tuple[FlexBody, ...] = ()
    """Elastic members, in the order of the engine."""
    parted: tuple[frozenset[str], ...] = ()
    """Pairs, one of them elastic, that pass through each other."""
    exclude_of: dict[str, int] = field(default_factory=dict)
    """Exclusion per weld that a driver can open."""
    eq_of: dict[str, int] = field(default_factory=dict)
    tendon_of: dict[str, int] = field(default_factory=dict)
    kin: Any = None
    """Whether a collider is a breakable entity, whose pieces meet each other, shape (colliders,)."""
    kin_rows: Any = None
    """Whether an entry of `bodies` is a piece of one, shape (n,)."""
    actuator_of: dict[str, int] = field(default_factory=dict)


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


class _Builder:
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
        self.out.memory = max(64 << 20, dof_estimate * (96 << 10))

    def _geom(self, body: Any, name: str, piece: Convex, entity: str, part: BuiltPart, *, fixed: bool) -> None:
        mujoco = self.mj
        kinds = {
            "box": mujoco.mjtGeom.mjGEOM_BOX,
            "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
            "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
            "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
            "hull": mujoco.mjtGeom.mjGEOM_MESH,
            "heightfield": mujoco.mjtGeom.mjGEOM_HFIELD,
        }
        matter = self.spec.materials[part.material]
        geom = body.add_geom(name=name, type=kinds[piece.kind], pos=piece.pose.position, quat=piece.pose.quaternion)
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
            matter.friction,
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
        pose = compose(compose(base, built.bodies[0].pose), RigidPose(center, _ORIGIN.quaternion))
        joint = self.spec.simulation.joints.get(self.tree.get(name, ""))
        parent_name = getattr(joint, "parent", None)
        if parent_name is not None:
            if parent_name not in self.members:
                raise InputError(f"joint parent {parent_name!r} is not a member of the same solver instance; add it to members")
            self.entity(parent_name)
        parent = self.made[parent_name] if parent_name is not None else self.out.worldbody
        parent_pose = self.world_pose[parent_name] if parent_name is not None else _ORIGIN
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
        for cluster in clusters_of(built, self.whole.get(name, np.ones(len(built.bonds or ()), dtype=bool))):
            pose = compose(base, RigidPose(cluster.center, _ORIGIN.quaternion))
            body = self._child(self.out.worldbody, _ORIGIN, cluster.name, pose)
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
        parent, parent_pose = self.out.worldbody, _ORIGIN
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
        """How many segments on touch a segment by construction."""
        length = 2 * min(_half_length(self.built[name], b.name) for b in self.built[name].bodies)
        return 1 + math.ceil((2 * rope.radius + 2 * self.settings.skin) / max(length, 1e-9))

    def links(self) -> None:
        """Springs, detachable welds, excluded and special contact pairs, motors."""
        mujoco, plan = self.mj, self.spec.simulation
        for a, b in (sorted(pair) for pair in self.apart if pair <= set(self.members)):
            if is_soft(self.spec, a) or is_soft(self.spec, b):
                continue  # `flex.part_flexes`
            for one, two in itertools.product(self._bodies_of(a), self._bodies_of(b)):
                self.out.add_exclude(bodyname1=one, bodyname2=two)
        for name, joint in plan.joints.items():
            if joint.child not in self.members:
                continue
            for side in (joint.parent, joint.child):
                if side is not None and side not in self.made:
                    raise InputError(f"joint {name!r} names {side!r}, which is not a member of the same solver instance; add it")
            if isinstance(joint, SpringJoint):
                self._spring(name, joint)
                continue
            parent_pose = _ORIGIN if joint.parent is None else self.world_pose[joint.parent]
            if isinstance(joint, WeldJoint) and self.tree.get(joint.child) != name:
                equality = self.out.add_equality(name=name, type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
                equality.name1 = self.made[joint.child].name
                equality.name2 = "world" if joint.parent is None else self.made[joint.parent].name
                # Layout: anchor in body 2 [0:3], relative pose [3:10] (zero: the pose of the model), torque scale [10].
                local = parent_pose.inverse().apply(np.array([joint.anchor]))[0]
                equality.data[0:3] = local
                equality.data[10] = 1.0
            if not joint.collide and joint.parent is not None:
                names = (self.made[joint.parent].name, self.made[joint.child].name)
                self.out.add_exclude(name=name, bodyname1=names[0], bodyname2=names[1])
        for name, driver in plan.drivers.items():
            if isinstance(driver, MotorDriver) and driver.joint in self.joint_names:
                gain = driver.max_effort / max(0.05 * abs(driver.velocity), 1e-3)
                actuator = self.out.add_actuator(name=name, target=driver.joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
                actuator.set_to_velocity(kv=gain)
                actuator.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
                actuator.forcerange = [-driver.max_effort, driver.max_effort]

    def _bodies_of(self, name: str) -> list[str]:
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

    def _spring(self, name: str, joint: SpringJoint) -> None:
        sites = []
        for owner, point, tag in ((joint.child, joint.child_point, "a"), (joint.parent, joint.parent_point, "b")):
            body = self.out.worldbody if owner is None else self.made[owner]
            pose = _ORIGIN if owner is None else self.world_pose[owner]
            sites.append(f"{name}/{tag}")
            body.add_site(name=sites[-1], pos=pose.inverse().apply(np.array([point]))[0])
        rest = joint.rest_length
        if rest is None:
            rest = float(np.linalg.norm(np.subtract(joint.child_point, joint.parent_point)))
        tendon = self.out.add_tendon(name=name)
        tendon.stiffness[0], tendon.damping[0] = joint.stiffness, joint.damping
        tendon.springlength = [0.0 if joint.rope else rest, rest]
        for site in sites:
            tendon.wrap_site(site)

    def pairs(self) -> dict[tuple[str, str], float]:
        """Explicit pairs with their own friction; returns the restitutions of pairs that have their own."""
        values: dict[tuple[str, str], float] = {}
        plan, matter = self.spec.simulation, self.spec.materials
        fastened = [j for j in plan.joints.values() if not isinstance(j, SpringJoint) and not j.collide]
        joined = {frozenset((j.parent, j.child)) for j in fastened}
        for name, pair in plan.contacts.items():
            if pair.a not in self.members or pair.b not in self.members or frozenset((pair.a, pair.b)) in joined:
                continue
            if pair.restitution is not None:
                values[pair.a, pair.b] = pair.restitution
            if pair.friction is None or frozenset((pair.a, pair.b)) in self.apart:
                continue
            combos = [(g, h) for g in self.geoms_of[pair.a] for h in self.geoms_of[pair.b] if g != h]
            if len(combos) > MAX_PAIR_GEOMS:
                raise InputError(
                    f"contact {name!r} joins {len(combos)} pieces, at most {MAX_PAIR_GEOMS}; "
                    "give one of the entities fewer parts or segments"
                )
            for k, (g, h) in enumerate(combos):
                rolling = max(matter[self.geom_material[x]].rolling_friction for x in (g, h))
                made = self.out.add_pair(name=f"{name}/{k}", geomname1=g, geomname2=h)
                made.friction = [pair.friction, pair.friction, *[max(rolling, ROLLING_DEFAULT)] * 3]
                made.condim = 6 if rolling > 0 else 3
                made.margin = 2 * self.settings.skin + self.geom_excess[g] + self.geom_excess[h]
                made.solimp = SOLIMP
        return values


_ORIGIN = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


def _half_length(built: BuiltEntity, body: str) -> float:
    return float(built.parts_of(body)[0].collision[0].params[1])


def _free_count(built: BuiltEntity, whole: Any) -> int:
    """Bodies of an entity that can move."""
    if built.bonds is None:
        return len(built.bodies)
    held = np.ones(len(built.bonds), dtype=bool) if whole is None else whole
    return sum(not c.fixed for c in clusters_of(built, held))


def build_model(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    members: tuple[str, ...],
    settings: RigidSettings,
    *,
    apart: Iterable[tuple[str, str]] = (),
    whole: Mapping[str, Any] | None = None,
) -> RigidModel:
    """Compile the model of one solver instance.

    Args:
        spec: the specification.
        built: built entities.
        members: of the instance.
        settings: of the instance.
        apart: pairs that pass through each other.
        whole: which bonds of breakable entities hold; default all.

    Raises:
        InputError: joints that form loops, share a child or name non-members; too many special pairs.
    """
    import mujoco

    held = whole or {}
    builder = _Builder(spec, built, members, settings, frozenset(frozenset(pair) for pair in apart), held)
    bodies = sum(_free_count(built[m], held.get(m)) for m in members if spec.entities[m].motion != "static")
    builder.options(6 * bodies + 3 * sum(node_count(built[m]) for m in members))
    for name in members:
        if is_soft(spec, name):
            builder.flexes.append(add_flex(builder, name))
        else:
            builder.entity(name)
    builder.links()
    builder.drag()
    bounces = builder.pairs()
    try:
        with warnings.catch_warnings():
            # Of an elastic body without damping, whose elasticity MuJoCo 4.0.0 does not count as a force.
            warnings.filterwarnings("ignore", message="flex '.*' is not rigid and has no equality constraints")
            model = builder.out.compile()
    except ValueError as error:
        raise InputError(f"MuJoCo refuses the model: {error}") from error
    colliders = tuple(members)
    rank = {name: i for i, name in enumerate(colliders)}
    geom_names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, g) for g in range(model.ngeom)]
    body_ids = [model.body(builder.body_of.get(n, n.removesuffix("/body"))).id for n in builder.body_names]
    soft = [f.entity for f in builder.flexes]
    geom_collider = np.array([rank[n] for n in (*(builder.geom_entity[g] for g in geom_names), *soft)], dtype=np.int64)
    matter = [builder.geom_material[g] for g in geom_names] + [built[n].parts[0].material for n in soft]
    result = RigidModel(
        model=model,
        colliders=colliders,
        bodies=tuple(builder.body_names),
        body_ids=np.array(body_ids, dtype=np.int64),
        offsets=np.array(builder.offsets).reshape(-1, 3),
        centers=np.array(builder.centers).reshape(-1, 3),
        kin=np.array([built[c].bonds is not None for c in colliders], dtype=bool),
        kin_rows=np.array([n in builder.body_of for n in builder.body_names], dtype=bool),
        geom_collider=geom_collider,
        joints=tuple(builder.joint_names),
        joint_qpos=np.array([model.joint(n).qposadr[0] for n in builder.joint_names], dtype=np.int64),
        law=ContactLaw(
            model,
            np.array([spec.materials[m].restitution for m in matter]),
            geom_collider,
            {(rank[a], rank[b]): value for (a, b), value in bounces.items()},
            make_crumbling(spec, built, colliders, geom_names, builder.geom_entity),
        ),
        excess=np.array([*(builder.geom_excess[g] for g in geom_names), *(0.0 for _ in soft)]),
        flexes=tuple(builder.flexes),
        parted=tuple(p for p in builder.apart if p <= set(members) and any(is_soft(spec, n) for n in p)),
    )
    part_flexes(result)
    for name in spec.simulation.joints:
        equality = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_EQUALITY, name)
        tendon = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TENDON, name)
        exclude = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_EXCLUDE, name)
        if equality >= 0:
            result.eq_of[name] = equality
        if equality >= 0 and exclude >= 0:
            result.exclude_of[name] = exclude
        if tendon >= 0:
            result.tendon_of[name] = tendon
    for name in spec.simulation.drivers:
        actuator = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
        if actuator >= 0:
            result.actuator_of[name] = actuator
    for name, damping in builder.dragged.items():
        start = int(model.joint(name).dofadr[0])
        model.dof_damping[start : start + 3] = damping
    # The softness of a contact follows its lighter body; under a far heavier one it would sink through the skin.
    moving = [b for b in body_ids if model.body_dofnum[b]]
    heaviest = float(model.body_mass[moving].max(initial=1e-9)) if moving else 1.0
    model.body_invweight0[:, 0] = np.minimum(model.body_invweight0[:, 0], SOFTEST / heaviest)
    set_contact_law(result, settings.contact_steps, settings.step)
    return result

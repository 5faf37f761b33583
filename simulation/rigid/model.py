"""Specification and built entities -> MuJoCo model.

Every entity becomes bodies; static ones are welded to the world, kinematic and held ones get an inertia so large
that nothing moves them (`HOLD_FACTOR`), so that contacts still see their velocity.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of
from ...worlds.built import BuiltEntity, Convex
from ...worlds.errors import InputError
from ...worlds.spec import (
    BallJoint,
    DetachDriver,
    HingeJoint,
    MotorDriver,
    RigidSettings,
    SlideJoint,
    SpringJoint,
    WeldJoint,
    WorldSpec,
)
from .contact_law import IMPEDANCE, contact_reference

__all__ = ["RigidModel", "build_model"]

SOLIMP = (IMPEDANCE, IMPEDANCE, 0.001, 0.5, 2.0)
"""MuJoCo `solimp`: constant, so that the contact is the linear spring-damper that `contact_law` calibrates."""
JOINT_STEPS = 4.0
"""Natural period / 2 pi of equality constraints and limits, in steps."""
DENSE_LIMIT = 1500
"""Degrees of freedom up to which Newton with a dense Jacobian is used (4.0.0's sparse Hessian is wrong)."""
MAX_PAIR_GEOMS = 2000
ROLLING_DEFAULT = 1e-6


@dataclass
class RigidModel:
    """A compiled model and the maps between the specification's names and its indices."""

    model: Any
    colliders: tuple[str, ...]
    bodies: tuple[str, ...]
    """`entity/body` of every moving body, in cache order."""
    body_ids: F64
    """MuJoCo body id per entry of `bodies`."""
    geom_collider: Any
    """Collider index per geom, shape (ngeom,)."""
    joints: tuple[str, ...]
    joint_qpos: Any
    """qpos address per entry of `joints`."""
    restitution: Any
    """Restitution per geom, shape (ngeom,)."""
    pair_restitution: Any
    """Restitution per explicit pair, shape (npair,)."""
    eq_of: dict[str, int] = field(default_factory=dict)
    tendon_of: dict[str, int] = field(default_factory=dict)
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
    def __init__(self, spec: WorldSpec, built: Mapping[str, BuiltEntity], members: tuple[str, ...], settings: RigidSettings) -> None:
        import mujoco

        self.mj = mujoco
        self.spec, self.built, self.members, self.settings = spec, built, members, settings
        self.out = mujoco.MjSpec()
        self.tree = _joint_tree(spec, frozenset(members))
        self.made: dict[str, Any] = {}
        self.world_pose: dict[str, RigidPose] = {}
        self.geom_entity: dict[str, str] = {}
        self.geom_restitution: dict[str, float] = {}
        self.geoms_of: dict[str, list[str]] = {m: [] for m in members}
        self.body_names: list[str] = []
        self.joint_names: list[str] = []

    def options(self, dof_estimate: int) -> None:
        mujoco, option = self.mj, self.out.option
        option.timestep = self.settings.step
        option.gravity = self.spec.simulation.gravity
        # Under `discrete` contact springs are implicit: a declared restitution of 0.9 measures 0.64. An instance
        # that also owns elastic members will need it; a purely rigid one is exact with implicitfast.
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        dense = dof_estimate <= DENSE_LIMIT
        option.solver = mujoco.mjtSolver.mjSOL_NEWTON if dense else mujoco.mjtSolver.mjSOL_CG
        option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE if dense else mujoco.mjtJacobian.mjJAC_AUTO
        option.iterations = self.settings.iterations
        option.tolerance = self.settings.tolerance
        option.impratio = self.settings.impratio
        option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET) | int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
        if self.settings.sleep:
            option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        if self.settings.speculative:
            option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SPECULATIVE)
        self.out.memory = max(64 << 20, dof_estimate * (96 << 10))

    def _geom(self, body: Any, name: str, piece: Convex, entity: str, material: str) -> None:
        mujoco = self.mj
        kinds = {
            "box": mujoco.mjtGeom.mjGEOM_BOX,
            "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
            "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
            "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
            "hull": mujoco.mjtGeom.mjGEOM_MESH,
            "heightfield": mujoco.mjtGeom.mjGEOM_HFIELD,
        }
        matter = self.spec.materials[material]
        geom = body.add_geom(name=name, type=kinds[piece.kind], pos=piece.pose.position, quat=piece.pose.quaternion)
        if piece.kind == "hull":
            mesh = self.out.add_mesh(name=name)
            mesh.uservert = piece.points.ravel().tolist()
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            geom.meshname = name
        elif piece.kind == "heightfield":
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
        geom.friction = [matter.friction, max(matter.rolling_friction, ROLLING_DEFAULT), max(matter.rolling_friction, ROLLING_DEFAULT)]
        geom.margin = self.settings.skin
        geom.solimp = SOLIMP
        self.geom_entity[name] = entity
        self.geom_restitution[name] = matter.restitution
        self.geoms_of[entity].append(name)

    def _fill(self, body: Any, entity: str, name: str) -> None:
        built = self.built[entity]
        mass = next(b for b in built.bodies if b.name == name)
        body.explicitinertial = True
        body.mass = mass.mass
        body.ipos = mass.center
        i = mass.inertia
        body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
        for part in built.parts_of(name):
            for k, piece in enumerate(part.collision):
                self._geom(body, f"{entity}/{part.part}/{k}", piece, entity, part.material)

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
        if entity.generator is not None:
            self._rope(name, base)
            return
        pose = compose(base, built.bodies[0].pose)
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
        self._fill(body, name, "body")
        self.made[name], self.world_pose[name] = body, pose

    def _rope(self, name: str, base: RigidPose) -> None:
        mujoco, rope = self.mj, self.spec.entities[name].generator
        assert rope is not None
        parent, parent_pose, previous = self.out.worldbody, _ORIGIN, ""
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
            self._fill(body, name, part.name)
            self.body_names.append(f"{name}/{part.name}")
            if previous:
                self.out.add_exclude(bodyname1=previous, bodyname2=body.name)
            parent, parent_pose, previous = body, pose, body.name
        self.made[name], self.world_pose[name] = parent, parent_pose
        if rope.attach_end is not None:
            last = self.built[name].bodies[-1]
            tip = _half_length(self.built[name], last.name)
            equality = self.out.add_equality(name=f"end/{name}", type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY)
            equality.name1 = previous
            if rope.attach_end != "world":
                self.entity(rope.attach_end)
                equality.name2 = rope.attach_end
            equality.data[:3] = [0, 0, tip]
        for end in (rope.attach_start, rope.attach_end):
            if end not in (None, "world"):
                for part in self.built[name].bodies:
                    self.out.add_exclude(bodyname1=f"{name}/{part.name}", bodyname2=str(end))

    def links(self) -> None:
        """Springs, detachable welds, excluded and special contact pairs, motors."""
        mujoco, plan = self.mj, self.spec.simulation
        for name, joint in plan.joints.items():
            if joint.child not in self.members:
                continue
            if isinstance(joint, SpringJoint):
                self._spring(name, joint)
                continue
            if isinstance(joint, WeldJoint) and self.tree.get(joint.child) != name:
                equality = self.out.add_equality(name=name, type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
                equality.name1 = joint.child
                equality.name2 = joint.parent or "world"
                local = self.world_pose[joint.child].inverse().apply(np.array([joint.anchor]))[0]
                equality.data[0:3] = local
                equality.data[10] = 1.0
            if not joint.collide and joint.parent is not None:
                self.out.add_exclude(bodyname1=joint.parent, bodyname2=joint.child)
        for name, driver in plan.drivers.items():
            if isinstance(driver, MotorDriver) and driver.joint in self.joint_names:
                gain = driver.max_effort / max(0.05 * abs(driver.velocity), 1e-3)
                actuator = self.out.add_actuator(name=name, target=driver.joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
                actuator.set_to_velocity(kv=gain)
                actuator.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
                actuator.forcerange = [-driver.max_effort, driver.max_effort]

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

    def pairs(self) -> list[float]:
        """Explicit pairs with their own friction and restitution; returns their restitutions."""
        values: list[float] = []
        for name, pair in self.spec.simulation.contacts.items():
            if pair.a not in self.members or pair.b not in self.members:
                continue
            combos = [(g, h) for g in self.geoms_of[pair.a] for h in self.geoms_of[pair.b]]
            if len(combos) > MAX_PAIR_GEOMS:
                raise InputError(
                    f"contact {name!r} joins {len(combos)} pieces, at most {MAX_PAIR_GEOMS}; give one of the entities fewer parts or segments"
                )
            mixed = {e: self.spec.materials[self.spec.entities[e].material] for e in (pair.a, pair.b)}
            friction = pair.friction if pair.friction is not None else max(m.friction for m in mixed.values())
            rolling = max(ROLLING_DEFAULT, *(m.rolling_friction for m in mixed.values()))
            bounce = pair.restitution if pair.restitution is not None else min(m.restitution for m in mixed.values())
            for g, h in combos:
                made = self.out.add_pair(name=f"{name}/{len(values)}", geomname1=g, geomname2=h)
                made.friction = [friction, friction, rolling, rolling, rolling]
                made.condim = 6 if rolling > ROLLING_DEFAULT else 3
                made.margin = 2 * self.settings.skin
                made.solimp = SOLIMP
                values.append(bounce)
        return values


_ORIGIN = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


def _half_length(built: BuiltEntity, body: str) -> float:
    return float(built.parts_of(body)[0].collision[0].params[1])


def build_model(spec: WorldSpec, built: Mapping[str, BuiltEntity], members: tuple[str, ...], settings: RigidSettings) -> RigidModel:
    """Compile the model of one solver instance.

    Raises:
        InputError: joints that form loops, share a child or name non-members; too many special pairs.
    """
    import mujoco

    builder = _Builder(spec, built, members, settings)
    builder.options(6 * sum(len(built[m].bodies) for m in members if spec.entities[m].motion != "static"))
    for name in members:
        builder.entity(name)
    builder.links()
    bounces = builder.pairs()
    try:
        model = builder.out.compile()
    except ValueError as error:
        raise InputError(f"MuJoCo refuses the model: {error}") from error
    colliders = tuple(members)
    rank = {name: i for i, name in enumerate(colliders)}
    geom_names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, g) for g in range(model.ngeom)]
    body_ids = [model.body(n.removesuffix("/body")).id for n in builder.body_names]
    result = RigidModel(
        model=model,
        colliders=colliders,
        bodies=tuple(builder.body_names),
        body_ids=np.array(body_ids, dtype=np.int64),
        geom_collider=np.array([rank[builder.geom_entity[g]] for g in geom_names], dtype=np.int64),
        joints=tuple(builder.joint_names),
        joint_qpos=np.array([model.joint(n).qposadr[0] for n in builder.joint_names], dtype=np.int64),
        restitution=np.array([builder.geom_restitution[g] for g in geom_names]),
        pair_restitution=np.array(bounces),
    )
    for name in spec.simulation.joints:
        equality = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_EQUALITY, name)
        tendon = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TENDON, name)
        if equality >= 0:
            result.eq_of[name] = equality
        if tendon >= 0:
            result.tendon_of[name] = tendon
    for name in spec.simulation.drivers:
        actuator = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
        if actuator >= 0:
            result.actuator_of[name] = actuator
    set_contact_law(result, settings.contact_steps, settings.step)
    return result


def set_contact_law(rigid: RigidModel, steps: float, dt: float) -> None:
    """Write step and contact, limit and equality stiffness for a time step `dt` [s]."""
    model = rigid.model
    model.opt.timestep = dt
    for values, target in ((rigid.restitution, model.geom_solref), (rigid.pair_restitution, model.pair_solref)):
        for e in np.unique(values):
            k, b = contact_reference(float(e), steps, dt)
            target[values == e] = (-k, -b)
    k, b = contact_reference(0.0, JOINT_STEPS, dt)
    for target in (model.eq_solref, model.jnt_solref):
        target[:] = (-k, -b)
    for target in (model.eq_solimp, model.jnt_solimp):
        target[:] = SOLIMP

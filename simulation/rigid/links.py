"""Links between entities of one solver instance: springs, welds that can open, motors, pairs with a friction of their own."""

from __future__ import annotations

import itertools

import numpy as np

from ...worlds.errors import InputError
from ...worlds.spec import MotorDriver, SpringJoint, WeldJoint
from .builder import ORIGIN, ROLLING_DEFAULT, ModelBuilder
from .flex import SOLIMP, is_soft

__all__ = ["add_links", "add_pairs"]

MAX_PAIR_GEOMS = 2000


def add_links(builder: ModelBuilder) -> None:
    """Springs, detachable welds, excluded and special contact pairs, motors."""
    mujoco, plan = builder.mj, builder.spec.simulation
    for a, b in (sorted(pair) for pair in builder.apart if pair <= set(builder.members)):
        if is_soft(builder.spec, a) or is_soft(builder.spec, b):
            continue  # `flex.part_flexes`
        for one, two in itertools.product(builder.bodies_of(a), builder.bodies_of(b)):
            builder.out.add_exclude(bodyname1=one, bodyname2=two)
    for name, joint in plan.joints.items():
        if joint.child not in builder.members:
            continue
        for side in (joint.parent, joint.child):
            if side is not None and side not in builder.made:
                raise InputError(f"joint {name!r} names {side!r}, which is not a member of the same solver instance; add it")
        if isinstance(joint, SpringJoint):
            _spring(builder, name, joint)
            continue
        parent_pose = ORIGIN if joint.parent is None else builder.world_pose[joint.parent]
        if isinstance(joint, WeldJoint) and builder.tree.get(joint.child) != name:
            equality = builder.out.add_equality(name=name, type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
            equality.name1 = builder.made[joint.child].name
            equality.name2 = "world" if joint.parent is None else builder.made[joint.parent].name
            # Layout: anchor in body 2 [0:3], relative pose [3:10] (zero: the pose of the model), torque scale [10].
            local = parent_pose.inverse().apply(np.array([joint.anchor]))[0]
            equality.data[0:3] = local
            equality.data[10] = 1.0
        if not joint.collide and joint.parent is not None:
            names = (builder.made[joint.parent].name, builder.made[joint.child].name)
            builder.out.add_exclude(name=name, bodyname1=names[0], bodyname2=names[1])
    for name, driver in plan.drivers.items():
        if isinstance(driver, MotorDriver) and driver.joint in builder.joint_names:
            gain = driver.max_effort / max(0.05 * abs(driver.velocity), 1e-3)
            actuator = builder.out.add_actuator(name=name, target=driver.joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            actuator.set_to_velocity(kv=gain)
            actuator.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
            actuator.forcerange = [-driver.max_effort, driver.max_effort]


def _spring(builder: ModelBuilder, name: str, joint: SpringJoint) -> None:
    sites = []
    for owner, point, tag in ((joint.child, joint.child_point, "a"), (joint.parent, joint.parent_point, "b")):
        body = builder.out.worldbody if owner is None else builder.made[owner]
        pose = ORIGIN if owner is None else builder.world_pose[owner]
        sites.append(f"{name}/{tag}")
        body.add_site(name=sites[-1], pos=pose.inverse().apply(np.array([point]))[0])
    rest = joint.rest_length
    if rest is None:
        rest = float(np.linalg.norm(np.subtract(joint.child_point, joint.parent_point)))
    tendon = builder.out.add_tendon(name=name)
    tendon.stiffness[0], tendon.damping[0] = joint.stiffness, joint.damping
    tendon.springlength = [0.0 if joint.rope else rest, rest]
    for site in sites:
        tendon.wrap_site(site)


def add_pairs(builder: ModelBuilder) -> dict[tuple[str, str], float]:
    """Explicit pairs with their own friction; returns the restitutions of pairs that have their own."""
    values: dict[tuple[str, str], float] = {}
    plan, matter = builder.spec.simulation, builder.spec.materials
    fastened = [j for j in plan.joints.values() if not isinstance(j, SpringJoint) and not j.collide]
    joined = {frozenset((j.parent, j.child)) for j in fastened}
    for name, pair in plan.contacts.items():
        if pair.a not in builder.members or pair.b not in builder.members or frozenset((pair.a, pair.b)) in joined:
            continue
        if pair.restitution is not None:
            values[pair.a, pair.b] = pair.restitution
        rest = pair.friction_at_rest
        if rest is None or frozenset((pair.a, pair.b)) in builder.apart:
            continue
        combos = [(g, h) for g in builder.geoms_of[pair.a] for h in builder.geoms_of[pair.b] if g != h]
        if len(combos) > MAX_PAIR_GEOMS:
            raise InputError(
                f"contact {name!r} joins {len(combos)} pieces, at most {MAX_PAIR_GEOMS}; "
                "give one of the entities fewer parts or segments"
            )
        for k, (g, h) in enumerate(combos):
            rolling = max(matter[builder.geom_material[x]].rolling_friction for x in (g, h))
            made = builder.out.add_pair(name=f"{name}/{k}", geomname1=g, geomname2=h)
            made.friction = [rest, rest, *[max(rolling, ROLLING_DEFAULT)] * 3]
            made.condim = 6 if rolling > 0 else 3
            made.margin = 2 * builder.settings.skin + builder.geom_excess[g] + builder.geom_excess[h]
            made.solimp = SOLIMP
    return values

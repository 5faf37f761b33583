"""Families of small worlds that the engine runs: flights, bounces, slides, joints, drivers, stacks. One world per variant."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import (
    BallJoint,
    Cylinder,
    Entity,
    ForceDriver,
    HingeJoint,
    Material,
    MotorDriver,
    PathDriver,
    PathKey,
    ReleaseDriver,
    RigidPhysics,
    RigidSettings,
    Rope,
    SlideJoint,
    SpringJoint,
    WeldJoint,
    WorldSpec,
)
from ..worlds.small_worlds import ball, box, entity, ground, pose, world
from ._films import cached

__all__ = [
    "VARIANTS",
    "bounce",
    "cradle",
    "flight",
    "gripped",
    "pendulum",
    "pile",
    "pushed",
    "roped",
    "slide",
    "sprung",
    "stack",
    "thrown_pair",
    "welded",
]

VARIANTS = 6
"""Worlds per family; details beyond them are drawn where a defect is written."""
STEP = 1e-3


def _rng(variant: int, family: int) -> np.random.Generator:
    return np.random.default_rng([variant, family])


def _at(origin: F64, x: float, y: float, z: float) -> tuple[float, float, float]:
    """A place given from a world's own origin."""
    return float(origin[0] + x), float(origin[1] + y), float(origin[2] + z)


def _far(rng: np.random.Generator) -> F64:
    """Every third world stands far from the origin."""
    return float(rng.choice([0.0, 0.0, 1.0])) * np.array([300.0, -200.0, 0.0])


def _moving(made: Entity, *, spin: Any = (0, 0, 0), mass: float | None = None, drag: float = 0.0) -> Entity:
    physics = made.physics
    assert isinstance(physics, RigidPhysics)
    changed = physics.model_copy(update={"angular_velocity": tuple(map(float, spin)), "mass": mass, "linear_damping": drag})
    return made.model_copy(update={"physics": changed})


def _materials(**more: Any) -> dict[str, Material]:
    base: dict[str, Any] = {"density": 600.0, "friction": 0.4, "restitution": 0.3, "substance": "wood"}
    return {"wood": Material(**(base | more))}


def _make(entities: dict[str, Entity], **more: Any) -> WorldSpec:
    return world(
        entities, settings=more.pop("settings", RigidSettings(step=STEP)), materials=more.pop("materials", _materials()), **more
    )


def _flight(variant: int) -> WorldSpec:
    """Two bodies thrown, one of them a tumbling rod or plate, one tiny; nothing touches."""
    rng = _rng(variant, 1)
    at = _far(rng)
    size = rng.uniform(0.05, 0.4, 3) * rng.choice([0.2, 1.0, 3.0])
    entities = {
        "floor": box(6, 6, 0.2, at=_at(at, 0, 0, -0.1)),
        "thrown": _moving(
            box(
                *size,
                motion="dynamic",
                at=_at(at, 0, 0, 3.0),
                euler=rng.uniform(-3, 3, 3),
                velocity=rng.uniform(-1, 1, 3) + np.array([0, 0, 4.0]),
            ),
            spin=rng.normal(size=3) * rng.uniform(0.5, 6.0),
        ),
        "small": ball(0.02, motion="dynamic", at=_at(at, 1.5, 0.5, 2.0), velocity=(0.2, 0.1, 4.5)),
    }
    return _make(entities, frames=14, fps=int(rng.choice([24, 30])))


def _bounce(variant: int) -> WorldSpec:
    """A ball that bounces once or twice, beside one that rolls."""
    rng = _rng(variant, 2)
    at, kept = _far(rng), (0.0, 0.3, 0.5, 0.7, 0.9, 1.0)[variant % 6]
    entities = {
        "floor": box(8, 8, 0.2, at=_at(at, 0, 0, -0.1)),
        "ball": ball(0.1, motion="dynamic", at=_at(at, 0, 0, rng.uniform(0.4, 0.8)), velocity=(rng.uniform(0, 1), 0.3, -0.5)),
        "other": box(0.2, 0.2, 0.2, motion="dynamic", at=_at(at, 2, 1, 0.1)),
    }
    return _make(entities, frames=18, materials=_materials(restitution=kept))


def _slide(variant: int) -> WorldSpec:
    """A box that slides on a floor or down a ramp."""
    rng = _rng(variant, 3)
    at, mu = _far(rng), float(rng.uniform(0.1, 0.4))
    heading, tilt = rng.uniform(0, 6.28), (0.0, 0.0, 0.2)[variant % 3]
    along = np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    normal = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    way = along if tilt else np.array([np.cos(heading), np.sin(heading), 0.0])
    place = normal * 0.0505 - along * 1.0 * (tilt > 0)
    entities = {
        "floor": box(12, 12, 0.4, at=at - normal * 0.2, euler=(0, tilt, 0)),
        "box": box(0.3, 0.2, 0.1, motion="dynamic", at=at + place, euler=(0, tilt, 0), velocity=way * rng.uniform(2.5, 3.5)),
    }
    return _make(entities, frames=14, materials=_materials(friction=mu, restitution=0.0))


def _gripped(variant: int) -> WorldSpec:
    """Boxes on a ramp between the angles of motion and of rest: one stays, one that was pushed slides on."""
    rng = _rng(variant, 12)
    at, mu, more = _far(rng), float(rng.uniform(0.15, 0.4)), float(rng.uniform(1.2, 1.8))
    tilt = float(np.arctan(mu * (0.5 + 0.5 * more)))
    along, normal = np.array([np.cos(tilt), 0.0, -np.sin(tilt)]), np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    pose = {"euler": (0, tilt, 0), "motion": "dynamic"}
    entities = {
        "floor": box(12, 12, 0.4, at=at - normal * 0.2, euler=(0, tilt, 0)),
        "box": box(0.3, 0.2, 0.1, at=at + normal * 0.0505 - along, velocity=along * rng.uniform(1.5, 2.5), **pose),
        "held": box(0.3, 0.2, 0.1, at=at + normal * 0.0505 + np.array([0.0, 1.0, 0.0]), **pose),
    }
    return _make(entities, frames=14, materials=_materials(friction=mu, static_friction=more * mu, restitution=0.0))


def _pendulum(variant: int) -> WorldSpec:
    """A damped pendulum on a hinge with a range, and a door-like slide."""
    rng = _rng(variant, 4)
    at = _far(rng)
    entities = {
        "post": box(0.1, 0.1, 2.0, at=_at(at, 0, -0.3, 1.0)),
        "bob": box(0.4, 0.05, 0.1, motion="dynamic", at=_at(at, 0.25, 0, 1.8)),
        "block": box(0.2, 0.2, 0.2, motion="dynamic", at=_at(at, 1.5, 0, 1.0)),
    }
    joints = {
        "pivot": HingeJoint(
            child="bob", anchor=_at(at, 0, 0, 1.8), axis=(0, 1, 0), damping=float(rng.uniform(0, 0.02)), range=(-2.5, 2.5)
        ),
        "rail": SlideJoint(child="block", anchor=_at(at, 1.5, 0, 1.0), axis=(0, 0.6, -0.8), friction=0.2),
    }
    return _make(entities, frames=16, joints=joints)


def _welded(variant: int) -> WorldSpec:
    """Two boxes welded and thrown; two balls on a ball joint."""
    rng = _rng(variant, 5)
    at = _far(rng)
    entities = {
        "floor": box(6, 6, 0.2, at=_at(at, 0, 0, -0.1)),
        "head": box(0.2, 0.2, 0.2, motion="dynamic", at=_at(at, 0, 0, 3.0)),
        "tail": box(0.3, 0.1, 0.1, motion="dynamic", at=_at(at, 0.255, 0, 3.0)),
        "left": ball(0.1, motion="dynamic", at=_at(at, 2, 0, 3.0)),
        "right": ball(0.06, motion="dynamic", at=_at(at, 2.2, 0, 3.0)),
    }
    joints = {
        "glue": WeldJoint(parent="head", child="tail", anchor=_at(at, 0.1, 0, 3.0)),
        "knee": BallJoint(parent="left", child="right", anchor=_at(at, 2.12, 0, 3.0)),
    }
    drivers = {
        "turn": ForceDriver(entity="head", force=(0, 0, 30.0), torque=tuple(rng.uniform(-0.2, 0.2, 3)), start=0.0, end=0.2)
    }
    return _make(entities, frames=14, joints=joints, drivers=drivers)


def _roped(variant: int) -> WorldSpec:
    """A rope that swings from a post."""
    rng = _rng(variant, 6)
    at = _far(rng)
    segments = int(rng.integers(5, 9))
    rope = Rope(points=[(0, 0, 0), (0.8, 0, 0)], radius=0.01, segments=segments, attach_start="world", damping=1e-3)
    entities = {
        "post": box(0.1, 0.1, 2.0, at=_at(at, -0.2, 0, 1.0)),
        "rope": entity(motion="dynamic", at=_at(at, 0, 0, 2.0), rope=rope),
    }
    return _make(entities, frames=12)


def _sprung(variant: int) -> WorldSpec:
    """A mass on a soft spring from the ceiling, and two masses that swing about each other."""
    rng = _rng(variant, 7)
    at = _far(rng)
    entities = {
        "beam": box(1, 0.1, 0.1, at=_at(at, 0, 0, 2.5)),
        "mass": _moving(box(0.2, 0.2, 0.2, motion="dynamic", at=_at(at, 0, 0, 1.2)), mass=2.0),
        "one": _moving(ball(0.1, motion="dynamic", at=_at(at, 2, 0, 2.0), velocity=(0, 0.5, 2.0)), mass=1.0),
        "two": _moving(ball(0.1, motion="dynamic", at=_at(at, 2.6, 0, 2.0), velocity=(0, -0.5, 2.0)), mass=1.5),
    }
    joints = {
        "hang": SpringJoint(
            child="mass",
            child_point=_at(at, 0, 0, 1.3),
            parent_point=_at(at, 0, 0, 2.45),
            stiffness=float(rng.uniform(30, 80)),
            damping=0.5,
        ),
        "pull": SpringJoint(
            parent="one",
            child="two",
            parent_point=_at(at, 2, 0, 2),
            child_point=_at(at, 2.6, 0, 2),
            stiffness=30.0,
            rest_length=0.45,
        ),
    }
    return _make(entities, frames=14, joints=joints)


def _pushed(variant: int) -> WorldSpec:
    """A path, a motor, a force and a release: drivers that add energy."""
    rng = _rng(variant, 8)
    at = _far(rng)
    keys = {
        "a": PathKey(time=0.05, pose=pose(_at(at, -1, 0, 0.16))),
        "b": PathKey(time=0.6, pose=pose(_at(at, 0, 0.2, 0.16), euler=(0, 0, 0.6))),
    }
    entities = {
        "floor": box(10, 10, 0.2, at=_at(at, 0, 0, -0.1)),
        "pusher": box(0.1, 0.4, 0.3, motion="kinematic", at=_at(at, -1, 0, 0.16)),
        "cart": box(0.2, 0.2, 0.2, motion="dynamic", at=_at(at, -0.7, 0, 0.1005)),
        "rocket": box(0.1, 0.1, 0.3, motion="dynamic", at=_at(at, 2, 0, 1.0), velocity=(0, 0, 0.5)),
        "late": box(0.15, 0.1, 0.1, motion="dynamic", at=_at(at, 2, 2, 1.5), euler=(0.3, 0.2, 0)),
        "wheel": entity(Cylinder(radius=0.2, height=0.05), motion="dynamic", at=_at(at, 0, 3, 1.0)),
    }
    joints = {"axle": HingeJoint(child="wheel", anchor=_at(at, 0, 3, 1.0), axis=(0, 0, 1))}
    drivers = {
        "path": PathDriver(entity="pusher", keys=keys),
        "burn": ForceDriver(
            entity="rocket", force=(0, 0, 30.0), torque=(0, 0.0, 0.01), start=0.1, end=float(rng.uniform(0.3, 0.45))
        ),
        "drop": ReleaseDriver(entity="late", time=float(rng.uniform(0.1, 0.4))),
        "spin": MotorDriver(joint="axle", velocity=10.0, max_effort=0.5, start=0.1, end=0.4),
    }
    return _make(entities, frames=16, joints=joints, drivers=drivers, materials=_materials(restitution=0.0))


def _stack(variant: int) -> WorldSpec:
    """A stack that comes to rest and sleeps, one ball that is dropped on it late."""
    rng = _rng(variant, 9)
    at = _far(rng)
    width = float(rng.uniform(0.1, 0.3))
    entities = {"floor": box(6, 6, 0.2, at=_at(at, 0, 0, -0.1))}
    for k in range(3):
        entities[f"block{k}"] = box(width, width, 0.1, motion="dynamic", at=_at(at, 0, 0, 0.05 + 0.1 * k))
    entities["ball"] = ball(0.04, motion="dynamic", at=_at(at, 0.01, 0, 1.6))
    return _make(entities, frames=24)


def _cradle(variant: int) -> WorldSpec:
    """Balls in a row, hit by one, without gravity and without losses: momentum travels through."""
    rng = _rng(variant, 10)
    at = _far(rng)
    count = int(rng.integers(2, 5))
    speed = float(rng.uniform(1.0, 3.0))
    entities = {
        f"ball{k}": ball(
            0.05, motion="dynamic", at=_at(at, 0.1003 * k if k else -0.4, 0, 1), velocity=(speed if k == 0 else 0, 0, 0)
        )
        for k in range(count)
    }
    return _make(entities, frames=16, gravity=(0, 0, 0), materials=_materials(restitution=(1.0, 0.5)[variant % 2]))


def _thrown_pair(variant: int) -> WorldSpec:
    """Two bodies that meet in the air and touch nothing else."""
    rng = _rng(variant, 11)
    at = _far(rng)
    heavy = float(rng.choice([1.0, 1.0, 20.0]))
    entities = {
        "floor": box(6, 6, 0.2, at=_at(at, 0, 0, -0.1)),
        "left": _moving(ball(0.1, motion="dynamic", at=_at(at, -0.6, 0, 3), velocity=(2.0, 0, 2.0)), mass=heavy),
        "right": _moving(
            ball(0.1, motion="dynamic", at=_at(at, 0.6, float(rng.uniform(-0.05, 0.05)), 3), velocity=(-2.0, 0, 2.0)), mass=1.0
        ),
    }
    return _make(entities, frames=14, materials=_materials(restitution=float(rng.uniform(0.1, 0.9))))


def _pile(variant: int) -> WorldSpec:
    """Boxes that fall on each other without bouncing."""
    rng = _rng(variant, 12)
    entities = {"floor": ground(6.0)}
    for k in range(4):
        entities[f"box{k}"] = box(
            *rng.uniform(0.08, 0.2, 3),
            motion="dynamic",
            at=(*rng.uniform(-0.05, 0.05, 2), 0.2 + 0.3 * k),
            euler=rng.uniform(-1, 1, 3),
        )
    return _make(entities, frames=20, materials=_materials(restitution=0.0))


flight, bounce, slide, gripped, pendulum = (cached(f) for f in (_flight, _bounce, _slide, _gripped, _pendulum))
welded, roped = cached(_welded), cached(_roped)
sprung, pushed, stack, cradle, thrown_pair, pile = (cached(f) for f in (_sprung, _pushed, _stack, _cradle, _thrown_pair, _pile))

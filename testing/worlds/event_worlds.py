"""Small worlds in each of which one kind of event happens to a body, or something near it: run by the engine, named by what is true."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from ...worlds.spec import (
    Box,
    DetachDriver,
    Entity,
    ForceDriver,
    HingeJoint,
    Material,
    Part,
    PathDriver,
    PathKey,
    Pose,
    ReleaseDriver,
    RigidSettings,
    Rope,
    SpringJoint,
    WeldJoint,
    WorldSpec,
)
from ...worlds.spec.fields import FieldDriver, WindField
from ...worlds.vocabulary import SpecModel
from .cart_worlds import parked, wedged
from .small_worlds import ball, box, entity, ground, pose, world

__all__ = ["EVENT_WORLDS", "event_world"]

SETTINGS = RigidSettings(step=1e-3)
SLIPPERY = {"wood": Material(density=600.0, friction=0.05, restitution=0.0, substance="wood")}
BOUNCY = {"wood": Material(density=600.0, friction=0.4, restitution=0.7, substance="wood")}
GRIPPY = {"wood": Material(density=600.0, friction=0.9, restitution=0.0, substance="wood")}


def _path(name: str, keys: Sequence[tuple[float, Sequence[float]]], euler: Sequence[Sequence[float]] | None = None) -> PathDriver:
    turns = euler or [(0.0, 0.0, 0.0)] * len(keys)
    made = {
        f"k{i}": PathKey(time=t, pose=Pose(position=tuple(map(float, at)), euler=tuple(map(float, turn))))
        for i, ((t, at), turn) in enumerate(zip(keys, turns, strict=True))
    }
    return PathDriver(entity=name, keys=made)


def _world(
    entities: Mapping[str, Entity], *, frames: int = 36, drivers: Mapping[str, SpecModel] | None = None, **more: object
) -> WorldSpec:
    return world({"floor": ground(20.0), **entities}, frames=frames, settings=SETTINGS, drivers=dict(drivers or {}), **more)  # type: ignore[arg-type]


def drop() -> WorldSpec:
    """A ball falls 1 m onto the floor and stays."""
    return _world({"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.1))}, materials=GRIPPY)


def bounce() -> WorldSpec:
    """A ball falls 1 m onto the floor, bounces off it and comes down again."""
    return _world({"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.1))}, materials=BOUNCY)


def rest() -> WorldSpec:
    """A box stands on another throughout."""
    lower, upper = (box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, z)) for z in (0.101, 0.302))
    return _world({"lower": lower, "box": upper})


def lowered() -> WorldSpec:
    """A platform on a path takes a box down by 0.8 m in 1.2 s."""
    platform = box(0.4, 0.4, 0.05, motion="kinematic", at=(0, 0, 1.0))
    return _world(
        {"hand": platform, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 1.126))},
        drivers={"path": _path("hand", [(0.0, (0, 0, 1.0)), (0.3, (0, 0, 0.96)), (1.2, (0, 0, 0.2))])},
    )


def lifted() -> WorldSpec:
    """A platform on a path takes a box up by 0.8 m in 1.2 s."""
    platform = box(0.4, 0.4, 0.05, motion="kinematic", at=(0, 0, 0.2))
    return _world(
        {"hand": platform, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.326))},
        drivers={"path": _path("hand", [(0.0, (0, 0, 0.2)), (0.3, (0, 0, 0.24)), (1.2, (0, 0, 1.0))])},
    )


def roll() -> WorldSpec:
    """A ball rolls along the floor."""
    start = ball(0.1, motion="dynamic", at=(0, 0, 0.101), velocity=(1.0, 0, 0))
    physics = start.physics.model_copy(update={"angular_velocity": (0.0, 10.0, 0.0)})
    return _world({"ball": start.model_copy(update={"physics": physics})}, materials=GRIPPY)


def slide() -> WorldSpec:
    """A box slides along the floor until friction stops it."""
    return _world({"box": box(0.2, 0.2, 0.1, motion="dynamic", at=(0, 0, 0.051), velocity=(2.0, 0, 0))})


def slip() -> WorldSpec:
    """A ball slides along a slippery floor and hardly turns."""
    return _world({"ball": ball(0.1, motion="dynamic", at=(0, 0, 0.101), velocity=(1.5, 0, 0))}, materials=SLIPPERY, frames=20)


def topple() -> WorldSpec:
    """A slab gets a turn at the start, passes its balance and falls flat."""
    slab = box(0.04, 0.1, 0.3, motion="dynamic", at=(0, 0, 0.151))
    physics = slab.physics.model_copy(update={"angular_velocity": (0.0, 2.5, 0.0), "linear_velocity": (0.375, 0.0, 0.0)})
    return _world({"slab": slab.model_copy(update={"physics": physics})}, materials=GRIPPY)


def topple_against() -> WorldSpec:
    """A force that begins between two frames tips a cupboard over its front edge, until it leans on a lower block after 0.6 rad."""
    cupboard = box(0.3, 1.0, 1.3, motion="dynamic", at=(0, 0, 0.651))
    push = ForceDriver(entity="cupboard", force=(500.0, 0.0, 0.0), torque=(0.0, 315.0, 0.0), start=0.405, end=0.95)
    return _world(
        {"cupboard": cupboard, "block": box(0.5, 1.0, 1.0, at=(1.084, 0, 0.501))}, materials=GRIPPY, drivers={"push": push}
    )


def rock() -> WorldSpec:
    """A slab gets a turn at the start, does not reach its balance and rocks back."""
    slab = box(0.1, 0.1, 0.3, motion="dynamic", at=(0, 0, 0.151))
    physics = slab.physics.model_copy(update={"angular_velocity": (0.0, 1.5, 0.0), "linear_velocity": (0.22, 0.0, 0.0)})
    return _world({"slab": slab.model_copy(update={"physics": physics})}, materials=GRIPPY)


def laid_down() -> WorldSpec:
    """A plank stands with one edge on the floor; a platform on a path takes its other end down."""
    lean = math.asin(0.5)
    plank = box(1.0, 0.2, 0.04, motion="dynamic", at=(0, 0, 0.5 * 0.5 + 0.03), euler=(0, -lean, 0))
    hand = box(0.06, 0.2, 0.1, motion="kinematic", at=(0.36, 0, 0.38))
    keys = [(0.0, (0.36, 0, 0.38)), (0.4, (0.36, 0, 0.33)), (1.5, (0.36, 0, 0.06))]
    return _world({"plank": plank, "hand": hand}, frames=48, materials=GRIPPY, drivers={"path": _path("hand", keys)})


def push() -> WorldSpec:
    """A hand on a path pushes a box 0.6 m along the floor."""
    hand = box(0.1, 0.2, 0.2, motion="kinematic", at=(-0.16, 0, 0.12))
    return _world(
        {"hand": hand, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101))},
        drivers={"path": _path("hand", [(0.0, (-0.16, 0, 0.12)), (1.2, (0.5, 0, 0.12))])},
    )


def hit() -> WorldSpec:
    """A box slides into another that rests and sends it off."""
    one, two = (box(0.2, 0.2, 0.2, motion="dynamic", at=(x, 0, 0.101), velocity=(v, 0, 0)) for x, v in ((-0.5, 3.0), (0.0, 0.0)))
    return _world({"hitter": one, "box": two}, materials={"wood": BOUNCY["wood"].model_copy(update={"friction": 0.2})})


def shove() -> WorldSpec:
    """A force moves a box sideways along the floor."""
    return _world(
        {"box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101))},
        drivers={"wind": ForceDriver(entity="box", force=(40.0, 0.0, 0.0), start=0.1, end=0.8)},
    )


def held() -> WorldSpec:
    """A ball is held in the air throughout."""
    return _world(
        {"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.1))}, drivers={"latch": ReleaseDriver(entity="ball", time=100.0)}
    )


def spin() -> WorldSpec:
    """A disc of a box turns on the spot, about the upright axis, in the air without gravity."""
    disc = box(0.2, 0.2, 0.05, motion="dynamic", at=(0, 0, 1.0))
    physics = disc.physics.model_copy(update={"angular_velocity": (0.0, 0.0, 12.0)})
    return _world({"box": disc.model_copy(update={"physics": physics})}, gravity=(0.0, 0.0, 0.0))


def swing() -> WorldSpec:
    """A box on a rod of no mass swings about a point of the ceiling."""
    lean = math.radians(40.0)
    bob = box(0.1, 0.1, 0.1, motion="dynamic", at=(math.sin(lean), 0, 2.0 - math.cos(lean)))
    return _world({"bob": bob}, frames=72, joints={"pin": HingeJoint(child="bob", anchor=(0, 0, 2.0), axis=(0, 1, 0))})


def hang() -> WorldSpec:
    """A box on such a rod hangs straight down throughout."""
    bob = box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 1.0))
    return _world({"bob": bob}, joints={"pin": HingeJoint(child="bob", anchor=(0, 0, 2.0), axis=(0, 1, 0))})


def waved() -> WorldSpec:
    """A hand on a path carries a box to and fro."""
    keys = [(0.0, (0, 0, 0.5)), (0.5, (0.3, 0, 0.5)), (1.0, (-0.3, 0, 0.5)), (1.5, (0.3, 0, 0.5))]
    return _world(
        {
            "hand": box(0.4, 0.4, 0.05, motion="kinematic", at=(0, 0, 0.5)),
            "box": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.576)),
        },
        drivers={"path": _path("hand", keys)},
        materials=GRIPPY,
    )


def jump() -> WorldSpec:
    """A loaded spring below a box sends it off the floor."""
    spring = SpringJoint(
        parent="floor",
        child="box",
        parent_point=(0, 0, 0),
        child_point=(0, 0, 0.101),
        stiffness=4000.0,
        rest_length=0.2,
        damping=5.0,
    )
    return _world(
        {"box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101))},
        joints={"leg": spring},
        drivers={"latch": ReleaseDriver(entity="box", time=0.3), "cut": DetachDriver(joint="leg", time=0.36)},
    )


def toss() -> WorldSpec:
    """A platform on a path carries a box up, faster and faster, and stops: the box flies on."""
    platform = box(0.4, 0.4, 0.05, motion="kinematic", at=(0, 0, 0.2))
    keys = [(0.0, (0, 0, 0.2)), (0.15, (0, 0, 0.26)), (0.35, (0, 0, 0.8)), (0.4, (0, 0, 0.81)), (1.4, (0, 0, 0.81))]
    return _world(
        {"hand": platform, "box": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.276))}, drivers={"path": _path("hand", keys)}
    )


def drift() -> WorldSpec:
    """A light ball without weight goes slowly along with the wind."""
    light = {"wood": Material(density=20.0, friction=0.4, restitution=0.0, substance="foam")}
    wind = FieldDriver(field=WindField(velocity=(0.4, 0.0, 0.0)))
    return _world(
        {"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.0))},
        frames=72,
        gravity=(0, 0, 0),
        materials=light,
        drivers={"wind": wind},
    )


def glide() -> WorldSpec:
    """A ball without weight goes on slowly by itself."""
    return _world({"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.0), velocity=(0.2, 0, 0))}, frames=72, gravity=(0, 0, 0))


def pull() -> WorldSpec:
    """A hand on a path pulls a box along the floor by a rope."""
    rope = SpringJoint(
        parent="hand",
        child="box",
        parent_point=(0.6, 0, 0.101),
        child_point=(0.1, 0, 0.101),
        stiffness=2000.0,
        damping=20.0,
        rope=True,
    )
    return _world(
        {
            "hand": box(0.1, 0.1, 0.1, motion="kinematic", at=(0.6, 0, 0.101)),
            "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101)),
        },
        joints={"rope": rope},
        drivers={"path": _path("hand", [(0.0, (0.6, 0, 0.101)), (0.3, (0.65, 0, 0.101)), (1.4, (1.3, 0, 0.101))])},
    )


def downhill() -> WorldSpec:
    """A marble, let go on a ramp, rolls down it."""
    lean, radius = math.radians(20.0), 0.014
    ramp = box(4.0, 1.0, 0.1, at=(0, 0, 1.0), euler=(0, lean, 0))
    off = 0.05 + radius + 0.001
    marble = ball(radius, motion="dynamic", at=(off * math.sin(lean), 0, 1.0 + off * math.cos(lean)))
    return _world({"ramp": ramp, "ball": marble}, frames=20, materials=GRIPPY)


def towed() -> WorldSpec:
    """A hand on a path pulls a box along the floor by a rope of many pieces."""
    line = entity(
        motion="dynamic",
        at=(0, 0, 0),
        rope=Rope(points=[(0.1, 0, 0.15), (0.55, 0, 0.15)], radius=0.01, segments=6, attach_start="box", attach_end="hand"),
    )
    return _world(
        {
            "hand": box(0.1, 0.1, 0.1, motion="kinematic", at=(0.6, 0, 0.15)),
            "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101)),
            "line": line,
        },
        drivers={"path": _path("hand", [(0.0, (0.6, 0, 0.15)), (0.3, (0.65, 0, 0.15)), (1.4, (1.3, 0, 0.15))])},
    )


def uphill() -> WorldSpec:
    """A ball rolls up a ramp."""
    lean = math.radians(20.0)
    ramp = box(4.0, 1.0, 0.1, at=(2.0 * math.cos(lean), 0, 2.0 * math.sin(lean)), euler=(0, -lean, 0))
    off = 0.05 + 0.101
    start = ball(
        0.1, motion="dynamic", at=(0.5 * math.cos(lean) - off * math.sin(lean), 0, 0.5 * math.sin(lean) + off * math.cos(lean))
    )
    speed = 2.5
    physics = start.physics.model_copy(
        update={
            "linear_velocity": (speed * math.cos(lean), 0.0, speed * math.sin(lean)),
            "angular_velocity": (0.0, speed / 0.1, 0.0),
        }
    )
    return _world({"ramp": ramp, "ball": start.model_copy(update={"physics": physics})}, frames=20, materials=GRIPPY)


def loose() -> WorldSpec:
    """A box that is welded to a beam comes off it and falls."""
    return _world(
        {"beam": box(1.0, 0.1, 0.1, at=(0, 0, 2.0)), "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 1.85))},
        joints={"weld": WeldJoint(parent="beam", child="box", anchor=(0, 0, 1.95))},
        drivers={"cut": DetachDriver(joint="weld", time=0.5)},
    )


def fixed() -> WorldSpec:
    """A box stays welded to a beam throughout."""
    spec = loose()
    return spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"drivers": {}})})


def _door(start: float, spin: float) -> WorldSpec:
    posts = [Part(shape=Box(size=(0.1, 0.1, 2.0)), pose=pose((x, 0, 0))) for x in (-0.06, 0.92)]
    frame = entity(*posts, at=(0, 0, 1.0))
    leaf = box(0.84, 0.04, 1.8, motion="dynamic", at=(0.43 * math.cos(start), 0.43 * math.sin(start), 1.0), euler=(0, 0, start))
    push = ForceDriver(entity="door", torque=(0.0, 0.0, 60.0 * spin), start=0.0, end=0.15)
    hinge = HingeJoint(
        parent="frame", child="door", anchor=(0.0, 0.0, 1.0), axis=(0, 0, 1), friction=2.0, range=(-start, 1.6 - start)
    )
    return _world({"frame": frame, "door": leaf}, joints={"hinge": hinge}, drivers={"push": push})


def door_opens() -> WorldSpec:
    """A door that lies against its frame is given a turn and opens."""
    return _door(0.0, 1.5)


def door_closes() -> WorldSpec:
    """A door that stands open is given a turn and falls shut."""
    return _door(1.2, -2.0)


def door_moves() -> WorldSpec:
    """A door that stands half open opens a little farther."""
    return _door(0.7, 0.6)


def lean() -> WorldSpec:
    """A plank stands with its lower edge on the floor and its upper edge against a wall."""
    tilt = math.radians(20.0)
    wall = box(0.2, 2.0, 2.0, at=(0.1, 0, 1.0))
    low = (0.5 * math.sin(tilt) + 0.02 * math.cos(tilt), 0.5 * math.cos(tilt) + 0.02 * math.sin(tilt))
    plank = box(0.04, 0.2, 1.0, motion="dynamic", at=(-low[0] - 0.0011, 0, low[1] + 0.0011), euler=(0, tilt, 0))
    return _world({"wall": wall, "plank": plank}, frames=30, materials=GRIPPY)


def beside() -> WorldSpec:
    """A box stands beside a wall that it touches, and would stay without it."""
    wall = box(0.2, 2.0, 2.0, at=(0.1, 0, 1.0))
    return _world({"wall": wall, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(-0.101, 0, 0.101))}, frames=30)


def meets() -> WorldSpec:
    """A box slides along the floor against a wall, which stops it, and stays there."""
    wall = box(0.2, 2.0, 0.5, at=(0.4, 0, 0.25))
    return _world(
        {"wall": wall, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101), velocity=(1.2, 0, 0))},
        materials=SLIPPERY,
        frames=48,
    )


def reaches() -> WorldSpec:
    """A box slides along the floor up to a wall, nearly stopped by friction when it touches it."""
    wall = box(0.2, 2.0, 0.5, at=(0.4, 0, 0.25))
    return _world(
        {"wall": wall, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101), velocity=(0.44, 0, 0))},
        materials=SLIPPERY,
        frames=48,
    )


def jam() -> WorldSpec:
    """A force drives a box along the floor against a wall that holds it."""
    wall = box(0.2, 2.0, 0.5, at=(0.6, 0, 0.25))
    push = ForceDriver(entity="box", force=(40.0, 0.0, 0.0), start=0.1, end=10.0)
    return _world(
        {"wall": wall, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101))}, frames=48, drivers={"wind": push}
    )


def _seesaw(bag: float, catch: Mapping[str, Entity]) -> WorldSpec:
    """A beam on a hinge lies with one end on a block and a cube on that end; a bag is let go over the other, [kg/m^3]."""
    beam = box(1.4, 0.2, 0.03, motion="dynamic", at=(0, 0, 0.269), euler=(0, 0.3, 0))
    low = (0.7 * math.cos(0.3), 0.269 - 0.7 * math.sin(0.3))
    up = (math.sin(0.3), math.cos(0.3))
    ends = {f"rest_{k}": box(0.06, 0.2, 0.05, at=(side * (low[0] - 0.05), 0, 0.025)) for k, side in enumerate((1, -1))}
    middle = (0.6 * math.cos(0.3) + 0.0665 * up[0], 0.269 - 0.6 * math.sin(0.3) + 0.0665 * up[1])
    cube = box(0.1, 0.1, 0.1, motion="dynamic", at=(middle[0], 0, middle[1]), euler=(0, 0.3, 0))
    sack = box(0.2, 0.16, 0.12, motion="dynamic", at=(-0.5, 0, 0.85), material="sack")
    oak = Material(density=600.0, friction=0.6, restitution=0.0, substance="wood")
    materials = {"wood": oak, "sack": Material(density=bag, friction=0.6, restitution=0.0)}
    hinge = HingeJoint(child="beam", anchor=(0, 0, 0.269), axis=(0, 1, 0), damping=0.01)
    things = {"beam": beam, **ends, "cube": cube, "bag": sack, **catch}
    return _world(things, joints={"pivot": hinge}, materials=materials)


def seesaw() -> WorldSpec:
    """A bag falls on one end of a beam on a hinge, whose other end lifts a cube."""
    return _seesaw(1500.0, {})


def seesaw_struck() -> WorldSpec:
    """A bag falls on a shelf over one end of a beam on a hinge; nothing moves the cube on the other end."""
    return _seesaw(1500.0, {"shelf": box(0.4, 0.3, 0.02, at=(-0.5, 0, 0.7))})


EVENT_WORLDS: Mapping[str, Callable[[], WorldSpec]] = {
    make.__name__: make
    for make in (
        drop,
        bounce,
        rest,
        lowered,
        lifted,
        roll,
        slide,
        slip,
        topple,
        topple_against,
        rock,
        laid_down,
        push,
        hit,
        shove,
        held,
        spin,
        swing,
        hang,
        waved,
        jump,
        toss,
        drift,
        glide,
        pull,
        towed,
        uphill,
        downhill,
        loose,
        fixed,
        door_opens,
        door_closes,
        door_moves,
        lean,
        beside,
        meets,
        reaches,
        jam,
        seesaw,
        seesaw_struck,
        wedged,
        parked,
    )
}
"""By name."""


def event_world(name: str) -> WorldSpec:
    """The specification of a world."""
    return EVENT_WORLDS[name]()

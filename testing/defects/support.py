"""Seeded defects of support: what floats, slips, tips or hangs on nothing, and what only seems to."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...verifiers.support.bounds import MISSING, OUTSIDE
from ...worlds.predicates import Displacement
from ...worlds.spec import (
    BallJoint,
    Beat,
    Box,
    Capsule,
    Cylinder,
    DetachDriver,
    Extrusion,
    Fastened,
    HingeJoint,
    MotorDriver,
    Part,
    Pose,
    Rope,
    Sphere,
    SpringJoint,
    Wedge,
    WeldJoint,
)
from ._bonded_worlds import BONDED_MECHANISMS
from ._held_worlds import HELD_MECHANISMS
from ._hung_worlds import HUNG_MECHANISMS
from ._land_support import LAND_MECHANISMS
from ._loose_worlds import LOOSE_MECHANISMS
from ._lump_worlds import LUMP_MECHANISMS
from ._support_scenes import DRIFT, GAP, cart, draw_size, edge, ladder, seesaw, slide, slope, stair, wedged
from ._support_worlds import FRAMES, RNG, Scene, block, turn
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

FITTED = 5e-5
"""Gap to a wall up to which a body fits it [m]."""
OVER, UNDER = 1.05, 0.95
"""Just over and just under a bound."""


# ---------------------------------------------------------------- gaps and chains


def _afloat(folder: Path, m: float, rng: RNG) -> World:
    scene, size = Scene(rng), draw_size(rng)
    shape = Sphere(radius=float(size[2]) / 2) if rng.random() < 0.3 else block(rng, size)
    scene.add("thing", shape, at=(0, 0, size[2] / 2 + m), motion="dynamic")
    if rng.random() < 0.7:
        scene.on("floor", "thing")
    return scene.world(folder, "thing", still=True)


def _lifted(folder: Path, m: float, rng: RNG) -> World:
    """At one frame only, which may be the last."""
    scene, size = Scene(rng), draw_size(rng)
    frame = int(rng.choice([1, FRAMES - 1, int(rng.integers(1, FRAMES))]))
    path = np.tile([0.0, 0.0, size[2] / 2], (FRAMES, 1))
    path[frame, 2] += m
    scene.add("thing", block(rng, size), at=path[0], motion="dynamic", path=path)
    scene.on("floor", "thing")
    return scene.world(folder, "thing")


def _late_start(folder: Path, m: float, rng: RNG) -> World:
    """Floats at frame 0; the relation is declared only for later, when it has landed."""
    scene, size = Scene(rng), draw_size(rng)
    path = np.tile([0.0, 0.0, size[2] / 2], (FRAMES, 1))
    path[:5, 2] += m * np.linspace(1, 0, 5)
    scene.add("thing", block(rng, size), at=path[0], motion="dynamic", path=path)
    scene.on("floor", "thing", frames=(int(rng.integers(5, 9)), FRAMES - 1))
    return scene.world(folder, "thing")


def _speck(folder: Path, m: float, rng: RNG) -> World:
    """A tiny body floats over a huge one, among many."""
    scene, radius = Scene(rng), float(rng.uniform(0.001, 0.005))
    for k in range(30):
        place = (0.05 * (k % 6), 0.05 * (k // 6) + 0.1, radius + 1e-4)
        scene.add(f"peer{k}", Box(size=(2 * radius,) * 3), at=place, motion="dynamic")
    scene.add("thing", Sphere(radius=radius), at=(0.1, 0, radius + m), motion="dynamic")
    scene.on("floor", "thing")
    return scene.world(folder, "thing", still=True)


def _floating_pair(folder: Path, m: float, rng: RNG) -> World:
    """A stack, or two hooked into each other, with nothing beneath."""
    scene, size = Scene(rng), draw_size(rng)
    if rng.random() < 0.5:
        scene.add("thing", Box(size=tuple(size)), at=(0, 0, m + size[2] / 2), motion="dynamic")
        scene.add("rider", Box(size=tuple(0.8 * size)), at=(0, 0, m + 1.4 * size[2] + 1e-4), motion="dynamic")
        scene.on("thing", "rider")
    else:
        # Two rings of angles, each resting on the other's shelf.
        t = 0.1
        for name, x, sign in (("thing", 0.0, 1.0), ("rider", 1.0, -1.0)):
            parts = [
                Part(shape=Box(size=(1.0, t, t)), pose=Pose(position=(sign * 0.5, sign * -0.2, 0))),
                Part(shape=Box(size=(t, 0.6, t)), pose=Pose(position=(sign * 0.5, 0, sign * -(t + 1e-4)))),
            ]
            scene.add(name, *parts, at=(x, 0, m + 0.5), motion="dynamic")
    if rng.random() < 0.5:
        scene.on("floor", "thing")
    return scene.world(folder, "thing", "rider", still=True)


def _side_only(folder: Path, m: float, rng: RNG) -> World:
    """It touches a wall, or the underside of a shelf, and nothing else; or it stands, and the wall is said to carry it."""
    scene, size, kind = Scene(rng), m * draw_size(rng, 0.5, 2.0), int(rng.integers(3))
    height = 0.0 if kind == 2 else float(rng.uniform(0.05, 1.0))
    middle = height + size[2] / 2 + 1e-4
    scene.add("thing", Box(size=tuple(size)), at=(0, 0, middle), motion="dynamic")
    touch = float(rng.uniform(0, 0.9 * GAP))
    if kind == 1:
        scene.add("wall", Box(size=(2, 2, 0.1)), at=(0, 0, middle + size[2] / 2 + 0.05 + touch))
    else:
        scene.add("wall", Box(size=(0.1, 3, 6)), at=(size[0] / 2 + 0.05 + touch, 0, 0))
    scene.on("wall", "thing")
    return scene.world(folder, "thing", still=True)


def _pulled_out(folder: Path, m: float, rng: RNG) -> World:
    """The bottom of a stack slides away at frame m; what lay on it stays in the air."""
    scene, size, frame = Scene(rng), draw_size(rng, 0.1, 0.4), round(m)
    away = np.zeros(FRAMES)
    away[frame:] = 3.0 * np.arange(1, FRAMES - frame + 1)
    path = np.column_stack([away, 0 * away, np.full(FRAMES, size[2] / 2 + 1e-4)])
    scene.add("bottom", Box(size=tuple(size)), at=path[0], motion="dynamic", path=path)
    for k, name in enumerate(("thing", "top")):
        scene.add(name, Box(size=tuple(size)), at=(0, 0, (k + 1.5) * size[2] + (k + 2) * 1e-4), motion="dynamic")
    scene.on("floor", "bottom", frames=(0, frame - 1))
    scene.on("bottom", "thing")
    scene.on("thing", "top")
    return scene.world(folder, "thing", "top")


def _sunk(folder: Path, m: float, rng: RNG) -> World:
    scene, size = Scene(rng), draw_size(rng)
    scene.add("thing", block(rng, size), at=(0, 0, size[2] / 2 - min(m, 0.4 * size[2])), motion="dynamic")
    scene.on("floor", "thing")
    return scene.world(folder, "thing", still=True)


def _magnet(folder: Path, m: float, rng: RNG) -> World:
    """Stuck in a wall by an overlap that is declared intended; no joint holds it."""
    scene, size = Scene(rng), draw_size(rng, 0.1, 0.4)
    scene.add("wall", Box(size=(0.2, 3, 6)), at=(size[0] / 2 + 0.1 - m, 0, 0))
    scene.add(
        "thing",
        Box(size=tuple(size)),
        at=(0, 0, 1 + size[2] / 2),
        rotation=turn("x", float(rng.uniform(-3, 3))),
        motion="dynamic",
    )
    scene.relations["glue"] = Fastened(a="wall", b="thing", max_depth=1.5 * m, reason="held by a strong magnet")
    if rng.random() < 0.5:
        scene.on("wall", "thing")
    return scene.world(folder, "thing", still=True)


# ---------------------------------------------------------------- creep, tipping, slipping


def _creeping(folder: Path, m: float, rng: RNG) -> World:
    """Seen from what carries it, which may itself move; reached gradually or at one frame only."""
    scene, size = Scene(rng), draw_size(rng, 0.05, 0.3)
    if rng.random() < 0.5:
        share = np.linspace(0, 1, FRAMES)
    else:
        share = np.zeros(FRAMES)
        share[int(rng.integers(1, FRAMES))] = 1.0
    heading = rng.uniform(0, 2 * np.pi)
    creep = m * share[:, None] * np.array([np.cos(heading), np.sin(heading), 0.0])
    cart(scene, rng, size, creep)
    return scene.world(folder, "thing")


def _overhang(folder: Path, m: float, rng: RNG) -> World:
    """The centre of mass is m outside the edge, or outside a corner."""
    return edge(folder, rng, m, "thing")


def _heavy_pile(folder: Path, m: float, rng: RNG) -> World:
    return stair(folder, rng, m, "pile")


def _light_counterweight(folder: Path, m: float, rng: RNG) -> World:
    return seesaw(folder, rng, m, "plank", "weight")


def _too_steep(folder: Path, m: float, rng: RNG) -> World:
    return slope(folder, rng, float(np.arcsin(m)), "thing")


def _smooth_ladder(folder: Path, m: float, rng: RNG) -> World:
    return ladder(folder, rng, 1.0 - m, "ladder")


def _slips_through(folder: Path, m: float, rng: RNG) -> World:
    return wedged(folder, rng, m, "book")


def _one_bookend(folder: Path, m: float, rng: RNG) -> World:
    """Books between a wall and a bookend that floats: nothing presses them."""
    scene, thick, count = Scene(rng, friction=0.6), m, int(rng.integers(1, 4))
    names = [f"book{k}" for k in range(count)] + ["end"]
    scene.add("wall", Box(size=(0.2, 2, 4)), at=(-0.1, 0, 1))
    for k, name in enumerate(names):
        scene.add(name, Box(size=(thick, 0.2, 0.3)), at=((k + 0.5) * thick + (k + 1) * 1e-5, 0, 1), motion="dynamic")
        scene.on("wall" if k == 0 else names[k - 1], name)
    return scene.world(folder, *names, still=True)


# ---------------------------------------------------------------- joints and ropes


def _slack(folder: Path, m: float, rng: RNG) -> World:
    """Hangs on a rope that is m longer than the way to its hook."""
    scene, size, way = Scene(rng), draw_size(rng, 0.05, 0.2), float(rng.uniform(0.2, 1))
    scene.gallows()
    scene.add("thing", Box(size=tuple(size)), at=(0, 0, 3 - way - size[2] / 2), motion="dynamic")
    ends = {"parent_point": scene.point((0, 0, 3)), "child_point": scene.point((0, 0, 3 - way))}
    rope = SpringJoint(parent="beam", child="thing", stiffness=1e4, rest_length=way + m, rope=True, **ends)
    scene.more["joints"] = {"rope": rope}
    scene.on("beam", "thing") if rng.random() < 0.5 else None
    return scene.world(folder, "thing", still=True)


def _weak_lift(folder: Path, m: float, rng: RNG) -> World:
    """On an upright rail whose motor or brake lacks the share m of the weight."""
    scene = Scene(rng)
    weight = slide(scene, rng)
    rail = scene.more["joints"]["rail"]
    force = max(1e-3, (1 - m) * weight)
    if rng.random() < 0.5:
        scene.more["drivers"] = {"motor": MotorDriver(joint="rail", velocity=0.0, max_effort=force, end=10.0)}
    else:
        scene.more["joints"] = {"rail": rail.model_copy(update={"friction": force})}
    return scene.world(folder, "thing", still=True)


def _cut(folder: Path, m: float, rng: RNG) -> World:
    """Said to be held to the end; its joint is opened m frames before."""
    scene, size = Scene(rng), draw_size(rng, 0.1, 0.3)
    scene.gallows()
    scene.add("thing", Box(size=tuple(size)), at=(0, 0, 3 - size[2] / 2 - 1e-4), motion="dynamic")
    scene.more["joints"] = {"j": WeldJoint(parent="beam", child="thing", anchor=scene.point((0, 0, 3)))}
    scene.more["drivers"] = {"d": DetachDriver(joint="j", time=(FRAMES - 1 - round(m)) / 24 - 0.01)}
    scene.on("beam", "thing")
    scene.channels["digest"] = "cut"
    return scene.world(folder, "thing")


# ---------------------------------------------------------------- clean


def _resting(folder: Path, m: float, rng: RNG) -> World:
    scene, size = Scene(rng), draw_size(rng, 0.003, 1.0)
    shape = Sphere(radius=float(size[2]) / 2) if rng.random() < 0.3 else block(rng, size)
    scene.add("thing", shape, at=(0, 0, size[2] / 2 + m), motion="dynamic")
    scene.on("floor", "thing")
    return scene.world(folder, still=True)


def _riding(folder: Path, m: float, rng: RNG) -> World:
    """On a cart, lift, turntable or swing, creeping by m."""
    scene = Scene(rng)
    cart(scene, rng, draw_size(rng, 0.05, 0.3), m * np.linspace(0, 1, FRAMES)[:, None] * np.array([1.0, 0.0, 0.0]))
    return scene.world(folder)


def _barely_on(folder: Path, m: float, rng: RNG) -> World:
    return edge(folder, rng, -m)


def _leaning_pile(folder: Path, m: float, rng: RNG) -> World:
    return stair(folder, rng, -m)


def _counterweight(folder: Path, m: float, rng: RNG) -> World:
    return seesaw(folder, rng, -m)


def _gentle_slope(folder: Path, m: float, rng: RNG) -> World:
    return slope(folder, rng, -m)


def _rough_ladder(folder: Path, m: float, rng: RNG) -> World:
    return ladder(folder, rng, 1.0 + m)


def _held_book(folder: Path, m: float, rng: RNG) -> World:
    return wedged(folder, rng, -m)


def _between_walls(folder: Path, thick: float, gap: float, rng: RNG, *culprits: str) -> World:
    """Several books between two walls, none of them on anything, with a gap at each [m]."""
    scene, count = Scene(rng, friction=0.6), int(rng.integers(1, 5))
    scene.add("left", Box(size=(0.2, 2, 4)), at=(-0.1, 0, 1))
    names = ["left"]
    for k in range(count):
        names.append(f"book{k}")
        scene.add(names[-1], Box(size=(thick, 0.2, 0.3)), at=((k + 0.5) * thick + (k + 1) * gap, 0, 1), motion="dynamic")
        scene.on(names[-2], names[-1])
    scene.add("right", Box(size=(0.2, 2, 4)), at=(count * thick + (count + 1) * gap + 0.1, 0, 1))
    scene.on("right", names[-1])
    return scene.world(folder, *culprits, still=True)


def _row_of_books(folder: Path, m: float, rng: RNG) -> World:
    return _between_walls(folder, m, 1e-5, rng)


def _squeezed(folder: Path, m: float, rng: RNG) -> World:
    """Drawn m from the walls, within the skins: what presses them is not there."""
    return _between_walls(folder, float(rng.uniform(0.02, 0.1)), m, rng, "book0")


def _beside_a_column(folder: Path, m: float, rng: RNG, *culprits: str, lifted: bool = True) -> World:
    """A book between two walls, m from each, which a column on the floor touches from the side; or it stands on the floor itself."""
    scene, thick = Scene(rng, friction=0.6), float(rng.uniform(0.02, 0.1))
    height = 1.0 if lifted else 0.15 + 1e-4
    scene.add("left", Box(size=(0.2, 2, 4)), at=(-0.1 - m, 0, 2))
    scene.add("right", Box(size=(0.2, 2, 4)), at=(thick + 0.1 + m, 0, 2))
    scene.add("book", Box(size=(thick, 0.2, 0.3)), at=(thick / 2, 0, height), motion="dynamic")
    near = float(rng.uniform(1e-6, UNDER * GAP))
    column = Box(size=(0.8 * thick, 0.3, 1.5))
    scene.add("column", column, at=(thick / 2, 0.25 + near, 0.75 + 1e-4), motion="dynamic")
    return scene.world(folder, *culprits, still=True)


def _clamped_beside(folder: Path, m: float, rng: RNG) -> World:
    return _beside_a_column(folder, m, rng, "book")


def _stands_beside(folder: Path, m: float, rng: RNG) -> World:
    return _beside_a_column(folder, m, rng, lifted=False)


def _hanging(folder: Path, m: float, rng: RNG) -> World:
    """A lamp on a rope, spring, hinge or ball joint; it swings by m rad."""
    scene, radius, way, kind = Scene(rng), float(rng.uniform(0.05, 0.15)), float(rng.uniform(0.4, 1)), int(rng.integers(4))
    scene.gallows()
    angles = m * np.sin(np.linspace(0, 6, FRAMES)) if kind in (1, 2) else np.zeros(FRAMES)
    turns = np.array([turn("y", a) for a in angles])
    top = 2.997 if kind in (1, 2) else 3.0  # a pin with room to turn under the beam
    path = np.array([0, 0, top]) + turns @ np.array([0, 0, -way - radius])
    if kind == 3:
        path[:, 2] -= 0.05 * np.sin(np.linspace(0, 6, FRAMES)) ** 2
    lamp = [Part(shape=Sphere(radius=radius))]
    if kind in (1, 2):
        lamp.append(Part(shape=Capsule(radius=0.0025, length=way), pose=Pose(position=(0, 0, radius + way / 2))))
    scene.add("lamp", *lamp, at=path[0], motion="dynamic", path=path, turns=turns)
    hook, eye = scene.point((0, 0, top)), scene.point((0, 0, top - way))
    if kind == 0:
        line = Rope(points=[(0, 0, 0), (0, 0, -way)], radius=0.005, segments=4, attach_start="beam", attach_end="lamp")
        scene.add("rope", at=(0, 0, 3), motion="dynamic", rope=line)
        scene.on("rope", "lamp")
        return scene.world(folder)
    joint = {
        1: HingeJoint(parent="beam", child="lamp", anchor=hook, axis=scene.way((0, 1, 0))),
        2: BallJoint(parent="beam", child="lamp", anchor=hook),
        3: SpringJoint(parent="beam", child="lamp", parent_point=hook, child_point=eye, stiffness=100.0, rope=True),
    }[kind]
    scene.more["joints"] = {"hook": joint}
    scene.on("beam", "lamp")
    return scene.world(folder)


def _bridge(folder: Path, m: float, rng: RNG) -> World:
    """A beam on piers of heights that differ by less than the contact tolerance, each carrying part."""
    scene, count = Scene(rng), int(rng.integers(2, 5))
    for k in range(count):
        place = (k - (count - 1) / 2, 0, 0.5 - m * rng.uniform(0, 1) / 2)
        scene.add(f"pier{k}", Cylinder(radius=0.1, height=1.0), at=place)
        scene.on(f"pier{k}", "beam")
    scene.add("beam", Box(size=(count, 0.3, 0.1)), at=(0, 0, 1.05), motion="dynamic")
    return scene.world(folder, still=True)


def _leaves_in_time(folder: Path, m: float, rng: RNG) -> World:
    """Supported until a declared beat moves it, at frame m."""
    scene, size, frame = Scene(rng), draw_size(rng, 0.1, 0.3), round(m)
    path = np.tile([0.0, 0.0, size[2] / 2 + 1e-4], (FRAMES, 1))
    path[frame:, 0] += 1.0 * np.arange(1, FRAMES - frame + 1)
    scene.add("thing", Box(size=tuple(size)), at=path[0], motion="dynamic", path=path)
    scene.on("floor", "thing")
    beat = Beat(
        text="it goes",
        owner="rigid",
        subject="thing",
        frames=(frame, FRAMES - 1),
        predicate=Displacement(entity="thing", min=0.5),
    )
    scene.more["beats"] = {"go": beat}
    return scene.world(folder)


def _in_a_hollow(folder: Path, m: float, rng: RNG) -> World:
    """A drawer in a slot, a ball in a groove, a hook over an edge: m is the play."""
    scene, kind = Scene(rng), int(rng.integers(3))
    if kind == 0:
        tray = [
            (-0.5, 0),
            (0.5, 0),
            (0.5, 0.2 + m),
            (0.45, 0.2 + m),
            (0.45, 0.05),
            (-0.45, 0.05),
            (-0.45, 0.2 + m),
            (-0.5, 0.2 + m),
        ]
        scene.add("rest", Extrusion(polygon=tray, height=0.5), at=(0, 0, 0.5), rotation=turn("x", np.pi / 2))
        scene.post(0.0, 0.0, 0.5)
        scene.add("thing", Box(size=(0.9 - 2 * m, 0.3, 0.1)), at=(0, 0, 0.6 + 1e-5), motion="dynamic")
    elif kind == 1:
        groove = [(-0.5, 0), (0.5, 0), (0.5, 0.5), (0, 0.1), (-0.5, 0.5)]
        scene.add("rest", Extrusion(polygon=groove, height=0.5), at=(0, 0, 0.0), rotation=turn("x", np.pi / 2))
        slope = np.arctan2(0.4, 0.5)
        scene.add("thing", Sphere(radius=0.1), at=(0, 0, 0.1 + (0.1 + min(m, 0.9 * GAP)) / np.cos(slope)), motion="dynamic")
    else:
        # A beam stuck in a wall: pressed up at the slot's mouth and down at its end.
        for name, z in (("rest", 0.9), ("lid", 1.1 + m)):
            scene.add(name, Box(size=(0.6, 0.6, 0.1)), at=(-0.3, 0, z))
        scene.post(-0.55, 0.25, 1.1, founded=True)
        scene.add("thing", Box(size=(1.5, 0.1, 0.1)), at=(0.25, 0, 1.0), motion="dynamic")
    scene.on("rest", "thing")
    return scene.world(folder, still=True)


def _strong_lift(folder: Path, m: float, rng: RNG) -> World:
    """On an upright rail with a motor, a brake or a stop that holds it with m times its weight."""
    scene, kind = Scene(rng), int(rng.integers(3))
    weight = slide(scene, rng)
    rail = scene.more["joints"]["rail"]
    if kind == 0:
        scene.more["drivers"] = {"motor": MotorDriver(joint="rail", velocity=0.1, max_effort=m * weight, end=10.0)}
    elif kind == 1:
        scene.more["joints"] = {"rail": rail.model_copy(update={"friction": m * weight})}
    else:
        scene.more["joints"] = {"rail": rail.model_copy(update={"range": (0.0, 0.0)})}
    return scene.world(folder, still=True)


def _dim(folder: Path, m: float, rng: RNG) -> World:
    """A wedge on its broad side at a distance m from the origin, beside a wall that it touches."""
    scene = Scene(rng)
    scene.moved = m * np.array([1.0, -1.0, 1.0])
    size = draw_size(rng, 0.1, 0.4)
    scene.add("thing", Wedge(size=tuple(size)), at=(0, 0, size[2] / 2 + 1e-4), motion="dynamic")
    scene.add("wall", Box(size=(0.1, 2, 2)), at=(-size[0] / 2 - 0.05 - 1e-4, 0, 1.0))
    scene.on("floor", "thing")
    return scene.world(folder, still=True)


SUITE = Suite(
    "support",
    (
        Mechanism("afloat", "floats above the floor", True, _afloat, OVER * GAP, 1.0, "m", GAP),
        Mechanism("lifted", "leaves its support at one frame", True, _lifted, OVER * GAP, 0.1, "m", GAP),
        Mechanism("late-start", "its relation begins after it floated", True, _late_start, OVER * GAP, 0.2, "m", GAP),
        Mechanism("speck", "a tiny body floats over a huge one", True, _speck, OVER * GAP, 0.05, "m", GAP),
        Mechanism("floating-pair", "two bodies carry each other", True, _floating_pair, 0.01, 2.0, "m"),
        Mechanism("side-only", "touches by a side or from beneath", True, _side_only, 0.05, 1.0, "m"),
        Mechanism("pulled-out", "the bottom of its stack goes", True, _pulled_out, 1, FRAMES - 1, "frame"),
        Mechanism("sunk", "stands in its support", True, _sunk, 1e-5, 0.05, "m"),
        Mechanism("magnet", "held by a declared overlap only", True, _magnet, 1e-3, 0.03, "m"),
        Mechanism("creeping", "creeps on its support", True, _creeping, OVER * DRIFT, 0.3, "m", DRIFT),
        Mechanism("overhang", "its centre of mass is over the edge", True, _overhang, OVER * OUTSIDE, 0.08, "m", OUTSIDE),
        Mechanism("heavy-pile", "a pile tips as a whole", True, _heavy_pile, OVER * OUTSIDE, 0.02, "m", OUTSIDE),
        Mechanism(
            "light-counterweight",
            "a plank outweighs what holds it",
            True,
            _light_counterweight,
            OVER * OUTSIDE,
            0.02,
            "m",
            OUTSIDE,
        ),
        Mechanism("too-steep", "a slope steeper than friction holds", True, _too_steep, OVER * MISSING, 0.4, "weight", MISSING),
        # On a steep ladder 10 % less friction lacks less than the documented 1 % of the weight.
        Mechanism("smooth-ladder", "a ladder on too little friction", True, _smooth_ladder, 0.25, 0.9, "of the needed friction"),
        Mechanism("slips-through", "walls that open downwards", True, _slips_through, 0.02, 0.4, "rad"),
        Mechanism(
            "squeezed", "between walls from which it is drawn apart", True, _squeezed, OVER * FITTED, UNDER * GAP, "m", FITTED
        ),
        Mechanism(
            "clamped-beside",
            "the same, and what stands on the floor touches it",
            True,
            _clamped_beside,
            OVER * FITTED,
            UNDER * GAP,
            "m",
            FITTED,
        ),
        Mechanism("one-bookend", "pressed by something that floats", True, _one_bookend, 0.02, 0.1, "m"),
        Mechanism("slack", "hangs on a slack rope", True, _slack, OVER * GAP, 0.5, "m", GAP),
        Mechanism("weak-lift", "slides down its rail", True, _weak_lift, 0.02, 1.0, "weight"),
        Mechanism("cut", "its joint opens too soon", True, _cut, 1, FRAMES - 2, "frames"),
        Mechanism("resting", "a gap within the tolerance", False, _resting, 1e-7, UNDER * GAP, "m"),
        Mechanism("riding", "moves with what carries it", False, _riding, 1e-6, UNDER * DRIFT, "m"),
        Mechanism("barely-on", "its centre of mass is just above the edge", False, _barely_on, 1e-4, 0.05, "m"),
        Mechanism("leaning-pile", "a pile that just stands", False, _leaning_pile, 1e-4, 0.02, "m"),
        Mechanism("counterweight", "a plank far over the edge", False, _counterweight, 1e-4, 0.02, "m"),
        Mechanism("gentle-slope", "just within the friction angle", False, _gentle_slope, 1e-3, 0.15, "rad"),
        Mechanism(
            "rough-ladder", "a ladder within friction, wall declared", False, _rough_ladder, 1e-3, 0.5, "of the needed friction"
        ),
        Mechanism("held-book", "wedged by friction alone", False, _held_book, 1e-3, 0.2, "rad"),
        Mechanism("row-of-books", "pressed between walls", False, _row_of_books, 0.01, 0.1, "m"),
        Mechanism(
            "stands-beside", "stands between walls beside a column", False, _stands_beside, OVER * FITTED, UNDER * GAP, "m"
        ),
        Mechanism("hanging", "a lamp that swings", False, _hanging, 0.01, 1.0, "rad"),
        Mechanism("bridge", "several piers carry part", False, _bridge, 1e-5, UNDER * GAP, "m"),
        Mechanism("leaves-in-time", "leaves when its beat begins", False, _leaves_in_time, 1, FRAMES - 1, "frame"),
        Mechanism("in-a-hollow", "held by concave things", False, _in_a_hollow, 1e-4, 5e-4, "m"),
        Mechanism("strong-lift", "an upright rail that holds", False, _strong_lift, 1.001, 10.0, "weight"),
        Mechanism("far-away", "beside a wall, far from the origin", False, _dim, 1.0, 1e5, "m"),
        *LAND_MECHANISMS,
        *HELD_MECHANISMS,
        *HUNG_MECHANISMS,
        *BONDED_MECHANISMS,
        *LUMP_MECHANISMS,
        *LOOSE_MECHANISMS,
    ),
)

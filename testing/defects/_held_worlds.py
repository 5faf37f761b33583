"""Seeded defects of what holds things: static things in the air, joints over gaps, bodies that fall and nobody said so."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.predicates import Displacement
from ...worlds.spec import (
    BallJoint,
    Beat,
    Box,
    Fastened,
    FieldDriver,
    ForceDriver,
    HingeJoint,
    Limits,
    Part,
    Pose,
    ReleaseDriver,
    RigidPhysics,
    RigidSettings,
    Rope,
    SlideJoint,
    Sphere,
    SpringJoint,
    WeldJoint,
)
from ._support_worlds import FRAMES, RNG, Scene, turn
from .cases import Mechanism, World

__all__ = ["HELD_MECHANISMS"]

GAP, DRIFT = Limits().contact_gap, Limits().support_drift
REACH = GAP + RigidSettings().skin
"""Largest distance of an anchor from a surface [m]."""
SEAM, NARROW = 2e-3, 8e-4
"""Gap over which no two static things touch, and over which those of this suite do, 8 cm in diagonal and more [m]."""
OUTSIDE = 0.002
"""Largest distance by which a centre of mass may seem to lie beside what carries it [m]."""
OVER, UNDER = 1.05, 0.95
FPS = 24


def _size(rng: RNG) -> tuple[float, float, float]:
    x, y, z = np.exp(rng.uniform(np.log(0.05), np.log(0.5), 3)).tolist()
    return x, y, z


# ---------------------------------------------------------------- static things


def _static_in_the_air(folder: Path, m: float, rng: RNG) -> World:
    """Above the floor, beside a wall, or a stack of both; m from what is nearest."""
    scene, (x, y, z), kind = Scene(rng), _size(rng), int(rng.integers(3))
    height = m if kind != 1 else float(rng.uniform(1.5, 2.0)) + m
    scene.add("thing", Box(size=(x, y, z)), at=(0, 0, height + z / 2))
    if kind == 1:
        scene.add("wall", Box(size=(0.2, 3, 6)), at=(x / 2 + m + 0.1, 0, 3))
    if kind == 2:
        scene.add("vase", Box(size=(0.5 * x, 0.5 * y, 0.1)), at=(0, 0, height + z + 0.05 + 1e-4))
    return scene.world(folder, "thing", still=True)


def _on_a_drawn_post(folder: Path, m: float, rng: RNG, *, solid: bool = False) -> World:
    """A block m [m] above the floor on a post of its own, of which collisions know or not, with a drawn label on it."""
    scene, (x, y, z) = Scene(rng), _size(rng)
    parts = [
        Part(shape=Box(size=(x, y, z)), pose=Pose(position=(0, 0, m + z / 2))),
        Part(shape=Box(size=(0.2 * x, 0.2 * y, m)), pose=Pose(position=(0, 0, m / 2)), collides=solid),
        Part(shape=Box(size=(0.5 * x, 0.002, 0.5 * z)), pose=Pose(position=(0, y / 2 + 0.001, m + z / 2)), collides=False),
    ]
    scene.add("thing", *parts, at=(0, 0, 0))
    return scene.world(folder, *(() if solid else ("thing",)), still=True)


def _loose_part(folder: Path, m: float, rng: RNG) -> World:
    """One of its parts is m away from the others, over the floor."""
    scene, (x, y, z) = Scene(rng), _size(rng)
    parts = [
        Part(shape=Box(size=(x, y, z)), pose=Pose(position=(0, 0, z / 2))),
        Part(shape=Box(size=(x, y, z)), pose=Pose(position=(0, 0, 1.5 * z + m))),
    ]
    order = rng.permutation(2)
    scene.add("thing", *(parts[i] for i in order), at=(0, 0, 0))
    return scene.world(folder, "thing", still=True)


def _static_on_free(folder: Path, m: float, rng: RNG) -> World:
    """A static shelf on boxes that may move, m high."""
    scene = Scene(rng)
    for k, x in enumerate((-0.3, 0.3)):
        scene.add(f"leg{k}", Box(size=(0.1, 0.1, m)), at=(x, 0, m / 2 + 1e-4), motion="dynamic")
        scene.on("floor", f"leg{k}")
    scene.add("thing", Box(size=(0.8, 0.2, 0.05)), at=(0, 0, m + 0.025 + 2e-4))
    return scene.world(folder, "thing", still=True)


def _on_its_wall(folder: Path, m: float, rng: RNG) -> World:
    """A picture on a wall, a beam between posts, a lamp under a ceiling: held from the side or from above, within m."""
    scene, (x, y, z), kind = Scene(rng), _size(rng), int(rng.integers(3))
    if kind == 0:
        scene.add("wall", Box(size=(0.2, 3, 4)), at=(0, 0, 2))
        scene.add("thing", Box(size=(0.04, y, z)), at=(0.12 + m, 0, 1.5))
        scene.on("wall", "thing")
    elif kind == 1:
        for k, sign in enumerate((-1, 1)):
            scene.add(f"pillar{k}", Box(size=(0.2, 0.2, 2)), at=(sign * (x / 2 + 0.1 + m), 0, 1))
        scene.add("thing", Box(size=(x, 0.1, 0.1)), at=(0, 0, 1.5))
    else:
        scene.gallows()
        scene.add("thing", Sphere(radius=0.1), at=(0, 0, 2.9 - m))
        scene.on("beam", "thing")
    return scene.world(folder, still=True)


def _row_of_beads(folder: Path, m: float, rng: RNG, count: int, *culprits: str) -> World:
    """Static beads beside a pole that is set into the floor, m from it and from each other."""
    scene, size = Scene(rng), float(rng.uniform(0.1, 0.2))
    scene.add("pole", Box(size=(0.1, 0.1, 2)), at=(0, 0, 1))
    scene.found("pole")
    for k in range(count):
        scene.add(f"bead{k}", Box(size=(size, size, size)), at=(0.05 + (k + 0.5) * size + (k + 1) * m, 0, 1.5))
    return scene.world(folder, *culprits, still=True)


def _beads(folder: Path, m: float, rng: RNG) -> World:
    """As many as use up the contact tolerance, and one or two more."""
    enough = int(np.ceil(GAP / m))
    return _row_of_beads(folder, m, rng, enough + int(rng.integers(1, 3)), f"bead{enough}")


def _short_row(folder: Path, m: float, rng: RNG) -> World:
    return _row_of_beads(folder, m, rng, 2)


def _said_to_float(folder: Path, m: float, rng: RNG) -> World:
    scene = Scene(rng)
    reason = "a glowing orb that the tale lets hover by magic"
    scene.add("thing", Sphere(radius=0.2), at=(0, 0, 0.2 + m), afloat=reason)
    return scene.world(folder, still=True)


def _on_a_post(folder: Path, beyond: float, rng: RNG, *culprits: str) -> World:
    """A static slab on a post, its centre `beyond` the post's edge [m]; sometimes with another one on it."""
    scene, half = Scene(rng), float(rng.uniform(0.05, 0.2))
    length = float(rng.uniform(2.2, 4.0)) * (half + abs(beyond))
    scene.add("pillar", Box(size=(2 * half, 2 * half, 1)), at=(0, 0, 0.5))
    scene.add("slab", Box(size=(length, 2 * half, 0.1)), at=(half + beyond, 0, 1.05))
    if rng.random() < 0.4:
        scene.add("top", Box(size=(length, half, 0.1)), at=(half + beyond, 0, 1.15))
    return scene.world(folder, *culprits, still=True)


def _beside_its_post(folder: Path, m: float, rng: RNG) -> World:
    return _on_a_post(folder, m, rng, "slab", "top")


def _over_its_post(folder: Path, m: float, rng: RNG) -> World:
    return _on_a_post(folder, -m, rng)


# ---------------------------------------------------------------- joints, ropes, fastened things


def _joined(folder: Path, m: float, rng: RNG, *culprits: str) -> World:
    """Something under a beam, joined over a gap of m by each kind of joint."""
    scene, kind, radius = Scene(rng), int(rng.integers(4)), 0.1
    scene.gallows()
    scene.add("thing", Sphere(radius=radius), at=(0, 0, 3 - m - radius), motion="dynamic")
    anchor, low = scene.point((0, 0, 3)), scene.point((0, 0, 3 - 2 * radius - 1.5 * m))
    made = {
        0: WeldJoint(parent="beam", child="thing", anchor=anchor),
        1: BallJoint(parent="beam", child="thing", anchor=anchor),
        2: HingeJoint(parent="beam", child="thing", anchor=anchor, axis=scene.way((0, 1, 0))),
        # The sphere is m under the beam; its lower end has to be reached, not the air beneath it.
        3: SpringJoint(parent="beam", child="thing", parent_point=anchor, child_point=low, stiffness=1e4, rest_length=0.0),
    }[kind]
    if kind == 3:
        scene.entities["thing"] = (scene.entities["thing"][0], np.array([0, 0, 3 - radius - 0.5 * m]), np.eye(3))
    scene.more["joints"] = {"link": made}
    return scene.world(folder, *culprits, still=True)


def _joint_over_a_gap(folder: Path, m: float, rng: RNG) -> World:
    return _joined(folder, m, rng, "thing")


def _joint_that_reaches(folder: Path, m: float, rng: RNG) -> World:
    return _joined(folder, m, rng)


def _at_a_point(folder: Path, m: float, rng: RNG, *culprits: str, afloat: str | None = None) -> World:
    """Something held at a point of space, m under a beam, by each kind of joint and by a rope."""
    scene, kind, top = Scene(rng), int(rng.integers(6)), 3 - m
    scene.gallows()
    if kind == 5:
        line = Rope(points=[(0, 0, 0), (0, 0, -0.5)], radius=0.005, segments=4, attach_start="world")
        scene.add("thing", at=(0, 0, top - 0.005), motion="dynamic", rope=line, afloat=afloat)
        return scene.world(folder, *culprits, still=True)
    scene.add("thing", Sphere(radius=0.1), at=(0, 0, top - 0.1), motion="dynamic", afloat=afloat)
    anchor = scene.point((0, 0, top))
    made = {
        0: WeldJoint(child="thing", anchor=anchor),
        1: BallJoint(child="thing", anchor=anchor),
        2: HingeJoint(child="thing", anchor=anchor, axis=scene.way((0, 1, 0))),
        3: SlideJoint(child="thing", anchor=anchor, axis=scene.way((1, 0, 0))),
        4: SpringJoint(child="thing", parent_point=anchor, child_point=scene.point((0, 0, top - 0.2)), stiffness=1e4),
    }[kind]
    scene.more["joints"] = {"link": made}
    return scene.world(folder, *culprits, still=True)


def _held_by_a_point(folder: Path, m: float, rng: RNG) -> World:
    return _at_a_point(folder, m, rng, "thing")


def _point_on_a_beam(folder: Path, m: float, rng: RNG) -> World:
    return _at_a_point(folder, m, rng)


def _point_that_is_told(folder: Path, m: float, rng: RNG) -> World:
    return _at_a_point(folder, m, rng, afloat="a lamp that a spell keeps where it is")


def _on_an_axis(folder: Path, m: float, rng: RNG, *culprits: str) -> World:
    """A lump m above a post, on an upright hinge to the world whose anchor lies in the post."""
    scene, high = Scene(rng), float(rng.uniform(0.2, 0.6))
    scene.add("post", Box(size=(0.06, 0.06, high)), at=(0, 0, high / 2))
    scene.add("thing", Box(size=(0.1, 0.1, 0.1)), at=(0, 0, high + 0.05 + m), motion="dynamic")
    anchor = scene.point((0, 0, float(rng.uniform(0.2, 0.8)) * high))
    scene.more["joints"] = {"link": HingeJoint(child="thing", anchor=anchor, axis=scene.way((0, 0, 1)))}
    return scene.world(folder, *culprits, still=True)


def _over_its_axis(folder: Path, m: float, rng: RNG) -> World:
    return _on_an_axis(folder, m, rng, "thing")


def _turns_on_its_post(folder: Path, m: float, rng: RNG) -> World:
    return _on_an_axis(folder, m, rng)


def _roped(folder: Path, m: float, rng: RNG, *culprits: str) -> World:
    """A lamp on a rope whose upper end stops m (and its radius) short of the beam."""
    scene, way = Scene(rng), float(rng.uniform(0.3, 1.0))
    scene.gallows()
    top = 3 - m - 0.005
    line = Rope(points=[(0, 0, 0), (0, 0, -way)], radius=0.005, segments=4, attach_start="beam", attach_end="lamp")
    scene.add("rope", at=(0, 0, top), motion="dynamic", rope=line)
    scene.add("lamp", Sphere(radius=0.1), at=(0, 0, top - way - 0.1), motion="dynamic")
    return scene.world(folder, *culprits, still=True)


def _short_rope(folder: Path, m: float, rng: RNG) -> World:
    return _roped(folder, m, rng, "rope")


def _rope_that_reaches(folder: Path, m: float, rng: RNG) -> World:
    return _roped(folder, m, rng)


def _fastened(folder: Path, m: float, rng: RNG, *culprits: str) -> World:
    scene, (x, y, z) = Scene(rng), _size(rng)
    scene.add("thing", Box(size=(x, y, z)), at=(0, 0, z / 2 + 1e-4), motion="dynamic")
    scene.add("plate", Box(size=(0.05, y, z)), at=(x / 2 + 0.025 + m, 0, z / 2 + 1e-4), motion="dynamic")
    scene.relations["glue"] = Fastened(a="thing", b="plate", max_depth=1e-3, reason="the plate is glued to it")
    return scene.world(folder, *culprits, still=True)


def _fastened_apart(folder: Path, m: float, rng: RNG) -> World:
    return _fastened(folder, m, rng, "thing", "plate")


def _fastened_close(folder: Path, m: float, rng: RNG) -> World:
    return _fastened(folder, m, rng)


# ---------------------------------------------------------------- free bodies that nothing covers


def _pair(scene: Scene, shift: np.ndarray) -> None:
    """Two boxes, one on the other, of which the upper one moves aside by `shift` [m], shape (frames,)."""
    size = 0.2
    scene.add("lower", Box(size=(size,) * 3), at=(0, 0, size / 2 + 1e-4), motion="dynamic")
    path = np.tile([0.0, 0.0, 1.5 * size + 2e-4], (FRAMES, 1))
    path[:, 0] += shift
    scene.add("thing", Box(size=(size,) * 3), at=path[0], motion="dynamic", path=path)


def _leaves_untold(folder: Path, m: float, rng: RNG) -> World:
    """The top of a stack that nothing declares slides off, at once or slowly."""
    scene, begin = Scene(rng), int(rng.integers(1, FRAMES))
    _pair(scene, m * (np.arange(FRAMES) >= begin))
    return scene.world(folder, "thing")


def _leaves_too_early(folder: Path, m: float, rng: RNG) -> World:
    """It slides off by itself; what was thrown hits it, but only m frames later."""
    scene, begin = Scene(rng), 2
    _pair(scene, 0.02 * np.maximum(0, np.arange(FRAMES) - begin))
    _thrown(scene, begin + 1 + round(m))
    return scene.world(folder, "thing")


def _settles(folder: Path, m: float, rng: RNG) -> World:
    scene = Scene(rng)
    _pair(scene, np.linspace(0.0, m, FRAMES))
    return scene.world(folder)


def _thrown(scene: Scene, hits: int) -> None:
    """A thrown ball that meets the upper box of `_pair` at a frame and rests there."""
    x = np.minimum(0.0, np.arange(FRAMES) - hits) * 0.05 - 0.1 - 0.05 - 1e-4
    upper = scene.paths["thing"][0][:, 0]
    path = np.column_stack([np.where(np.arange(FRAMES) < hits, np.minimum(x, x[0] + 9), upper - 0.1501), 0 * x, 0 * x + 0.3])
    physics = RigidPhysics(linear_velocity=scene.way((0.05 * FPS, 0, 0)))
    scene.add("ball", Sphere(radius=0.05), at=path[0], motion="dynamic", path=path, physics=physics)
    flies = Displacement(entity="ball", min=0.01)
    scene.more["beats"] = {"flies": Beat(text="it flies", owner="rigid", subject="ball", frames=(0, hits), predicate=flies)}


def _struck(folder: Path, m: float, rng: RNG) -> World:
    """A thrown ball meets it at frame m, and it slides off."""
    scene, hits = Scene(rng), round(m)
    _pair(scene, 0.02 * np.maximum(0, np.arange(FRAMES) - hits))
    _thrown(scene, hits)
    return scene.world(folder)


def _with_its_post(folder: Path, m: float, rng: RNG) -> World:
    """A lamp welded to a free post that a beat tips at frame m: its support ends when the post goes."""
    scene, begin = Scene(rng), round(m)
    angle = 0.1 * np.maximum(0, np.arange(FRAMES) - begin + 1)
    turns = np.array([turn("y", a) for a in angle])
    # The post turns about the lower edge of its foot, the lamp with it.
    pivot = np.array([0.05, 0.0, 0.0])
    post, lamp = (pivot + turns @ (np.array(p) - pivot) for p in ((0, 0, 0.5 + 1e-4), (0.1501, 0, 0.9)))
    scene.add("mast", Box(size=(0.1, 0.1, 1.0)), at=post[0], motion="dynamic", path=post, turns=turns)
    scene.add("lamp", Box(size=(0.2, 0.1, 0.1)), at=lamp[0], motion="dynamic", path=lamp, turns=turns)
    scene.more["joints"] = {"arm": WeldJoint(parent="mast", child="lamp", anchor=scene.point((0.05, 0, 0.9)))}
    scene.on("floor", "mast")
    scene.on("mast", "lamp")
    fall = Displacement(entity="mast", min=0.05)
    scene.more["beats"] = {
        "tips": Beat(text="the mast tips", owner="rigid", subject="mast", frames=(begin, FRAMES - 1), predicate=fall)
    }
    return scene.world(folder)


def _let_go(scene: Scene, m: float) -> None:
    """A ball in the air that a driver lets go after m of the film, or that is thrown at once."""
    frames, height = np.arange(FRAMES), float(scene.rng.uniform(0.3, 2.0))
    begin = round(m * (FRAMES - 1))
    path = np.tile([0.0, 0.0, height], (FRAMES, 1))
    path[:, 2] -= np.minimum(0.5 * 9.81 * (np.maximum(0, frames - begin) / FPS) ** 2, height - 0.1)
    physics = RigidPhysics(linear_velocity=scene.way((0.3, 0, 0)))
    thrown = begin == 0
    scene.add("thing", Sphere(radius=0.1), at=path[0], motion="dynamic", path=path, physics=physics if thrown else RigidPhysics())
    if not thrown:
        scene.more["drivers"] = {"hold": ReleaseDriver(entity="thing", time=begin / FPS)}


def _let_go_untold(folder: Path, m: float, rng: RNG) -> World:
    scene = Scene(rng)
    _let_go(scene, m)
    return scene.world(folder, "thing", still=True)


def _carried_untold(folder: Path, m: float, rng: RNG) -> World:
    """A force or a field of no beat carries a ball that is in the air."""
    scene = Scene(rng)
    scene.add("thing", Sphere(radius=0.1), at=(0, 0, 0.1 + m), motion="dynamic")
    mass = 600.0 * 4 / 3 * np.pi * 0.1**3
    carry: Any = ForceDriver(entity="thing", force=(0, 0, 9.81 * mass), start=0.0, end=100.0)
    if rng.random() < 0.5:
        high = scene.point((0, 0, 1000.0))
        field = {"kind": "attraction", "center": high, "acceleration": 9.81, "distance": 1.0, "exponent": 0.0}
        carry = FieldDriver.model_validate({"field": field, "entities": ["thing"]})
    scene.more["drivers"] = {"carry": carry}
    return scene.world(folder, "thing", still=True)


def _let_go_in_a_beat(folder: Path, m: float, rng: RNG) -> World:
    scene = Scene(rng)
    _let_go(scene, m)
    falls = Displacement(entity="thing", min=0.01)
    scene.more["beats"] = {
        "falls": Beat(text="it falls", owner="rigid", subject="thing", frames=(1, FRAMES - 1), predicate=falls)
    }
    return scene.world(folder, still=True)


def _plates(folder: Path, m: float, rng: RNG, *culprits: str) -> World:
    """Two plates of one free body, m from each other."""
    scene, (x, y, z) = Scene(rng), _size(rng)
    order = rng.permutation(2)
    parts = [
        Part(shape=Box(size=(x, y, z)), pose=Pose(position=(0, 0, z / 2))),
        Part(shape=Box(size=(x, y, z)), pose=Pose(position=(0, 0, 1.5 * z + m))),
    ]
    scene.add("thing", *(parts[i] for i in order), at=(0, 0, 1e-4), motion="dynamic")
    scene.on("floor", "thing")
    return scene.world(folder, *culprits, still=True)


def _plates_apart(folder: Path, m: float, rng: RNG) -> World:
    return _plates(folder, m, rng, "thing")


def _plates_together(folder: Path, m: float, rng: RNG) -> World:
    return _plates(folder, m, rng)


HELD_MECHANISMS = (
    Mechanism("static-in-the-air", "static, and nothing touches it", True, _static_in_the_air, OVER * SEAM, 1.0, "m", SEAM),
    Mechanism("loose-part", "a part that touches no other", True, _loose_part, OVER * SEAM, 0.5, "m", SEAM),
    Mechanism("on-a-drawn-post", "static, on a post that is drawn only", True, _on_a_drawn_post, OVER * SEAM, 1.0, "m", SEAM),
    Mechanism("static-on-free", "static, on bodies that may move", True, _static_on_free, 0.05, 1.0, "m"),
    Mechanism("beside-its-post", "static, its centre beside its post", True, _beside_its_post, OVER * OUTSIDE, 1.0, "m", OUTSIDE),
    Mechanism("beads", "a row of static things with a little air at each", True, _beads, 0.5 * NARROW, UNDER * NARROW, "m"),
    Mechanism("joint-over-a-gap", "no surface at its joint", True, _joint_over_a_gap, OVER * REACH, 0.5, "m", REACH),
    Mechanism("held-by-a-point", "joined to the air", True, _held_by_a_point, OVER * REACH, 1.0, "m", REACH),
    Mechanism(
        "over-its-axis",
        "its hinge to the world is anchored in a post that it does not reach",
        True,
        _over_its_axis,
        2 * OVER * REACH,
        1.0,
        "m",
        2 * REACH,
    ),
    Mechanism("short-rope", "it ends before its hook", True, _short_rope, OVER * REACH, 0.5, "m", REACH),
    Mechanism("fastened-apart", "glued over a gap", True, _fastened_apart, OVER * GAP, 0.5, "m", GAP),
    Mechanism("leaves-untold", "slides off, and nothing says so", True, _leaves_untold, OVER * DRIFT, 0.09, "m", DRIFT),
    Mechanism("leaves-too-early", "gone before it is hit", True, _leaves_too_early, 2, FRAMES - 5, "frames"),
    Mechanism("let-go-untold", "hangs on a driver that no beat tells of", True, _let_go_untold, 0.02, 1.0, "film"),
    Mechanism("carried-untold", "a force that no beat tells of carries it", True, _carried_untold, OVER * GAP, 1.0, "m", GAP),
    Mechanism("plates-apart", "parts of a free body with nothing between", True, _plates_apart, OVER * GAP, 0.5, "m", GAP),
    Mechanism(
        "on-its-own-post",
        "the same on a post that bears, with a drawn label",
        False,
        partial(_on_a_drawn_post, solid=True),
        0.02,
        1.0,
        "m",
    ),
    Mechanism("on-its-wall", "held from the side or above", False, _on_its_wall, 1e-6, UNDER * NARROW, "m"),
    Mechanism("over-its-post", "static, its centre just over its post", False, _over_its_post, 1e-4, 0.04, "m"),
    Mechanism("short-row", "two static things, a little air at each", False, _short_row, 1e-6, UNDER * NARROW, "m"),
    Mechanism("said-to-float", "it says why it hovers", False, _said_to_float, 0.01, 5.0, "m"),
    Mechanism("point-on-a-beam", "joined to the world where a beam is", False, _point_on_a_beam, 1e-6, UNDER * GAP, "m"),
    Mechanism("point-that-is-told", "joined to the air, and says so", False, _point_that_is_told, 0.01, 1.0, "m"),
    Mechanism(
        "turns-on-its-post",
        "its hinge to the world is anchored in the post it stands on",
        False,
        _turns_on_its_post,
        1e-6,
        UNDER * GAP,
        "m",
    ),
    Mechanism("joint-that-reaches", "at its joint within the skins", False, _joint_that_reaches, 1e-6, UNDER * GAP, "m"),
    Mechanism("rope-that-reaches", "ends at its hook", False, _rope_that_reaches, 1e-6, UNDER * GAP, "m"),
    Mechanism("fastened-close", "glued within the tolerance", False, _fastened_close, 1e-6, UNDER * GAP, "m"),
    Mechanism("let-go-in-a-beat", "a beat tells that it is let go", False, _let_go_in_a_beat, 0.02, 1.0, "film"),
    Mechanism("plates-together", "parts of a free body that touch", False, _plates_together, 1e-6, UNDER * GAP, "m"),
    Mechanism("settles", "settles a little, untold", False, _settles, 1e-5, UNDER * DRIFT, "m"),
    Mechanism("struck", "slides off once it is hit", False, _struck, 3, FRAMES - 2, "frame"),
    Mechanism("with-its-post", "falls with what it hangs on", False, _with_its_post, 2, FRAMES - 2, "frame"),
)
"""Mechanisms of the suite `support` about what holds static things, joints and bodies that no relation covers."""

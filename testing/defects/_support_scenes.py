"""Scenes of the suite of support that are sound on one side of a bound and broken on the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...worlds.spec import Box, Extrusion, Limits, SlideJoint
from ..worlds.small_worlds import mesh_of
from ._support_worlds import FRAMES, RNG, Scene, block, inside_out, turn
from .cases import World

__all__ = [
    "DRIFT",
    "GAP",
    "cart",
    "corners",
    "draw_size",
    "edge",
    "ladder",
    "seesaw",
    "slide",
    "slope",
    "stair",
    "table",
    "wedged",
]

GAP, DRIFT = Limits().contact_gap, Limits().support_drift
DENSITY, GRAVITY = 600.0, 9.81


def draw_size(rng: RNG, low: float = 0.05, high: float = 1.0) -> np.ndarray:
    return np.exp(rng.uniform(np.log(low), np.log(high), 3))


def table(scene: Scene, rng: RNG, half: tuple[float, float], top: float) -> None:
    """A static table with its top at a height; sometimes an import that is inside out."""
    shape = Box(size=(2 * half[0], 2 * half[1], top))
    scene.add("table", inside_out(shape) if rng.random() < 0.3 else shape, at=(0, 0, top / 2))


def cart(scene: Scene, rng: RNG, size: np.ndarray, creep: np.ndarray) -> None:
    """A slab that stands, drives, rises, turns or swings, and the thing on it."""
    kind, time = int(rng.integers(5)), np.linspace(0, 1, FRAMES)
    speed = float(rng.uniform(0.2, 4))
    path, turns = np.tile([0.0, 0.0, 1.0], (FRAMES, 1)), np.tile(np.eye(3), (FRAMES, 1, 1))
    if kind == 1:
        path[:, 0] += speed * time
    elif kind == 2:
        path[:, 2] += speed * (1 - np.cos(3 * time)) / 2
    elif kind == 3:
        turns = np.array([turn("z", speed * t) for t in time])
    elif kind == 4:
        angles = 0.4 * np.sin(2 * np.pi * time)
        turns = np.array([turn("y", a) for a in angles])
        path += np.column_stack([-2 * np.sin(angles), 0 * time, 2 - 2 * np.cos(angles)])
    scene.add("cart", Box(size=(3, 3, 0.1)), at=path[0], motion="kinematic", path=path, turns=turns)
    rise = float(rng.uniform(0, 0.9 * GAP))
    offset = np.array([0.3, 0.2, 0.05 + size[2] / 2 + rise]) + creep
    rides = path + np.einsum("fij,fj->fi", turns, offset)
    scene.add("thing", block(rng, size), at=rides[0], motion="dynamic", path=rides, turns=turns)
    scene.on("cart", "thing")


def corners(scene: Scene, name: str) -> np.ndarray:
    return np.asarray(mesh_of(next(iter(scene.entities[name][0].parts.values())).shape).vertices)


def edge(folder: Path, rng: RNG, beyond: float, *culprits: str) -> World:
    scene, size, half = Scene(rng), draw_size(rng, 0.2, 0.6), (float(rng.uniform(0.4, 1)), float(rng.uniform(0.4, 1)))
    table(scene, rng, half, float(rng.uniform(0.3, 1)))
    top = float(np.ptp([v[2] for v in corners(scene, "table")]))
    corner = rng.random() < 0.3
    place = (half[0] + beyond, half[1] + beyond if corner else 0.0, top + size[2] / 2 + float(rng.uniform(0, 0.9 * GAP)))
    if corner:
        scene.add("thing", Box(size=tuple(size)), at=place, motion="dynamic")
    else:
        scene.add(
            "thing", Box(size=tuple(size)), at=place, rotation=turn("z", float(rng.choice([0.0, np.pi / 4]))), motion="dynamic"
        )
    scene.on("table", "thing")
    return scene.world(folder, *culprits, still=True)


def stair(folder: Path, rng: RNG, beyond: float, *culprits: str) -> World:
    """Each block's centre is above the block beneath it; of the pile as a whole it lies `beyond` the lowest edge."""
    scene, count, length = Scene(rng), int(rng.integers(2, 6)), float(rng.uniform(0.2, 0.5))
    step = (length + 2 * beyond) / (count + 1)
    height, width = float(rng.uniform(0.05, 0.1)), float(rng.uniform(0.1, 0.3))
    names = ["base", *(f"b{k}" for k in range(count))]
    for k, name in enumerate(names):
        place = (k * step, 0, (k + 0.5) * height + (k + 1) * 1e-5)
        scene.add(name, Box(size=(length, width, height)), at=place, motion="static" if k == 0 else "dynamic")
        if k:
            scene.on(names[k - 1], name)
    return scene.world(folder, *(names[1:] if culprits else ()), still=True)


def seesaw(folder: Path, rng: RNG, beyond: float, *culprits: str) -> World:
    """A plank far over the edge with a counterweight at its inner end; together they lie `beyond` the edge."""
    scene, length, thick = Scene(rng), float(rng.uniform(1, 2)), 0.04
    top, width = 0.7, 0.3
    table(scene, rng, (1.5, 0.5), top)
    side = float(rng.uniform(0.12, 0.25))
    plank, weight = length * width * thick, side * side * side
    over = float(rng.uniform(0.05, 0.12)) * length
    inner = over - 0.45 * length
    # plank x over + weight x place = total x beyond, about the edge at x = 1.5
    place = ((plank + weight) * beyond - plank * over) / weight
    if place < inner or place + side / 2 > 0.3:
        weight_scale = (plank * (beyond - over)) / (inner - beyond)
        side = float((weight_scale) ** (1 / 3))
        place = inner
    scene.add("plank", Box(size=(length, width, thick)), at=(1.5 + over, 0, top + thick / 2 + 1e-5), motion="dynamic")
    scene.add("weight", Box(size=(side,) * 3), at=(1.5 + place, 0, top + thick + side / 2 + 2e-5), motion="dynamic")
    scene.on("table", "plank")
    scene.on("plank", "weight")
    return scene.world(folder, *culprits, still=True)


def slope(folder: Path, rng: RNG, excess: float, *culprits: str) -> World:
    """A block on a slope that is steeper than the friction angle by `excess` rad."""
    friction = float(rng.uniform(0.2, 0.8))
    scene = Scene(rng, friction=friction)
    angle = np.arctan(friction) + excess
    scene.add("slope", Box(size=(4, 4, 0.2)), at=(0, 0, 3), rotation=turn("y", angle))
    scene.post(0.0, 0.0, 3.0)
    size = draw_size(rng, 0.1, 0.4)
    size[2] = min(size[2], 0.5 * min(size[:2]))
    rotation = turn("y", angle) @ turn("z", float(rng.choice([0.0, rng.uniform(-3, 3)])))
    rise = 0.1 + size[2] / 2 + float(rng.uniform(0, 0.3 * GAP))
    scene.add(
        "thing", block(rng, size), at=np.array([0, 0, 3]) + turn("y", angle)[:, 2] * rise, rotation=rotation, motion="dynamic"
    )
    scene.on("slope", "thing")
    return scene.world(folder, *culprits, still=True)


def ladder(folder: Path, rng: RNG, share: float, *culprits: str) -> World:
    """A ladder whose friction is `share` of what it needs against floor and wall (equal on both)."""
    length, thick, lean = float(rng.uniform(1.5, 4)), float(rng.uniform(0.02, 0.05)), float(rng.uniform(0.25, 0.7))
    rotation = turn("y", lean)
    corner = np.array([[x, 0, z] for x in (-thick / 2, thick / 2) for z in (-length / 2, length / 2)]) @ rotation.T
    foot, head = corner[corner[:, 2].argmin()], corner[corner[:, 0].argmax()]
    low, high = np.array([-foot[0], 0, -foot[2]]), head - foot
    # Friction m at both ends, wall force N: m N + V = 1, N = m V; moments about the foot: N z + m N x = c.
    z, x, c = high[2], high[0], low[0]
    need = float(min(m for m in np.roots([x - c, z, -c]).real if m > 0)) if abs(x - c) > 1e-12 else c / z
    scene = Scene(rng, friction=share * need)
    scene.add("ladder", Box(size=(thick, 0.4, length)), at=low + np.array([0, 0, 1e-5]), rotation=rotation, motion="dynamic")
    scene.add("wall", Box(size=(0.2, 3, 6)), at=(high[0] + 0.1 + 1e-5, 0, 3.001))
    scene.on("floor", "ladder")
    if not culprits:
        scene.on("wall", "ladder")
    return scene.world(folder, *culprits, still=True)


def wedged(folder: Path, rng: RNG, excess: float, *culprits: str) -> World:
    """Between two walls that open downwards, by `excess` rad more than the friction angle."""
    friction = float(rng.uniform(0.3, 0.7))
    scene, angle = Scene(rng, friction=friction), np.arctan(friction) + excess
    half, height, depth = float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.05, 0.15)), 0.2
    grow = height * np.tan(angle) / 2
    outline = [(-half - grow, -height / 2), (half + grow, -height / 2), (half - grow, height / 2), (-half + grow, height / 2)]
    upright = turn("x", np.pi / 2)
    scene.add("book", Extrusion(polygon=outline, height=depth), at=(0, 0, 2), rotation=upright, motion="dynamic")
    for name, sign in (("left", -1.0), ("right", 1.0)):
        lean = turn("y", -sign * angle)
        place = np.array([sign * half, 0, 2]) + lean @ np.array([sign * (0.1 + 1e-5), 0, 0])
        scene.add(name, Box(size=(0.2, 0.5, 0.3)), at=place, rotation=lean)
        scene.post(float(place[0]), 0.2, float(place[2]), founded=True)
        scene.on(name, "book")
    return scene.world(folder, *culprits, still=True)


def slide(scene: Scene, rng: RNG, **more: object) -> float:
    """A body on an upright rail; its weight [N]."""
    size = draw_size(rng, 0.1, 0.3)
    scene.add("rail", Box(size=(0.1, 0.1, 3)), at=(0, 0, 1.5))
    scene.add("thing", Box(size=tuple(size)), at=(0.05 + size[0] / 2 + 1e-4, 0, 1.5), motion="dynamic")
    axis = scene.way((0, 0, 1 if rng.random() < 0.5 else -1))
    weight = DENSITY * float(np.prod(size)) * GRAVITY
    scene.more["joints"] = {"rail": SlideJoint(parent="rail", child="thing", anchor=scene.point((0, 0, 1.5)), axis=axis, **more)}
    if rng.random() < 0.5:
        scene.on("rail", "thing")
    return weight

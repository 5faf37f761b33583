"""Worlds of the interpenetration check: one moment, seeded overlap or what only looks like it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.spec import Box, Cylinder, Entity, Extrusion, Fastened, Part, Pose
from ..worlds import small_worlds as sw
from ._motion import bowl, crate, eps_of, mesh_entity, pieces, random_rotation, torus, turn_of
from .cases import World

Rng = np.random.Generator
Things = dict[str, Entity]

CHANNEL = [(-0.3, -0.1), (0.3, -0.1), (0.3, 0.3), (0.2, 0.3), (0.2, 0), (-0.2, 0), (-0.2, 0.3), (-0.3, 0.3)]
"""Cross-section of a channel 0.4 m wide inside, with walls of 0.1 m."""


def _world(folder: Path, things: Things, *culprits: str, **more: Any) -> World:
    built = more.pop("built", None)
    spec = sw.world(things, frames=2, **more)
    made = sw.make_candidate(folder, spec, built=None if built is None else {k: pieces(k, spec.entities[k], spec) for k in built})
    return World(made, culprits)


def _turned(entity: Entity, at: Any, quaternion: F64) -> Entity:
    pose = Pose(position=tuple(map(float, at)), quaternion=tuple(map(float, quaternion)))
    return entity.model_copy(update={"pose": pose})


def _moving(rng: Rng) -> str:
    return str(rng.choice(["static", "dynamic"]))


def _decoys(rng: Rng, count: int) -> Things:
    """A grid of blocks that stand flush beside each other, away from the origin."""
    side = float(rng.uniform(0.1, 0.3))
    return {f"decoy{k}": sw.box(side, side, side, at=(3 + side * (k % 5), side * (k // 5), side / 2)) for k in range(count)}


# ---------------------------------------------------------------------- broken


def sunk(folder: Path, magnitude: float, rng: Rng, *, shift: float = 0.0) -> World:
    """A block stands in the floor instead of on it."""
    size = rng.uniform(0.05, 0.5, 3)
    at = np.array([shift, -0.7 * shift, 0.0])
    floor = sw.box(10, 10, 0.25, at=at - np.array([0, 0, 0.125]))
    block = sw.box(*map(float, size), motion=_moving(rng))
    depth = min(magnitude * eps_of(floor, block, shift), 0.45 * float(size.min()), 0.1)
    turn = turn_of((0, 0, 1), rng.uniform(0, 6))[0]
    return _world(
        folder,
        {"floor": floor, "block": _turned(block, at + np.array([0, 0, size[2] / 2 - depth]), turn), **_decoys(rng, 5)},
        "block",
        "floor",
    )


def far_sunk(folder: Path, magnitude: float, rng: Rng) -> World:
    """The same kilometres from the origin."""
    return sunk(folder, magnitude, rng, shift=float(rng.uniform(1e3, 1e4)))


def any_way_up(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two blocks of a scene turned any way overlap, hidden between two walls."""
    q = random_rotation(rng)
    turn, side = rotation_matrix(q), rng.uniform(0.1, 0.4, 2)
    a, b = (sw.box(*(float(s),) * 3, motion="dynamic") for s in side)
    gap = side.sum() / 2 - min(magnitude * eps_of(a, b), 0.4 * float(side.min()))
    wall = sw.box(0.05, 2, 2)
    walls = {
        f"w{k}": _turned(wall, turn @ [x, 0, 0], q) for k, x in enumerate((-0.5 * side[0] - 0.025, gap + side[1] / 2 + 0.025))
    }
    slide = float(rng.uniform(-0.3, 0.3)) * float(side.min())
    return _world(folder, {**walls, "a": _turned(a, (0, 0, 0), q), "b": _turned(b, turn @ [gap, slide, 0], q)}, "a", "b")


def edge_down(folder: Path, magnitude: float, rng: Rng) -> World:
    """A block on its edge: only the edge is inside the floor."""
    size, angle = rng.uniform(0.1, 0.4, 3), float(rng.uniform(0.3, 1.2))
    floor, block = sw.ground(), sw.box(*map(float, size), motion=_moving(rng))
    low = (size[0] * math.sin(angle) + size[2] * math.cos(angle)) / 2
    depth = min(magnitude * eps_of(floor, block), 0.3 * float(size.min()) * min(math.sin(angle), math.cos(angle)))
    quaternion = turn_of((0, 1, 0), angle)[0]
    return _world(folder, {"floor": floor, "block": _turned(block, (0, 0, low - depth), quaternion)}, "block", "floor")


def concave(folder: Path, magnitude: float, rng: Rng) -> World:
    """A block in a channel of one concave part pokes into its wall from within."""
    side = float(rng.uniform(0.05, 0.2))
    channel, block = sw.entity(Extrusion(polygon=CHANNEL, height=1.0)), sw.box(side, side, side, motion=_moving(rng))
    x = 0.2 - side / 2 + min(magnitude * eps_of(channel, block), 0.4 * min(side, 0.1))
    at = (x * float(rng.choice([-1, 1])), side / 2, float(rng.uniform(-0.3, 0.3)))
    return _world(folder, {"channel": channel, "block": block.model_copy(update={"pose": sw.pose(at)})}, "block", "channel")


def beyond_fastened(folder: Path, magnitude: float, rng: Rng) -> World:
    """A post is set deeper than its relation declares."""
    depth = float(rng.uniform(0.02, 0.09))
    floor, post = sw.ground(), sw.box(0.2, 0.2, 1.0)
    at = (0, 0, 0.5 - depth - magnitude * eps_of(floor, post))
    relation = Fastened(a="post", b="floor", max_depth=depth, reason="the post is set into the ground")
    return _world(
        folder,
        {"floor": floor, "post": post.model_copy(update={"pose": sw.pose(at)})},
        "post",
        "floor",
        relations={"f": relation},
    )


def own_pieces(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two bodies of one entity overlap."""
    side = float(rng.uniform(0.1, 0.5))
    depth = min(magnitude * 2e-9 * math.sqrt(3) * side, 0.4 * side)
    parts = [Part(shape=Box(size=(side,) * 3), pose=sw.pose((k * (side - depth), 0, 0))) for k in range(2)]
    return _world(
        folder, {"ground": sw.ground(), "body": sw.entity(*parts, motion="dynamic", at=(0, 0, 2))}, "body", built=("body",)
    )


def buried(folder: Path, magnitude: float, rng: Rng) -> World:
    """A pipe lies whole inside a wall: no surfaces cross, no camera sees it. Magnitude: its radius over the wall's thickness."""
    thick = float(rng.uniform(0.1, 0.4))
    pipe = sw.entity(Cylinder(radius=magnitude * thick, height=float(rng.uniform(0.2, 0.9))), at=(0, 0, 1))
    return _world(folder, {"wall": sw.box(2, thick, 2, at=(0, 0, 1)), "pipe": pipe, **_decoys(rng, 10)}, "pipe", "wall")


def tiny_in_huge(folder: Path, magnitude: float, rng: Rng) -> World:
    """A grain inside a huge ring of one concave part. Magnitude: its size [m]."""
    angle = float(rng.uniform(0, 6))
    at = (20 * math.cos(angle), 20 * math.sin(angle), float(rng.uniform(-2, 2)))
    return _world(folder, {"huge": mesh_entity(torus(20.0, 5.0)), "grain": sw.box(*(magnitude,) * 3, at=at)}, "grain", "huge")


def twice(folder: Path, magnitude: float, rng: Rng) -> World:
    """The same body stands twice in almost the same place. Magnitude: offset over size."""
    size = rng.uniform(0.1, 0.5, 3)
    quaternion = random_rotation(rng)
    way = rotation_matrix(quaternion)[:, int(rng.integers(3))]
    body = sw.box(*map(float, size), motion="dynamic")
    copy = _turned(body, magnitude * float(size.min()) * way, quaternion)
    return _world(folder, {"a": _turned(body, (0, 0, 0), quaternion), "b": copy}, "a", "b")


def inside_out(folder: Path, magnitude: float, rng: Rng) -> World:
    """An import with all normals inwards overlaps a block. Magnitude: depth [m]."""
    ring = torus(0.5, 0.2)
    top = float(np.asarray(ring.vertices)[:, 2].max())
    ring.invert()
    block = sw.box(0.2, 0.2, 0.2, motion="dynamic", at=(0.5, 0, top + 0.1 - magnitude))
    return _world(folder, {"import": mesh_entity(ring, keep_origin=True), "block": block}, "import", "block")


def leaky(folder: Path, magnitude: float, rng: Rng) -> World:
    """An import that lacks some triangles holds a block inside. Magnitude: share of its triangles that are missing."""
    shell = trimesh.creation.icosphere(2, radius=0.5)
    gone = rng.choice(len(shell.faces), max(1, int(magnitude * len(shell.faces))), replace=False)
    shell.update_faces(np.setdiff1d(np.arange(len(shell.faces)), gone))
    grain = sw.box(0.05, 0.05, 0.05, motion="dynamic", at=tuple(map(float, rng.uniform(-0.1, 0.1, 3))))
    return _world(folder, {"import": mesh_entity(shell, keep_origin=True), "grain": grain}, "import", "grain")


def inverted_lobe(folder: Path, magnitude: float, rng: Rng) -> World:
    """One mesh of two boxes that cross, one inside out: what is inside is not definite. Magnitude: overlap over the size."""
    outer, lobe = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((0.5, 0.6, 0.7))
    lobe.invert()
    lobe.apply_translation([0.5 + 0.25 - 0.5 * magnitude, *rng.uniform(-0.05, 0.05, 2)])
    mesh = trimesh.util.concatenate([outer, lobe])
    mesh.apply_scale(float(rng.uniform(0.1, 3)))
    return _world(folder, {"import": mesh_entity(mesh, keep_origin=True)}, "import")


def crossed_bars(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two thin bars go through each other; no corner of one is inside the other. Magnitude: thickness [m]."""
    angle = float(rng.uniform(0.3, 1.5))
    a = sw.box(1.0, magnitude, magnitude, motion="dynamic")
    b = sw.box(1.0, magnitude, magnitude, at=(0, 0, 0.3 * magnitude), euler=(0, 0, angle))
    return _world(folder, {"a": a, "b": b, **_decoys(rng, 5)}, "a", "b")


# ---------------------------------------------------------------------- clean


def flush(folder: Path, magnitude: float, rng: Rng) -> World:
    """Blocks lie flush on and beside each other, turned any way. Magnitude: share of eps that they sink."""
    q = random_rotation(rng)
    turn, side = rotation_matrix(q), float(rng.uniform(0.1, 0.5))
    block = sw.box(side, side, side, motion="dynamic")
    gap = side - magnitude * eps_of(block, block)
    places = [(0, 0, 0), (gap, 0, 0), (0, gap, 0), (0, 0, gap), (gap, gap, 0)]
    return _world(folder, {f"b{k}": _turned(block, turn @ np.array(p), q) for k, p in enumerate(places)})


def far_flush(folder: Path, magnitude: float, rng: Rng) -> World:
    """Flush, far away. Magnitude: distance [m]."""
    side, at = float(rng.uniform(0.1, 0.5)), magnitude * rng.normal(size=3)
    blocks = {f"b{k}": sw.box(side, side, side, at=tuple(map(float, at + np.array([k * side, 0, 0])))) for k in range(3)}
    return _world(folder, blocks)


def tight_pin(folder: Path, magnitude: float, rng: Rng) -> World:
    """A pin in a hole of one concave part. Magnitude: play on each side [m]."""
    side, outer = float(rng.uniform(0.02, 0.2)), 0.5
    h = side / 2 + magnitude
    polygon = [
        (-outer, -outer), (outer, -outer), (outer, outer), (-outer, outer), (-outer, 1e-3),
        (-h, 1e-3), (-h, h), (h, h), (h, -h), (-h, -h), (-h, -1e-3), (-outer, -1e-3),
    ]  # fmt: skip
    return _world(
        folder, {"plate": sw.entity(Extrusion(polygon=polygon, height=0.1)), "pin": sw.box(side, side, 0.6, motion="dynamic")}
    )


def in_the_channel(folder: Path, magnitude: float, rng: Rng) -> World:
    """A block lies in the corner of a channel, within its box and hull. Magnitude: gap [m]."""
    side = float(rng.uniform(0.05, 0.2))
    at = (0.2 - side / 2 - magnitude, side / 2 + magnitude, 0.0)
    block = sw.box(side, side, side, motion="dynamic", at=at)
    return _world(folder, {"channel": sw.entity(Extrusion(polygon=CHANNEL, height=1.0)), "block": block})


def linked(folder: Path, magnitude: float, rng: Rng) -> World:
    """Linked rings. Magnitude: radius of their section [m]."""
    ring = mesh_entity(torus(0.5, magnitude), motion="dynamic")
    things = {"a": ring, "b": ring.model_copy(update={"pose": sw.pose((0.5, 0, 0), euler=(math.pi / 2, 0, 0))})}
    return _world(folder, things)


def under_the_table(folder: Path, magnitude: float, rng: Rng) -> World:
    """A stool under a table, between its legs. Magnitude: gap to the top [m]."""
    legs = [Part(shape=Box(size=(0.05, 0.05, 0.7)), pose=sw.pose((x, y, 0.35))) for x in (-0.45, 0.45) for y in (-0.25, 0.25)]
    table = sw.entity(Part(shape=Box(size=(1, 0.6, 0.04)), pose=sw.pose((0, 0, 0.72))), *legs)
    tall = 0.7 - magnitude
    return _world(
        folder, {"floor": sw.ground(), "table": table, "stool": sw.box(0.3, 0.3, tall, motion="dynamic", at=(0, 0, tall / 2))}
    )


def nested(folder: Path, magnitude: float, rng: Rng) -> World:
    """Crates stand in crates. Magnitude: play on each side [m]."""
    things: Things = {}
    size, base = rng.uniform(0.6, 1.0, 3), 0.0
    for k in range(3):
        things[f"crate{k}"] = sw.entity(*crate(size, 0.02), motion="dynamic", at=(0, 0, base + 0.02))
        base += 0.02
        size = size - np.array([0.04 + 2 * magnitude, 0.04 + 2 * magnitude, 0.05])
    return _world(folder, {"floor": sw.ground(), **things})


def fastened(folder: Path, magnitude: float, rng: Rng) -> World:
    """A post is set as deep as its relation declares. Magnitude: share of the declared depth."""
    depth = float(rng.uniform(0.02, 0.09))
    relation = Fastened(a="post", b="floor", max_depth=depth, reason="the post is set into the ground")
    post = sw.box(0.2, 0.2, 1.0, at=(0, 0, 0.5 - magnitude * depth))
    return _world(folder, {"floor": sw.ground(), "post": post}, relations={"f": relation})


def union(folder: Path, magnitude: float, rng: Rng) -> World:
    """One mesh of two boxes that cross, both outwards: a union, whose inside is definite. Magnitude: overlap over the size."""
    one, two = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((0.5, 0.6, 0.7))
    two.apply_translation([0.5 + 0.25 - 0.5 * magnitude, *rng.uniform(-0.05, 0.05, 2)])
    mesh = trimesh.util.concatenate([one, two])
    beside = sw.box(0.3, 0.3, 0.3, motion="dynamic", at=(0.65, 0.55, 0))
    return _world(folder, {"import": mesh_entity(mesh, keep_origin=True, at=(0, 0, 0)), "block": beside})


def corner_to_corner(folder: Path, magnitude: float, rng: Rng) -> World:
    """Blocks that touch at a corner, or cross at their edges. Magnitude: side [m]."""
    s = magnitude
    tip = sw.box(s, s, s, motion="dynamic", at=(s, s, s))
    # Two edges crosswise: one block on its edge along x below, one along y above.
    r = s / math.sqrt(2)
    low = sw.box(s, s, s, at=(5 * s, 0, 0), euler=(math.pi / 4, 0, 0))
    high = sw.box(s, s, s, motion="dynamic", at=(5 * s, 0, 2 * r), euler=(0, math.pi / 4, 0))
    return _world(folder, {"a": sw.box(s, s, s), "b": tip, "low": low, "high": high})


def bowl_and_ball(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball in a thin bowl, inside its hull. Magnitude: gap [m]."""
    inner, sections, radius = 0.5, 16, float(rng.uniform(0.03, 0.15))
    reach = inner * math.cos(math.pi / sections) * math.cos(math.pi / 24) - radius - magnitude
    tilt, around = float(rng.uniform(0, 1.2)), float(rng.uniform(0, 6))
    at = (reach * math.sin(tilt) * math.cos(around), reach * math.sin(tilt) * math.sin(around), -reach * math.cos(tilt))
    things = {"bowl": mesh_entity(bowl(inner, float(rng.uniform(0.01, 0.05)), sections), keep_origin=True)}
    return _world(folder, {**things, "ball": sw.ball(radius, motion="dynamic", at=at)})


def flush_pieces(folder: Path, magnitude: float, rng: Rng) -> World:
    """Bodies of one entity lie flush. Magnitude: side [m]."""
    parts = [Part(shape=Box(size=(magnitude,) * 3), pose=sw.pose((k * magnitude, 0, 0))) for k in range(3)]
    return _world(folder, {"body": sw.entity(*parts, motion="dynamic", at=(0, 0, 2))}, built=("body",))

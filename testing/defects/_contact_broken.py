"""Worlds with a seeded contact defect: overlap at a frame, or a passage between two."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.spec import Box, Extrusion, Fastened, HingeJoint, Part, Pose, Rope
from ..worlds import small_worlds as sw
from ._motion import (
    FPS,
    FRAMES,
    Track,
    about,
    ball,
    candidate_of,
    crate,
    eps_of,
    mesh_entity,
    pieces,
    random_rotation,
    rolled,
    still,
    torus,
    turn_of,
)
from .cases import World

__all__ = [
    "beyond_fastened",
    "concave",
    "dip",
    "far_dip",
    "filled_ditch",
    "gate",
    "head_on",
    "hidden_dip",
    "inside_out",
    "last_dip",
    "nested",
    "own_pieces",
    "rope_through_itself",
    "slowed_through",
    "spinning_blade",
    "thin_wall",
    "threaded_ring",
    "tiny_in_huge",
]

Rng = np.random.Generator


def _size(rng: Rng) -> tuple[float, float, float]:
    x, y, z = rng.uniform(0.05, 0.5, 3)
    return float(x), float(y), float(z)


def _dip(folder: Path, depth_eps: float, rng: Rng, *, frame: int, shift: float = 0.0) -> World:
    size = _size(rng)
    at = np.array([shift, -0.7 * shift, 0.0])
    floor = sw.box(10, 10, 0.2, at=at - np.array([0, 0, 0.1]))
    box = sw.box(*size, motion="dynamic", at=at + np.array([0, 0, size[2] / 2]))
    depth = min(depth_eps * eps_of(floor, box, shift), 0.45 * min(size), 0.09)
    path = still(at + np.array([*rng.uniform(-3, 3, 2), size[2] / 2]))
    path.position[frame, 2] -= depth
    path.quaternion[:] = turn_of((0, 0, 1), rng.uniform(0, 6))
    spec = sw.world({"floor": floor, "body": box}, frames=FRAMES)
    return World(candidate_of(folder, spec, {"body": path}), ("body",))


def dip(folder: Path, magnitude: float, rng: Rng) -> World:
    """A box sinks into the floor at one frame."""
    return _dip(folder, magnitude, rng, frame=int(rng.integers(1, FRAMES - 1)))


def last_dip(folder: Path, magnitude: float, rng: Rng) -> World:
    """The same at the very last frame."""
    return _dip(folder, magnitude, rng, frame=FRAMES - 1)


def far_dip(folder: Path, magnitude: float, rng: Rng) -> World:
    """The same kilometres from the origin."""
    return _dip(folder, magnitude, rng, frame=int(rng.integers(1, FRAMES)), shift=float(rng.uniform(1e3, 1e4)))


def hidden_dip(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two blocks overlap inside a closed chest, one frame, among bodies that only touch."""
    chest = sw.entity(
        *crate(np.array([1.0, 1.0, 0.5]), 0.05), Part(shape=Box(size=(1.1, 1.1, 0.05)), pose=sw.pose((0, 0, 0.525)))
    )
    things = {"chest": chest}
    for k in range(6):
        things[f"decoy{k}"] = sw.box(0.1, 0.1, 0.1, motion="dynamic", at=(1.5 + 0.1 * k, 0, 0.05))
    x = float(rng.uniform(-0.3, 0.1))
    a = sw.box(0.2, 0.2, 0.2, motion="dynamic", at=(x, 0, 0.1))
    b = sw.box(0.1, 0.1, 0.1, motion="dynamic", at=(x + 0.15, 0, 0.05))
    frame = int(rng.integers(1, FRAMES))
    path = still((x + 0.15, 0, 0.05))
    path.position[frame, 0] -= min(magnitude * eps_of(a, b), 0.045)
    return World(candidate_of(folder, sw.world({**things, "a": a, "b": b}, frames=FRAMES), {"b": path}), ("a", "b"))


def concave(folder: Path, magnitude: float, rng: Rng) -> World:
    """A block inside a channel of one concave part pokes into its wall from within."""
    wall, wide, high = 0.1, 0.4, float(rng.uniform(0.2, 0.5))
    half = wide / 2
    shape = Extrusion(
        polygon=[
            (-half - wall, -wall), (half + wall, -wall), (half + wall, high), (half, high),
            (half, 0), (-half, 0), (-half, high), (-half - wall, high),
        ],
        height=1.0,
    )  # fmt: skip
    side = float(rng.uniform(0.05, 0.2))
    channel, block = sw.entity(shape), sw.box(side, side, side, motion="dynamic")
    path = still((0, side / 2, 0))
    path.position[:, 0] = np.linspace(-0.05, 0.05, FRAMES)
    frame = int(rng.integers(1, FRAMES))
    path.position[frame, 0] = (half - side / 2 + min(magnitude * eps_of(channel, block), 0.4 * min(side, wall))) * rng.choice(
        [-1, 1]
    )
    return World(candidate_of(folder, sw.world({"channel": channel, "block": block}, frames=FRAMES), {"block": path}), ("block",))


def nested(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball lies whole inside a block, for some frames, without touching its surface."""
    size = float(rng.uniform(0.5, 2.0))
    block = sw.box(size, size, size, motion="dynamic", at=(0, 0, 3))
    sphere = ball(magnitude * size, motion="dynamic")
    path = still((3, 0, 3))
    frame = int(rng.integers(1, FRAMES))
    path.position[frame:] = np.array([0, 0, 3]) + rng.uniform(-1, 1, 3) * (0.45 - magnitude) * size
    spec = sw.world({"ground": sw.ground(), "block": block, "ball": sphere}, frames=FRAMES)
    return World(candidate_of(folder, spec, {"ball": path}), ("ball",))


def tiny_in_huge(folder: Path, magnitude: float, rng: Rng) -> World:
    """A grain deep inside a huge ring (one concave part), for one frame."""
    ring = torus(20.0, 5.0)
    huge, grain = mesh_entity(ring), sw.box(*(magnitude,) * 3, motion="dynamic")
    path = still((0, 0, 0))
    angle, frame = rng.uniform(0, 6), int(rng.integers(1, FRAMES))
    path.position[frame] = [20 * math.cos(angle), 20 * math.sin(angle), rng.uniform(-2, 2)]
    return World(candidate_of(folder, sw.world({"huge": huge, "grain": grain}, frames=FRAMES), {"grain": path}), ("grain",))


def inside_out(folder: Path, magnitude: float, rng: Rng) -> World:
    """An imported body with all its normals inwards is hit by a block, one frame."""
    ball = torus(0.5, 0.2)
    ball.invert()
    inverted = mesh_entity(ball, keep_origin=True, size=(1.4, 1.4, 0.4))
    block = sw.box(0.2, 0.2, 0.2, motion="dynamic")
    top = float(np.asarray(ball.vertices)[:, 2].max())
    path = still((0.5, 0, top + 0.1))
    frame = int(rng.integers(1, FRAMES))
    path.position[frame, 2] -= magnitude
    return World(candidate_of(folder, sw.world({"import": inverted, "block": block}, frames=FRAMES), {"block": path}), ("block",))


def own_pieces(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two bodies of one entity, which nothing joins, overlap at one frame."""
    sizes = [_size(rng) for _ in range(2)]
    parts = [Part(shape=Box(size=s), pose=sw.pose((2.0 * k, 0, 0))) for k, s in enumerate(sizes)]
    whole = sw.entity(*parts, motion="dynamic", at=(0, 0, 2))
    spec = sw.world({"ground": sw.ground(), "body": whole}, frames=FRAMES)
    depth = min(magnitude * 2e-9 * max(math.dist(s, (0, 0, 0)) for s in sizes), 0.4 * min(*sizes[0], *sizes[1]))
    path = still((2, 0, 2))
    path.position[int(rng.integers(1, FRAMES)), 0] = (sizes[0][0] + sizes[1][0]) / 2 - depth
    made = candidate_of(folder, spec, {"body/p1": path}, built={"body": pieces("body", whole, spec)})
    return World(made, ("body",))


def rope_through_itself(folder: Path, magnitude: float, rng: Rng) -> World:
    """The far end of a rope lies in its own middle at one frame; magnitude: overlap / radius."""
    radius = float(rng.uniform(0.005, 0.02))
    rope = sw.entity(rope=Rope(points=[(0, 0, 0), (1, 0, 0)], radius=radius, segments=8), motion="dynamic", at=(0, 0, 1))
    path = Track(np.tile([0.5 + 7 / 16, 0.0, 1.0], (FRAMES, 1)), turn_of((0, 1, 0), math.pi / 2))
    segment = int(rng.integers(1, 4))
    frame = int(rng.integers(1, FRAMES))
    path.position[frame] = [(segment + 0.5) / 8, 0, 1.0 + radius * (2.0 - magnitude)]
    path.quaternion[frame] = turn_of((1, 0, 0), math.pi / 2)[0]
    spec = sw.world({"ground": sw.ground(), "rope": rope}, frames=FRAMES)
    return World(candidate_of(folder, spec, {"rope/s7": path}), ("rope",))


def beyond_fastened(folder: Path, magnitude: float, rng: Rng) -> World:
    """A jointed arm sits in its post by more than the relation declares."""
    depth = float(rng.uniform(0.005, 0.04))
    post = sw.box(0.1, 0.1, 1.0, at=(0, 0, 0.5))
    arm = sw.box(0.4, 0.05, 0.05, motion="dynamic", at=(0.25 - depth, 0, 0.5))
    spec = sw.world(
        {"post": post, "arm": arm},
        frames=FRAMES,
        joints={"h": HingeJoint(parent="post", child="arm", anchor=(0, 0, 0.5), axis=(1, 0, 0))},
        relations={"f": Fastened(a="post", b="arm", max_depth=depth, reason="the arm is set into the post")},
    )
    path = still((0.25 - depth, 0, 0.5))
    # The deepest point of an end sunk by less than half its width is an edge of the end.
    path.position[int(rng.integers(1, FRAMES)), 0] -= magnitude * eps_of(post, arm)
    return World(candidate_of(folder, spec, {"arm": path}), ("arm", "post"))


# ---------------------------------------------------------------------- between frames


def _crossing(rng: Rng, normal: F64, travel: float, frame: int) -> tuple[F64, F64]:
    """Straight track that passes the origin in the middle of a frame interval, and its step per frame."""
    side = np.cross(normal, rng.normal(size=3))
    direction = normal + 0.3 * rng.uniform() * side / np.linalg.norm(side)
    step = travel * direction
    return (np.arange(FRAMES) - frame + 0.5)[:, None] * step, step


def thin_wall(folder: Path, magnitude: float, rng: Rng) -> World:
    """A small fast ball goes through a thin plate of any slope; no frame shows it. Magnitude: travel / (ball + plate)."""
    radius, wall = float(rng.uniform(0.005, 0.05)), float(rng.uniform(0.001, 0.03))
    quaternion = random_rotation(rng)
    normal = rotation_matrix(quaternion)[:, 2]
    track, step = _crossing(rng, normal, magnitude * (2 * radius + wall), int(rng.integers(1, FRAMES)))
    plate = sw.box(3, 3, wall)
    plate = plate.model_copy(update={"pose": Pose(position=(0, 0, 0), quaternion=tuple(map(float, quaternion)))})
    sphere = ball(radius, motion="dynamic")
    spec = sw.world({"plate": plate, "ball": sphere}, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, {"ball": Track(track, velocity=step * FPS)}), ("ball", "plate"))


def slowed_through(folder: Path, magnitude: float, rng: Rng) -> World:
    """The engine felt the plate and slowed the ball, which comes out behind it all the same. Magnitude: share of speed lost."""
    radius, wall = 0.02, float(rng.uniform(0.005, 0.02))
    frame, speed = int(rng.integers(2, FRAMES - 1)), float(rng.uniform(6, 20))
    z = np.empty(FRAMES)
    # Contact in the middle of the interval before `frame`, 1 mm of travel within the plate at each step.
    at = (np.arange(FRAMES) - frame + 0.5) / FPS
    z = np.where(at < 0, -speed * at, -(1 - magnitude) * speed * at)
    velocity = np.where(at < 0, -speed, -(1 - magnitude) * speed)
    track, vel = np.zeros((FRAMES, 3)), np.zeros((FRAMES, 3))
    track[:, 2], vel[:, 2] = z, velocity
    deep = -(radius + wall / 2) * float(rng.uniform(0.7, 1.0))
    spec = sw.world({"plate": sw.box(1, 1, wall), "ball": ball(radius, motion="dynamic")}, frames=FRAMES, gravity=(0, 0, 0))
    events = [sw.Event((frame - 0.5) / FPS, "plate", "ball", speed=speed)]
    touches = [sw.Touch(frame, "plate", "ball", min_gap=deep)]
    return World(candidate_of(folder, spec, {"ball": Track(track, velocity=vel)}, events=events, touches=touches), ("ball",))


def spinning_blade(folder: Path, magnitude: float, rng: Rng) -> World:
    """A thin bar turns through a post between two frames, some times whole turns. Magnitude: angle per frame [rad]."""
    width, side = float(rng.uniform(0.01, 0.03)), float(rng.uniform(0.01, 0.03))
    where, frame = float(rng.uniform(0.3, 0.9)), int(rng.integers(1, FRAMES))
    blade = sw.box(2.0, width, 0.05, motion=rng.choice(["dynamic", "kinematic"]))
    start = float(rng.uniform(0, 6))
    angle = start + (np.arange(FRAMES) - frame + 0.5) * magnitude
    post = sw.box(side, side, 0.5, at=(where * math.cos(start), where * math.sin(start), 0), euler=(0, 0, start))
    # The blade has two arms: the post must be clear of both at every frame, or the defect would show at one.
    near = np.abs((angle - start + math.pi / 2) % math.pi - math.pi / 2)
    clear = math.asin(min(1.0, (width + 2 * side) / where))
    if near.min() <= clear:
        angle = start + np.where(np.arange(FRAMES) < frame, -0.5, 0.5) * magnitude
    rate = magnitude * FPS
    spec = sw.world({"post": post, "blade": blade}, frames=FRAMES, gravity=(0, 0, 0))
    path = about((0, 0, 1), np.asarray(angle, dtype=np.float64), np.full(FRAMES, rate), (0, 0, 0), (0, 0, 0))
    return World(candidate_of(folder, spec, {"blade": path}), ("blade", "post"))


def head_on(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two dynamic bodies go through each other between two frames. Magnitude: relative travel / summed sizes along it."""
    a, b = ball(float(rng.uniform(0.02, 0.1)), motion="dynamic"), sw.box(*_size(rng), motion="dynamic")
    qa, qb = random_rotation(rng), random_rotation(rng)
    direction = random_rotation(rng)[:3]
    direction /= np.linalg.norm(direction)
    reach = a.dimensions.size[0] + 1.05 * math.dist(b.dimensions.size, (0, 0, 0))
    k = np.arange(FRAMES) - int(rng.integers(1, FRAMES)) + 0.5
    step = magnitude * reach * direction
    share = float(rng.uniform(0.2, 0.8))
    paths = {
        "a": Track(k[:, None] * step * share, qa, velocity=step * share * FPS),
        "b": Track(-k[:, None] * step * (1 - share), qb, velocity=-step * (1 - share) * FPS),
    }
    spec = sw.world({"ground": sw.box(1, 1, 1, at=(50, 50, 50)), "a": a, "b": b}, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, paths), ("a", "b"))


def gate(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball crosses a thin kinematic gate that slides across its way. Magnitude: travel / (ball + gate)."""
    radius, wall = float(rng.uniform(0.01, 0.04)), float(rng.uniform(0.004, 0.02))
    frame = int(rng.integers(1, FRAMES))
    track, step = _crossing(rng, np.array([1.0, 0, 0]), magnitude * (2 * radius + wall), frame)
    lift = np.zeros((FRAMES, 3))
    rise = float(rng.uniform(-0.05, 0.05))
    lift[:, 2] = (np.arange(FRAMES) - frame + 0.5) * rise
    spec = sw.world(
        {"gate": sw.box(wall, 1, 2, motion="kinematic"), "ball": ball(radius, motion="dynamic")},
        frames=FRAMES,
        gravity=(0, 0, 0),
    )
    paths = {"gate": Track(lift, velocity=(0, 0, rise * FPS)), "ball": Track(track, velocity=step * FPS)}
    return World(candidate_of(folder, spec, paths), ("ball", "gate"))


def filled_ditch(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball rolls on over a ditch that is drawn open, on its plate's hull. Magnitude: half width of the ditch in radii."""
    radius = float(rng.uniform(0.03, 0.1))
    return World(rolled(folder, radius, magnitude * radius, rng), ("ball", "plate"))


def threaded_ring(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ring that hung free is linked with a bar in the next frame: it went through. Magnitude: radius of the section / bar."""
    minor = 0.01 * magnitude
    ring = mesh_entity(torus(0.15, minor), motion="dynamic")
    bar = sw.box(0.02, 2.0, 0.02)
    frame = int(rng.integers(1, FRAMES))
    k = (np.arange(FRAMES) - frame + 0.5)[:, None]
    # The section of the ring that lies across the bar passes it from beside to within.
    start = np.array([0.15, 0.0, 0.0])
    step = np.array([-(0.06 + 4 * minor), 0.0, 0.0])
    track = start + np.where(k < 0, -0.5, 0.5) * step
    velocity = np.tile(step * FPS, (FRAMES, 1))
    velocity[np.abs(k[:, 0]) > 1] = 0.0
    turn = turn_of((1, 0, 0), math.pi / 2)
    spec = sw.world({"bar": bar, "ring": ring}, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, {"ring": Track(track, np.tile(turn, (FRAMES, 1)), velocity)}), ("ring", "bar"))

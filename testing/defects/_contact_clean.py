"""Sound worlds that look like contact defects: flush, tight, fast, linked, nested, bouncing within a frame."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...worlds.arrays import rotation_matrix
from ...worlds.spec import Box, Cylinder, Entity, Extrusion, Fastened, HingeJoint, Part, Pose, Rope
from ..worlds import small_worlds as sw
from ._motion import (
    FPS,
    FRAMES,
    Track,
    about,
    ball,
    bowl,
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
    "blade_beside_post",
    "bounce",
    "bowl_and_ball",
    "corner_bounce",
    "crate_with_content",
    "far_rest",
    "fastened",
    "flush_pieces",
    "joints_of_a_pavement",
    "landing_stick",
    "linked_rings",
    "near_miss",
    "open_gate",
    "recoil",
    "rest",
    "rope_in_a_bight",
    "slide",
    "thrown_over",
    "tight_pin",
    "turntable",
]

Rng = np.random.Generator


def rest(folder: Path, magnitude: float, rng: Rng) -> World:
    """Blocks stand on each other with no gap, or so far inside the noise as the bound allows. Magnitude: share of eps."""
    sizes = rng.uniform(0.1, 0.5, (3, 3))
    blocks = {f"b{k}": sw.box(*map(float, s), motion="dynamic") for k, s in enumerate(sizes)}
    floor = sw.ground()
    paths, top = {}, 0.0
    below = floor
    for k, (name, block) in enumerate(blocks.items()):
        depth = magnitude * eps_of(below, block) if k < 2 else 0.0
        paths[name] = still((0, 0, top + sizes[k, 2] / 2 - depth))
        paths[name].quaternion[:] = turn_of((0, 0, 1), rng.uniform(0, 6))
        top, below = top + sizes[k, 2] - depth, block
    return World(candidate_of(folder, sw.world({"floor": floor, **blocks}, frames=FRAMES), paths))


def far_rest(folder: Path, magnitude: float, rng: Rng) -> World:
    """The same kilometres away, where positions round. Magnitude: distance [m]."""
    at = np.array([magnitude, -0.7 * magnitude, 0.3 * magnitude])
    size = float(rng.uniform(0.1, 0.5))
    floor = sw.box(10, 10, 0.25, at=at - np.array([0, 0, 0.125]))
    body = sw.box(size, size, size, motion="dynamic", at=at + np.array([0, 0, size / 2]))
    path = still(at + np.array([0, 0, size / 2]))
    path.position[:, 0] += np.linspace(0, 1, FRAMES)
    return World(candidate_of(folder, sw.world({"floor": floor, "body": body}, frames=FRAMES), {"body": path}))


def slide(folder: Path, magnitude: float, rng: Rng) -> World:
    """A block slides flush along floor and wall of a scene turned any way. Magnitude: speed [m/s]."""
    q = random_rotation(rng)
    turn = rotation_matrix(q)
    pose = {"quaternion": tuple(map(float, q))}

    def placed(entity: Entity, at: tuple[float, float, float]) -> Entity:
        return entity.model_copy(update={"pose": Pose(position=tuple(map(float, turn @ at)), **pose)})

    side = float(rng.uniform(0.1, 0.4))
    floor, wall = placed(sw.box(60, 4, 0.2), (0, 0, -0.1)), placed(sw.box(60, 0.2, 1), (0, -0.1, 0.5))
    local = np.column_stack([magnitude * np.arange(FRAMES) / FPS, np.full(FRAMES, side / 2), np.full(FRAMES, side / 2)])
    local[:, 0] -= local[-1, 0] / 2
    path = Track(local @ turn.T, q, velocity=magnitude * turn[:, 0])
    block = sw.box(side, side, side, motion="dynamic")
    return World(
        candidate_of(
            folder, sw.world({"floor": floor, "wall": wall, "block": block}, frames=FRAMES, gravity=(0, 0, 0)), {"block": path}
        )
    )


def joints_of_a_pavement(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball rolls over a slot that it hardly dips into. Magnitude: half width of the slot in radii."""
    radius = float(rng.uniform(0.03, 0.1))
    return World(rolled(folder, radius, magnitude * radius, rng))


def tight_pin(folder: Path, magnitude: float, rng: Rng) -> World:
    """A square pin is pushed through a square hole of one concave part. Magnitude: play on each side [m]."""
    side, outer = float(rng.uniform(0.02, 0.2)), 0.5
    h = side / 2 + magnitude
    ring = Extrusion(
        polygon=[
            (-outer, -outer), (outer, -outer), (outer, outer), (-outer, outer), (-outer, 1e-3),
            (-h, 1e-3), (-h, h), (h, h), (h, -h), (-h, -h), (-h, -1e-3), (-outer, -1e-3),
        ],
        height=0.1,
    )  # fmt: skip
    path = still((0, 0, 0))
    path.position[:, 2] = np.linspace(-0.5, 0.5, FRAMES)
    path.velocity[:, 2] = FPS / (FRAMES - 1)
    pin = sw.box(side, side, 0.6, motion="kinematic")
    spec = sw.world({"plate": sw.entity(ring), "pin": pin}, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, {"pin": path}))


def bounce(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball bounces off a thin plate between two frames, at any moment of the interval. Magnitude: speed [m/s]."""
    radius, wall = float(rng.uniform(0.01, 0.04)), float(rng.uniform(0.004, 0.02))
    restitution, spin = float(rng.uniform(0.2, 1.0)), rng.normal(size=3) * 20
    frame = int(rng.integers(1, FRAMES))
    when = (frame - float(rng.uniform(0.02, 0.98))) / FPS
    time = np.arange(FRAMES) / FPS - when
    side = float(rng.uniform(-1, 1)) * magnitude
    before = time < 0
    z = radius + wall / 2 + np.where(before, -magnitude * time, restitution * magnitude * time)
    velocity = np.column_stack([np.full(FRAMES, side), np.zeros(FRAMES), np.where(before, -magnitude, restitution * magnitude)])
    path = Track(np.column_stack([side * time, 0 * z, z]), sw.IDENTITY, velocity)
    path.spin[~before] = spin
    for k in np.flatnonzero(~before):
        path.quaternion[k] = turn_of(spin, np.linalg.norm(spin) * time[k])[0]
    things = {"plate": sw.box(8, 8, wall), "ball": ball(radius, motion="dynamic")}
    events = [sw.Event(when, "plate", "ball", speed=magnitude)]
    touches = [sw.Touch(frame, "plate", "ball")]
    return World(
        candidate_of(folder, sw.world(things, frames=FRAMES, gravity=(0, 0, 0)), {"ball": path}, events=events, touches=touches)
    )


def corner_bounce(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball hits floor and wall, thin sheets both, within one frame. Magnitude: speed [m/s]."""
    radius, sheet = 0.02, 0.005
    frame = int(rng.integers(1, FRAMES))
    late = rng.uniform(0.05, 0.95, 2)
    paths = []
    for k in range(2):
        time = np.arange(FRAMES) / FPS - (frame - late[k]) / FPS
        paths.append(
            (np.where(time < 0, -magnitude * time, 0.8 * magnitude * time), np.where(time < 0, -magnitude, 0.8 * magnitude))
        )
    off = radius + sheet / 2
    track = np.column_stack([off + paths[0][0], np.zeros(FRAMES), off + paths[1][0]])
    velocity = np.column_stack([paths[0][1], np.zeros(FRAMES), paths[1][1]])
    things = {
        "floor": sw.box(10, 10, sheet, at=(5 + sheet / 2 + 1e-3, 0, 0)),
        "wall": sw.box(sheet, 10, 10, at=(0, 0, 5 - sheet / 2)),
        "ball": ball(radius, motion="dynamic"),
    }
    events = [sw.Event((frame - late[k]) / FPS, n, "ball") for k, n in enumerate(("wall", "floor"))]
    touches = [sw.Touch(frame, n, "ball") for n in ("wall", "floor")]
    spec = sw.world(things, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, {"ball": Track(track, velocity=velocity)}, events=events, touches=touches))


def recoil(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two flying balls strike each other between frames and part again. Magnitude: closing speed [m/s]."""
    ra, rb = rng.uniform(0.01, 0.08, 2)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    frame = int(rng.integers(1, FRAMES))
    when = (frame - float(rng.uniform(0.02, 0.98))) / FPS
    time = (np.arange(FRAMES) / FPS - when)[:, None]
    drift = rng.normal(size=3) * 3
    share = float(rng.uniform(0.1, 0.9))
    paths = {}
    for name, sign, reach, part in (("a", 1.0, ra, share), ("b", -1.0, rb, 1 - share)):
        speed = np.where(time < 0, -magnitude * part, 0.7 * magnitude * part)
        paths[name] = Track(drift * time + sign * direction * (reach + speed * time), velocity=drift + sign * direction * speed)
    spec = sw.world(
        {"a": ball(float(ra), motion="dynamic"), "b": ball(float(rb), motion="dynamic")}, frames=FRAMES, gravity=(0, 0, 0)
    )
    events, touches = [sw.Event(when, "a", "b")], [sw.Touch(frame, "a", "b")]
    return World(candidate_of(folder, spec, paths, events=events, touches=touches))


def landing_stick(folder: Path, magnitude: float, rng: Rng) -> World:
    """A thin stick falls level but for one end, which strikes the floor: it turns from then on. Magnitude: speed [m/s]."""
    length, thick = 1.0, float(rng.uniform(0.01, 0.03))
    tilt, frame = float(rng.uniform(0.2, 0.5)), int(rng.integers(2, FRAMES))
    when = (frame - float(rng.uniform(0.05, 0.95))) / FPS
    time = np.arange(FRAMES) / FPS - when
    low = length / 2 * math.sin(tilt) + thick / 2 * math.cos(tilt)
    # The end that strikes stays there; the other comes down until the stick lies.
    corner = np.array([-length / 2, 0, -thick / 2])
    rate = 3.0 * magnitude / (2.0 * length)
    angle = np.clip(tilt - rate * time, 0.0, tilt)
    quaternion = turn_of((0, -1, 0), angle)
    pivot = np.array([-length / 2 * math.cos(tilt) + thick / 2 * math.sin(tilt), 0, 0])
    turned = rotation_matrix(quaternion)
    track = np.where(time[:, None] < 0, np.array([0, 0, low]) - np.outer(time, [0, 0, magnitude]), pivot - turned @ corner)
    swinging = (time >= 0) & (angle > 0)
    spin = np.where(swinging[:, None], [0, rate, 0], 0.0)
    velocity = np.where(time[:, None] < 0, [0, 0, -magnitude], np.cross(spin, -(turned @ corner)))
    down = tilt / rate + when
    events = [sw.Event(when, "floor", "stick"), *([sw.Event(down + 1e-9, "floor", "stick")] if down < (FRAMES - 1) / FPS else [])]
    touches = [sw.Touch(k, "floor", "stick") for k in range(frame, FRAMES)]
    things = {"floor": sw.ground(), "stick": sw.box(length, thick, thick, motion="dynamic")}
    path = Track(track, quaternion, velocity, spin)
    return World(candidate_of(folder, sw.world(things, frames=FRAMES), {"stick": path}, events=events, touches=touches))


def near_miss(folder: Path, magnitude: float, rng: Rng) -> World:
    """A fast ball flies past the edge of a thin wall on its parabola. Magnitude: clearance [m]."""
    radius, wall = float(rng.uniform(0.02, 0.08)), float(rng.uniform(0.002, 0.02))
    speed, frame = float(rng.uniform(5, 50)), int(rng.integers(1, FRAMES))
    time = (np.arange(FRAMES) - frame + float(rng.uniform(0.1, 0.9))) / FPS
    z = radius + magnitude - 0.5 * 9.81 * time**2
    top = np.array([0.0, 0.0, 0.0])
    # Highest over the wall; the sides of the wall are reached within its thickness.
    sag = 0.5 * 9.81 * ((radius + wall) / speed) ** 2
    track = np.column_stack([speed * time, 0 * time, z + sag]) + top
    velocity = np.column_stack([np.full(FRAMES, speed), 0 * time, -9.81 * time])
    things = {"wall": sw.box(wall, 2, 1, at=(0, 0, -0.5)), "ball": ball(radius, motion="dynamic")}
    track[:, 2] = track[:, 2]
    keep = np.abs(time) < 0.3
    track[~keep], velocity[~keep] = track[keep][np.where(time[~keep] < 0, 0, -1)], 0.0
    return World(candidate_of(folder, sw.world(things, frames=FRAMES), {"ball": Track(track, velocity=velocity)}))


def thrown_over(folder: Path, magnitude: float, rng: Rng) -> World:
    """The chord between two frames leads through a thin wall, the parabola over it. Magnitude: clearance [m]."""
    radius, fps = 0.02, 6
    speed, side = float(rng.uniform(2, 6)), float(rng.choice([-1, 1]))
    half = 0.5 / fps
    rise = 0.5 * 9.81 * half**2
    time = (np.arange(FRAMES) - FRAMES // 2 + 0.5) / fps
    z = 0.3 + radius + magnitude + 0.5 * 9.81 * (0.02 / speed + radius / speed) ** 2 - 0.5 * 9.81 * time**2
    ok = np.abs(time) <= half * 1.01
    track = np.column_stack([side * speed * time, 0 * time, z])
    velocity = np.column_stack([np.full(FRAMES, side * speed), 0 * time, -9.81 * time])
    # Before and after it lies on ledges where the throw begins and ends.
    track[~ok] = np.where(time[~ok, None] < 0, track[ok][0], track[ok][-1])
    velocity[~ok] = 0.0
    assert rise > radius
    things = {"wall": sw.box(0.02, 1, 0.3, at=(0, 0, 0.15)), "ball": ball(radius, motion="dynamic")}
    spec = sw.world(things, frames=FRAMES, fps=fps)
    return World(candidate_of(folder, spec, {"ball": Track(track, velocity=velocity)}))


def blade_beside_post(folder: Path, magnitude: float, rng: Rng) -> World:
    """A blade turns fast, whole turns between frames too, and clears a post by little. Magnitude: clearance [m]."""
    length, width, side = 2.0, 0.02, 0.02
    rate = float(rng.uniform(5, 400))
    reach = math.hypot(length / 2, width / 2) + magnitude + math.hypot(side, side) / 2
    where = float(rng.uniform(0, 6))
    post = sw.box(side, side, 1, at=(reach * math.cos(where), reach * math.sin(where), 0), euler=(0, 0, float(rng.uniform(0, 6))))
    blade = sw.box(length, width, 0.05, motion=str(rng.choice(["kinematic", "dynamic"])))
    angle = float(rng.uniform(0, 6)) + rate * np.arange(FRAMES) / FPS
    path = about((0, 0, 1), angle, np.full(FRAMES, rate), (0, 0, 0), (0, 0, 0))
    spec = sw.world({"post": post, "blade": blade}, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, {"blade": path}))


def open_gate(folder: Path, magnitude: float, rng: Rng) -> World:
    """A gate rises and a ball flies under it. Magnitude: clearance [m]."""
    radius, speed = float(rng.uniform(0.02, 0.08)), float(rng.uniform(5, 40))
    frame = int(rng.integers(2, FRAMES - 1))
    time = (np.arange(FRAMES) - frame + float(rng.uniform(0.2, 0.8))) / FPS
    rise = float(rng.uniform(0.2, 1.0))
    # While the ball is under the gate its lower edge stands at least the clearance above the ball.
    under = (radius + 0.02) / speed
    edge = radius + magnitude + rise * (time + under)
    lift = np.column_stack([0 * time, 0 * time, 0.5 + edge])
    flight = Track(np.outer(time, [speed, 0, 0]), velocity=(speed, 0, 0))
    things = {"gate": sw.box(0.02, 1, 1, motion="kinematic"), "ball": ball(radius, motion="dynamic")}
    early = time < -under
    lift[early, 2] = np.maximum(lift[early, 2], -10.0)
    spec = sw.world(things, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, {"gate": Track(lift, velocity=(0, 0, rise)), "ball": flight}))


def linked_rings(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two linked rings swing through each other's holes without touching. Magnitude: turn per frame [rad]."""
    major, minor = 0.5, float(rng.uniform(0.05, 0.12))
    ring = torus(major, minor)
    things = {n: mesh_entity(ring, motion="dynamic") for n in ("a", "b")}
    angle = magnitude * np.arange(FRAMES)
    flat = turn_of((0, 0, 1), angle)
    upright = turn_of((1, 0, 0), math.pi / 2)[0]
    first = Track(np.zeros((FRAMES, 3)), flat, spin=(0, 0, magnitude * FPS))
    second = Track(np.tile([major, 0, 0], (FRAMES, 1)), upright)
    spec = sw.world(things, frames=FRAMES, gravity=(0, 0, 0))
    return World(candidate_of(folder, spec, {"a": first, "b": second}))


def bowl_and_ball(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball rolls in a thin bowl, inside its box and its hull. Magnitude: gap [m]."""
    inner, wall, sections = 0.5, float(rng.uniform(0.01, 0.05)), 16
    radius = float(rng.uniform(0.03, 0.15))
    # Facets of the bowl stand inside its sphere: by the sagitta of both its divisions.
    clear = inner * math.cos(math.pi / sections) * math.cos(math.pi / 24)
    angle = 1.1 * np.sin(np.arange(FRAMES) / 3.0 + rng.uniform(0, 6))
    rate = 1.1 * np.cos(np.arange(FRAMES) / 3.0 + 0.0) * FPS / 3.0
    reach = clear - radius - magnitude
    around = float(rng.uniform(0, 6))
    way = np.array([math.cos(around), math.sin(around), 0.0])
    track = reach * (np.sin(angle)[:, None] * way - np.cos(angle)[:, None] * np.array([0, 0, 1.0]))
    velocity = np.gradient(track, 1 / FPS, axis=0)
    axis = np.cross(way, [0, 0, 1.0])
    turn = turn_of(axis, -angle * reach / radius)
    things = {"bowl": mesh_entity(bowl(inner, wall, sections), keep_origin=True), "ball": ball(radius, motion="dynamic")}
    path = Track(track, turn, velocity, -rate[:, None] * reach / radius * axis)
    return World(candidate_of(folder, sw.world(things, frames=FRAMES), {"ball": path}))


def crate_with_content(folder: Path, magnitude: float, rng: Rng) -> World:
    """A block lies in an open crate that fits it closely; the crate is carried along. Magnitude: play [m]."""
    size = rng.uniform(0.1, 0.4, 3)
    box = sw.entity(*crate(size + np.array([2 * magnitude, 2 * magnitude, 0]), 0.02), motion="kinematic")
    block = sw.box(*map(float, size), motion="dynamic")
    angle = np.linspace(0, float(rng.uniform(0.5, 6)), FRAMES)
    where = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle), 0.1 * angle])
    turn = turn_of((0, 0, 1), angle)
    rate = (angle[1] - angle[0]) * FPS
    velocity = np.column_stack([-2 * np.sin(angle), 2 * np.cos(angle), np.full(FRAMES, 0.1)]) * rate
    spec = sw.world({"crate": box, "block": block}, frames=FRAMES)
    paths = {
        "crate": Track(where, turn, velocity, (0, 0, rate)),
        "block": Track(where + np.array([0, 0, size[2] / 2]), turn, velocity, (0, 0, rate)),
    }
    return World(candidate_of(folder, spec, paths))


def turntable(folder: Path, magnitude: float, rng: Rng) -> World:
    """Blocks ride on a fast turntable with no gap. Magnitude: rate [rad/s]."""
    disc = sw.entity(Cylinder(radius=1.0, height=0.1), motion="kinematic", at=(0, 0, -0.05))
    things, paths = {"disc": disc}, {}
    angle = magnitude * np.arange(FRAMES) / FPS
    rate = np.full(FRAMES, magnitude)
    paths["disc"] = about((0, 0, 1), angle, rate, (0, 0, -0.05), (0, 0, 0))
    for k in range(3):
        side = float(rng.uniform(0.05, 0.2))
        place = 2.1 * k + rng.uniform(0, 1)
        things[f"rider{k}"] = sw.box(side, side, side, motion="dynamic")
        paths[f"rider{k}"] = about((0, 0, 1), angle, rate, (0, 0, 0), (0.7 * math.cos(place), 0.7 * math.sin(place), side / 2))
    return World(candidate_of(folder, sw.world(things, frames=FRAMES), paths))


def fastened(folder: Path, magnitude: float, rng: Rng) -> World:
    """A jointed arm turns in its post by as much as the relation declares. Magnitude: share of the declared depth."""
    depth = float(rng.uniform(0.01, 0.04))
    post, arm = sw.box(0.1, 0.1, 1.0, at=(0, 0, 0.5)), sw.box(0.4, 0.05, 0.05, motion="dynamic")
    sunk = depth * magnitude
    spec = sw.world(
        {"post": post, "arm": arm},
        frames=FRAMES,
        joints={"h": HingeJoint(parent="post", child="arm", anchor=(0, 0, 0.5), axis=(1, 0, 0))},
        relations={"f": Fastened(a="post", b="arm", max_depth=depth, reason="the arm is set into the post")},
    )
    rate = float(rng.uniform(1, 30))
    path = about((1, 0, 0), rate * np.arange(FRAMES) / FPS, np.full(FRAMES, rate), (0.25 - sunk, 0, 0.5), (0, 0, 0))
    return World(candidate_of(folder, spec, {"arm": path}))


def flush_pieces(folder: Path, magnitude: float, rng: Rng) -> World:
    """Bodies of one entity lie flush against each other and part. Magnitude: speed of parting [m/s]."""
    side = float(rng.uniform(0.1, 0.4))
    parts = [Part(shape=Box(size=(side,) * 3), pose=sw.pose((side * k, 0, 0))) for k in range(3)]
    whole = sw.entity(*parts, motion="dynamic", at=(0, 0, 2))
    spec = sw.world({"ground": sw.ground(), "body": whole}, frames=FRAMES, gravity=(0, 0, 0))
    path = still((2 * side, 0, 2))
    path.position[:, 0] += magnitude * np.arange(FRAMES) / FPS
    path.velocity[:, 0] = magnitude
    return World(candidate_of(folder, spec, {"body/p2": path}, built={"body": pieces("body", whole, spec)}))


def rope_in_a_bight(folder: Path, magnitude: float, rng: Rng) -> World:
    """A rope whose neighbours overlap at their round ends lies close to itself. Magnitude: gap / radius."""
    radius, count = float(rng.uniform(0.01, 0.02)), 8
    rope = sw.entity(rope=Rope(points=[(0, 0, 0), (1, 0, 0)], radius=radius, segments=count), motion="dynamic", at=(0, 0, 1))
    paths = {}
    step, gap = 1 / count, radius * (2 + magnitude)
    # Three segments forth, two across, three back beside the first ones.
    bend = math.asin(min(1.0, gap / (2 * step)))
    knots = [(k * step, 0.0) for k in range(4)]
    middle = (knots[-1][0] + step * math.cos(bend), gap / 2)
    knots += [middle, (knots[3][0], gap)] + [(knots[3][0] - k * step, gap) for k in (1, 2, 3)]
    for k in range(count):
        (x0, y0), (x1, y1) = knots[k], knots[k + 1]
        along = np.array([x1 - x0, y1 - y0, 0.0])
        across = np.cross([0, 0, 1.0], along / np.linalg.norm(along))
        paths[f"rope/s{k}"] = Track(np.tile([(x0 + x1) / 2, (y0 + y1) / 2, 1.0], (FRAMES, 1)), turn_of(across, math.pi / 2))
    spec = sw.world(
        {"ground": sw.ground(), "rope": rope},
        frames=FRAMES,
    )
    return World(candidate_of(folder, spec, paths))

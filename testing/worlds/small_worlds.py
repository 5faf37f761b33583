"""Small worlds for tests and seeded defects: short specifications, their geometry, and caches written by hand.

Geometry is made here and not by `construction`, so that a verifier's test does not depend on the code it judges.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from ...worlds.arrays import F64, RigidPose, compose, pose_of, rotation_matrix
from ...worlds.built import BuiltBody, BuiltEntity, BuiltPart, Convex, TriangleMesh
from ...worlds.cache import Cache, CacheIndex, write_container
from ...worlds.candidate import Candidate, Stage
from ...worlds.spec import (
    Beat,
    Box,
    Capsule,
    Cylinder,
    Dimensions,
    Entity,
    Extrusion,
    HeightField,
    Limits,
    Material,
    Mesh,
    Part,
    Pose,
    RigidInstance,
    RigidPhysics,
    RigidSettings,
    Rope,
    SceneGraph,
    Shape,
    SimulationPlan,
    Sphere,
    Story,
    Wedge,
    WorldSpec,
)
from ...worlds.vocabulary import SpecModel

IDENTITY = (1.0, 0.0, 0.0, 0.0)
MATERIALS = {"wood": Material(density=600.0, friction=0.5, restitution=0.2, substance="wood")}
Track = tuple[Any, Any]
"""Positions, shape (frames, 3) or (3,), and quaternions, shape (frames, 4) or (4,)."""


@dataclass(frozen=True)
class Event:
    """A contact begins; it is written into the first frame at or after `time`."""

    time: float
    a: str
    b: str
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    speed: float = 1.0
    impulse: float = 1.0


@dataclass(frozen=True)
class Touch:
    """A pair that touched since the last frame."""

    frame: int
    a: str
    b: str
    impulse: float = 1.0
    """Normal [N s], along Z: b is pushed up."""
    max_force: float = 1.0
    min_gap: float = 0.0


def pose(position: Sequence[float] = (0, 0, 0), *, euler: Sequence[float] | None = None) -> Pose:
    """A specified pose."""
    return Pose(position=tuple(position), euler=None if euler is None else tuple(euler))


def entity(
    *shapes: Shape | Part,
    motion: str = "static",
    at: Sequence[float] = (0, 0, 0),
    euler: Sequence[float] | None = None,
    size: Sequence[float] | None = None,
    tolerance: float = 0.01,
    velocity: Sequence[float] = (0, 0, 0),
    rope: Rope | None = None,
    **more: Any,
) -> Entity:
    """An entity of one or several shapes (parts `p0`, `p1`, ...); `size` defaults to what the shapes measure."""
    parts = {f"p{i}": s if isinstance(s, Part) else Part(shape=s) for i, s in enumerate(shapes)}
    if size is None:
        corners = [v for p in parts.values() for v in pose_of(p.pose).apply(mesh_of(p.shape).vertices)]
        corners += [np.array(p) + s * rope.radius for p in rope.points for s in (-1.0, 1.0)] if rope else []
        size = np.maximum(np.ptp(np.array(corners), axis=0), 1e-6)
    return Entity(
        role="test object",
        motion=motion,
        physics=more.pop("physics", None) or RigidPhysics(linear_velocity=tuple(velocity)),
        dimensions=Dimensions(size=tuple(float(s) for s in size), tolerance=tolerance),
        pose=pose(at, euler=euler),
        material=more.pop("material", "wood"),
        parts=parts,
        generator=rope,
        **more,
    )


def box(*size: float, **more: Any) -> Entity:
    """A box entity of full extents `size`."""
    return entity(Box(size=size), **more)


def ball(radius: float, **more: Any) -> Entity:
    """A ball entity."""
    return entity(Sphere(radius=radius), size=(2 * radius,) * 3, **more)


def ground(extent: float = 10.0, thickness: float = 0.2) -> Entity:
    """A static slab whose top is z = 0."""
    return box(extent, extent, thickness, at=(0, 0, -thickness / 2))


def world(
    entities: Mapping[str, Entity],
    *,
    relations: Mapping[str, SpecModel] | None = None,
    regions: Mapping[str, SpecModel] | None = None,
    beats: Mapping[str, Beat] | None = None,
    joints: Mapping[str, SpecModel] | None = None,
    drivers: Mapping[str, SpecModel] | None = None,
    materials: Mapping[str, Material] | None = None,
    settings: RigidSettings | None = None,
    limits: Limits | None = None,
    frames: int = 24,
    fps: int = 24,
    preroll: float = 0.0,
    gravity: Sequence[float] = (0.0, 0.0, -9.81),
    **more: Any,
) -> WorldSpec:
    """A specification with one solver instance `rigid` that owns every entity; `more` goes to `WorldSpec`."""
    return WorldSpec(
        title="test",
        prompt="A test world.",
        story=more.pop("story", Story(beats=dict(beats or {}))),
        materials=dict(materials or MATERIALS),
        entities=dict(entities),
        graph=SceneGraph(regions=dict(regions or {}), relations=dict(relations or {})),
        simulation=SimulationPlan(
            fps=fps,
            frames=frames,
            preroll=preroll,
            gravity=tuple(gravity),
            solvers={"rigid": RigidInstance(engine="mujoco", members=list(entities), settings=settings or RigidSettings())}
            if entities
            else {},
            joints=dict(joints or {}),
            drivers=dict(drivers or {}),
            limits=limits or Limits(),
        ),
        **more,
    )


def mesh_of(shape: Shape) -> TriangleMesh:
    """Visible surface of a shape, outward normals."""
    made: Any
    if isinstance(shape, Box):
        made = trimesh.creation.box(extents=shape.size)
    elif isinstance(shape, Sphere):
        made = trimesh.creation.icosphere(subdivisions=3, radius=shape.radius)
    elif isinstance(shape, Cylinder):
        made = trimesh.creation.cylinder(radius=shape.radius, height=shape.height, sections=32)
    elif isinstance(shape, Capsule):
        made = trimesh.creation.capsule(radius=shape.radius, height=shape.length, count=[16, 16])
        made.apply_translation([0, 0, -made.bounds.mean(axis=0)[2]])
    elif isinstance(shape, Wedge):
        x, y, z = (s / 2 for s in shape.size)
        corners = np.array([[-x, -y, -z], [x, -y, -z], [-x, -y, z], [-x, y, -z], [x, y, -z], [-x, y, z]])
        faces = [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [0, 2, 5], [0, 5, 3], [1, 4, 5], [1, 5, 2]]
        made = trimesh.Trimesh(corners, faces, process=False)
    elif isinstance(shape, Extrusion):
        made = _extrusion(shape)
    elif isinstance(shape, Mesh) and shape.vertices is not None and shape.faces is not None:
        made = trimesh.Trimesh(np.array(shape.vertices) * shape.scale, np.array(shape.faces), process=False)
    elif isinstance(shape, HeightField):
        made = _heightfield(shape)
    else:
        raise NotImplementedError(f"testing/worlds/small_worlds.py has no mesh for {shape.kind!r}")
    return TriangleMesh(np.array(made.vertices, dtype=np.float64), np.array(made.faces, dtype=np.int32))


def _extrusion(shape: Extrusion) -> Any:
    """Ear clipping of the polygon, then walls."""
    polygon = np.array(shape.polygon)
    left = list(range(len(polygon)))
    triangles: list[list[int]] = []

    def cross(a: Any, b: Any, c: Any) -> float:
        return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    while len(left) > 3:
        for k in range(len(left)):
            i, j, m = left[k - 1], left[k], left[(k + 1) % len(left)]
            a, b, c = polygon[i], polygon[j], polygon[m]
            others = [polygon[o] for o in left if o not in (i, j, m)]
            if cross(a, b, c) > 0 and not any(
                cross(a, b, p) >= 0 and cross(b, c, p) >= 0 and cross(c, a, p) >= 0 for p in others
            ):
                triangles.append([i, j, m])
                left.pop(k)
                break
        else:
            raise ValueError("polygon is not simple and counter-clockwise")
    triangles.append(left)
    n, h = len(polygon), shape.height / 2
    vertices = np.concatenate([np.column_stack([polygon, np.full(n, z)]) for z in (-h, h)])
    faces = [[c, b, a] for a, b, c in triangles] + [[a + n, b + n, c + n] for a, b, c in triangles]
    for i in range(n):
        j = (i + 1) % n
        faces += [[i, j, j + n], [i, j + n, i + n]]
    return trimesh.Trimesh(vertices, faces, process=False)


def _heightfield(shape: HeightField) -> Any:
    """Top surface, vertical skirt and flat bottom."""
    heights = np.array(shape.heights)
    rows, cols = heights.shape
    x, y = np.linspace(-shape.size[0] / 2, shape.size[0] / 2, cols), np.linspace(-shape.size[1] / 2, shape.size[1] / 2, rows)
    gx, gy = np.meshgrid(x, y)
    floor = np.full_like(heights, heights.min() - shape.base)
    vertices = np.concatenate([np.stack([gx, gy, z], axis=-1).reshape(-1, 3) for z in (heights, floor)])
    n, faces = rows * cols, []
    for r in range(rows - 1):
        for c in range(cols - 1):
            a, b, d, e = r * cols + c, r * cols + c + 1, (r + 1) * cols + c, (r + 1) * cols + c + 1
            faces += [[a, b, e], [a, e, d], [a + n, e + n, b + n], [a + n, d + n, e + n]]
    rim = list(range(cols)) + [r * cols + cols - 1 for r in range(1, rows)]
    rim += [(rows - 1) * cols + c for c in range(cols - 2, -1, -1)] + [r * cols for r in range(rows - 2, 0, -1)]
    for i, j in zip(rim, rim[1:] + rim[:1], strict=True):
        faces += [[j, i, i + n], [j, i + n, j + n]]
    return trimesh.Trimesh(vertices, faces, process=False)


def _convex(shape: Shape, mesh: TriangleMesh, placed: RigidPose) -> Convex:
    nothing = np.zeros((0, 3))
    if isinstance(shape, Box):
        return Convex("box", tuple(s / 2 for s in shape.size), placed, nothing)
    if isinstance(shape, Sphere):
        return Convex("sphere", (shape.radius,), placed, nothing)
    if isinstance(shape, Cylinder):
        return Convex("cylinder", (shape.radius, shape.height / 2), placed, nothing)
    if isinstance(shape, Capsule):
        return Convex("capsule", (shape.radius, shape.length / 2), placed, nothing)
    return Convex("hull", (), placed, mesh.vertices)


def _mass(meshes: Iterable[tuple[TriangleMesh, float]]) -> tuple[float, F64, F64, float]:
    """Mass, centre, inertia and volume of solid meshes with densities."""
    parts = []
    for mesh, density in meshes:
        solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        solid.density = density
        parts.append((solid.mass, np.array(solid.center_mass), np.array(solid.moment_inertia), solid.volume))
    mass = sum(p[0] for p in parts)
    center = sum((p[0] * p[1] for p in parts), start=np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for m, c, i, _ in parts:
        d = c - center
        inertia += i + m * (d @ d * np.eye(3) - np.outer(d, d))
    return float(mass), center, inertia, float(sum(p[3] for p in parts))


def build(spec: WorldSpec, entity_id: str) -> BuiltEntity:
    """Geometry of one entity of the specification."""
    contract = spec.entities[entity_id]
    if contract.generator is not None:
        return _build_rope(spec, entity_id, contract.generator)
    if contract.physics.category == "cloth":
        from ...construction.sheets import build_cloth

        return build_cloth(spec, entity_id, contract, Path(), "")
    parts, weighed = [], []
    for name, part in contract.parts.items():
        mesh, placed = mesh_of(part.shape), pose_of(part.pose)
        render = TriangleMesh(placed.apply(mesh.vertices), mesh.faces)
        material = part.material or contract.material
        collision = (_convex(part.shape, mesh, placed),) if part.collides else ()
        smooth = isinstance(part.shape, Sphere | Cylinder | Capsule)
        parts.append(BuiltPart(name, "body", material, render, collision, True, (0.0, 0.0), smooth))
        weighed.append((render, spec.materials[material].density))
    mass, center, inertia, volume = _mass(weighed)
    physics = contract.physics
    if isinstance(physics, RigidPhysics) and physics.mass is not None:
        inertia, mass = inertia * physics.mass / mass, physics.mass
    body = BuiltBody("body", RigidPose(np.zeros(3), np.array(IDENTITY)), mass, center, inertia, volume)
    return BuiltEntity(entity_id, (body,), tuple(parts), "test")


def _build_rope(spec: WorldSpec, entity_id: str, rope: Rope) -> BuiltEntity:
    """A straight chain of capsules `s0`, `s1`, ... from the first to the last point."""
    start, end = np.array(rope.points[0]), np.array(rope.points[-1])
    axis = end - start
    length = float(np.linalg.norm(axis)) / rope.segments
    material = spec.entities[entity_id].material
    half = math.acos(max(-1.0, min(1.0, axis[2] / np.linalg.norm(axis)))) / 2
    turn = np.cross([0.0, 0.0, 1.0], axis)
    norm = np.linalg.norm(turn)
    turn = turn / norm if norm > 1e-12 else np.array([1.0, 0.0, 0.0])
    quaternion = np.array([math.cos(half), *(math.sin(half) * turn)])
    shape = Capsule(radius=rope.radius, length=length)
    mesh = mesh_of(shape)
    mass, center, inertia, volume = _mass([(mesh, spec.materials[material].density)])
    bodies, parts = [], []
    for i in range(rope.segments):
        middle = start + axis * (i + 0.5) / rope.segments
        bodies.append(BuiltBody(f"s{i}", RigidPose(middle, quaternion), mass, center, inertia, volume))
        piece = Convex("capsule", (rope.radius, length / 2), RigidPose(np.zeros(3), np.array(IDENTITY)), np.zeros((0, 3)))
        parts.append(BuiltPart(f"s{i}", f"s{i}", material, mesh, (piece,), True, (0.0, 0.0), True))
    return BuiltEntity(entity_id, tuple(bodies), tuple(parts), "test")


def build_all(spec: WorldSpec) -> dict[str, BuiltEntity]:
    """Geometry of every entity."""
    return {name: build(spec, name) for name in spec.entities}


def _derivative(positions: F64, fps: int) -> F64:
    return np.gradient(positions, 1.0 / fps, axis=0) if len(positions) > 1 else np.zeros_like(positions)


def _angular(quaternions: F64, fps: int) -> F64:
    """World angular velocity by central differences of the orientation."""
    turns = rotation_matrix(quaternions)
    if len(turns) < 2:
        return np.zeros((len(turns), 3))
    rate = np.gradient(turns, 1.0 / fps, axis=0) @ np.swapaxes(turns, -1, -2)
    return np.stack([rate[:, 2, 1] - rate[:, 1, 2], rate[:, 0, 2] - rate[:, 2, 0], rate[:, 1, 0] - rate[:, 0, 1]], axis=-1) / 2


def make_candidate(
    tmp_path: Path,
    spec: WorldSpec,
    *,
    tracks: Mapping[str, Track] | None = None,
    stage: Stage | None = None,
    events: Sequence[Event] = (),
    touches: Sequence[Touch] = (),
    records: Mapping[str, Any] | None = None,
    joints: Mapping[str, Any] | None = None,
    active: Mapping[str, Any] | None = None,
    asleep: Mapping[str, Any] | None = None,
    channels: Mapping[str, Any] | None = None,
    without: Iterable[str] = (),
    built: Mapping[str, BuiltEntity] | None = None,
    digest: str = "test",
) -> Candidate:
    """A candidate with hand-written caches.

    Args:
        tmp_path: the world folder.
        spec: the specification.
        tracks: body-frame motion per `entity` (its body `body`) or `entity/body`; moving entities without a track
            stay where the specification puts them. None makes a candidate of the static stage, without caches.
        stage: default `full` with tracks, `static` without.
        events: contact beginnings.
        touches: pairs that touched since the last frame.
        records: per quantity a number or an array of shape (frames,).
        joints: per hinge or slide its coordinate, a number or shape (frames,).
        active: per driver a flag or shape (frames,).
        asleep: per `entity` a flag or shape (frames,).
        channels: further channels (or replacements), shape (frames, ...).
        without: channels left out.
        built: replaces the geometry of single entities.
        digest: content digest of the caches.
    """
    geometry = {**build_all(spec), **(built or {})}
    if tracks is None:
        return Candidate(tmp_path, spec, geometry, stage or "static")
    plan = spec.simulation
    frames = plan.frames
    solids = [n for n, e in spec.entities.items() if e.physics.category != "liquid"]
    bodies = [f"{n}/{b.name}" for n in solids if spec.entities[n].motion != "static" for b in geometry[n].bodies]
    positions, quaternions = np.zeros((frames, len(bodies), 3)), np.zeros((frames, len(bodies), 4))
    velocity, spin = np.zeros((frames, len(bodies), 3)), np.zeros((frames, len(bodies), 3))
    unknown = set(tracks) - set(bodies) - {b.split("/")[0] for b in bodies}
    assert not unknown, f"tracks of bodies that do not move: {unknown}"
    for row, name in enumerate(bodies):
        owner, body_name = name.split("/")
        body = next(b for b in geometry[owner].bodies if b.name == body_name)
        start = compose(pose_of(spec.entities[owner].pose), body.pose)
        where, how = tracks.get(name) or tracks.get(owner) or start
        positions[:, row], quaternions[:, row] = np.asarray(where, dtype=float), np.asarray(how, dtype=float)
        centers = positions[:, row] + np.einsum("fij,j->fi", rotation_matrix(quaternions[:, row]), body.center)
        velocity[:, row], spin[:, row] = _derivative(centers, plan.fps), _angular(quaternions[:, row], plan.fps)
    colliders = tuple(solids)
    hinges = tuple(j for j, joint in plan.joints.items() if joint.kind in {"hinge", "slide"})
    drivers = tuple(n for n, d in plan.drivers.items() if d.kind not in ("inflow", "outflow", "waves"))
    per_frame: dict[str, Any] = {
        "position": positions,
        "quaternion": quaternions,
        "velocity": velocity,
        "angular_velocity": spin,
        "asleep": _columns([b.split("/")[0] for b in bodies], asleep, frames).astype(np.uint8),
        "joint": _columns(hinges, joints, frames),
        "driver/active": _columns(drivers, active, frames).astype(np.uint8),
    }
    for name, value in (records or {}).items():
        per_frame[f"record/{name}"] = np.broadcast_to(np.asarray(value, dtype=float), (frames,))
    per_frame |= dict(channels or {})
    folder = tmp_path / "cache" / "rigid"
    cache = Cache(folder)
    index = CacheIndex("rigid", "mujoco", plan.fps, frames, tuple(bodies), colliders, hinges, drivers, "test", {})
    cache.write_index(index)
    left_out, digests = set(without), []
    for k in range(frames):
        frame = {n: v[k] for n, v in per_frame.items()} | _contacts(k, plan.fps, colliders, events, touches)
        digests.append(write_container(cache.path(k), {n: v for n, v in frame.items() if n not in left_out}))
    (folder / "digests.txt").write_text("".join(f"{d}\n" for d in digests))
    return Candidate(tmp_path, spec, geometry, stage or "full", {"rigid": cache}, "cache/rigid", digest)


def _columns(names: Sequence[str], values: Mapping[str, Any] | None, frames: int) -> F64:
    table = np.zeros((frames, len(names)))
    for column, name in enumerate(names):
        table[:, column] = np.asarray((values or {}).get(name, 0.0), dtype=float)
    return table


def _contacts(
    frame: int, fps: int, colliders: Sequence[str], events: Sequence[Event], touches: Sequence[Touch]
) -> dict[str, Any]:
    def pair(a: str, b: str) -> list[int]:
        return sorted((colliders.index(a), colliders.index(b)))

    begun = sorted((e for e in events if max(0, math.ceil(e.time * fps - 1e-9)) == frame), key=lambda e: e.time)
    touched = [t for t in touches if t.frame == frame]
    return {
        "contact/pair": np.array([pair(t.a, t.b) for t in touched], dtype=np.int32).reshape(-1, 2),
        "contact/impulse": np.array([t.impulse for t in touched], dtype=np.float64),
        "contact/vector": np.array(
            [(0.0, 0.0, math.copysign(t.impulse, colliders.index(t.b) - colliders.index(t.a))) for t in touched], dtype=np.float64
        ).reshape(-1, 3),
        "contact/max_force": np.array([t.max_force for t in touched], dtype=np.float64),
        "contact/min_gap": np.array([t.min_gap for t in touched], dtype=np.float64),
        "event/time": np.array([e.time for e in begun], dtype=np.float64),
        "event/pair": np.array([pair(e.a, e.b) for e in begun], dtype=np.int32).reshape(-1, 2),
        "event/point": np.array([e.point for e in begun], dtype=np.float64).reshape(-1, 3),
        "event/speed": np.array([e.speed for e in begun], dtype=np.float64),
        "event/impulse": np.array([e.impulse for e in begun], dtype=np.float64),
        "impact/time": np.zeros(0),
        "impact/pair": np.zeros((0, 2), dtype=np.int32),
        "impact/turn": np.zeros(0, dtype=np.int32),
        "impact/normal": np.zeros((0, 3)),
        "impact/vector": np.zeros((0, 3)),
    }

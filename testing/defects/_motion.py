"""Motions for the seeded worlds of the contact check: tracks with exact velocities, noise of a pair, odd shapes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from ...worlds.arrays import F64, RigidPose, pose_of, rotation_matrix
from ...worlds.built import BuiltBody, BuiltEntity, BuiltPart
from ...worlds.candidate import Candidate
from ...worlds.spec import Box, Entity, Extrusion, Mesh, Part, WorldSpec
from ..worlds import small_worlds as sw

__all__ = [
    "FRAMES",
    "Track",
    "about",
    "ball",
    "bowl",
    "candidate_of",
    "crate",
    "diagonal",
    "eps_of",
    "mesh_entity",
    "pieces",
    "random_rotation",
    "rolled",
    "still",
    "torus",
    "turn_of",
]

FRAMES = 16
FPS = 24
EPS = 1e-9
"""The documented bound: query noise relative to the summed sizes of a pair (S1)."""


class Track:
    """Motion of one body: position, quaternion, velocity and spin at every frame."""

    def __init__(self, position: Any, quaternion: Any = sw.IDENTITY, velocity: Any = 0.0, spin: Any = 0.0) -> None:
        count = max([len(np.atleast_2d(x)) for x in (position, quaternion)])
        self.position = np.broadcast_to(np.asarray(position, dtype=float), (count, 3)).copy()
        self.quaternion = np.broadcast_to(np.asarray(quaternion, dtype=float), (count, 4)).copy()
        self.velocity = np.broadcast_to(np.asarray(velocity, dtype=float), (count, 3)).copy()
        self.spin = np.broadcast_to(np.asarray(spin, dtype=float), (count, 3)).copy()


def still(position: Sequence[float] | F64, frames: int = FRAMES) -> Track:
    """A body that rests."""
    return Track(np.tile(np.asarray(position, dtype=float), (frames, 1)))


def turn_of(axis: Sequence[float] | F64, angle: Any) -> F64:
    """Quaternions of rotations about an axis, shape (n, 4)."""
    angle = np.atleast_1d(np.asarray(angle, dtype=float))
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    return np.concatenate([np.cos(angle / 2)[:, None], np.sin(angle / 2)[:, None] * axis], axis=1)


def about(axis: Sequence[float], angle: F64, rate: Any, pivot: Sequence[float], arm: Sequence[float]) -> Track:
    """A body that turns about an axis through `pivot`; its frame stands at pivot + turned arm."""
    quaternion = turn_of(axis, angle)
    reach = rotation_matrix(quaternion) @ np.asarray(arm, dtype=float)
    spin = np.broadcast_to(np.asarray(rate, dtype=float), angle.shape)[:, None] * np.asarray(axis, dtype=float)
    return Track(np.asarray(pivot) + reach, quaternion, np.cross(spin, reach), spin)


def random_rotation(rng: np.random.Generator) -> F64:
    """A quaternion, uniform over rotations."""
    q = rng.normal(size=4)
    return np.asarray(q / np.linalg.norm(q))


def candidate_of(folder: Path, spec: WorldSpec, paths: Mapping[str, Track], **more: Any) -> Candidate:
    """A candidate with these motions and their velocities; what has no path rests where it is specified.

    Paths start at the body frame; frames must have their origin at the centre of mass, which velocities belong to.
    """
    built = {**sw.build_all(spec), **more.get("built", {})}
    names = [f"{n}/{b.name}" for n, e in spec.entities.items() if e.motion != "static" for b in built[n].bodies]
    velocity, spin = np.zeros((2, spec.simulation.frames, len(names), 3))
    for k, name in enumerate(names):
        path = paths.get(name, paths.get(name.split("/")[0]))
        if path is not None:
            velocity[:, k], spin[:, k] = path.velocity, path.spin
    channels = {"velocity": velocity, "angular_velocity": spin, **more.pop("channels", {})}
    tracks = {n: (p.position, p.quaternion) for n, p in paths.items()}
    return sw.make_candidate(folder, spec, tracks=tracks, channels=channels, **more)


def diagonal(entity: Entity) -> float:
    """Diagonal of the largest part of an entity [m]."""
    return max(float(np.linalg.norm(np.ptp(sw.mesh_of(p.shape).vertices, axis=0))) for p in entity.parts.values())


def eps_of(a: Entity, b: Entity, offset: float = 0.0) -> float:
    """Documented bound of overlap of a pair [m] (S1), `offset` [m] from the origin."""
    return EPS * (diagonal(a) + diagonal(b)) + 8.0 * float(np.finfo(float).eps) * offset


def mesh_entity(mesh: trimesh.Trimesh, **more: Any) -> Entity:
    """An entity with a written mesh, centred at its middle of mass."""
    vertices = np.asarray(mesh.vertices) - (0.0 if more.pop("keep_origin", False) else np.asarray(mesh.center_mass))
    shape = Mesh(vertices=[tuple(map(float, v)) for v in vertices], faces=[tuple(map(int, f)) for f in mesh.faces])
    return sw.entity(shape, **more)


def ball(radius: float, **more: Any) -> Entity:
    """A ball of 320 triangles: a quarter of those of a sphere, for the many queries of these worlds."""
    return mesh_entity(trimesh.creation.icosphere(subdivisions=2, radius=radius), keep_origin=True, **more)


def torus(major: float, minor: float) -> trimesh.Trimesh:
    """A ring about z."""
    return trimesh.creation.torus(major, minor, major_sections=16, minor_sections=6)


def bowl(inner: float, wall: float, sections: int = 16) -> trimesh.Trimesh:
    """Half a hollow ball, open upwards, its middle at the origin."""
    angles = np.linspace(0.0, math.pi / 2, 7)
    outside = np.stack([(inner + wall) * np.sin(angles), -(inner + wall) * np.cos(angles)], axis=1)
    inside = np.stack([inner * np.sin(angles), -inner * np.cos(angles)], axis=1)[::-1]
    profile = np.concatenate([outside, inside])
    profile[[0, -1], 0] = 0.0
    made = trimesh.creation.revolve(profile, sections=sections)
    if made.volume < 0:
        made.invert()
    return made


def rolled(folder: Path, radius: float, half: float, rng: np.random.Generator) -> Candidate:
    """A ball rolls at one height over a plate with a ditch across its way, and the two push each other all the time.

    Args:
        folder: the world folder.
        radius: of the ball [m].
        half: half the width of the ditch [m], which is as deep as the ball is high.
        rng: of its speed.
    """
    deep, wide = 2.0 * radius, half + 8.0 * radius
    plate = Extrusion(
        polygon=[
            (-wide, -2 * deep), (wide, -2 * deep), (wide, 0.0), (half, 0.0), (half, -deep), (-half, -deep), (-half, 0.0), (-wide, 0.0),
        ],
        height=1.0,
    )  # fmt: skip
    speed = float(rng.uniform(0.5, 1.5)) * half / (FRAMES / FPS)
    way = speed * (np.arange(FRAMES) - 0.5 * (FRAMES - 1)) / FPS
    position = np.column_stack([way, np.full(FRAMES, radius), np.zeros(FRAMES)])
    spin = np.array([0.0, 0.0, -speed / radius])
    path = Track(position, turn_of((0, 0, -1), way / radius), (speed, 0.0, 0.0), spin)
    things = {"plate": sw.entity(plate), "ball": ball(radius, motion="dynamic", at=tuple(map(float, position[0])))}
    spec = sw.world(things, frames=FRAMES, gravity=(0, -9.81, 0))
    weight = 9.81 * sw.build(spec, "ball").bodies[0].mass
    touches = [sw.Touch(k, "plate", "ball", weight / FPS) for k in range(1, FRAMES)]
    return candidate_of(folder, spec, {"ball": path}, touches=touches)


def crate(size: F64, wall: float) -> list[Any]:
    """Parts of an open box around a clear space of `size` [m], whose floor is z = 0 and whose middle is x = y = 0."""
    x, y, z = size
    places = [
        ((x + 2 * wall, y + 2 * wall, wall), (0, 0, -wall / 2)),
        ((wall, y + 2 * wall, z), ((x + wall) / 2, 0, z / 2)),
        ((wall, y + 2 * wall, z), (-(x + wall) / 2, 0, z / 2)),
        ((x, wall, z), (0, (y + wall) / 2, z / 2)),
        ((x, wall, z), (0, -(y + wall) / 2, z / 2)),
    ]
    return [Part(shape=Box(size=s), pose=sw.pose(p)) for s, p in places]


def pieces(name: str, entity: Entity, spec: WorldSpec) -> BuiltEntity:
    """The entity with every part as a body of its own, `p0`, `p1`, ..., each about its own middle."""
    bodies, parts = [], []
    for key, part in entity.parts.items():
        alone = sw.build(
            spec.model_copy(update={"entities": {name: entity.model_copy(update={"parts": {key: Part(shape=part.shape)}})}}),
            name,
        )
        body, only = alone.bodies[0], alone.parts[0]
        where = pose_of(part.pose)
        bodies.append(BuiltBody(key, RigidPose(*where), body.mass, body.center, body.inertia, body.volume))
        parts.append(BuiltPart(key, key, only.material, only.render, only.collision, True, (0.0, 0.0), only.smooth))
    return BuiltEntity(name, tuple(bodies), tuple(parts), "test")

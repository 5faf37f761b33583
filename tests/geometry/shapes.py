"""Random bodies, mostly not convex, and placements that are apart, touching, overlapping, contained or nested."""

from __future__ import annotations

import numpy as np
import trimesh
from worldagent.geometry import Solid
from worldagent.worlds.arrays import RigidPose, compose

from .meshes import hull, random_pose, solid_of

KINDS = ("torus", "ring", "ell", "star", "hollow", "twins", "bowl", "sheet", "hull", "box")
OPEN = ("bowl", "sheet")


def _ell(rng: np.random.Generator) -> trimesh.Trimesh:
    """An L-shaped bar: two boxes' union, as one extruded polygon."""
    x, y, h = rng.uniform(0.5, 1.2, 3)
    wide, high = rng.uniform(0.2, 0.8) * x, rng.uniform(0.2, 0.8) * y
    flat = np.array([(0, 0), (x, 0), (x, high), (wide, high), (wide, y), (0, y)]) - [x / 2, y / 2]
    n = len(flat)
    vertices = np.concatenate([np.c_[flat, np.full(n, -h / 2)], np.c_[flat, np.full(n, h / 2)]])
    cap = [(0, 1, 2), (0, 2, 3), (0, 3, 5), (3, 4, 5)]
    faces = [(c, b, a) for a, b, c in cap] + [(a + n, b + n, c + n) for a, b, c in cap]
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, j + n), (i, j + n, i + n)]
    return trimesh.Trimesh(vertices, faces, process=False)


def _star(rng: np.random.Generator, radius: float = 0.5) -> trimesh.Trimesh:
    ball = trimesh.creation.icosphere(subdivisions=1, radius=radius)
    ball.vertices *= rng.uniform(0.5, 1.3, (len(ball.vertices), 1))
    return ball


def random_shape(rng: np.random.Generator, kind: str) -> Solid:
    """One body of about 1 m."""
    if kind == "torus":
        made = trimesh.creation.torus(rng.uniform(0.3, 0.5), rng.uniform(0.08, 0.2), major_sections=8, minor_sections=6)
    elif kind == "ring":
        made = trimesh.creation.annulus(rng.uniform(0.2, 0.4), rng.uniform(0.5, 0.7), rng.uniform(0.1, 0.5), sections=8)
    elif kind == "ell":
        made = _ell(rng)
    elif kind == "star":
        made = _star(rng)
    elif kind == "hollow":
        inner = _star(rng, 0.25)
        inner.invert()
        made = trimesh.util.concatenate([trimesh.creation.icosphere(subdivisions=1, radius=0.8), inner])
    elif kind == "twins":
        made = trimesh.util.concatenate([_star(rng, 0.3), _star(rng, 0.3).apply_translation([0.9, 0, 0])])
    elif kind == "bowl":
        made = _star(rng)
        made.update_faces(made.triangles_center[:, 2] < 0.1)
        made.remove_unreferenced_vertices()
    elif kind == "sheet":
        x, y = np.meshgrid(np.linspace(-0.6, 0.6, 5), np.linspace(-0.6, 0.6, 5))
        k = np.arange(20).reshape(4, 5)[:, :4].reshape(-1)
        faces = np.concatenate([np.c_[k, k + 1, k + 6], np.c_[k, k + 6, k + 5]])
        made = trimesh.Trimesh(np.c_[x.ravel(), y.ravel(), rng.uniform(-0.1, 0.1, 25)], faces, process=False)
    elif kind == "hull":
        return hull(rng)
    else:
        made = trimesh.creation.box(rng.uniform(0.2, 1.2, 3))
    return solid_of(made, closed=kind not in OPEN)


def scaled(solid: Solid, factor: float) -> Solid:
    return Solid(solid.vertices * factor, solid.faces, solid.closed)


def random_pair(rng: np.random.Generator) -> tuple[Solid, RigidPose, Solid, RigidPose, str]:
    """Two bodies with their poses, carried about together, and which kinds they are."""
    first, second = rng.choice(KINDS, 2)
    a, b = random_shape(rng, first), random_shape(rng, second)
    spread = rng.choice([0.0, 0.1, 0.3, 0.6, 1.0, 1.5])
    if rng.random() < 0.3:
        # One much smaller than the other: contained, nested in a cavity, or hidden in a hole.
        a = scaled(a, rng.uniform(0.05, 0.3))
        spread *= 0.4
    world = random_pose(rng, 5.0)
    pose_a, pose_b = random_pose(rng, spread), random_pose(rng, 0.0)
    return a, compose(world, pose_a), b, compose(world, pose_b), f"{first}-{second}"

"""A lattice of bodies in constant touch range: meshes of at most 500 triangles, half of them not convex, and their motion."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..worlds.arrays import F64, I32, rotation_matrix
from ..worlds.built import TriangleMesh

__all__ = ["Lattice", "lattice"]

GAP = 1.5e-3
"""[m] Mean gap of neighbours' boxes."""
SWAY = 0.35e-3
"""[m] Amplitude of each body along either axis."""
ROCK = math.radians(0.15)
"""Amplitude of the rocking of bodies that cannot spin in their place."""
HALF = 0.075
"""[m] Half extent of a body along the axes of the lattice."""

Mesh = tuple[F64, I32]


class Lattice(NamedTuple):
    """Bodies in rows; each is near its neighbours to the left, right, front and back."""

    meshes: list[TriangleMesh]
    position: F64
    """[m], shape (bodies, frames, 3)."""
    quaternion: F64
    """Shape (bodies, frames, 4)."""


def sphere(radius: float, splits: int = 2) -> Mesh:
    """An icosahedron split `splits` times: 20 * 4**splits triangles."""
    g = (1.0 + math.sqrt(5.0)) / 2.0
    points: list[tuple[float, float, float]] = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    points += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8)]
    faces += [(3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    vertices, triangles = np.array(points, dtype=np.float64), np.array(faces, dtype=np.int32)
    for _ in range(splits):
        vertices, triangles = _split(vertices, triangles)
    return radius * vertices / np.linalg.norm(vertices, axis=1)[:, None], triangles


def _split(vertices: F64, triangles: I32) -> Mesh:
    """Each triangle into four by the middles of its sides."""
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, index = np.unique(sides, axis=0, return_inverse=True)
    a, b, c = triangles.T
    ab, bc, ca = (len(vertices) + index.reshape(-1, 3)).T
    parts = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    faces = np.concatenate([np.stack(p, axis=1) for p in parts]).astype(np.int32)
    return np.concatenate([vertices, vertices[unique].mean(axis=1)]), faces


def torus(outer: float, tube: float, around: int = 20, across: int = 12) -> Mesh:
    """A torus about z, reaching `outer` from its axis: 2 * around * across triangles."""
    u, v = np.meshgrid(np.arange(around) * 2 * math.pi / around, np.arange(across) * 2 * math.pi / across, indexing="ij")
    ring = outer - tube + tube * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), tube * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    n, m = (i + 1) % around, (j + 1) % across
    p, q, r, s = i * across + j, n * across + j, n * across + m, i * across + m
    return vertices, np.concatenate([np.stack([p, q, r], axis=1), np.stack([p, r, s], axis=1)]).astype(np.int32)


def profile(cells: set[tuple[int, int]], height: float, splits: int = 1) -> Mesh:
    """Unit cells of a grid, extruded and centred; every triangle split `splits` times.

    `cells` are those that are filled, as (column, row).
    """
    corners: dict[tuple[int, int, int], int] = {}
    faces: list[tuple[int, int, int]] = []

    def corner(x: int, y: int, z: int) -> int:
        return corners.setdefault((x, y, z), len(corners))

    def quad(*at: tuple[int, int, int]) -> None:
        a, b, c, d = (corner(*p) for p in at)
        faces.extend([(a, b, c), (a, c, d)])

    for x, y in sorted(cells):
        quad((x, y, 1), (x + 1, y, 1), (x + 1, y + 1, 1), (x, y + 1, 1))
        quad((x, y, 0), (x, y + 1, 0), (x + 1, y + 1, 0), (x + 1, y, 0))
        if (x - 1, y) not in cells:
            quad((x, y, 0), (x, y, 1), (x, y + 1, 1), (x, y + 1, 0))
        if (x + 1, y) not in cells:
            quad((x + 1, y, 0), (x + 1, y + 1, 0), (x + 1, y + 1, 1), (x + 1, y, 1))
        if (x, y - 1) not in cells:
            quad((x, y, 0), (x + 1, y, 0), (x + 1, y, 1), (x, y, 1))
        if (x, y + 1) not in cells:
            quad((x, y + 1, 0), (x, y + 1, 1), (x + 1, y + 1, 1), (x + 1, y + 1, 0))
    vertices, triangles = np.array(list(corners), dtype=np.float64), np.array(faces, dtype=np.int32)
    for _ in range(splits):
        vertices, triangles = _split(vertices, triangles)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return (vertices - 0.5 * (low + high)) / (high - low) * [2.0, 2.0, height], triangles


ELL = {(0, 0), (1, 0), (2, 0), (0, 1), (0, 2)}
CUP = {(0, 0), (1, 0), (2, 0), (0, 1), (2, 1)}
"""Cells of an L and of a U."""


def _body(kind: int, rng: np.random.Generator) -> tuple[Mesh, bool]:
    """One body of its own shape that fills its place in x and y, and whether it may turn freely there."""
    if kind == 0:
        vertices, faces = sphere(HALF)
        return (vertices @ rotation_matrix(_unit(rng.normal(size=4))).T, faces), True
    if kind == 1:
        return torus(HALF, HALF * rng.uniform(0.2, 0.4)), True
    vertices, faces = profile(ELL if kind == 2 else CUP, height=2.0 * rng.uniform(0.4, 1.2))
    return (vertices * HALF, faces), False


def _unit(vector: F64) -> F64:
    return np.asarray(vector / np.linalg.norm(vector))


def lattice(bodies: int, frames: int, fps: int, seed: int) -> Lattice:
    """Rows of spheres, tori, L and U bodies that sway, rock and turn between about 0.4 and 4 mm from their neighbours."""
    rng = np.random.default_rng(seed)
    columns = math.ceil(math.sqrt(bodies))
    time = np.arange(frames) / fps
    meshes: list[TriangleMesh] = []
    position, quaternion = np.zeros((bodies, frames, 3)), np.zeros((bodies, frames, 4))
    for k in range(bodies):
        kind = int(rng.integers(4))
        (vertices, faces), free = _body(kind, rng)
        meshes.append(TriangleMesh(vertices, faces))
        phase, pace = rng.uniform(0, 2 * math.pi, 3), rng.uniform(0.3, 1.5, 3)
        wave = np.sin(2 * math.pi * pace * time[:, None] + phase)
        row, column = divmod(k, columns)
        position[k] = np.array([column, row, 0.0]) * (2.0 * HALF + GAP) + wave * SWAY
        axis = _unit(rng.normal(size=3)) if kind == 0 else np.array([0.0, 0.0, 1.0])
        angle = 0.5 * (2 * math.pi * pace[2] * time if free else ROCK * wave[:, 2])
        quaternion[k, :, 0], quaternion[k, :, 1:] = np.cos(angle), np.sin(angle)[:, None] * axis
    return Lattice(meshes, position, quaternion)

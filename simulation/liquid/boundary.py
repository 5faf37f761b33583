"""Samples that stand for sheets in a particle liquid (Akinci et al. 2012), on the sheets themselves; solids are `solid_samples`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...worlds.arrays import F64, I32
from ...worlds.built import TriangleMesh

__all__ = ["Sampled", "sample_surface"]

DISTANCE = 0.55
"""Least distance of samples in spacings: with 0.8, particles passed between them under a quarter of a metre of water."""
CANDIDATES = 6.0
"""Candidates per square of the least distance."""
PLANE_SHARE = 0.711
"""Measured on a large plane: the volumes of its samples then sum to area times spacing, as those of a lattice plane do (0.7006)."""


@dataclass(frozen=True)
class Sampled:
    """Samples of one boundary in its own frame."""

    position: F64
    """(n, 3) [m]"""
    volume: F64
    """Volume of liquid that each sample stands for (n,) [m^3]."""
    face: I32
    """Face that each was made on (n,); with `weights` its place on a deforming mesh."""
    weights: F64
    """Barycentric coordinates (n, 3)."""


def sample_surface(
    mesh: TriangleMesh,
    spacing: float,
    *,
    seed: int = 0,
    lower: F64 | None = None,
    upper: F64 | None = None,
) -> Sampled:
    """Sample a surface evenly at about one spacing, equal seeds alike.

    Args:
        mesh: the surface.
        spacing: distance of liquid particles [m].
        seed: of the candidates.
        lower: only the part above this corner, in the mesh's frame.
        upper: and below this one.
    """
    corners = mesh.vertices[mesh.faces]
    face: I32 = np.arange(len(mesh.faces), dtype=np.int32)
    if lower is not None and upper is not None:
        near = (corners.max(axis=1) >= lower).all(axis=1) & (corners.min(axis=1) <= upper).all(axis=1)
        face = face[near]
    rng = np.random.default_rng(seed)
    face, weights = _candidates(corners, face, spacing, rng, lower, upper)
    surface = np.einsum("nk,nkd->nd", weights, corners[face])
    chosen = _thinned(surface, DISTANCE * spacing)
    return Sampled(surface[chosen], _volumes(surface[chosen], spacing), face[chosen].astype(np.int32), weights[chosen])


def _candidates(
    corners: F64, face: I32, spacing: float, rng: np.random.Generator, lower: F64 | None, upper: F64 | None
) -> tuple[I32, F64]:
    """Faces and barycentric coordinates of random points of even density; large faces are cut to the box first."""
    normal = np.cross(corners[face, 1] - corners[face, 0], corners[face, 2] - corners[face, 0])
    area = 0.5 * np.linalg.norm(normal, axis=1)
    wanted = area * CANDIDATES / (DISTANCE * spacing) ** 2
    if lower is None or upper is None or wanted.sum() < 1e6:
        number = np.floor(wanted + rng.random(len(wanted))).astype(int)
        which = np.repeat(face, number)
        a, b = rng.random((2, len(which)))
        over = a + b > 1
        a[over], b[over] = 1 - a[over], 1 - b[over]
        weights = np.stack([1 - a - b, a, b], axis=1)
        if lower is not None and upper is not None and len(which):
            point = np.einsum("nk,nkd->nd", weights, corners[which])
            inside = ((point >= lower) & (point <= upper)).all(axis=1)
            which, weights = which[inside], weights[inside]
        return which, weights
    found_face: list[I32] = []
    found_weights: list[F64] = []
    for f in face:
        one_face, one_weights = _in_box(corners[f], f, spacing, rng, lower, upper)
        found_face.append(one_face)
        found_weights.append(one_weights)
    return np.concatenate(found_face), np.concatenate(found_weights)


def _in_box(corner: F64, face: int, spacing: float, rng: np.random.Generator, lower: F64, upper: F64) -> tuple[I32, F64]:
    """Random points of even density on the part of one triangle inside a box: the box is projected along the normal's axis."""
    edge1, edge2 = corner[1] - corner[0], corner[2] - corner[0]
    normal = np.cross(edge1, edge2)
    size = np.linalg.norm(normal)
    if size == 0:
        return np.zeros(0, dtype=np.int32), np.zeros((0, 3))
    axis = int(np.argmax(np.abs(normal)))
    flat = [k for k in range(3) if k != axis]
    low = np.maximum(corner.min(axis=0), lower)[flat]
    high = np.minimum(corner.max(axis=0), upper)[flat]
    wanted = np.prod(np.maximum(high - low, 0)) * size / abs(normal[axis]) * CANDIDATES / (DISTANCE * spacing) ** 2
    number = int(np.floor(wanted + rng.random()))
    place = low + (high - low) * rng.random((number, 2))
    system = np.stack([edge1[flat], edge2[flat]], axis=1)
    b = np.linalg.solve(system, (place - corner[0][flat]).T).T
    weights = np.column_stack([1 - b.sum(axis=1), b])
    point = weights @ corner
    inside = (weights >= 0).all(axis=1) & ((point >= lower) & (point <= upper)).all(axis=1)
    return np.full(int(inside.sum()), face, dtype=np.int32), weights[inside]


def _thinned(point: F64, distance: float) -> I32:
    """Indices of a largest set of points, in their given order, that keeps a distance (Poisson disks)."""
    from scipy.spatial import cKDTree

    if not len(point):
        return np.zeros(0, dtype=np.int32)
    pair = cKDTree(point).query_pairs(distance, output_type="ndarray")
    first, second = pair.min(axis=1), pair.max(axis=1)
    undecided = np.ones(len(point), dtype=bool)
    chosen = np.zeros(len(point), dtype=bool)
    while undecided.any():
        live = undecided[first] & undecided[second]
        first, second = first[live], second[live]
        behind = np.zeros(len(point), dtype=bool)
        behind[second] = True
        won = undecided & ~behind
        chosen |= won
        undecided &= ~won
        undecided[second[won[first]]] = False
    return np.flatnonzero(chosen).astype(np.int32)


def _volumes(point: F64, spacing: float) -> F64:
    """V = share / sum of W over the body's own samples."""
    from scipy.spatial import cKDTree

    h = 2.0 * spacing
    if not len(point):
        return np.zeros(0)
    pair = cKDTree(point).query_pairs(h, output_type="ndarray")
    q = np.linalg.norm(point[pair[:, 0]] - point[pair[:, 1]], axis=1) / h
    w = np.where(q < 0.5, 6 * (q**3 - q**2) + 1, 2 * (1 - np.minimum(q, 1)) ** 3)
    total = np.ones(len(point))
    np.add.at(total, pair[:, 0], w)
    np.add.at(total, pair[:, 1], w)
    return PLANE_SHARE * np.pi * h**3 / 8 / total

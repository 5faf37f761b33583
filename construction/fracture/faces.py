"""Faces that convex hulls share, and the bonds over them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.bonds import WORLD, Bonds
from .polyhedra import Facet, facets_of, overlap

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...worlds.spec import Breakable

__all__ = ["Face", "bonds_of", "shared_faces"]

TOUCH = 1e-7
"""Planes of two facets this close, relative to the body's size, count as one."""
LEAST_FACE = 1e-6
"""Faces below this share of the smaller hull's surface are rounding, not faces."""


class Face(NamedTuple):
    """One face that two hulls share, or that a hull shares with a side of the body's box."""

    first: int
    second: int
    """Index of the other hull; `WORLD` for a side."""
    normal: F64
    """From the first to the second, shape (3,)."""
    corners: F64
    """In order around the face [m], shape (k, 3)."""


def _axes(normal: F64) -> F64:
    """Two unit vectors across a normal, shape (2, 3)."""
    first = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])


def _area(polygon: F64) -> float:
    """Area of a polygon in its plane, shape (k, 2) [m^2]; positive counter-clockwise."""
    ahead = np.roll(polygon, -1, axis=0)
    return float((polygon[:, 0] * ahead[:, 1] - polygon[:, 1] * ahead[:, 0]).sum() / 2)


def _meet(a: Facet, b: Facet) -> F64 | None:
    """Corners of the face that two opposite facets of one plane share, shape (k, 3)."""
    axes = _axes(a.normal)
    origin = a.corners[0]
    mine, other = (a.corners - origin) @ axes.T, (b.corners[::-1] - origin) @ axes.T
    common = overlap(mine, other)
    if len(common) < 3 or _area(common) <= LEAST_FACE * min(_area(mine), _area(other)):
        return None
    return np.asarray(origin + common @ axes)


def shared_faces(hulls: Sequence[F64], size: float) -> list[Face]:
    """Faces between convex hulls, given by their corners, shape (n, 3) each.

    Args:
        hulls: corners of each.
        size: diagonal of the whole body [m].
    """
    facets = [facets_of(h) for h in hulls]
    low, high = np.array([h.min(axis=0) for h in hulls]), np.array([h.max(axis=0) for h in hulls])
    slack = TOUCH * size
    normals = [np.array([f.normal for f in own]) for own in facets]
    offsets = [np.array([f.offset for f in own]) for own in facets]
    found = []
    for i in range(len(hulls)):
        near = (low[i + 1 :] <= high[i] + slack).all(axis=1) & (high[i + 1 :] >= low[i] - slack).all(axis=1)
        for j in (np.flatnonzero(near) + i + 1).tolist():
            opposite = normals[i] @ normals[j].T < -1 + 1e-8
            level = np.abs(offsets[i][:, None] + offsets[j][None]) < slack
            for a, b in np.argwhere(opposite & level).tolist():
                corners = _meet(facets[i][a], facets[j][b])
                if corners is not None:
                    found.append(Face(i, j, facets[i][a].normal, corners))
    return found


def side_faces(hulls: Sequence[F64], sides: Sequence[str], low: F64, high: F64) -> list[Face]:
    """Faces of hulls on sides of the body's box."""
    slack = TOUCH * float(np.linalg.norm(high - low))
    found = []
    for side in sides:
        axis, up = "xyz".index(side[0]), side[1] == "+"
        normal = np.eye(3)[axis] * (1.0 if up else -1.0)
        level = float(high[axis]) if up else -float(low[axis])
        for i, hull in enumerate(hulls):
            if abs(float((hull @ normal).max()) - level) > slack:
                continue
            flat = [f for f in facets_of(hull) if f.normal @ normal > 1 - 1e-8 and abs(f.offset - level) < slack]
            found += [Face(i, WORLD, normal, f.corners) for f in flat]
    return found


class _Section(NamedTuple):
    area: float
    point: F64
    frame: F64
    second: F64
    corners: F64


def _section(face: Face) -> _Section:
    """Area, centroid, principal axes and second moments of a face."""
    axes = _axes(face.normal)
    origin = face.corners.mean(axis=0)
    flat = (face.corners - origin) @ axes.T
    if _area(flat) < 0:
        flat = flat[::-1]
    ahead = np.roll(flat, -1, axis=0)
    cross = flat[:, 0] * ahead[:, 1] - flat[:, 1] * ahead[:, 0]
    area = float(cross.sum() / 2)
    middle = ((flat + ahead) * cross[:, None]).sum(axis=0) / (6 * area)
    p, q = flat - middle, ahead - middle
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    moment = np.zeros((2, 2))
    for i in range(2):
        for j in range(2):
            terms = 2 * p[:, i] * p[:, j] + p[:, i] * q[:, j] + q[:, i] * p[:, j] + 2 * q[:, i] * q[:, j]
            moment[i, j] = float((cross * terms).sum()) / 24
    values, turn = np.linalg.eigh(moment)
    if np.linalg.det(turn) < 0:
        turn[:, 1] = -turn[:, 1]
    # Second moment about an axis counts distances along the other one.
    return _Section(
        area, origin + middle @ axes, np.concatenate([face.normal[None], turn.T @ axes]), values[::-1].copy(), p @ turn
    )


def bonds_of(faces: Sequence[Face], owner: Sequence[int], centers: F64, breakable: Breakable) -> Bonds:
    """Bonds over faces between different pieces.

    Args:
        faces: of hulls.
        owner: piece of each hull.
        centers: centres of mass of the pieces [m], shape (n, 3).
        breakable: tells how the strength depends on direction.
    """
    kept = [f for f in faces if f.second == WORLD or owner[f.first] != owner[f.second]]
    kept = [f if f.second == WORLD or owner[f.first] < owner[f.second] else _turned(f) for f in kept]
    sections = [_section(f) for f in kept]
    most = max((len(s.corners) for s in sections), default=1)
    pieces = np.array([(owner[f.first], WORLD if f.second == WORLD else owner[f.second]) for f in kept], dtype=np.int32)
    lengths = []
    for face, section in zip(kept, sections, strict=True):
        one = centers[owner[face.first]]
        other = 2 * section.point - one if face.second == WORLD else centers[owner[face.second]]
        lengths.append(max(abs(float((other - one) @ face.normal)), 1e-3 * float(np.sqrt(section.area))))
    factor = np.ones(len(kept))
    if breakable.pattern.kind == "wood":
        grain = np.array(breakable.pattern.grain) / np.linalg.norm(breakable.pattern.grain)
        across = np.array([float(f.normal @ grain) ** 2 for f in kept])
        factor = 1 + (breakable.pattern.along_grain - 1) * across
    return Bonds(
        pieces=pieces.reshape(-1, 2),
        area=np.array([s.area for s in sections]),
        point=np.array([s.point for s in sections]).reshape(-1, 3),
        frame=np.array([s.frame for s in sections]).reshape(-1, 3, 3),
        second=np.array([s.second for s in sections]).reshape(-1, 2),
        corners=np.array([np.pad(s.corners, ((0, most - len(s.corners)), (0, 0)), mode="edge") for s in sections]).reshape(
            -1, most, 2
        ),
        length=np.array(lengths),
        factor=factor,
    )


def _turned(face: Face) -> Face:
    return Face(face.second, face.first, -face.normal, face.corners[::-1])

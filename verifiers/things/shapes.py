"""Rows about the shapes of generated things: what collides, what deforms and what is drawn of a part are the same (R54).

Distances are measured here, at points of both surfaces, whatever the construction wrote about them: of the collision pieces as far as
they stand outside of what is drawn, of what is drawn from the faces of the piece that covers it best, of bound vertices from where they
are drawn.

Cost: equal parts are measured once; parts that are one convex piece, corner by corner the same, cost next to nothing.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Solid, contains, distance_to_surface
from ...worlds.arrays import F64, rotation_matrix
from ...worlds.errors import EvidenceError, InputError
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .bounds import SHAPES_LEAST, SHAPES_SHARE
from .openings import assembly_of
from .questions import SHAPES

if TYPE_CHECKING:
    from ...worlds.built import BuiltPart, Convex
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row

__all__ = ["Differs", "check", "difference"]

SAME = 1e-9
"""[1] Of the size: corners that are nearer are one."""
ROUND = ("sphere", "cylinder", "capsule")
AROUND = 64
"""Points around a round piece among others."""
KEPT = 50_000
"""Parts whose measures are kept."""
STANDS_OUT, IS_BARE = "what collides stands out of what is drawn", "what is drawn stands out of what collides"
_BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)


class Differs(NamedTuple):
    """Distance of shapes of one part from each other."""

    distance: float
    """[m]"""
    point: tuple[float, float, float]
    """Where, in the body's frame [m]."""
    how: str
    """In words, behind the name of the part."""


_kept: dict[bytes, Differs] = {}
"""By content."""


@guarded(SHAPES)
def check(candidate: Candidate) -> list[Row]:
    """One row per thing that a generator made."""
    bodies: dict[str, list[str]] = {}
    for name, main in assembly_of(candidate.spec).items():
        bodies.setdefault(main, []).append(name)
    return [
        row_of(candidate, SHAPES, (main,), partial(_finding, candidate, names), entities=(main,), recipe_entities=names)
        for main, names in bodies.items()
    ]


def _finding(candidate: Candidate, names: list[str]) -> Finding:
    worst: tuple[float, Differs, str, BuiltPart] | None = None
    count = 0
    for name in names:
        entity = candidate.spec.entities.get(name)
        if entity is None or entity.physics.shape == "loose" or entity.breakable is not None:
            continue  # loose matter and pieces have rows of their category
        for part in candidate.entity(name).parts:
            if part.collision or part.simulation is not None:  # what is only drawn stands in the register
                found = _kept_difference(part)
                ratio, count = found.distance / _allowed(part), count + 1
                if worst is None or ratio > worst[0]:
                    worst = (ratio, found, name, part)
    if worst is None:
        return Finding("not_applicable", f"{names[0]!r} has no part that collides and is drawn", frames=(0, 0), extra=[])
    ratio, found, name, part = worst
    allowed = _allowed(part)
    hint = correction(
        "the part collides as another shape than is seen",
        "shape",
        f"Give part {part.part!r} of {name!r} a shape whose collision pieces follow it: convex pieces instead of one hull, "
        "an extrusion, a revolution or a sweep instead of a mesh.",
        pointers=(pointer("entities", name, "parts", part.part, "shape"),),
    )
    return Finding(
        "pass" if ratio <= 1.0 else "fail",
        f"{name}/{part.part}: {found.how} by {found.distance * 1e3:.4g} mm, allowed {allowed * 1e3:.4g} mm; {count} parts measured",
        found.distance,
        allowed,
        hints=() if ratio <= 1.0 else (hint,),
        evidence={"part": part.part, "body": name, "point_m": list(found.point), "parts": count},
        entities=(name,) if ratio > 1.0 else (),
        frames=(0, 0),
        extra=[],
    )


def _size(part: BuiltPart) -> float:
    return float(np.linalg.norm(np.ptp(part.render.vertices, axis=0)))


def _allowed(part: BuiltPart) -> float:
    return max(SHAPES_LEAST, SHAPES_SHARE * _size(part))


def _kept_difference(part: BuiltPart) -> Differs:
    """`difference`, once for parts of equal content: rooms hold many, and every edit judges them again."""
    mesh = part.render
    content = hashlib.sha256(repr((mesh.vertices.shape, part.closed)).encode())
    content.update(np.ascontiguousarray(mesh.vertices).tobytes() + np.ascontiguousarray(mesh.faces).tobytes())
    for piece in part.collision:
        numbers = np.concatenate([piece.params, piece.pose.position, piece.pose.quaternion, piece.points.reshape(-1)])
        content.update(piece.kind.encode() + numbers.tobytes())
    if part.simulation is not None:
        content.update(part.simulation.vertices.tobytes() + part.simulation.weights.tobytes())
    key = content.digest()
    if key not in _kept:
        if len(_kept) >= KEPT:
            _kept.clear()
        _kept[key] = difference(part)
    return _kept[key]


def difference(part: BuiltPart) -> Differs:
    """Largest distance of shapes of a part from each other.

    Raises:
        EvidenceError: the visible surface cannot be measured.
    """
    from scipy.spatial import cKDTree

    drawn = part.render.vertices
    if part.simulation is not None:
        off = np.linalg.norm(part.simulation.bound(part.simulation.vertices) - drawn, axis=1)
        return _at(off, drawn, "what is drawn is off the mesh that deforms")
    try:
        seen = Solid.from_mesh(part.render, closed=part.closed)
    except InputError as error:
        raise EvidenceError(f"the surface of part {part.part!r} cannot be measured: {error}") from error
    if _same_corners(part, seen):
        return Differs(0.0, (0.0, 0.0, 0.0), STANDS_OUT)
    pieces = [c for c in part.collision if c.kind != "heightfield"]
    spots = _points(seen)
    if len(pieces) == 1 and pieces[0].kind in ROUND:
        signed = _off_round(pieces[0], spots)
        one = _at(-signed, spots, STANDS_OUT)
        two = _at(signed, spots, IS_BARE)
        return one if one.distance >= two.distance else two
    if not pieces:
        return Differs(0.0, (0.0, 0.0, 0.0), STANDS_OUT)
    hulls = [_hull(c) for c in pieces]
    bare = np.min([(spots @ h.planes[:, :3].T + h.planes[:, 3]).max(axis=1) for h in hulls], axis=0)
    two = _at(np.maximum(bare, 0.0), spots, IS_BARE)
    felt = np.unique(np.round(np.concatenate([h.points for h in hulls]), 9), axis=0)
    felt = felt[~_among(felt, np.round(seen.vertices, 9))]
    # No point is further from the surface than from a spot of it: those nearer than what is bare decide nothing.
    felt = felt[cKDTree(spots).query(felt)[0] >= two.distance] if len(felt) else felt
    felt = felt[~contains(seen, felt)]
    over = distance_to_surface(seen, felt).distance if len(felt) else np.empty(0)
    one = _at(over, felt, STANDS_OUT)
    return one if one.distance >= two.distance else two


def _among(points: F64, others: F64) -> NDArray[np.bool_]:
    """True for points that are among others, bit for bit, shape (n,)."""
    known = {row.tobytes() for row in np.ascontiguousarray(others)}
    return np.array([row.tobytes() in known for row in np.ascontiguousarray(points)], dtype=bool)


def _at(distance: F64, points: F64, how: str) -> Differs:
    if len(distance) == 0:
        return Differs(0.0, (0.0, 0.0, 0.0), how)
    k = int(np.argmax(distance))
    x, y, z = (float(v) for v in points[k])
    return Differs(float(distance[k]), (x, y, z), how)


def _same_corners(part: BuiltPart, seen: Solid) -> bool:
    """True if one convex piece has the very corners of a convex surface: then both are the same."""
    if len(part.collision) != 1 or part.collision[0].kind not in ("box", "hull"):
        return False
    mine, size = _corners(part.collision[0]), max(_size(part), 1e-9)
    if len(mine) != len(seen.vertices):
        return False
    order = [np.lexsort(np.round(p / (1e3 * SAME * size)).T) for p in (mine, seen.vertices)]
    if np.abs(mine[order[0]] - seen.vertices[order[1]]).max() > SAME * size:
        return False
    return seen.convex


def _corners(piece: Convex) -> F64:
    local = _BOX * np.array(piece.params) if piece.kind == "box" else piece.points
    return np.asarray(piece.pose.apply(local))


class _Hull(NamedTuple):
    points: F64
    """Corners and middles of the faces of a piece [m], shape (n, 3)."""
    planes: F64
    """Outward normals and offsets of its faces, shape (k, 4)."""


def _hull(piece: Convex) -> _Hull:
    """A collision piece as the convex hull of its corners; a round one of points on it."""
    from scipy.spatial import ConvexHull

    corners = _corners(piece) if piece.kind not in ROUND else piece.pose.apply(_round(piece.kind, piece.params))
    hull = ConvexHull(corners)
    return _Hull(np.concatenate([corners, corners[hull.simplices].mean(axis=1)]), hull.equations)


def _off_round(piece: Convex, points: F64) -> F64:
    """Signed distances of points from a sphere, cylinder or capsule [m], positive outside, shape (n,)."""
    local = (points - piece.pose.position) @ rotation_matrix(piece.pose.quaternion)
    radius = piece.params[0]
    across, along = np.linalg.norm(local[:, :2], axis=1), np.abs(local[:, 2])
    if piece.kind == "cylinder":
        wide, high = across - radius, along - piece.params[1]
        outside = np.hypot(np.maximum(wide, 0.0), np.maximum(high, 0.0))
        return np.asarray(np.where((wide <= 0) & (high <= 0), np.maximum(wide, high), outside))
    half = piece.params[1] if piece.kind == "capsule" else 0.0
    return np.asarray(np.hypot(across, np.maximum(along - half, 0.0)) - radius)


def _round(kind: str, params: Sequence[float]) -> F64:
    """Points on a sphere, cylinder or capsule about the z axis."""
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(AROUND)], axis=-1)
    radius = params[0]
    if kind == "cylinder":
        return np.concatenate([radius * ring + [0.0, 0.0, s * params[1]] for s in (-1.0, 1.0)])
    half = params[1] if kind == "capsule" else 0.0
    lifts = np.linspace(0.0, 0.5 * np.pi, AROUND // 4 + 1)
    found = [radius * np.cos(q) * ring + [0.0, 0.0, side * (half + radius * np.sin(q))] for q in lifts for side in (-1.0, 1.0)]
    return np.asarray(np.unique(np.round(np.concatenate(found), 12), axis=0))


def _points(solid: Solid) -> F64:
    """Corners, middles of edges and of faces of a surface [m], shape (n, 3)."""
    t = solid.triangles
    return np.concatenate([solid.vertices, 0.5 * (t + np.roll(t, 1, axis=1)).reshape(-1, 3), t.mean(axis=1)])

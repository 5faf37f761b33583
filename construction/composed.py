"""Solids composed of others: lofts, letters, and booleans with their exact convex pieces, by manifold3d.

A piece is a point set of shape (n, 3); the solid is the union of the convex hulls of its pieces, so that what is drawn and what
collides are the same by construction.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..worlds.arrays import F64, RigidPose, pose_of
from ..worlds.built import Convex, TriangleMesh
from ..worlds.errors import InputError
from ..worlds.spec import Boolean, Box, Capsule, Cylinder, Loft, Member, Shape, Sphere, Text
from .polygons import convex_partition, is_convex, signed_area

if TYPE_CHECKING:
    from manifold3d import Manifold

__all__ = ["MOST_PIECES", "combined", "lettered", "lofted"]

IDENTITY = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
MOST_PIECES = 512
"""Own choice: convex pieces of one composed shape, at most."""
ROUND = 32
"""Own choice: sides of round members of a boolean."""
CAP_RINGS = 4
"""Own choice: rings of each cap of a capsule in a boolean."""
SLIVER = 1e-9
"""Own choice: parts of a cut piece below this share of its volume are rounding."""
STROKE_SIDES = 8
"""Sides of the round ends of a letter's strokes."""
CAPITAL, GAP, BLANK = 6.0, 1.9, 2.6
"""Height of a capital, space between letters and width of a blank in the units of `letters.json`."""

Made = tuple[TriangleMesh, tuple[Convex, ...]]


def _made(solid: Manifold, pieces: Iterable[F64], name: str) -> Made:
    """Visible mesh and collision pieces.

    Raises:
        InputError: the solid is empty, or has too many pieces.
    """
    hulls = tuple(Convex("hull", (), IDENTITY, np.ascontiguousarray(p, dtype=np.float64)) for p in pieces)
    if solid.is_empty() or not hulls:
        raise InputError(f"the {name} is empty: its members leave no volume; move or resize them")
    if len(hulls) > MOST_PIECES:
        raise InputError(
            f"the {name} has {len(hulls)} convex pieces, at most {MOST_PIECES} are allowed; use fewer members or segments, "
            "a revolution for what is hollow and round, or several parts"
        )
    mesh = solid.to_mesh64()
    vertices = np.ascontiguousarray(np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3])
    return TriangleMesh(vertices, np.ascontiguousarray(mesh.tri_verts, dtype=np.int32)), hulls


def _union(pieces: Sequence[F64]) -> Manifold:
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean([Manifold.hull_points(p) for p in pieces], OpType.Add)


def _plane(polygon: Sequence[tuple[float, float]], height: float) -> F64:
    return np.column_stack([np.array(polygon, dtype=np.float64), np.full(len(polygon), height)])


def lofted(shape: Loft) -> Made:
    """Visible mesh and convex pieces of a loft: one piece from each section to the next, more where they are concave.

    Raises:
        InputError: a section is no simple polygon, or concave sections cannot be cut in the same way, or two sections lie in one plane.
    """
    polygons = [list(s.polygon) for s in shape.sections]
    polygons = [p if signed_area(p) > 0 else p[::-1] for p in polygons]
    cuts = [convex_partition(p) for p in polygons]
    parts: list[list[list[int]]]
    if all(len(c) == 1 for c in cuts):
        parts = [[list(range(len(p)))] for p in polygons]
    else:
        first = max(cuts, key=len)
        for k, polygon in enumerate(polygons):
            if not all(is_convex(polygon, ring) for ring in first):
                raise InputError(
                    f"section {k} of the loft bends in where the others do not; give it the same corners in the same order"
                )
        parts = [first] * len(polygons)
    placed = [pose_of(s.pose).apply(_plane(p, 0.0)) for s, p in zip(shape.sections, polygons, strict=True)]
    pieces = []
    for k in range(len(placed) - 1):
        for one, two in zip(parts[k], parts[k + 1], strict=True):
            points = np.concatenate([placed[k][one], placed[k + 1][two]])
            if np.linalg.matrix_rank(points - points[0], tol=1e-9) < 3:
                raise InputError(f"sections {k} and {k + 1} of the loft lie in one plane; move one of them by its pose")
            pieces.append(points)
    return _made(_union(pieces), pieces, "loft")


@lru_cache(maxsize=1)
def _letters() -> dict[str, list[list[list[float]]]]:
    found: dict[str, Any] = json.loads(Path(__file__).with_name("letters.json").read_text(encoding="utf-8"))
    return dict(found["letters"])


def lettered(shape: Text) -> Made:
    """Visible mesh and convex pieces of letters: each segment of a stroke is the hull of two octagons.

    Raises:
        InputError: too many pieces.
    """
    letters, strokes, right = _letters(), [], 0.0
    for letter in shape.text.upper():
        if letter == " ":
            right += BLANK
            continue
        drawn = letters[letter]
        strokes += [[(right + x, y) for x, y in line] for line in drawn]
        right += max(x for line in drawn for x, _ in line) + GAP
    unit = shape.height / CAPITAL
    middle = np.array([0.5 * (right - GAP), 0.5 * CAPITAL])
    turn = [math.pi * (2 * k + 1) / STROKE_SIDES for k in range(STROKE_SIDES)]
    pen = 0.5 * shape.stroke * shape.height * np.column_stack([np.cos(turn), np.sin(turn)])
    pieces = []
    for line in strokes:
        points = (np.array(line) - middle) * unit
        for a, b in itertools.pairwise(points):
            flat = np.concatenate([pen + a, pen + b]) if (a != b).any() else pen + a
            pieces.append(np.concatenate([_plane(list(map(tuple, flat)), z) for z in (-shape.depth / 2, shape.depth / 2)]))
    return _made(_union(pieces), pieces, "text")


def _round_rings(rings: Iterable[tuple[float, float]]) -> F64:
    turn = 2 * math.pi * np.arange(ROUND) / ROUND
    flat = np.column_stack([np.cos(turn), np.sin(turn)])
    return np.concatenate([_plane(list(map(tuple, r * flat)), z) for r, z in rings])


def _sphere_points(radius: float) -> F64:
    from trimesh.creation import icosphere

    return np.asarray(icosphere(subdivisions=2, radius=radius).vertices, dtype=np.float64)


def _member_pieces(shape: Shape, build: Callable[[Shape], tuple[Convex, ...]]) -> list[F64]:
    """Pieces of one member in its own frame; round ones get facets."""
    if isinstance(shape, Box):
        corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
        return [corners * np.array(shape.size)]
    if isinstance(shape, Sphere):
        return [_sphere_points(shape.radius)]
    if isinstance(shape, Cylinder):
        return [_round_rings([(shape.radius, -shape.height / 2), (shape.radius, shape.height / 2)])]
    if isinstance(shape, Capsule):
        steps = [math.pi / 2 * k / CAP_RINGS for k in range(CAP_RINGS + 1)]
        cap = [(shape.radius * math.cos(t), shape.length / 2 + shape.radius * math.sin(t)) for t in steps]
        return [_round_rings([*cap, *((r, -z) for r, z in cap)])]
    return [p.points for p in build(shape)]


def _copies(member: Member, pieces: list[F64]) -> list[F64]:
    """Pieces of a member and its copies, in the frame of the whole."""
    placed = [pose_of(member.pose).apply(p) for p in pieces]
    found = list(placed)
    if member.repeat is not None:
        c, s = math.cos(member.repeat.turn), math.sin(member.repeat.turn)
        turn, move = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array(member.repeat.move)
        for _ in range(member.repeat.count - 1):
            placed = [p @ turn.T + move for p in placed]
            found += placed
    if member.mirror is not None:
        flip = np.where(np.array(list("xyz")) == member.mirror, -1.0, 1.0)
        found += [p * flip for p in found]
    return found


def _corners(solid: Manifold) -> F64:
    return np.array(np.asarray(solid.to_mesh64().vert_properties, dtype=np.float64)[:, :3])


def _without(piece: Manifold, tool: F64) -> list[Manifold]:
    """Convex pieces of what a convex tool leaves of a convex piece: one cut along each of its faces.

    Cutting the tool's box free first keeps the cuts of a round tool near it: the way of fewer pieces is taken.
    """
    from manifold3d import Manifold
    from scipy.spatial import ConvexHull

    if (piece ^ Manifold.hull_points(tool)).volume() <= SLIVER * piece.volume():
        return [piece]
    faces = np.unique(np.round(ConvexHull(tool).equations, 12), axis=0)
    box = np.concatenate([np.column_stack([np.eye(3), -tool.max(0)]), np.column_stack([-np.eye(3), tool.min(0)])])
    return min((_cut(piece, faces), _cut(piece, np.concatenate([box, faces]))), key=len)


def _cut(piece: Manifold, planes: F64) -> list[Manifold]:
    """Parts of a convex piece outside the planes (n, 4), each normal . x + offset <= 0 inside, one after the other."""
    least = SLIVER * piece.volume()
    left, rest = [], piece
    for *normal, offset in planes:
        outside, inside = rest.split_by_plane(normal, -offset)
        if outside.volume() > least:
            left.append(outside)
            rest = inside
        if rest.is_empty():
            break
    return left


def combined(shape: Boolean, build: Callable[[Shape], tuple[Convex, ...]]) -> Made:
    """Visible mesh and exact convex pieces of a boolean; `build` gives the pieces of a shape that is neither box nor round.

    Raises:
        InputError: nothing is left, or too many pieces.
    """
    from manifold3d import Manifold, OpType

    members = [_copies(m, _member_pieces(m.shape, build)) for m in shape.of]
    count = sum(map(len, members))
    if count > MOST_PIECES:
        raise InputError(
            f"the members of the boolean have {count} convex pieces with all copies, at most {MOST_PIECES} are allowed"
        )
    if shape.operation == "union":
        pieces = [p for m in members for p in m]
        return _made(_union(pieces), pieces, "union")
    first = [Manifold.hull_points(p) for p in members[0]]
    if shape.operation == "intersection":
        for member in members[1:]:
            first = [both for a in first for p in member if not (both := a ^ Manifold.hull_points(p)).is_empty()]
        solid = Manifold.batch_boolean(first, OpType.Add)
        return _made(solid, [_corners(p) for p in first if p.volume() > SLIVER * solid.volume()], "intersection")
    tools = [p for m in members[1:] for p in m]
    solid = _union(members[0]) - _union(tools)
    for tool in tools:
        first = [left for piece in first for left in _without(piece, tool)]
        if len(first) > 4 * MOST_PIECES:
            break
    return _made(solid, [_corners(p) for p in first], "difference")

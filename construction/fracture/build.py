"""Parts of a breakable entity -> pieces with mass, visible surface and collision hulls, and their bonds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64, RigidPose
from ...worlds.bonds import Bonds
from ...worlds.built import BuiltBody, BuiltPart, Convex, TriangleMesh
from ...worlds.errors import InputError, LimitError
from ...worlds.limits import CAPS
from .faces import Face, bonds_of, shared_faces, side_faces
from .patterns import cells_of
from .polyhedra import Polyhedron, clip, hull_mesh, polyhedron_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...worlds.spec import Breakable

__all__ = ["PIECE_NAME", "Pieces", "Whole", "build_pieces"]

PIECE_NAME = "piece_{:03d}"
SLIVER = 0.02
"""Pieces smaller than this share of the middle one are joined to the neighbour with the largest common face."""
NOTHING = 1e-9
"""Fragments below this share of the whole are rounding of a cut along a side."""
VOLUME_ERROR = 1e-7
"""Largest accepted difference between the pieces' volume and the whole's, in parts of the whole."""
BOX = 1e-9
"""Corners this close to those of a box, relative to its size, make one."""
IDENTITY = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
NO_POINTS: F64 = np.zeros((0, 3))


class Whole(NamedTuple):
    """One part of the entity before it is cut, in the entity's frame."""

    part: str
    material: str
    density: float
    """[kg/m^3], scaled where the entity declares its mass."""
    tiles: tuple[F64, ...]
    """Corners of convex bodies that tile the part [m], shape (n, 3) each."""
    smooth: bool


class Pieces(NamedTuple):
    """The entity cut."""

    bodies: list[BuiltBody]
    parts: list[BuiltPart]
    bonds: Bonds


@dataclass
class _Fragment:
    points: F64
    whole: int
    cell: int
    volume: float


def _volume(points: F64) -> float:
    return Solid.from_mesh(hull_mesh(points), closed=True).volume


def _inside(wholes: Sequence[Whole], points: F64) -> F64:
    """Which points, shape (n, 3), lie in the body."""
    from scipy.spatial import ConvexHull

    found = np.zeros(len(points), dtype=bool)
    for tile in (t for w in wholes for t in w.tiles):
        planes = ConvexHull(tile).equations
        found |= (points @ planes[:, :3].T + planes[:, 3]).max(axis=1) <= 0
    return np.asarray(found)


def _fragments(wholes: Sequence[Whole], breakable: Breakable, low: F64, high: F64) -> list[_Fragment]:
    cells = cells_of(breakable, low, high, lambda points: _inside(wholes, points))
    cap = CAPS["pieces"].value
    if len(cells) > 4 * cap:
        raise LimitError(f"the pattern makes {len(cells)} cells, at most {4 * cap}; {CAPS['pieces'].knob}")
    bodies: list[tuple[int, Polyhedron]] = [(k, polyhedron_of(t)) for k, w in enumerate(wholes) for t in w.tiles]
    found = []
    for index, cell in enumerate(cells):
        for k, tile in bodies:
            body: Polyhedron | None = tile
            for normal, offset in zip(cell.normals, cell.offsets, strict=True):
                body = None if body is None else clip(body, normal, float(offset))
            if body is not None:
                points = np.unique(body.points, axis=0)
                found.append(_Fragment(points, k, index, _volume(points)))
    total = sum(f.volume for f in found)
    return [f for f in found if f.volume > NOTHING * total]


def _join(fragments: Sequence[_Fragment], faces: Sequence[Face]) -> list[int]:
    """Piece of each fragment: those of one cell and part that share a face, and slivers with their largest neighbour."""
    label = list(range(len(fragments)))

    def root(i: int) -> int:
        while label[i] != i:
            i = label[i]
        return i

    for face in faces:
        a, b = fragments[face.first], fragments[face.second]
        if (a.cell, a.whole) == (b.cell, b.whole):
            one, other = sorted((root(face.first), root(face.second)))
            label[other] = one
    volume: dict[int, float] = {}
    for i, fragment in enumerate(fragments):
        volume[root(i)] = volume.get(root(i), 0.0) + fragment.volume
    least = SLIVER * float(np.median(list(volume.values())))
    widest: dict[int, tuple[float, int]] = {}
    for face in faces:
        one, other = root(face.first), root(face.second)
        same = fragments[face.first].whole == fragments[face.second].whole
        spread = np.cross(face.corners[1:-1] - face.corners[0], face.corners[2:] - face.corners[0])
        area = float(np.linalg.norm(spread.sum(axis=0)))
        for small, large in ((one, other), (other, one)):
            if (
                same
                and one != other
                and volume[small] < least
                and volume[large] >= least
                and area > widest.get(small, (0.0, 0))[0]
            ):
                widest[small] = (area, large)
    for small, (_, large) in widest.items():
        label[small] = large
    roots = sorted({root(i) for i in range(len(fragments))})
    rank = {r: k for k, r in enumerate(roots)}
    return [rank[root(i)] for i in range(len(fragments))]


def _as_box(points: F64) -> Convex | None:
    """The box whose corners these are; None where they are none's."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = high - low
    near = np.minimum(np.abs(points - low), np.abs(points - high))
    if len(points) != 8 or near.max() > BOX * size.max():
        return None
    half = size / 2
    return Convex("box", (float(half[0]), float(half[1]), float(half[2])), RigidPose(low + half, IDENTITY.quaternion), NO_POINTS)


def _joined_mesh(hulls: Sequence[F64]) -> TriangleMesh:
    meshes = [hull_mesh(h) for h in hulls]
    starts = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    faces = [m.faces + np.int32(s) for m, s in zip(meshes, starts, strict=True)]
    return TriangleMesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces))


def _piece(index: int, hulls: Sequence[F64], whole: Whole) -> tuple[BuiltBody, BuiltPart]:
    name = PIECE_NAME.format(index)
    mesh = _joined_mesh(hulls)
    solid = Solid.from_mesh(mesh, closed=True)
    center = solid.center
    body = BuiltBody(
        name,
        RigidPose(center, IDENTITY.quaternion),
        whole.density * solid.volume,
        np.zeros(3),
        solid.inertia(whole.density),
        solid.volume,
    )
    collision = []
    for hull in hulls:
        own = np.ascontiguousarray(hull - center)
        collision.append(_as_box(own) or Convex("hull", (), IDENTITY, own))
    part = BuiltPart(
        part=name,
        body=name,
        material=whole.material,
        render=TriangleMesh(mesh.vertices - center, mesh.faces),
        collision=tuple(collision),
        closed=True,
        deviation=(0.0, 0.0),
        smooth=False,
    )
    return body, part


def build_pieces(name: str, wholes: Sequence[Whole], breakable: Breakable) -> Pieces:
    """Cut the parts of an entity.

    Args:
        name: the entity, for messages.
        wholes: its parts.
        breakable: how it is cut.

    Raises:
        InputError: the cut leaves one piece, or does not conserve the volume.
        LimitError: more pieces than the cap.
    """
    corners = np.concatenate([t for w in wholes for t in w.tiles])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = float(np.linalg.norm(high - low))
    fragments = _fragments(wholes, breakable, low, high)
    hulls = [f.points for f in fragments]
    faces = shared_faces(hulls, size)
    owner = _join(fragments, faces)
    count = max(owner) + 1
    cap = CAPS["pieces"]
    if count > cap.value:
        raise LimitError(f"entity {name!r} would break into {count} pieces, at most {cap.value}; {cap.knob}")
    if count < 2:
        raise InputError(f"/entities/{name}/breakable/pattern leaves one piece; use more pieces or smaller bricks")
    parent = sum(_volume(t) for w in wholes for t in w.tiles)
    total = sum(f.volume for f in fragments)
    if abs(total - parent) > VOLUME_ERROR * parent:
        raise InputError(
            f"entity {name!r}: its pieces hold {total:.9g} m^3, its parts {parent:.9g} m^3; use another seed or simpler parts"
        )
    bodies, parts = [], []
    for index in range(count):
        mine = [i for i, piece in enumerate(owner) if piece == index]
        body, part = _piece(index, [hulls[i] for i in mine], wholes[fragments[mine[0]].whole])
        bodies.append(body)
        parts.append(part)
    faces += side_faces(hulls, breakable.fixed, low, high)
    centers = np.array([b.pose.position for b in bodies])
    return Pieces(bodies, parts, bonds_of(faces, owner, centers, breakable))

"""Trunks and boulders of a landscape as a part of the ground that is cut from it: written, read, and made solid."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from ..worlds.arrays import F64
from ..worlds.built import Convex, TriangleMesh
from ..worlds.errors import InputError
from ..worlds.folder import WorldFolder, write_atomically
from ..worlds.landscape import SavedLandscape
from ..worlds.limits import CAPS, check_cap
from ..worlds.spec import StemField
from ..worlds.stems import pieces_of, stem_table, stems_from, stems_of
from .imports import load_table

__all__ = ["StemCut", "cut_stems", "load_stems"]

SIDES = 32
"""Sides of the prisms that are seen in place of trunks, 0.48 % of the radius within the circle."""


class StemCut(NamedTuple):
    """File of the stems cut for a ground, and the box around them."""

    file: str
    """Name in the world's `assets/` folder."""
    digest: str
    number: int
    low: F64
    """Corner of the box around all, in the ground's frame [m], shape (3,)."""
    high: F64


def cut_stems(
    folder: WorldFolder, name: str, land: SavedLandscape, *, center: tuple[float, float], size: tuple[float, float]
) -> StemCut | None:
    """Write the trunks and boulders whose feet stand in a rectangle as a file in `assets/`; None where there are none.

    Args:
        folder: the world.
        name: of the terrain.
        land: its landscape.
        center: of the rectangle [m].
        size: of the rectangle x, y [m].

    Raises:
        LimitError: there are too many.
    """
    middle, half = np.array(center), 0.5 * np.array(size)
    found = stems_of(land).standing(middle - half, middle + half)
    own = found._replace(foot=found.foot - np.array([*center, 0.0]))
    count = len(own.radius)
    check_cap("stems", count, what=f"a ground of {size[0]:g} x {size[1]:g} m of the landscape {name!r}")
    if count == 0:
        return None
    buffer = io.BytesIO()
    np.save(buffer, stem_table(own))
    data = buffer.getvalue()
    digest = hashlib.sha256(data).hexdigest()
    file = f"{name}-stems-{digest[:12]}.npy"
    write_atomically(folder.assets / file, data)
    corners = _surface(pieces_of(own)).vertices
    return StemCut(file, digest, count, corners.min(axis=0), corners.max(axis=0))


def load_stems(shape: StemField, assets: Path) -> tuple[TriangleMesh, tuple[Convex, ...], float]:
    """Visible surface of trunks and boulders, their convex pieces, and how far these stand outside of it [m].

    Raises:
        InputError: the file is missing, is another one than the specification names, or holds no such table.
    """
    table = load_table(assets, shape.file, shape.digest, 8 * 7 * CAPS["stems"].value + 4096)
    try:
        stems = stems_from(table)
    except ValueError as error:
        raise InputError(f"file of stems {shape.file!r} is no table of them: {error}; call build_terrain again") from error
    if len(stems.radius) != shape.count:
        raise InputError(
            f"file of stems {shape.file!r} holds {len(stems.radius)}, the specification says {shape.count}; call build_terrain again"
        )
    pieces = pieces_of(stems)
    widest = max((p.params[0] for p in pieces if p.kind == "cylinder"), default=0.0)
    return _surface(pieces), pieces, widest * float(1.0 - np.cos(np.pi / SIDES))


def _prism() -> tuple[F64, np.ndarray]:
    """Closed prism of unit radius from z = -1 to 1: corners (n, 3), faces (m, 3) outwards."""
    turn = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    corners = np.concatenate([np.column_stack([ring, np.full(SIDES, z)]) for z in (-1.0, 1.0)] + [[[0, 0, -1.0], [0, 0, 1.0]]])
    k = np.arange(SIDES)
    n = (k + 1) % SIDES
    below, above = np.full(SIDES, 2 * SIDES), np.full(SIDES, 2 * SIDES + 1)
    faces = [(k, n, n + SIDES), (k, n + SIDES, k + SIDES), (below, n, k), (above, k + SIDES, n + SIDES)]
    return corners, np.concatenate([np.stack(f, axis=1) for f in faces])


def _outward(points: F64) -> np.ndarray:
    """Faces of the hull of points, outwards, shape (m, 3)."""
    hull = ConvexHull(points)
    faces = hull.simplices.astype(np.int64)
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) < 0
    faces[inward] = faces[inward][:, ::-1]
    return np.asarray(faces)


def _surface(pieces: tuple[Convex, ...]) -> TriangleMesh:
    corners, sides = _prism()
    vertices, faces, start = [], [], 0
    for piece in pieces:
        if piece.kind == "cylinder":
            radius, half = piece.params
            own, number = piece.pose.apply(corners * [radius, radius, half]), sides
        else:
            own, number = piece.pose.apply(piece.points), _outward(piece.points)
        vertices.append(own)
        faces.append(number + start)
        start += len(own)
    return TriangleMesh(np.concatenate(vertices), np.concatenate(faces).astype(np.int32))

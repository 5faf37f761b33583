"""Signed clearances of many different pairs at one pose each, with their points: what takes long over each is done for all at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..worlds.arrays import F64, RigidPose, rotation_matrix
from .clearance import Clearance, examine, relative_poses
from .triangles import triangle_pairs

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["signed_clearances"]

OF_TRIANGLES = ("edges", "mesh", "crossing")
"""Methods whose points are the nearest ones of two triangles, at a single pose."""


def signed_clearances(asked: Sequence[tuple[Solid, RigidPose, Solid, RigidPose]]) -> list[Clearance]:
    """`signed_clearance` of many (a, its pose, b, its pose), bit for bit; nearest points of triangles are worked out all at once."""
    if not asked:
        return []
    sides = [
        [np.array([pose[m] for pose in poses]) for m in (0, 1)] for poses in zip(*((q[1], q[3]) for q in asked), strict=True)
    ]
    relative = relative_poses((sides[0][0], sides[0][1]), (sides[1][0], sides[1][1]))
    points, values, methods, open_rows, faces = np.empty((len(asked), 2, 3)), list[float](), list[str](), list[int](), list[F64]()
    for row, (a, _, b, _) in enumerate(asked):
        named: list[tuple[int, int]] = []
        found = examine(a, b, relative.take(np.array([row])), witness=True, named=named)
        points[row] = found.point_a[0], found.point_b[0]
        values.append(float(found.value[0]))
        methods.append(str(found.method[0]))
        if methods[-1] in OF_TRIANGLES:
            i, j = named[-1]
            open_rows.append(row)
            faces.append(np.stack([a.triangles[i], b.triangles[j]]))
    if open_rows:
        some, pair = relative.take(np.array(open_rows)), np.array(faces)
        moved = pair[:, 0] @ some.rotation.swapaxes(1, 2) + some.translation[:, None]
        points[open_rows] = np.stack(triangle_pairs(moved, pair[:, 1]), axis=1)
    points = points @ rotation_matrix(sides[1][1]).swapaxes(1, 2) + sides[1][0][:, None]
    return [Clearance(v, p[0], p[1], m) for v, p, m in zip(values, points, methods, strict=True)]

"""Point queries against a solid: containment by winding number and distance to the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, length
from .triangles import Nearest, nearest_on_triangles

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["contains", "distance_to_surface", "nearest_faces", "winding_number"]

PAIRS = 400_000
"""Point-triangle pairs per chunk."""
BRUTE_FACES = 200
"""Own choice, measured: below this many triangles a full sweep beats the k-d tree."""
BOXED_FACES = 40
"""Own choice, measured: from so many triangles on their boxes are looked at first, which is 2 to 6 times as fast as all triangles from 80 on."""
FEW_PLANES = 50_000
"""Own choice: up to so many products points are compared with the planes of all triangles, without merging those of one facet first."""
GRID_FACES = 500
"""Own choice: above this many triangles points are classified by counting crossings."""
GRID_PAIRS = 100_000
"""Own choice: above this many point-triangle pairs too, where solid angles of all of them would take longer than building the grid."""


def winding_number(triangles: F64, points: F64) -> F64:
    """Generalized winding number of a triangle soup, shape (n,): 1 inside a closed outward surface, 0 outside.

    Solid angles by Van Oosterom and Strackee (1983), doi:10.1109/TBME.1983.325207; the sum as a winding number by
    Jacobson et al. (2013), doi:10.1145/2461912.2461916.

    Args:
        triangles: corners [m], shape (m, 3, 3).
        points: queries [m], shape (n, 3).
    """
    result = np.zeros(len(points))
    step = max(1, PAIRS // max(1, len(triangles)))
    # One array per corner and coordinate: short last axes take several times as long.
    corners = np.ascontiguousarray(triangles.transpose(1, 2, 0))
    for i in range(0, len(points), step):
        x, y, z = (points[i : i + step, k, None] for k in range(3))
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ((u - x, v - y, w - z) for u, v, w in corners)
        la, lb, lc = (np.sqrt((u * u + v * v) + w * w) for u, v, w in ((ax, ay, az), (bx, by, bz), (cx, cy, cz)))
        top = (ax * (by * cz - bz * cy) + az * (bx * cy - by * cx)) + ay * (bz * cx - bx * cz)
        bottom = (
            la * lb * lc
            + ((ax * bx + az * bz) + ay * by) * lc
            + ((bx * cx + bz * cz) + by * cy) * la
            + ((cx * ax + cz * az) + cy * ay) * lb
        )
        result[i : i + step] = np.arctan2(top, bottom).sum(axis=1) / (2.0 * np.pi)
    return result


def contains(solid: Solid, points: F64) -> NDArray[np.bool_]:
    """True where points [m], shape (n, 3) in the solid's frame, lie inside; always False for open solids.

    Points closer to the surface than about 1e-14 of the size may fall on either side.
    """
    points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    result = np.zeros(len(points), dtype=bool)
    if not solid.closed:
        return result
    near = np.flatnonzero(((points >= solid.lower) & (points <= solid.upper)).all(axis=1))
    if len(near) == 0:
        return result
    if solid.convex:
        few = len(near) * len(solid.faces) <= FEW_PLANES
        normals, offsets = solid.planes if few else (solid.facets.normals, solid.facets.offsets)
        result[near] = (points[near] @ normals.T <= offsets).all(axis=1)
        return result
    few = len(solid.faces) <= GRID_FACES and len(near) * len(solid.faces) <= GRID_PAIRS
    if few or not solid.is_watertight:
        result[near] = np.abs(winding_number(solid.triangles, points[near])) > 0.5
        return result
    winding, doubtful = solid.ray_grid.winding(points[near])
    result[near] = winding != 0
    result[near[doubtful]] = np.abs(winding_number(solid.triangles, points[near[doubtful]])) > 0.5
    return result


def distance_to_surface(solid: Solid, points: F64) -> Nearest:
    """Unsigned distance [m], shape (n,), and nearest surface point, shape (n, 3), in the solid's frame. Exact."""
    distance, point, _ = nearest_faces(solid, points)
    return Nearest(distance, point)


def nearest_faces(solid: Solid, points: F64) -> tuple[F64, F64, NDArray[np.intp]]:
    """`distance_to_surface` with the index of the nearest triangle, shape (n,)."""
    points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    distance, nearest = np.empty(len(points)), np.empty((len(points), 3))
    face = np.zeros(len(points), dtype=np.intp)
    if len(solid.faces) <= BRUTE_FACES:
        step = max(1, PAIRS // len(solid.faces))
        for i in range(0, len(points), step):
            few = slice(i, i + step)
            distance[few], nearest[few], face[few] = _nearest_of_few(solid, points[few])
        return distance, nearest, face
    center = solid.centroids
    bound = solid.vertex_tree.query(points)[0] * (1.0 + 1e-12) + 1e-12 * solid.size
    # Few large triangles among many small ones (the base of a terrain) are always compared, the small ones by tree.
    common, large = solid.common_reach, solid.large_faces
    box_low, box_high = solid.face_bounds
    low, high = box_low[large], box_high[large]
    step = 256
    for i in range(0, len(points), step):
        block = points[i : i + step]
        near = solid.centroid_tree.query_ball_point(block, bound[i : i + step] + common)
        count = np.array([len(n) for n in near])
        columns = np.concatenate([np.asarray(n, dtype=np.intp) for n in near])
        rows = np.repeat(np.arange(len(block)), count)
        reached = bound[i : i + step]
        far = _box_gap(low, high, (block - reached[:, None]).min(axis=0), (block + reached[:, None]).max(axis=0))
        some = large[far <= 0.0]
        more_rows = np.repeat(np.arange(len(block)), len(some))
        more = np.tile(some, len(block))
        close = _box_gap(box_low[more], box_high[more], block[more_rows], block[more_rows]) <= reached[more_rows]
        gap = length(block[rows] - center[columns]) - solid.reaches[columns]
        keep = gap <= reached[rows]
        rows = np.concatenate([rows[keep], more_rows[close]])
        columns = np.concatenate([columns[keep], more[close]])
        d, q = _pairwise(block, solid.triangles, rows, columns)
        order = np.lexsort((d, rows))
        first = order[np.searchsorted(rows[order], np.arange(len(block)))]
        distance[i : i + step], nearest[i : i + step] = d[first], q[first]
        face[i : i + step] = columns[first]
    return distance, nearest, face


def _nearest_of_few(solid: Solid, points: F64) -> tuple[F64, F64, NDArray[np.intp]]:
    """The same for few triangles: those whose box is no farther than the nearest vertex are compared, all of them where that saves little."""
    count = np.arange(len(points))
    if len(solid.faces) < BOXED_FACES:
        d, q = nearest_on_triangles(points[:, None], solid.triangles[None])
        k = d.argmin(axis=1)
        return d[count, k], q[count, k], k
    reached = solid.vertex_tree.query(points)[0] * (1.0 + 1e-12) + 1e-12 * solid.size
    low, high = solid.face_bounds
    gap = np.maximum(np.maximum(low - points[:, None], points[:, None] - high), 0.0)
    rows, columns = np.nonzero(np.einsum("nmi,nmi->nm", gap, gap) <= np.square(reached)[:, None])
    d, q = _pairwise(points, solid.triangles, rows, columns)
    order = np.lexsort((d, rows))
    first = order[np.searchsorted(rows[order], count)]
    return d[first], q[first], columns[first]


def _box_gap(low: F64, high: F64, other_low: F64, other_high: F64) -> F64:
    """Distance between boxes [m]; 0 where they meet."""
    return length(np.maximum(np.maximum(low - other_high, other_low - high), 0.0))


def _pairwise(points: F64, triangles: F64, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Nearest:
    parts = [
        nearest_on_triangles(points[rows[s : s + PAIRS]], triangles[columns[s : s + PAIRS]]) for s in range(0, len(rows), PAIRS)
    ]
    return Nearest(np.concatenate([d for d, _ in parts]), np.concatenate([q for _, q in parts]))

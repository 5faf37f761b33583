"""Which triangles cross: of two soups, or of one surface with itself.

Two triangles cross when each has corners on both sides of the other's plane, farther than the noise, and their stretches
of the common line overlap by more than the noise (Moeller 1997, "A fast triangle-triangle intersection test"). Besides:
coplanar triangles that face the same way and overlap (two bodies in one mesh), an edge that lies in a triangle while its
two faces leave it on different sides, and neighbours folded onto each other. Touching is no crossing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32, cross
from .triangle_pairs import coplanar, heights, pairs_of, planes_of, properly

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["Crossings", "mutual_crossings", "pierced", "self_crossings"]

CELL = 2.0
"""Own choice: edge of a grid cell in mean triangle extents."""
LARGE = 512
"""Own choice: triangles over more cells than this are compared with all instead."""
CHUNK = 400_000
"""Pairs of triangles tested at once; bounds memory to about 200 MB."""
SAME_ANGLE = 1e-7
"""[rad] Triangles this close around an edge lie on each other."""
IPoints = NDArray[np.intp]


class Crossings(NamedTuple):
    """Pairs of triangles that cross."""

    pairs: I32
    """Indices, shape (k, 2); of one surface i < j."""
    reach: F64
    """Depth to which each pair reaches through each other [m], shape (k,): the smaller of the four rises over the other's plane;
    for coplanar overlap the length of the overlap."""


def self_crossings(solid: Solid, *, noise: float, groups: NDArray[np.intp] | None = None) -> Crossings:
    """Triangles of one surface that cross each other.

    Triangles that share an edge cross only where they are folded onto each other; those that share a corner only beyond it.

    Args:
        solid: the surface, open or closed.
        noise: [m] up to which parts of it touch and do not cross.
        groups: sizes of runs of triangles, each far from the others, where the surface is many small ones; default one.
    """
    triangles, faces = solid.triangles, solid.faces
    low, high = triangles.min(axis=1) - noise, triangles.max(axis=1) + noise
    i, j = _near_pairs(low, high) if groups is None else _near_in_groups(low, high, groups)
    owners, planes = _edge_owners(solid), planes_of(triangles)
    found, reach = [np.empty((0, 2), dtype=np.intp)], [np.empty(0)]
    for s in range(0, len(i), CHUNK):
        one, two = i[s : s + CHUNK], j[s : s + CHUNK]
        shared = (faces[one][:, :, None] == faces[two][:, None]).sum(axis=(1, 2))
        both = pairs_of(triangles, planes, one, two, noise)
        value = np.zeros(len(one))
        loose = np.flatnonzero(shared <= 1)
        value[loose] = properly(both.take(loose), noise)
        rest = np.flatnonzero(value == 0.0)
        value[rest] = coplanar(both.take(rest), noise)
        apart = np.flatnonzero((shared == 0) & (value == 0.0))
        value[apart] = _through_edge(solid, owners, one[apart], two[apart], noise)
        edge = np.flatnonzero((shared == 2) & (value == 0.0))
        value[edge] = _folded(solid, owners, one[edge], two[edge], noise)
        hit = value > 0.0
        found.append(np.stack([one[hit], two[hit]], axis=1))
        reach.append(value[hit])
    crowded = _crowded_edges(solid, owners, noise)
    pairs = np.concatenate([*found, crowded.pairs])
    kept = np.unique(pairs, axis=0, return_index=True)[1]
    return _sorted(pairs[kept], np.concatenate([*reach, crowded.reach])[kept])


def mutual_crossings(one: F64, two: F64, *, noise: float) -> Crossings:
    """Triangles of two surfaces that cross, or lie on each other and face the same way.

    Args:
        one: corners [m], shape (n, 3, 3).
        two: corners of the other, shape (m, 3, 3); the second index of a pair counts from its first triangle.
        noise: [m] up to which they touch and do not cross.
    """
    both = np.concatenate([one, two])
    i, j = _near_pairs(both.min(axis=1) - noise, both.max(axis=1) + noise, split=len(one))
    reach, planes = np.zeros(len(i)), planes_of(both)
    for s in range(0, len(i), CHUNK):
        some = slice(s, s + CHUNK)
        pairs = pairs_of(both, planes, i[some], j[some], noise)
        reach[some] = np.maximum(properly(pairs, noise), coplanar(pairs, noise))
    hit = reach > 0.0
    return _sorted(np.stack([i[hit], j[hit] - len(one)], axis=1), reach[hit])


def pierced(points: F64, edges: I32, faces: I32) -> I32:
    """Edges that go through triangles, none of whose corners is an end of theirs: pairs (edge, face), shape (k, 2).

    What is exactly touched is not gone through: the volumes of five tetrahedra have to have the right signs.

    Args:
        points: [m], shape (n, 3).
        edges: shape (m, 2).
        faces: shape (t, 3).
    """
    ends, corners = points[edges], points[faces]
    low = np.concatenate([ends.min(axis=1), corners.min(axis=1)])
    high = np.concatenate([ends.max(axis=1), corners.max(axis=1)])
    i, j = _near_pairs(low, high, split=len(edges))
    j = j - len(edges)
    apart = ~(edges[i][:, :, None] == faces[j][:, None, :]).any(axis=(1, 2))
    i, j = i[apart], j[apart]
    a, b, (p, q, r) = ends[i, 0], ends[i, 1], (corners[j, k] for k in range(3))
    across = _volume(p, q, r, a) * _volume(p, q, r, b) < 0.0
    i, j, a, b, p, q, r = (v[across] for v in (i, j, a, b, p, q, r))
    around = np.stack([_volume(a, b, p, q), _volume(a, b, q, r), _volume(a, b, r, p)], axis=1)
    hit = (around > 0.0).all(axis=1) | (around < 0.0).all(axis=1)
    return np.stack([i[hit], j[hit]], axis=1).astype(np.int32)


def _volume(p: F64, q: F64, r: F64, s: F64) -> F64:
    """Six times the signed volumes of tetrahedra, shape (n,)."""
    return np.asarray(np.einsum("ij,ij->i", cross(q - p, r - p), s - p))


def _sorted(pairs: NDArray[np.intp], reach: F64) -> Crossings:
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    return Crossings(pairs[order].astype(np.int32), reach[order])


# ---------------------------------------------------------------------- broad phase


def _near_pairs(low: F64, high: F64, *, split: int | None = None) -> tuple[IPoints, IPoints]:
    """Pairs i < j of boxes that meet, by a uniform grid; with `split` only pairs across that index."""
    extent = high - low
    cell = max(CELL * float(extent.max(axis=1).mean()), np.finfo(float).tiny)
    origin = low.min(axis=0)
    first = np.floor((low - origin) / cell).astype(np.int64)
    last = np.floor((high - origin) / cell).astype(np.int64)
    span = last - first + 1
    cells = span.prod(axis=1)
    large = cells > LARGE
    small = np.flatnonzero(~large)
    shape = last.max(axis=0) + 1
    owner = np.repeat(small, cells[small])
    number = np.arange(len(owner)) - np.repeat(np.cumsum(cells[small]) - cells[small], cells[small])
    x, rest = np.divmod(number, span[owner, 1] * span[owner, 2])
    y, z = np.divmod(rest, span[owner, 2])
    place = first[owner] + np.stack([x, y, z], axis=1)
    key = (place[:, 0] * shape[1] + place[:, 1]) * shape[2] + place[:, 2]
    order = np.argsort(key, kind="stable")
    key, owner, place = key[order], owner[order], place[order]
    # Every entry is paired with the later ones of its cell.
    stop = np.searchsorted(key, key, side="right")
    count = stop - np.arange(len(key)) - 1
    found_i, found_j = [], []
    total = np.cumsum(count)
    start = 0
    while start < len(key):
        budget = (total[start - 1] if start else 0) + 4 * CHUNK
        end = max(start + 1, int(np.searchsorted(total, budget, side="right")))
        p = np.repeat(np.arange(start, end), count[start:end])
        begin = np.cumsum(count[start:end]) - count[start:end]
        q = p + 1 + np.arange(len(p)) - np.repeat(begin, count[start:end])
        i, j = owner[p], owner[q]
        # Counted in the one cell that holds the least corner of the common box.
        here = (np.maximum(first[i], first[j]) == place[p]).all(axis=1)
        meet = here & ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
        found_i.append(i[meet])
        found_j.append(j[meet])
        start = end
    for k in np.flatnonzero(large):
        meet = np.flatnonzero(((low[k] <= high) & (low <= high[k])).all(axis=1))
        meet = meet[(meet > k) | ((meet < k) & ~large[meet])]
        found_i.append(np.full(len(meet), k))
        found_j.append(meet)
    i, j = (np.concatenate([np.empty(0, dtype=np.intp), *f]) for f in (found_i, found_j))
    i, j = np.minimum(i, j), np.maximum(i, j)
    if split is not None:
        across = (i < split) & (j >= split)
        i, j = i[across], j[across]
    return i, j


def _near_in_groups(low: F64, high: F64, groups: NDArray[np.intp]) -> tuple[IPoints, IPoints]:
    """Pairs i < j of boxes of one group that meet; groups are runs of boxes."""
    from .soup_kernels import met_in_groups

    order = np.lexsort((low[:, 0], np.repeat(np.arange(len(groups)), groups)))
    found = met_in_groups(low, high, order, np.concatenate([[0], np.cumsum(groups)]).astype(np.int64))
    return found[:, 0], found[:, 1]


# ---------------------------------------------------------------------- edges


class _Edges(NamedTuple):
    """Undirected edges of a surface: sorted keys of all triangle sides, and the triangle of each."""

    key: NDArray[np.int64]
    face: IPoints


def _edge_keys(solid: Solid, faces: I32) -> NDArray[np.int64]:
    """Key of the side opposite to corner 2, 0, 1 of each triangle (sides 01, 12, 20), shape (n, 3)."""
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).astype(np.int64)
    return np.asarray(sides[..., 0] * len(solid.vertices) + sides[..., 1])


def _edge_owners(solid: Solid) -> _Edges:
    key = _edge_keys(solid, solid.faces).reshape(-1)
    order = np.argsort(key, kind="stable")
    return _Edges(key[order], order // 3)


def _neighbour(owners: _Edges, key: NDArray[np.int64], face: IPoints) -> IPoints:
    """The other triangle of an edge that has exactly two; -1 elsewhere."""
    start, stop = np.searchsorted(owners.key, key, side="left"), np.searchsorted(owners.key, key, side="right")
    two = stop - start == 2
    first = owners.face[np.minimum(start, len(owners.face) - 1)]
    second = owners.face[np.minimum(start + 1, len(owners.face) - 1)]
    return np.where(two, np.where(first == face, second, first), -1)


def _folded(solid: Solid, owners: _Edges, one: IPoints, two: IPoints, noise: float) -> F64:
    """Neighbours across an edge of two triangles that lie on each other: overlap across the edge [m], shape (n,)."""
    value = np.zeros(len(one))
    if len(one) == 0:
        return value
    faces, triangles = solid.faces, solid.triangles
    mine = (faces[one][:, :, None] == faces[two][:, None]).any(axis=2)
    own, other = (~mine).argmax(axis=1), (~(faces[two][:, :, None] == faces[one][:, None]).any(axis=2)).argmax(axis=1)
    rows = np.arange(len(one))
    start = triangles[one][rows, (own + 1) % 3]
    edge = triangles[one][rows, (own + 2) % 3] - start
    edge /= np.maximum(np.linalg.norm(edge, axis=1), np.finfo(float).tiny)[:, None]
    key = _edge_keys(solid, faces[one])[rows, (own + 1) % 3]
    manifold = _neighbour(owners, key, one) == two
    arms = []
    for tip in (triangles[one][rows, own], triangles[two][rows, other]):
        arm = tip - start
        arms.append(arm - np.einsum("ni,ni->n", arm, edge)[:, None] * edge)
    lengths = [np.linalg.norm(a, axis=1) for a in arms]
    aligned = np.einsum("ni,ni->n", arms[0], arms[1]) > 0.0
    shorter = np.minimum(*lengths)
    gap = np.linalg.norm(cross(arms[0], arms[1]), axis=1) / np.maximum(np.maximum(*lengths), np.finfo(float).tiny)
    folded = manifold & aligned & (gap <= noise) & (shorter > noise)
    return np.where(folded, shorter, 0.0)


def _through_edge(solid: Solid, owners: _Edges, one: IPoints, two: IPoints, noise: float) -> F64:
    """Pairs where a side of one triangle lies in the other, and the surface goes through there: the rise [m], shape (n,)."""
    value = np.zeros(len(one))
    for first, second in ((one, two), (two, one)):
        plane, t = solid.triangles[first], solid.triangles[second]
        normal, wide = planes_of(plane)
        h = heights(t, plane, normal, noise)
        rows = np.flatnonzero(((h == 0.0).sum(axis=1) == 2) & wide)
        if len(rows) == 0:
            continue
        tip = (h[rows] != 0.0).argmax(axis=1)
        side = (tip + 1) % 3
        key = _edge_keys(solid, solid.faces[second[rows]])[np.arange(len(rows)), side]
        beyond = _neighbour(owners, key, second[rows])
        real = beyond >= 0
        rows, tip, side, beyond = rows[real], tip[real], side[real], beyond[real]
        rise = h[rows, tip]
        far = heights(solid.triangles[beyond], plane[rows], normal[rows], noise)
        drop = np.where(rise > 0.0, -far.min(axis=1), far.max(axis=1))
        here = np.arange(len(rows))
        ends = t[rows][here, side], t[rows][here, (side + 1) % 3]
        inside = _clipped(plane[rows], normal[rows], *ends, noise)
        through = (drop > 0.0) & (inside > noise)
        value[rows] = np.maximum(value[rows], np.where(through, np.minimum(np.abs(rise), drop), 0.0))
    return value


def _crowded_edges(solid: Solid, owners: _Edges, noise: float) -> Crossings:
    """Edges with more than two triangles where the surface goes through itself, as where two welded bodies overlap.

    Around an edge each triangle changes the winding number by one. Bodies that touch there take it from 0 to 1 and back;
    where it takes three values, bodies overlap or one is inside out.
    """
    pairs, reach = [np.empty((0, 2), dtype=np.intp)], []
    key, first, count = np.unique(owners.key, return_index=True, return_counts=True)
    for k in np.flatnonzero(count > 2):
        members = owners.face[first[k] : first[k] + count[k]]
        u, v = divmod(int(key[k]), len(solid.vertices))
        along = solid.vertices[v] - solid.vertices[u]
        length = float(np.linalg.norm(along))
        if length <= noise:
            continue
        faces = solid.faces[members]
        tip = solid.vertices[faces[(faces != u) & (faces != v)]] - solid.vertices[u]
        forth = np.array([(np.roll(f, -1)[f == u] == v).any() for f in faces])
        arm = tip - np.outer(tip @ along / length**2, along)
        arm /= np.maximum(np.linalg.norm(arm, axis=1), np.finfo(float).tiny)[:, None]
        angle = np.arctan2(cross(arm[0], arm) @ along / length, arm @ arm[0]) % (2.0 * np.pi)
        angle = np.where(angle > 2.0 * np.pi - SAME_ANGLE, 0.0, angle)
        order = np.argsort(angle, kind="stable")
        change = np.where(forth, 1, -1)[order]
        last = np.append(np.diff(angle[order]) > SAME_ANGLE, True)
        winding = np.append(np.cumsum(change)[last], 0)
        if winding[-2] == 0 and np.ptp(winding) >= 2:
            alike = members[forth] if forth.sum() >= 2 else members[~forth]
            pairs.append(np.sort(alike[:2])[None])
            reach.append(length)
    return Crossings(np.concatenate(pairs).astype(np.int32), np.array(reach))


def _clipped(t: F64, normal: F64, start: F64, end: F64, noise: float) -> F64:
    """Length of segments, farther than the noise inside triangles of the same plane [m], shape (n,)."""
    low, high = np.zeros(len(t)), np.ones(len(t))
    for k in range(3):
        edge = t[:, (k + 1) % 3] - t[:, k]
        inward = cross(normal, edge)
        inward /= np.maximum(np.linalg.norm(inward, axis=1), np.finfo(float).tiny)[:, None]
        d0 = np.einsum("ni,ni->n", start - t[:, k], inward) - noise
        d1 = np.einsum("ni,ni->n", end - t[:, k], inward) - noise
        slope = d1 - d0
        cut = np.where(slope != 0.0, -d0 / np.where(slope != 0.0, slope, 1.0), np.where(d0 > 0.0, -np.inf, np.inf))
        low = np.where(slope > 0.0, np.maximum(low, cut), low)
        high = np.where(slope < 0.0, np.minimum(high, cut), high)
        high = np.where((slope == 0.0) & (d0 <= 0.0), -np.inf, high)
    return np.asarray(np.maximum(high - low, 0.0) * np.linalg.norm(end - start, axis=1))

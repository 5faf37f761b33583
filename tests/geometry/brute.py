"""Brute force over all pairs of triangles, vectorised, by other formulas than the code uses.

Points against triangles region by region (Ericson, Real-Time Collision Detection, 2005, 5.1.5), segments by the least of
the interior solution and the four ends, crossings by Moeller and Trumbore (1997), inside by signed ray crossings.
"""

from __future__ import annotations

import numpy as np
from worldagent.geometry import Solid
from worldagent.worlds.arrays import RigidPose

RAY = np.array([0.3127, 0.7411, 0.5936])
PAIRS = 60_000


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("...i,...i->...", a, b)


def point_triangle(p: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Distances of points (..., 3) to triangles (..., 3, 3), by broadcasting."""
    a, b, c = t[..., 0, :], t[..., 1, :], t[..., 2, :]
    ab, ac, bc = b - a, c - a, c - b
    ap, bp, cp = p - a, p - b, p - c
    d1, d2, d3, d4, d5, d6 = (_dot(x, y) for y in (ap, bp, cp) for x in (ab, ac))
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2

    def away(foot: np.ndarray) -> np.ndarray:
        gap = p - foot
        return np.sqrt(_dot(gap, gap))

    with np.errstate(divide="ignore", invalid="ignore"):
        on_ab = a + (d1 / (d1 - d3))[..., None] * ab
        on_ac = a + (d2 / (d2 - d6))[..., None] * ac
        on_bc = b + ((d4 - d3) / ((d4 - d3) + (d5 - d6)))[..., None] * bc
        normal = np.cross(ab, ac)
        height = np.abs(_dot(ap, normal)) / np.linalg.norm(normal, axis=-1)
        return np.select(
            [
                (d1 <= 0) & (d2 <= 0),
                (d3 >= 0) & (d4 <= d3),
                (vc <= 0) & (d1 >= 0) & (d3 <= 0),
                (d6 >= 0) & (d5 <= d6),
                (vb <= 0) & (d2 >= 0) & (d6 <= 0),
                (va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0),
            ],
            [away(a), away(b), away(on_ab), away(c), away(on_ac), away(on_bc)],
            height,
        )


def segments(p: np.ndarray, p2: np.ndarray, q: np.ndarray, q2: np.ndarray) -> np.ndarray:
    """Distances of segments, by broadcasting."""
    u, v, r = p2 - p, q2 - q, p - q
    a, b, c, d, e = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, r), _dot(v, r)
    det = a * c - b * b
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (b * e - c * d) / det, (a * e - b * d) / det
        good = (det > 1e-12 * a * c) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
        inner = np.linalg.norm(r + s[..., None] * u - t[..., None] * v, axis=-1)
    best = np.where(good, inner, np.inf)
    for x, o, w in ((p, q, v), (p2, q, v), (q, p, u), (q2, p, u)):
        k = np.clip(_dot(x - o, w) / _dot(w, w), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(x - o - k[..., None] * w, axis=-1))
    return best


def _crosses(p: np.ndarray, q: np.ndarray, t: np.ndarray) -> bool:
    """True if any segment p-q, shape (n, 3), goes through any triangle, shape (m, 3, 3)."""
    u, v, w, det = _ray(p, q - p, t)
    with np.errstate(invalid="ignore"):
        return bool(((det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (w >= 0) & (w <= 1)).any())


def _ray(p: np.ndarray, along: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    e1, e2 = t[None, :, 1] - t[None, :, 0], t[None, :, 2] - t[None, :, 0]
    along = np.broadcast_to(along, p.shape)[:, None]
    h = np.cross(along, e2)
    det = _dot(e1, h)
    s = p[:, None] - t[None, :, 0]
    q = np.cross(s, e1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return _dot(s, h) / det, _dot(along, q) / det, _dot(e2, q) / det, det


def soup_distance(ta: np.ndarray, tb: np.ndarray) -> float:
    """Distance of two triangle soups, shape (n, 3, 3) each; 0 where they cross."""
    best = np.inf
    step = max(1, PAIRS // len(tb))
    for i in range(0, len(ta), step):
        a, b = ta[i : i + step, None], tb[None]
        for k in range(3):
            best = min(best, point_triangle(a[..., k, :], b).min(), point_triangle(b[..., k, :], a).min())
            for m in range(3):
                best = min(best, segments(a[..., k, :], a[..., k - 1, :], b[..., m, :], b[..., m - 1, :]).min())
    for one, two in ((ta, tb), (tb, ta)):
        for k in range(3):
            if _crosses(one[:, k], one[:, k - 1], two):
                return 0.0
    return float(best)


def inside(t: np.ndarray, points: np.ndarray) -> np.ndarray:
    """True where points lie where the signed crossings of a ray do not cancel."""
    found = np.zeros(len(points), dtype=bool)
    step = max(1, PAIRS // len(t))
    for i in range(0, len(points), step):
        u, v, w, det = _ray(points[i : i + step], RAY, t)
        with np.errstate(invalid="ignore"):
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (w > 0)
        found[i : i + step] = np.where(hit, np.sign(det), 0.0).sum(axis=1) != 0
    return found


def _to_soup(points: np.ndarray, t: np.ndarray) -> np.ndarray:
    found = np.empty(len(points))
    step = max(1, PAIRS // len(t))
    for i in range(0, len(points), step):
        found[i : i + step] = point_triangle(points[i : i + step, None], t[None]).min(axis=1)
    return found


def _one_way(ta: np.ndarray, tb: np.ndarray, density: int, rounds: int) -> float:
    """Deepest point of a inside b: a grid on every triangle, then finer grids about the best few points."""
    i, j = np.meshgrid(np.arange(density + 1), np.arange(density + 1))
    keep = i + j <= density
    grid = np.stack([i[keep], j[keep]], axis=1) / density
    low, high = tb.min(axis=(0, 1)), tb.max(axis=(0, 1))
    ta = ta[((ta.min(axis=1) <= high) & (ta.max(axis=1) >= low)).all(axis=1)]
    if len(ta) == 0:
        return 0.0
    owner, place = np.repeat(np.arange(len(ta)), len(grid)), np.tile(grid, (len(ta), 1))
    best, width = 0.0, 1.0 / density
    for _ in range(rounds + 1):
        t = ta[owner]
        points = t[:, 0] + place[:, :1] * (t[:, 1] - t[:, 0]) + place[:, 1:] * (t[:, 2] - t[:, 0])
        within = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        within = within[inside(tb, points[within])]
        if len(within) == 0:
            return best
        depth = _to_soup(points[within], tb)
        order = np.argsort(-depth, kind="stable")[:8]
        best = max(best, float(depth[order[0]]))
        owner, centre = owner[within[order]], place[within[order]]
        width *= 0.4
        around = np.stack(np.meshgrid(np.linspace(-2, 2, 7), np.linspace(-2, 2, 7)), axis=-1).reshape(-1, 2) * width
        owner, place = np.repeat(owner, len(around)), (centre[:, None] + around).reshape(-1, 2)
        legal = (place >= 0).all(axis=1) & (place.sum(axis=1) <= 1)
        owner, place = owner[legal], place[legal]
    return best


def signed(a: Solid, pose_a: RigidPose, b: Solid, pose_b: RigidPose, *, density: int = 5, rounds: int = 7) -> float:
    """Signed clearance [m] by brute force; where bodies overlap a lower bound of the depth, good to a fraction of 1 %."""
    ta, tb = pose_a.apply(a.vertices)[a.faces], pose_b.apply(b.vertices)[b.faces]
    away = soup_distance(ta, tb)
    heads_a, heads_b = pose_a.apply(a.component_heads), pose_b.apply(b.component_heads)
    if away > 0.0 and not (b.closed and inside(tb, heads_a).any()) and not (a.closed and inside(ta, heads_b).any()):
        return away
    into_b = _one_way(ta, tb, density, rounds) if b.closed else 0.0
    into_a = _one_way(tb, ta, density, rounds) if a.closed else 0.0
    return -max(into_a, into_b)


def depth_of(point_a: np.ndarray, point_b: np.ndarray, a: Solid, pose_a: RigidPose, b: Solid, pose_b: RigidPose) -> float:
    """Depth [m] of a point on the surface of one body inside the other; 0 where none of the two points is such a point."""
    best = 0.0
    for point, one, pose_one, two, pose_two in ((point_a, a, pose_a, b, pose_b), (point_b, b, pose_b, a, pose_a)):
        ta, tb = pose_one.apply(one.vertices)[one.faces], pose_two.apply(two.vertices)[two.faces]
        if two.closed and inside(tb, point[None])[0] and _to_soup(point[None], ta)[0] < 1e-9 * one.size:
            best = max(best, float(_to_soup(point[None], tb)[0]))
    return best

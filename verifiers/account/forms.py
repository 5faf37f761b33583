"""The form of a mesh in one word with its sizes, by the directions of its faces: box, ball, cylinder, rod, sheet, wedge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from ...worlds.arrays import F64
    from ...worlds.built import TriangleMesh

__all__ = ["Form", "form_of", "joined_form"]

FLAT = float(np.cos(np.radians(1.0)))
"""Own choice: faces whose normals differ by less than a degree are one plane side; meshes of flat solids are exact to rounding."""
SQUARE = float(np.sin(np.radians(1.0)))
"""Own choice: two directions within a degree of a right angle are at right angles."""
MOST_SIDES = 8
"""Plane sides that are looked for; a solid with more has no word for its sides here."""
ROUND = 0.1
"""Own choice: mean deviation of normals from the plane through the axis [1]; a hexagonal prism has 0.26, 24 segments 0.07."""
EVEN = 0.02
"""Own choice: relative spread of distances up to which a ball or rod is one; facets of 16 segments are off by 0.02."""
CAP, SIDE = 0.999, 0.05
"""Cosine to the axis of caps of a cylinder, at least, and of its side, at most."""
HOLLOW = 0.6
"""Own choice: share of its hull that a round body fills, below which it is called hollow: a bowl has 0.3, a cone or lens 1."""


class Form(NamedTuple):
    """A word with sizes."""

    word: str
    sizes: tuple[float, ...]
    """[m]: of a ball its diameter, of a cylinder diameter and length, else extents, largest first."""


def form_of(mesh: TriangleMesh) -> Form:
    """The form of a closed mesh or a sheet; `body` with its extents where no word fits."""
    points = np.asarray(mesh.vertices, dtype=np.float64)
    corners = points[mesh.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(cross, axis=1)
    if not np.isfinite(points).all() or not areas.sum() > 0.0:
        return Form("body", ())
    real = areas > 1e-12 * areas.sum()
    normals, areas, middles = cross[real] / areas[real, None], areas[real], corners[real].mean(axis=1)
    sides = _sides(normals)
    found = _flat(points, sides) or _ball(points) or _rod(points) or _round(points, normals, areas, middles)
    return found or Form("body", _sorted(np.ptp(points, axis=0)))


def joined_form(points: F64) -> Form:
    """The form of the hull of points, shape (n, 3): of a body of many pieces, as it is before it breaks."""
    from ...worlds.built import TriangleMesh

    hull = _hull(points)
    if hull is None:
        return Form("body", _sorted(np.ptp(points, axis=0)))
    return form_of(TriangleMesh(points, hull.simplices.astype(np.int32)))


def _sorted(extents: F64) -> tuple[float, ...]:
    return tuple(sorted((float(e) for e in extents), reverse=True))


def _sides(normals: F64) -> F64 | None:
    """Different directions of the faces, shape (n, 3); None for more than `MOST_SIDES`."""
    left, found = np.ones(len(normals), dtype=bool), list[Any]()
    while left.any():
        if len(found) == MOST_SIDES:
            return None
        found.append(normals[left][0])
        left &= normals @ found[-1] < FLAT
    return np.array(found)


def _flat(points: F64, sides: F64 | None) -> Form | None:
    """Sheet, box or wedge."""
    if sides is None:
        return None
    turned = sides @ sides.T
    pairs = [(i, j) for i in range(len(sides)) for j in range(i) if turned[i, j] < -FLAT]
    if len(sides) <= 2 and len(pairs) == len(sides) - 1:
        extents = np.ptp((points - points[0]) @ _frame(sides[0], points).T, axis=0)
        return Form("sheet", _sorted(extents[1:]))
    axes = sides[[i for i, _ in pairs]]
    if len(sides) == 6 and len(pairs) == 3 and np.abs(axes @ axes.T - np.eye(3)).max() < SQUARE:
        return Form("box", _sorted(np.ptp(points @ axes.T, axis=0)))
    if len(sides) == 5 and len(pairs) == 1:
        across = next((s for s in sides if abs(s @ axes[0]) < SQUARE), None)
        if across is not None:
            frame = np.array([axes[0], across, np.cross(axes[0], across)])
            return Form("wedge", _sorted(np.ptp(points @ frame.T, axis=0)))
    return None


def _frame(normal: F64, points: F64) -> F64:
    """Normal, and two directions in the plane along the longest edge of its points, shape (3, 3)."""
    flat = points - points.mean(axis=0)
    flat = flat - np.outer(flat @ normal, normal)
    values, vectors = np.linalg.eigh(flat.T @ flat)
    along = vectors[:, 2] if values[2] > 1.001 * values[1] else next(e for e in np.eye(3) if abs(e @ normal) < 0.9)
    along = along - (along @ normal) * normal
    along = along / np.linalg.norm(along)
    return np.array([normal, along, np.cross(normal, along)])


def _ball(points: F64) -> Form | None:
    away = np.linalg.norm(points - 0.5 * (points.min(axis=0) + points.max(axis=0)), axis=1)
    if away.min() < (1.0 - EVEN) * away.max():
        return None
    return Form("ball", (2.0 * float(away.max()),))


def _axes(points: F64, center: F64) -> F64:
    """Principal axes about a centre, shape (3, 3)."""
    spread = points - center
    return np.asarray(np.linalg.eigh(spread.T @ spread)[1].T)


def _rod(points: F64) -> Form | None:
    """A cylinder with round ends."""
    axis = _axes(points, points.mean(axis=0))[2]
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    along = (points - middle) @ axis
    half = 0.5 * float(np.ptp(along))
    radius = float(np.linalg.norm(points - middle - np.outer(along, axis), axis=1).max())
    if half <= radius:
        return None
    core = np.clip(along, radius - half, half - radius)
    away = np.linalg.norm(points - middle - np.outer(core, axis), axis=1)
    even = (1.0 - EVEN) * radius < away.min() and away.max() < (1.0 + EVEN) * radius
    return Form("rod with round ends", (2.0 * radius, 2.0 * half)) if even else None


def _round(points: F64, normals: F64, areas: F64, middles: F64) -> Form | None:
    """A cylinder, or another body turned about an axis."""
    center = np.average(middles, axis=0, weights=areas)  # of any body of revolution on its axis
    capped = normals[np.argsort(-areas, kind="stable")[:8]]
    for axis in np.concatenate([_axes(points, center), capped]):
        out = middles - center
        out = out - np.outer(out @ axis, axis)
        reach = np.linalg.norm(out, axis=1)
        wide = float(reach.max())
        off = reach > 1e-3 * wide
        if not off.any():
            continue
        across = np.cross(axis, out[off] / reach[off, None])
        if np.average(np.abs(np.sum(normals[off] * across, axis=1)), weights=areas[off]) > ROUND:
            continue
        along = (points - center) @ axis
        radius = float(np.linalg.norm(points - center - np.outer(along, axis), axis=1).max())
        sizes = (2.0 * radius, float(np.ptp(along)))
        facing = np.abs(normals @ axis)
        plain = areas[(facing > CAP) | (facing < SIDE)].sum() > 0.98 * areas.sum()
        full = _filled(points, normals, areas, middles)
        if full < HOLLOW:
            return Form("hollow round body", sizes)
        return Form("cylinder" if plain and full > 0.97 else "round body", sizes)
    return None


def _filled(points: F64, normals: F64, areas: F64, middles: F64) -> float:
    """Volume as a share of that of the hull."""
    hull = _hull(points)
    # Divergence theorem: a triangle's area is half the length of its cross product.
    volume = abs(float(np.sum(np.sum((middles - points.mean(axis=0)) * normals, axis=1) * areas))) / 6.0
    return 0.0 if hull is None or hull.volume <= 0.0 else volume / float(hull.volume)


def _hull(points: F64) -> Any:
    """Convex hull; None where the points lie in a plane."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return ConvexHull(points)
    except (QhullError, ValueError):
        return None

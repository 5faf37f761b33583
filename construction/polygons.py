"""Convex partition of simple polygons: ear clipping, then Hertel-Mehlhorn merging.

Source: J. O'Rourke, *Computational Geometry in C*, 2nd ed., sections 1.4 and 2.5.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..worlds.errors import InputError

__all__ = ["convex_partition", "is_convex", "signed_area", "triangulate"]

Point = tuple[float, float]


def _cross(o: Point, a: Point, b: Point) -> float:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def signed_area(polygon: Sequence[Point]) -> float:
    """Area [m^2], positive when counter-clockwise."""
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(polygon, [*polygon[1:], polygon[0]], strict=True))


def _crosses(p: Point, q: Point, a: Point, b: Point) -> bool:
    return _cross(p, q, a) * _cross(p, q, b) < 0 and _cross(a, b, p) * _cross(a, b, q) < 0


def _touches(p: Point, a: Point, b: Point) -> bool:
    """True if p lies on the segment from a to b, to a billionth of its length."""
    x, y = b[0] - a[0], b[1] - a[1]
    square = x * x + y * y
    along = (p[0] - a[0]) * x + (p[1] - a[1]) * y
    return abs(_cross(a, b, p)) <= 1e-9 * square and -1e-9 * square <= along <= (1 + 1e-9) * square


def _require_simple(polygon: Sequence[Point]) -> None:
    n = len(polygon)
    for i in range(n):
        a, b = polygon[i], polygon[(i + 1) % n]
        for j in range(n):
            if j > i and _crosses(a, b, polygon[j], polygon[(j + 1) % n]):
                raise InputError(f"polygon edges {i} and {j} cross each other; give a simple polygon")
            if j not in (i, (i + 1) % n) and _touches(polygon[j], a, b):
                raise InputError(f"polygon point {j} repeats or touches edge {i}; give a simple polygon")


def triangulate(polygon: Sequence[Point]) -> list[tuple[int, int, int]]:
    """Triangles (indices, counter-clockwise) of a simple counter-clockwise polygon.

    Raises:
        InputError: the polygon crosses itself or has no area.
    """
    _require_simple(polygon)
    if signed_area(polygon) <= 0:
        raise InputError("polygon has no area or runs clockwise; list its points counter-clockwise")
    left = list(range(len(polygon)))
    triangles: list[tuple[int, int, int]] = []
    while len(left) > 3:
        for k in range(len(left)):
            i, j, m = left[k - 1], left[k], left[(k + 1) % len(left)]
            a, b, c = polygon[i], polygon[j], polygon[m]
            turn = _cross(a, b, c)
            if turn < 0:
                continue
            if turn > 0 and any(
                min(_cross(a, b, polygon[o]), _cross(b, c, polygon[o]), _cross(c, a, polygon[o])) >= 0
                for o in left
                if o not in (i, j, m) and polygon[o] not in (a, b, c)
            ):
                continue
            if turn > 0:
                triangles.append((i, j, m))
            left.pop(k)
            break
        else:
            raise InputError("polygon cannot be triangulated; its points repeat or touch an edge")
    if _cross(*(polygon[i] for i in left)) > 0:
        triangles.append((left[0], left[1], left[2]))
    return triangles


def is_convex(polygon: Sequence[Point], ring: Sequence[int]) -> bool:
    """True if the corners of a ring (indices) never turn to the right."""
    n = len(ring)
    return all(_cross(polygon[ring[k - 1]], polygon[ring[k]], polygon[ring[(k + 1) % n]]) >= -1e-15 for k in range(n))


def _merge(a: Sequence[int], b: Sequence[int]) -> list[int] | None:
    """Join two rings along their shared edge; None when they share none."""
    for k in range(len(a)):
        start, end = a[k], a[(k + 1) % len(a)]
        for m in range(len(b)):
            if b[m] == end and b[(m + 1) % len(b)] == start:
                ring_a = [a[(k + 1 + t) % len(a)] for t in range(len(a))]
                ring_b = [b[(m + 2 + t) % len(b)] for t in range(len(b) - 2)]
                return ring_a + ring_b
    return None


def convex_partition(polygon: Sequence[Point]) -> list[list[int]]:
    """Convex rings (indices, counter-clockwise) that tile a simple counter-clockwise polygon."""
    if is_convex(polygon, range(len(polygon))) and signed_area(polygon) > 0:
        return [list(range(len(polygon)))]
    rings: list[list[int]] = [list(t) for t in triangulate(polygon)]
    merged = True
    while merged:
        merged = False
        for i in range(len(rings)):
            for j in range(i + 1, len(rings)):
                joined = _merge(rings[i], rings[j])
                if joined is not None and is_convex(polygon, joined):
                    rings[i] = joined
                    rings.pop(j)
                    merged = True
                    break
            if merged:
                break
    return rings

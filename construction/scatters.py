"""Places of many of one kind: rows and grids, circles, and a scatter inside a polygon whose outlines stay apart."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..worlds.arrays import F64, RigidPose
from ..worlds.errors import InputError, RefusedError
from .placing import turned
from .scenes import Body

__all__ = ["Place", "Scatter", "circle", "grid", "random_sizes", "random_yaws", "scatter"]

TRIES = 300
"""Own choice: places that are tried for each one of a scatter before it is said that no more fit."""


@dataclass(frozen=True)
class Place:
    """Pose of one copy, and its size as a factor of the original's."""

    pose: RigidPose
    size: float = 1.0


@dataclass(frozen=True)
class Scatter:
    """Numbers of a scatter."""

    count: int
    polygon: F64
    """Corners x, y in order [m], shape (n, 2)."""
    gap: float
    """Least distance between the outlines from above [m]."""
    sizes: tuple[float, float]
    """Least and greatest factor."""
    random_yaw: bool
    seed: int


def grid(pose: RigidPose, counts: tuple[int, int], spacing: tuple[float, float]) -> Iterator[Place]:
    """Places of a grid of columns along x and rows along y, the first one where the original stands.

    Args:
        pose: of the original.
        counts: columns and rows.
        spacing: from origin to origin along x and y [m].
    """
    for row in range(counts[1]):
        for column in range(counts[0]):
            yield Place(RigidPose(pose.position + np.array([column * spacing[0], row * spacing[1], 0.0]), pose.quaternion))


def circle(pose: RigidPose, count: int, center: tuple[float, float], arc: float, *, along: bool) -> Iterator[Place]:
    """Places on the circle about a centre through the original, counter-clockwise from it.

    Args:
        pose: of the original.
        count: of all places.
        center: x, y [m].
        arc: angle from the first to the last [rad]; of a full turn the last place is no second one on the first.
        along: whether they turn with the circle.
    """
    steps = count if abs(abs(arc) - 2 * np.pi) < 1e-9 else count - 1
    middle = np.array([*center, pose.position[2]])
    if np.linalg.norm(pose.position - middle) < 1e-9:
        raise InputError(
            f"the entity stands on the centre {tuple(center)} of the circle; its distance from there is the radius: move it with `at`"
        )
    for k in range(count):
        yaw = arc * k / steps
        turn = turned(RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])), yaw)
        there = middle + turn.apply((pose.position - middle)[None])[0]
        yield Place(turned(RigidPose(there, pose.quaternion), yaw) if along else RigidPose(there, pose.quaternion))


def scatter(
    asked: Scatter,
    body: Body,
    quaternion: F64,
    settle: Callable[[RigidPose, Body], RigidPose],
    free: Callable[[RigidPose, Body], bool],
) -> list[Place]:
    """Places inside a polygon at which the outlines from above are whole inside it and apart; equal seeds give equal places.

    Outlines are convex hulls of all vertices seen from above, so that bodies whose outlines are apart do not overlap.

    Args:
        asked: how many and where.
        body: the original, which is the first one, at its own size and yaw.
        quaternion: its orientation.
        settle: brings a copy of this form to its height and tilt.
        free: whether it meets nothing else there.

    Raises:
        RefusedError: not all find a place.
        InputError: the polygon has no area.
    """
    polygon = _checked(asked.polygon)
    rng = np.random.default_rng(asked.seed)
    sizes = np.concatenate([[1.0], rng.uniform(*asked.sizes, asked.count - 1)])
    found: dict[int, Place] = {}
    outlines: list[F64] = []
    low, high = polygon.min(0), polygon.max(0)
    for k in np.argsort(-sizes, kind="stable"):  # the large ones first, while there is room
        size = float(sizes[k])
        shape = body if size == 1.0 else body.scaled(size)
        for _ in range(TRIES):
            where, yaw = rng.uniform(low, high), rng.uniform(0, 2 * np.pi)
            pose = RigidPose(np.array([*where, 0.0]), quaternion)
            pose = turned(pose, yaw) if asked.random_yaw and k else pose
            if not _fits(_outline(shape, pose), polygon, outlines, asked.gap):
                continue
            pose = settle(pose, shape)
            outline = _outline(shape, pose)
            if _fits(outline, polygon, outlines, asked.gap) and free(pose, shape):
                break
        else:
            raise RefusedError(
                f"{len(found)} of {asked.count} find a place in the polygon, {TRIES} places tried for the next one; give a larger polygon, "
                "fewer of them, a smaller gap or smaller sizes"
            )
        found[int(k)] = Place(pose, size)
        outlines.append(outline)
    return [found[k] for k in range(asked.count)]


def _checked(polygon: F64) -> F64:
    """The polygon counter-clockwise."""
    x, y = polygon.T
    area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    if len(polygon) < 3 or abs(area) < 1e-9:
        raise InputError(f"the polygon {polygon.tolist()} has no area; give its corners x, y in order, at least three")
    return polygon if area > 0 else polygon[::-1]


def _outline(body: Body, pose: RigidPose) -> F64:
    """Convex hull from above, counter-clockwise, shape (n, 2) [m]."""
    from scipy.spatial import ConvexHull

    points = body.points(pose)[:, :2]
    return np.asarray(points[ConvexHull(points).vertices])


def _fits(outline: F64, polygon: F64, others: Sequence[F64], gap: float) -> bool:
    if not _inside(outline, polygon).all() or _inside(polygon, outline).any() or _cross(outline, polygon):
        return False
    low, high = outline.min(0) - gap, outline.max(0) + gap
    return not any(
        bool((other.min(0) < high).all() and (other.max(0) > low).all()) and _separation(outline, other) < gap + 1e-9
        for other in others
    )


def _separation(a: F64, b: F64) -> float:
    """Distance of two convex outlines along the best normal of their sides [m], a lower bound; negative where they overlap."""
    best = -np.inf
    for one, two in ((a, b), (b, a)):
        side = np.roll(one, -1, axis=0) - one
        normal = np.column_stack([side[:, 1], -side[:, 0]]) / np.linalg.norm(side, axis=1)[:, None]
        best = max(best, float((two @ normal.T - (one * normal).sum(1)).min(0).max()))
    return best


def _inside(points: F64, polygon: F64) -> np.ndarray:
    """Mask of the points that lie inside a polygon, by the number of its sides to their right, shape (n,)."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    x, y = points[:, 0, None], points[:, 1, None]
    spans = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return np.asarray((spans & (x < at)).sum(1) % 2 == 1)


def _cross(a: F64, b: F64) -> bool:
    """True where sides of two polygons cross."""

    def turn(p: F64, q: F64, r: F64) -> F64:
        return np.asarray((q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0]))

    p, q = a[:, None], np.roll(a, -1, axis=0)[:, None]
    r, s = b[None], np.roll(b, -1, axis=0)[None]
    return bool(((turn(p, q, r) * turn(p, q, s) < 0) & (turn(r, s, p) * turn(r, s, q) < 0)).any())


def random_yaws(count: int, seed: int) -> F64:
    """Angles of all but the first [rad], which keeps its own."""
    return np.concatenate([[0.0], np.random.default_rng(seed).uniform(0, 2 * np.pi, count - 1)])


def random_sizes(count: int, sizes: tuple[float, float], seed: int) -> F64:
    """Factors of all but the first, which keeps its own."""
    return np.concatenate([[1.0], np.random.default_rng([seed, 1]).uniform(*sizes, count - 1)])

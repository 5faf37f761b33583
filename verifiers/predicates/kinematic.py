"""Evaluators of predicates about where things are and how they move."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Crosses, Displacement, JointAngle, Reaches, Speed, StaysIn, Tilts, Topples
from ...worlds.spec import BoxRegion, CylinderRegion, SphereRegion
from ..categories.registry import judge_of
from ..ledgers import motion
from .outcome import Comparison, Outcome, Series, band, judge, vector

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Region
    from .scope import Scope

__all__ = [
    "crosses",
    "displacement",
    "joint_angle",
    "points_in_region",
    "reaches",
    "region_offset",
    "speed",
    "stays_in",
    "tilts",
    "topples",
]

TINY = 1e-300
"""Keeps a margin below zero, and a distance above it, where the entity was exactly on the plane."""
MOST_SURFACE_POINTS = 20_000
"""Above this many visible vertices `measure=surface` takes the corners of the convex hull (regions are convex)."""
WAY = 33
"""Own choice: points of a straight way between two frames at which it is looked whether it goes through a region."""


def region_offset(region: Region, points: F64) -> tuple[F64, F64]:
    """Signed depth inside a region [m], negative outside, and offset from the region's nearest point [m].

    Shapes (n, 3) -> (n,), (n, 3); the offset is zero inside. Points are in the region's own frame.
    """
    if isinstance(region, BoxRegion):
        low, high = np.array(region.min), np.array(region.max)
        offset = points - np.clip(points, low, high)
        inner = np.minimum(points - low, high - points).min(axis=1)
    elif isinstance(region, SphereRegion):
        arm = points - np.array(region.center)
        distance = np.linalg.norm(arm, axis=1)
        inner = region.radius - distance
        offset = arm * np.clip(1 - region.radius / np.maximum(distance, 1e-300), 0, None)[:, None]
    else:
        assert isinstance(region, CylinderRegion)
        arm = points - np.array(region.center)
        across = np.linalg.norm(arm[:, :2], axis=1)
        inner = np.minimum(region.radius - across, region.height / 2 - np.abs(arm[:, 2]))
        offset = np.zeros_like(points)
        offset[:, :2] = arm[:, :2] * np.clip(1 - region.radius / np.maximum(across, 1e-300), 0, None)[:, None]
        offset[:, 2] = np.sign(arm[:, 2]) * np.clip(np.abs(arm[:, 2]) - region.height / 2, 0, None)
    outside = np.linalg.norm(offset, axis=1)
    return np.where(outside > 0, -outside, inner), offset


def points_in_region(candidate: Candidate, region_id: str | None, points: F64, frame: int) -> NDArray[np.bool_]:
    """True of points in the world, shape (n, 3), that lie in a region at a frame; all where none is asked for.

    Raises:
        EvidenceError: there is no such region.
    """
    if region_id is None:
        return np.ones(len(points), dtype=bool)
    region = candidate.spec.graph.regions.get(region_id)
    if region is None:
        raise EvidenceError(f"region {region_id!r} is not in the scene graph")
    if region.relative_to is not None:
        at, turn = (t[frame] for t in motion.entity_poses(candidate, region.relative_to))
        points = (points - at) @ rotation_matrix(turn)
    return np.asarray(region_offset(region, points)[0] >= 0.0)


def _hull_points(vertices: F64) -> F64:
    if len(vertices) <= MOST_SURFACE_POINTS:
        return vertices
    from scipy.spatial import ConvexHull

    hull: F64 = vertices[ConvexHull(vertices).vertices]
    return hull


def _passes(region: Region, local: F64, i: int) -> int | None:
    """Index of the sample next to the one at `i` after which the straight way to the next one goes through the region; None: no way does."""
    share = np.linspace(0.0, 1.0, WAY)[:, None]
    for k in (i - 1, i):
        if 0 <= k < len(local) - 1 and np.isfinite(local[k : k + 2]).all():
            depth, _ = region_offset(region, local[k] + share * (local[k + 1] - local[k]))
            if (depth >= 0).any():
                return k
    return None


def _in_region(scope: Scope, entity: str, region_id: str, measure: str) -> Series:
    candidate, window = scope.candidate, scope.window
    region = candidate.spec.graph.regions.get(region_id)
    if region is None:
        raise EvidenceError(f"region {region_id!r} is not in the scene graph")
    centers = judge_of(candidate.spec, entity).centers(candidate, entity)[window]
    if region.relative_to is not None:
        at, turn = (t[window] for t in motion.entity_poses(candidate, region.relative_to))
    else:
        at, turn = np.zeros_like(centers), np.repeat([[1.0, 0, 0, 0]], len(centers), 0)
    with np.errstate(invalid="ignore", over="ignore"):
        frames_of = rotation_matrix(turn)
        local = np.einsum("fji,fj->fi", frames_of, centers - at)
        depth, offset = region_offset(region, local)
    if measure == "surface":
        parts = candidate.entity(entity).parts
        hulls = [(p.body, _hull_points(p.render.vertices)) for p in parts]
        for i, frame in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
            if entity in candidate.deforming:
                points = candidate.vertices(entity, frame)
            else:
                points = np.concatenate([candidate.pose(entity, frame, b).apply(v) for b, v in hulls])
            with np.errstate(invalid="ignore", over="ignore"):
                depths, offsets = region_offset(region, (points - at[i]) @ frames_of[i])
            worst = int(np.argmin(depths))
            depth[i], offset[i] = depths[worst], offsets[worst]
    with np.errstate(invalid="ignore", over="ignore"):
        offset = np.einsum("fij,fj->fi", frames_of, offset)  # along the world's axes, as whoever moves something needs it
    what = "centre" if measure == "center" else "surface"

    def tell(i: int) -> str:
        frame = scope.frames[0] + i
        if depth[i] >= 0:
            return f"{entity}'s {what} was {depth[i]:.3g} m inside region {region_id} at frame {frame}"
        return (
            f"{entity}'s {what} was {-depth[i]:.3g} m outside region {region_id} at frame {frame}, "
            f"offset {vector(offset[i])} m, centre at {vector(centers[i])} m, both in the world's frame"
        )

    def detail(i: int) -> dict[str, object]:
        told: dict[str, object] = {
            "distance": max(0.0, -float(depth[i])), "offset": offset[i].tolist(), "position": centers[i].tolist()
        }  # fmt: skip
        between = None if depth[i] >= 0 or measure == "surface" else _passes(region, local, i)
        return told if between is None else {**told, "passes_after_frame": scope.frames[0] + between}

    side: tuple[float, Comparison] = (0.0, "<=")
    return Series(scope.frames, -depth, depth, "m", entity, lambda i: side, tell, detail)


def reaches(scope: Scope, p: Reaches) -> Outcome:
    """Measured: distance outside the region (negative: depth inside) at the frame that decides.

    Its details tell `offset`, from the region's nearest point to what was measured, and `position`, both along the world's axes [m].
    """
    return judge(_in_region(scope, p.entity, p.region, p.measure), p.when)


def stays_in(scope: Scope, p: StaysIn) -> Outcome:
    """As `reaches`; the docstring of the model asks for every frame unless `when` says otherwise."""
    return judge(_in_region(scope, p.entity, p.region, p.measure), p.when)


# ---------------------------------------------------------------- travel and turning


def crosses(scope: Scope, p: Crosses) -> Outcome:
    """True from the first frame at which the centre is in front of the plane after having been behind it.

    The frame before the interval counts as a start, so that a passage during the first frame is seen. Measured:
    distance in front of the plane, the largest after having been behind.
    """
    normal = np.array(p.normal)
    length = float(np.linalg.norm(normal))
    if length == 0:
        raise EvidenceError("the plane's normal is zero")
    start = max(0, scope.frames[0] - 1)
    track = judge_of(scope.candidate.spec, p.entity).centers(scope.candidate, p.entity)[start : scope.frames[1] + 1]
    with np.errstate(invalid="ignore", over="ignore"):
        ahead = (track - np.array(p.point)) @ normal / length
    behind = np.concatenate([[-np.inf], np.maximum.accumulate(-ahead[:-1])])  # deepest behind before each frame
    passed = np.where(behind > 0, np.minimum(behind, ahead), np.minimum(behind, -TINY))
    passed[0] = min(-abs(ahead[0]), -TINY)
    robust = np.maximum.accumulate(passed)
    skip = scope.frames[0] - start
    margin, value = robust[skip:], ahead[skip:].copy()
    never_behind = not bool((ahead[:-1] < 0).any())
    best = int(np.nanargmax(ahead)) if np.isfinite(ahead).any() else 0

    def tell(i: int) -> str:
        if margin[i] >= 0:
            first = scope.frames[0] + int(np.argmax(margin >= 0))
            return f"{p.entity} passed the plane at frame {first}"
        if never_behind:
            return f"{p.entity} was never behind the plane: it was {ahead.min():.3g} m in front of it at the least"
        return f"{p.entity} stayed {-ahead[best]:.3g} m behind the plane at the nearest, at frame {start + best}"

    side: tuple[float, Comparison] = (0.0, ">=")
    series = Series(
        scope.frames,
        value,
        margin,
        "m",
        p.entity,
        lambda i: side,
        tell,
        lambda i: {"distance": max(0.0, -float(ahead[best])), "closest_frame": start + best},
    )
    outcome = judge(series, "eventually")
    if outcome.status == "pass" or outcome.details.get("non_finite"):
        return outcome
    after = ahead[behind > 0]
    if len(after):
        return replace(outcome, value=float(after.max()))
    # It never was behind, or at the last frame only: what is missing is the start.
    nearest = float(ahead.min())
    return replace(outcome, value=nearest if nearest < 0 else max(nearest, TINY), comparison=">=" if nearest < 0 else "<=")


def tilts(scope: Scope, p: Tilts) -> Outcome:
    """Measured: angle between the entity's own axis and where it pointed at frame 0."""
    angle = motion.angles(scope.candidate, p.entity, np.array(p.axis))[scope.window]
    margin, side = band(angle, p.min, p.max)
    return judge(
        Series(scope.frames, angle, margin, "rad", p.entity, side, _say(scope, p.entity, "tilted", angle, "rad")), p.when
    )


def topples(scope: Scope, p: Topples) -> Outcome:
    """True where the z axis is at least `min_angle` from frame 0; must be so at the end and not at the start."""
    angle = motion.angles(scope.candidate, p.entity, np.array([0.0, 0.0, 1.0]))[scope.window]
    margin, side = band(angle, p.min_angle, None)
    largest = int(np.argmax(angle)) if np.isfinite(angle).all() else 0

    def tell(i: int) -> str:
        peak = f"largest angle {angle[largest]:.3g} rad at frame {scope.frames[0] + largest}"
        return f"{p.entity} ended {angle[-1]:.3g} rad from where it stood at frame 0; {peak}"

    def detail(i: int) -> dict[str, object]:
        return {"largest_angle": float(angle[largest]), "largest_frame": scope.frames[0] + largest}

    outcome = judge(Series(scope.frames, angle, margin, "rad", p.entity, side, tell, detail), "end")
    if outcome.status == "pass" and scope.frames[0] > 0 and angle[0] >= p.min_angle:
        text = f"{p.entity} had already toppled at frame {scope.frames[0]}, where the interval begins ({angle[0]:.3g} rad)"
        return Outcome(
            "fail",
            scope.frames,
            "rad",
            text,
            value=float(angle[0]),
            bound=p.min_angle,
            comparison="<=",
            truth=outcome.truth,
            margin=float(p.min_angle - angle[0]),
            first_true_frame=outcome.first_true_frame,
            first_failing_entity=p.entity,
            first_failing_frame=scope.frames[0],
            failing=(p.entity,),
            details={**outcome.details, "already": True},
        )
    return outcome


def speed(scope: Scope, p: Speed) -> Outcome:
    """Measured: speed of the centre of mass."""
    with np.errstate(invalid="ignore", over="ignore"):
        value = np.linalg.norm(motion.velocities(scope.candidate, p.entity)[scope.window], axis=1)
    margin, side = band(value, p.min, p.max)
    tell = _say(scope, p.entity, "moved at", value, "m/s")
    return judge(Series(scope.frames, value, margin, "m/s", p.entity, side, tell), p.when)


def displacement(scope: Scope, p: Displacement) -> Outcome:
    """Measured: distance of the centre of mass from frame 0, or its component along `axis`."""
    centers = judge_of(scope.candidate.spec, p.entity).centers(scope.candidate, p.entity)
    with np.errstate(invalid="ignore", over="ignore"):
        moved = centers[scope.window] - centers[0]
        if p.axis is None:
            value = np.linalg.norm(moved, axis=1)
        else:
            axis = np.array(p.axis)
            if not np.linalg.norm(axis) > 0:
                raise EvidenceError("the axis of the displacement is zero")
            value = moved @ (axis / np.linalg.norm(axis))
    margin, side = band(value, p.min, p.max)
    tell = _say(scope, p.entity, "was displaced by" if p.axis is None else "was displaced along the axis by", value, "m")
    return judge(Series(scope.frames, value, margin, "m", p.entity, side, tell), p.when)


def joint_angle(scope: Scope, p: JointAngle) -> Outcome:
    """Measured: the joint's coordinate as its engine records it, zero in the configuration of frame 0."""
    joint = scope.candidate.spec.simulation.joints.get(p.joint)
    if joint is None:
        raise EvidenceError(f"joint {p.joint!r} is not in the simulation plan")
    for cache in scope.candidate.rigid_caches.values():
        if p.joint in cache.index.joints:
            value: F64 = cache.series("joint")[scope.window, cache.index.joints.index(p.joint)]
            break
    else:
        raise EvidenceError(f"no cache records the coordinate of joint {p.joint!r} (hinges and slides have one)")
    unit = "m" if joint.kind == "slide" else "rad"
    margin, side = band(value, p.min, p.max)
    return judge(
        Series(scope.frames, value, margin, unit, joint.child, side, _say(scope, p.joint, "stood at", value, unit)), p.when
    )


def _say(scope: Scope, name: str, verb: str, value: F64, unit: str) -> Callable[[int], str]:
    """Describes index i of a series, and the range of the series."""

    def tell(i: int) -> str:
        low, high = float(np.min(value)), float(np.max(value))
        return f"{name} {verb} {value[i]:.3g} {unit} at frame {scope.frames[0] + i} (range {low:.3g} to {high:.3g})"

    return tell

"""Where a body is between two written frames: what never happens at a frame may have happened on the way to the next.

The way of the centre is the cubic through the states at both frames, exact where forces are constant; it is asked at as many places as
resolve what is asked for. What contacts may have bent it by at most, a quarter of the change of velocity times the frame, is not known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Crosses, Displacement, Eventually, Or, Reaches, Tilts
from ...worlds.spec import BoxRegion, SphereRegion
from ..categories.registry import judge_of
from ..ledgers import motion
from .kinematic import region_offset

if TYPE_CHECKING:
    from ...worlds.spec import Region, SpecModel
    from .scope import Scope

__all__ = ["Passing", "passing"]

LEAST, MOST = 9, 513
"""Own choice: places on the way between two frames at which it is asked; the thinnest extent of a region is met four times."""


class Passing(NamedTuple):
    """A predicate that holds at no written frame, and may hold on the way up to `frame`."""

    frame: int
    sure: bool
    """True where it holds on every way that the states allow; else the frames are too far apart to tell."""
    told: str


def passing(scope: Scope, predicate: SpecModel) -> Passing | None:
    """The first way between two frames on which a predicate holds that holds at neither; None where none is found.

    Only places and turns are looked at: contacts are logged by step, and speeds change little between frames where nothing strikes.
    """
    if isinstance(predicate, Eventually):
        return passing(scope, predicate.predicate)
    if isinstance(predicate, Or):
        found = [f for f in (passing(scope, p) for p in predicate.of) if f is not None]
        return min(found, key=lambda f: (not f.sure, f.frame), default=None)
    if getattr(predicate, "when", "eventually") != "eventually":
        return None
    asked = _ASKED.get(type(predicate))
    return asked(scope, predicate) if asked is not None else None


class _Way(NamedTuple):
    """Places of a centre on its way through the intervals that end within the scope."""

    places: F64
    """[m], shape (n, k, 3), k places each, the first and the last those of the frames."""
    chord: F64
    """The same on straight ways."""
    bent: F64
    """By how much contacts may have bent the way [m], shape (n,)."""
    last: NDArray[np.intp]
    """Frames at which the intervals end, shape (n,)."""


def _way(scope: Scope, entity: str, thin: float) -> _Way:
    candidate = scope.candidate
    rows = np.arange(max(0, scope.frames[0] - 1), scope.frames[1])
    centers = judge_of(candidate.spec, entity).centers(candidate, entity)
    start, end, step = centers[rows], centers[rows + 1], 1.0 / candidate.spec.simulation.fps
    travel = float(np.nanmax(np.linalg.norm(end - start, axis=1), initial=0.0))
    count = int(np.clip(np.ceil(4.0 * travel / max(thin, 1e-9)), LEAST, MOST))
    s = np.linspace(0.0, 1.0, count)[None, :, None]
    chord = start[:, None] + s * (end - start)[:, None]
    try:
        speed = motion.velocities(candidate, entity)
    except EvidenceError:  # nothing tells but the ends
        return _Way(chord, chord, np.full(len(rows), np.inf), rows + 1)
    first, last = step * speed[rows, None], step * speed[rows + 1, None]
    places = (
        (2 * s**3 - 3 * s**2 + 1) * start[:, None] + (s**3 - 2 * s**2 + s) * first
        + (3 * s**2 - 2 * s**3) * end[:, None] + (s**3 - s**2) * last
    )  # fmt: skip
    change = (last - first)[:, 0]
    fall = step**2 * np.array(candidate.spec.simulation.gravity)
    bent = 0.25 * np.minimum(np.linalg.norm(change, axis=1), np.linalg.norm(change - fall, axis=1))
    return _Way(places, chord, bent, rows + 1)


def _found(way: _Way, measure: Callable[[F64], F64], told: str) -> Passing | None:
    """The first interval within which a measure rises above zero while it does not at its ends; `measure` takes (n, k, 3)."""
    with np.errstate(invalid="ignore", over="ignore"):
        over, straight = (measure(v)[:, 1:-1].max(axis=1) for v in (way.places, way.chord))
        ends = measure(way.places[:, [0, -1]]).max(axis=1)
    held = ((over > 0.0) | (straight > 0.0)) & (ends < 0.0)
    sure = held & (((over > 0.0) & (straight > 0.0)) | (over > way.bent))
    for rows, known in ((np.flatnonzero(sure), True), (np.flatnonzero(held), False)):
        if len(rows):
            frame = int(way.last[rows[0]])
            return Passing(frame, known, f"{told} on its way from frame {frame - 1} to frame {frame}")
    return None


def _thin(region: Region) -> float:
    if isinstance(region, BoxRegion):
        return float((np.array(region.max) - np.array(region.min)).min())
    return 2.0 * region.radius if isinstance(region, SphereRegion) else min(2.0 * region.radius, region.height)


def _reaches(scope: Scope, p: Reaches) -> Passing | None:
    region = scope.candidate.spec.graph.regions.get(p.region)
    if region is None:
        return None
    way = _way(scope, p.entity, _thin(region))
    if region.relative_to is not None:
        at, turn = motion.entity_poses(scope.candidate, region.relative_to)
        frames = way.last
        local = [
            np.einsum("nji,nj->ni", rotation_matrix(turn[k]), way.places[:, i] - at[k])
            for i, k in ((0, frames - 1), (-1, frames))
        ]
        s = np.linspace(0.0, 1.0, way.places.shape[1])[None, :, None]
        chord = local[0][:, None] + s * (local[1] - local[0])[:, None]
        way = _Way(chord, chord, way.bent, way.last)

    def inside(points: F64) -> F64:
        return region_offset(region, points.reshape(-1, 3))[0].reshape(points.shape[:2])

    found = _found(way, inside, f"{p.entity} goes through region {p.region}")
    # All of its surface is inside only where its centre is, and not always then.
    return found._replace(sure=False) if found is not None and p.measure == "surface" else found


def _crosses(scope: Scope, p: Crosses) -> Passing | None:
    normal = np.array(p.normal) / max(float(np.linalg.norm(p.normal)), 1e-300)
    way = _way(scope, p.entity, np.inf)
    return _found(way, lambda points: (points - np.array(p.point)) @ normal, f"{p.entity} passes the plane and comes back")


def _displacement(scope: Scope, p: Displacement) -> Passing | None:
    start = judge_of(scope.candidate.spec, p.entity).centers(scope.candidate, p.entity)[0]
    low, high = (-np.inf if p.min is None else p.min), (np.inf if p.max is None else p.max)
    way = _way(scope, p.entity, high - low)

    def within(points: F64) -> F64:
        moved = points - start
        length = np.linalg.norm(moved, axis=-1) if p.axis is None else moved @ (np.array(p.axis) / np.linalg.norm(p.axis))
        return np.asarray(np.minimum(length - low, high - length))

    return _found(way, within, f"{p.entity} is displaced so far")


def _tilts(scope: Scope, p: Tilts) -> Passing | None:
    """A body that turns by more than half a right angle from frame to frame may have pointed anywhere."""
    rows = np.arange(max(0, scope.frames[0] - 1), scope.frames[1])
    try:
        spins = motion.spins(scope.candidate, p.entity)
    except EvidenceError:
        return None
    turn = np.abs(spins) / scope.candidate.spec.simulation.fps
    angle = motion.angles(scope.candidate, p.entity, np.array(p.axis))
    low, high = (-np.inf if p.min is None else p.min), (np.inf if p.max is None else p.max)
    with np.errstate(invalid="ignore"):
        travel = np.maximum(turn[rows], turn[rows + 1])
        most = 0.5 * (angle[rows] + angle[rows + 1] + travel)
        least = 0.5 * (angle[rows] + angle[rows + 1] - travel)
        may = (travel > 0.25 * np.pi) & (most >= low) & (least <= high)
    at = np.flatnonzero(may)
    if not len(at):
        return None
    frame = int(rows[at[0]]) + 1
    told = f"{p.entity} turns by {travel[at[0]]:.3g} rad from frame {frame - 1} to frame {frame} and may tilt so far between"
    return Passing(frame, False, told)


_ASKED: Mapping[type, Callable[[Scope, Any], Passing | None]] = {
    Reaches: _reaches,
    Crosses: _crosses,
    Displacement: _displacement,
    Tilts: _tilts,
}

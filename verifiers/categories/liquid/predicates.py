"""Evaluators of predicates about liquids: from particles that an engine moved, and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import wraps
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.predicates import (
    LiquidArrives,
    LiquidFluxThrough,
    LiquidLevelAt,
    LiquidSpeed,
    LiquidTemperature,
    LiquidVolumeIn,
    SplashHeight,
    SubmergedFraction,
    WetArea,
)
from ...predicates.kinematic import points_in_region
from ...predicates.outcome import Comparison, Outcome, Series, band, judge
from .frames import Frame, Liquid
from .samples import triangles_by_parts
from .solids import Piece, pieces_of
from .submerged import Submerged
from .told import liquid_or_none, painted
from .wet import touched

if TYPE_CHECKING:
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope

__all__ = [
    "liquid_arrives",
    "liquid_flux_through",
    "liquid_level_at",
    "liquid_speed",
    "liquid_temperature",
    "liquid_volume_in",
    "splash_height",
    "submerged_fraction",
    "wet_area",
]

Banded = (
    LiquidVolumeIn
    | LiquidLevelAt
    | LiquidFluxThrough
    | SubmergedFraction
    | WetArea
    | SplashHeight
    | LiquidSpeed
    | LiquidTemperature
)
"""Predicates that bound a value from below, from above or both."""
P = TypeVar("P", bound=Banded | LiquidArrives)
CREST = 8
"""Particles that a splash needs: fewer are drops that nothing resolves."""
TOUCH = 1.0
"""[spacings] Liquid this near to a surface wets it."""
PART = 1.0
"""[spacings] Longest edge of the parts of a surface that are each wet or dry."""


def _of_liquid(
    kind: type[P], unit: str | Callable[[P], str], of: str = "entity"
) -> Callable[[Callable[[Scope, P, Liquid, int], Outcome]], Callable[[Scope, SpecModel], Outcome]]:
    """Evaluator of a predicate from what measures it on the particles of a liquid, which its field `of` names.

    Of a surface that only looks like a liquid nothing is measured (`painted`).
    """

    def evaluator(measure: Callable[[Scope, P, Liquid, int], Outcome]) -> Callable[[Scope, SpecModel], Outcome]:
        @wraps(measure)
        def evaluate(scope: Scope, predicate: SpecModel) -> Outcome:
            assert isinstance(predicate, kind)
            found = liquid_or_none(scope.candidate, getattr(predicate, of))
            if isinstance(found, str):
                return painted(scope, unit if isinstance(unit, str) else unit(predicate), predicate.entity, found)
            return measure(scope, predicate, *found)

        return evaluate

    return evaluator


def _frames(scope: Scope, liquid: Liquid, member: int) -> Iterator[tuple[int, Frame, NDArray[np.bool_]]]:
    """Place in the interval, frame and which of its particles are of the liquid."""
    for i, index in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
        frame = liquid.read(index)
        yield i, frame, frame.fluid == member


def _banded(scope: Scope, p: Banded, value: F64, unit: str, what: str) -> Outcome:
    margin, side = band(value, p.min, p.max)

    def tell(i: int) -> str:
        known = value[np.isfinite(value)]
        span = f" (range {known.min():.4g} to {known.max():.4g} {unit})" if len(known) else ""
        return f"{what} is {value[i]:.4g} {unit} at frame {scope.frames[0] + i}{span}"

    return judge(Series(scope.frames, value, margin, unit, p.entity, side, tell), p.when)


@_of_liquid(LiquidVolumeIn, "m^3")
def liquid_volume_in(scope: Scope, p: LiquidVolumeIn, liquid: Liquid, member: int) -> Outcome:
    """Measured: sum of the volumes of the particles whose middles are in the region."""
    value = np.zeros(scope.length)
    for i, frame, own in _frames(scope, liquid, member):
        value[i] = float(frame.volume[own & points_in_region(scope.candidate, p.region, frame.position, frame.index)].sum())
    return _banded(scope, p, value, "m^3", f"volume of {p.entity} in {p.region}")


@_of_liquid(LiquidLevelAt, "m")
def liquid_level_at(scope: Scope, p: LiquidLevelAt, liquid: Liquid, member: int) -> Outcome:
    """Measured: highest particle of the column plus half a particle."""
    radius = p.radius if p.radius is not None else 2.0 * liquid.spacing
    value = np.full(scope.length, float(liquid.lower[2]))
    for i, frame, own in _frames(scope, liquid, member):
        near = own & (np.hypot(*(frame.position[:, :2] - np.array(p.point)).T) <= radius)
        if near.any():
            value[i] = float(frame.position[near, 2].max()) + 0.5 * liquid.pitch
    return _banded(scope, p, value, "m", f"level of {p.entity} at {p.point}")


def _across(p: LiquidFluxThrough) -> tuple[F64, F64]:
    """Unit normal, and the two directions across it as rows: level, then across both."""
    normal = np.array(p.normal, dtype=np.float64)
    normal /= np.linalg.norm(normal)
    level = np.cross([0.0, 0.0, 1.0], normal)
    if np.linalg.norm(level) < 1e-9:
        level = np.array([1.0, 0.0, 0.0])
    level /= np.linalg.norm(level)
    return normal, np.stack([level, np.cross(normal, level)])


def _flux_unit(p: LiquidFluxThrough) -> str:
    return "m^3" if p.measure == "total" else "m^3/s"


@_of_liquid(LiquidFluxThrough, _flux_unit)
def liquid_flux_through(scope: Scope, p: LiquidFluxThrough, liquid: Liquid, member: int) -> Outcome:
    """Measured: volumes of particles whose straight way between two frames passes the disc or rectangle."""
    normal, across = _across(p)
    half = 0.5 * np.array(p.size) if p.size is not None else None
    passed = np.zeros(scope.length)
    before = liquid.read(scope.frames[0] - 1) if scope.frames[0] > 0 else None
    for i, frame, own in _frames(scope, liquid, member):
        if before is not None:
            _, here, there = np.intersect1d(frame.identity, before.identity, assume_unique=True, return_indices=True)
            a, b = before.position[there] - np.array(p.point), frame.position[here] - np.array(p.point)
            old, new = a @ normal, b @ normal
            rows = np.flatnonzero(((old < 0.0) != (new < 0.0)) & own[here])
            share = old[rows] / (old[rows] - new[rows])
            flat = (a[rows] + share[:, None] * (b[rows] - a[rows])) @ across.T
            hit = (
                (np.abs(flat) <= half).all(axis=1) if half is not None else np.linalg.norm(flat, axis=1) <= float(p.radius or 0.0)
            )
            passed[i] = float((frame.volume[here][rows] * np.sign(new[rows] - old[rows]))[hit].sum())
        before = frame
    value = np.cumsum(passed) if p.measure == "total" else passed / liquid.duration
    return _banded(scope, p, value, _flux_unit(p), f"what passed of {p.entity}")


@_of_liquid(LiquidArrives, "m^3")
def liquid_arrives(scope: Scope, p: LiquidArrives, liquid: Liquid, member: int) -> Outcome:
    """Measured: most volume that was there at any frame so far. First true: when it reaches `min_volume`."""
    target = [q for q in pieces_of(scope.candidate) if q.entity == p.target] if p.target is not None else []
    if p.target is not None and not target:
        raise EvidenceError(f"target {p.target!r} has no surface that a liquid can reach")
    value = np.zeros(scope.length)
    for i, frame, own in _frames(scope, liquid, member):
        if p.region is not None:
            there = own & points_in_region(scope.candidate, p.region, frame.position, frame.index)
        else:
            there = own & _near(target, frame, p.within if p.within is not None else TOUCH * liquid.spacing)
        value[i] = float(frame.volume[there].sum())
    value = np.maximum.accumulate(value)
    # One particle, whose volume single precision rounds.
    least = max(p.min_volume, 0.5 * liquid.pitch**3)
    where = p.region or p.target
    side: tuple[float, Comparison] = (least, ">=")

    def tell(i: int) -> str:
        at = np.flatnonzero(value >= least)
        if len(at):
            return f"{least:.3g} m^3 of {p.entity} are at {where} first at frame {scope.frames[0] + int(at[0])}, most {value[-1]:.4g} m^3"
        return f"at most {value[-1]:.4g} m^3 of {p.entity} are at {where}, needed {least:.3g} m^3"

    return judge(Series(scope.frames, value, value - least, "m^3", p.entity, lambda i: side, tell), "eventually")


def _near(pieces: list[Piece], frame: Frame, reach: float) -> NDArray[np.bool_]:
    """Which particles are within `reach` [m] of the surface of a solid."""
    from ....geometry import distance_to_surface

    result = np.zeros(frame.count, dtype=bool)
    for piece in pieces:
        low, high = piece.box(frame.index)
        rows = np.flatnonzero(((frame.position >= low - reach) & (frame.position <= high + reach)).all(axis=1) & ~result)
        if len(rows):
            local = piece.local(frame.position[rows], frame.index)
            result[rows] = (distance_to_surface(piece.solid, local).distance <= reach) | (piece.depth(local) > 0.0)
    return result


@_of_liquid(SubmergedFraction, "1", of="liquid")
def submerged_fraction(scope: Scope, p: SubmergedFraction, liquid: Liquid, member: int) -> Outcome:
    """Measured: share of points inside the entity that are lower than the liquid that stands about it, with no solid between.

    `categories/liquid/about.py` says what stands about it.
    """
    under = Submerged(scope.candidate, p.entity, liquid, member)
    value = np.array([under.share(f) for f in range(scope.frames[0], scope.frames[1] + 1)])
    return _banded(scope, p, value, "1", f"submerged share of {p.entity}")


@_of_liquid(WetArea, "m^2", of="liquid")
def wet_area(scope: Scope, p: WetArea, liquid: Liquid, member: int) -> Outcome:
    """Measured: points spread over the surface with a particle within one spacing on their outer side, each for its share of the area.

    That is what wet maps call wet (`categories/liquid/wet.py` judges those).
    """
    pieces = [q for q in pieces_of(scope.candidate) if q.entity == p.entity]
    if not pieces:
        raise EvidenceError(f"{p.entity!r} has no surface that a liquid can wet")
    spread = [_spread(q, liquid) for q in pieces]
    state = [np.zeros(len(x), dtype=bool) for x, *_ in spread]
    value = np.zeros(scope.length)
    for i, frame, own in _frames(scope, liquid, member):
        for piece, (points, area, normals), wet in zip(pieces, spread, state, strict=True):
            asked = ~wet if p.measure == "ever" else np.ones(len(area), dtype=bool)
            outward = normals[asked] @ piece.turn[frame.index].T
            wet[asked], _ = touched(frame.position[own], piece.world(points[asked], frame.index), outward, liquid.spacing)
            value[i] += float(area[wet].sum())
    return _banded(scope, p, value, "m^2", f"wet area of {p.entity}")


def _spread(piece: Piece, liquid: Liquid) -> tuple[F64, F64, F64]:
    """Middles of equal parts of each triangle that the liquid may reach, in the body's frame, shape (n, 3), the area of each part
    [m^2], shape (n,), and the normals there, shape (n, 3)."""
    low, high = liquid.extent[0] - TOUCH * liquid.spacing, liquid.extent[1] + TOUCH * liquid.spacing
    if not np.isfinite(low).all():
        return np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3))
    if piece.still:
        corners = piece.local(np.array([[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)]), 0)
        low, high = corners.min(axis=0), corners.max(axis=0)
    else:
        low, high = piece.solid.lower, piece.solid.upper
    points, areas, normals = [np.zeros((0, 3))], [np.zeros(0)], [np.zeros((0, 3))]
    for triangles, facing, k in triangles_by_parts(piece.solid, PART * liquid.spacing, low, high):
        weights = _middles(k)
        area = 0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
        points.append(np.einsum("wc,tcx->twx", weights, triangles).reshape(-1, 3))
        areas.append(np.repeat(area / k**2, k**2))
        normals.append(np.repeat(facing, k**2, axis=0))
    point = np.concatenate(points)
    within = ((point >= low) & (point <= high)).all(axis=1)
    return point[within], np.concatenate(areas)[within], np.concatenate(normals)[within]


def _middles(k: int) -> F64:
    """Barycentric coordinates of the middles of the k^2 equal triangles that a triangle is cut into, shape (k^2, 3)."""
    i, j = (x.reshape(-1) for x in np.meshgrid(np.arange(k), np.arange(k), indexing="ij"))
    up, down = i + j < k, i + j < k - 1
    first = np.concatenate([i[up] + 1.0 / 3.0, i[down] + 2.0 / 3.0]) / k
    second = np.concatenate([j[up] + 1.0 / 3.0, j[down] + 2.0 / 3.0]) / k
    return np.stack([first, second, 1.0 - first - second], axis=1)


@_of_liquid(SplashHeight, "m")
def splash_height(scope: Scope, p: SplashHeight, liquid: Liquid, member: int) -> Outcome:
    """Measured: height of the eighth highest particle."""
    base = p.over
    if base is None:
        first = liquid.read(0)
        heights = first.position[first.fluid == member, 2]
        base = float(heights.max()) if len(heights) else float(liquid.lower[2])
    value = np.full(scope.length, float(liquid.lower[2]) - base)
    for i, frame, own in _frames(scope, liquid, member):
        heights = frame.position[own, 2]
        if len(heights) >= CREST:
            value[i] = float(np.partition(heights, -CREST)[-CREST]) - base
    return _banded(scope, p, value, "m", f"height of {p.entity} over {base:.4g} m")


def _measured(values: F64, mass: F64, measure: str) -> float:
    chosen: dict[str, Callable[[], float]] = {
        "mean": lambda: float(np.average(values, weights=mass)),
        "largest": lambda: float(values.max()),
        "highest": lambda: float(values.max()),
        "lowest": lambda: float(values.min()),
    }
    return chosen[measure]()


@_of_liquid(LiquidSpeed, "m/s")
def liquid_speed(scope: Scope, p: LiquidSpeed, liquid: Liquid, member: int) -> Outcome:
    """Measured: mean or largest speed of the particles."""
    value = np.zeros(scope.length)
    for i, frame, own in _frames(scope, liquid, member):
        own = own & points_in_region(scope.candidate, p.region, frame.position, frame.index)
        if own.any():
            value[i] = _measured(np.linalg.norm(frame.velocity[own], axis=1), frame.mass[own], p.measure)
    return _banded(scope, p, value, "m/s", f"{p.measure} speed of {p.entity}")


@_of_liquid(LiquidTemperature, "K")
def liquid_temperature(scope: Scope, p: LiquidTemperature, liquid: Liquid, member: int) -> Outcome:
    """Measured: mean, lowest or highest temperature of the particles; where there are none the frame is not true."""
    value = np.full(scope.length, np.nan)
    for i, frame, own in _frames(scope, liquid, member):
        if "particle/temperature" not in frame.others:
            raise EvidenceError(
                f"no temperature is recorded of {p.entity!r}; give a liquid of its instance a temperature, conductivity or activation"
            )
        own = own & points_in_region(scope.candidate, p.region, frame.position, frame.index)
        if own.any():
            rows = np.argsort(frame.others["particle/id"], kind="stable")
            heat = np.asarray(frame.others["particle/temperature"], dtype=np.float64)[rows]
            if len(heat) != frame.count:
                raise EvidenceError(f"particles of frame {frame.index} are not all finite or share ids, see numerical:finite")
            value[i] = _measured(heat[own], frame.mass[own], p.measure)
    if np.isnan(value).all():
        raise EvidenceError(f"no particle of {p.entity!r} is in {p.region or 'the domain'} in these frames")
    margin, side = band(value, p.min, p.max)
    margin = np.where(np.isnan(value), -np.inf, margin)

    def tell(i: int) -> str:
        if np.isnan(value[i]):
            return f"no particle of {p.entity} is in {p.region or 'the domain'} at frame {scope.frames[0] + i}"
        return f"{p.measure} temperature of {p.entity} is {value[i]:.5g} K at frame {scope.frames[0] + i}"

    return judge(Series(scope.frames, value, margin, "K", p.entity, side, tell), p.when)

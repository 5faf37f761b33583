"""Result of the search for a route, and where regions lie."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, RigidPose
from ..rows.questions import Comparison

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces

__all__ = ["Reason", "RouteResult", "failed", "frame_of", "region_box"]


class Reason(NamedTuple):
    """Reason why there is no route, and how its measured value would have to compare with the bound."""

    name: str
    comparison: Comparison
    unit: str


NO_FLOOR = Reason("no floor", ">=", "m")
NO_SPACE = Reason("no space", ">=", "m")
NO_LAND = Reason("gap", ">=", "m")
GAP = Reason("gap", "<=", "m")
BLOCKED = Reason("blocked", ">=", "m")
OVERGROWN = Reason("overgrown", ">=", "m")
TOO_NARROW = Reason("too narrow", ">=", "m")
TOO_LOW = Reason("too low", ">=", "m")
TOO_STEEP = Reason("too steep", "<=", "rad")
TOO_DEEP = Reason("too deep", "<=", "m")
STEP_TOO_HIGH = Reason("step too high", "<=", "m")
UNRESOLVED = Reason("unresolved", ">=", "1")


class RouteResult(NamedTuple):
    """Result of the search for one route at one frame."""

    ok: bool
    text: str
    measured: float
    bound: float
    comparison: Comparison
    unit: str
    reason: str
    blame: tuple[str, ...]
    evidence: dict[str, Any]
    route: F64 | None = None
    """Middle of the way that was found [m], shape (n, 3)."""
    floors: tuple[str, ...] = ()
    """Entities that the route leads over."""


def failed(
    reason: Reason, text: str, measured: float, bound: float, blame: tuple[str, ...], evidence: dict[str, Any]
) -> RouteResult:
    """Result of a search that found no route."""
    return RouteResult(False, text, measured, bound, reason.comparison, reason.unit, reason.name, blame, evidence)


def frame_of(surfaces: Surfaces, entity: str, frame: int) -> RigidPose:
    """Pose of an entity's first body."""
    surfaces.require(entity)
    return surfaces.track(entity, surfaces.candidate.entity(entity).bodies[0].name).at(frame)


def region_box(surfaces: Surfaces, name: str, frame: int) -> tuple[F64, F64]:
    """Bounding box of a region in the world [m], shapes (3,)."""
    region = surfaces.candidate.spec.graph.regions[name]
    if region.kind == "box":
        low, high = np.array(region.min), np.array(region.max)
    elif region.kind == "sphere":
        low, high = np.array(region.center) - region.radius, np.array(region.center) + region.radius
    else:
        half = np.array([region.radius, region.radius, region.height / 2])
        low, high = np.array(region.center) - half, np.array(region.center) + half
    if region.relative_to is not None:
        corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
        corners = frame_of(surfaces, region.relative_to, frame).apply(corners)
        low, high = corners.min(axis=0), corners.max(axis=0)
    return low, high

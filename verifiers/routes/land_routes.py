"""The route of one connection over open land, or which of slope, water, plants and buildings bars it."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..land.grounds import Land, lands, patches
from .bounds import NEAR, WADING
from .open_land import Asked, Field, Track, ground_in
from .places import BLOCKED, NO_FLOOR, NO_LAND, OVERGROWN, TOO_DEEP, TOO_STEEP, RouteResult, failed, region_box

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces

__all__ = ["follow"]

STEEPEST = math.tan(1.5)
"""Slopes up to this are tried when looking for the reason of a failure."""
CORNERS = 200
"""Corners of a route that are kept as evidence."""
THINNEST = 0.05
"""Share of the width down to which a gap between plants is searched."""


def follow(surfaces: Surfaces, relation: Connects, frame: int, absent: Collection[str] = ()) -> RouteResult | None:
    """The route over a landscape; None where the regions are not both on the ground of one.

    Raises:
        EvidenceError: a landscape is not built.
    """
    if relation.carrier not in WADING:
        return None
    for land in lands(surfaces.candidate):
        if all(len(ground_in(surfaces, land, n, frame, relation.max_step)) for n in (relation.a, relation.b)):
            return _follow(surfaces, land, relation, frame, absent)
    return None


def _follow(surfaces: Surfaces, land: Land, relation: Connects, frame: int, absent: Collection[str]) -> RouteResult:
    asked = Asked(relation.width, relation.headroom, math.tan(relation.max_slope), relation.max_step, WADING[relation.carrier])
    boxes = [b[:2] for n in (relation.a, relation.b) for b in region_box(surfaces, n, frame)]
    flat = np.array([*boxes, *(list(w) for w in relation.waypoints)])
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = max(NEAR, 0.5 * float(np.linalg.norm(high - low)))
    field = Field(surfaces, land, frame, low - margin, high + margin, relation.width, absent)
    track = field.way(relation, asked)
    if track is None and not field.whole:
        wide = Field(surfaces, land, frame, land.low, land.high, relation.width, absent)
        track = wide.way(relation, asked)
        field = wide if track is not None else field
    if track is None:
        return _why(field, relation, asked)
    slope = math.atan(track.tangent)
    text = (
        f"a route of {_length(track):.4g} m leads over {land.name!r} from {relation.a!r} to {relation.b!r}, at most {slope:.3f} rad "
        f"steep and through at most {track.depth:.2g} m of water"
    )
    floors = tuple(p.entity for p in patches(surfaces.candidate.spec, land.name))
    return RouteResult(True, text, slope, relation.max_slope, "<=", "rad", "", (), _evidence(field, track), track.route, floors)


def _length(track: Track) -> float:
    return float(np.linalg.norm(np.diff(track.route, axis=0), axis=1).sum())


def _evidence(field: Field, track: Track | None) -> dict[str, Any]:
    found: dict[str, Any] = {"land": field.land.name, "cell_m": field.cell, "search_clipped": not field.whole}
    if track is not None:
        step = max(1, -(-len(track.route) // CORNERS))
        found |= {
            "route": track.route[::step].tolist(),
            "route_length_m": _length(track),
            "steepest_rad": math.atan(track.tangent),
            "steepest_place": track.steepest.tolist(),
            "deepest_water_m": track.depth,
        }
    return found


def _why(field: Field, relation: Connects, asked: Asked) -> RouteResult:
    """There is no way: find the one limit without which there is, and the value that it would have to have."""
    for name, region in (("a", relation.a), ("b", relation.b)):
        if not len(field.stops(relation, field.free(asked))[0 if name == "a" else -1]):
            return _no_place(field, relation, asked, region)
    for reason in (_too_steep, _too_deep, _too_narrow, _blocked):
        found = reason(field, relation, asked)
        if found is not None:
            return found
    bare = replace(asked, tangent=STEEPEST, wade=math.inf, stems=False, built=False)
    if field.exists(relation, bare):
        text = f"steep ground, water, plants and buildings together bar every way from {relation.a!r} to {relation.b!r}"
        return failed(BLOCKED, text, 0.0, relation.width, (), _evidence(field, field.way(relation, bare)))
    text = f"no land leads from {relation.a!r} to {relation.b!r}"
    return failed(NO_LAND, text, 0.0, relation.width, (), _evidence(field, None))


def _no_place(field: Field, relation: Connects, asked: Asked, region: str) -> RouteResult:
    squares = field.stops(replace_ends(relation, region), np.ones(field.shape, dtype=bool))[0]
    if not len(squares):
        return failed(NO_FLOOR, f"region {region!r} has no ground", 0.0, relation.width, (), _evidence(field, None))
    slope, depth = field.tangent.ravel()[squares].min(), field.depth.ravel()[squares].min()
    if slope > asked.tangent:
        text = f"the ground in region {region!r} slopes {math.atan(slope):.3f} rad or more"
        return failed(TOO_STEEP, text, math.atan(float(slope)), relation.max_slope, (), _evidence(field, None))
    if depth > asked.wade:
        text = f"region {region!r} lies under {depth:.3g} m of water or more"
        return failed(TOO_DEEP, text, float(depth), asked.wade, (), _evidence(field, None))
    met = field.occupied(asked).ravel()[squares]
    blame = tuple(field.surfaces.entities[k] for k in dict.fromkeys(met[met >= 0].tolist()))
    text = f"region {region!r} has no free ground" + (f", {blame[0]!r} stands there" if blame else "")
    return failed(BLOCKED if blame else NO_FLOOR, text, 0.0, relation.width, blame, _evidence(field, None))


def replace_ends(relation: Connects, region: str) -> Connects:
    """The same connection from a region to itself."""
    return relation.model_copy(update={"a": region, "b": region, "waypoints": []})


def _at(place: Any) -> str:
    return "(" + ", ".join(f"{c:.2f}" for c in place) + ")"


def _too_steep(field: Field, relation: Connects, asked: Asked) -> RouteResult | None:
    if not field.exists(relation, replace(asked, tangent=STEEPEST)):
        return None
    limit = field.least(relation, asked, "tangent", STEEPEST, asked.tangent)
    track = field.way(relation, replace(asked, tangent=limit))
    assert track is not None
    angle = math.atan(track.tangent)
    text = (
        f"the gentlest way over {field.land.name!r} slopes {angle:.3f} rad at {_at(track.steepest)}, the carrier takes "
        f"{relation.max_slope:g} rad"
    )
    return failed(TOO_STEEP, text, angle, relation.max_slope, (), _evidence(field, track))


def _too_deep(field: Field, relation: Connects, asked: Asked) -> RouteResult | None:
    track = field.way(relation, replace(asked, wade=math.inf))
    if track is None:
        return None
    limit = field.least(relation, asked, "wade", track.depth, asked.wade)
    track = field.way(relation, replace(asked, wade=limit)) or track
    text = f"the shallowest way over {field.land.name!r} leads through {track.depth:.3g} m of water, the carrier wades {asked.wade:g} m"
    return failed(TOO_DEEP, text, track.depth, asked.wade, (), _evidence(field, track))


def _too_narrow(field: Field, relation: Connects, asked: Asked) -> RouteResult | None:
    if not field.exists(relation, replace(asked, stems=False)):
        return None
    thin = THINNEST * asked.width
    through = field.exists(relation, replace(asked, width=thin))
    width = field.least(relation, asked, "width", thin, asked.width) if through else 0.0
    track = field.way(relation, replace(asked, width=width) if through else replace(asked, stems=False))
    text = (
        f"plants and stones of {field.land.name!r} leave a way {width:.3f} m wide from {relation.a!r} to {relation.b!r}, the carrier "
        f"needs {asked.width:g} m"
    )
    return failed(OVERGROWN, text, width, asked.width, (), _evidence(field, track))


def _blocked(field: Field, relation: Connects, asked: Asked) -> RouteResult | None:
    track = field.way(relation, replace(asked, built=False))
    if track is None:
        return None
    blame = tuple(field.on_the_way(track, asked))
    text = f"{', '.join(map(repr, blame[:4]))} block the way from {relation.a!r} to {relation.b!r}"
    return failed(BLOCKED, text, 0.0, asked.width, blame, _evidence(field, track))

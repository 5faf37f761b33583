"""Evaluators of predicates about the land: water bodies counted and measured, fields averaged, from the built landscape."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ...worlds.landscape import FIELDS, SavedLandscape, open_landscape
from ...worlds.predicates import LandscapeField, LandscapeWater
from .outcome import Comparison, Outcome

if TYPE_CHECKING:
    from ...worlds.spec.terrain import Terrain, Zone
    from .scope import Scope

__all__ = ["in_polygon", "landscape_field", "landscape_water", "zone_cells"]

Mask = NDArray[np.bool_]


def _opened(scope: Scope, name: str) -> tuple[SavedLandscape, Terrain]:
    spec = scope.candidate.spec
    if name not in spec.terrains:
        raise EvidenceError(f"there is no terrain {name!r}; the world has {sorted(spec.terrains)}")
    return open_landscape(scope.candidate.folder, spec, name), spec.terrains[name]


def _centers(land: SavedLandscape) -> tuple[F64, F64]:
    rows, cols = land.shape
    x, y = ((np.arange(n) - 0.5 * (n - 1)) * land.cell for n in (cols, rows))
    return np.broadcast_to(x[None], (rows, cols)), np.broadcast_to(y[:, None], (rows, cols))


def in_polygon(x: F64, y: F64, corners: F64) -> Mask:
    """Even-odd rule."""
    inside = np.zeros(x.shape, dtype=bool)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        inside ^= crosses & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return inside


def _near_line(x: F64, y: F64, line: F64, reach: float) -> Mask:
    near = np.zeros(x.shape, dtype=bool)
    for start, end in itertools.pairwise(line):
        along = end - start
        t = np.clip(((x - start[0]) * along[0] + (y - start[1]) * along[1]) / max(float(along @ along), 1e-300), 0.0, 1.0)
        near |= np.hypot(x - start[0] - t * along[0], y - start[1] - t * along[1]) <= reach
    return near


def zone_cells(land: SavedLandscape, terrain: Terrain, name: str | None) -> Mask:
    """Cells whose centre lies in a zone of the terrain; all cells for None.

    Raises:
        EvidenceError: there is no such zone, or no cell lies in it.
    """
    if name is None:
        return np.ones(land.shape, dtype=bool)
    zone: Zone | None = terrain.zones.get(name)
    if zone is None:
        raise EvidenceError(f"the terrain has no zone {name!r}; it has {sorted(terrain.zones)}")
    x, y = _centers(land)
    if zone.polygon is not None:
        inside = in_polygon(x, y, np.array(zone.polygon))
    elif zone.line is not None:
        inside = _near_line(x, y, np.array(zone.line), 0.5 * float(zone.width or 0.0))
    else:
        assert zone.center is not None
        inside = np.hypot(x - zone.center[0], y - zone.center[1]) <= float(zone.radius or 0.0)
    if not inside.any():
        raise EvidenceError(f"no cell of the landscape lies in zone {name!r}; its cells are {land.cell:g} m wide")
    return inside


# ---------------------------------------------------------------- water


def _standing(land: SavedLandscape, ask: LandscapeWater, inside: Mask) -> list[dict[str, Any]]:
    ground = land.field("ground")
    if ask.water == "sea":
        sea = land.raw("sea").astype(bool)
        if not (sea & inside).any():
            return []
        level = land.field("water_level")
        depth = float(np.nanmax(np.where(sea, level - ground, np.nan)))
        return [{"name": "sea", "depth": depth, "area": float(sea.sum()) * land.cell**2}]
    number, found = land.raw("lake"), []
    for lake in land.about["lakes"]:
        cells = number == lake["number"]
        if (cells & inside).any():
            depth = float(lake["level"] - ground[cells].min())
            found.append({"name": f"lake {lake['number']}", "depth": depth, "area": float(cells.sum()) * land.cell**2})
    return found


def _ways(land: SavedLandscape) -> dict[int, tuple[str, float]]:
    """Per reach, where its water goes at last and how far that is along beds [m]."""
    _, cols = land.shape
    reaches = {int(r["number"]): r for r in land.about["reaches"]}
    owner: dict[int, tuple[int, int]] = {}
    for number, reach in reaches.items():
        for place, cell in enumerate(reach["cells"][:-1]):
            owner[int(cell)] = (number, place)
    steps = {}
    for number, reach in reaches.items():
        cells = np.asarray(reach["cells"], dtype=np.int64)
        far = np.hypot(np.diff(cells // cols), np.diff(cells % cols)) * land.cell
        steps[number] = np.concatenate([np.cumsum(far[::-1])[::-1], [0.0]])
    known: dict[int, tuple[str, float]] = {}
    for first in reaches:
        number, place, length, seen = first, 0, 0.0, set[int]()
        while True:
            length += float(steps[number][place])
            end, seen = str(reaches[number]["ends_in"]), seen | {number}
            joined = owner.get(int(reaches[number]["cells"][-1])) if end == "river" else None
            if joined is None or joined[0] in seen:
                break
            number, place = joined
        known[first] = (end, length)
    return known


def _flowing(land: SavedLandscape, ask: LandscapeWater, inside: Mask) -> list[dict[str, Any]]:
    ways, found = _ways(land), []
    for reach in land.about["reaches"]:
        if reach["kind"] != ask.water or not inside.ravel()[reach["cells"]].any():
            continue
        end, length = ways[int(reach["number"])]
        found.append({
            "name": f"{reach['kind']} {reach['number']}", "ends_in": end, "length": length, "width": float(max(reach["width"])),
            "depth": float(max(reach["depth"])),
        })  # fmt: skip
    return found


def _lacks(body: dict[str, Any], ask: LandscapeWater) -> str:
    """Why a water body does not count; empty where it does."""
    if ask.ends_in is not None and body["ends_in"] != ask.ends_in:
        return f"ends in {body['ends_in']}"
    for name in ("depth", "area", "length", "width"):
        least = getattr(ask, f"min_{name}")
        if least and body[name] < least:
            return f"{name} {body[name]:.4g} < {least:g}"
    return ""


def landscape_water(scope: Scope, predicate: LandscapeWater) -> Outcome:
    """Counts the waters that are as asked."""
    land, terrain = _opened(scope, predicate.terrain)
    inside = zone_cells(land, terrain, predicate.zone)
    bodies = (_standing if predicate.water in ("lake", "sea") else _flowing)(land, predicate, inside)
    lacks = {b["name"]: _lacks(b, predicate) for b in bodies}
    good = [b for b in bodies if not lacks[b["name"]]]
    count = len(good)
    high = predicate.max if predicate.max is not None and count > predicate.max else None
    ok = count >= predicate.min and high is None
    where = f" in zone {predicate.zone!r}" if predicate.zone else ""
    told = ", ".join(f"{b['name']} ({_measures(b)})" for b in good[:3]) or "none"
    missed = "; ".join(f"{n}: {t}" for n, t in list(lacks.items())[:4] if t)
    text = f"{count} of {len(bodies)} {predicate.water}s{where} are as asked: {told}" + (f"; not {missed}" if missed else "")
    return Outcome(
        "pass" if ok else "fail",
        scope.frames,
        "1",
        text,
        value=float(count),
        bound=float(predicate.min if high is None else high),
        comparison=">=" if high is None else "<=",
        truth=np.full(scope.length, ok),
        margin=float(count - predicate.min if high is None else high - count),
        first_true_frame=scope.frames[0] if ok else None,
        first_failing_frame=None if ok else scope.frames[0],
        details={"landscape": land.digest(), "bodies": good[:10]},
    )


def _measures(body: dict[str, Any]) -> str:
    units = {"depth": "m", "area": "m^2", "length": "m", "width": "m"}
    told = [f"{n} {body[n]:.4g} {u}" for n, u in units.items() if n in body]
    return ", ".join([*told, *([f"to the {body['ends_in']}"] if "ends_in" in body else [])])


# ---------------------------------------------------------------- fields


def _mean(land: SavedLandscape, terrain: Terrain, field: str, zone: str | None) -> float:
    values = land.field(field)
    dry = zone_cells(land, terrain, zone) & ~land.raw("wet").astype(bool) & np.isfinite(values)
    if not dry.any():
        raise EvidenceError(f"zone {zone!r} of the landscape has no dry land")
    return float(values[dry].mean())


def landscape_field(scope: Scope, predicate: LandscapeField) -> Outcome:
    """Mean over the dry land of a zone, or its ratio to that of another."""
    land, terrain = _opened(scope, predicate.terrain)
    if predicate.field not in land.names:
        raise EvidenceError(f"the landscape has no field {predicate.field!r}; declare what makes it (vegetation forms, erosion)")
    mean = _mean(land, terrain, predicate.field, predicate.zone)
    value, unit = mean, FIELDS[predicate.field].unit
    where = f"zone {predicate.zone!r}" if predicate.zone else "the whole land"
    text = f"{predicate.field} is {mean:.4g} {unit} over the dry land of {where}"
    details: dict[str, Any] = {"landscape": land.digest(), "mean": mean}
    if predicate.relative_to is not None:
        other = _mean(land, terrain, predicate.field, predicate.relative_to)
        if other == 0.0 and mean == 0.0:
            raise EvidenceError(f"{predicate.field} is 0 in both zones, so they have no ratio")
        value, unit = (mean / other if other else float(np.finfo(float).max)), "1"
        text += f", {value:.4g} times the {other:.4g} of zone {predicate.relative_to!r}"
        details["other_mean"] = other
    below = -np.inf if predicate.min is None else value - predicate.min
    above = np.inf if predicate.max is None else predicate.max - value
    low = predicate.min is not None and (predicate.max is None or below <= above)
    margin = float(below if low else above)
    comparison: Comparison = ">=" if low else "<="
    ok = margin >= 0
    return Outcome(
        "pass" if ok else "fail", scope.frames, unit, text, value=value, bound=predicate.min if low else predicate.max,
        comparison=comparison, truth=np.full(scope.length, ok), margin=margin,
        first_true_frame=scope.frames[0] if ok else None, first_failing_frame=None if ok else scope.frames[0], details=details,
    )  # fmt: skip

"""Warnings about a built landscape, told with the answer of build_terrain: things that nothing asks for, things asked for that it lacks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..worlds.predicates import atoms_of

if TYPE_CHECKING:
    from ..worlds.landscape import SavedLandscape
    from ..worlds.spec import WorldSpec

__all__ = ["land_warnings"]

SHORT = 0.25
"""Own choice: a river that is asked for runs at least this share of the land's shorter side before it leaves the map."""
SNOWY = 0.5
"""Cover from which on ground counts as snowy, and nothing is planted."""
NEAR = 3.0
"""[cells] A declared inflow feeds a reach that begins or passes within this."""
OFF = 0.2
"""Own choice: share by which the discharge of a river may differ from its declared inflow before it is told."""


def land_warnings(spec: WorldSpec, name: str, land: SavedLandscape, water: dict[str, Any]) -> list[str]:
    """Warnings about a landscape, each with pointer, measured value and next step.

    Args:
        spec: the specification.
        name: of the terrain.
        land: as built.
        water: figures of the liquid that was made of its water; empty where none was.
    """
    return [*_lakes(spec, name, land), *_rivers(spec, name, land), *_snow(spec, name, land), *_inflows(spec, name, land, water), *_plants(spec, name, land)]  # fmt: skip


def _asked(spec: WorldSpec, name: str) -> set[str]:
    """Kinds of water that the terrain requires or that the story speaks of."""
    said = [b.predicate for b in spec.story.beats.values()] + [r.asked for r in spec.story.requirements.values()]
    told = {str(getattr(a, "water", "")) for p in said for a in atoms_of(p)}
    return {*spec.terrains[name].hydrology.required, *told}


def _lakes(spec: WorldSpec, name: str, land: SavedLandscape) -> Iterator[str]:
    lakes = land.about["lakes"]
    if not lakes or "lake" in _asked(spec, name):
        return
    largest = max(lakes, key=lambda lake: lake["area"])
    place = f"/terrains/{name}/hydrology"
    deepest = max(lake["depth"] for lake in lakes)
    yield (
        f"{place}/required: {len(lakes)} lakes lie on the land and none is asked for; the largest, number {largest['number']}, has {largest['area']:.4g} m^2 "
        f'and is {largest["depth"]:.3g} m deep, with its outlet at ({", ".join(f"{v:.4g}" for v in largest["outlet"])}) m. Keep them with "lake" in required, '
        f"or leave them dry with least_lake_area over {largest['area']:.4g} m^2 or least_lake_depth over {deepest:.3g} m"
    )


def _length(land: SavedLandscape, reach: dict[str, Any]) -> float:
    """Length of a reach [m]."""
    import numpy as np

    cells = np.array(reach["cells"])
    rows, cols = cells // land.shape[1], cells % land.shape[1]
    return float(np.hypot(np.diff(rows), np.diff(cols)).sum() * land.cell)


def _rivers(spec: WorldSpec, name: str, land: SavedLandscape) -> Iterator[str]:
    side = min(land.shape) * land.cell
    for kind in ("river", "stream"):
        reaches = [r for r in land.about["reaches"] if r["kind"] == kind]
        if kind not in spec.terrains[name].hydrology.required or not reaches:
            continue  # none at all is refused
        longest = max(reaches, key=lambda r: _length(land, r))
        length = _length(land, longest)
        if length < SHORT * side and longest["ends_in"] == "edge":
            yield (
                f"/terrains/{name}/hydrology/required: the longest {kind}, number {longest['number']}, leaves the map after {length:.3g} m, at least "
                f"{SHORT * side:.3g} m is wanted ({SHORT:g} of the shorter side). Give a valley layer across the land, a hydrology inflow where it comes in, or "
                f"a higher density"
            )


def _snow(spec: WorldSpec, name: str, land: SavedLandscape) -> Iterator[str]:
    import numpy as np

    terrain = spec.terrains[name]
    wants = [
        (f"/terrains/{name}/ground/{k}/where", c.at_least)
        for k, rule in terrain.ground.items()
        for c in rule.where
        if c.field == "snow" and c.at_least
    ]
    if terrain.climate.snow_line is not None:
        wants.append((f"/terrains/{name}/climate/snow_line", SNOWY))
    snow = land.field("snow")
    have, top = float(np.nanmax(snow)), float(np.nanmax(land.field("height")))
    for place, least in wants:
        if have < least:
            line = terrain.climate.snow_line
            why = (
                f"the snow line is at {line:g} m"
                if line is not None
                else "without a snow line it lies where the yearly mean is below -2 deg C"
            )
            yield f"{place}: the most snow on the land is a cover of {have:.2g}, {least:g} is wanted; {why}, and the highest ground is at {top:.4g} m. Lower snow_line or temperature, or raise the land"  # fmt: skip


def _inflows(spec: WorldSpec, name: str, land: SavedLandscape, water: dict[str, Any]) -> Iterator[str]:
    """Discharges of the reaches that declared inflows feed, and of the inflows of a liquid, where they are others than declared."""
    import numpy as np

    (rows, cols), cell = land.shape, land.cell
    for key, inflow in spec.terrains[name].hydrology.inflows.items():
        place = f"/terrains/{name}/hydrology/inflows/{key}/discharge"
        found: list[tuple[float, dict[str, Any]]] = []
        for reach in land.about["reaches"]:
            cells = np.array(reach["cells"])
            x, y = (cells % cols - 0.5 * (cols - 1)) * cell, (cells // cols - 0.5 * (rows - 1)) * cell
            found.append((float(np.hypot(x - inflow.position[0], y - inflow.position[1]).min()), reach))
        distance, reach = min(found, key=lambda item: item[0], default=(float("inf"), {}))
        if distance > NEAR * cell:
            continue  # it comes into a lake or the sea
        first, last = reach["discharge"]
        if abs(last - inflow.discharge) > OFF * inflow.discharge:
            yield f"{place}: {inflow.discharge:g} m^3/s are declared, and {reach['kind']} {reach['number']}, which it feeds, carries {first:.3g} to {last:.3g} m^3/s (yearly mean; rain and tributaries added). Change the discharge or the rain if that is not meant"  # fmt: skip
    brings = list(water.get("inflows", ()))
    if brings and spec.terrains[name].hydrology.inflows:
        told = ", ".join(f"{g['rate_m3_s']:g}" for g in brings)
        declared = ", ".join(f"{i.discharge:g}" for i in spec.terrains[name].hydrology.inflows.values())
        yield f"/simulation/drivers: the liquid's inflows bring {told} m^3/s, the bankfull discharge of the beds; hydrology declares {declared} m^3/s, the yearly mean. Set the drivers' rate if the mean is meant"  # fmt: skip


def _plants(spec: WorldSpec, name: str, land: SavedLandscape) -> Iterator[str]:
    plan = spec.terrains[name].vegetation
    if plan is None or plan.density == 0.0:
        return
    grown = land.about["figures"].get("plants_by_species", {})
    place = f"/terrains/{name}/vegetation"
    missing = [s for s in plan.species or () if not grown.get(s)]
    if not sum(grown.values()):
        yield f"{place}: 0 plants found room, at least 1 is wanted; {_conditions(land)}. Change density, species, zone, clear or the climate"
    elif missing:
        yield f"{place}/species: of {', '.join(missing)} 0 plants found room, at least 1 of each is wanted; {_conditions(land)}. What each needs: skill://outdoor-terrain/plants.md; change the species, climate, zone or density"  # fmt: skip


def _conditions(land: SavedLandscape) -> str:
    """Conditions that plants find, in words."""
    import numpy as np

    parts = []
    for field, unit in (("moisture", ""), ("temperature", " deg C"), ("slope", "")):
        low, high = np.nanpercentile(land.field(field), (5, 95))
        parts.append(f"{field} {low:.2g} to {high:.2g}{unit}")
    wet = float(np.mean((land.raw("wet") > 0) | (land.field("snow") > SNOWY)))
    return f"most of the land has {', '.join(parts)}, and {wet:.0%} is under water or snow"

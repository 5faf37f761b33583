"""From the terrain of a specification to all fields of the landscape (R33): height, erosion, water, climate, ground, plants."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.limits import check_cap
from ...worlds.spec.terrain import Terrain
from .channels import Channels, carve
from .clearings import cleared
from .climate import BIOMES, LAPSE, Biome, bank_distance, height_above_water, moisture, soil_depth, wetness_index
from .erosion import Ground
from .flood import Drainage, drain
from .grid import Grid
from .ground import GroundCover, cover
from .layers import shape_land
from .relief import horizons, relief, sunlight, wind_exposure
from .vegetation import HECTARE, Plants, Species, biomes_of, fitness, scatter, species_of
from .water import WaterBodies, WaterLimits, find_lakes, find_water
from .weathering import Say, weather
from .zones import along, declared_zone, zone_distance

__all__ = ["Landscape", "build_landscape"]

COARSE_CELLS = 160
"""Cells along the longer side of the grid on which wind and rain are followed."""
LAKE_CELLS = 10
"""A lake has at least so many cells: smaller ones are noise of the grid."""
PERCENTILES = (0, 5, 10, 25, 50, 75, 90, 95, 100)
"""Percentiles in which the figures on relief are given."""
SNOW_BAND = 150.0
"""Height over which snow cover grows from none to full [m]."""
SNOW_SLOPE = 1.2
"""Slope on which no snow holds (50 degrees)."""


@dataclass(frozen=True)
class Landscape:
    """A finished landscape. Fields have shape (rows, cols)."""

    grid: Grid
    fields: dict[str, F64]
    """By name; `height` is the ground as it is, beds included."""
    drainage: Drainage
    """Drainage of the land before beds were cut."""
    water: WaterBodies
    channels: Channels
    cover: GroundCover
    plants: Plants | None
    figures: dict[str, Any] = field(default_factory=dict)
    """Numbers for the record: mass balances, residuals, counts, seconds."""

    @property
    def wet(self) -> np.ndarray:
        """All cells under water."""
        return np.asarray(self.water.standing | self.channels.wet)

    @property
    def water_level(self) -> F64:
        """Surface of the water [m], NaN where it is dry."""
        level = np.where(self.channels.wet, self.channels.level, np.nan)
        for lake in self.water.lakes:
            level = np.where(self.water.lake == lake.number, lake.level, level)
        return level


def build_landscape(
    terrain: Terrain, assets: Path, *, outlines: Mapping[str, F64] | None = None, say: Say = lambda done, text: None
) -> Landscape:
    """Build everything.

    Args:
        terrain: of the specification.
        assets: the world's assets folder, for DEM files.
        outlines: corners [m], shape (n, 2), of what each entity covers around which nothing may grow.
        say: hears (part done, what) as it goes.

    Raises:
        LimitError: the grid is too large.
        InputError: a layer, rule or zone cannot be used, or required water cannot be.
    """
    cells = terrain.extent[0] * terrain.extent[1] / terrain.cell**2
    check_cap("cells", cells, what=f"{terrain.extent[0]:g} x {terrain.extent[1]:g} m at {terrain.cell:g} m")
    if cells < 9:
        raise InputError(
            f"{terrain.extent[0]:g} x {terrain.extent[1]:g} m at {terrain.cell:g} m gives {cells:.0f} cells; a landscape needs at least 3 x 3: lower /cell"
        )
    grid = Grid.over(terrain.extent, terrain.cell)
    biome = BIOMES[terrain.climate.biome]
    say(0.02, "shaping the land")
    raw = shape_land(grid, terrain, assets)
    if not terrain.layers:
        raise InputError("the terrain has no layers: it is a plain. Add layers, or call build_terrain without terrain")
    valid = np.isfinite(raw)
    figures: dict[str, Any] = {}
    ground = weather(grid, terrain, raw, valid, figures, say)
    worked = shape_land(grid, terrain, assets, after=ground.height) - ground.height
    ground = ground.reshaped(np.where(valid, worked, 0.0))
    say(0.5, "routing the water")
    drainage = drain(grid, ground.height, valid=valid)
    rain = _rain(grid, terrain, biome, drainage.filled)
    water = _water(grid, terrain, biome, drainage, rain)
    channels = carve(drainage, water) if terrain.hydrology.carve else _uncut(grid, water)
    say(0.6, "sun, wind and moisture")
    fields = _fields(terrain, raw, ground, drainage, water, channels, rain)
    say(0.8, "covering the ground")
    covered = cover(grid, terrain, fields, bed=channels.bed)
    fields["moisture"] = _moisture(fields, covered.retention, rain)
    say(0.85, "planting")
    plants = _planted(grid, terrain, fields, water.standing | channels.bed, outlines or {}, figures)
    figures |= {
        "relief": _relief_figures(fields, valid & ~water.sea),
        "lakes": len(water.lakes),
        "rivers": sum(r.kind == "river" for r in water.rivers),
        "streams": sum(r.kind == "stream" for r in water.rivers),
        "river_threshold_m3_s": water.threshold if np.isfinite(water.threshold) else None,
        "plants": 0 if plants is None else len(plants),
    }
    say(1.0, "done")
    return Landscape(grid, fields, drainage, water, channels, covered, plants, figures)


def _relief_figures(fields: dict[str, F64], land: np.ndarray) -> dict[str, Any]:
    """Distribution of height and slope over the land above the sea; the hypsometric integral (Strahler 1952)."""
    if not land.any():
        return {}
    height, slope = fields["height"][land], fields["slope"][land]
    low, high, mean = float(height.min()), float(height.max()), float(height.mean())
    return {
        "percentiles": list(PERCENTILES),
        "height": [round(float(v), 2) for v in np.percentile(height, PERCENTILES)],
        "slope_deg": [round(float(v), 2) for v in np.degrees(np.arctan(np.percentile(slope, PERCENTILES)))],
        "hypsometric_integral": round((mean - low) / max(high - low, 1e-9), 4),
        "land_share": round(float(land.mean()), 4),
    }


def _rain(grid: Grid, terrain: Terrain, biome: Biome, surface: F64) -> F64:
    """Precipitation [m/year]: less in the lee of heights, the mean as prescribed."""
    mean = biome.rain if terrain.climate.rain is None else terrain.climate.rain
    if terrain.climate.rain_shadow <= 0:
        return np.full(grid.shape, mean)
    from scipy import ndimage

    solid = np.where(np.isfinite(surface), surface, 0.0)
    if terrain.sea_level is not None:
        solid = np.maximum(solid, terrain.sea_level)
    step = max(1.0, max(grid.shape) / COARSE_CELLS)
    small = ndimage.zoom(ndimage.uniform_filter(solid, int(step)), 1 / step, order=1, mode="nearest", grid_mode=True)
    coarse = Grid(small.shape[0], small.shape[1], grid.extent[0] / small.shape[1])
    seen = horizons(coarse, small)
    # Air that has to rise rains; air that sinks dries: the difference of the horizons ahead and behind.
    direction = np.radians(terrain.climate.wind_deg)
    open_up = wind_exposure(seen, direction=direction, spread=np.pi / 4)
    open_down = wind_exposure(seen, direction=direction + np.pi, spread=np.pi / 4)
    effect = ndimage.gaussian_filter(open_up - open_down, 3.0, mode="nearest")
    x, y = grid.axes()
    rows = np.clip((y / grid.extent[1] + 0.5) * coarse.rows - 0.5, 0, coarse.rows - 1)
    cols = np.clip((x / grid.extent[0] + 0.5) * coarse.cols - 0.5, 0, coarse.cols - 1)
    fine = ndimage.map_coordinates(effect, np.meshgrid(rows, cols, indexing="ij"), order=1, mode="nearest")
    factor = np.clip(1.0 + 2.0 * terrain.climate.rain_shadow * fine, 0.1, 3.0)
    return np.asarray(mean * factor / factor.mean())


def _water(grid: Grid, terrain: Terrain, biome: Biome, drainage: Drainage, rain: F64) -> WaterBodies:
    plan = terrain.hydrology
    inflow = np.zeros(grid.shape)
    for name, source in plan.inflows.items():
        x, y = source.position
        if not (abs(x) <= grid.extent[0] / 2 and abs(y) <= grid.extent[1] / 2):
            raise InputError(
                f"inflow {name!r} at {source.position} lies outside the extent {grid.extent[0]:g} x {grid.extent[1]:g} m"
            )
        inflow[grid.indices(np.array(x), np.array(y))] += source.discharge
    water = find_water(
        drainage,
        WaterLimits(
            sea_level=terrain.sea_level,
            river_density=biome.river_density * plan.density if plan.rivers is None else plan.rivers,
            stream_density=biome.stream_density * plan.density if plan.streams is None else plan.streams,
            least_lake_area=max(plan.least_lake_area, LAKE_CELLS * grid.cell_area),
            least_lake_depth=plan.least_lake_depth,
        ),
        runoff=rain * biome.runoff,
        inflow=inflow if plan.inflows else None,
        rng=np.random.default_rng([terrain.seed, 1]),
    )
    have = {
        "lake": bool(water.lakes),
        "sea": bool(water.sea.any()),
        "river": any(r.kind == "river" for r in water.rivers),
        "stream": any(r.kind == "stream" for r in water.rivers),
    }
    for kind in plan.required:
        if not have[kind]:
            raise InputError(f"the land has no {kind}: {_remedy(kind, terrain, drainage)}")
    return water


def _remedy(kind: str, terrain: Terrain, drainage: Drainage) -> str:
    if kind == "sea":
        low = float(np.nanmin(drainage.height))
        return f"nothing at the edge lies below sea_level {terrain.sea_level}; the lowest land is at {low:.1f} m. Raise /sea_level or add a coast layer"
    if kind == "lake":
        deepest, plan = float(np.nanmax(drainage.depth)), terrain.hydrology
        nowhere = np.zeros(drainage.depth.shape, dtype=bool)
        _, found = find_lakes(drainage, nowhere, least_area=0.0, least_depth=plan.least_lake_depth)
        if found:
            area, smallest = max(one.area for one in found), LAKE_CELLS * drainage.grid.cell_area
            least = max(plan.least_lake_area, smallest)
            lower = f", or lower /hydrology/least_lake_area to {0.9 * area:.3g}" if area > smallest else ", or take smaller cells"
            return (
                f"its largest depression of at least {plan.least_lake_depth:g} m covers {area:.4g} m^2, and smaller ones than {least:g} m^2 stay "
                f"dry: make it wider{lower}"
            )
        return f"its deepest depression is {deepest:.2f} m; add a crater or valley without outlet, or lower /hydrology/least_lake_depth"
    return "raise /hydrology/density, give an inflow at the edge, or more relief: water gathers only where land falls together"


def _uncut(grid: Grid, water: WaterBodies) -> Channels:
    none = np.zeros(grid.shape, dtype=bool)
    return Channels(np.zeros(grid.shape), np.full(grid.shape, np.nan), water.channels(), none)


def _fields(
    terrain: Terrain, raw: F64, ground: Ground, drainage: Drainage, water: WaterBodies, channels: Channels, rain: F64
) -> dict[str, F64]:
    grid, biome = ground.grid, BIOMES[terrain.climate.biome]
    height = ground.height - channels.cut
    shape = relief(grid, height, window=3 * grid.cell)
    climate = terrain.climate
    latitude, wind = (float(np.radians(angle)) for angle in (climate.latitude_deg, climate.wind_deg))
    sun = sunlight(grid, height, latitude=latitude, day=climate.day, wind=wind)
    wet = water.standing | channels.bed
    level = np.where(water.standing, drainage.filled, np.where(channels.bed, height, np.nan))
    if terrain.sea_level is not None:
        level = np.where(water.sea, terrain.sea_level, level)
    mean = biome.temperature if terrain.climate.temperature is None else terrain.climate.temperature
    warmth = mean - LAPSE * (height - (terrain.sea_level or 0.0))
    east, north = grid.points()
    fields: dict[str, F64] = {
        "height": height,
        "ground": ground.height,
        "start": raw,
        "uplift": ground.uplift,
        "earthworks": ground.earthworks,
        "bedrock": ground.bedrock,
        "sediment": ground.sediment,
        "wear": ground.wear,
        "deposit": ground.deposit,
        "filled": drainage.filled,
        "basin_depth": drainage.depth,
        "accumulation": drainage.accumulation(),
        "discharge": water.discharge,
        "rain": rain,
        "slope": shape.slope,
        "aspect": shape.aspect,
        "curvature": shape.curvature,
        "roughness": shape.roughness,
        "peak": shape.peak.astype(np.float64),
        "sun_hours": sun.hours,
        "sunlight": sun.energy,
        "sky": sun.sky,
        "wind_exposure": sun.exposure,
        "water_distance": bank_distance(grid, wet),
        "height_above_water": height_above_water(drainage, wet, level),
        "wetness": wetness_index(drainage, shape.slope),
        "temperature": warmth,
        "soil_depth": soil_depth(
            ground.sediment, shape.slope, talus=float(np.tan(np.radians(terrain.erosion.talus_deg if terrain.erosion else 33.0)))
        ),
        "snow": _snow(terrain, height, shape.slope, warmth),
        "east": np.array(east),
        "north": np.array(north),
    }
    fields["moisture"] = _moisture(fields, np.full(grid.shape, 0.5), rain)
    return fields


def _moisture(fields: dict[str, F64], retention: F64, rain: F64) -> F64:
    return moisture(
        distance=fields["water_distance"],
        above=fields["height_above_water"],
        index=fields["wetness"],
        retention=retention,
        rain=rain,
    )


def _snow(terrain: Terrain, height: F64, slope: F64, warmth: F64) -> F64:
    """Cover of snow, 0 to 1: above the snow line (default: where the yearly mean is below -2 deg C), not on steep rock."""
    line = terrain.climate.snow_line
    above = (height - line) / SNOW_BAND if line is not None else (-2.0 - warmth) / (LAPSE * SNOW_BAND)
    return np.asarray(np.clip(above, 0.0, 1.0) * np.clip((SNOW_SLOPE - slope) / 0.4, 0.0, 1.0))


def _planted(
    grid: Grid, terrain: Terrain, fields: dict[str, F64], water: np.ndarray, outlines: Mapping[str, F64], figures: dict[str, Any]
) -> Plants | None:
    plan = terrain.vegetation
    if plan is None:
        return None
    kinds = _kinds(terrain)
    open_light = float(np.percentile(fields["sunlight"], 99)) or 1.0
    given = {
        "moisture": fields["moisture"],
        "temperature": fields["temperature"],
        "slope": fields["slope"],
        "soil": fields["soil_depth"],
        "light": fields["sunlight"] / open_light,
        "exposure": fields["wind_exposure"],
    }
    blocked = water | (fields["snow"] > 0.5) | np.isnan(fields["start"])
    for layer in terrain.layers.values():
        if layer.kind == "road":
            blocked |= along(grid, np.array(layer.line))[0] <= 0.5 * layer.width + 0.5 * grid.cell
        if layer.kind == "flatten" and layer.zone is not None:
            blocked |= zone_distance(grid, declared_zone(terrain, layer.zone)) <= 0
    blocked |= cleared(grid, terrain, outlines)
    allowed = ~blocked
    if plan.zone is not None:
        allowed &= zone_distance(grid, declared_zone(terrain, plan.zone)) <= 0
    fitting = fitness(kinds, given, allowed)
    for form in plan.grown():
        own = [s for s in kinds if s.form == form]
        total = sum((fitting[s.name] * s.density for s in own), start=np.zeros(grid.shape))
        fields[f"{form}_density"] = np.asarray(total) * plan.density / HECTARE
    # A cell reaches half its diagonal towards what is blocked.
    clearance = bank_distance(grid, blocked) - 0.75 * grid.cell
    found = scatter(
        grid, fields["height"], kinds, fitting, clearance=clearance, density=plan.density,
        rng=np.random.default_rng([terrain.seed, 2, plan.seed]), most=plan.most,
    )  # fmt: skip
    figures["plants_by_species"] = {name: int((found.kind == k).sum()) for k, name in enumerate(found.species)}
    return found


def _kinds(terrain: Terrain) -> list[Species]:
    plan = terrain.vegetation
    assert plan is not None
    known = species_of(terrain.climate.biome)
    if plan.species is None:
        return [s for s in known if s.form in plan.grown()]
    chosen = {s.name: s for s in known if s.name in plan.species}
    for name in plan.species:
        if name not in chosen:
            raise InputError(
                f"species {name!r} does not grow in biome {terrain.climate.biome!r}; it has {sorted(s.name for s in known)}. "
                f"{name!r} grows in {', '.join(biomes_of(name))}: change /climate/biome or /vegetation/species"
            )
        if plan.forms is not None and chosen[name].form not in plan.forms:
            raise InputError(
                f"species {name!r} is a {chosen[name].form}, and /vegetation/forms {plan.forms} leaves that out: leave out forms, or add it"
            )
    return list(chosen.values())

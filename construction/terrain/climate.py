"""Moisture of the ground and where plants thrive (R38, R43, R44)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from .flood import Drainage
from .grid import Grid

__all__ = ["BIOMES", "Biome", "bank_distance", "height_above_water", "moisture", "soil_depth", "wetness_index"]

LAPSE = 0.0065
"""Fall of temperature with height [K/m] (ICAO standard atmosphere)."""


@dataclass(frozen=True)
class Biome:
    """Climate and water system of a kind of landscape; typical values, each may be overridden."""

    rain: float
    """Precipitation [m/year] (Whittaker 1975, biome diagram)."""
    runoff: float
    """Part of it that runs off (Fekete et al. 2002, order of magnitude)."""
    temperature: float
    """Mean annual at sea level [deg C]."""
    river_density: float
    """Length of rivers per area [m/m^2]. Own choice, of the order of perennial networks on 1:50,000 maps."""
    stream_density: float
    """Length of streams per area [m/m^2]."""


BIOMES: dict[str, Biome] = {
    "desert": Biome(0.15, 0.05, 22.0, 5e-5, 5e-5),
    "mediterranean": Biome(0.55, 0.2, 16.0, 3e-4, 4e-4),
    "grassland": Biome(0.6, 0.2, 12.0, 3e-4, 4e-4),
    "temperate": Biome(0.9, 0.4, 10.0, 5e-4, 8e-4),
    "boreal": Biome(0.6, 0.45, 3.0, 6e-4, 8e-4),
    "tundra": Biome(0.35, 0.5, -3.0, 5e-4, 5e-4),
    "tropical": Biome(2.4, 0.5, 25.0, 8e-4, 1.2e-3),
    "volcanic-island": Biome(2.0, 0.35, 22.0, 5e-4, 6e-4),
}


def bank_distance(grid: Grid, wet: np.ndarray) -> F64:
    """Horizontal distance to the nearest water [m]; infinite where there is none."""
    if not wet.any():
        return np.full(grid.shape, np.inf)
    return np.asarray(ndimage.distance_transform_edt(~wet) * grid.cell)


def height_above_water(drainage: Drainage, wet: np.ndarray, level: F64) -> F64:
    """Height of a cell above the water that it drains to [m] (HAND, Nobre et al. 2011); infinite where it meets none."""
    from .flood_kernels import inherit

    flat = wet.ravel()
    base = inherit(np.where(flat, np.nan_to_num(level.ravel()), 0.0), flat, drainage.receiver.ravel(), drainage.order)
    meets = inherit(flat.astype(np.float64), flat, drainage.receiver.ravel(), drainage.order) > 0
    above = np.where(meets, np.maximum(drainage.filled.ravel() - base, 0.0), np.inf)
    return np.asarray(above.reshape(drainage.grid.shape))


def wetness_index(drainage: Drainage, slope: F64) -> F64:
    """Topographic wetness ln(a / tan beta) (Beven & Kirkby 1979); a is the area per width of contour [m]."""
    per_width = drainage.accumulation() / drainage.grid.cell
    return np.asarray(np.log(np.maximum(per_width, 1e-6) / np.maximum(slope, 1e-3)))


def soil_depth(sediment: F64, slope: F64, *, talus: float) -> F64:
    """Depth of ground that roots can use [m]: what lies loose, and a cover that thins out towards the angle of repose."""
    cover = np.clip(1.0 - slope / talus, 0.0, 1.0)
    return np.asarray(np.minimum(sediment + 0.6 * cover, 3.0))


def moisture(
    *,
    distance: F64,
    above: F64,
    index: F64,
    retention: F64,
    rain: F64,
) -> F64:
    """Moisture of the ground, 0 (dry) to 1 (saturated): water near, water gathered, water held, water fallen (R43).

    A weighted mean of four responses between 0 and 1. The weights are own choices; each response is monotone.

    Args:
        distance: to the nearest water [m]; fades with 60 m, the reach of most riparian vegetation.
        above: height above that water [m]; fades with 4 m, a floodplain (Nobre et al. 2011: lowland below 5 m).
        index: topographic wetness; 5 is a crest, 15 a valley floor.
        retention: of the ground material, 0 (bare rock) to 1 (peat).
        rain: [m/year]; saturates like evapotranspiration at 1.5 m/year (Zhang, Dawes & Walker 2001).
    """
    near = np.exp(-np.minimum(distance, 1e6) / 60.0) * 0.5 + np.exp(-np.minimum(above, 1e3) / 4.0) * 0.5
    gathered = np.clip((index - 5.0) / 10.0, 0.0, 1.0)
    fallen = rain / (rain + 1.0) / 0.6
    return np.asarray(np.clip(0.30 * near + 0.25 * gathered + 0.15 * retention + 0.30 * np.minimum(fallen, 1.0), 0.0, 1.0))

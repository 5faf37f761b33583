"""Measures of the shape of the land: slope, aspect, curvature, roughness, peaks, openness to sun, sky and wind (R41)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from .grid import Grid
from .slices import in_slices

__all__ = ["Relief", "Sunlight", "horizons", "relief", "sunlight", "wind_exposure"]

AZIMUTHS = 32
NEAR_CELLS = 64
"""The horizon is looked for at least so far [cells], and to a quarter of the longer side."""
FAR_CELLS = 16
"""From here on the mean height of a neighbourhood counts [cells]."""
BLOCK_ROWS = 32
SOLAR_CONSTANT = 1361.0
TRANSMISSION = 0.7
"""Clear-sky transmission of the beam per air mass (Liu & Jordan 1960: 0.6 to 0.75)."""
DIFFUSE_SHARE = 0.2
"""Diffuse part of clear-sky radiation on level ground. Own choice within 0.1 to 0.25."""


@dataclass(frozen=True)
class Relief:
    """Derivatives of the surface, each of shape (rows, cols)."""

    slope: F64
    """Tangent of the steepest inclination [m/m]."""
    aspect: F64
    """Direction of descent [rad], from east towards north."""
    curvature: F64
    """Laplacian [1/m]: positive in hollows, negative on crests."""
    roughness: F64
    """Standard deviation of the slope around a cell [m/m]."""
    peak: np.ndarray
    """Local maxima of the surroundings."""


@dataclass(frozen=True)
class Sunlight:
    """Potential clear-sky sunlight of one day."""

    hours: F64
    """Direct sun [h]."""
    energy: F64
    """Beam on the slope and diffuse from the visible sky [MJ/m^2]."""
    sky: F64
    """Visible part of the sky, 0 to 1."""
    exposure: F64
    """Openness to the wind, as `wind_exposure` returns it."""


def relief(grid: Grid, height: F64, *, window: float = 0.0) -> Relief:
    """Derivatives of a surface.

    Args:
        grid: where the heights lie.
        height: [m], shape (rows, cols).
        window: radius for roughness and peaks [m]; at least two cells.
    """
    north, east = np.gradient(height, grid.cell)
    slope = np.hypot(east, north)
    reach = max(2, round(window / grid.cell))
    size = 2 * reach + 1
    mean = ndimage.uniform_filter(slope, size)
    variance = ndimage.uniform_filter(slope * slope, size) - mean * mean
    highest = ndimage.maximum_filter(height, size)
    return Relief(
        slope=slope,
        aspect=np.arctan2(-north, -east),
        curvature=ndimage.laplace(height, mode="nearest") / grid.cell_area,
        roughness=np.sqrt(np.maximum(variance, 0.0)),
        peak=(height >= highest) & (height > ndimage.minimum_filter(height, size)),
    )


class Skyline:
    """Horizons of a surface, looked at part by part: all of them at once would be 32 fields."""

    def __init__(self, grid: Grid, height: F64, *, azimuths: int = AZIMUTHS) -> None:
        self.grid, self.azimuths = grid, azimuths
        self.low = height.astype(np.float32)
        most = max(NEAR_CELLS, max(grid.shape) // 4)
        reaches = sorted({round(1.32**k) for k in range(int(np.log(most) / np.log(1.32)) + 1)} | {2, 3, most})
        self.edge = most + 1
        self.levels: list[tuple[np.ndarray, list[int]]] = []
        for low, high in ((1, FAR_CELLS), *((FAR_CELLS * 2**k, FAR_CELLS * 2 ** (k + 1)) for k in range(16))):
            own = [r for r in reaches if low < r <= high or r == low == 1]
            if own:
                width = 1 if low == 1 else 2 * (low // 16) + 1
                seen = ndimage.uniform_filter(self.low, width, mode="nearest") if width > 1 else self.low
                self.levels.append((np.pad(seen, self.edge, mode="edge"), own))

    def rows(self, first: int, last: int) -> np.ndarray:
        """Tangents of the horizon of some rows, shape (azimuths, last - first, cols), float32."""
        from .light_kernels import raise_horizons

        found = np.zeros((self.azimuths, last - first, self.grid.cols), dtype=np.float32)
        for k in range(self.azimuths):
            angle = 2 * np.pi * k / self.azimuths
            for seen, reaches in self.levels:
                for reach in reaches:
                    col, row = round(reach * np.cos(angle)), round(reach * np.sin(angle))
                    away = float(np.hypot(col, row)) * self.grid.cell
                    raise_horizons(self.low, seen, self.edge, row, col, away, first, last, found[k])
        return found


def horizons(grid: Grid, height: F64, *, azimuths: int = AZIMUTHS) -> np.ndarray:
    """Tangent of the elevation of the horizon, shape (azimuths, rows, cols); azimuth k points to 2 pi k / azimuths from east.

    Looked for along each direction at distances that grow by a third up to a quarter of the longer side (at least
    `NEAR_CELLS`); from `FAR_CELLS` on what counts is the mean height of a neighbourhood as wide as the gap between
    directions, so that a finer grid sees the same skyline. Beyond the edge the land goes on level.
    """
    line = Skyline(grid, height, azimuths=azimuths)
    return np.concatenate(in_slices(grid.rows, line.rows), axis=1)


def sunlight(grid: Grid, height: F64, *, latitude: float, day: int, steps: int = 24, wind: float = 0.0) -> Sunlight:
    """Sun that reaches the ground on one clear day.

    Args:
        grid: where the heights lie.
        height: [m], shape (rows, cols).
        latitude: [rad], north positive; y is north.
        day: of the year, 1 to 365.
        steps: times between sunrise and sunset.
        wind: where the wind comes from [rad], from east towards north.

    References:
        Declination: Spencer 1971, Search 2(5), 172.
    """
    from .light_kernels import shine

    line = Skyline(grid, height)
    places, level = _sun_places(latitude, day, steps, line.azimuths)
    diffuse = level * DIFFUSE_SHARE / (1 - DIFFUSE_SHARE)
    north, east = (np.asarray(d) for d in np.gradient(height, grid.cell))
    hours, beam, sky, exposure = (np.zeros(grid.shape) for _ in range(4))

    def work(first: int, last: int) -> None:
        part = np.s_[first:last]
        seen = line.rows(first, last)
        shine(seen, east[part], north[part], places, hours[part], beam[part])
        # Share of an isotropic sky above the horizon, weighted by the cosine (Dozier & Frew 1990, level ground).
        sky[part] = np.mean(1.0 / (1.0 + seen * seen), axis=0, dtype=np.float64)
        beam[part] += diffuse * sky[part]
        exposure[part] = wind_exposure(seen, direction=wind)

    in_slices(grid.rows, work, size=BLOCK_ROWS)
    return Sunlight(hours=hours, energy=beam, sky=sky, exposure=exposure)


def _sun_places(latitude: float, day: int, steps: int, azimuths: int) -> tuple[F64, float]:
    """Where the sun stands through the day (see `shine`), and the energy that level ground gets without horizon [MJ/m^2]."""
    turn = 2 * np.pi * (day - 1) / 365
    declination = (
        0.006918 - 0.399912 * np.cos(turn) + 0.070257 * np.sin(turn) - 0.006758 * np.cos(2 * turn)
        + 0.000907 * np.sin(2 * turn) - 0.002697 * np.cos(3 * turn) + 0.00148 * np.sin(3 * turn)
    )  # fmt: skip
    half_day = np.arccos(np.clip(-np.tan(latitude) * np.tan(declination), -1.0, 1.0))
    interval = 2 * half_day / steps
    seconds = interval / (2 * np.pi) * 86400
    found, level = [], 0.0
    for angle in (np.arange(steps) + 0.5) * interval - half_day:
        up = np.sin(latitude) * np.sin(declination) + np.cos(latitude) * np.cos(declination) * np.cos(angle)
        if up <= 0.01:
            continue
        to_east = -np.cos(declination) * np.sin(angle)
        to_north = np.cos(latitude) * np.sin(declination) - np.sin(latitude) * np.cos(declination) * np.cos(angle)
        bearing = np.arctan2(to_north, to_east) / (2 * np.pi) * azimuths % azimuths
        strength = SOLAR_CONSTANT * TRANSMISSION ** (1.0 / up) * seconds / 1e6
        found.append((bearing, up / np.hypot(to_east, to_north), up, to_east, to_north, seconds / 3600, strength))
        level += float(up * strength)
    return np.array(found, dtype=np.float64).reshape(-1, 7), level


def wind_exposure(horizon: np.ndarray, *, direction: float, spread: float = np.pi / 6) -> F64:
    """Openness of a place to the wind, 0 (deep in the lee) to 1 (nothing upwind stands higher).

    From the mean upwind horizon, as the maximum upwind slope of Winstral, Elder & Davis 2002.

    Args:
        horizon: of `horizons`.
        direction: where the wind comes from [rad], from east towards north.
        spread: half width of the sector looked at [rad].
    """
    count = len(horizon)
    bearings = 2 * np.pi * np.arange(count) / count
    off = np.abs((bearings - direction + np.pi) % (2 * np.pi) - np.pi)
    upwind = np.arctan(horizon[off <= spread + 1e-9]).mean(axis=0)
    return np.asarray(np.clip(1.0 - upwind / np.radians(25.0), 0.0, 1.0), dtype=np.float64)

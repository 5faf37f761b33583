"""What the shape of the land gives directly: slope, aspect, curvature, roughness, peaks, openness to sun, sky and wind (R41)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from .grid import Grid

__all__ = ["Relief", "Sunlight", "horizons", "relief", "sunlight", "wind_exposure"]

AZIMUTHS = 32
REACH_CELLS = (1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48, 64)
"""Distances at which the horizon is looked for [cells]: dense near, sparse far."""
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


def horizons(grid: Grid, height: F64, *, azimuths: int = AZIMUTHS) -> np.ndarray:
    """Tangent of the elevation of the horizon, shape (azimuths, rows, cols); azimuth k points to 2 pi k / azimuths from east.

    Looked for at `REACH_CELLS` distances along each direction; beyond the edge the land goes on level.
    """
    low = height.astype(np.float32)
    found = np.zeros((azimuths, *grid.shape), dtype=np.float32)
    edge = max(REACH_CELLS) + 1
    padded = np.pad(low, edge, mode="edge")
    for k in range(azimuths):
        angle = 2 * np.pi * k / azimuths
        for reach in REACH_CELLS:
            col, row = round(reach * np.cos(angle)), round(reach * np.sin(angle))
            away = np.hypot(col, row) * grid.cell
            if away == 0:
                continue
            there = padded[edge + row : edge + row + grid.rows, edge + col : edge + col + grid.cols]
            np.maximum(found[k], (there - low) / np.float32(away), out=found[k])
    return np.asarray(found)


def sunlight(
    grid: Grid, height: F64, *, latitude: float, day: int, horizon: np.ndarray | None = None, steps: int = 24
) -> Sunlight:
    """Sun that reaches the ground on one clear day.

    Args:
        grid: where the heights lie.
        height: [m], shape (rows, cols).
        latitude: [rad], north positive; y is north.
        day: of the year, 1 to 365.
        horizon: of `horizons`.
        steps: times between sunrise and sunset.

    References:
        Declination: Spencer 1971, Search 2(5), 172.
    """
    seen = horizons(grid, height) if horizon is None else horizon
    count = len(seen)
    turn = 2 * np.pi * (day - 1) / 365
    declination = (
        0.006918 - 0.399912 * np.cos(turn) + 0.070257 * np.sin(turn) - 0.006758 * np.cos(2 * turn)
        + 0.000907 * np.sin(2 * turn) - 0.002697 * np.cos(3 * turn) + 0.00148 * np.sin(3 * turn)
    )  # fmt: skip
    half_day = np.arccos(np.clip(-np.tan(latitude) * np.tan(declination), -1.0, 1.0))
    north, east = np.gradient(height, grid.cell)
    upright = 1.0 / np.sqrt(1.0 + east**2 + north**2)
    # Share of an isotropic sky above the horizon, weighted by the cosine (Dozier & Frew 1990, level ground).
    sky = np.mean(1.0 / (1.0 + seen.astype(np.float64) ** 2), axis=0)
    hours, beam = np.zeros(grid.shape), np.zeros(grid.shape)
    interval = 2 * half_day / steps
    level = 0.0
    for angle in (np.arange(steps) + 0.5) * interval - half_day:
        up = np.sin(latitude) * np.sin(declination) + np.cos(latitude) * np.cos(declination) * np.cos(angle)
        if up <= 0.01:
            continue
        to_east = -np.cos(declination) * np.sin(angle)
        to_north = np.cos(latitude) * np.sin(declination) - np.sin(latitude) * np.cos(declination) * np.cos(angle)
        bearing = np.arctan2(to_north, to_east) / (2 * np.pi) * count % count
        below, share = int(bearing), bearing % 1.0
        skyline = (1 - share) * seen[below % count] + share * seen[(below + 1) % count]
        lit = skyline <= up / np.hypot(to_east, to_north)
        facing = np.maximum((up - east * to_east - north * to_north) * upright, 0.0)
        seconds = interval / (2 * np.pi) * 86400
        strength = SOLAR_CONSTANT * TRANSMISSION ** (1.0 / up) * seconds / 1e6
        hours += lit * (seconds / 3600)
        beam += lit * facing * strength
        level += up * strength
    diffuse = level * DIFFUSE_SHARE / (1 - DIFFUSE_SHARE)
    return Sunlight(hours=hours, energy=beam + diffuse * sky, sky=sky)


def wind_exposure(horizon: np.ndarray, *, direction: float, spread: float = np.pi / 6) -> F64:
    """How open a place is to the wind, 0 (deep in the lee) to 1 (nothing upwind stands higher).

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

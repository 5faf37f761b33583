"""A plume above a small hot source, against the similarity of Morton, Taylor and Turner (1956, doi:10.1098/rspa.1956.0011).

In still air of one density a plume's width is b = 6/5 alpha z, its speed w = (25 B / (48 pi alpha^2))^(1/3) z^(-1/3) for top hats, B its flux of
buoyancy: heights are over a virtual source. Widths and speeds come from horizontal integrals of means over time: volume flux Q, flux of momentum M,
b = Q / sqrt(pi M), w = M / Q.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..simulation.gas.engine import Gas
from ..simulation.gas.settings import GasSettings
from ..worlds.arrays import F64

__all__ = ["Plume", "plume"]

LIGHTNESS = 0.02
"""Lightness of the source: small, so that Boussinesq's approximation holds."""
FLICKER = 0.05
"""Seconds for which each cell of the source keeps its share of the heat, between none and twice the mean: without it the plume stays laminar."""
SPAN = (0.3, 0.75)
"""Heights between which the plume is fitted, as shares of the box."""


class Plume(NamedTuple):
    """Fits of a plume."""

    entrainment: float
    """alpha, from the growth of the width."""
    width: float
    """Exponent of the width."""
    speed: float
    """Exponent of the speed."""
    buoyancy: float
    """Flux of buoyancy at the top of the span over that at its bottom."""


def plume(cells: int, seconds: float, mean: float) -> Plume:
    """Fits of a plume in an open box of 1 x 1 x 1.5 m, from means over the last seconds.

    Args:
        cells: along 1 m.
        seconds: of the run.
        mean: of them, the last ones that count.
    """
    size, shape = 1.0 / cells, (cells, cells, 3 * cells // 2)
    gas = Gas(shape, size, ("open",) * 4 + ("closed", "open"), GasSettings(expands=False, courant=1.5))
    middle = (np.arange(cells) + 0.5) * size - 0.5
    x, y = np.meshgrid(middle, middle, indexing="ij")
    inside = np.hypot(x, y) < max(0.06, 1.5 * size)
    draw = np.random.default_rng(0)
    speeds: list[F64] = []
    lights: list[F64] = []
    for frame in range(round(seconds / FLICKER)):
        heating = np.zeros(shape)
        heating[..., 0][inside] = LIGHTNESS / 0.05 * draw.uniform(0.0, 2.0, int(inside.sum()))
        gas.heat(heating)
        gas.advance(FLICKER)
        if (frame + 1) * FLICKER <= seconds - mean:
            continue
        w = gas.velocity[:cells, :cells, :, 2].astype(float)
        speeds.append(0.5 * (w[..., :-1] + w[..., 1:]))
        lights.append(gas.state[..., 0].astype(float))
    return _fit(np.mean(speeds, axis=0), np.mean([w * q for w, q in zip(speeds, lights, strict=True)], axis=0), size)


def _fit(speed: F64, flux: F64, size: float) -> Plume:
    """Exponents of a mean flow; the air that rises at less than a tenth of the greatest speed of its height is not counted."""
    height = (np.arange(speed.shape[2]) + 0.5) * size
    core = np.where(speed > 0.1 * speed.max(axis=(0, 1)), speed, 0.0)
    volume, momentum = core.sum(axis=(0, 1)) * size**2, (core**2).sum(axis=(0, 1)) * size**2
    width, fast = volume / np.sqrt(np.pi * momentum), momentum / volume
    top = height[-1] + 0.5 * size
    span = (height > SPAN[0] * top) & (height < SPAN[1] * top)
    slope, offset = np.polyfit(height[span], width[span], 1)
    above = height[span] + offset / slope
    carried = flux.sum(axis=(0, 1))[span]
    return Plume(
        float(slope / 1.2),
        float(np.polyfit(np.log(above), np.log(width[span]), 1)[0]),
        float(np.polyfit(np.log(above), np.log(fast[span]), 1)[0]),
        float(carried[-3:].mean() / carried[:3].mean()),
    )

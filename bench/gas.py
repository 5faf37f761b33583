"""Benchmark gas: vortices, a heated cavity, convergence of the pressure and seconds per frame of smoke past a ball, by cells.

`worldagent bench gas` runs the sizes of a CPU; `WORLDAGENT_DEVICE=cuda worldagent bench gas` those of a GPU too. Published: Nusselt numbers of
de Vahl Davis (1983, doi:10.1002/fld.1650030305); vortices of Taylor and Green keep their energy without viscosity.
"""

from __future__ import annotations

import math
import statistics
import time
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np

from ..geometry.launch import chosen_device
from ..simulation.gas.active import ActiveGas, gas_in
from ..simulation.gas.engine import Gas
from ..simulation.gas.settings import GasSettings, Side
from ..simulation.gas.solids import corners_of, cut
from ..worlds.arrays import F64

__all__ = ["CAVITY", "CLOSED", "SMOKE", "ball", "cavity", "residuals", "run", "smoke", "smoke_box", "vortices"]

CLOSED: tuple[Side, ...] = ("closed",) * 6
CAVITY = {1e3: 1.118, 1e4: 2.243, 1e5: 4.519, 1e6: 8.800}
"""Mean Nusselt numbers of the heated square cavity at Prandtl number 0.71, by Rayleigh number (de Vahl Davis 1983)."""
PRANDTL = 0.71
Scheme = Literal["maccormack", "reflection"]
SCHEMES: tuple[Scheme, ...] = get_args(Scheme)
WIND, WINDY = (1.0, 0.5), 2.0
"""A wind that takes vortices along [m/s], and the Courant number of the steps: those of the engine's own settings."""
BALLS = 12
SMOKE = (0.5, 0.01, 0.0, 0.0)
"""Gas of the source: half as dense as the air (twice its temperature), with 0.01 kg/m^3 of soot, a hundredth of the air: it rises."""


def vortices(
    cells: int, scheme: Scheme, viscosity: float = 0.0, *, courant: float = 1.0, wind: tuple[float, float] = (0.0, 0.0)
) -> dict[str, float]:
    """Taylor-Green vortices on a periodic square of 1 m after 1 s: error of the speeds over their size, share of energy left, divergence.

    Args:
        cells: along a side.
        scheme: that carries velocities.
        viscosity: [m^2/s].
        courant: of the steps.
        wind: that takes the vortices along [m/s]; without, the flow stands but for what it loses.
    """
    size, k = 1.0 / cells, 2.0 * np.pi
    settings = GasSettings(scheme=scheme, viscosity=viscosity, courant=courant, expands=False)
    gas = Gas((cells, cells, 2), size, ("periodic",) * 6, settings, gravity=(0.0, 0.0, 0.0))
    faces = np.arange(cells + 1) * size
    middle = faces + 0.5 * size

    def vortex(seconds: float) -> F64:
        """Speeds of the vortices alone, where the wind has taken them."""
        x, y = wind[0] * seconds, wind[1] * seconds
        speed = np.zeros((cells + 1, cells + 1, 3, 3))
        speed[..., 0] = (np.sin(k * (faces - x))[:, None] * np.cos(k * (middle - y))[None, :])[:, :, None]
        speed[..., 1] = (-np.cos(k * (middle - x))[:, None] * np.sin(k * (faces - y))[None, :])[:, :, None]
        return speed

    gas.velocity = (vortex(0.0) + np.array([*wind, 0.0])).astype(np.float32)
    reports = gas.advance(1.0)
    left = math.exp(-2.0 * k * k * viscosity)
    start, true, end = (
        v[:cells, :cells, 0, :2] for v in (vortex(0.0), left * vortex(1.0), gas.velocity - np.array([*wind, 0.0]))
    )
    return {
        "error": float(np.sqrt(np.square(end - true).mean() / np.square(true).mean())),
        "energy": float(np.square(end).sum() / np.square(start).sum()),
        "divergence": max(r.divergence for r in reports),
    }


def cavity(rayleigh: float, cells: int, seconds: float) -> tuple[float, float]:
    """Mean Nusselt numbers at the warm and the cold wall; lengths in sides, times in side^2 / diffusivity."""
    settings = GasSettings(scheme="maccormack", expands=False, viscosity=PRANDTL, diffusivity=1.0, courant=1.0)
    sides: tuple[Side, ...] = ("closed", "closed", "periodic", "periodic", "closed", "closed")
    gas = Gas((cells, 2, cells), 1.0 / cells, sides, settings, gravity=(0.0, 0.0, -PRANDTL * rayleigh))
    gas.warm([0.5, -0.5, None, None, None, None])
    across = (np.arange(cells) + 0.5) / cells
    state = np.zeros((cells, 2, cells, 4), np.float32)
    state[..., 0] = (0.5 - across)[:, None, None]
    gas.state = state
    gas.advance(seconds)
    warm, cold = 0.5 - gas.state[0, 0, :, 0], gas.state[-1, 0, :, 0] + 0.5
    return float(2 * cells * warm.mean()), float(2 * cells * cold.mean())


def ball(cells: int) -> F64:
    """Signed distance to a ball, at the corners of a cube of 1 m."""
    corners = corners_of((cells, cells, cells), 1.0 / cells, np.zeros(3))
    return np.asarray(np.linalg.norm(corners - [0.5, 0.5, 0.6], axis=-1) - 0.15)


def residuals(cells: int, distance: F64 | None, caps: tuple[int, ...] = (2, 4, 6)) -> list[float]:
    """Largest residual of the pressure after some iterations, from noise in a cube with solids and an open top [m/s]."""
    solids = None if distance is None else cut(distance)
    gas = Gas((cells,) * 3, 1.0 / cells, (*CLOSED[:5], "open"), GasSettings(expands=False), solids=solids)
    noise = np.random.default_rng(1).standard_normal((cells + 1, cells + 1, cells + 1, 3), dtype=np.float32)
    found = []
    for cap in caps:
        gas.velocity = noise
        found.append(gas.solve(1e-12, cap).residual)
    return found


def _balls(cells: int) -> F64:
    """Signed distance to balls in the way, at the corners of a cube of 1 m."""
    corners = corners_of((cells, cells, cells), 1.0 / cells, np.zeros(3))
    draw, found = np.random.default_rng(1), np.full(corners.shape[:3], np.inf)
    for _ in range(BALLS):
        found = np.minimum(found, np.linalg.norm(corners - draw.uniform(0.15, 0.85, 3), axis=-1) - draw.uniform(0.04, 0.12))
    return found


def smoke_box(cells: int, scheme: Scheme, *, past_ball: bool = True, follows: bool = False) -> Gas | ActiveGas:
    """An open cube of 1 m with a floor, a source of hot smoke, and a ball above it; `follows`: solved where the smoke is alone."""
    sides: tuple[Side, ...] = ("open", "open", "open", "open", "closed", "open")
    solids = cut(ball(cells)) if past_ball else None
    middle = (np.arange(cells) + 0.5) / cells
    x, y, z = np.meshgrid(middle - 0.5, middle - 0.5, middle - 0.1, indexing="ij", sparse=True)
    rate = np.where(x * x + y * y + z * z < 0.08**2, 5.0, 0.0)
    settings = GasSettings(scheme=scheme, courant=3.0)
    gas = gas_in((cells,) * 3, 1.0 / cells, sides, settings, follows, rate > 0.0, solids=solids)
    gas.emit(rate, SMOKE)
    return gas


def smoke(cells: int, scheme: Scheme, frames: int = 8, *, past_ball: bool = True) -> float:
    """Median seconds of a frame (1/24 s) of smoke that flows past a ball; the first frame compiles and is left out."""
    gas, seconds = smoke_box(cells, scheme, past_ball=past_ball), []
    for _ in range(frames):
        start = time.perf_counter()
        gas.advance(1.0 / 24.0)
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds[1:])


def run() -> dict[str, Any]:
    """All figures; sizes by device."""
    device = chosen_device()
    large = device != "cpu"
    grids = (64, 128, 256) if large else (32, 64)
    # Shares of the cells that a solid cuts are worked out on one core, which takes minutes here.
    largest = (512,) if large else ()
    cavities = [(1e3, 64), (1e4, 64), (1e5, 64), (1e6, 128)] if large else [(1e3, 24), (1e4, 32)]
    falls = {n: residuals(n, _balls(n)) for n in grids} | {n: residuals(n, None) for n in largest}
    return {
        "device": device,
        "vortices": {f"{s} {n}": vortices(n, s) for s in SCHEMES for n in (32, 64)},
        "vortices_in_wind": {f"{s} {n}": vortices(n, s, courant=WINDY, wind=WIND) for s in SCHEMES for n in (32, 64)},
        "cavity": {f"{ra:g}": {"cells": n, "nusselt": cavity(ra, n, 0.3)[0], "published": CAVITY[ra]} for ra, n in cavities},
        "residual_falls_per_two_iterations": {n: [a / b for a, b in pairwise(r)] for n, r in falls.items()},
        "smoke_seconds_per_frame": {f"{s} {n}": smoke(n, s) for s in SCHEMES for n in grids},
        "smoke_seconds_per_frame_without_ball": {f"{s} {n}": smoke(n, s, 4, past_ball=False) for s in SCHEMES for n in largest},
    }

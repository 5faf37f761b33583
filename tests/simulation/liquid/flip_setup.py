"""Boxes of water for the grid engine's tests."""

from __future__ import annotations

from typing import Any

import numpy as np
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.liquid.engine import Engine, Fluid, LiquidReport, LiquidSetup
from worldagent.worlds.arrays import F64

WATER = Fluid("water", 1000.0, 1e-3)
CLOSED = ("closed",) * 6


def no_bodies(count: int = 0) -> BodyState:
    """Boundaries that stand still at the origin."""
    zero = np.zeros((count, 3))
    turn = np.broadcast_to(np.eye(3), (count, 3, 3)).copy()
    return BodyState(zero, turn, zero.copy(), zero.copy(), zero.copy(), np.zeros(count), np.zeros((count, 3, 3)), zero.copy())


def block(low: tuple[float, ...], high: tuple[float, ...], size: float) -> F64:
    """Centres of cubes that fill a box."""
    ticks = [np.arange(a + size / 2, b, size) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)


def tank(
    size: tuple[float, float, float], water: F64, cell: float, *, velocity: F64 | None = None, boundaries: tuple[Boundary, ...] = (),
    **more: Any,
) -> LiquidSetup:  # fmt: skip
    """A tank at the origin with cubes of water of one cell each."""
    n = len(water)
    given: dict[str, Any] = {"sides": CLOSED, "gravity": np.array([0.0, 0.0, -9.81]), **more}
    return LiquidSetup(
        spacing=cell,
        lower=np.zeros(3),
        upper=np.array(size),
        fluids=(WATER,),
        position=water,
        velocity=np.zeros((n, 3)) if velocity is None else velocity,
        fluid=np.zeros(n, np.int32),
        volume=np.full(n, cell**3),
        boundaries=boundaries,
        **given,
    )


def advance(engine: Engine, seconds: float, bodies: BodyState | None = None) -> list[LiquidReport]:
    """Steps until a time has passed."""
    reports, passed = [], 0.0
    while passed < seconds - 1e-9:
        reports.append(engine.step(seconds - passed, bodies or no_bodies()))
        passed += reports[-1].dt
    return reports

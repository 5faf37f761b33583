"""Elastic energy that the contacts of an engine's grains hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64
from ..passes import ALONE

if TYPE_CHECKING:
    from .engine import Grains

__all__ = ["Elastic", "elastic"]


class Elastic(NamedTuple):
    """Elastic energy of all contacts, among grains and with bodies."""

    depth: float
    """Work against Hertz's force less that of adhesion [J]."""
    springs: float
    """In the springs that resist slip and rolling [J]."""


def elastic(engine: Grains) -> Elastic:
    """Elastic energy of contacts at the present places; springs are as the last step left them. Sums keep one order on a device."""
    from . import energy_kernels as kernels

    now, n = engine.now, engine.count
    if not engine.listed or not n:
        return Elastic(0.0, 0.0)
    found = np.zeros(2)
    among = [
        now.state, now.count, now.near, now.spring, now.roll, now.row, now.stride, engine.laws, float(engine.unit), engine.rolls,
        engine.dt,
    ]  # fmt: skip
    found += _sum(engine, "grain_energy", kernels.grain_energy, n, among)
    if now.pair_count:
        walls = [now.state, engine.walls.bodies, now.pairs, engine.wall_laws, warp().float64(engine.unit), engine.dt]
        found += _sum(engine, "wall_energy", kernels.wall_energy, now.pair_count, walls)
    return Elastic(*map(float, found))


def _sum(engine: Grains, name: str, kernel: Any, count: int, inputs: list[Any]) -> F64:
    wp, run = warp(), engine.passes
    values = wp.zeros((count, 2), dtype=wp.float32, device=engine.device)
    partial = wp.zeros((2, run.parts(count)), dtype=wp.float64, device=engine.device)
    result = wp.zeros(2, dtype=wp.float64, device=engine.device)
    run(name, kernel, count, [*inputs, values], smallest=ALONE)()
    for one in run.sum(f"{name}_sum", values, count, partial, result):
        one()
    total: F64 = result.numpy()
    return total

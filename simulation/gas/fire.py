"""Fire in a gas: what burns in a step, and what has burnt."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from ...physics.combustion import SOOT_ABSORPTION, SOOT_SOLID, greatest_power, longest_burning
from . import fire_kernels as kernels

if TYPE_CHECKING:
    from ...physics.combustion import Fuel
    from ..grids.runner import Runner
    from .regions import Regions

__all__ = ["Fire"]

FUEL_DIFFUSIVITY = 2.1e-5
"""Diffusivity of methane in air at room temperature [m^2/s]; only cells of a few millimetres notice."""


class Fire:
    """A fuel in a box of gas.

    Args:
        run: arrays and launches.
        elements: of the fields.
        fuel: what burns.
        cell: its size [m].
        air: temperature [K], density [kg/m^3] and heat capacity [J/(kg K)] of the ambient air.
        gravity: its size [m/s^2].
    """

    def __init__(
        self, run: Runner, elements: int, fuel: Fuel, cell: float, *, air: tuple[float, float, float], gravity: float
    ) -> None:
        wp = warp()
        self.run, self.elements, self.cell = run, elements, cell
        flame = self.flame = kernels.Flame()
        flame.heat, flame.air, flame.soot, flame.radiant = fuel.heat, fuel.air, fuel.soot, fuel.radiant
        flame.ignition, flame.least, flame.greatest = fuel.ignition, fuel.least_heat, greatest_power(cell)
        times = [cell * cell / FUEL_DIFFUSIVITY, *([math.sqrt(2.0 * cell / gravity)] if gravity > 0.0 else [])]
        flame.mixing = min(times)
        flame.ambient, flame.density, flame.capacity = air
        flame.absorption = SOOT_ABSORPTION / SOOT_SOLID
        self.longest = longest_burning(cell, air[0])
        """Longest step [s]."""
        self.spark = run.upload("gas/spark", np.zeros(elements, np.float32), wp.float32)
        self.power = run.upload("gas/power", np.zeros((elements, 2), np.float32), wp.vec2)
        """Released and radiated in the last step [W/m^3]."""
        self._sums = wp.zeros((2, -(-elements // run.block)), dtype=wp.float64, device=run.device)
        self.last = (0.0, 0.0)
        """Released and radiated in the last step [J]."""
        self.released = 0.0
        """Heat of all fuel that has burnt [J]."""
        self.radiated = 0.0
        """Heat that has left the gas by radiation [J]."""

    def __call__(self, seconds: float, box: Any, regions: Regions, room: Any, velocity: Any, state: Any, expansion: Any) -> None:
        """Burn for a step; `state` and `expansion` change."""
        run = self.run
        inputs = [box, self.cell, seconds, self.flame, regions.numbers, regions.ratios, room, self.spark, velocity]
        run(kernels.burn, self.elements, [*inputs, state, self.power, expansion], grain=1024)
        many = -(-self.elements // run.block)
        run(kernels.heats, many, [self.elements, run.block, room, self.power, self._sums], grain=16)
        made, lost = self._sums.numpy().sum(axis=1) * seconds * self.cell**3
        self.last = (float(made), float(lost))
        self.released += self.last[0]
        self.radiated += self.last[1]

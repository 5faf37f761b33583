"""Facts of gases that the specification alone tells: cells, emissions, steps (R60)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....physics.combustion import FUELS, Fuel, longest_burning
from ...arrays import F64
from ...extents import initial_box, initial_volume
from ..loose import domain_box

if TYPE_CHECKING:
    from ...spec import DustDriver, EmissionDriver, Entity, GasInstance, GasPhysics, IgnitionDriver, WorldSpec

__all__ = [
    "LEAST_CELLS",
    "LEAST_SOURCE",
    "SOURCE_SHARE",
    "Grid",
    "dusts_of",
    "dusty_box",
    "emissions_of",
    "fuel_of",
    "gas_counts",
    "gas_of",
    "gas_seconds",
    "grid_of",
    "ignitions_of",
    "lit",
    "yielding_mass",
]

LEAST_SOURCE = 2.0
"""Own choice: cells across a source; a thinner one is a point whose size its cell decides."""
LEAST_CELLS = 4
"""Own choice: a box narrower than so many cells holds no flow."""
SOURCE_SHARE = 0.5
"""Own choice: most of a cell's volume that a source makes in a step, so that what leaves it finds its way out."""
CACHE_BYTES_PER_CELL = 28
"""Soot, temperature, velocity and room in 32 bits, half of it kept after compression, and what checkpoints hold [bytes]."""
CELL_STEPS = 2.0e5
"""Per second on two cores of the development machine, schemes alike within a factor of two; an estimate before anything was measured."""
FOLLOWED = 0.6
"""Share of the cell steps of a box that are left where an active part of it follows the gas (0.43 to 0.65 measured)."""
FLAME = 1200.0
"""Own choice: temperature of flames, for estimates [K]."""
FALL = 0.5
"""Own choice: share of the speed that unhindered hot gas would reach over the height of its box, for estimates."""


class Grid(NamedTuple):
    """Cells of a box."""

    shape: tuple[int, int, int]
    cell: float
    """[m]"""
    corner: F64
    """Lower corner of the first cell [m], shape (3,)."""

    @property
    def cells(self) -> int:
        """Number of cells."""
        return math.prod(self.shape)


def gas_of(spec: WorldSpec, name: str) -> tuple[str, Entity, GasPhysics] | None:
    """The gas of an instance: name, entity and physics; None where its first member is none."""
    member = spec.simulation.gas[name].members[0]
    entity = spec.entities.get(member)
    if entity is None or entity.physics.category != "gas":
        return None
    return member, entity, entity.physics


def grid_of(instance: GasInstance, cell: float) -> Grid:
    """Whole cells about the middle of the declared domain, as many along each axis as come nearest to its size."""
    low, high = domain_box(instance)
    counts = np.maximum(1, np.round((high - low) / cell)).astype(int)
    return Grid((int(counts[0]), int(counts[1]), int(counts[2])), cell, 0.5 * (low + high) - 0.5 * cell * counts)


def emissions_of(spec: WorldSpec, name: str) -> dict[str, EmissionDriver]:
    """Emissions of the gas of an instance, by driver id."""
    members = spec.simulation.gas[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "emission" and d.entity in members}


def ignitions_of(spec: WorldSpec, name: str) -> dict[str, IgnitionDriver]:
    """Ignitions of the gas of an instance, by driver id."""
    members = spec.simulation.gas[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "ignition" and d.entity in members}


def dusts_of(spec: WorldSpec, name: str) -> dict[str, DustDriver]:
    """Drivers that raise dust of the gas of an instance, by driver id."""
    members = spec.simulation.gas[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "dust" and d.entity in members}


def dusty_box(entity: Entity, cell: float) -> tuple[F64, F64] | None:
    """Corners of the room in which impacts raise dust [m]: the box around the parts of a gas, widened by a cell; None where a part is a file."""
    box = initial_box(entity)
    return None if box is None else (box[0] - cell, box[1] + cell)


def yielding_mass(entity: Entity, bodies: Iterable[float]) -> float:
    """Mass of an entity that an impact can stop [kg]: of all its bodies, since bonds and joints hold them; infinite of one that does not give way or has none."""
    return (sum(bodies) or math.inf) if entity.motion == "dynamic" else math.inf


def fuel_of(physics: GasPhysics) -> Fuel | None:
    """Fuel of a gas; None of one that does not burn."""
    return None if physics.fuel is None else FUELS[physics.fuel]


def lit(driver: IgnitionDriver, middles: F64) -> NDArray[np.bool_]:
    """Cells that an ignition lights: those in its ball, and the nearest; (..., 3) middles [m] -> (...)."""
    far = np.linalg.norm(middles - np.array(driver.center), axis=-1)
    return np.asarray((far <= driver.radius) | (far == far.min()))


def _steps(spec: WorldSpec, name: str, entity: Entity, physics: GasPhysics, grid: Grid) -> float:
    """Steps of a run: the fastest of its rise and what its source drives out decide."""
    plan, settings = spec.simulation, spec.simulation.gas[name].settings
    seconds = plan.preroll + (plan.frames - 1) / plan.fps
    lift = abs(1.0 - settings.ambient_temperature / physics.temperature) + physics.soot_density
    fuel = fuel_of(physics)
    burning = 0.0 if fuel is None else 1.0 - settings.ambient_temperature / FLAME
    rise = FALL * math.sqrt(2.0 * math.hypot(*plan.gravity) * max(lift, burning) * grid.shape[2] * grid.cell)
    rate = sum(d.rate for d in emissions_of(spec, name).values())
    volume = max(initial_volume(entity), grid.cell**3)
    blast = rate / volume ** (2.0 / 3.0)
    step = min(settings.max_step, settings.courant * grid.cell / max(rise, blast, 1e-9))
    if fuel is not None:
        step = min(step, longest_burning(grid.cell, settings.ambient_temperature))
    return seconds / float(min(step, SOURCE_SHARE * volume / max(rate, 1e-12)))


def gas_counts(spec: WorldSpec) -> dict[str, float]:
    """Amounts that the gases of a world take, by name of the cap."""
    cells = steps = work = 0.0
    for name, instance in spec.simulation.gas.items():
        found = gas_of(spec, name)
        if found is None:
            continue
        grid = grid_of(instance, found[2].resolution)
        taken = _steps(spec, name, found[1], found[2], grid)
        cells, steps, work = (
            cells + grid.cells,
            steps + taken,
            work + taken * grid.cells * (FOLLOWED if instance.settings.follows else 1.0),
        )
    return {
        "cells": cells,
        "steps": steps,
        "cell_steps": work,
        "cache_bytes": cells * spec.simulation.frames * CACHE_BYTES_PER_CELL,
    }


def gas_seconds(spec: WorldSpec) -> float | None:
    """Seconds that the gases of a world will take by a usual rate; None without any."""
    return gas_counts(spec)["cell_steps"] / CELL_STEPS if spec.simulation.gas else None

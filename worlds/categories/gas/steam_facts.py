"""Facts of steam where hot matter meets water, that the specification alone tells (R60)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....physics.interfaces import SUPPORT
from ..liquid.facts import spacing_of

if TYPE_CHECKING:
    from ...spec import SteamDriver, WorldSpec

__all__ = ["HotMatter", "contact_reach", "hot_matter", "instance_of", "steams_of", "water_temperature"]


class HotMatter(NamedTuple):
    """Hot matter of a driver of steam."""

    driver: str
    entity: str
    liquid: bool
    temperature: float
    """[K] Before it gave any heat."""
    heat_capacity: float
    """[J/(kg K)]"""


def steams_of(spec: WorldSpec, name: str) -> dict[str, SteamDriver]:
    """Drivers that make steam of the gas of an instance, by driver id."""
    members = spec.simulation.gas[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "steam" and d.entity in members}


def hot_matter(spec: WorldSpec, drivers: dict[str, SteamDriver]) -> tuple[HotMatter, ...]:
    """Hot entities of drivers, in the order of the drivers' ids: rows of the channels about them."""
    found = []
    for key, driver in sorted(drivers.items()):
        for name in driver.hot:
            physics = spec.entities[name].physics
            if physics.category == "liquid":
                found.append(HotMatter(key, name, True, physics.temperature, physics.heat_capacity))
            else:
                found.append(HotMatter(key, name, False, float(driver.temperature or np.nan), driver.heat_capacity))
    return tuple(found)


def instance_of(spec: WorldSpec, entity: str) -> str | None:
    """The instance that moves an entity; None where there is none."""
    return next((n for n, i in spec.simulation.solvers.items() if entity in i.members), None)


def water_temperature(spec: WorldSpec, driver: SteamDriver) -> float:
    """Temperature of the water that boils [K], of several liquids their mean."""
    physics = [spec.entities[n].physics for n in driver.water]
    return float(np.mean([p.temperature for p in physics if p.category == "liquid"]))


def contact_reach(spec: WorldSpec, driver: SteamDriver) -> float:
    """Distance within which particles of water touch what is hot [m]: the support of the kernel that tells the area."""
    held = instance_of(spec, driver.water[0])
    return SUPPORT * spacing_of(spec, held) if held in spec.simulation.liquid and held is not None else 0.0

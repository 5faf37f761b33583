"""Rows of the audit about steam where hot matter meets water (R60)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ....physics.boiling import BOILING, STEAM_DENSITY
from ...extents import initial_box
from ...problems import Problem, removed, replaced
from ..loose import domain_box, told_box
from .steam_facts import instance_of

if TYPE_CHECKING:
    from ...spec import GasPhysics, SteamDriver, WorldSpec

__all__ = ["steam_problems"]

DROPS = 0.08
"""[kg/m^3] Own choice: drops in steam as it comes, offered where a gas carries none: that of a kettle."""
SLACK = 0.5
"""[K] The temperature of the gas may be this far from that of boiling water."""
ACROSS = 2.0
"""[cells] Least radius of the balls in which steam comes: thinner ones are as wide as their cells."""


def steam_problems(spec: WorldSpec, key: str, driver: SteamDriver) -> Iterator[Problem]:
    """Problems of one driver that makes steam: of what gas, of what heat, of what water."""
    place, entity = f"/simulation/drivers/{key}", spec.entities.get(driver.entity)
    if entity is None:
        return
    if entity.physics.category != "gas":
        yield Problem(f"{place}/entity", f"steam {key!r} makes {driver.entity!r}, which is no gas; name a gas")
        return
    last = (spec.simulation.frames - 1) / spec.simulation.fps
    if not driver.start < last:
        yield Problem(
            f"{place}/start", f"steam {key!r} starts at {driver.start:g} s, after the last frame at {last:g} s; start it before"
        )
    yield from _gas(key, driver.entity, entity.physics)
    cell = entity.physics.resolution
    if driver.radius < (1.0 - 1e-9) * ACROSS * cell:
        text = f"steam {key!r} comes in balls of {driver.radius:g} m, at least {ACROSS:g} cells of {cell:g} m are resolved; widen them"
        yield Problem(f"{place}/radius", text, replaced(f"{place}/radius", round(ACROSS * cell, 6)))
    for k, name in enumerate(driver.water):
        yield from _water(spec, f"{place}/water/{k}", key, driver, name)
    for k, name in enumerate(driver.hot):
        yield from _hot(spec, f"{place}/hot/{k}", key, driver, name)


def _gas(key: str, member: str, physics: GasPhysics) -> Iterator[Problem]:
    """Problems of the gas that steam is: as hot as boiling water, with drops in it, nothing that burns."""
    place = f"/entities/{member}/physics"
    if abs(physics.temperature - BOILING) > SLACK:
        text = f"steam {key!r} makes {member!r} at {physics.temperature:g} K, but water boils at {BOILING:g} K: give it that temperature"
        yield Problem(f"{place}/temperature", text, replaced(f"{place}/temperature", BOILING))
    if not 0.0 < physics.soot_density <= STEAM_DENSITY:
        text = (
            f"steam {key!r} makes {member!r} with {physics.soot_density:g} kg/m^3 of drops; a cubic metre of steam can give above 0 and at most "
            f"{STEAM_DENSITY:g} kg: say how much of it is seen as drops (a kettle's: {DROPS:g})"
        )
        yield Problem(f"{place}/soot_density", text, replaced(f"{place}/soot_density", DROPS))
    if physics.fuel is not None:
        text = f"steam {key!r} makes {member!r}, which has the fuel {physics.fuel!r}; steam does not burn: leave fuel out"
        yield Problem(f"{place}/fuel", text, removed(f"{place}/fuel"))


def _water(spec: WorldSpec, place: str, key: str, driver: SteamDriver, name: str) -> Iterator[Problem]:
    """Problems of the water that boils."""
    entity = spec.entities.get(name)
    if entity is None:
        return
    if entity.physics.category != "liquid":
        yield Problem(
            place, f"steam {key!r} comes of {name!r}, which is {entity.physics.category}; name a liquid of substance water"
        )
        return
    material = spec.materials.get(entity.material)
    if material is not None and material.substance != "water":
        where = f"/materials/{entity.material}/substance"
        text = f"steam {key!r} comes of {name!r}, which is of substance {material.substance!r}; only water boils here: make it water, or name another liquid"
        yield Problem(where, text, replaced(where, "water"))
    if not 273.0 <= entity.physics.temperature <= BOILING:
        where = f"/entities/{name}/physics/temperature"
        text = f"the water {name!r} of steam {key!r} has {entity.physics.temperature:g} K; liquid water has 273 to {BOILING:g} K: choose one of these"
        yield Problem(where, text, replaced(where, 293.15))
    if entity.physics.conductivity > 0.0:
        where = f"/entities/{name}/physics/conductivity"
        text = (
            f"the water {name!r} of steam {key!r} conducts heat ({entity.physics.conductivity:g} W/(m K)), and would take heat of what is hot beside that "
            "which makes steam; leave its conductivity at 0"
        )
        yield Problem(where, text, replaced(where, 0.0))
    solver = instance_of(spec, name)
    if solver is None or solver not in spec.simulation.liquid:
        yield Problem(place, f"steam {key!r} comes of {name!r}, which no liquid instance moves; make it a member of one")
    yield from _covered(spec, key, driver, name)


def _covered(spec: WorldSpec, key: str, driver: SteamDriver, name: str) -> Iterator[Problem]:
    """The box of the gas holds the water from above, and the balls of steam over it."""
    box = initial_box(spec.entities[name])
    for solver, instance in spec.simulation.gas.items():
        if driver.entity not in instance.members or box is None:
            continue
        low, high = domain_box(instance)
        most, least = box[1].copy(), box[0].copy()
        most[2] += 2.0 * driver.radius
        least[2] = box[1][2]
        if (least < low - 1e-9).any() or (most > high + 1e-9).any():
            text = (
                f"the box of the gas {driver.entity!r} {told_box(low, high)} does not hold the water {name!r} from above with the balls of steam over it "
                f"{told_box(least, most)}; steam would come outside of it: widen or move the domain"
            )
            yield Problem(f"/simulation/solvers/{solver}/settings/domain", text)


def _hot(spec: WorldSpec, place: str, key: str, driver: SteamDriver, name: str) -> Iterator[Problem]:
    """Problems of hot matter: solid in one piece with a temperature by the driver, or liquid of the water's instance with its own."""
    entity = spec.entities.get(name)
    if entity is None:
        return
    others = [k for k, d in spec.simulation.drivers.items() if d.kind == "steam" and k != key and name in d.hot]
    if others:
        yield Problem(
            place, f"steam {key!r} cools {name!r}, which {others[0]!r} cools, too; its heat is there once: name it in one of them"
        )
    if entity.physics.category == "liquid":
        if not entity.physics.temperature > BOILING:
            where = f"/entities/{name}/physics/temperature"
            text = f"steam {key!r} takes heat of {name!r} at {entity.physics.temperature:g} K; above {BOILING:g} K water boils at it (lava 1300 to 1500): raise it"
            yield Problem(where, text)
        met = {instance_of(spec, n) for n in driver.water}
        if met != {instance_of(spec, name)}:
            text = (
                f"steam {key!r}: {name!r} and the water {', '.join(map(repr, driver.water))} are of different instances, whose liquids pass through each other; "
                "make them members of one (engine dfsph)"
            )
            yield Problem(place, text)
    elif entity.physics.category != "rigid" or entity.breakable is not None or entity.generator is not None:
        what = "breakable" if entity.breakable is not None else entity.physics.category
        yield Problem(
            place,
            f"steam {key!r} takes heat of {name!r}, which is {what}; name rigid entities in one piece without a generator, or liquids",
        )
    elif driver.temperature is None:
        where = f"/simulation/drivers/{key}/temperature"
        text = f"steam {key!r} takes heat of the rigid {name!r} and names no temperature; give that of solids, 380 to 3000 K (red-hot iron 1000, lava rock 1300)"
        yield Problem(where, text, {"op": "add", "path": where, "value": 1000.0})

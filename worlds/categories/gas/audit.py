"""Rows of the audit about gases: one source per box, in it and resolved, with something that makes it and a way out (R60)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...extents import box_extent, initial_box
from ...fields import Fields, acting_on, field_drivers
from ...problems import Problem, removed, replaced
from ..loose import ROUNDED, domain_box, told_box
from .burning import burning_problems
from .dust import dust_problems
from .facts import LEAST_CELLS, LEAST_SOURCE, dusts_of, emissions_of, fuel_of, gas_of, grid_of, ignitions_of
from .steam import steam_problems
from .steam_facts import steams_of

if TYPE_CHECKING:
    from ...spec import Entity, FieldDriver, GasInstance, GasPhysics, IgnitionDriver, WorldSpec

__all__ = ["gas_problems"]

MARGIN = 4.0
"""Own choice: cells around a source that a box is offered to have at least."""
SEEN = 9
"""Own choice: points along each edge of a side, and times of a sequence, at which a field is looked for."""
LEAST_FOLLOWED = 24
"""Own choice: cells along the longest side of a box from which on a part of it may follow its gas: two blocks of eight, and one to grow."""
BOUSSINESQ = 0.1
"""Largest difference of temperatures, as a share of the ambient one, that Boussinesq's approximation describes within some percent
(Gray and Giorgini 1976, doi:10.1016/0017-9310(76)90168-X)."""


def gas_problems(spec: WorldSpec) -> list[Problem]:
    """Problems of gases, their instances and their drivers."""
    found = [*_entities(spec)]
    for name, instance in spec.simulation.gas.items():
        found += _instance(spec, name, instance)
    return [*found, *_drivers(spec), *_couplings(spec)]


def _entities(spec: WorldSpec) -> Iterator[Problem]:
    for name, entity in spec.entities.items():
        if entity.physics.category != "gas":
            continue
        place = f"/entities/{name}"
        if entity.motion != "dynamic":
            yield Problem(
                f"{place}/motion",
                f"the gas {name!r} is {entity.motion}; gases are dynamic",
                replaced(f"{place}/motion", "dynamic"),
            )
        if entity.generator is not None:
            yield Problem(
                f"{place}/generator", f"the gas {name!r} has a generator; give it parts that are the room of its source"
            )


def _instance(spec: WorldSpec, name: str, instance: GasInstance) -> Iterator[Problem]:
    place = f"/simulation/solvers/{name}"
    if len(instance.members) > 1:
        yield Problem(
            f"{place}/members",
            f"{name!r} has {len(instance.members)} gases, a box has 1; give each of the others an instance of its own, or make their "
            f"parts parts of {instance.members[0]!r}",
            replaced(f"{place}/members", instance.members[:1]),
        )
    held = gas_of(spec, name)
    if held is None:
        return
    member, entity, physics = held
    yield from _source(spec, name, member, entity, physics)
    yield from _burning(spec, name, member, physics, instance)
    yield from burning_problems(spec, name)
    yield from _blown(spec, member, instance)
    yield from _followed(spec, name, member, instance)
    settings, hot = instance.settings, physics.temperature / instance.settings.ambient_temperature - 1.0
    if not settings.expands and abs(hot) > BOUSSINESQ:
        yield Problem(
            f"{place}/settings/expands",
            f"{member!r} has {physics.temperature:g} K, {abs(hot):.0%} from the ambient {settings.ambient_temperature:g} K; without expansion "
            f"at most {BOUSSINESQ:.0%} is described: let it expand",
            replaced(f"{place}/settings/expands", True),
        )
    if (emissions_of(spec, name) or dusts_of(spec, name) or steams_of(spec, name)) and "open" not in settings.domain.sides:
        yield Problem(
            f"{place}/settings/domain/sides",
            f"{member!r} is let into a box without an open side, which has no room for it; open one, as the top",
            replaced(f"{place}/settings/domain/sides", [*settings.domain.sides[:5], "open"]),
        )


def _source(spec: WorldSpec, name: str, member: str, entity: Entity, physics: GasPhysics) -> Iterator[Problem]:
    """Problems of the box and the shape of a source."""
    place, cell = f"/simulation/solvers/{name}/settings/domain", physics.resolution
    grid = grid_of(spec.simulation.gas[name], cell)
    if min(grid.shape) < LEAST_CELLS:
        yield Problem(
            f"{place}/size",
            f"the domain of {member!r} is {min(grid.shape)} cells of {cell:g} m wide, at least {LEAST_CELLS} hold a flow; widen it, or use "
            f"a resolution of at most {cell * min(grid.shape) / LEAST_CELLS:.3g} m",
        )
    thin = min((e for p in entity.parts.values() if (e := box_extent(p.shape)) is not None), default=np.inf)
    if thin < (1.0 - ROUNDED) * LEAST_SOURCE * cell:
        yield Problem(
            f"/entities/{member}/physics/resolution",
            f"the source {member!r} is {thin:.3g} m thin, less than {LEAST_SOURCE:g} cells of {cell:g} m; use at most "
            f"{thin / LEAST_SOURCE:.3g} m, or make it larger",
        )
    box, low, high = initial_box(entity), grid.corner, grid.corner + cell * np.array(grid.shape)
    if box is not None and ((box[0] < low - 1e-9).any() or (box[1] > high + 1e-9).any()):
        around = MARGIN * cell
        low_to, high_to = np.minimum(low, box[0] - around), np.maximum(high, box[1] + around)
        center, size = (0.5 * (low_to + high_to)).round(4).tolist(), (high_to - low_to).round(4).tolist()
        yield Problem(
            place,
            f"the source {member!r} {told_box(*box)} reaches out of the box of its gas {told_box(low, high)}; widen or move the domain",
            replaced(place, {"center": center, "size": size, "sides": list(spec.simulation.gas[name].settings.domain.sides)}),
        )


def _burning(spec: WorldSpec, name: str, member: str, physics: GasPhysics, instance: GasInstance) -> Iterator[Problem]:
    """Problems of a gas that may burn: it expands, and something lights it."""
    fuel = fuel_of(physics)
    if fuel is None:
        return
    if not instance.settings.expands:
        place = f"/simulation/solvers/{name}/settings/expands"
        yield Problem(place, f"{member!r} burns, and hot gas is light: let it expand", replaced(place, True))
    if physics.temperature < fuel.ignition and not ignitions_of(spec, name):
        source = initial_box(spec.entities[member])
        middle = [0.0, 0.0, 0.0] if source is None else (0.5 * (source[0] + source[1])).round(4).tolist()
        value = {"kind": "ignition", "entity": member, "center": middle, "radius": round(2.0 * physics.resolution, 6), "end": 1.0}
        text = (
            f"nothing lights {member!r}: it comes with {physics.temperature:g} K and burns by itself from {fuel.ignition:g} K on; add a driver "
            "of kind 'ignition', or leave out fuel where it does not burn"
        )
        yield Problem("/simulation/drivers", text, {"op": "add", "path": f"/simulation/drivers/{member}-spark", "value": value})


def _ignition(spec: WorldSpec, key: str, driver: IgnitionDriver, entity: Entity | None) -> Iterator[Problem]:
    """Problems of one ignition."""
    place = f"/simulation/drivers/{key}"
    if entity is None:
        return
    if entity.physics.category != "gas" or entity.physics.fuel is None:
        yield Problem(f"{place}/entity", f"ignition {key!r} lights {driver.entity!r}, which is no gas with a fuel; name one")
        return
    if not driver.start < (spec.simulation.frames - 1) / spec.simulation.fps:
        yield Problem(f"{place}/start", f"ignition {key!r} starts at {driver.start:g} s, after the last frame")
    for name, instance in spec.simulation.gas.items():
        low, high = domain_box(instance)
        if driver.entity in instance.members and not ((low <= driver.center) & (high >= driver.center)).all():
            text = f"ignition {key!r} is at {list(driver.center)}, outside the box of the gas of {name!r} {told_box(low, high)}; move it into the gas"
            yield Problem(f"{place}/center", text)


def _drivers(spec: WorldSpec) -> Iterator[Problem]:
    emitting = set()
    for key, driver in spec.simulation.drivers.items():
        place = f"/simulation/drivers/{key}"
        entity = spec.entities.get(getattr(driver, "entity", "") or "")
        gas = entity is not None and entity.physics.category == "gas"
        if driver.kind == "ignition":
            yield from _ignition(spec, key, driver, entity)
        elif driver.kind == "dust":
            emitting.add(driver.entity)
            yield from dust_problems(spec, key, driver)
        elif driver.kind == "steam":
            emitting.add(driver.entity)
            yield from steam_problems(spec, key, driver)
        elif driver.kind == "emission":
            emitting.add(driver.entity)
            if entity is not None and not gas:
                yield Problem(f"{place}/entity", f"emission {key!r} makes {driver.entity!r}, which is no gas; name a gas")
            elif not driver.start < (spec.simulation.frames - 1) / spec.simulation.fps:
                yield Problem(f"{place}/start", f"emission {key!r} starts at {driver.start:g} s, after the last frame")
        elif gas:
            yield Problem(
                place,
                f"driver {driver.kind!r} cannot act on a gas; use emission, dust, steam, ignition, a field (wind), or a solid that moves it",
                removed(place),
            )
    for name, entity in spec.entities.items():
        if entity.physics.category == "gas" and name not in emitting:
            text = f"nothing makes the gas {name!r}; add a driver of kind 'emission' with its rate [m^3/s], of kind 'dust' for what impacts raise, or of kind 'steam' where hot matter meets water"
            add = {
                "op": "add",
                "path": f"/simulation/drivers/{name}-source",
                "value": {"kind": "emission", "entity": name, "rate": 0.01},
            }
            yield Problem("/simulation/drivers", text, add)


def _blown(spec: WorldSpec, member: str, instance: GasInstance) -> Iterator[Problem]:
    """Fields that act on a gas: it feels the air beyond open sides, and no pull."""
    for key, driver in field_drivers(spec).items():
        if member not in acting_on(spec, driver) or driver.field.kind == "drag":
            continue
        place = f"/simulation/drivers/{key}"
        if driver.field.kind == "attraction":
            text = f"field {key!r} pulls at the gas {member!r}, which feels no pull but gravity; name the entities that it acts on, without the gas"
            yield Problem(f"{place}/entities", text)
        elif "open" not in instance.settings.domain.sides:
            text = f"field {key!r} moves the air beyond open sides, and the box of {member!r} has none; open the side that it blows in at"
            yield Problem(f"/simulation/solvers/{_owner(spec, member)}/settings/domain/sides", text)
        elif not _arrives(spec, driver, instance):
            text = (
                f"field {key!r} moves the air beyond open sides, and at those of the box of {member!r} it blows at no time; move its region or "
                "time, or widen or open the domain there"
            )
            yield Problem(place, text)


def _followed(spec: WorldSpec, name: str, member: str, instance: GasInstance) -> Iterator[Problem]:
    """A gas that a part of its box follows: the air beyond that part is still, and its box has room for one."""
    if not instance.settings.follows:
        return
    place, held = f"/simulation/solvers/{name}/settings/follows", gas_of(spec, name)
    for key, driver in field_drivers(spec).items():
        if member in acting_on(spec, driver) and driver.field.kind not in ("drag", "attraction"):
            speed = _fastest_at_sides(spec, driver, instance)
            text = (
                f"follows is true, and field {key!r} moves the air at the sides of the box of {member!r} with {speed:.3g} m/s; a part that follows "
                "the gas lies in air at rest, 0 m/s: set follows to false"
            )
            yield Problem(place, text, replaced(place, False))
    if held is not None and max(grid_of(instance, held[2].resolution).shape) < LEAST_FOLLOWED:
        many = max(grid_of(instance, held[2].resolution).shape)
        text = (
            f"follows is true, and the box of {member!r} is {many} cells long; a part that follows the gas and its margin take "
            f"{LEAST_FOLLOWED} cells at least, so that it would gain nothing: set follows to false"
        )
        yield Problem(place, text, replaced(place, False))


def _arrives(spec: WorldSpec, driver: FieldDriver, instance: GasInstance) -> bool:
    """True if a field moves the air at an open side of a box, at some of a few times."""
    return _fastest_at_sides(spec, driver, instance) > 0.0


def _fastest_at_sides(spec: WorldSpec, driver: FieldDriver, instance: GasInstance) -> float:
    """Greatest speed along an axis with which a field moves the air at open sides of a box, at a few times [m/s]; 0 without any."""
    fields, (low, high) = Fields({"field": driver}), domain_box(instance)
    axes = [np.linspace(low[k], high[k], SEEN) for k in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    sides = [
        np.moveaxis(points, k // 2, 0)[-(k % 2)].reshape(-1, 3)
        for k, s in enumerate(instance.settings.domain.sides)
        if s == "open"
    ]
    last = (spec.simulation.frames - 1) / spec.simulation.fps
    if not sides:
        return 0.0
    at = np.concatenate(sides)
    return max(float(np.abs(fields.medium(at, t).velocity).max()) for t in np.linspace(0.0, last, SEEN))


def _owner(spec: WorldSpec, member: str) -> str:
    return next(name for name, instance in spec.simulation.gas.items() if member in instance.members)


def _couplings(spec: WorldSpec) -> Iterator[Problem]:
    plan = spec.simulation
    for name, coupling in plan.couplings.items():
        gases = [s for s in (coupling.source, coupling.target) if s in plan.gas]
        if gases and coupling.direction == "two_way" and coupling.source not in plan.gas:
            place = f"/simulation/couplings/{name}"
            text = f"coupling {name!r}: the gas of {gases[0]!r} does not push and feel at once; let it carry {coupling.source!r} (one_way from the gas), or leave it out"
            yield Problem(place, text, removed(place))

"""Rows of the audit about dust that impacts raise (R60)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...problems import Problem, replaced
from .facts import dusty_box

if TYPE_CHECKING:
    from ...spec import DustDriver, GasPhysics, WorldSpec

__all__ = ["dust_problems"]

AIRBORNE = 0.5
"""[kg/m^3] Own choice: dust in a cloud as it rises, offered where a gas carries none."""


def dust_problems(spec: WorldSpec, key: str, driver: DustDriver) -> Iterator[Problem]:
    """Problems of one driver that raises dust: what it raises, and who."""
    place, entity = f"/simulation/drivers/{key}", spec.entities.get(driver.entity)
    if entity is None:
        return
    if entity.physics.category != "gas":
        yield Problem(f"{place}/entity", f"dust {key!r} raises {driver.entity!r}, which is no gas; name a gas")
        return
    if not driver.start < (spec.simulation.frames - 1) / spec.simulation.fps:
        yield Problem(f"{place}/start", f"dust {key!r} starts at {driver.start:g} s, after the last frame")
    if dusty_box(entity, entity.physics.resolution) is None:
        yield Problem(
            f"/entities/{driver.entity}/parts",
            f"{driver.entity!r} is the room in which dust lies; make its parts of simple shapes",
        )
    yield from _carried(spec, key, driver.entity, entity.physics)
    for k, name in enumerate(driver.bodies):
        yield from _body(spec, f"{place}/bodies/{k}", key, name)


def _carried(spec: WorldSpec, key: str, member: str, physics: GasPhysics) -> Iterator[Problem]:
    """Problems of the gas that dust comes with: air of the place, with dust in it and nothing that burns."""
    place = f"/entities/{member}/physics"
    if physics.soot_density <= 0.0:
        text = f"dust {key!r} raises {member!r}, which carries nothing (soot_density 0): say how much dust is in a cubic metre of it as it rises"
        yield Problem(f"{place}/soot_density", text, replaced(f"{place}/soot_density", AIRBORNE))
    if physics.fuel is not None:
        yield Problem(
            f"{place}/fuel", f"dust {key!r} raises {member!r}, which has a fuel; dust does not burn in this build: leave fuel out"
        )
    ambient = next((i.settings.ambient_temperature for i in spec.simulation.gas.values() if member in i.members), None)
    if ambient is not None and physics.temperature != ambient:
        text = f"dust {key!r} raises {member!r} at {physics.temperature:g} K, but dust comes with the air of the place, which has {ambient:g} K"
        yield Problem(f"{place}/temperature", text, replaced(f"{place}/temperature", ambient))


def _body(spec: WorldSpec, place: str, key: str, name: str) -> Iterator[Problem]:
    """Problems of a body that raises dust."""
    body = spec.entities.get(name)
    if body is None:
        return
    if body.physics.category != "rigid" or body.motion == "static":
        yield Problem(
            place,
            f"dust {key!r} comes of what {name!r} hits, which is {body.motion} {body.physics.category}; name rigid bodies that move",
        )
    elif not any(name in i.members for i in spec.simulation.rigid.values()):
        yield Problem(place, f"dust {key!r} comes of what {name!r} hits, which no rigid instance moves; make it a member of one")

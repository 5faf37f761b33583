"""Rows of the audit about force fields: whom they act on, and when (R18)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..categories.registry import CATEGORIES
from ..fields import acting_on, field_drivers
from ..problems import Problem, removed
from .lift import lift_problems

if TYPE_CHECKING:
    from ..spec import FieldDriver, WorldSpec

__all__ = ["field_problems"]


def field_problems(spec: WorldSpec) -> list[Problem]:
    """Fields that act on nothing, on what cannot feel them, or too late; bodies that declare lift without cause."""
    found: list[Problem] = []
    for name, driver in field_drivers(spec).items():
        found += _named(spec, name, driver)
        if not acting_on(spec, driver) and not found:
            text = f"field {name!r} acts on nothing that moves; leave it out, or add what it should move"
            found.append(Problem(f"/simulation/drivers/{name}", text))
        last = (spec.simulation.frames - 1) / spec.simulation.fps
        if driver.start >= last:
            text = f"field {name!r} begins at {driver.start:g} s, after the last frame ({last:.3g} s); start it earlier"
            found.append(Problem(f"/simulation/drivers/{name}/start", text))
    return [*found, *lift_problems(spec)]


def _named(spec: WorldSpec, name: str, driver: FieldDriver) -> Iterator[Problem]:
    for k, member in enumerate(driver.entities or ()):
        entity = spec.entities.get(member)
        if entity is None:
            continue
        place = f"/simulation/drivers/{name}/entities/{k}"
        out = removed(place) if len(driver.entities or ()) > 1 else None
        if not entity.physics.feels_fields:
            known = ", ".join(sorted(n for n, c in CATEGORIES.items() if c.physics is not None and c.physics.feels_fields))
            text = f"field {name!r} cannot act on {member!r}: fields act on {known} matter, not on {entity.physics.category}; take it out"
            yield Problem(place, text, out)
        elif entity.motion != "dynamic":
            text = f"field {name!r} cannot move {member!r}, which is {entity.motion}; make it dynamic or take it out"
            yield Problem(place, text, out)

"""Rows of the audit about bodies that declare lift: a medium moves past them, and they are flat and of one piece (R18, R66)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..extents import box_size
from ..fields import acting_on, field_drivers, fields_of
from ..problems import Problem, replaced

if TYPE_CHECKING:
    from ..spec import Entity, WorldSpec

__all__ = ["declares_lift", "lift_problems"]

LEAST_FLAT = 0.2
"""[1] Own choice: of what is less flat no law of plates tells, and drag is four fifths of the force at least."""
DENSEST = 20.0
"""[kg/m^3] Own choice: densest medium whose own mass, moved along with a plate, is left out; gases are below it."""


def declares_lift(spec: WorldSpec) -> bool:
    """True if any entity does."""
    return any(e.physics.lifted for e in spec.entities.values())


def lift_problems(spec: WorldSpec) -> Iterator[Problem]:
    """Bodies that nothing lifts, or whose lift no law tells."""
    for name, entity in spec.entities.items():
        if not entity.physics.lifted:
            continue
        place = f"/entities/{name}/physics/lift"
        found = _whole(name, entity) or _moved(spec, name, entity) or _flat(name, entity)
        if found:
            yield Problem(place, f"{found}, or set lift to false", replaced(place, False))


def _whole(name: str, entity: Entity) -> str:
    """Problem of a body whose hull is not known from the start."""
    if entity.motion != "dynamic":
        return f"lift moves what is dynamic, and {name!r} is {entity.motion}; make it dynamic"
    if entity.breakable is not None:
        return f"{name!r} is breakable, and lift acts on the hull of a whole body; leave breakable out"
    if entity.generator is not None or not entity.parts:
        return f"{name!r} has no parts whose hull lift could act on; give it parts in place of a generator"
    return ""


def _moved(spec: WorldSpec, name: str, entity: Entity) -> str:
    """Problem of a body that no medium, or none light enough, moves past."""
    if not fields_of(spec, name).has_medium:
        return (
            f"lift of {name!r}: no field of kind 'wind', 'turbulence', 'vortex' or 'drag' acts on it and no gas carries it, so that it has no medium; add a field, "
            "or a coupling from a gas to its instance"
        )
    for key, driver in field_drivers(spec).items():
        field = driver.field
        if field.kind != "attraction" and name in acting_on(spec, driver) and field.density > DENSEST:
            return (
                f"lift of {name!r}: the medium of field {key!r} has {field.density:g} kg/m^3, and what of it a plate moves along is left out, which holds up to "
                f"{DENSEST:g} kg/m^3; give a gas's density"
            )
    return ""


def _flat(name: str, entity: Entity) -> str:
    """Problem of a body that is about as thick as wide, as far as the specification tells."""
    (part, *others) = entity.parts.values()
    size = box_size(part.shape)
    if others or size is None or part.shape.kind not in ("box", "sphere", "cylinder", "capsule"):
        return ""
    thin, wide, _ = np.sort(size).tolist()
    flat = 1.0 - thin / wide
    if flat >= LEAST_FLAT:
        return ""
    return (
        f"lift of {name!r}: it is {thin:.3g} m thick and {wide:.3g} m wide, so that its flatness, one less their ratio, is {flat:.2g}, at least {LEAST_FLAT:g} has lift to speak "
        "of; make it thinner"
    )

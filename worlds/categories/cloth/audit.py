"""Rows of the audit about cloth: resolution against thickness, what holds it, drivers that cannot reach it (R63, R64)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ...materials import DENSITY_RANGES
from ...problems import Problem, replaced
from ...weights import ROUNDING
from ..holders import cannot_hold
from .facts import THIN, grids_of, held_by, vertices_by_part, vertices_of
from .models import ClothPhysics

if TYPE_CHECKING:
    from ...spec import Entity, WorldSpec

__all__ = ["cloth_problems", "has_sheets", "mass_problems"]

LEAST_EDGES = 4
"""Own choice: a sheet with fewer edges across cannot bend."""


def cloth_problems(spec: WorldSpec) -> list[Problem]:
    """Problems of cloth, its instances, pins and drivers."""
    found: list[Problem] = []
    for name, entity in spec.entities.items():
        if entity.physics.category == "cloth":
            found += [*_entity(name, entity), *_resolution(spec, name, entity), *_pins(spec, name, entity), *_tear(name, entity)]
            found += _joined(name, entity)
        else:
            for key, part in entity.parts.items():
                if part.shape.kind == "sheet":
                    text = (
                        f"part {key!r} of {name!r} is a sheet, and {name!r} is {entity.physics.category}; sheets are cloth only"
                    )
                    found.append(Problem(f"/entities/{name}/parts/{key}/shape", text))
    for key, driver in spec.simulation.drivers.items():
        moved = spec.entities.get(getattr(driver, "entity", ""))
        if moved is not None and moved.physics.category == "cloth" and driver.kind not in ("field", "release"):
            text = f"driver {driver.kind!r} cannot act on cloth; use a field, a release, a pin to a body that moves, or gravity"
            found.append(Problem(f"/simulation/drivers/{key}", text))
    for key, joint in spec.simulation.joints.items():
        for end in ("parent", "child"):
            other = spec.entities.get(getattr(joint, end) or "")
            if other is not None and other.physics.category == "cloth":
                text = f"joint {key!r} joins the cloth {getattr(joint, end)!r}; hold cloth by pins in its physics"
                found.append(Problem(f"/simulation/joints/{key}/{end}", text))
    return found


def has_sheets(spec: WorldSpec) -> bool:
    """True if a part of any entity is a sheet."""
    return any(p.shape.kind == "sheet" for e in spec.entities.values() for p in e.parts.values())


def _entity(name: str, entity: Entity) -> Iterator[Problem]:
    if entity.motion != "dynamic":
        place = f"/entities/{name}/motion"
        text = f"the cloth {name!r} is {entity.motion}; cloth is dynamic, and pins hold it"
        yield Problem(place, text, replaced(place, "dynamic"))
    if entity.generator is not None:
        yield Problem(f"/entities/{name}/generator", f"the cloth {name!r} has a generator; give it parts: sheets or meshes")
    for key, part in entity.parts.items():
        if part.shape.kind not in ("sheet", "mesh"):
            text = f"part {key!r} of the cloth {name!r} is a {part.shape.kind}; cloth is made of sheets or meshes"
            yield Problem(f"/entities/{name}/parts/{key}/shape", text)


def _resolution(spec: WorldSpec, name: str, entity: Entity) -> Iterator[Problem]:
    physics = entity.physics
    if physics.category != "cloth":
        return
    shortest = min((edge for _, edge in grids_of(entity)), default=None)
    if shortest is None:
        return
    margins = [i.settings.margin or 0.0 for i in spec.simulation.cloth.values() if name in i.members]
    apart, place = max([physics.thickness, *margins]), f"/entities/{name}/physics/thickness"
    if apart > THIN * shortest:
        text = (
            f"layers of {name!r} touch at {apart:g} m, and its shortest edge is {shortest:.4g} m; neighbours would touch: "
            f"at most {THIN:g} of it, {THIN * shortest:.3g} m. Use a coarser resolution, a thinner sheet or a smaller margin"
        )
        yield Problem(place, text)
    for key, part in entity.parts.items():
        if part.shape.kind == "sheet" and min(part.shape.size) < LEAST_EDGES * part.shape.resolution * (1 - 1e-9):
            most = min(part.shape.size) / LEAST_EDGES
            where = f"/entities/{name}/parts/{key}/shape/resolution"
            text = (
                f"sheet {key!r} of {name!r} has fewer than {LEAST_EDGES} edges across; use a resolution of at most {most:.3g} m"
            )
            yield Problem(where, text, replaced(where, most))


def _joined(name: str, entity: Entity) -> Iterator[Problem]:
    """Problems of parts whose vertices meet as if they were sewn: nothing joins them, and they push each other apart from frame 0 on."""
    from scipy.spatial import cKDTree

    physics = entity.physics
    if physics.category != "cloth":
        return
    for (one, mine), (two, theirs) in combinations(vertices_by_part(entity).items(), 2):
        near = int(np.isfinite(cKDTree(mine).query(theirs, distance_upper_bound=physics.thickness)[0]).sum())
        if near:
            text = (
                f"{near} vertices of part {two!r} of {name!r} lie within its thickness of {physics.thickness:g} m of vertices of part {one!r}: parts of "
                f"a cloth are separate sheets, which nothing joins and which push each other apart. Make one sheet of them (a claim of a hem "
                f"or corner names the whole cloth), or leave more than the thickness between them"
            )
            yield Problem(f"/entities/{name}/parts/{two}", text)


def _tear(name: str, entity: Entity) -> Iterator[Problem]:
    physics = entity.physics
    if physics.category != "cloth" or physics.tear is None:
        return
    softest = min(physics.stretch_stiffness, physics.weft_stiffness or physics.stretch_stiffness)
    stretch = physics.tear.strength / softest
    if stretch > physics.max_stretch:
        text = (
            f"{name!r} tears at {physics.tear.strength:g} N/m, where it is stretched by {stretch:.3g}, and max_stretch is "
            f"{physics.max_stretch:g}: it would fail before it tears; lower strength, or raise stretch_stiffness or max_stretch"
        )
        yield Problem(f"/entities/{name}/physics/tear/strength", text)


def _pins(spec: WorldSpec, name: str, entity: Entity) -> Iterator[Problem]:
    physics = entity.physics
    if physics.category != "cloth":
        return
    vertices = vertices_of(entity)
    taken: dict[str, set[int]] = {}
    for key, pin in physics.pins.items():
        place = f"/entities/{name}/physics/pins/{key}"
        why = cannot_hold(spec.entities[pin.to]) if pin.to is not None and pin.to in spec.entities else None
        if why is not None:
            yield Problem(f"{place}/to", f"pin {key!r} of {name!r} is held by {pin.to!r}, {why}")
        if vertices is None:
            continue
        held = held_by(pin, vertices)
        if len(held) == 0:
            yield Problem(
                place, f"pin {key!r} of {name!r} holds no vertex: none lies within {pin.radius:g} m of it; widen the radius"
            )
        both = [other for other, rows in taken.items() if rows & set(held.tolist())]
        if both and physics.pins[both[0]].to != pin.to:
            yield Problem(place, f"pins {both[0]!r} and {key!r} of {name!r} hold the same vertices for different holders")
        taken[key] = set(held.tolist())
    for key in physics.ignores:
        if key in spec.entities and spec.entities[key].physics.category != "rigid":
            yield Problem(f"/entities/{name}/physics/ignores", f"{key!r} is not rigid; cloth passes through rigid entities only")


def mass_problems(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """Cloth whose weight per area over its thickness is no density of its substance."""
    entity = spec.entities[name]
    physics = entity.physics
    if not isinstance(physics, ClothPhysics) or entity.material not in spec.materials:
        return
    substance = spec.materials[entity.material].substance
    low, high = DENSITY_RANGES[substance]
    density = physics.area_density / physics.thickness
    if not (1.0 - ROUNDING) * low <= density <= (1.0 + ROUNDING) * high:
        best = physics.thickness * min(max(density, low), high)
        place = f"/entities/{name}/physics/area_density"
        yield Problem(
            place,
            f"{name!r} weighs {physics.area_density:g} kg/m^2 at {physics.thickness:g} m, {density:.3g} kg/m^3, which is no {substance}: "
            f"allowed {low * physics.thickness:.3g} to {high * physics.thickness:.3g} kg/m^2",
            replaced(place, float(f"{best:.4g}")),
        )

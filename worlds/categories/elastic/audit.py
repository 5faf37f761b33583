"""Rows of the audit about elastic bodies: what moves them, what holds them, and the steps and skins they need (R62, R64)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...problems import Problem, removed, replaced
from ..holders import cannot_hold
from .models import ElasticPhysics

if TYPE_CHECKING:
    from ...spec import Entity, RigidInstance, WorldSpec

__all__ = ["LONGEST_STEP", "SKIN_SHARE", "elastic_problems"]

LONGEST_STEP = 1e-3
"""[s] Beyond it the engine's solve of stiff bodies ends before it converges (measured: E 5e7 Pa, cells of 0.1 m, at 4 ms)."""
SKIN_SHARE = 0.1
"""Own choice: of a cell's edge; thicker skins hold a body visibly off what it touches and smooth its contacts away."""


def elastic_problems(spec: WorldSpec) -> list[Problem]:
    """Problems of elastic bodies, of their pins and of the instances they are members of."""
    found: list[Problem] = []
    soft = {n for n, e in spec.entities.items() if isinstance(e.physics, ElasticPhysics)}
    for name in spec.entities:
        if name in soft:
            found += _entity(spec, name, spec.entities[name])
    for key, instance in spec.simulation.rigid.items():
        found += _instance(key, instance, [m for m in instance.members if m in soft], spec)
    found += _links(spec, soft)
    return found


def _entity(spec: WorldSpec, name: str, entity: Entity) -> Iterator[Problem]:
    place, physics = f"/entities/{name}", entity.physics
    assert isinstance(physics, ElasticPhysics)
    if entity.motion != "dynamic":
        text = f"the elastic body {name!r} is {entity.motion}; make it dynamic and hold it by physics.pins"
        yield Problem(f"{place}/motion", text, replaced(f"{place}/motion", "dynamic"))
    if entity.generator is not None or len(entity.parts) != 1:
        yield Problem(f"{place}/parts", f"the elastic body {name!r} needs exactly one part, and no generator")
    for part, made in entity.parts.items():
        if not made.collides:
            where = f"{place}/parts/{part}/collides"
            yield Problem(where, f"{name}/{part} is elastic and collides", replaced(where, True))
    for key, pin in physics.pins.items():
        target = spec.entities.get(pin.to) if pin.to is not None else None
        why = cannot_hold(target) if target is not None else None
        if why is not None:
            text = f"pin {key!r} of {name!r} hangs on {pin.to!r}, {why}, or leave out `to` for the world"
            yield Problem(f"{place}/physics/pins/{key}/to", text)
    if physics.resolution is not None and physics.resolution > max(entity.dimensions.size):
        where = f"{place}/physics/resolution"
        yield Problem(
            where,
            f"cells of {physics.resolution:g} m are larger than {name!r} ({max(entity.dimensions.size):g} m); take at most its "
            "smallest extent",
            replaced(where, min(entity.dimensions.size)),
        )


def _instance(key: str, instance: RigidInstance, soft: list[str], spec: WorldSpec) -> Iterator[Problem]:
    if not soft:
        return
    place, settings = f"/simulation/solvers/{key}/settings", instance.settings
    if settings.step > LONGEST_STEP:
        yield Problem(
            f"{place}/step",
            f"step {settings.step:g} s of {key!r} is longer than {LONGEST_STEP:g} s, which its elastic members need",
            replaced(f"{place}/step", LONGEST_STEP),
        )
    for member in instance.members:
        if member in spec.entities and spec.entities[member].breakable is not None:
            text = f"{member!r} breaks and {soft[0]!r} is elastic: the engine's solve of one undoes the other's; take one of them out of {key!r}"
            yield Problem(f"/entities/{member}/breakable", text)
    for name in soft:
        edge = cell_edge(spec.entities[name])
        if settings.skin > SKIN_SHARE * edge:
            yield Problem(
                f"{place}/skin",
                f"skin {settings.skin:g} m of {key!r} exceeds {SKIN_SHARE:.0%} of the cells of {name!r} ({edge:.3g} m)",
                replaced(f"{place}/skin", float(f"{SKIN_SHARE * edge:.3g}")),
            )


def cell_edge(entity: Entity) -> float:
    """Edge of the cells of an elastic body [m], as declared or by the default rule."""
    physics = entity.physics
    assert isinstance(physics, ElasticPhysics)
    least, most = min(entity.dimensions.size), max(entity.dimensions.size)
    return min(least, physics.resolution or (least if most > 4.0 * least else least / 2))


def _links(spec: WorldSpec, soft: set[str]) -> Iterator[Problem]:
    plan = spec.simulation
    for key, joint in plan.joints.items():
        for side in ("parent", "child"):
            if getattr(joint, side) in soft:
                name = getattr(joint, side)
                text = f"joint {key!r} hangs on the elastic body {name!r}; hold that by /entities/{name}/physics/pins"
                yield Problem(f"/simulation/joints/{key}/{side}", text)
    for key, pair in plan.contacts.items():
        if {pair.a, pair.b} & soft:
            text = f"contact {key!r} names an elastic body; its friction and restitution are those of its material"
            yield Problem(f"/simulation/contacts/{key}", text, removed(f"/simulation/contacts/{key}"))
    for key, driver in plan.drivers.items():
        if driver.kind in ("force", "path") and getattr(driver, "entity", None) in soft:
            text = f"{driver.kind} driver {key!r} acts on an elastic body; pin it to a rigid body that the driver moves"
            yield Problem(f"/simulation/drivers/{key}/entity", text)

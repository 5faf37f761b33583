"""Rows of the audit about breakable bodies: who may break, how finely, and whether it stands by itself (R61, R68)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...problems import Problem, removed, replaced
from ..caps import PIECES
from ..rigid.models import ForceDriver, PathDriver, RigidPhysics
from .facts import CRUMBLE, least_piece, piece_count

if TYPE_CHECKING:
    from ...spec import Breakable, Entity, WorldSpec

__all__ = ["crumble_limit", "eased", "fracture_problems", "usual_crumble"]

LEAST_SIZE = 10.0
"""Pieces are at least so many summed skins wide: below, their contacts would be all skin."""
CRUMBLE_SHARE = 0.1
"""Depth of what crumbles, at most, in parts of a piece's least size."""
CUTTABLE = ("box", "wedge", "cylinder", "capsule", "sphere", "extrusion", "revolution", "hull", "mesh")


def fracture_problems(spec: WorldSpec) -> list[Problem]:
    """Problems of breakable entities."""
    found: list[Problem] = []
    for name, entity in spec.entities.items():
        if entity.breakable is not None:
            found += [
                *_contract(spec, name, entity),
                *_partners(spec, name),
                *_soft_company(spec, name),
                *_pieces(spec, name, entity, entity.breakable),
                *_weight(spec, name, entity, entity.breakable),
            ]
    total = sum(piece_count(e) for e in spec.entities.values() if e.breakable is not None)
    if total > PIECES.value:
        found.append(Problem("/entities", f"breakable entities have about {total} pieces, at most {PIECES.value}; {PIECES.knob}"))
    return found


def crumble_limit(entity: Entity) -> float:
    """Most that faces of a breakable entity may crumble [m]: a share of its least piece, as far as the specification tells its size."""
    assert entity.breakable is not None
    return CRUMBLE_SHARE * least_piece(entity, entity.breakable)


def usual_crumble(entity: Entity) -> float:
    """Depth to which faces crumble by default [m], as far as the specification tells the size of pieces."""
    assert entity.breakable is not None
    pattern = entity.breakable.pattern
    return pattern.joint / 2 if pattern.kind == "bricks" else CRUMBLE * least_piece(entity, entity.breakable)


def eased(name: str, old: Entity, new: Entity) -> Iterator[str]:
    """Pieces that an edit lets lie deeper in one another than by default, in words.

    Args:
        name: of the entity.
        old: the entity before the edit.
        new: the entity after it.
    """
    if old.breakable is None or new.breakable is None:
        return
    was, now = old.breakable.bond.crumble, new.breakable.bond.crumble
    if was is None and now is not None and now > usual_crumble(old):
        yield f"/entities/{name}/breakable/bond/crumble the default -> {now:g} m: pieces may lie deeper in one another"


def _contract(spec: WorldSpec, name: str, entity: Entity) -> Iterator[Problem]:
    place = f"/entities/{name}"
    if not isinstance(entity.physics, RigidPhysics):
        category = entity.physics.category
        yield Problem(f"{place}/breakable", f"{name!r} is {category}; only rigid entities break: make it rigid or leave it out")
        return
    if entity.motion != "dynamic":
        text = f"{name!r} is breakable and {entity.motion}; make it dynamic, and give the sides that hold it in breakable/fixed"
        yield Problem(f"{place}/motion", text, replaced(f"{place}/motion", "dynamic"))
    if entity.generator is not None:
        yield Problem(f"{place}/generator", f"{name!r} is breakable and made by a generator; give it parts")
    if entity.physics.linear_damping > 0:
        text = f"{name!r} is breakable, and linear_damping works on single bodies only; use a field driver for drag"
        yield Problem(f"{place}/physics/linear_damping", text, removed(f"{place}/physics/linear_damping"))
    moving = np.any([*entity.physics.linear_velocity, *entity.physics.angular_velocity])
    if moving and entity.breakable is not None and entity.breakable.fixed:
        yield Problem(
            f"{place}/physics/linear_velocity", f"{name!r} is bonded to the world and has a velocity; remove one of them"
        )
    for key, part in entity.parts.items():
        if part.shape.kind not in CUTTABLE or not part.collides:
            text = f"part {key!r} of breakable {name!r} must be a solid that collides: one of {list(CUTTABLE)}"
            yield Problem(f"{place}/parts/{key}", text)


def _soft_company(spec: WorldSpec, name: str) -> Iterator[Problem]:
    for key, instance in spec.simulation.rigid.items():
        soft = [m for m in instance.members if m in spec.entities and spec.entities[m].physics.category == "elastic"]
        if name in instance.members and soft:
            text = f"{soft[0]!r} is elastic and {name!r} is breakable; no instance of this build holds both: make one of them plainly rigid"
            yield Problem(f"/simulation/solvers/{key}/members", text)


def _partners(spec: WorldSpec, name: str) -> Iterator[Problem]:
    plan = spec.simulation
    for key, joint in plan.joints.items():
        if name in (joint.parent, joint.child):
            text = f"joint {key!r} hangs on {name!r}, which is breakable and may fall apart; joints need whole bodies"
            yield Problem(f"/simulation/joints/{key}", text, removed(f"/simulation/joints/{key}"))
    for key, other in spec.entities.items():
        if other.generator is not None and name in (other.generator.attach_start, other.generator.attach_end):
            yield Problem(
                f"/entities/{key}/generator", f"rope {key!r} is attached to breakable {name!r}; attach it to a whole body"
            )
    for key, driver in plan.drivers.items():
        if isinstance(driver, ForceDriver | PathDriver) and driver.entity == name:
            text = f"driver {key!r} moves {name!r}, which is breakable; push it with another body or a field"
            yield Problem(f"/simulation/drivers/{key}", text, removed(f"/simulation/drivers/{key}"))
    for key, pair in plan.contacts.items():
        if pair.a == name and pair.b == name:
            text = f"contact {key!r} pairs {name!r} with itself; its pieces meet with its material's friction"
            yield Problem(f"/simulation/contacts/{key}", text, removed(f"/simulation/contacts/{key}"))


def _pieces(spec: WorldSpec, name: str, entity: Entity, breakable: Breakable) -> Iterator[Problem]:
    place, bond = f"/entities/{name}/breakable", breakable.bond
    least = least_piece(entity, breakable)
    for key, instance in spec.simulation.rigid.items():
        if name not in instance.members:
            continue
        skins = 2 * instance.settings.skin
        if least < LEAST_SIZE * skins:
            yield Problem(
                f"/simulation/solvers/{key}/settings/skin",
                f"pieces of {name!r} are about {least:.3g} m thin, less than {LEAST_SIZE:g} summed skins of {skins:g} m; use larger "
                f"pieces or a skin of at most {least / LEAST_SIZE / 2:.2g} m",
            )
        if instance.settings.step > bond.contact_time:
            text = f"a step of {instance.settings.step:g} s is longer than the contact time {bond.contact_time:g} s of {name!r}; "
            yield Problem(f"/simulation/solvers/{key}/settings/step", text + f"use at most {bond.contact_time:g} s")
    value = crumble_limit(entity)
    if bond.crumble is not None and bond.crumble > value:
        text = f"faces of {name!r} crumble over {bond.crumble:g} m, more than {CRUMBLE_SHARE:g} of a piece; at most "
        patch = replaced(f"{place}/bond/crumble", value)
        yield Problem(f"{place}/bond/crumble", text + f"{value:.3g} m", patch)


def _weight(spec: WorldSpec, name: str, entity: Entity, breakable: Breakable) -> Iterator[Problem]:
    """A body that the world holds at its sides only must carry its own weight: as a cantilever, or a beam of two ends."""
    sides = breakable.fixed
    if not sides or entity.material not in spec.materials or any(s in ("z-", "z+") for s in sides):
        return
    axis = "xyz".index(sides[0][0])
    both = {f"{sides[0][0]}-", f"{sides[0][0]}+"} <= set(sides)
    length, height = entity.dimensions.size[axis], entity.dimensions.size[2]
    gravity = float(np.linalg.norm(spec.simulation.gravity))
    load = 3.0 * spec.materials[entity.material].density * gravity * length**2 / height
    stress = load / (6.0 if both else 1.0)
    if stress > breakable.bond.tension:
        yield Problem(
            f"/entities/{name}/breakable/bond/tension",
            f"{name!r} would break under its own weight: {length:g} m long and {height:g} m high it bends with {stress:.3g} Pa, and "
            f"its bonds bear {breakable.bond.tension:.3g} Pa; raise tension, or fix it from below (z-)",
        )

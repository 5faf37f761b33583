"""Blows that a breakable body cannot break under: those of all declared falls and velocities, against its bonds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...extents import initial_box, initial_volume, least_extent
from ...problems import Problem
from .facts import least_piece

if TYPE_CHECKING:
    from ...spec import Entity, WorldSpec
    from ...vocabulary import SpecModel

__all__ = ["fall_warnings"]

BREAKING = ("broken", "breach", "debris", "cracks", "breaks")
"""Predicates that want bonds to break."""
QUIET = ("release", "detach")
"""Drivers that give no energy of their own."""
REBOUND = 2.0
"""A blow's impulse is at most so many momenta of what falls, where it comes back as fast."""


def fall_warnings(spec: WorldSpec) -> Iterator[Problem]:
    """Breakable bodies that the story wants to break and that no declared fall or velocity can break.

    The bound is generous: the whole impulse of the strongest blow on one face of the least piece, with the lever of the whole body.
    Where anything else brings energy (drivers, springs, other matter), nothing is said.
    """
    wanted = _wanted(spec)
    if not wanted or not _falls_only(spec):
        return
    blows = [(*found, n) for n, entity in spec.entities.items() if (found := _blow(spec, entity)) is not None]
    if len(blows) < sum(e.motion == "dynamic" for e in spec.entities.values()):
        return  # a shape that only its file tells
    momentum, _, name = max(blows, default=(0.0, 0.0, ""))
    most = max((energy for _, energy, _ in blows), default=0.0)
    for target, place in wanted.items():
        breakable = spec.entities[target].breakable
        assert breakable is not None
        thick = [least_extent(p.shape) for p in spec.entities[target].parts.values()]
        known = [t for t in thick if t is not None]
        if not known or len(known) < len(thick):
            continue  # a pot's wall is thinner than its box
        bond, least = breakable.bond, min(*known, least_piece(spec.entities[target], breakable))
        face = least**2
        lever = 1.0 + 6.0 * max(spec.entities[target].dimensions.size) / least
        stress = REBOUND * momentum / bond.contact_time / face * lever
        weakest = min(bond.tension, bond.shear)
        told = f"the strongest declared blow is that of {name!r}" if name else "nothing falls or has a velocity"
        if stress < weakest:
            yield Problem(
                f"/entities/{target}/breakable/bond",
                f"{told} ({momentum:.3g} N s): over {bond.contact_time:g} s it loads a face of {target!r} with at most {stress:.3g} Pa, and its bonds bear "
                f"{weakest:.3g} Pa, so that {place} cannot come: at most {stress:.3g} Pa of tension or shear, a higher fall, a greater "
                "mass or velocity",
            )
        elif (least_energy := bond.toughness * face) > most:
            yield Problem(
                f"/entities/{target}/breakable/bond/toughness",
                f"{told}, and no blow has more than {most:.3g} J: a face of {target!r} takes {least_energy:.3g} J to break, so that {place} "
                f"cannot come: at most {most / face:.3g} J/m^2, a higher fall, a greater mass or velocity",
            )


def _wanted(spec: WorldSpec) -> dict[str, str]:
    """Breakable entities of which a mandatory beat or requirement says that they break, and its pointer."""
    found: dict[str, str] = {}
    said = [(f"/story/beats/{n}", b.predicate) for n, b in spec.story.beats.items() if b.mandatory]
    said += [(f"/story/requirements/{n}", r.asked) for n, r in spec.story.requirements.items() if r.mandatory]
    for place, predicate in said:
        for atom in _positive(predicate):
            kind, entity = getattr(atom, "kind", ""), getattr(atom, "entity", "")
            if kind not in BREAKING or entity not in spec.entities or spec.entities[entity].breakable is None:
                continue
            if kind in ("broken", "debris") and not (getattr(atom, "min", None) or 0.0) > 0.0:
                continue
            if getattr(atom, "when", "") != "always":
                found.setdefault(entity, place)
    return found


def _positive(predicate: SpecModel) -> Iterator[SpecModel]:
    """The predicates that it is made of, without those that must not hold and those of which any one would do."""
    if getattr(predicate, "kind", "") in ("not", "never", "or"):
        return
    inner = [*getattr(predicate, "of", ()), *(getattr(predicate, f, None) for f in ("predicate", "goal"))]
    held = [p for p in inner if p is not None]
    for one in held:
        yield from _positive(one)
    if not held:
        yield predicate


def _falls_only(spec: WorldSpec) -> bool:
    """True where gravity and velocities at frame 0 are all that moves bodies."""
    plan = spec.simulation
    return (
        all(d.kind in QUIET for d in plan.drivers.values())
        and not any(j.kind == "spring" for j in plan.joints.values())
        and not plan.couplings
        and all(e.physics.category == "rigid" and e.generator is None for e in spec.entities.values())
    )


def _blow(spec: WorldSpec, entity: Entity) -> tuple[float, float] | None:
    """Largest momentum [N s] and energy [J] that a dynamic entity comes to; None of others, and where a shape does not tell."""
    if entity.motion != "dynamic" or entity.material not in spec.materials:
        return None
    box = initial_box(entity)
    floors = [initial_box(e) for e in spec.entities.values() if e.motion == "static"]
    if box is None or not floors or any(f is None for f in floors):
        return None
    gravity = np.array(spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    down = gravity / strength if strength > 0 else np.zeros(3)
    # To the upper side of the lowest floor, from the middle: what topples falls by half its height.
    lowest = max(min(float(c @ down) for c in f) for f in floors if f is not None)
    drop = max(0.0, lowest - float(0.5 * (box[0] + box[1]) @ down))
    physics = entity.physics
    mass = getattr(physics, "mass", None) or initial_volume(entity) * max(
        spec.materials[m].density
        for m in {entity.material, *(p.material or entity.material for p in entity.parts.values())} & set(spec.materials)
    )
    speed = math.sqrt(math.hypot(*getattr(physics, "linear_velocity", (0.0,))) ** 2 + 2.0 * strength * drop)
    spin = math.hypot(*getattr(physics, "angular_velocity", (0.0,))) * 0.5 * math.hypot(*entity.dimensions.size)
    return mass * (speed + spin), 0.5 * mass * (speed + spin) ** 2

"""Lines of the approximation register about rigid instances: skins, the law of their contacts, how hard their constraints are (R61, R68).

The verifiers import no engine, so the engine's numbers stand here a second time; `tests/verifiers/register/test_register.py` compares the two.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING

from ....worlds.spec import DetachDriver, WeldJoint
from .lifted import lift_lines

if TYPE_CHECKING:
    from ....worlds.spec import Material, RigidInstance, WorldSpec

__all__ = ["rigid_lines"]

SLOWEST_BOUNCE = 0.01
"""[m/s] Contacts that close slower do not bounce (`simulation/rigid/contact_law.py`, and so the four numbers below)."""
GRAVITY_STEPS = 4.0
"""Nor do those that close slower than gravity makes them in so many steps."""
SLIPS = 2e-3
"""[m/s] Speed of slip from which on a contact has the friction of motion (`simulation/rigid/stiction.py`)."""
PASSED = 0.03 / 0.97
"""Push that constraints let pass, over the push that they stop."""
SOFTEST = 200.0
"""A contact is as soft as that of a body so many times lighter than the heaviest one, at most."""
JERK_STEPS = 0.8
"""[steps] A constraint that is pulled apart at a speed opens by that speed times so many steps at most: critically damped over four
steps it halves the speed in the first one."""


def rigid_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines about every rigid instance, by its settings."""
    return [
        line
        for name, instance in spec.simulation.rigid.items()
        for line in (*_instance(spec, name, instance), *lift_lines(spec, name))
    ]


def _instance(spec: WorldSpec, name: str, instance: RigidInstance) -> list[dict[str, str]]:
    settings, pull = instance.settings, math.hypot(*spec.simulation.gravity)
    found = [
        {
            "what": f"collision skin of {settings.skin:g} m on every part of {name!r}",
            "effect": f"resting bodies hover up to {2 * settings.skin:g} m",
        }
    ]
    slowest = max(SLOWEST_BOUNCE, GRAVITY_STEPS * pull * settings.step)
    used = _materials(spec, instance)
    if _bounces(spec, instance):
        hop = f", hops of up to {slowest**2 / (2 * pull):.2g} m" if pull > 0 else ""
        found.append(
            {
                "what": f"contacts of {name!r} that close slower than {slowest:.3g} m/s do not bounce",
                "effect": f"the last rebounds before rest are left out{hop}",
            }
        )
        found.append(_impacts(spec, name, instance))
    found += _mixed(spec, name, instance, used)
    found += _at_rest(spec, name, instance, used)
    sunk = PASSED * pull * (settings.contact_steps * settings.step) ** 2
    if sunk > 0:
        found.append(
            {
                "what": f"contacts of {name!r} push back softly, over {settings.contact_steps:g} steps of {settings.step:g} s",
                "effect": f"what rests sinks {sunk:.2g} m into the skins, and under a heavier body as many times as much, "
                f"{SOFTEST * sunk:.2g} m at most",
            }
        )
    held = _constraints(spec, instance)
    if held:
        found.append(
            {
                "what": f"constraints of {name!r} that are no exact joints: {', '.join(held)}",
                "effect": f"a jerk of 1 m/s opens them by up to {JERK_STEPS * settings.step:.2g} m for some steps of {settings.step:g} s",
            }
        )
    return found


def _impacts(spec: WorldSpec, name: str, instance: RigidInstance) -> dict[str, str]:
    """Line about impacts that pass through several bodies."""
    members = [spec.entities[m] for m in instance.members]
    if any(e.breakable is not None for e in members):
        return {
            "what": f"impacts of {name!r}, which holds debris, are solved at once",
            "effect": "a row that touches hands a blow on to more of its bodies, and an oblique bounce keeps up to three quarters of the slide "
            "that friction takes",
        }
    return {
        "what": f"impacts of {name!r} follow one another within a step of {instance.settings.step:g} s, as if each took no time",
        "effect": "where many bodies touch, a real blow spreads over all of them at once: how they share it is one of the ways that energy "
        "and momentum allow",
    }


def _touching(spec: WorldSpec, member: str) -> set[str]:
    """Materials of a member's parts that collide; a rope has its entity's."""
    entity = spec.entities[member]
    parts = {p.material or entity.material for p in entity.parts.values() if p.collides}
    return parts | ({entity.material} if entity.generator is not None else set())


def _materials(spec: WorldSpec, instance: RigidInstance) -> dict[str, Material]:
    """Materials of the parts that collide, by name."""
    names = {n for m in instance.members for n in _touching(spec, m)}
    return {n: spec.materials[n] for n in sorted(names) if n in spec.materials}


def _bounces(spec: WorldSpec, instance: RigidInstance) -> bool:
    """True if any two members bounce off each other: with the smaller restitution, or with one of their own."""
    lively = 0
    for member in instance.members:
        lively += any(n in spec.materials and spec.materials[n].restitution > 0 for n in _touching(spec, member))
    given = [c for c in spec.simulation.contacts.values() if {c.a, c.b} <= set(instance.members)]
    return lively > 1 or any((c.restitution or 0) > 0 for c in given)


def _meeting(spec: WorldSpec, instance: RigidInstance, used: dict[str, Material]) -> list[tuple[str, str]]:
    """Pairs of materials of which two members touch by the graph of the scene; of any two that can, where it says of none."""
    made = {m: _touching(spec, m) & set(used) for m in instance.members}
    said = [(r.a, r.b) for r in spec.graph.relations.values() if r.kind in ("supports", "interacts", "contains")]
    able = [(a, b) for a, b in combinations(instance.members, 2) if not _still(spec, a, b)]
    for members in ([p for p in said if p[0] in made and p[1] in made], able):
        pairs = {(min(m, n), max(m, n)) for a, b in members for m in made[a] for n in made[b] if m != n}
        if pairs:
            return sorted(pairs)
    return []


def _still(spec: WorldSpec, a: str, b: str) -> bool:
    return spec.entities[a].motion == spec.entities[b].motion == "static"


def _mixed(spec: WorldSpec, name: str, instance: RigidInstance, used: dict[str, Material]) -> list[dict[str, str]]:
    """Line about the way contacts of different materials are combined, with the pair of materials that it changes most."""
    pairs = _meeting(spec, instance, used)
    if not pairs:
        return []
    rough = max(pairs, key=lambda p: abs(used[p[0]].friction - used[p[1]].friction))
    lively = max(pairs, key=lambda p: abs(used[p[0]].restitution - used[p[1]].restitution))
    told = []
    for pair, value, word in ((rough, "friction", max), (lively, "restitution", min)):
        one, two = (float(getattr(used[n], value)) for n in pair)
        if one != two:
            told.append(f"{pair[0]!r} ({one:g}) meets {pair[1]!r} ({two:g}) with a {value} of {word(one, two):g}")
    if not told:
        return []
    own = sum({c.a, c.b} <= set(instance.members) for c in spec.simulation.contacts.values())
    return [
        {
            "what": f"contacts of {name!r} take the larger friction and the smaller restitution of two materials"
            + (f", but for the {own} of `simulation.contacts`" if own else ""),
            "effect": f"what a pair of materials would measure together is not known: {' and '.join(told)}",
        }
    ]


def _at_rest(spec: WorldSpec, name: str, instance: RigidInstance, used: dict[str, Material]) -> list[dict[str, str]]:
    """Line about static friction, where materials or pairs have one."""
    told = [f"{n!r} {m.static_friction:g} (sliding {m.friction:g})" for n, m in used.items() if m.static_friction is not None]
    pairs = [c for c in spec.simulation.contacts.values() if {c.a, c.b} <= set(instance.members)]
    told += [f"{c.a!r} on {c.b!r} {c.static_friction:g} (sliding {c.friction:g})" for c in pairs if c.static_friction is not None]
    if not told:
        return []
    return [
        {
            "what": f"static friction of {name!r}: {', '.join(told)}",
            "effect": f"contacts hold with it until they slip faster than {SLIPS:g} m/s, whatever the time they were at rest",
        }
    ]


def _constraints(spec: WorldSpec, instance: RigidInstance) -> list[str]:
    """Names of joints and ropes that a constraint of the solver holds: welds that open, ends of ropes, joints at the ends of their range."""
    plan, members = spec.simulation, set(instance.members)
    opened = {d.joint for d in plan.drivers.values() if isinstance(d, DetachDriver)}
    found = []
    for name, joint in plan.joints.items():
        if joint.child not in members:
            continue
        if isinstance(joint, WeldJoint) and name in opened:
            found.append(f"weld {name!r}")
        elif getattr(joint, "range", None) is not None:
            found.append(f"range of {name!r}")
    for member in instance.members:
        rope = spec.entities[member].generator
        if rope is not None and rope.attach_end is not None:
            found.append(f"far end of the rope {member!r}")
    return found

"""Lines of the approximation register about particles (R68)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.instances import coupled_groups, soft_met
from ...support.moved import moves_of

if TYPE_CHECKING:
    from ....worlds.categories.particles.models import ParticlePhysics
    from ....worlds.spec import WorldSpec

__all__ = ["particle_lines"]

HARD = 1e9
"""[Pa] Own choice: moduli below it are told, since they make contacts of grains last longer than real ones."""


def particle_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of every instance of grains or flying particles."""
    found = []
    for name, instance in spec.simulation.particles.items():
        found.append((f"particles of {name!r} that leave its domain are gone", "they are counted as outflow and never come back"))
        for member in instance.members:
            physics = spec.entities[member].physics
            if physics.category != "particles":
                continue
            if instance.engine == "ballistic":
                effect = "they do not meet each other, and neither bodies nor the air feel them"
                found.append((f"particles of {member!r} fly alone", effect))
                found += _in_the_air(spec, member, physics)
            else:
                found += _grains(member, physics)
        if instance.engine == "dem":
            found += _partners(spec, name)
    return [{"what": what, "effect": effect} for what, effect in found]


def _in_the_air(spec: WorldSpec, member: str, physics: ParticlePhysics) -> list[tuple[str, str]]:
    """The line about flying particles that are there at frame 0 and of which no beat tells; what fills a volume hangs in it at first."""
    there = physics.count > 0 and any(spec.simulation.gravity)
    if not there or member in moves_of(spec).direct:
        return []
    return [(f"particles of {member!r} begin in the air, where nothing holds them", "they fall at once, and no beat tells of it")]


def _grains(member: str, physics: ParticlePhysics) -> list[tuple[str, str]]:
    """Simplification and effect of each line about the grains of an entity."""
    found = [
        (
            f"grains of {physics.radius:g} m stand for {member!r}",
            "single smaller grains, dust and the air between grains are not simulated",
        ),
        (
            f"grains of {member!r} are spheres with a rolling resistance of {physics.rolling:g} in place of their shapes",
            "slopes and flow are those of rounded grains; nothing breaks or wears",
        ),
    ]
    if physics.young_modulus < HARD:
        what = f"grains of {member!r} have a modulus of {physics.young_modulus:.3g} Pa, and walls they touch the same"
        effect = "contacts last longer than between hard grains; overlaps stay below the bound of the row overlap"
        found.append((what, effect))
    if physics.cohesion > 0:
        what = f"cohesion of {member!r} is a constant pull while grains touch (Derjaguin, Muller, Toporov)"
        found.append((what, "no neck is drawn out and no water moves between grains"))
    return found


def _partners(spec: WorldSpec, name: str) -> list[tuple[str, str]]:
    """Simplification and effect of each line about bodies that the grains of an instance meet."""
    found, groups = [], coupled_groups(spec)
    if soft_met(spec, name):
        what = f"surfaces that deform take no couples from grains of {name!r}"
        found.append((what, "nothing resists the rolling of grains on elastic bodies and cloth"))
    for rigid, other in spec.simulation.rigid.items():
        moving = any(spec.entities[m].motion == "dynamic" for m in other.members if m in spec.entities)
        if moving and not any({name, rigid} <= g for g in groups):
            what = f"grains of {name!r} are pushed by bodies of {rigid!r} and do not push them"
            found.append((what, "omitted reaction: those bodies move as if there were no grains"))
    return found

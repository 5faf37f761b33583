"""Lines of the approximation register about particles (R68)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.instances import coupled_groups, soft_met

if TYPE_CHECKING:
    from ....worlds.spec import WorldSpec

__all__ = ["particle_lines"]


def particle_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """What grains and flying particles simplify."""
    plan = spec.simulation
    found = []
    for name, instance in plan.particles.items():
        found.append(
            {
                "what": f"particles of {name!r} that leave its domain are gone",
                "effect": "they are counted as outflow and never come back",
            }
        )
        for member in instance.members:
            physics = spec.entities[member].physics
            if physics.category != "particles":
                continue
            if instance.engine == "ballistic":
                found.append(
                    {
                        "what": f"particles of {member!r} fly alone",
                        "effect": "they do not meet each other, and neither bodies nor the air feel them",
                    }
                )
                continue
            found.append(
                {
                    "what": f"grains of {physics.radius:g} m stand for {member!r}",
                    "effect": "single smaller grains, dust and the air between grains are not simulated",
                }
            )
            found.append(
                {
                    "what": f"grains of {member!r} are spheres with a rolling resistance of {physics.rolling:g} in place of their shapes",
                    "effect": "slopes and flow are those of rounded grains; nothing breaks or wears",
                }
            )
            if physics.young_modulus < 1e9:
                found.append(
                    {
                        "what": f"grains of {member!r} have a modulus of {physics.young_modulus:.3g} Pa, and walls they touch the same",
                        "effect": "contacts last longer than between hard grains; overlaps stay below the bound of the row overlap",
                    }
                )
            if physics.cohesion > 0:
                found.append(
                    {
                        "what": f"cohesion of {member!r} is a constant pull while grains touch (Derjaguin, Muller, Toporov)",
                        "effect": "no neck is drawn out and no water moves between grains",
                    }
                )
        if instance.engine == "dem":
            groups = coupled_groups(spec)
            if soft_met(spec, name):
                found.append(
                    {
                        "what": f"surfaces that deform take no couples from grains of {name!r}",
                        "effect": "nothing resists the rolling of grains on elastic bodies and cloth",
                    }
                )
            for rigid, other in plan.rigid.items():
                moving = any(spec.entities[m].motion == "dynamic" for m in other.members if m in spec.entities)
                if moving and not any({name, rigid} <= g for g in groups):
                    found.append(
                        {
                            "what": f"grains of {name!r} are pushed by bodies of {rigid!r} and do not push them",
                            "effect": "omitted reaction: those bodies move as if there were no grains",
                        }
                    )
    return found

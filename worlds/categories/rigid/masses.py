"""Declared masses of rigid bodies: they lie within what the substances allow the bodies' volumes to weigh (R154)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...extents import shape_volume
from ...materials import DENSITY_RANGES
from ...problems import Problem, removed
from ...weights import LEAST_WALL, ROUNDING, Weights, allowed
from .models import RigidPhysics

if TYPE_CHECKING:
    from ...spec import Entity, WorldSpec

__all__ = ["mass_problems"]


def mass_problems(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """A declared mass of a rigid body outside of what its substances allow."""
    entity = spec.entities[name]
    physics = entity.physics
    if not isinstance(physics, RigidPhysics) or physics.mass is None:
        return
    weights = _declared(spec, entity)
    if weights is None:
        return
    place, substances = f"/entities/{name}/physics/mass", _substances(spec, entity)
    if physics.mass > (1.0 + ROUNDING) * weights.most:
        yield Problem(
            place,
            f"{name!r} weighs {physics.mass:g} kg, its volume of {substances} at most {weights.most:.4g} kg; give at most that, or leave it out",
            removed(place),
        )
    least = weights.hollow if physics.hollow else weights.least
    if physics.mass < (1.0 - ROUNDING) * least:
        rest = f"a wall of {LEAST_WALL:g} m" if physics.hollow else "its volume"
        ways = "" if physics.hollow else "; build thinner parts, or say physics.hollow true where it is a closed shell"
        yield Problem(
            place,
            f"{name!r} weighs {physics.mass:g} kg, {rest} of {substances} at least {least:.4g} kg; give at least that, or leave it out{ways}",
            removed(place),
        )


def _declared(spec: WorldSpec, entity: Entity) -> Weights | None:
    """Least and largest mass of an entity as far as the specification tells its volume; None where a material is unknown."""
    used = [p.material or entity.material for p in entity.parts.values()] or [entity.material]
    if not set(used) <= set(spec.materials):
        return None
    kinds = [spec.materials[m].substance for m in used]
    if entity.generator is not None:
        rope = entity.generator
        ways = np.linalg.norm(np.diff(np.array(rope.points), axis=0), axis=1)
        core = math.pi * rope.radius**2 * float(ways.sum())
        low, high = allowed([(core, kinds[0])]), allowed([(core + rope.segments * 4 / 3 * math.pi * rope.radius**3, kinds[0])])
        return low._replace(most=high.most)
    volumes = [shape_volume(p.shape) for p in entity.parts.values()]
    known = [(v, k) for v, k in zip(volumes, kinds, strict=True) if v is not None]
    if len(known) == len(volumes):
        return allowed(known)
    # What files hold is known once they are built: `verifiers/scene/scale.py` asks then.
    box = math.prod(entity.dimensions.size) * max(DENSITY_RANGES[k][1] for k in kinds)
    return allowed(known)._replace(most=box)


def _substances(spec: WorldSpec, entity: Entity) -> str:
    used = dict.fromkeys(p.material or entity.material for p in entity.parts.values()) or {entity.material: None}
    return " and ".join(dict.fromkeys(spec.materials[m].substance for m in used))

"""Row of the audit about declared masses: they lie within what the substances of a body allow its volume to weigh (R154)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...physics.substances import DENSITY_RANGES
from ..categories.liquid.facts import shape_volume
from ..problems import Problem, removed, replaced
from ..spec import ClothPhysics, RigidPhysics

if TYPE_CHECKING:
    from ..spec import Entity, WorldSpec

__all__ = ["LEAST_WALL", "Weights", "allowed", "mass_problems"]

LEAST_WALL = 1e-4
"""[m] Thinnest wall of a hollow body: that of a drinks can."""
SPHERE = (36.0 * math.pi) ** (1.0 / 3.0)
"""No body of volume V has less surface than a ball: (36 pi)^(1/3) V^(2/3)."""
ROUNDING = 0.01
"""Share by which a mass may be off: facets of round parts, and digits of messages."""


class Weights(NamedTuple):
    """Least and largest mass of a body [kg]."""

    least: float
    hollow: float
    """Least as a shell of the thinnest wall."""
    most: float


def allowed(pieces: Sequence[tuple[float, str]]) -> Weights:
    """Least and largest mass [kg] of a body of these volumes [m^3] and substances.

    Parts may lie in one another: the least is that of the heaviest part alone, the most that of all of them.
    """
    found = [(v, *DENSITY_RANGES[s]) for v, s in pieces]
    return Weights(
        max((v * low for v, low, _ in found), default=0.0),
        max((min(v, SPHERE * v ** (2.0 / 3.0) * LEAST_WALL) * low for v, low, _ in found), default=0.0),
        sum(v * high for v, _, high in found),
    )


def _declared(spec: WorldSpec, entity: Entity) -> Weights | None:
    """What an entity may weigh as far as the specification tells its volume; None where a material is unknown."""
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


def mass_problems(spec: WorldSpec) -> Iterator[Problem]:
    """Declared masses outside of what substances allow, of bodies and of sheets; materials that are called like a substance and weigh otherwise."""
    yield from _called_otherwise(spec)
    for name, entity in spec.entities.items():
        physics = entity.physics
        if isinstance(physics, ClothPhysics):
            yield from _sheet(spec, name, entity, physics)
        if not isinstance(physics, RigidPhysics) or physics.mass is None:
            continue
        weights = _declared(spec, entity)
        if weights is None:
            continue
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


def _called_otherwise(spec: WorldSpec) -> Iterator[Problem]:
    """`steel` and `polished_steel` weigh what steel does: with the substance `other` they could weigh what they liked."""
    for name, material in spec.materials.items():
        word = name.replace("-", "_").rstrip("0123456789_").rsplit("_", 1)[-1]
        low, high = DENSITY_RANGES.get(word, (0.0, math.inf))
        if word != "other" and not low <= material.density <= high:
            yield Problem(
                f"/materials/{name}/density",
                f"material {name!r} is called {word} and weighs {material.density:g} kg/m^3, {word} {low:g} to {high:g}; give it a density of "
                f"{word}, or call the material what it is",
            )


def _substances(spec: WorldSpec, entity: Entity) -> str:
    used = dict.fromkeys(p.material or entity.material for p in entity.parts.values()) or {entity.material: None}
    return " and ".join(dict.fromkeys(spec.materials[m].substance for m in used))


def _sheet(spec: WorldSpec, name: str, entity: Entity, physics: ClothPhysics) -> Iterator[Problem]:
    """Cloth whose weight per area over its thickness is no density of its substance."""
    if entity.material not in spec.materials:
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

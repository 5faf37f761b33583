"""Unusual surfaces: materials that rub or bounce as nothing of their substance does, and bodies that rolling does not carry on (R154, R160)."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING

from ...worlds.materials import material_table
from ...worlds.row_words import FRICTION_FACTOR, RESTITUTION_ROOM

if TYPE_CHECKING:
    from ...worlds.spec import Entity, WorldSpec

__all__ = ["friction_lines"]

STEEP = 0.2
"""[1] Own choice: rolling resistance over radius, the tangent of the slope on which a ball stays; a tyre in loose sand has so much."""
USUAL_BOUNCE: Mapping[str, tuple[float, float]] = {
    "wood": (0.3, 0.5), "steel": (0.5, 0.8), "iron": (0.5, 0.8), "rubber": (0.5, 0.8), "ice": (0.1, 0.3), "paper": (0.0, 0.1), "foam": (0.0, 0.5),
}  # fmt: skip
"""Restitutions of substances for which the table of materials has none; as the skill of rigid bodies gives them."""


@cache
def _range_of(substance: str, field: str) -> tuple[float, float] | None:
    """Least and largest figure of the rows of a substance; None where none has one."""
    figures = [
        r.figures[field].range for r in material_table().materials.values() if r.substance == substance and field in r.figures
    ]
    if not figures:
        return USUAL_BOUNCE.get(substance) if field == "restitution" else None
    return min(f[0] for f in figures), max(f[2] for f in figures)


def friction_lines(spec: WorldSpec, bouncing: Collection[str] = ()) -> Iterator[str]:
    """Sentences about materials far from their substance, and about what stays on a slope on which it should roll.

    Args:
        spec: of the world.
        bouncing: materials of whose restitution another sentence tells.
    """
    used = {n for e in spec.entities.values() for n in _materials(e)}
    for name, material in spec.materials.items():
        if name not in used or material.of is not None or material.substance == "other":
            continue
        why = "" if material.departs is None else f": {material.departs}"
        friction, bounce = _range_of(material.substance, "friction"), _range_of(material.substance, "restitution")
        if friction is not None and not friction[0] / FRICTION_FACTOR <= material.friction <= friction[1] * FRICTION_FACTOR:
            yield (
                f"material {name!r} of {material.substance} has a friction of {material.friction:g}, and {material.substance} in the table of materials "
                f"{friction[0]:g} to {friction[1]:g}{why}"
            )
        if name not in bouncing and bounce is not None and material.restitution > bounce[1] + RESTITUTION_ROOM:
            yield f"material {name!r} of {material.substance} has a restitution of {material.restitution:g}, where {bounce[1]:g} is much for {material.substance}{why}"
    yield from _stuck(spec)


def _stuck(spec: WorldSpec) -> Iterator[str]:
    """Round bodies whose rolling resistance holds them on steep slopes."""
    for name, entity in spec.entities.items():
        radii = [p.shape.radius for p in entity.parts.values() if p.shape.kind in ("sphere", "cylinder", "capsule")]
        if entity.motion != "dynamic" or len(radii) != len(entity.parts) or not radii:
            continue
        length = max((spec.materials[m].rolling_friction for m in _materials(entity) if m in spec.materials), default=0.0)
        ratio = length / max(radii)
        if ratio > STEEP:
            yield (
                f"{name!r} has a rolling resistance of {length:g} m, {ratio:.2g} of its radius: it stays on slopes of up to {math.degrees(math.atan(ratio)):.2g} degrees, "
                f"where it would roll off those of {math.degrees(math.atan(STEEP)):.2g}"
            )


def _materials(entity: Entity) -> set[str]:
    return {p.material or entity.material for p in entity.parts.values() if p.collides} | {entity.material}

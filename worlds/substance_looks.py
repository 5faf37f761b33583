"""Looks that contradict the substance that a claim says: wood that shines as metal, steel with the grain of wood, the two exchanged (R2, R131).

The audit holds the words of a material against substance and density; who sees the film knows neither. There is no table of how substances
look; held are only marks that one substance has and another has not, and the verdict warns.
"""

from __future__ import annotations

import colorsys
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from .claim_targets import named_in
from .described import coloured_bodies
from .prompts.descriptions import meanings
from .prompts.languages import language_of

if TYPE_CHECKING:
    from .spec import Material, WorldSpec

__all__ = ["look_warnings"]

METALS = frozenset(("steel", "iron", "aluminium"))
CLEAR = frozenset(("glass", "ice", "plastic", "gel", "water", "oil"))
"""Substances that light may go through."""
HALF = 0.5
"""Own choice: share of `metallic` or `transmission` from which on a surface looks like metal, or like glass."""
GREY, BROWN = 0.15, 0.3
"""Own choice: most saturation of what looks grey, and least of what looks brown."""
BROWN_HUES = (10.0 / 360.0, 50.0 / 360.0)
"""[turns] Own choice: hues of orange, of which brown is the dark part."""
PATTERNS: Mapping[str, frozenset[str]] = {
    "wood": frozenset(("wood",)),
    "concrete": frozenset(("concrete", "stone", "brick", "ceramic")),
    "bricks": frozenset(("brick", "stone", "concrete")),
    "tiles": frozenset(("ceramic", "stone", "concrete", "brick", "glass")),
}
"""Substances whose pattern a surface shows."""


def look_warnings(spec: WorldSpec) -> Iterator[str]:
    """A line for each claim of a material whose body looks as if it were of another."""
    said = {n: found for n in spec.claims if (found := _made_of(spec, n))}
    coloured = {n for bodies in coloured_bodies(spec).values() for n in bodies}
    for name, materials in said.items():
        for key, bodies in materials.items():
            material = spec.materials[key]
            seen = _seems(material)
            if (
                seen is None
                and not bodies & coloured
                and _is_brown_metal(material)
                and any(map(_is_grey_wood, _materials(spec, said)))
            ):
                seen = "like wood, and what is claimed as wood looks like metal"
            if seen is not None:
                yield f"{spec.claims[name].quote!r} is {key!r} of {material.substance}, which looks {seen}: give it the look of {material.substance}"


def _made_of(spec: WorldSpec, name: str) -> dict[str, set[str]]:
    """Materials of the bodies of a claim that says a material, each with its bodies."""
    claim = spec.claims[name]
    if claim.type != "property" or claim.waived is not None or not meanings(claim.quote, language_of(spec.prompt), "material"):
        return {}
    found: dict[str, set[str]] = {n: set() for n in named_in(spec, name, "materials") if n in spec.materials}
    for body in named_in(spec, name, "entities"):
        if body in spec.entities and spec.entities[body].material in spec.materials:
            found.setdefault(spec.entities[body].material, set()).add(body)
    return found


def _materials(spec: WorldSpec, said: Mapping[str, Mapping[str, set[str]]]) -> list[Material]:
    return [spec.materials[key] for materials in said.values() for key in materials]


def _seems(material: Material) -> str | None:
    """Words on what a material looks like where that is no look of its substance; None where nothing tells."""
    look, substance = material.appearance, material.substance
    if substance == "other":
        return None
    if substance not in METALS and look.metallic >= HALF:
        return "like metal"
    if substance not in CLEAR and look.transmission >= HALF:
        return "like glass"
    if look.pattern in PATTERNS and substance not in PATTERNS[look.pattern]:
        return f"like {look.pattern}"
    return None


def _hue(material: Material) -> tuple[float, float]:
    """Hue [turns] and saturation of a colour."""
    hue, saturation, _ = colorsys.rgb_to_hsv(*material.appearance.color)
    return hue, saturation


def _is_brown_metal(material: Material) -> bool:
    hue, saturation = _hue(material)
    brown = saturation >= BROWN and BROWN_HUES[0] <= hue <= BROWN_HUES[1]
    return material.substance in METALS and material.appearance.metallic < HALF and brown


def _is_grey_wood(material: Material) -> bool:
    plain = material.appearance.pattern != "wood" and material.appearance.metallic < HALF
    return material.substance == "wood" and plain and _hue(material)[1] <= GREY

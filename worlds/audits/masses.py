"""Row of the audit about masses: declared ones fit the substances, and materials weigh what they are called (R154)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..categories.category import declares
from ..categories.registry import CATEGORIES
from ..materials import DENSITY_RANGES, ROUNDING, MaterialRow, material_table
from ..problems import Problem
from ..row_words import beyond_row

if TYPE_CHECKING:
    from ..spec import WorldSpec

__all__ = ["mass_problems"]


def mass_problems(spec: WorldSpec) -> Iterator[Problem]:
    """Declared masses outside of what substances allow; materials that are called like a substance and weigh otherwise."""
    yield from _called_otherwise(spec)
    for name, entity in spec.entities.items():
        for category in CATEGORIES.values():
            if declares(category, entity):
                yield from category.masses(spec, name)


def _of_grains(spec: WorldSpec, material: str, row: MaterialRow) -> bool:
    """True where only grains are of a material, whose row tells what a single one weighs."""
    users = [e for e in spec.entities.values() if material in {e.material, *(p.material for p in e.parts.values())}]
    return "grain_density" in row.figures and bool(users) and all(e.physics.shape == "loose" for e in users)


def _called_otherwise(spec: WorldSpec) -> Iterator[Problem]:
    """`steel` and `polished_steel` weigh what steel does: with the substance `other` they could weigh what they liked."""
    rows = material_table().materials
    for name, material in spec.materials.items():
        called = name.replace("-", "_").rstrip("0123456789_")
        word = called.rsplit("_", 1)[-1]
        low, high = DENSITY_RANGES.get(word, (0.0, math.inf))
        row = next((rows[n] for n in (called, word) if n in rows and n not in DENSITY_RANGES), None)
        ways = "or call the material what it is"
        # Of another substance a name is a colour: wood that is called gold.
        if row is not None and row.substance == material.substance and material.of is None and material.departs is None:
            low, _, high = row.figures["density"].range
            low, high = (1.0 - ROUNDING) * low, (1.0 + ROUNDING) * high
            ways = f"say in `departs` what makes it another (it is printed), {ways}"
            for field, value, least, most in beyond_row(material, row, math.inf):
                text = f"material {name!r} is called {word} and has a {field} of {value:g}, {word} {least:g} to {most:g}: use a value near that, or {ways}"
                yield Problem(f"/materials/{name}/{field}", text)
        if row is not None and _of_grains(spec, name, row) and row.figures["grain_density"].holds(material.density):
            continue
        if word != "other" and not low <= material.density <= high:
            yield Problem(
                f"/materials/{name}/density",
                f"material {name!r} is called {word} and weighs {material.density:g} kg/m^3, {word} {low:g} to {high:g}; give it a density of "
                f"{word}, {ways}",
            )

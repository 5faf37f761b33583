"""Materials that name a row of the table and are not what it says (R154)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..materials import material_table
from ..named_materials import departures
from ..problems import Problem, replaced

if TYPE_CHECKING:
    from ..spec import WorldSpec

__all__ = ["row_problems"]


def row_problems(spec: WorldSpec) -> Iterator[Problem]:
    """Materials of another substance than their row, or of values outside of its ranges that say no reason."""
    rows = material_table().materials
    for name, material in spec.materials.items():
        place = f"/materials/{name}"
        if material.of is None:
            continue
        row = rows.get(material.of)
        if row is None:
            yield Problem(
                f"{place}/of",
                f"the table of materials has no {material.of!r}: inspect_world(part='materials', query=...) finds rows",
            )
            continue
        if material.substance != row.substance:
            text = f"material {name!r} is {material.of}, of substance {row.substance}, not {material.substance}: name another row, or leave `of` out"
            yield Problem(f"{place}/substance", text, replaced(f"{place}/substance", row.substance))
        for field, value, figure in departures(material) if material.departs is None else ():
            low, _, high = figure.range
            on = "" if figure.on is None else f" (on {figure.on})"
            yield Problem(
                f"{place}/{field}",
                f"material {name!r} is {material.of} with a {field} of {value:g}, {material.of} has {low:g} to {high:g}{on}; use a value there, or say in "
                "`departs` what makes it another (waxed, wet, hollow): it is printed in the verdict",
                replaced(f"{place}/{field}", min(max(value, low), high)),
            )

"""Materials that a specification names: what an edit takes from the table, and how far a material departs from its row."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from .errors import SpecError
from .hints import did_you_mean
from .materials import Figure, MaterialRow, material_table, row_named
from .references import references

if TYPE_CHECKING:
    from .spec import Material, WorldSpec

__all__ = ["HELD", "Departure", "declared_by_name", "departures", "filled_materials"]

HELD = ("density", "friction", "restitution")
"""Fields of a material for which the table has figures."""


class Departure(NamedTuple):
    """A field of a material outside of the range of its row."""

    field: str
    value: float
    figure: Figure


def _values(name: str, row: MaterialRow) -> dict[str, Any]:
    """Fields of a material that is nothing but a row of the table."""
    figures = {k: row.figures[k].range[1] for k in HELD if k in row.figures}
    return {"of": name, "substance": row.substance, **figures, "appearance": dict(row.look)}


def filled_materials(document: Any) -> Any:
    """A specification as JSON in which materials with `of` have what they leave out from the table.

    Raises:
        SpecError: the table has no such row.
    """
    materials = document.get("materials") if isinstance(document, dict) else None
    if not isinstance(materials, dict) or not any(
        isinstance(m, dict) and isinstance(m.get("of"), str) for m in materials.values()
    ):
        return document
    found = dict(materials)
    for key, material in materials.items():
        if not isinstance(material, dict) or not isinstance(material.get("of"), str):
            continue
        row = row_named(material["of"])
        if row is None:
            raise _unknown(f"/materials/{key}/of", material["of"])
        found[key] = {**_values(*row), **material, "of": row[0]}
    return {**document, "materials": found}


def _unknown(pointer: str, name: str) -> SpecError:
    hint = did_you_mean(name, material_table().materials) or ";"
    text = f"the table of materials has no {name[:60]!r}{hint} inspect_world(part='materials', query=...) finds rows"
    return SpecError(f"the specification does not validate, nothing was changed:\n  {pointer}: {text}", ((pointer, text),))


def declared_by_name(spec: WorldSpec) -> WorldSpec:
    """The specification with the materials that it refers to and does not declare, where the table has rows of that name."""
    from .spec import Material

    wanted = {value for _, target, value in references(spec, "") if target == "material" and value not in spec.materials}
    rows = {name: row for name in sorted(wanted) if (row := row_named(name)) is not None}
    if not rows:
        return spec
    more = {}
    for name, row in rows.items():
        values, users = _values(*row), [e for e in spec.entities.values() if e.material == name]
        if "grain_density" in row[1].figures and users and all(e.physics.shape == "loose" for e in users):
            values["density"] = row[1].figures["grain_density"].range[1]  # of a grain, not of the heap
        more[name] = Material.model_validate(values)
    return spec.model_copy(update={"materials": {**spec.materials, **more}})


def departures(material: Material) -> Iterator[Departure]:
    """Fields in which a material with `of` is not what its row says."""
    row = None if material.of is None else material_table().materials.get(material.of)
    figures: Mapping[str, Figure] = {} if row is None else row.figures
    for field in HELD:
        value = getattr(material, field)
        grain = figures.get("grain_density") if field == "density" else None
        if field in figures and not figures[field].holds(value) and (grain is None or not grain.holds(value)):
            yield Departure(field, value, figures[field])

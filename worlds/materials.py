"""The table of materials, `materials.json`: figures with their sources, in SI units, and looks.

A figure is a range [least, typical, largest]. Where the source gives no typical value it is the middle, and the geometric mean of ranges wider
than 1:3. Figures that no source is known for are left out.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self

from pydantic import Field, model_validator

from .vocabulary import Id, SpecModel, Text

__all__ = [
    "DENSITY_RANGES",
    "QUANTITIES",
    "ROUNDING",
    "Figure",
    "MaterialRow",
    "Pair",
    "Table",
    "friction_between",
    "material_table",
    "row_named",
]

Value = Annotated[float, Field(ge=0)]
ROUNDING = 0.02
"""[1] Own choice: share by which a value may be off a range: digits, and the temperature of a liquid."""
FILE = Path(__file__).with_suffix(".json")


class Quantity(NamedTuple):
    """A quantity of the table."""

    unit: str
    meaning: str


QUANTITIES: Mapping[str, Quantity] = {
    "density": Quantity("kg/m^3", "in bulk"),
    "grain_density": Quantity("kg/m^3", "of a grain, for members of a dem instance"),
    "friction": Quantity("1", "Coulomb coefficient, dry, on what `on` says"),
    "restitution": Quantity("1", "separation over approach speed, on what `on` says"),
    "young_modulus": Quantity("Pa", "of wood along the grain"),
    "poisson_ratio": Quantity("1", "strain across over strain along the load"),
    "tensile_strength": Quantity("Pa", "of wood across the grain, where it splits"),
    "compressive_strength": Quantity("Pa", "of wood along the grain"),
    "shear_strength": Quantity("Pa", "of wood along the grain"),
    "absorption": Quantity("1", "water taken up over dry mass"),
    "porosity": Quantity("1", "volume of pores over volume"),
    "viscosity": Quantity("Pa s", "dynamic"),
    "surface_tension": Quantity("N/m", "against air"),
}
"""Quantities with their units."""


class Figure(SpecModel):
    """A quantity of a material."""

    range: tuple[Value, Value, Value] = Field(description="least, typical, largest")
    source: Id
    on: Text | None = Field(default=None, description="of friction and restitution: on what it is measured")
    note: Text | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if list(self.range) != sorted(self.range):
            raise ValueError("least <= typical <= largest")
        return self

    def holds(self, value: float) -> bool:
        """True of a value within the range, or off by no more than `ROUNDING`."""
        return (1.0 - ROUNDING) * self.range[0] <= value <= (1.0 + ROUNDING) * self.range[2]


class MaterialRow(SpecModel):
    """A material: its group in the table, the substance that audits know, its figures and its look."""

    group: Id
    substance: Id
    also: tuple[Id, ...] = Field(default=(), description="other names")
    note: Text | None = None
    figures: Mapping[str, Figure]
    look: Mapping[str, Any] = Field(description="fields of an appearance; own choice")


class Pair(SpecModel):
    """Friction of two materials or substances."""

    a: Id
    b: Id
    friction: Figure


class Table(SpecModel):
    """The whole table."""

    sources: Mapping[Id, Text]
    substances: Mapping[Id, tuple[Value, Value]] = Field(
        description="least and largest density [kg/m^3], in bulk (sand: from the heap to the grain; fabric: from fleece to fibre): CRC Handbook "
        "of Chemistry and Physics, sections 6 and 15, widened to the nearest round number"
    )
    pairs: tuple[Pair, ...]
    materials: Annotated[Mapping[Id, MaterialRow], Field(min_length=1)]


@cache
def material_table() -> Table:
    """The table as `materials.json` holds it."""
    return Table.model_validate(json.loads(FILE.read_text("utf-8")))


DENSITY_RANGES: Mapping[str, tuple[float, float]] = material_table().substances
"""Least and largest density of each substance [kg/m^3]."""


@cache
def _names() -> Mapping[str, str]:
    """Names of the rows, and other names of theirs, with the row that each means."""
    rows = material_table().materials
    return {**{also: name for name, row in rows.items() for also in row.also}, **{name: name for name in rows}}


def row_named(name: str) -> tuple[str, MaterialRow] | None:
    """The row that a name means, with its own name; None where there is none. Case and hyphens do not matter."""
    own = _names().get(name.strip().lower().replace("-", "_").replace(" ", "_"))
    return None if own is None else (own, material_table().materials[own])


def friction_between(a: str, b: str) -> Figure | None:
    """Friction of two rows, where a source gives that pair, or that of their substances; None where none does."""
    rows = material_table().materials
    sides = [(name, rows[name].substance) for name in (a, b)]
    for one, other in ((0, 0), (0, 1), (1, 0), (1, 1)):
        wanted = {sides[0][one], sides[1][other]}
        for pair in material_table().pairs:
            if {pair.a, pair.b} == wanted:
                return pair.friction
    return None

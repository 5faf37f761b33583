"""Rows of the table of materials as `inspect_world` tells them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ..worlds.errors import InputError
from ..worlds.hints import did_you_mean
from ..worlds.materials import QUANTITIES, Figure, MaterialRow, material_table, row_named
from ..worlds.spec import WorldSpec
from .answers import answer, call, paged

__all__ = ["essentials", "materials", "table_values"]

SUBSTANCE_ROWS = 12
"""Rows of a substance that are named."""


def materials(query: str, *, offset: int, limit: int) -> dict[str, Any]:
    """Rows that a query finds by name, other name, group or substance; without a query the names by group.

    Raises:
        InputError: nothing is found.
    """
    table = material_table()
    if not query.strip():
        groups: dict[str, list[str]] = {}
        for name, row in table.materials.items():
            groups.setdefault(row.group, []).append(name)
        text = f"{len(table.materials)} materials; an entity's material may be any of these names, which edit_spec then declares with these figures"
        return answer({"part": "materials", "groups": groups}, text, call("inspect_world", part="materials", query="oak"))
    names = _found(query)
    if not names:
        hint = did_you_mean(query, [n for name, row in table.materials.items() for n in (name, *row.also)]) or ";"
        raise InputError(
            f"no material is found by {query[:60]!r}{hint} groups: {sorted({r.group for r in table.materials.values()})}"
        )
    page, place = paged([(n, _row(n)) for n in names], offset, limit)
    told = dict(page)
    data: dict[str, Any] = {
        "part": "materials",
        "materials": told,
        "units": {q: QUANTITIES[q].unit for q in dict.fromkeys(q for r in told.values() for q in r["figures"])},
        "sources": {k: table.sources[k] for k in sorted(_cited(told))},
        **place,
    }
    then = f"edit_spec: the name alone as an entity's material, or in materials {{'plank': {{'of': {page[0][0]!r}, ...}}}} with what differs"
    if "next_offset" in place:
        then = call("inspect_world", part="materials", query=query, offset=place["next_offset"])
    return answer(
        data, f"{len(page)} of {len(names)} materials found by {query[:60]!r}; ranges are [least, typical, largest]", then
    )


def _found(query: str) -> list[str]:
    """Names of rows, those first that are called so, then those whose words, group or substance are among the query's."""
    words = [w for w in query.lower().replace("-", " ").replace(",", " ").split() if w]
    own = [found[0] for name in (query, *words) if (found := row_named(name)) is not None]
    rows = material_table().materials
    near = [n for n, row in rows.items() if any(_meant(n, row, w) for w in words)]
    return list(dict.fromkeys([*own, *near]))


def _meant(name: str, row: MaterialRow, word: str) -> bool:
    said = {*name.split("_"), *(part for also in row.also for part in also.split("_")), row.group, row.substance}
    return word in said or word.rstrip("s") in said


def _row(name: str) -> dict[str, Any]:
    """A row with the friction that sources give it with others."""
    table, row = material_table(), material_table().materials[name]
    sides = {name, row.substance}
    pairs = {(pair.b if pair.a in sides else pair.a): _figure(pair.friction) for pair in table.pairs if sides & {pair.a, pair.b}}
    return {
        **({"also": list(row.also)} if row.also else {}),
        "substance": row.substance,
        **({"note": row.note} if row.note else {}),
        "figures": {q: _figure(f) for q, f in row.figures.items()},
        **({"friction_with": pairs} if pairs else {}),
        "look": dict(row.look),
    }


def _figure(figure: Figure) -> dict[str, Any]:
    return figure.model_dump(mode="json", exclude_none=True)


def _cited(rows: Mapping[str, Mapping[str, Any]]) -> set[str]:
    figures = [f for r in rows.values() for f in (*r["figures"].values(), *r.get("friction_with", {}).values())]
    return {f["source"] for f in figures}


def table_values(spec: WorldSpec, before: WorldSpec | None) -> dict[str, str]:
    """Materials of a specification that name a row, new ones or those that named another before, with what stands in it now."""
    old = {} if before is None else before.materials
    told = {}
    for name, material in spec.materials.items():
        if material.of is not None and (name not in old or old[name].of != material.of):
            told[name] = (
                f"{material.of}: {material.substance}, {material.density:g} kg/m^3, friction {material.friction:g}, "
                f"restitution {material.restitution:g}, colour {[round(c, 2) for c in material.appearance.color]}"
            )
    return told


def essentials(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Density [kg/m^3] and friction of materials, each [least, typical, largest]; of a substance alone [least, largest] density, and its rows."""
    table, named = material_table(), list(names)
    found = {row[0]: row[1] for name in named if (row := row_named(name)) is not None}
    told: dict[str, dict[str, Any]] = {
        n: {q: list(r.figures[q].range) for q in ("density", "friction") if q in r.figures} for n, r in found.items()
    }
    for substance in dict.fromkeys(n for n in named if n in table.substances and row_named(n) is None):
        rows = [n for n, r in table.materials.items() if r.substance == substance]
        if rows and not set(rows) & set(found):
            told[substance] = {"density": list(table.substances[substance]), "rows": rows[:SUBSTANCE_ROWS]}
    return told

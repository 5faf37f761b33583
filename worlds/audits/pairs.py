"""Contacts of a pair that have friction or restitution of their own, beside what the materials of the two give (R27, R154)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..materials import friction_between
from ..problems import Problem, replaced

if TYPE_CHECKING:
    from ..spec import ContactPair, WorldSpec

__all__ = ["departures", "materials_of", "surface_problems"]

FRICTION_FACTOR = 2.0
"""Own choice: measured coefficients of one pair of materials scatter by so much; beyond, the surfaces are others than the materials say."""
RESTITUTION_ROOM = 0.2
"""[1] Own choice, likewise."""


def surface_problems(spec: WorldSpec) -> Iterator[Problem]:
    """Pairs whose own values depart from what their materials give, and that do not say why."""
    for key, pair in spec.simulation.contacts.items():
        if pair.reason is not None:
            continue
        for field, value, (low, high) in departures(spec, pair):
            place = f"/simulation/contacts/{key}/{field}"
            least, most = _allowed(field, low, high)
            yield Problem(
                place,
                f"contact {key!r} gives {pair.a!r} and {pair.b!r} a {field} of {value:g}, and their materials give {_span(low, high)}; allowed without a "
                f"reason: {least:.3g} to {most:.3g}. Use a value there, or say in `reason` what lies between the two "
                f"(an oil film, ice, glue): it is printed in the verdict",
                replaced(place, min(max(value, least), most)),
            )


def departures(spec: WorldSpec, pair: ContactPair) -> Iterator[tuple[str, float, tuple[float, float]]]:
    """Own values of a pair that its materials do not give: field, value, and least and greatest that the materials give."""
    sides = [materials_of(spec, name) for name in (pair.a, pair.b)]
    if not all(sides):
        return
    for field, joined in (("friction", max), ("restitution", min)):
        value = getattr(pair, field)
        if value is None:
            continue
        if field == "friction" and all(_measured(spec, m, n, value) for m in sides[0] for n in sides[1]):
            continue
        given = [joined(getattr(spec.materials[m], field), getattr(spec.materials[n], field)) for m in sides[0] for n in sides[1]]
        least, most = _allowed(field, min(given), max(given))
        if not least <= value <= most:
            yield field, value, (min(given), max(given))


def _measured(spec: WorldSpec, a: str, b: str, value: float) -> bool:
    """True of a friction that the table of materials has for the rows of two materials."""
    rows = [spec.materials[name].of for name in (a, b)]
    found = None if rows[0] is None or rows[1] is None else friction_between(rows[0], rows[1])
    return found is not None and found.holds(value)


def materials_of(spec: WorldSpec, name: str) -> set[str]:
    """Materials of an entity's parts that the specification has."""
    entity = spec.entities.get(name)
    if entity is None:
        return set()
    used = {p.material or entity.material for p in entity.parts.values() if p.collides} or {entity.material}
    return {m for m in used if m in spec.materials}


def _allowed(field: str, low: float, high: float) -> tuple[float, float]:
    if field == "friction":
        return low / FRICTION_FACTOR, high * FRICTION_FACTOR
    return max(0.0, low - RESTITUTION_ROOM), min(1.0, high + RESTITUTION_ROOM)


def _span(low: float, high: float) -> str:
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"

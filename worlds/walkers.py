"""Measures of a walker: those of a person, which no specification may make smaller; other carriers are named as such (S4)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from .directions import way_of

if TYPE_CHECKING:
    from .spec import Connects

__all__ = ["PERSON", "TOO_EASY", "Measure", "carrier_words", "easier_than_a_person"]


class Measure(NamedTuple):
    """One measure of a person."""

    value: float
    """Least width and height, largest step and slope [m, rad]."""
    unit: str
    source: str


PERSON: Mapping[str, Measure] = {
    "width": Measure(
        0.51, "m", "shoulder breadth, 95th percentile of British men (Pheasant & Haslegrave 2006, Bodyspace, 3rd ed.)"
    ),
    "headroom": Measure(1.88, "m", "stature, 95th percentile of British men, 1.855 m, and shoes (ibid.)"),
    "max_step": Measure(0.22, "m", "highest riser of private stairs (UK Approved Document K 2013, 1.3)"),
    "max_slope": Measure(0.6, "rad", "own choice: 34 degrees; steeper ground is climbed with the hands"),
}
TOO_EASY = 1e-9
"""Rounding."""


def easier_than_a_person(relation: Connects) -> list[str]:
    """Measures of a carrier that get through where a person does not, the farthest off first; none of a fluid's."""
    if relation.carrier == "fluid":
        return []
    off: dict[str, float] = {}
    for name, person in PERSON.items():
        way, value = way_of(f"/graph/relations/x/{name}"), getattr(relation, name)
        assert way is not None
        times = person.value / value if way.direction == "harder_up" else value / person.value
        if times > 1.0 + TOO_EASY:
            off[name] = times
    return sorted(off, key=lambda n: -off[n])


def carrier_words(relation: Connects) -> str:
    """Who takes a route, in words: a walker only where it is one."""
    if not easier_than_a_person(relation):
        return f"a {relation.carrier} {relation.width:g} m wide and {relation.headroom:g} m high"
    return f"a carrier of {relation.width:g} m x {relation.headroom:g} m with steps of {relation.max_step:g} m, not a person"

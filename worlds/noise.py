"""Least values that tell an event from noise: what bodies do while they settle into their skins, and what a solver leaves over (R154)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from .extents import told_mass
from .predicates import atoms_of
from .predicates.registry import PREDICATES

if TYPE_CHECKING:
    from .spec import Beat, SpecModel, WorldSpec

__all__ = ["Floor", "least_impulse", "least_margin", "least_travel"]

LEAST_TRAVEL_SHARE = 0.02
"""Own choice: a displacement counts as an event from this share of the entity's diagonal on, within the two limits below."""
LEAST_TRAVEL = (0.001, 0.02)
"""[m]: above what bodies settle into their skins, and no more than one can see on a large body."""
LEAST_PUSH = 0.001
"""[m/s] Own choice: an impulse counts as a push when it changes the speed of the lighter moving body by so much; gravity does that in
a tenth of a millisecond, less than one step of most solvers."""
_DIGITS = 3


class Floor(NamedTuple):
    """Least value that is no noise."""

    value: float
    unit: str
    how: str
    """Rule by which it is computed, in words."""


def least_travel(spec: WorldSpec, entity: str) -> Floor:
    """Least displacement of an entity [m]."""
    sizes = [spec.entities[n].dimensions.size for n in ([entity] if entity in spec.entities else [])]
    diagonal = min((math.hypot(*size) for size in sizes), default=0.0)
    least = round(min(max(LEAST_TRAVEL_SHARE * diagonal, LEAST_TRAVEL[0]), LEAST_TRAVEL[1]), 6)
    how = f"{LEAST_TRAVEL_SHARE:.0%} of its diagonal, from {LEAST_TRAVEL[0]:g} to {LEAST_TRAVEL[1]:g} m"
    return Floor(least, "m", how)


def least_impulse(spec: WorldSpec, a: str, b: str) -> Floor | None:
    """Least impulse between two entities [N s]; None where neither is a moving body whose mass the specification tells."""
    masses = [m for n in (a, b) if (m := told_mass(spec, n)) > 0.0]
    if not masses:
        return None
    least = float(f"{LEAST_PUSH * min(masses):.{_DIGITS}g}")
    how = f"{1000 * LEAST_PUSH:g} mm/s of the lighter moving body, {min(masses):.{_DIGITS}g} kg"
    return Floor(least, "N s", how)


def least_margin(spec: WorldSpec, beat: Beat) -> Floor | None:
    """Least margin of a cause of a beat, in the unit that the beat measures; None where it has no floor but a share of what it measures."""
    if beat.predicate.kind == "count":
        return Floor(1.0, "1", "one of those that are counted")
    floors = [f for a in atoms_of(beat.predicate) if (f := _of_atom(spec, a, beat.subject)) is not None]
    return min(floors, default=None)


def _of_atom(spec: WorldSpec, atom: SpecModel, subject: str) -> Floor | None:
    kind = str(getattr(atom, "kind", ""))
    info = PREDICATES.get(kind)
    if info is None:
        return None
    if kind == "contact":
        return least_impulse(spec, atom.a, atom.b)  # type: ignore[attr-defined]
    if info.noise is not None:
        least = info.noise.least(spec, kind, str(getattr(atom, "entity", subject)))
        return None if least is None else Floor(*least)
    if info.unit == "m" and info.bodily:
        return least_travel(spec, str(getattr(atom, "entity", subject)))
    if info.unit in ("rad", "m/s"):
        # What is least for a topple is an angle at which one may speak of it, no noise.
        like = info if "min" in info.least else PREDICATES["tilts" if info.unit == "rad" else "speed"]
        return Floor(like.least["min"], info.unit, f"the least that `{like.kind}` may ask for")
    return None

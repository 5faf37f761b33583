"""Names that cloth fills into the diagnosis tables: the wind that blows a sheet, and whether pins hold it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ....worlds.categories.cloth.facts import pins_of
from ....worlds.predicates import atoms_of

if TYPE_CHECKING:
    from ....worlds.requirements import Row
    from ....worlds.spec import WorldSpec

__all__ = ["sheet_names"]

AIRS = ("wind", "turbulence", "vortex")
"""Kinds of fields that make air move."""
STEADY = 0.3
"""Own choice: gusts below this share of the wind's speed are weak."""
BY_AIR = frozenset(
    {"flutters", "drifts", "rises", "goes_uphill", "displacement", "speed", "reaches", "crosses", "separation", "tilts"}
)
"""Kinds of predicate that moving air may bring about. What falls, lands, drapes or stops needs none."""


def sheet_names(spec: WorldSpec, entity: str, row: Row) -> dict[str, Any]:
    """The strongest wind on a sheet, the same if it hardly gusts, the sheet itself where no air moves around it; the sheet as held or as free.

    Names of air are left out where a beat or requirement asks for what air does not bring about.
    """
    held = {"held" if pins_of(spec.entities[entity]) else "free": entity}
    asked = _asked(spec, row, entity)
    if asked and not asked & BY_AIR:
        return held
    fields = {n: d for n, d in spec.simulation.drivers.items() if d.kind == "field" and d.field.kind in AIRS}
    airs = {n: d.field for n, d in fields.items() if d.entities is None or entity in d.entities}
    winds = {n: f for n, f in airs.items() if f.kind == "wind"}
    wind = max(winds, key=lambda n: sum(v * v for v in winds[n].velocity), default=None)
    steady = wind if winds and max(w.gust for w in winds.values()) < STEADY else None
    return {"wind": wind, "steady": steady, "becalmed": None if airs else entity, **held}


def _asked(spec: WorldSpec, row: Row, entity: str) -> set[str]:
    """Kinds of the predicates of a beat or requirement that are about the sheet; none of other rows."""
    name = row.subject[-1] if row.check == "beat" and row.subject else ""
    item = spec.story.beats.get(name) or spec.story.requirements.get(name)
    if item is None:
        return set()
    atoms = list(atoms_of(item.predicate))
    own = [a for a in atoms if {entity, "each"} & {v for v in a.model_dump().values() if isinstance(v, str)}]
    return {str(getattr(a, "kind", "")) for a in own or atoms}

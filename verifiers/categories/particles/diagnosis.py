"""Names that particles fill into the diagnosis tables: what lets them out, and whether they run or are jammed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...story.bounds import BEHIND

if TYPE_CHECKING:
    from ....worlds.requirements import Row
    from ....worlds.spec import WorldSpec

__all__ = ["particle_names"]

COMING = 0.1
"""Own choice: what comes in a quarter of a second, over what is lacking; where it is more, grains still run."""


def particle_names(spec: WorldSpec, entity: str, row: Row) -> dict[str, Any]:
    """The one emitter of an entity; the entity as grains, as flying particles, and as grains that are jammed."""
    emitters = [n for n, d in spec.simulation.drivers.items() if d.kind == "emitter" and d.entity == entity]
    law = getattr(spec.entities[entity].physics, "law", "")
    return {
        "emitter": emitters[0] if len(emitters) == 1 else None,
        "grains": entity if law == "granular" else None,
        "flying": entity if law == "ballistic" else None,
        "jammed": entity if law == "granular" and _stay_behind(row) else None,
    }


def _stay_behind(row: Row) -> bool:
    """True if grains that are lacking in a region lie above what is in it, and hardly any come; so it may be where the row does not tell."""
    above, gained = row.evidence.get("above"), row.evidence.get("gained")
    if above is None or gained is None or row.bound is None or row.measured is None:
        return True
    lacking = row.bound - row.measured
    return bool(above >= BEHIND * lacking and gained <= COMING * lacking)

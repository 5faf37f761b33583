"""Lamps of generated things: what shines in a picture follows from the parts that are bulbs."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from ..worlds.spec import WorldSpec

__all__ = ["lamp_operations"]

BULB = "bulb"
"""Name that generators give to the part that shines."""
MOST = 200
"""`max_length` of `look.lamps`."""


def lamp_operations(
    spec: WorldSpec, entities: Mapping[str, Mapping[str, Any]], old: Collection[str] = ()
) -> list[dict[str, Any]]:
    """Operations that light the bulbs among new entities, and take the lamps of entities out that are no more.

    A lamp that is there already keeps what was set; beyond `MOST` no more are lit.

    Args:
        spec: what the operations are applied to.
        entities: documents of the new entities, by id.
        old: ids of what they replace.
    """
    lamps = spec.look.lamps
    gone = [k for k, lamp in lamps.items() if lamp.entity in old and BULB not in entities.get(lamp.entity, {}).get("parts", {})]
    edits: list[dict[str, Any]] = [{"op": "remove", "path": f"/look/lamps/{k}"} for k in gone]
    lit = {(lamp.entity, lamp.part) for lamp in lamps.values()}
    new = [k for k, e in entities.items() if BULB in e.get("parts", {}) and (k, BULB) not in lit and k not in lamps]
    room = MOST - len(lamps) + len(gone)
    return edits + [{"op": "add", "path": f"/look/lamps/{k}", "value": {"entity": k, "part": BULB}} for k in new[:room]]

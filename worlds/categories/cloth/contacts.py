"""Contacts of cloth that its record cannot tell: it holds an impulse for each solid, of contacts and pins, of all members together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .facts import pins_of

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["unrecorded"]


def unrecorded(spec: WorldSpec, a: str, b: str) -> str:
    """Why no record tells contacts of two entities of which one is cloth, and what to ask instead; empty where one does."""
    sheets = [n for n in (a, b) if n in spec.entities and spec.entities[n].physics.category == "cloth"]
    if not sheets or not {a, b} <= set(spec.entities):
        return ""
    sheet, other = sheets[0], b if sheets[0] == a else a
    contract, category = spec.entities[sheet], spec.entities[other].physics.category
    if category == "cloth":
        return f"no record holds contacts among cloth, such as {a!r} and {b!r}: ask separation of them"
    if category not in ("rigid", "elastic"):
        return ""
    alike = next((i.members for i in spec.simulation.cloth.values() if sheet in i.members), [sheet])
    if len(alike) > 1:
        return (
            f"the record of pushes on {other!r} does not tell {sheet!r} from {', '.join(m for m in alike if m != sheet)}: "
            f"give it an instance of its own, or ask separation or reaches"
        )
    pins = pins_of(contract)
    if any(p.to == other for p in pins.values()):
        return f"{other!r} holds a pin of {sheet!r}, and its pull is recorded with contacts: ask pinned or separation"
    if contract.physics.category == "cloth" and other in contract.physics.ignores:
        return f"{sheet!r} passes through {other!r} (`ignores`): take it out of there, or ask separation or reaches"
    parts = spec.entities[other].parts.values()
    if category == "rigid" and parts and not any(p.collides for p in parts):
        return f"no part of {other!r} collides, so {sheet!r} never meets it: let one collide, or ask separation or reaches"
    return ""

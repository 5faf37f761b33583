"""Spans of claims, and the pointers and ids that a claim is judged by."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from .spec import Claim, ClaimType, WorldSpec

__all__ = ["JUDGED_BY", "Span", "may_judge", "named_in", "targets_of"]

JUDGED_BY: Mapping[ClaimType, tuple[str, ...]] = {
    "thing": ("entities", "terrains"),
    "count": ("entities", "terrains", "simulation", "story/beats", "story/requirements"),
    "quantity": ("entities", "terrains", "materials", "graph", "story", "simulation", "look", "shots"),
    "property": ("entities", "terrains", "materials", "story/beats", "story/requirements", "graph/relations"),
    "event": ("story/beats",),
    "order": ("story/beats", "story/requirements"),
    "negation": ("story/requirements",),
    "place": ("graph", "terrains", "entities", "story/requirements"),
    "time": ("look", "simulation", "story/beats", "story/requirements", "shots"),
    "weather": ("look", "simulation", "terrains", "entities"),
    "look": ("look", "shots", "materials", "entities"),
    "route": ("graph/relations", "graph/regions", "story/beats", "story/requirements"),
}
"""Where a claim of each type may be judged."""


class Span(NamedTuple):
    """A part of the prompt with its claim; without one it is filler."""

    start: int
    end: int
    text: str
    claim: str | None
    type: str


def targets_of(claims: Mapping[str, Claim], name: str) -> list[str]:
    """Pointers that a claim is judged by, its own or those of the claim that it is the same as."""
    claim = claims[name]
    other = claims.get(claim.same_as or "")
    return list(claim.by or (other.by if other is not None else ()))


def named_in(spec: WorldSpec, name: str, group: str) -> list[str]:
    """Ids of the members of a group, as `story/beats`, that a claim is judged by, in the order in which it names them."""
    start = f"/{group}/"
    return list(dict.fromkeys(p.removeprefix(start).split("/")[0] for p in targets_of(spec.claims, name) if p.startswith(start)))


def may_judge(kind: ClaimType, pointer: str) -> bool:
    """True if a claim of a type may be judged by what stands at a pointer."""
    return pointer.lstrip("/").startswith(tuple(f"{root}/" for root in JUDGED_BY[kind]))

"""Spans of claims, and the pointers and ids that a claim is judged by."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from .spec import Claim, WorldSpec

__all__ = ["Span", "named_in", "targets_of"]


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

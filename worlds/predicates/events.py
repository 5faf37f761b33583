"""Kinds of event: every predicate that says that something happens, with its definition, by kind (R131, R157)."""

from __future__ import annotations

from collections.abc import Mapping

from ..predicate_base import PredicateInfo
from ..vocabulary import SpecModel
from .event_models import BodyEvent, PairEvent, TouchEvent
from .registry import PREDICATES, is_event

__all__ = ["EVENT_KINDS", "BodyEvent", "PairEvent", "TouchEvent", "event_atoms"]

EVENT_KINDS: Mapping[str, PredicateInfo] = {kind: info for kind, info in PREDICATES.items() if info.event}
"""Kinds of event with their metadata: `directed`, `gloss`, `source`, `unit`."""


def event_atoms(predicate: SpecModel) -> list[SpecModel]:
    """Events that have to happen for a predicate to hold, at any depth; none below a `not` or a count without `min`, nor of an `or` with a branch without one."""
    if is_event(predicate):
        return [predicate]
    kind = getattr(predicate, "kind", "")
    if kind == "not" or (kind == "count" and not (getattr(predicate, "min", None) or 0) > 0):
        return []
    if kind == "or":
        branches = [event_atoms(branch) for branch in predicate.of]  # type: ignore[attr-defined]
        return [atom for branch in branches for atom in branch] if all(branches) else []
    inner = [getattr(predicate, name, None) for name in ("predicate", "goal")] + list(getattr(predicate, "of", None) or ())
    return [atom for child in inner if isinstance(child, SpecModel) for atom in event_atoms(child)]

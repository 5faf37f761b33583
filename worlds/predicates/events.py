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
    """Events that have to happen for a predicate to hold, at any depth; none below a `not`."""
    if is_event(predicate):
        return [predicate]
    if getattr(predicate, "kind", "") == "not":
        return []
    inner = [getattr(predicate, name, None) for name in ("predicate", "goal")] + list(getattr(predicate, "of", None) or ())
    return [atom for child in inner if isinstance(child, SpecModel) for atom in event_atoms(child)]

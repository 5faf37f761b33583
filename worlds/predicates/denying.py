"""Events that happen wherever a predicate holds, and those that never happen where it never does."""

from __future__ import annotations

from ..vocabulary import SpecModel
from .models import After, Always, And, Before, Count, Eventually, Until, Within
from .registry import is_event

__all__ = ["certain", "denying", "implies"]


def certain(predicate: SpecModel, each: str | None = None) -> list[SpecModel]:
    """Events that happen wherever a predicate holds, `each` of a count that wants all told of every one."""
    if is_event(predicate):
        return [predicate if each is None else _told_of(predicate, each)]
    if isinstance(predicate, And):
        return [a for member in predicate.of for a in certain(member, each)]
    if isinstance(predicate, Before | After | Within | Eventually | Always):
        return certain(predicate.predicate, each)
    if isinstance(predicate, Until):
        return certain(predicate.goal, each)
    if isinstance(predicate, Count) and (predicate.min or 0) >= len(predicate.entities):
        return [a for name in predicate.entities for a in certain(predicate.predicate, name)]
    return []


def _told_of(atom: SpecModel, entity: str) -> SpecModel:
    fields = (n for n in ("entity", "a", "b", "other") if getattr(atom, n, None) == "each")
    return atom.model_copy(update=dict.fromkeys(fields, entity))


def denying(predicate: SpecModel) -> list[SpecModel]:
    """Events none of which happens where a predicate never holds."""
    if is_event(predicate):
        return [predicate]
    if getattr(predicate, "kind", "") == "or":
        return [a for member in predicate.of for a in denying(member)]  # type: ignore[attr-defined]
    if isinstance(predicate, Eventually) and predicate.frames is None:
        return denying(predicate.predicate)
    if isinstance(predicate, Count) and predicate.max is None and (predicate.min or 0) <= 1:
        return [_told_of(a, name) for name in predicate.entities for a in denying(predicate.predicate)]
    return []


def implies(event: SpecModel, other: SpecModel) -> bool:
    """True where an event cannot happen without another: the same kind of the same, at least as much."""
    if type(event) is not type(other):
        return False
    for name in type(event).model_fields:
        mine, theirs = getattr(event, name), getattr(other, name)
        if name in ("min", "min_impulse", "min_angle"):
            if (theirs or 0.0) > (mine or 0.0):
                return False
        elif (name == "other" and theirs is None) or (name in ("a", "b") and _pair(event) == _pair(other)):
            continue
        elif mine != theirs:
            return False
    return True


def _pair(atom: SpecModel) -> set[object]:
    return {getattr(atom, "a", None), getattr(atom, "b", None)}

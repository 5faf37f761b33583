"""Beats and requirements that ask for less after an edit (R157)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from .predicates.registry import interval_tightens
from .stricter import asks_less

__all__ = ["story_weakenings"]


def _beat_weakenings(old: Mapping[str, Any], new: Mapping[str, Any], place: str) -> Iterator[str]:
    for key, beat in old.items():
        now = new.get(key)
        if now is None:
            yield f"{place}/{key} removed"
            continue
        if beat.get("mandatory", True) and not now.get("mandatory", True):
            yield f"{place}/{key} made optional"
        if beat.get("observe", True) and not now.get("observe", True):
            yield f"{place}/{key} need not be seen any more"
        if beat.get("frames") != now.get("frames") and _frames_weaker(beat, now):
            yield f"{place}/{key}/frames {beat.get('frames')} -> {now.get('frames')}"
        if not set(beat.get("causes", [])) <= set(now.get("causes", [])):
            yield f"{place}/{key}/causes lost {sorted(set(beat['causes']) - set(now.get('causes', [])))}"
        yield from _margin_weakenings(beat, now, f"{place}/{key}/margins")
        for field in ("subject", "owner"):
            if beat.get(field) != now.get(field):
                yield f"{place}/{key}/{field} {beat.get(field)} -> {now.get(field)}"
        if asks_less(beat["predicate"], now["predicate"]):
            yield f"{place}/{key}/predicate loosened or replaced"


def story_weakenings(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Beats and requirements of a story, as JSON, that ask for less in another one."""
    yield from _beat_weakenings(old["beats"], new["beats"], "/story/beats")
    yield from _beat_weakenings(_asked(old["requirements"]), _asked(new["requirements"]), "/story/requirements")


def _frames_weaker(old: Mapping[str, Any], new: Mapping[str, Any]) -> bool:
    """True if other frames are, or may be, easier: what must happen is harder in fewer frames, what must last in more, and what must
    be so at the end is looked for from no later frame.

    An effect that is only looked for later is not asked whether it came before its cause.
    """
    (first, last), (now, then) = (x.get("frames") or (0, math.inf) for x in (old, new))
    harder = interval_tightens(old["predicate"])
    if harder == "narrower":
        return bool(now < first or then > last or (now > first and old.get("causes")))
    if harder == "end":
        return bool(then != last or now > first)
    return harder == "either" or bool(now > first or then < last)


def _margin_weakenings(old: Mapping[str, Any], beat: Mapping[str, Any], place: str) -> Iterator[str]:
    """Without a margin an effect must vanish with its cause; any margin asks less, a smaller one still less."""
    for cause, margin in beat.get("margins", {}).items():
        before = old.get("margins", {}).get(cause)
        if before == margin or cause not in old.get("causes", []):
            continue
        field = next(iter(margin))
        if before is None or field not in before or margin[field] < before[field]:
            yield f"{place}/{cause} {before or 'must vanish'} -> {margin}"


def _asked(requirements: Mapping[str, Any]) -> dict[str, Any]:
    """Requirements with the predicate that must hold, negated where it must never come true."""
    return {
        key: {**r, "predicate": {"kind": "not", "predicate": r["predicate"]}} if r.get("never") else r
        for key, r in requirements.items()
    }

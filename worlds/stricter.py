"""Which of two predicates asks for more, as far as their form tells (R157).

One asks for at least as much as another where whatever meets it meets the other, at each frame as over its interval, and comes true no
sooner. An `and` asks for all that its members ask, an `or` for what all of its members ask; `not` turns the direction. Where the form
does not tell, the other is taken to ask for less.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .predicates.registry import PREDICATES

__all__ = ["asks_less"]

Predicate = Mapping[str, Any]
_BY_ORDER = ("before", "after", "within")
"""Kinds that compare first true frames, which do not follow the inner predicate in one direction."""
_MOST_COMPARED = 20_000
"""Own choice: pairs of predicates that one comparison looks at. 64 members against 64 in another order are 4,096; beyond, nothing is told."""


def asks_less(old: Predicate, new: Predicate) -> bool:
    """True if `new` is, or may be, easier to satisfy than `old`; both as JSON."""
    return not _Comparison().as_much(old, new)


class _Comparison:
    """Answers about pairs of predicates, kept by identity: they live as long as the two that are compared."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], bool] = {}

    def as_much(self, old: Predicate, new: Predicate) -> bool:
        """True if it can be told that `new` asks for at least as much as `old`."""
        pair = id(old), id(new)
        if pair not in self._known:
            if len(self._known) >= _MOST_COMPARED:
                return False
            self._known[pair] = False
            self._known[pair] = old == new or self._told(old, new)
        return self._known[pair]

    def _told(self, old: Predicate, new: Predicate) -> bool:
        kind = old.get("kind")
        if kind == "and":
            asked = _members(new, "and")
            return all(self._beside(asked, k, one, new) for k, one in enumerate(_members(old, "and")))
        if new.get("kind") == "or":
            choices = _members(old, "or")
            return all(
                (k < len(choices) and self.as_much(choices[k], one)) or self.as_much(old, one)
                for k, one in enumerate(_members(new, "or"))
            )
        if new.get("kind") == "and" or kind == "or":
            if new.get("kind") == "and" and any(self.as_much(old, one) for one in _members(new, "and")):
                return True
            return kind == "or" and any(self.as_much(one, new) for one in _members(old, "or"))
        if kind != new.get("kind"):
            return False
        if kind == "not":
            return self.as_much(new["predicate"], old["predicate"])
        if (kind in _BY_ORDER or (kind == "count" and "max" in old)) and old.get("predicate") != new.get("predicate"):
            return False
        return self._bounds(old, new)

    def _beside(self, asked: Sequence[Predicate], place: int, one: Predicate, new: Predicate) -> bool:
        """As `as_much`; the member at the same place is looked at first, since edits seldom move them."""
        return (place < len(asked) and self.as_much(one, asked[place])) or self.as_much(one, new)

    def _bounds(self, old: Predicate, new: Predicate) -> bool:
        """True if every field that changed is a bound moved to the harder side, or a predicate that asks for as much."""
        info = PREDICATES.get(str(old.get("kind")))
        for key in {*old, *new}:
            a, b = old.get(key), new.get(key)
            if a == b:
                continue
            if isinstance(a, dict) and isinstance(b, dict):
                # The first frame of an `or` is that of members which hold over the whole interval; a goal asks for a first frame alone.
                if (key == "goal" and _chooses(a)) or not self.as_much(a, b):
                    return False
                continue
            direction = "none" if info is None else info.tightens.get(key, "none")
            if direction == "none" or b is None:
                return False
            if a is not None and ((direction == "up" and b < a) or (direction == "down" and b > a)):
                return False
        return True


def _members(predicate: Predicate, kind: str) -> list[Predicate]:
    """Members of an `and` or `or` and of those of its kind in it, in order; the predicate itself where it is none."""
    if predicate.get("kind") != kind:
        return [predicate]
    return [one for member in predicate["of"] for one in _members(member, kind)]


def _chooses(predicate: Predicate) -> bool:
    """True if there is an `or` in a predicate."""
    below = [*predicate.get("of", ()), *(predicate[k] for k in ("predicate", "hold", "goal") if k in predicate)]
    return predicate.get("kind") == "or" or any(map(_chooses, below))

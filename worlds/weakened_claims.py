"""Claims that ask for less after an edit (R157).

A pointer that judged nothing is no loss: one that led nowhere, or to where a claim of its type is not judged. Nor is one to a beat or
requirement in whose place another one comes that asks for as much: the same as an edit of the first, which is free to stay.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from .claim_targets import may_judge
from .errors import InputError
from .prompts.marks import occurrence
from .references import resolves
from .weakened_story import story_weakenings

__all__ = ["claim_weakenings"]

Document = Mapping[str, Any]
_ONE_BY_ONE = frozenset({"event", "negation", "place", "property", "route", "time"})
"""Types that ask of each beat or requirement that it holds; an order, a count or a number lies in how several stand to each other."""


def claim_weakenings(old: Document, new: Document) -> Iterator[str]:
    """Edits of claims that ask for less: compared by quote and place in the prompt, since ids may change.

    Args:
        old: the specification before the edit, as JSON without nulls.
        new: the one after it, of the same prompt.
    """
    edit = _Edit(old, new)
    before, now = ({(c["quote"], c.get("nth", 1)): c for c in d.get("claims", {}).values()} for d in (old, new))
    for place, claim in before.items():
        told, after = f"claim of {place[0]!r}", now.get(place)
        if after is None:
            yield from _marked_otherwise(told, claim, now.values(), edit)
        elif after.get("waived") and not claim.get("waived"):
            yield f"{told} waived: {after['waived']}"
        elif after["type"] != claim["type"] and not claim.get("waived"):
            yield f"{told} is {after['type']}, was {claim['type']}"
        else:
            yield from edit.lost(told, claim, after.get("by", ()))
    for place, claim in now.items():
        if place not in before and claim.get("waived") and before:
            yield f"claim of {place[0]!r} waived: {claim['waived']}"


def _marked_otherwise(told: str, claim: Document, now: Iterable[Document], edit: _Edit) -> Iterator[str]:
    """Lines on words whose claim is gone; none where claims of its type now cover them all and name all that it named."""
    prompt = edit.prompt
    words = _letters(claim, prompt)
    over = [c for c in now if not c.get("waived") and words & _letters(c, prompt)]
    left = words.difference(*(_letters(c, prompt) for c in over))
    if claim.get("waived"):
        return
    if not over:
        yield f"{told} dropped: these words are filler"
        return
    if left:
        kept = "".join(prompt[i] if i in left else " " for i in range(min(words), max(words) + 1)).split()
        yield f"{told} covers less: {' '.join(kept)!r} is filler now"
    if claim["type"] not in {c["type"] for c in over} | ({"thing"} if any(c["type"] == "count" for c in over) else set()):
        yield f"{told} is part of {over[0]['quote']!r}, of type {over[0]['type']}; it was {claim['type']}"
    yield from edit.lost(told, claim, [pointer for c in over for pointer in c.get("by", ())])


def _letters(claim: Document, prompt: str) -> set[int]:
    """Indices into the prompt of the letters and digits that a claim marks; none where its quote is not there."""
    try:
        start, end = occurrence(prompt, claim["quote"], claim.get("nth", 1))
    except InputError:
        return set()
    return {i for i in range(start, end) if prompt[i].isalnum()}


class _Edit:
    """Two specifications of one prompt, and what claims lose between them."""

    def __init__(self, old: Document, new: Document) -> None:
        self._old, self._new = old, new
        self.prompt: str = new["prompt"]

    def lost(self, told: str, claim: Document, by: Iterable[str]) -> Iterator[str]:
        """The line about pointers that judged a claim and do so no more; none where there is no such pointer.

        Args:
            told: which claim, in words.
            claim: as it was.
            by: pointers that judge its words now.
        """
        named = list(dict.fromkeys(by))
        fresh = [p for p in named if p not in claim.get("by", ())]
        left = []
        for pointer in sorted(set(claim.get("by", ())) - set(named)):
            if not resolves(self._old, pointer) or not may_judge(claim["type"], pointer):
                continue
            successor = next((p for p in fresh if claim["type"] in _ONE_BY_ONE and self._as_much(pointer, p)), None)
            if successor is None:
                left.append(pointer)
            else:
                fresh.remove(successor)
        if left:
            yield f"{told} is no longer judged by {', '.join(left)}"

    def _as_much(self, pointer: str, other: str) -> bool:
        """True if a beat or requirement after the edit asks for at least as much as one before it, in as many runs and pictures."""
        (group, name), (kind, successor) = _told_at(pointer), _told_at(other)
        was, now = (d["story"].get(group, {}) for d in (self._old, self._new))
        if group != kind or name not in was or successor not in now:
            return False
        empty: dict[str, Any] = {"beats": {}, "requirements": {}}
        pair = ({**empty, group: {name: item}} for item in (was[name], now[successor]))
        return not any(story_weakenings(*pair)) and (group != "beats" or self._stands_in(name, successor))

    def _stands_in(self, beat: str, successor: str) -> bool:
        """True if whatever tries or shows a beat before the edit does so with another one after it."""
        old, new = self._old, self._new
        for key, item in old["story"].get("robustness", {}).items():
            if beat in item["beats"] and successor not in new["story"].get("robustness", {}).get(key, {"beats": ()})["beats"]:
                return False
        shown = {name for shot in new["shots"].values() for name in shot["covers"]}
        return successor in shown or not any(beat in shot["covers"] for shot in old["shots"].values())


def _told_at(pointer: str) -> tuple[str, str]:
    """Group and id of the beat or requirement that a pointer leads to; both empty where it leads elsewhere or into one."""
    root, _, rest = pointer.removeprefix("/").partition("/")
    group, _, name = rest.partition("/")
    return (group, name) if root == "story" and group in ("beats", "requirements") and "/" not in name else ("", "")

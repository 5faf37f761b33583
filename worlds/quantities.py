"""Quantities that claims state, with the words beside their quote that open them: `at most [8 cm](quantity ...)` is at most 8 cm (R131, R155)."""

from __future__ import annotations

import regex

from .errors import InputError
from .prompts.languages import language_of
from .prompts.marks import occurrence
from .prompts.numbers import Quantity, hedge_beside, quantity_in
from .spec import WorldSpec

__all__ = ["quantity_said"]

_CLAUSE = regex.compile(r"[,;:.!?…()\n。，、；：！？]")


def quantity_said(spec: WorldSpec, name: str) -> Quantity | None:
    """The quantity of a claim's quote, opened by the words of its clause right before and behind it; None where it states none."""
    claim, language = spec.claims[name], language_of(spec.prompt)
    found = quantity_in(claim.quote, language)
    if found is None or found.how not in ("written", "about"):
        return found
    try:
        start, end = occurrence(spec.prompt, claim.quote, claim.nth)
    except InputError:
        return found
    taken = []
    for other, c in spec.claims.items():
        if other == name or c.type not in ("quantity", "count"):
            continue
        try:
            taken.append(occurrence(spec.prompt, c.quote, c.nth))
        except InputError:
            continue
    low = max((b for _, b in taken if b <= start), default=0)
    high = min((a for a, _ in taken if a >= end), default=len(spec.prompt))
    before, behind = _CLAUSE.split(spec.prompt[low:start])[-1], _CLAUSE.split(spec.prompt[end:high])[0]
    # What fills the gap up to the next number belongs to that one.
    how = hedge_beside(before, behind if high == len(spec.prompt) or _CLAUSE.search(spec.prompt[end:high]) else "", language)
    return found if how is None else found.opened(how)

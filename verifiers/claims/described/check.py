"""Words that describe (R2, R131): each claim of property, place, time, weather, look or way with a word that a rule exists for has a row.

Colours have rows of their own (`colours.py`), since plates answer them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from typing import TYPE_CHECKING

from ....worlds.described import Word, judged_words
from ...rows.answers import row_of
from . import forms, looks, places, times, ways, weather
from .questions import FORM, LOOK, PLACE, ROUTE, TIME, WEATHER

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ....worlds.spec import ClaimType
    from ...rows.findings import Finding
    from ...rows.questions import Question

__all__ = ["LIT", "check"]

LIT: frozenset[ClaimType] = frozenset(("time", "weather"))
"""Types that the light of a world decides, besides colour."""
_JUDGES: dict[ClaimType, tuple[Question, str, Callable[[Candidate, str, list[Word]], Finding]]] = {
    "property": (FORM, "form", forms.judge),
    "place": (PLACE, "place", places.judge),
    "time": (TIME, "time", times.judge),
    "weather": (WEATHER, "weather", weather.judge),
    "look": (LOOK, "look", looks.judge),
    "route": (ROUTE, "route", ways.judge),
}


def check(candidate: Candidate, types: Collection[ClaimType] | None = None) -> list[Row]:
    """One row per claim with a word that a rule judges.

    Args:
        candidate: what is judged.
        types: of claims; default all.
    """
    spec, rows = candidate.spec, []
    for name, claim in spec.claims.items():
        if claim.type not in _JUDGES or (types is not None and claim.type not in types):
            continue
        question, kind, judge = _JUDGES[claim.type]
        words = [w for w in judged_words(spec, name) if w.kind == kind]
        if words:
            extra = [claim.model_dump(mode="json"), spec.look.model_dump(mode="json") if claim.type in LIT else None]
            rows.append(row_of(candidate, question, (name,), partial(judge, candidate, name, words), extra=extra))
    return rows

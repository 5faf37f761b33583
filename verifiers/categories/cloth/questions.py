"""Questions about cloth: stretch, shape, crossings, tears, pins, ledgers and numbers of every sheet on every written frame."""

from __future__ import annotations

from ...rows.questions import Question
from .bounds import LEAST_AREA, OVER, SLIP

__all__ = ["CATEGORY", "NUMERICAL", "QUESTIONS"]

CATEGORY = (
    Question(
        "category:cloth:stretch",
        "no edge is longer than its length at rest by more than the contract's max_stretch",
        "largest extension of an edge, of the sheet that is nearest to its bound",
        "1",
        "<=",
        "max_stretch of the cloth",
        ("solver",),
    ),
    Question(
        "category:cloth:shape",
        f"no triangle shrinks below {LEAST_AREA:.0%} of its area at rest",
        "least area over that at rest",
        "1",
        ">=",
        "LEAST_AREA",
        ("solver",),
    ),
    Question(
        "category:cloth:self",
        "no edge of a sheet goes through a triangle of a sheet",
        "crossings, over all frames",
        "1",
        "<=",
        "0",
        ("solver",),
    ),
    Question(
        "category:cloth:solids",
        "no sheet goes through a solid",
        "crossings, over all frames",
        "1",
        "<=",
        "0",
        ("solver",),
    ),
    Question(
        "category:cloth:tears",
        "what tore was pulled harder than its strength, and nothing parts without a tear",
        "least tension of a tear over the strength",
        "1",
        ">=",
        "1, less SAME",
        ("solver",),
    ),
    Question(
        "category:cloth:strength",
        f"nothing stays whole that is pulled {OVER:.0%} harder than its strength at two frames in a row",
        "largest tension over the strength",
        "1",
        "<=",
        "1 + OVER",
        ("solver",),
    ),
    Question(
        "category:cloth:pins",
        f"what is held stays within {SLIP:g} m of where its holder takes it",
        "largest slip",
        "m",
        "<=",
        "SLIP",
        ("solver",),
    ),
    Question(
        "category:cloth:mass",
        "mass is area density times area at rest",
        "largest deviation, relative",
        "1",
        "<=",
        "ROUNDING",
        ("solver",),
    ),
    Question(
        "category:cloth:records",
        "recorded momentum and energy are those of the vertices",
        "largest deviation over that which SINGLE and ROUNDING allow",
        "1",
        "<=",
        "1",
        ("solver",),
    ),
    Question(
        "category:cloth:momentum",
        "momentum changes by what gravity, air, holders, solids and other matter gave",
        "momentum without a source",
        "N s",
        "<=",
        "BOOKS and SINGLE of the momentum that passed through the cloth",
        ("solver",),
    ),
    Question(
        "category:cloth:energy",
        "no energy comes from nowhere",
        "energy beyond all work done, as share of the energy in play",
        "1",
        "<=",
        "limits.energy_growth",
        ("solver",),
    ),
)
"""Questions of the category check; `check.py` answers each, in this order."""

NUMERICAL = (
    Question(
        "numerical:cloth_finite",
        "every written number of the cloth is finite",
        "numbers that are not",
        "1",
        "<=",
        "0",
        ("solver",),
    ),
    Question(
        "numerical:cloth_speed",
        "no vertex is faster than limits.max_speed",
        "largest speed",
        "m/s",
        "<=",
        "limits.max_speed",
        ("solver",),
    ),
    Question(
        "numerical:cut",
        "little momentum is lost where ways are cut short so that nothing crosses",
        "momentum lost",
        "N s",
        "<=",
        "CUT of the momentum that passed through the cloth",
        ("solver",),
    ),
)
"""Questions of the numerical check."""

QUESTIONS = (*CATEGORY, *NUMERICAL)

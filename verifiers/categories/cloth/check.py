"""Cloth (R63, R68, R74, R101): stretch, shape, crossings, pins and ledgers of every sheet on every written frame.

Nothing here knows the solver: vertices, what is built and what was recorded are all there is. A question whose evidence is missing is
`unverified`, and the others are judged all the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

from ...rows.findings import Finding, judged
from ...rows.instance_rows import instance_answer
from ..container import rows_about
from .crossing import apart, free_of_itself
from .frames import ClothRun, cloth_run
from .ledger import energy, kept_mass, kept_records, momentum, uncut
from .numerical import finite, slow
from .questions import CATEGORY, NUMERICAL
from .shape import pinned, shaped, stretched
from .start import STARTS
from .tears import held_strength, torn_with_cause

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ...rows.questions import Question

__all__ = ["category_rows", "numerical_rows"]

FUNCTIONS: Mapping[str, Callable[[ClothRun], Finding]] = {
    "category:cloth:stretch": stretched,
    "category:cloth:shape": shaped,
    "category:cloth:self": free_of_itself,
    "category:cloth:solids": apart,
    "category:cloth:tears": torn_with_cause,
    "category:cloth:strength": held_strength,
    "category:cloth:pins": pinned,
    "category:cloth:mass": kept_mass,
    "category:cloth:records": kept_records,
    "category:cloth:momentum": momentum,
    "category:cloth:energy": energy,
    "numerical:cloth_finite": finite,
    "numerical:cloth_speed": slow,
    "numerical:cut": uncut,
}
"""By id of the question."""


def _rows(candidate: Candidate, solver: str, questions: Iterable[Question]) -> list[Row]:
    def ask(function: Callable[[ClothRun], Finding]) -> Finding:
        return function(cloth_run(candidate, solver))

    return [instance_answer(candidate, q, solver, judged(ask, FUNCTIONS[q.id]), members=True) for q in questions]


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """The rows of the category check of one instance."""
    return _rows(candidate, solver, CATEGORY)


def numerical_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of frame 0, of the cache and of its numbers."""
    return rows_about(candidate, solver, STARTS) + _rows(candidate, solver, NUMERICAL)

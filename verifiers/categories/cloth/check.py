"""Cloth (R63, R68, R74, R101): stretch, shape, crossings, pins and ledgers of every sheet on every written frame.

Rows: `category:cloth:<claim>:<solver>`, and `numerical:<claim>:<solver>`. Nothing here knows the solver: vertices, what is built
and what was recorded are all there is. A claim whose evidence is missing is `unverified`, and the others are judged all the same.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from ...rows.findings import Finding, judged
from ...rows.instance_rows import instance_row
from ...scene import initial_state
from ..container import rows_about
from .crossing import apart, free_of_itself
from .frames import ClothRun, cloth_run
from .ledger import energy, kept_mass, kept_records, momentum, uncut
from .numerical import finite, slow
from .shape import pinned, shaped, stretched
from .tears import held_strength, torn_with_cause

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Check, Row

__all__ = ["CLAIMS", "NUMBERS", "category_rows", "numerical_rows"]

Judge = Callable[[ClothRun], Finding]
CLAIMS: dict[str, tuple[str, Judge]] = {
    "stretch": ("no edge is longer than its length at rest by more than the contract's max_stretch", stretched),
    "shape": ("no triangle collapses or grows out of shape", shaped),
    "self": ("no edge of a sheet goes through a triangle of a sheet", free_of_itself),
    "solids": ("no sheet goes through a solid", apart),
    "tears": ("what tore was pulled harder than its strength, and nothing parts without a tear", torn_with_cause),
    "strength": ("nothing stays whole that is pulled harder than its strength", held_strength),
    "pins": ("what is held stays where its holder takes it", pinned),
    "mass": ("mass is area density times area at rest", kept_mass),
    "records": ("recorded momentum and energy are those of the vertices", kept_records),
    "momentum": ("momentum changes by what gravity, air, holders, solids and other matter gave", momentum),
    "energy": ("no energy comes from nowhere", energy),
}
NUMBERS: dict[str, tuple[str, Judge]] = {
    "cloth_finite": ("every written number of the cloth is finite", finite),
    "cloth_speed": ("no vertex is faster than limits.max_speed", slow),
    "cut": ("little momentum is lost where ways are cut short so that nothing crosses", uncut),
}


def _rows(candidate: Candidate, solver: str, claims: dict[str, tuple[str, Judge]], check: Check, family: str) -> list[Row]:
    return [
        instance_row(
            candidate,
            solver,
            name,
            text,
            judged(lambda j=judge: j(cloth_run(candidate, solver))),
            check=check,
            family=family,
        )
        for name, (text, judge) in claims.items()
    ]


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """The rows of the category check of one instance."""
    return _rows(candidate, solver, CLAIMS, "category", "cloth:")


def numerical_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of frame 0, of the cache and of its numbers."""
    first = initial_state.FUNCTIONS["cloth"]
    return rows_about(candidate, solver, first, initial_state.CLAIMS) + _rows(candidate, solver, NUMBERS, "numerical", "")

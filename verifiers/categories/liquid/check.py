"""Liquids (R57, R58, R66-R68, R70, R99, R102, R105): one pass over the frames of an instance, seen by one watch per family of questions.

Rows: `category:liquid:<question>:<solver>` and, of counters, `numerical:<question>:<solver>`. A question whose channels are missing is
`unverified`, and the others are judged all the same. Nothing here knows a solver: particles, their surfaces, what was exchanged
and recorded, and the solids of the candidate are all there is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...rows.findings import judged
from ...rows.instance_rows import instance_answer
from ...rows.watches import Watch, Watching
from ..container import rows_about
from .across import Across, across_finding
from .blown import Blown
from .coupling import Coupling
from .declared import Declared
from .density import Density
from .energy import Energy, Momentum
from .flight import Flight
from .frames import liquid_of
from .leaks import Leaks
from .ledger import Books, Identity
from .motion import Motion, Trapped
from .numerical import Numbers
from .obstacles import obstacles_finding
from .questions import ACROSS, RESOLVED
from .resolved import Resolved
from .start import STARTS
from .sticking import Sticking
from .surface import Shown
from .walls import Walls
from .waves import Waves
from .wet import Wetted

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ...rows.findings import Finding
    from ...rows.questions import Question

__all__ = ["DECLARED", "WATCHES", "category_rows", "declared_rows", "findings_of", "numerical_rows"]

WATCHES: tuple[type[Watch], ...] = (
    *(
        Numbers,
        Books,
        Identity,
        Energy,
        Momentum,
        Walls,
        Leaks,
        Motion,
        Flight,
        Trapped,
        Sticking,
        Resolved,
        Across,
        Density,
        Coupling,
        Shown,
        Waves,
        Blown,
        Wetted,
    ),
)
"""All families, in the order of their rows."""
DECLARED: Mapping[Question, Callable[[Declared], Finding]] = {
    ACROSS["across"]: across_finding,
    RESOLVED["obstacles"]: obstacles_finding,
}
"""Questions that what is declared decides at frame 0, by the functions that answer them."""


_WATCHING = Watching(WATCHES, Numbers, liquid_of, lambda liquid: ((step,) for step in liquid.steps()))
findings_of = _WATCHING.findings_of
category_rows = _WATCHING.category_rows


def declared_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of one instance that what is declared decides, before anything is simulated."""
    return [
        instance_answer(candidate, question, solver, judged(ask, Declared(candidate, solver)), members=True)
        for question, ask in DECLARED.items()
    ]


def numerical_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of frame 0, of the cache and of counters of one instance."""
    return [*rows_about(candidate, solver, STARTS), *_WATCHING.numerical_rows(candidate, solver)]

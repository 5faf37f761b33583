"""Liquids (R57, R58, R66-R68, R70, R99, R102, R105): one pass over the frames of an instance, seen by one watch per family of claims.

Rows: `category:liquid:<claim>:<solver>` and, of counters, `numerical:<claim>:<solver>`. A claim whose channels are missing is
`unverified`, and the others are judged all the same. Nothing here knows a solver: particles, their surfaces, what was exchanged
and recorded, and the solids of the candidate are all there is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..worlds.errors import EvidenceError
from .findings import Finding
from .instance_rows import instance_row
from .liquid_blown import Blown
from .liquid_coupling import Coupling
from .liquid_density import Density
from .liquid_energy import Energy, Momentum
from .liquid_flight import Flight
from .liquid_frames import liquid_of
from .liquid_leaks import Leaks
from .liquid_ledger import Books, Identity
from .liquid_motion import Motion, Trapped
from .liquid_numerical import Numbers
from .liquid_resolved import Resolved
from .liquid_rows import Watch
from .liquid_sticking import Sticking
from .liquid_surface import Shown
from .liquid_walls import Walls
from .liquid_waves import Waves
from .liquid_wet import Wetted

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.requirements import Row

__all__ = ["WATCHES", "check_instance", "findings_of", "numerical_rows"]

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
        Density,
        Coupling,
        Shown,
        Waves,
        Blown,
        Wetted,
    ),
)
"""All families, in the order of their rows."""


def findings_of(candidate: Candidate, solver: str) -> dict[str, dict[str, tuple[str, Finding]]]:
    """Predicate and verdict of every claim by watch; worked out once per candidate."""
    store: dict[str, dict[str, dict[str, tuple[str, Finding]]]] = vars(candidate).setdefault("_liquid_findings", {})
    if solver not in store:
        store[solver] = _run(candidate, solver)
    return store[solver]


def _run(candidate: Candidate, solver: str) -> dict[str, dict[str, tuple[str, Finding]]]:
    watches: dict[type[Watch], Watch] = {}
    failed: dict[type[Watch], str] = {}
    try:
        liquid = liquid_of(candidate, solver)
        for kind in WATCHES:
            try:
                watches[kind] = kind(liquid)
            except EvidenceError as error:
                failed[kind] = str(error)
        for step in liquid.steps():
            for kind, watch in watches.items():
                if kind not in failed:
                    try:
                        watch.see(step)
                    except EvidenceError as error:
                        failed[kind] = str(error)
    except EvidenceError as error:
        failed = {kind: failed.get(kind, str(error)) for kind in WATCHES}
    found = {}
    for kind in WATCHES:
        try:
            if kind in failed:
                raise EvidenceError(failed[kind])
            verdicts = watches[kind].findings()
        except EvidenceError as error:
            verdicts = {name: Finding("unverified", str(error)) for name in kind.claims}
        found[kind.__name__] = {name: (claim, verdicts[name]) for name, claim in kind.claims.items()}
    return found


def check_instance(candidate: Candidate, solver: str) -> list[Row]:
    """The rows of the category check of one instance."""
    found = findings_of(candidate, solver)
    return [
        instance_row(candidate, solver, name, claim, finding)
        for kind in WATCHES
        if kind is not Numbers
        for name, (claim, finding) in found[kind.__name__].items()
    ]


def numerical_rows(candidate: Candidate, solver: str) -> list[Row]:
    """The rows of its counters."""
    return [
        instance_row(candidate, solver, name, claim, finding, check="numerical", family="")
        for name, (claim, finding) in findings_of(candidate, solver)[Numbers.__name__].items()
    ]

"""The list of checks and the stages at which each one can judge. One module per check, joined here explicitly."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from ..worlds.candidate import Candidate, Stage
from ..worlds.requirements import Row, fail_closed
from ..worlds.spec import WorldSpec
from . import (
    beats,
    category,
    causal,
    contact,
    counterfactual,
    delivery,
    interpenetration,
    navigability,
    numerical,
    phases,
    relations,
    robustness,
    scale,
    shots,
    support,
    terrain,
)
from .diagnosis import diagnose

__all__ = ["CHECKS", "CheckBinding", "names_of", "rerun_ids", "run_checks"]


@dataclass(frozen=True)
class CheckBinding:
    """One check: its name in rows, the function, and where it can judge."""

    name: str
    function: Callable[[Candidate], list[Row]]
    stages: tuple[Stage, ...]
    reruns: Callable[[WorldSpec], frozenset[str]] | None = None
    """Ids of its rows, where the check simulates the world again: such a one judges at the probe, and in acceptance."""


CHECKS: tuple[CheckBinding, ...] = (
    CheckBinding("terrain", terrain.check, ("static", "full")),
    CheckBinding("scale", scale.check, ("static", "full")),
    CheckBinding("interpenetration", interpenetration.check, ("static", "full")),
    CheckBinding("relations", relations.check, ("static", "probe", "full")),
    CheckBinding("support", support.check, ("static", "probe", "full")),
    CheckBinding("navigability", navigability.check, ("static", "full")),
    CheckBinding("shots", shots.check, ("static", "probe", "full")),
    CheckBinding("numerical", numerical.check, ("probe", "full")),
    CheckBinding("contact", contact.check, ("probe", "full")),
    CheckBinding("category", category.check, ("probe", "full")),
    CheckBinding("beat", beats.check, ("probe", "full")),
    CheckBinding("beat", phases.check, ("probe",)),
    CheckBinding("causal", causal.check, ("probe", "full")),
    CheckBinding("delivery", delivery.check, ("full",)),
    CheckBinding("causal", counterfactual.check, ("probe", "full"), counterfactual.row_ids),
    CheckBinding("robustness", robustness.check, ("probe", "full"), robustness.row_ids),
)


def names_of(stage: Stage) -> tuple[str, ...]:
    """Names of the checks that judge at a stage."""
    return tuple(dict.fromkeys(c.name for c in CHECKS if stage in c.stages))


def rerun_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that take simulations: a bake of the probed settings leaves those of its probe as they are."""
    return frozenset().union(*(c.reruns(spec) for c in CHECKS if c.reruns is not None))


def run_checks(
    candidate: Candidate,
    *,
    only: Iterable[str] | None = None,
    reruns: bool | None = None,
    progress: Callable[[int, int, str], None] | None = None,
) -> list[Row]:
    """Run every check that judges at the candidate's stage.

    Args:
        candidate: what is judged.
        only: names of checks; default all.
        reruns: whether to simulate variants of the world for the checks that need them; default at the probe only.
        progress: called with (done, total, message) before each check.
    """
    wanted = None if only is None else set(only)
    again = candidate.stage == "probe" if reruns is None else reruns
    chosen = [
        c for c in CHECKS if candidate.stage in c.stages and (wanted is None or c.name in wanted) and (again or c.reruns is None)
    ]
    rows: list[Row] = []
    for done, binding in enumerate(chosen):
        if progress is not None:
            progress(done, len(chosen), f"checking {binding.name}")
        rows += [diagnose(fail_closed(r), candidate.spec) for r in binding.function(candidate)]
    return rows

"""The list of checks and the stages at which each one can judge. One module per check, joined here explicitly."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass

from ..execution import Part, Tell, one_core, seldom_collected
from ..worlds.ablation import ablation, switched_off
from ..worlds.candidate import Candidate, Stage
from ..worlds.requirements import Check, Row, fail_closed
from ..worlds.spec import WorldSpec
from .beside import Beside, ahead, worth_while
from .categories import check as category
from .claims import check as claims
from .claims.described import check as described
from .claims.described import colours
from .contact import check as contact
from .delivery import check as delivery
from .diagnosis.cite import diagnose
from .land import terrain
from .routes import navigability
from .rows.corrections import without_again
from .rows.seen import only_seen, unmended_till_seen
from .rows.telling import telling
from .scene import interpenetration, relations, scale
from .shots import check as shots
from .shots import seen
from .story import beats, causal, counterfactual, phases, robustness, untold
from .support import check as support
from .things import joints, shapes, sizes

__all__ = [
    "CHECKS",
    "CheckBinding",
    "diagnosed",
    "judging_share",
    "lit_rows",
    "names_of",
    "plate_ids",
    "rerun_ids",
    "run_checks",
    "second_ahead",
    "silent",
]

CHECK_WORK = 0.03
"""Work of a check that simulates nothing, in simulations of the probe; own choice, for progress alone."""
RERUN_WORK = 0.3
"""Work of a row whose check simulates the world again: from the middle on, mostly, and not all instances."""
MOST_WORK = 4.0
"""Judging counts as no more, so that a simulation before it is seen to go on."""


@dataclass(frozen=True)
class CheckBinding:
    """One check: its name in rows, the function, and where it can judge."""

    name: Check
    function: Callable[..., list[Row]]
    """Takes a candidate; one that reruns also takes `progress` and the id of a row that keeps it from simulating, or None."""
    stages: tuple[Stage, ...]
    reruns: Callable[[WorldSpec], frozenset[str]] | None = None
    """Ids of its rows, where the check simulates the world again: such a one judges at the probe, and in acceptance."""
    only: frozenset[str] = frozenset()
    """Ids of the questions that it answers, where those are not all of its check."""
    plates: bool = False
    """True if it reads plates: such a one judges where some were made, and in acceptance."""
    beside: bool = False
    """True if it shares little work with the others: a second process judges it of a large world at the static stage."""


CHECKS: tuple[CheckBinding, ...] = (
    CheckBinding("terrain", terrain.check, ("static", "full")),
    CheckBinding("scale", scale.check, ("static", "full"), beside=True),
    CheckBinding("scale", sizes.check, ("static", "full"), beside=True),
    CheckBinding("scale", shapes.check, ("static", "full"), beside=True),
    CheckBinding("interpenetration", interpenetration.check, ("static", "full")),
    CheckBinding("relations", relations.check, ("static", "probe", "full")),
    CheckBinding("support", support.check, ("static", "probe", "full")),
    CheckBinding("navigability", navigability.check, ("static", "full"), beside=True),
    CheckBinding("navigability", joints.check, ("static", "full")),
    CheckBinding("category", category.check_declared, ("static",), only=category.declared_questions()),
    CheckBinding("shots", shots.check, ("static", "probe", "full")),
    CheckBinding("shots", seen.check, ("full",), plates=True),
    CheckBinding("numerical", category.check_numerical, ("probe", "full")),
    CheckBinding("contact", contact.check, ("probe", "full")),
    CheckBinding("category", category.check, ("probe", "full")),
    CheckBinding("beat", beats.check, ("probe", "full")),
    CheckBinding("beat", phases.check, ("probe",)),
    CheckBinding("causal", causal.check, ("probe", "full")),
    CheckBinding("claim", claims.check, ("probe", "full")),
    CheckBinding("claim", colours.check, ("full",), plates=True),
    CheckBinding("delivery", delivery.check, ("full",)),
    CheckBinding("causal", counterfactual.check, ("probe", "full"), counterfactual.row_ids),
    CheckBinding("causal", untold.check, ("probe", "full"), untold.row_ids),
    CheckBinding("robustness", robustness.check, ("probe", "full"), robustness.row_ids),
)


LOADED = ("worldagent.verifiers.routes.column_kernels", "worldagent.verifiers.routes.way_kernels", "scipy.sparse.csgraph")
"""Modules that the checks beside load as they come to them; a process that has time loads them before."""


def plate_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that plates answer."""
    return seen.seen_ids(spec) | colours.colour_ids(spec)


def lit_rows(candidate: Candidate) -> list[Row]:
    """Rows that the look of a world decides, plates read."""
    found = [*seen.check(candidate), *colours.check(candidate), *described.check(candidate, described.LIT)]
    return diagnosed(candidate, found)


def names_of(stage: Stage) -> tuple[str, ...]:
    """Names of the checks that judge at a stage."""
    return tuple(dict.fromkeys(c.name for c in CHECKS if stage in c.stages))


def rerun_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that take simulations: a bake of the probed settings leaves those of its probe as they are."""
    return frozenset().union(*(c.reruns(spec) for c in CHECKS if c.reruns is not None))


def _chosen(
    stage: Stage, only: Iterable[str] | None = None, reruns: bool | None = None, plates: bool = False
) -> list[CheckBinding]:
    wanted = None if only is None else set(only)
    again = stage == "probe" if reruns is None else reruns
    able = [c for c in CHECKS if (again or c.reruns is None) and (plates or not c.plates)]
    return [c for c in able if stage in c.stages and (wanted is None or c.name in wanted)]


def _work(spec: WorldSpec, chosen: Iterable[CheckBinding]) -> list[float]:
    """Work of each check, in simulations of the whole."""
    return [CHECK_WORK if c.reruns is None else RERUN_WORK * len(c.reruns(spec)) for c in chosen]


def judging_share(spec: WorldSpec, stage: Stage, *, reruns: bool | None = None) -> float:
    """Share of a job that judging takes, beside one simulation of all that is judged, in (0, 1)."""
    work = min(MOST_WORK, sum(_work(spec, _chosen(stage, reruns=reruns))))
    return work / (1.0 + work)


def run_checks(
    candidate: Candidate,
    *,
    only: Iterable[str] | None = None,
    reruns: bool | None = None,
    plates: bool | None = None,
    progress: Tell | None = None,
    seconds: dict[str, float] | None = None,
    second: Beside | None = None,
) -> list[Row]:
    """Run every check that judges at the candidate's stage.

    Args:
        candidate: what is judged.
        only: names of checks; default all.
        reruns: whether to simulate variants of the world for the checks that need them; default at the probe only.
        plates: whether to judge by plates; default where some were made of this bake.
        progress: told before each check, and from within those that simulate.
        seconds: gets the time that the others took, as `judged`.
        second: process that may judge some of them, from `second_ahead`; default one of its own where that is worth while.
    """
    chosen = _chosen(candidate.stage, only, reruns, seen.taken(candidate) if plates is None else plates)
    at_once = (seldom_collected(), one_core()) if candidate.stage == "static" else ()
    with ExitStack() as held:
        for one in at_once:
            held.enter_context(one)
        helper = held.enter_context(_asked(candidate, chosen, second))
        return _judged(candidate, chosen, helper, progress, seconds)


def second_ahead(spec: WorldSpec) -> Beside | nullcontext[None]:
    """A process for `run_checks` at the static stage that gets ready while the entities are still built; None for small worlds."""
    modules = {c.function.__module__ for c in CHECKS if c.beside} | set(LOADED)
    return ahead(len(spec.entities), modules)


def _asked(candidate: Candidate, chosen: list[CheckBinding], second: Beside | None) -> Beside | nullcontext[None]:
    """A process that judges those of the checks that may stand beside the others, where that is worth while."""
    apart = {CHECKS.index(c): c.function for c in chosen if c.beside and not switched_off(c.name)}
    if not apart or len(apart) == len(chosen) or not worth_while(candidate):
        return nullcontext()
    return (Beside() if second is None else second).ask(candidate, apart)


def _judged(
    candidate: Candidate,
    chosen: list[CheckBinding],
    second: Beside | None,
    progress: Tell | None,
    seconds: dict[str, float] | None,
) -> list[Row]:
    """Rows of checks in their order, those of a second process as it has made them."""
    found_by: dict[int, list[Row]] = {}
    work, took = _work(candidate.spec, chosen), 0.0
    # What a second process judges is fetched last, so that both work meanwhile.
    order = sorted(range(len(chosen)), key=lambda k: second is not None and CHECKS.index(chosen[k]) in second.checks)
    for done, k in enumerate(order):
        binding, rows = chosen[k], [r for i in sorted(found_by) for r in found_by[i]]
        whole, began = max(sum(work), CHECK_WORK), time.monotonic()
        told = Part(
            progress or silent, sum(work[i] for i in order[:done]) / whole, sum(work[i] for i in order[: done + 1]) / whole
        )
        told(0, 1, f"checking {binding.name}")
        if second is not None and CHECKS.index(binding) in second.checks:
            found = second.rows[CHECKS.index(binding)]
        elif binding.reruns is None:
            with telling(told, f"checking {binding.name}"):
                found = binding.function(candidate)
        else:
            found = binding.function(candidate, told, _keeps(binding, rows))
        found_by[k] = diagnosed(candidate, found)
        took += time.monotonic() - began if binding.reruns is None else 0.0
    if seconds is not None:
        seconds["judged"] = took
    return [r for k in sorted(found_by) for r in found_by[k]]


def diagnosed(candidate: Candidate, rows: Iterable[Row]) -> list[Row]:
    """Rows of one check as the matrix has them: no pass over frames that are not there, and what past cases say of each that can help."""
    told = (without_again(candidate, diagnose(only_seen(candidate, fail_closed(r)), candidate.spec)) for r in rows)
    return [unmended_till_seen(candidate, r) for r in told]


def _keeps(binding: CheckBinding, rows: Iterable[Row]) -> str | None:
    """The reason for which a check does not simulate: the first failure, or an evaluation that leaves it out."""
    return f"ablation:{ablation()}" if switched_off(binding.name) else _first_failure(rows)


def _first_failure(rows: Iterable[Row]) -> str | None:
    """The first mandatory row that fails, of those that pictures have no part in: most that mends it makes another motion, so that
    runs of this one's variants would be for nothing."""
    return next((r.id for r in rows if r.mandatory and r.status == "fail" and r.check != "shots"), None)


def silent(done: float, total: float, message: str, ends: float | None = None) -> None:
    """Tell nobody."""

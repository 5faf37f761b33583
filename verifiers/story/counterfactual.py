"""Counterfactual causality: take the cause away, let the world go on, and the effect must not come (R97, R156, S8).

Row `causal:without:<cause>:<effect>`: the world is continued from just before the onset of the cause, with the cause prevented
(`story/interventions.py`), up to the end of the effect's interval. The effect must vanish, or change by the margin that the effect
declares for this cause (`story/without_cause.py`). An intervention counts only if the cause's own predicate then stays false.
Of a compound effect every body must do its part no more in the run without one of the
causes, where no margin is declared. Coincident independent events fail: each comes without the other. An effect that is true in a run without its cause is vacuous.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from ...worlds.errors import EvidenceError
from ..predicates.evaluators import evaluate
from ..predicates.times import last_needed
from ..rows.corrections import postponed
from ..rows.findings import Finding, judged
from .bodies import deeds_of, standing_atoms
from .causal_corrections import not_prevented, other_body_hints
from .edges import edges_of
from .interventions import FollowsError, preventions
from .questions import WITHOUT
from .reruns import Rerun, rerun
from .without_cause import compare

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import SpecModel, WorldSpec
    from .edges import Edge
    from .interventions import Prevention

__all__ = ["check", "row_ids"]

Progress = Callable[[float, float, str], None]


def row_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that this check gives for a specification."""
    beats = spec.story.beats
    return frozenset(WITHOUT.row_id((c, e)) for e, beat in beats.items() for c in beat.causes if c in beats)


def check(candidate: Candidate, progress: Progress | None = None, failing: str | None = None) -> list[Row]:
    """One row per declared cause of every beat; runs that serve several effects are made once.

    Args:
        candidate: what is judged.
        progress: called with (rows done, rows planned, message), also from within a run.
        failing: id of a row that fails; then nothing is simulated, and every row follows from that one.
    """
    edges = [edge for edge in edges_of(candidate) if edge.known]
    if failing is not None:
        return [_row(e, Finding("unverified", postponed(failing), evidence={"follows": failing})) for e in edges]
    variants = _Variants(candidate, edges, progress)
    return [_row(edge, partial(variants.judge, edge)) for edge in edges]


def _row(edge: Edge, found: Finding | Callable[[], Finding]) -> Row:
    """The row of one edge; its words name the margin that the effect declares."""
    found = found if isinstance(found, Finding) else judged(found)
    if (margin := edge.effect.margins.get(edge.cause_id)) is not None:
        asked = f"does not come, or {margin.model_dump(exclude_none=True)} apart"
        found = replace(found, predicate=f"without {edge.cause_id}, {edge.effect_id} {asked}")
    return edge.row(WITHOUT, found)


class _Variants:
    """Runs of one candidate in which causes are prevented."""

    def __init__(self, candidate: Candidate, edges: list[Edge], progress: Progress | None) -> None:
        self.candidate = candidate
        self._edges, self._progress, self._begun = edges, progress, -1
        self._ways: dict[Edge, list[Prevention] | EvidenceError] = {}
        self._ends: dict[Prevention, int] = {}
        self._runs: dict[Prevention, Rerun | EvidenceError] = {}
        for edge in edges:
            try:
                ways = self._ways[edge] = preventions(edge)
            except EvidenceError as error:
                self._ways[edge] = error
                continue
            end = min(candidate.last_frame, last_needed(candidate.spec, (edge.cause_id, edge.effect_id)))
            self._ends |= {way: max(end, self._ends.get(way, 0)) for way in ways}

    def judge(self, edge: Edge) -> Finding:
        """Judge whether the effect vanishes or changes without its cause.

        Raises:
            EvidenceError: the cause cannot be prevented, or the run not be repeated.
        """
        self._begun += 1
        self._tell(0, 1, f"{self._begun + 1} of {len(self._edges)}")
        try:
            return self._judged(edge)
        except FollowsError as error:
            return Finding("unverified", str(error), evidence={"follows": error.row})

    def _judged(self, edge: Edge) -> Finding:
        if isinstance(ways := self._ways[edge], EvidenceError):
            raise ways
        _, effect = edge.outcomes
        if effect.status != "pass" or effect.first_true_frame is None:
            text = f"{edge.effect_id} did not come true, so nothing can vanish: {effect.explanation}"
            raise FollowsError(self.candidate, edge.effect_id, text)
        way, variant, failed = self._absent(edge)
        if way is not None and variant is not None:
            found = compare(edge, way, variant.candidate)
            found = (self._bodies_anyway(edge) if found.status == "pass" and not edge.effect.margins else None) or found
            told = {"intervention": way.text, "not_enough": failed, "from_frame": way.start, **variant.cost()}
            return replace(found, evidence={**told, **(found.evidence or {})})
        text = (
            f"nothing that this build can do prevents {edge.cause_id} ({'; '.join(failed) or 'no body of it moves'}), so that its absence tells "
            "nothing: state the cause as an event of a moving body, which is not so while that body is held"
        )
        missing = {"missing": text, "not_enough": failed}
        return Finding("unverified", f"no evidence: {text}", hints=not_prevented(edge), evidence=missing)

    def _absent(self, edge: Edge) -> tuple[Prevention | None, Rerun | None, list[str]]:
        """The first way that prevents the cause of an edge, its run, and the ways before it that do not; None where none does.

        Raises:
            EvidenceError: the cause did not come true, a run cannot be made, or nobody can tell whether the cause came in it.
        """
        ways, failed = self._ways[edge], list[str]()
        if isinstance(ways, EvidenceError):
            raise ways
        for way in ways:
            variant = self._run(way)
            first, last = edge.cause.frames
            removed = evaluate(variant.candidate, edge.cause.predicate, (first, min(last, variant.candidate.last_frame)))
            if removed.status == "unverified":
                raise EvidenceError(f"cannot tell whether {edge.cause_id} was prevented: {removed.explanation}")
            if removed.status == "fail":
                return way, variant, failed
            failed.append(way.text)
        return None, None, failed

    def _bodies_anyway(self, edge: Edge) -> Finding | None:
        """The failure of a compound effect of which a body does its part without any of the causes; None where each needs one.

        Raises:
            EvidenceError: a body does its part without this cause, and no run tells whether it needs another one.
        """
        deeds = deeds_of(self.candidate, edge.effect)
        if not deeds:
            return None
        runs = [self._absent(other)[1] for other in self._edges if other.effect_id == edge.effect_id]

        def needs(_: str, atom: SpecModel) -> bool:
            return any(r is not None and evaluate(r.candidate, atom, edge.effect.frames).status == "fail" for r in runs)

        # What stops because it is held in the air stops anyway; that it rests on the table is the part of it that needs the cause.
        idle = [
            body
            for body in dict.fromkeys(body for part in deeds for body in part.lacking(needs))
            if not any(needs(body, atom) for atom in standing_atoms(edge.effect.predicate, body))
        ]
        if not idle:
            return None
        first, causes = idle[0], ", ".join(edge.effect.causes)
        text = f"without {edge.cause_id} {edge.effect_id} does not come, but {', '.join(idle)} does its part of it in every run without one of {causes}"
        hints, told = other_body_hints(edge, first), {"anyway": idle}
        return Finding("fail", text, float(len(idle)), 0.0, "1", first, hints=hints, evidence=told, comparison="<=")

    def _run(self, way: Prevention) -> Rerun:
        if way not in self._runs:
            try:
                self._runs[way] = rerun(self.candidate, way.done, way.start, self._ends[way], self._tell)
            except EvidenceError as error:
                self._runs[way] = error
        found = self._runs[way]
        if isinstance(found, EvidenceError):
            raise found
        return found

    def _tell(self, done: int, total: int, message: str) -> None:
        if self._progress is not None:
            edge, planned = self._edges[self._begun], len(self._edges)
            text = f"checking causal: {edge.effect_id} without {edge.cause_id}, {message}"
            self._progress(self._begun + done / max(total, 1), planned, text)

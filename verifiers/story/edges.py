"""Cause and effect: a beat of the story, one of its declared causes, and the rows about the two."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..predicates.evaluators import beat_times
from ..predicates.outcome import Outcome
from ..rows.answers import row_of
from ..rows.findings import Finding, judged
from .chains import chains_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import Beat
    from ..rows.questions import Question
    from .chains import Chains

__all__ = ["Edge", "edges_of"]


@dataclass(frozen=True, eq=False)
class Edge:
    """A declared cause of a beat."""

    candidate: Candidate
    cause_id: str
    """A beat of the story; it may be missing there."""
    effect_id: str
    body: str = ""
    """The body of a compound effect that is asked about; empty for its subject."""

    @property
    def known(self) -> bool:
        """True if the cause is a beat of the story."""
        return self.cause_id in self.candidate.spec.story.beats

    @property
    def cause(self) -> Beat:
        """The beat that is declared as the cause."""
        return self.candidate.spec.story.beats[self.cause_id]

    @property
    def effect(self) -> Beat:
        """The beat that declares it."""
        return self.candidate.spec.story.beats[self.effect_id]

    @property
    def subject(self) -> str:
        """The effect's entity: its subject, or the body of it that is asked about."""
        return self.body or self.effect.subject

    @property
    def driven(self) -> bool:
        """True if a driver owns the cause."""
        return self.cause.owner in self.candidate.spec.simulation.drivers

    @property
    def outcomes(self) -> tuple[Outcome, Outcome]:
        """Outcomes of cause and effect over their own frames."""
        times = beat_times(self.candidate)
        return times.outcome(self.cause_id), times.outcome(self.effect_id)

    @property
    def chains(self) -> Chains:
        """Links and motion of the candidate, prepared once.

        Raises:
            EvidenceError: a contact or event channel is missing.
        """
        return chains_of(self.candidate)

    def row(self, question: Question, found: Finding | Callable[[], Finding]) -> Row:
        """The row that answers a question about the two."""
        found = found if isinstance(found, Finding) else judged(found)
        beats = [self.cause, self.effect] if self.known else [self.effect]
        evidence = {"pointers": [f"/story/beats/{self.effect_id}/causes"], **(found.evidence or {})}
        return row_of(
            self.candidate,
            replace(question, mandatory=self.effect.mandatory),
            (self.cause_id, self.effect_id),
            replace(found, evidence=evidence),
            entities=[b.subject for b in beats],
            extra=[b.model_dump(mode="json") for b in beats],
        )


def edges_of(candidate: Candidate) -> list[Edge]:
    """Every declared cause of every beat, by effect."""
    return [Edge(candidate, cause, effect) for effect, beat in candidate.spec.story.beats.items() for cause in beat.causes]

"""One pass over the frames of an instance, seen by one watch per family of questions, and the rows that these become.

A question whose evidence is missing is `unverified`, and the others are judged all the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from ...worlds.errors import EvidenceError
from .findings import Finding
from .instance_rows import instance_answer
from .telling import tell

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row, Status
    from .questions import Question

__all__ = ["Watch", "Watching"]

Verdicts = dict[str, dict[str, tuple["Question", Finding]]]
"""Each question with its finding, by watch and name of the question."""


class Watch(Protocol):
    """One family of questions: made from what is watched, its method `see` takes each frame in order, then it says what it found.

    Whatever the evidence for its questions lacks is told by an EvidenceError.
    """

    questions: ClassVar[Mapping[str, Question]]
    """Questions by name; a name is the second last part of a row's id."""

    def findings(self) -> dict[str, Finding]:
        """Finding on every question by name, after the last frame.

        Raises:
            EvidenceError: there is nothing to judge them by.
        """


def _unread(kind: type[Any], name: str, error: EvidenceError) -> Status:
    return "unverified"


@dataclass(frozen=True)
class Watching:
    """Watches over the instances of one category."""

    kinds: tuple[type[Any], ...]
    """All watches, in the order of their rows; each is made from what `opened` gives."""
    numbers: type[Any]
    """The one whose questions are rows of the numerical check."""
    opened: Callable[[Candidate, str], Any]
    """Function that opens the evidence of an instance."""
    frames: Callable[[Any], Iterable[tuple[Any, ...]]]
    """Function that gives the arguments of a watch's `see`, frame by frame, from what `opened` gives."""
    unread: Callable[[type[Any], str, EvidenceError], Status] = _unread
    """Status of a watch's question that an error kept from being judged."""

    def findings_of(self, candidate: Candidate, solver: str) -> Verdicts:
        """Each question with its finding, by watch and name of the question; worked out once per candidate."""
        return candidate.memo((self.numbers, solver), lambda: self._run(candidate, solver))

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """The rows of the category check of one instance."""
        return [
            instance_answer(candidate, question, solver, finding, members=True)
            for kind, verdicts in self.findings_of(candidate, solver).items()
            if kind != self.numbers.__name__
            for question, finding in verdicts.values()
        ]

    def numerical_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """The rows of its counters."""
        verdicts = self.findings_of(candidate, solver)[self.numbers.__name__]
        return [instance_answer(candidate, question, solver, finding, members=True) for question, finding in verdicts.values()]

    def _run(self, candidate: Candidate, solver: str) -> Verdicts:
        watches: dict[type[Any], Any] = {}
        failed: dict[type[Any], EvidenceError] = {}
        try:
            whole = self.opened(candidate, solver)
            for kind in self.kinds:
                try:
                    watches[kind] = kind(whole)
                except EvidenceError as error:
                    failed[kind] = error
            for number, seen in enumerate(self.frames(whole), 1):
                tell(f"{solver}: frame", number, candidate.frame_count)
                for kind, watch in watches.items():
                    if kind not in failed:
                        try:
                            watch.see(*seen)
                        except EvidenceError as error:
                            failed[kind] = error
        except EvidenceError as error:
            failed = {kind: failed.get(kind, error) for kind in self.kinds}
        return {kind.__name__: self._verdicts(kind, watches.get(kind), failed.get(kind)) for kind in self.kinds}

    def _verdicts(self, kind: type[Any], watch: Watch | None, error: EvidenceError | None) -> dict[str, tuple[Question, Finding]]:
        try:
            if watch is None or error is not None:
                raise error or EvidenceError("it was not watched")
            found = watch.findings()
        except EvidenceError as missing:
            found = {name: Finding(self.unread(kind, name, missing), str(missing)) for name in kind.questions}
        return {name: (question, found[name]) for name, question in kind.questions.items()}

"""Scope of one evaluation: the candidate, the interval, the other beats, and how a nested predicate is judged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from ...worlds.spec import SpecModel
from .outcome import Outcome

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Beats", "Evaluator", "Scope"]


class Beats(Protocol):
    """First true frames of the story's beats."""

    def outcome(self, beat: str) -> Outcome:
        """The beat's own outcome over its own frames."""
        ...


@dataclass(frozen=True)
class Scope:
    """One evaluation."""

    candidate: Candidate
    frames: tuple[int, int]
    beats: Beats
    nested: Callable[[SpecModel, tuple[int, int]], Outcome]
    """Judges another predicate over other frames."""

    @property
    def window(self) -> slice:
        """The interval as an index into series over all frames."""
        return slice(self.frames[0], self.frames[1] + 1)

    @property
    def length(self) -> int:
        """Number of frames in the interval."""
        return self.frames[1] - self.frames[0] + 1

    def judge(self, predicate: SpecModel, frames: tuple[int, int] | None = None) -> Outcome:
        """Outcome of a nested predicate, over this interval unless told."""
        return self.nested(predicate, frames or self.frames)


Evaluator = Callable[[Scope, Any], Outcome]
"""Takes a scope and the model of its kind of predicate."""

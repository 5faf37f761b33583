"""When each beat of the story first came true: evaluated on demand, once per candidate, safe against cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.references import references
from .outcome import Outcome, missing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ...worlds.candidate import Candidate
    from ...worlds.spec import SpecModel, WorldSpec
    from .scope import Beats

__all__ = ["BeatTimes", "last_needed"]


class BeatTimes:
    """Outcomes of the story's beats over their own frames.

    Beats whose predicates refer to each other in a circle have no first true frame: `unverified`.
    """

    def __init__(self, candidate: Candidate, evaluate: Callable[[Candidate, SpecModel, tuple[int, int], Beats], Outcome]) -> None:
        self._candidate = candidate
        self._evaluate = evaluate
        self._known: dict[str, Outcome] = {}
        self._open: list[str] = []

    def outcome(self, beat: str) -> Outcome:
        """The beat's outcome over its frames."""
        if beat in self._known:
            return self._known[beat]
        declared = self._candidate.spec.story.beats.get(beat)
        if declared is None:
            return missing((0, self._candidate.last_frame), "1", f"beat {beat!r} is not in the story")
        if beat in self._open:
            circle = " -> ".join([*self._open[self._open.index(beat) :], beat])
            return missing(
                declared.frames, "frame", f"beats refer to each other in a circle: {circle}; drop one before/after/within"
            )
        self._open.append(beat)
        try:
            outcome = self._evaluate(self._candidate, declared.predicate, declared.frames, self)
        finally:
            self._open.pop()
        self._known[beat] = outcome
        return outcome

    def first(self, beat: str) -> int | None:
        """First frame at which the beat is true; None when it never is or cannot be judged."""
        return self.outcome(beat).first_true_frame


def last_needed(spec: WorldSpec, beats: Iterable[str]) -> int:
    """Last frame that the beats, and those that their predicates refer to, are judged by."""
    todo, known = [b for b in beats if b in spec.story.beats], set[str]()
    while todo:
        name = todo.pop()
        known.add(name)
        named = [v for _, target, v in references(spec.story.beats[name].predicate, "") if target == "beat"]
        todo += [v for v in named if v in spec.story.beats and v not in known]
    return min(spec.simulation.frames - 1, max((spec.story.beats[b].frames[1] for b in known), default=0))

"""The questions that a judge is asked about a film: texts and frames of every question, known before any is put (R145-R147, R150, R151).

Neither the text nor a picture tells who made the film: questions are made of the prompt's own words, and frames carry no names.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..prompts.reading import BenchPrompt
from .rubrics import Rubric, rubrics
from .selection import Window, causal_links, causal_stages, composition_windows, production_windows, shot_segments

__all__ = ["JUDGED", "Question", "questions_of"]

JUDGED = ("caus", "qual", "comp", "prod")
"""Metrics that a judge gives."""


@dataclass(frozen=True)
class Question:
    """One question with the frames that are shown beside it."""

    kind: str
    """Name of its rubric."""
    about: str
    """Beat, pair of beats, question of the prompt, or nothing."""
    window: Window
    text: str

    @property
    def key(self) -> str:
        """Short name, unique within a metric and a film."""
        return f"{self.kind}:{self.about}:{self.window.part}:{self.window.frames[0]}"

    @property
    def rubric(self) -> Rubric:
        """The rubric that says what answers it."""
        found: Rubric = getattr(rubrics(), self.kind)
        return found


def _question(kind: str, about: str, window: Window, count: int, fps: float, **words: str) -> Question:
    known = rubrics()
    times = ", ".join(f"{k / fps:.2f}" for k in window.frames)
    sampled = known.sampled.format(seconds=count / fps, count=len(window.frames), times=times)
    rubric: Rubric = getattr(known, kind)
    return Question(kind, about, window, f"{sampled}\n{rubric.ask.format(**words)}")


def questions_of(metric: str, prompt: BenchPrompt, count: int, fps: float) -> list[Question]:
    """All questions of a metric about a film.

    Args:
        metric: one of `JUDGED`.
        prompt: of the film.
        count: its frames.
        fps: frames per second.

    Raises:
        InputError: the film is too short to be cut into segments.
        ValueError: Caus of a prompt with another number of beats than five.
    """
    if metric == "caus":
        beats = prompt.beats
        if len(beats) != len(causal_stages(count)):
            raise ValueError(f"Caus needs five beats; prompt {prompt.id!r} has {len(beats)}")
        asked = [
            _question("causal_beat", b.id, w, count, fps, beat=b.text) for b, w in zip(beats, causal_stages(count), strict=True)
        ]
        for window, before, after in zip(causal_links(count), beats[:-1], beats[1:], strict=True):
            asked.append(
                _question("causal_link", f"{before.id}-{after.id}", window, count, fps, before=before.text, after=after.text)
            )
        return asked
    if metric == "qual":
        return [_question("shots", "", w, count, fps) for w in shot_segments(count)]
    if metric == "comp":
        windows = composition_windows(count)
        return [_question("composition", q.id, w, count, fps, question=q.question) for q in prompt.composition for w in windows]
    if metric == "prod":
        return [_question("production", "", w, count, fps, text=prompt.text) for w in production_windows(count)]
    raise ValueError(f"{metric!r} is no metric of a judge: {', '.join(JUDGED)}")

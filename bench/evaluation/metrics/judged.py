"""Caus, Qual, Comp and Prod of a film by a judge (R145-R147, R150, R151): every question put, scores joined by the paper's formulas.

A film of which one needed answer is missing has no score: a mean over the rest would not compare. So nothing more is asked then.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from typing import Any

import anyio

from ....worlds.errors import WorldAgentError
from ..prompts.reading import BenchPrompt
from .film import JUDGE_EDGE, QUALITY, Film
from .formulas import causal_score, composition_score, production_score, shots_score
from .judge import SECONDS, TRIES, Answered, Judge, JudgeIdentity, put
from .questions import Question, questions_of
from .rubrics import rubrics

__all__ = ["Judged", "judge_film"]

AT_ONCE = 8
"""Questions that are open at the same time; a provider's own limits come on top."""
GIVE_UP = 2 * AT_ONCE
"""Questions in a row without scores after which a judge is asked no more."""


@dataclass(frozen=True)
class Judged:
    """A metric of one film, with all that it rests on."""

    metric: str
    value: float | None
    reason: str
    """Why there is no value; empty where there is one."""
    judge: JudgeIdentity
    answers: tuple[Answered, ...]
    questions_sha256: str
    """Over the texts of all questions that belong to the metric, in order."""
    frames: int
    """Number of frames of the film."""

    def as_json(self) -> dict[str, Any]:
        """Plain data for logs and reports."""
        return {
            "metric": self.metric,
            "value": self.value,
            "reason": self.reason,
            "judge": asdict(self.judge),
            "rubric": {"version": rubrics().version, "sha256": rubrics().digest},
            "questions_sha256": self.questions_sha256,
            "pictures_sent_as": {"longest_side": JUDGE_EDGE, "format": "jpeg", "quality": QUALITY},
            "frames": self.frames,
            "calls": sum(a.tries for a in self.answers),
            "pictures": sum(a.pictures for a in self.answers),
            "input_tokens": sum(a.input_tokens for a in self.answers),
            "output_tokens": sum(a.output_tokens for a in self.answers),
            "tokens_told": all(a.told for a in self.answers),
            "answers": [a.as_json() for a in self.answers],
        }


async def judge_film(
    judge: Judge, film: Film, prompt: BenchPrompt, metric: str, *, tries: int = TRIES, seconds: float = SECONDS
) -> Judged:
    """One metric of a film.

    Args:
        judge: whom to ask.
        film: that is judged.
        prompt: which it is of.
        metric: `caus`, `qual`, `comp` or `prod`.
        tries: per question.
        seconds: longest wait for each.
    """
    try:
        asked = questions_of(metric, prompt, film.count, film.fps)
    except (ValueError, WorldAgentError) as error:
        return Judged(metric, None, str(error), judge.identity, (), _digest([]), 0)
    pictures = film.jpegs(sorted({k for q in asked for k in q.window.frames}))
    # Windows of one question of Comp come one after the other, until one is a yes; all else is put at once.
    chains = [list(g) for _, g in groupby(asked, lambda q: q.about)] if metric == "comp" else [[q] for q in asked]
    found: dict[str, Answered] = {}
    limiter = anyio.CapacityLimiter(AT_ONCE)

    in_vain = 0

    async def follow(chain: Sequence[Question], stop: anyio.CancelScope) -> None:
        nonlocal in_vain
        async with limiter:
            for question in chain:
                shown = [pictures[k] for k in question.window.frames]
                found[question.key] = made = await put(judge, question, shown, tries=tries, seconds=seconds)
                in_vain = 0 if made.scores is not None else in_vain + 1
                if made.scores == {"yes": 1.0}:
                    return
                if in_vain >= GIVE_UP:
                    stop.cancel()
        if any(found[q.key].scores is None for q in chain):
            stop.cancel()

    async with anyio.create_task_group() as group:
        for chain in chains:
            group.start_soon(follow, chain, group.cancel_scope)
    answers = tuple(found[q.key] for q in asked if q.key in found)
    value, reason = _folded(metric, asked, found)
    return Judged(metric, value, reason, judge.identity, answers, _digest(asked), film.count)


def _digest(asked: Sequence[Question]) -> str:
    return hashlib.sha256("\0".join(q.text for q in asked).encode()).hexdigest()


def _folded(metric: str, asked: Sequence[Question], found: dict[str, Answered]) -> tuple[float | None, str]:
    """Value of a metric from its answers, or None with the reason."""
    if metric == "comp":
        return _presence(asked, found)
    missing = _unanswered(asked, found)
    if missing is not None:
        return None, missing
    scores = [(q, found[q.key].scores or {}) for q in asked]
    if metric == "caus":
        beats = [s["completion"] for q, s in scores if q.kind == "causal_beat"]
        return causal_score(beats, [s["link"] for q, s in scores if q.kind == "causal_link"]), ""
    if metric == "qual":
        return shots_score([(s["viewpoints"], s["transitions"], s["motion"]) for _, s in scores]), ""
    return production_score([(len(q.window.frames), list(s.values())) for q, s in scores]), ""


def _presence(asked: Sequence[Question], found: dict[str, Answered]) -> tuple[float | None, str]:
    """Comp: a question is answered with yes in some window, or with no in all of them."""
    chains = [list(windows) for _, windows in groupby(asked, lambda q: q.about)]
    present = [any(q.key in found and found[q.key].scores == {"yes": 1.0} for q in chain) for chain in chains]
    missing = _unanswered([q for chain, yes in zip(chains, present, strict=True) if not yes for q in chain], found)
    return (composition_score(present), "") if missing is None else (None, missing)


def _unanswered(needed: Sequence[Question], found: dict[str, Answered]) -> str | None:
    """The first question that was put in vain and its last reason; None where all have scores."""
    vain = next((found[q.key] for q in needed if q.key in found and found[q.key].scores is None), None)
    unasked = sum(q.key not in found for q in needed)
    if vain is None:
        return f"{unasked} questions were not put" if unasked else None
    return f"{vain.key} has no scores after {vain.tries} tries, {unasked} questions were not put any more; {vain.reasons[-1]}"

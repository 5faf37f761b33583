"""The cost of a judge before it is asked: calls, pictures, tokens, money."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..prompts.reading import BenchPrompt
from .film import JUDGE_EDGE
from .questions import JUDGED, questions_of

__all__ = ["Forecast", "forecast", "picture_tokens"]

PIXELS_PER_TOKEN = 750
"""Pixels of a picture: the rule that Anthropic publishes; others count 85 to 1500 per picture, and local judges 196 (LLaVA-Video)."""
LETTERS_PER_TOKEN = 4
"""Letters of English text, roughly."""
ANSWER_TOKENS = 40
"""Tokens of an answer, without what a model thinks before it."""


@dataclass(frozen=True)
class Forecast:
    """Upper bounds without retries; Comp stops at the first yes and so usually needs fewer."""

    calls: int
    pictures: int
    input_tokens: int
    output_tokens: int
    cost_usd: float | None
    """None where no prices were given."""

    def __add__(self, other: Forecast) -> Forecast:
        """Both together."""
        cost = None if self.cost_usd is None or other.cost_usd is None else self.cost_usd + other.cost_usd
        return Forecast(
            self.calls + other.calls,
            self.pictures + other.pictures,
            self.input_tokens + other.input_tokens,
            self.output_tokens + other.output_tokens,
            cost,
        )

    def words(self) -> str:
        """One line for a person."""
        cost = "cost unknown (no prices given)" if self.cost_usd is None else f"about {self.cost_usd:.2f} USD"
        return f"{self.calls} calls with {self.pictures} pictures, about {self.input_tokens} tokens in and {self.output_tokens} out: {cost}"


def picture_tokens(size: tuple[int, int]) -> int:
    """Tokens of a frame of this height and width as a judge gets it."""
    scale = min(1.0, JUDGE_EDGE / max(1, *size))
    return max(1, math.ceil(size[0] * scale * size[1] * scale / PIXELS_PER_TOKEN))


def forecast(
    prompt: BenchPrompt,
    count: int,
    fps: float,
    size: tuple[int, int],
    *,
    metrics: Iterable[str] = JUDGED,
    prices: Sequence[float] | None = None,
) -> Forecast:
    """Calls, pictures, tokens and cost of judging one film.

    Args:
        prompt: of the film.
        count: its frames.
        fps: frames per second.
        size: height and width [pixels].
        metrics: of `JUDGED`.
        prices: dollars per million tokens in and out.
    """
    asked = [q for metric in metrics for q in questions_of(metric, prompt, count, fps)]
    pictures = sum(len(q.window.frames) for q in asked)
    tokens = pictures * picture_tokens(size) + sum(math.ceil(len(q.text) / LETTERS_PER_TOKEN) for q in asked)
    answers = ANSWER_TOKENS * len(asked)
    cost = None if prices is None else (tokens * prices[0] + answers * prices[1]) / 1e6
    return Forecast(len(asked), pictures, tokens, answers, cost)

"""The seven metrics as scorers of Inspect, each over what a sample left.

What cannot be scored stays unscored with its reason, and out of the mean; Inspect counts such samples beside it. `caus`, `qual`, `comp` and `prod`
need a judge: `--model-role grader=PROVIDER/MODEL`. On a finished log: `inspect score LOG --scorer worldagent/caus --action append`.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from typing import Any

import anyio.to_thread
from inspect_ai.log import transcript
from inspect_ai.model import model_roles
from inspect_ai.scorer import Score, Scorer, Target, mean, scorer, stderr
from inspect_ai.solver import TaskState

from ....worlds.errors import RefusedError, WorldAgentError
from .align import CHECKPOINT, MODEL, align, load_encoder
from .evaluated import pen_of_folder
from .forecast import forecast
from .imaging import imaging_quality, load_quality_model
from .judge import SECONDS, TRIES, InspectJudge
from .judged import judge_film
from .sample import SampleOutput, sample_output

__all__ = ["METRIC_SCORERS", "alignment", "caus", "comp", "imag", "pen", "prices_of", "prod", "qual"]

MOST_CALLS = 2000
"""Calls of a judge for one metric of one film, by the forecast; more are refused before the first."""
Measured = Callable[[SampleOutput], Awaitable[tuple[float | None, str, dict[str, Any]]]]
"""Value or None, words, and plain data."""


def _scored(measure: Measured) -> Scorer:
    """A scorer that measures what a sample left."""

    async def score(state: TaskState, target: Target) -> Score:
        try:
            value, words, data = await measure(sample_output(state.metadata))
        except WorldAgentError as error:
            return Score.unscored(explanation=str(error))
        if value is None:
            return Score.unscored(explanation=words, metadata=data)
        return Score(value=value, explanation=words, metadata=data)

    return score


@scorer(metrics=[mean(), stderr()])
def pen() -> Scorer:
    """Normalised maximum penetration depth of the baked world; lower is better; unscored of a mere film."""

    async def measure(output: SampleOutput) -> tuple[float | None, str, dict[str, Any]]:
        found = await anyio.to_thread.run_sync(pen_of_folder, output.need_world())
        where = (
            "nothing crosses"
            if found.worst is None
            else f"{found.worst.first} and {found.worst.second} at frame {found.worst.frame}"
        )
        return found.score, f"{1000 * found.depth:.4g} mm of {found.scale:.4g} m: {where}", found.as_json()

    return _scored(measure)


def _judged(metric: str, tries: int, seconds: float, most_calls: int, prices: str) -> Scorer:
    async def measure(output: SampleOutput) -> tuple[float | None, str, dict[str, Any]]:
        film = output.need_film()
        count = await anyio.to_thread.run_sync(lambda: film.count)
        if "grader" not in model_roles():
            raise RefusedError("no judge is named; add --model-role grader=PROVIDER/MODEL")
        judge = InspectJudge()
        try:
            told = forecast(output.prompt, count, film.fps, film.size, metrics=(metric,), prices=prices_of(prices))
        except ValueError as error:
            return None, str(error), {}
        transcript().info({"metric": metric, "forecast": told.words()})
        if told.calls > most_calls:
            raise RefusedError(f"{metric} would take {told.words()}; {most_calls} calls are allowed (most_calls)")
        found = await judge_film(judge, film, output.prompt, metric, tries=tries, seconds=seconds)
        return found.value, found.reason or f"by {found.judge.model}", {"forecast": told.words(), **found.as_json()}

    return _scored(measure)


def prices_of(text: str) -> tuple[float, float] | None:
    """Dollars per million tokens in and out, written `3/15`; None where nothing is given.

    Raises:
        RefusedError: it is written in another way.
    """
    if not text:
        return None
    one, _, two = text.partition("/")
    try:
        return float(one), float(two)
    except ValueError:
        raise RefusedError(f"prices {text!r} must be dollars per million tokens in and out, as 3/15") from None


@scorer(metrics=[mean(), stderr()])
def caus(tries: int = TRIES, seconds: float = SECONDS, most_calls: int = MOST_CALLS, prices: str = "") -> Scorer:
    """Causal beat completion by a judge."""
    return _judged("caus", tries, seconds, most_calls, prices)


@scorer(metrics=[mean(), stderr()])
def qual(tries: int = TRIES, seconds: float = SECONDS, most_calls: int = MOST_CALLS, prices: str = "") -> Scorer:
    """Quality of shot planning by a judge."""
    return _judged("qual", tries, seconds, most_calls, prices)


@scorer(metrics=[mean(), stderr()])
def comp(tries: int = TRIES, seconds: float = SECONDS, most_calls: int = MOST_CALLS, prices: str = "") -> Scorer:
    """Completeness of the scene by a judge."""
    return _judged("comp", tries, seconds, most_calls, prices)


@scorer(metrics=[mean(), stderr()])
def prod(tries: int = TRIES, seconds: float = SECONDS, most_calls: int = MOST_CALLS, prices: str = "") -> Scorer:
    """Production quality by a judge."""
    return _judged("prod", tries, seconds, most_calls, prices)


@scorer(metrics=[mean(), stderr()], name="align")
def alignment(model: str = MODEL, weights: str = CHECKPOINT, device: str = "") -> Scorer:
    """Agreement of film and prompt by the Perception Encoder (extra `[metrics]`)."""

    async def measure(output: SampleOutput) -> tuple[float | None, str, dict[str, Any]]:
        film = output.need_film()
        encoder = await anyio.to_thread.run_sync(partial(load_encoder, model=model, weights=weights, device=device or None))
        found = await anyio.to_thread.run_sync(align, film, output.prompt.text, encoder)
        return (
            found.value,
            f"{found.frames} frames, {found.text_tokens_used} of {found.text_tokens} tokens of the prompt",
            found.as_json(),
        )

    return _scored(measure)


@scorer(metrics=[mean(), stderr()])
def imag(device: str = "") -> Scorer:
    """Imaging quality by MUSIQ (package pyiqa, non-commercial)."""

    async def measure(output: SampleOutput) -> tuple[float | None, str, dict[str, Any]]:
        film = output.need_film()
        model = await anyio.to_thread.run_sync(partial(load_quality_model, device=device or None))
        found = await anyio.to_thread.run_sync(imaging_quality, film, model)
        return found.value, f"{found.frames} frames at {found.size[1]} x {found.size[0]}", found.as_json()

    return _scored(measure)


METRIC_SCORERS: Mapping[str, Callable[..., Scorer]] = {
    "pen": pen,
    "caus": caus,
    "qual": qual,
    "comp": comp,
    "align": alignment,
    "imag": imag,
    "prod": prod,
}
"""By their names, in the order of the paper's table."""

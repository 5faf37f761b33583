"""Metrics joined to runs: chosen by name, with what a judge will cost before it is asked, during a run or after it."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from functools import reduce
from operator import add
from typing import TYPE_CHECKING, Any

from inspect_ai.log import EvalLog, EvalSample, recompute_metrics, write_eval_log
from inspect_ai.scorer import Scorer

from ...worlds.errors import InputError, WorldAgentError
from .figures import scored_value
from .metrics.forecast import Forecast, forecast
from .metrics.questions import JUDGED
from .metrics.sample import sample_output
from .metrics.scorers import METRIC_SCORERS
from .prompts.reading import BenchPrompt

if TYPE_CHECKING:
    from inspect_ai.model import Model

__all__ = ["METRICS", "forecast_films", "forecast_prompts", "metric_names", "metric_scorers", "need_judge", "score_log"]

METRICS = METRIC_SCORERS
FILM_FPS, FILM_SIZE = 24.0, (1080, 1920)
"""Of a film that is still to be made, for a forecast: frames per second, height and width [pixels]."""


def metric_names(text: str) -> tuple[str, ...]:
    """Metrics named in a list with commas, or `all`, in the order of the table.

    Raises:
        InputError: one is unknown.
    """
    named = tuple(METRICS) if text == "all" else tuple(word.strip() for word in text.split(",") if word.strip())
    strange = [name for name in named if name not in METRICS]
    if strange:
        raise InputError(f"metrics {', '.join(strange)} must be among {', '.join(METRICS)}, or all")
    return tuple(name for name in METRICS if name in named)


def metric_scorers(names: Iterable[str]) -> list[Scorer]:
    """Their scorers."""
    return [METRICS[name]() for name in names]


def need_judge(names: Iterable[str], judge: str | None) -> tuple[str, ...]:
    """The metrics among them that ask a judge.

    Raises:
        InputError: there are some, and no judge is named.
    """
    asking = tuple(name for name in names if name in JUDGED)
    if asking and not judge:
        raise InputError(f"{', '.join(asking)} ask a judge; name its model with --judge PROVIDER/MODEL")
    return asking


def forecast_prompts(
    prompts: Iterable[BenchPrompt], names: Sequence[str], *, epochs: int = 1, prices: tuple[float, float] | None = None
) -> Forecast:
    """Cost of judging films that are still to be made: as long as each prompt's events need, 24 frames a second, Full HD.

    Args:
        prompts: of the samples.
        names: of the metrics.
        epochs: films per prompt.
        prices: dollars per million tokens in and out.
    """
    told = [
        _forecast(prompt, (max(1, round(prompt.duration_s * FILM_FPS)), FILM_FPS, FILM_SIZE), name, prices)
        for prompt in prompts
        for name in names
    ]
    return reduce(add, told * epochs, _nothing(prices))


def forecast_films(
    samples: Iterable[EvalSample], names: Sequence[str], *, prices: tuple[float, float] | None = None, again: bool = False
) -> Forecast:
    """Cost of judging the films that samples left, as far as they have no value yet, or `again`."""
    told = _nothing(prices)
    for sample in samples:
        film, prompt = _film_of(sample)
        for name in names:
            if film is not None and (again or scored_value(sample, name) is None):
                told += _forecast(prompt, film, name, prices)
    return told


def _nothing(prices: tuple[float, float] | None) -> Forecast:
    return Forecast(0, 0, 0, 0, None if prices is None else 0.0)


def _forecast(
    prompt: BenchPrompt, film: tuple[int, float, tuple[int, int]], name: str, prices: tuple[float, float] | None
) -> Forecast:
    """Of one metric of one film; nothing where it can have no score, since no question is put then."""
    try:
        return forecast(prompt, *film, metrics=(name,), prices=prices)
    except (ValueError, WorldAgentError):
        return _nothing(prices)


def _film_of(sample: EvalSample) -> tuple[tuple[int, float, tuple[int, int]] | None, Any]:
    """Frames, rate and size of the film of a sample, and its prompt."""
    try:
        left = sample_output(sample.metadata)
        film = left.need_film()
        return (film.count, film.fps, film.size), left.prompt
    except WorldAgentError:
        return None, None


def score_log(log: EvalLog, names: Sequence[str], *, judge: Model | None = None, again: bool = False) -> int:
    """Score the samples of a finished run and write its log anew after each one, so that nothing paid for is lost.

    Samples that were an error are left out, and so are metrics that have a value.

    Args:
        log: with its location.
        names: of the metrics.
        judge: model for those that ask one.
        again: score what has a value too.

    Returns:
        Number of scores that were asked for.
    """
    from inspect_ai import score as run_score

    asked = 0
    for sample in log.samples or ():
        wanted = [name for name in names if sample.error is None and (again or scored_value(sample, name) is None)]
        if not wanted:
            continue
        print(f"{sample.id}: {', '.join(wanted)}", file=sys.stderr, flush=True)
        sample.scores = {k: v for k, v in (sample.scores or {}).items() if k not in wanted}
        # Inspect writes the scorers of this pass alone into what it is given: a copy of the header, with this sample.
        part = log.model_copy(update={"eval": log.eval.model_copy(), "samples": [sample], "results": None, "reductions": None})
        part = run_score(
            part,
            metric_scorers(wanted),
            model="none",
            model_roles=None if judge is None else {"grader": judge},
            display="none",
            copy=False,
        )
        log.eval.scorers = [s for s in log.eval.scorers or [] if s.name.rpartition("/")[2] not in wanted] + list(
            part.eval.scorers or []
        )
        recompute_metrics(log)
        write_eval_log(log)
        asked += len(wanted)
    return asked

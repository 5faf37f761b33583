"""A run from the log of an evaluation: scores, reasons and details of every sample, with contact sheets of the films that are still there."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ....worlds.errors import WorldAgentError
from ..metrics.agreement import Spent, server_figures
from ..metrics.sample import sample_output
from .runs import METRICS, Run, SampleScores
from .sheets import film_sheet

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog, EvalSample
    from inspect_ai.scorer import Score

__all__ = ["run_of_log"]

VERDICT = "verified"
"""Scorer of the server's verdict: a table of values, among them `accepted`."""


def run_of_log(
    log: EvalLog, *, prompts: Mapping[str, str], method: str = "", films: bool = True, prices: Mapping[str, tuple[float, float]] | None = None
) -> tuple[Run, dict[str, bytes]]:
    """The run that a log tells of, and its contact sheets by name of their file.

    Args:
        log: with samples.
        prompts: name, version and digest of the set that was asked for.
        method: its name in tables; default that of the agent.
        films: look for films and make their sheets.
        prices: dollars per million tokens in and out, by model; without that of the agent's model there is no cost. What judges used is told
            with their scores.
    """
    sheets: dict[str, bytes] = {}
    samples = []
    for sample in log.samples or ():
        name = f"{re.sub(r'[^a-z0-9_]+', '_', str(sample.id).lower())}_{sample.epoch}.jpg"
        sheet = _sheet(sample) if films else None
        if sheet is not None:
            sheets[name] = sheet
        samples.append(_scores(sample, name if sheet is not None else "", log.eval.model, prices or {}))
    agent = (log.eval.solver or (log.plan.steps[-1].solver if log.plan.steps else "")).rpartition("/")[2]
    notes = tuple(dict.fromkeys(f"ablation {a}: nothing here is an acceptance" for s in log.samples or () if (a := dict(s.metadata.get("attempt") or {}).get("ablation"))))
    versions = {str(k): str(v) for k, v in log.eval.packages.items()}
    run = Run(method or agent or log.eval.task, log.eval.model, dict(prompts), versions, tuple(samples), str(log.eval.created), notes)
    return run, sheets


def _scores(sample: EvalSample, sheet: str, model: str, prices: Mapping[str, tuple[float, float]]) -> SampleScores:
    found, verdict = dict(sample.scores or {}), None
    values: dict[str, float | None] = {}
    reasons: dict[str, str] = {}
    if VERDICT in found:
        verdict = found.pop(VERDICT)
        table = verdict.value if isinstance(verdict.value, Mapping) else {}
        accepted = table.get("accepted")
        values["accepted"] = float(accepted) if isinstance(accepted, int | float) else None
        reasons["accepted"] = verdict.explanation or ""
    for metric in METRICS:
        score = found.get(metric.name)
        if score is None:
            continue
        values[metric.name] = value = _value(score)
        if value is None:
            reasons[metric.name] = score.explanation or "no score"
    details = {name: dict(found[name].metadata or {}) for name in values if name in found}
    shared = any(dict(d.get("judge") or {}).get("model") == model for d in details.values())
    used = _agents_tokens(sample, model, shared=shared)
    spent = Spent(_calls(verdict), sum(used), round(sample.total_time or 0.0, 3), _cost(used, prices.get(model)))
    return SampleScores(
        str(sample.id), sample.epoch, _outcome(sample, values.get("accepted")), values,
        {k: v for k, v in reasons.items() if values[k] is None}, _figures(verdict, spent), _plain(details), sheet,
    )  # fmt: skip


def _value(score: Score) -> float | None:
    value = score.value
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) else None


def _outcome(sample: EvalSample, accepted: float | None) -> str:
    if sample.error is not None:
        return "error"
    if accepted == 1.0:
        return "accepted"
    return "limit" if sample.limit is not None else "film" if accepted is None else "refused"


def _agents_tokens(sample: EvalSample, model: str, *, shared: bool) -> tuple[int, int]:
    """Tokens in and out that the agent used, without those of a judge that is the same model."""
    own = sample.model_usage.get(model)
    judges = sample.role_usage.get("grader") if shared else None
    if own is None:
        return 0, 0
    return own.input_tokens - (judges.input_tokens if judges else 0), own.output_tokens - (judges.output_tokens if judges else 0)


def _cost(used: tuple[int, int], price: tuple[float, float] | None) -> float | None:
    return None if price is None else (used[0] * price[0] + used[1] * price[1]) / 1e6


def _calls(verdict: Score | None) -> int:
    table = verdict.value if verdict is not None and isinstance(verdict.value, Mapping) else {}
    calls = table.get("calls", 0)
    return int(calls) if isinstance(calls, int | float) else 0


def _figures(verdict: Score | None, spent: Spent) -> dict[str, Any]:
    told = dict(verdict.metadata or {}) if verdict is not None else {}
    known = dict(told.get("server_verdict") or {})
    return server_figures(dict(told.get("verdict") or {}), weakenings=known.get("weakenings") or (), spent=spent)


def _sheet(sample: EvalSample) -> bytes | None:
    try:
        film = sample_output(sample.metadata).film
        return None if film is None else film_sheet(film)
    except WorldAgentError:
        return None


def _plain(value: Any) -> Any:
    """Data that JSON can hold: numbers that are none become nothing."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value

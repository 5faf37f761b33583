"""Figures of a run by prompt: the seven metrics and the server's own, and everything that must be equal for two runs to be compared."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING, Any, Literal

from ...worlds.canonical import digest_of
from .metrics.formulas import macro_average
from .results import SampleResult, samples_of
from .statistics import Interval, repeat_interval, share_interval

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog, EvalSample

__all__ = [
    "FIGURES",
    "METRIC_FIGURES",
    "SERVER_FIGURES",
    "Figure",
    "RunFigures",
    "Summary",
    "identity_of",
    "run_figures",
    "scored_value",
    "unscored",
]


@dataclass(frozen=True)
class Figure:
    """One column of a table."""

    name: str
    title: str
    better: Literal["higher", "lower", ""]
    """Empty where neither is."""
    group: str = ""
    """Of the paper's table."""
    digits: int = 4


METRIC_FIGURES = (
    Figure("pen", "Pen", "lower", "Physical plausibility"),
    Figure("caus", "Caus", "higher", "Physical plausibility"),
    Figure("qual", "Qual", "higher", "Shot planning"),
    Figure("comp", "Comp", "higher", "Content alignment"),
    Figure("align", "Align", "higher", "Content alignment"),
    Figure("imag", "Imag", "higher", "Aesthetics"),
    Figure("prod", "Prod", "higher", "Aesthetics"),
)
"""Columns of the paper's tables, in their order."""
SERVER_FIGURES = (
    Figure("accepted", "accepted", "higher", digits=3),
    Figure("calls", "calls", "lower", digits=1),
    Figure("refused_calls", "refused calls", "lower", digits=1),
    Figure("tokens", "tokens", "lower", digits=0),
    Figure("seconds", "seconds", "lower", digits=1),
    Figure("working_s", "seconds without waiting for a model", "lower", digits=1),
    Figure("device_s", "seconds of jobs", "lower", digits=1),
    Figure("cost_usd", "US dollars", "lower", digits=2),
    Figure("rows_pass", "rows passed", "", digits=1),
    Figure("rows_fail", "rows failed", "lower", digits=1),
    Figure("rows_unverified", "rows unverified", "lower", digits=1),
    Figure("rows_not_applicable", "rows not applicable", "", digits=1),
    Figure("approximations", "approximations", "lower", digits=1),
    Figure("unmet_words", "unmet words", "lower", digits=1),
    Figure("weakenings", "weakenings", "lower", digits=1),
)
"""The server's own, and the agent's expense."""
FIGURES: Mapping[str, Figure] = {f.name: f for f in (*METRIC_FIGURES, *SERVER_FIGURES)}


@dataclass(frozen=True)
class Summary:
    """One figure of a run."""

    values: Mapping[str, tuple[float | None, ...]]
    """By prompt, one value per repeat; None where there is none."""
    means: Mapping[str, float | None]
    """By prompt: over its repeats; None where one of them has no value."""
    intervals: Mapping[str, Interval | None]
    """By prompt: over its repeats; None where there are fewer than two."""
    average: float | None
    """Macro average (R140); None where a prompt has none."""
    interval: Interval | None
    """Of the macro average, over the repeats."""

    @property
    def scored(self) -> int:
        """Prompts with a mean."""
        return sum(mean is not None for mean in self.means.values())


@dataclass(frozen=True)
class RunFigures:
    """Samples of a run, and its figures by name."""

    results: tuple[SampleResult, ...]
    figures: Mapping[str, Summary]


def scored_value(sample: EvalSample, name: str) -> float | None:
    """Value of a metric of a sample; None where it has none yet, or no scorer could give one."""
    score = (sample.scores or {}).get(name)
    if score is None or not isinstance(score.value, int | float) or score.value != score.value:
        return None
    return float(score.value)


def run_figures(log: EvalLog) -> RunFigures:
    """Figures of a run; a sample that was an error has none of them, since it says nothing of its agent."""
    results = samples_of(log)
    table: dict[str, dict[str, list[float | None]]] = {name: {} for name in FIGURES}
    for sample, result in zip(log.samples or (), results, strict=True):
        told = {} if result.outcome == "error" else _of_sample(sample, result)
        for name, by_prompt in table.items():
            by_prompt.setdefault(result.id, []).append(told.get(name))
    made = {name: _summary(name, by_prompt) for name, by_prompt in table.items()}
    known = {name: s for name, s in made.items() if any(v is not None for values in s.values.values() for v in values)}
    return RunFigures(tuple(results), known)


def _of_sample(sample: EvalSample, result: SampleResult) -> dict[str, float | None]:
    costs = [usage.total_cost for usage in sample.model_usage.values()]
    told: dict[str, float | None] = {f.name: scored_value(sample, f.name) for f in METRIC_FIGURES}
    told |= {
        name: float(getattr(result, name)) for name in ("calls", "refused_calls", "tokens", "seconds", "working_s", "device_s")
    }
    told["accepted"] = float(result.outcome == "accepted")
    told["cost_usd"] = sum(c for c in costs if c is not None) if costs and None not in costs else None
    if result.rows:  # without a judged world there is nothing to count
        told |= {
            f"rows_{status}": float(result.rows.get(status, 0)) for status in ("pass", "fail", "unverified", "not_applicable")
        }
        told |= {"approximations": float(result.approximations), "unmet_words": float(len(result.unmet))}
        told["weakenings"] = float(result.weakenings)
    return told


def _summary(name: str, by_prompt: Mapping[str, list[float | None]]) -> Summary:
    whole = {prompt: [v for v in values if v is not None] for prompt, values in by_prompt.items() if None not in values}
    means = {prompt: fmean(whole[prompt]) if prompt in whole else None for prompt in by_prompt}
    average = macro_average(means)
    return Summary(
        values={prompt: tuple(values) for prompt, values in by_prompt.items()},
        means=means,
        intervals={prompt: _interval(name, [whole[prompt]]) if prompt in whole else None for prompt in by_prompt},
        average=average,
        interval=None if average is None else _interval(name, list(whole.values())),
    )


def _interval(name: str, repeats: list[list[float]]) -> Interval | None:
    """Of a share of yes and no, Wilson's, which repeats that agree do not make empty; else by their variance."""
    if any(len(group) < 2 for group in repeats):
        return None
    if name == "accepted":
        return share_interval(round(sum(map(sum, repeats))), sum(map(len, repeats)))
    return repeat_interval(repeats)


def identity_of(log: EvalLog) -> dict[str, Any]:
    """What a run rests on: set of prompts, template, server, packages and whoever scored it, with versions and hashes."""
    told = log.eval.metadata or {}
    samples = log.samples or []
    flights = [s.metadata["preflight"] for s in samples if s.metadata.get("preflight")]
    prompts = told.get("prompts") or {
        "name": log.eval.task,
        "version": "",
        "sha256": digest_of(*sorted({str(s.input) for s in samples})),
    }
    revision = log.eval.revision
    return {
        "prompts": prompts,
        "template": told.get("template") or {},
        "ablation": told.get("ablation") or "",
        "budget": told.get("budget") or {},
        "packages": dict(log.eval.packages),
        "revision": None if revision is None else {"commit": revision.commit, "dirty": revision.dirty},
        "server": sorted({f"{f['name']} {f['version']}" for f in flights}),
        "tools_sha256": sorted({str(f["tools_digest"]) for f in flights}),
        "metrics": {f.name: found for f in METRIC_FIGURES if (found := _scored_by(samples, f.name))},
    }


def _scored_by(samples: list[EvalSample], name: str) -> list[dict[str, Any]]:
    """Whoever scored a metric: judge and rubric, or model and conventions; more than one where samples differ."""
    found: dict[str, dict[str, Any]] = {}
    for sample in samples:
        score = (sample.scores or {}).get(name)
        if score is None or scored_value(sample, name) is None:
            continue
        data = dict(score.metadata or {})
        known = ("judge", "rubric", "pictures_sent_as", "choices", "model", "weights", "preprocess", "dtype", "versions")
        told = {k: data[k] for k in known if k in data}
        found[json.dumps(told, sort_keys=True, default=str)] = told
    return [found[key] for key in sorted(found)]


def unscored(log: EvalLog) -> list[dict[str, Any]]:
    """Metrics that a scorer could not give, each with sample, repeat and reason."""
    return [
        {"sample": str(s.id), "epoch": s.epoch, "metric": f.name, "reason": str((s.scores or {})[f.name].explanation or "")}
        for s in log.samples or ()
        for f in METRIC_FIGURES
        if f.name in (s.scores or {}) and scored_value(s, f.name) is None
    ]

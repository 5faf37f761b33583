"""Samples of a log as plain data, for reports: what Inspect keeps, and what the records say beside it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from .records import Record
from .workspace import marks_after

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog, EvalSample

__all__ = ["Outcome", "SampleResult", "counts_of", "samples_of"]

Outcome = Literal["accepted", "refused", "limit", "error"]
OUTCOMES: tuple[Outcome, ...] = ("accepted", "refused", "limit", "error")


@dataclass(frozen=True)
class SampleResult:
    """One sample of one run."""

    id: str
    epoch: int
    agent: str
    model: str
    outcome: Outcome
    """`accepted`: `verify` accepted its world, and nothing speaks against its isolation. `refused`: its agent ended, and none is.
    `limit`: a budget ended it first. `error`: the server or the harness failed, which says nothing of the agent."""
    reason: str
    """Reason of the verdict, the limit or the error, in one sentence."""
    limit: str = ""
    """`time`, `token`, `message`, `calls`, `device_s` ...; empty where none ended it."""
    ablation: str = ""
    """Name of the ablation; such a sample is never `accepted`."""
    server_verdict: str = ""
    """Last word of the sample's own server: `accepted`, `incomplete`, `ablated`, or nothing."""
    rows: Mapping[str, int] = field(default_factory=dict)
    """Rows by status, as `verify` judged."""
    open_rows: tuple[str, ...] = ()
    approximations: int = 0
    unmet: tuple[str, ...] = ()
    """Words of the prompt that the agent waived."""
    readings: tuple[str, ...] = ()
    """Words whose meaning is the agent's word alone."""
    weakenings: int = 0
    calls: int = 0
    refused_calls: int = 0
    tokens: int = 0
    seconds: float = 0.0
    """From start to end, waiting included [s]."""
    working_s: float = 0.0
    """Without waiting for a model [s]."""
    device_s: float = 0.0
    """Seconds of jobs in worker processes [s]."""
    isolation: tuple[str, ...] = ()
    """Lines that speak against its isolation, at its end and now."""
    differences: tuple[str, ...] = ()
    """Verdicts of a replay that are not those of its recording."""
    world: str = ""
    workspace: str = ""
    record: str = ""
    attempts: int = 1


def samples_of(log: EvalLog) -> list[SampleResult]:
    """The samples of a log, in its order."""
    agent = log.eval.solver or (log.plan.steps[-1].solver if log.plan.steps else "")
    return [_result(sample, agent.rpartition("/")[2], log.eval.model) for sample in log.samples or ()]


def counts_of(results: list[SampleResult]) -> dict[str, int]:
    """Samples by outcome."""
    return {outcome: sum(r.outcome == outcome for r in results) for outcome in OUTCOMES}


def _result(sample: EvalSample, agent: str, model: str) -> SampleResult:
    attempt = sample.metadata.get("attempt") or {}
    score = (sample.scores or {}).get("verified")
    told: dict[str, Any] = {} if score is None else dict(score.metadata or {})
    value: dict[str, Any] = dict(score.value) if score is not None and isinstance(score.value, Mapping) else {}
    verdict = told.get("verdict") or {}
    prompt = verdict.get("prompt") or {}
    known = told.get("server_verdict") or {}
    replayed = sample.metadata.get("replay") or {}
    outcome, reason, limit = _outcome(sample, value, score.explanation if score is not None else None)
    record = Record(Path(attempt["record"])) if attempt else None
    there = record is not None and Path(attempt["workspace"]).is_dir() and record.folder.is_dir()
    later = marks_after(record, Path(attempt["workspace"])) if there and record is not None else []
    return SampleResult(
        id=str(sample.id),
        epoch=sample.epoch,
        agent=agent,
        model=model,
        outcome="refused" if outcome == "accepted" and later else outcome,
        reason="; ".join(later) if outcome == "accepted" and later else reason,
        limit=limit,
        ablation=str(attempt.get("ablation", "")),
        server_verdict=str(known.get("verdict") or ""),
        rows={k: int(v) for k, v in (verdict.get("rows") or {}).items() if isinstance(v, int)},
        open_rows=tuple(str(r.get("id")) for r in verdict.get("failing") or ()),
        approximations=len(verdict.get("approximations") or ()),
        unmet=tuple(str(w) for w in prompt.get("waivers") or ()),
        readings=tuple(str(w) for w in prompt.get("readings") or ()),
        weakenings=len(known.get("weakenings") or ()),
        calls=int(value.get("calls", len(record.calls()) if there and record is not None else 0)),
        refused_calls=int(told.get("refused_calls", 0)),
        tokens=sum(usage.total_tokens for usage in sample.model_usage.values()),
        seconds=round(sample.total_time or 0.0, 3),
        working_s=round(sample.working_time or 0.0, 3),
        device_s=float(value.get("device_s", 0.0)),
        isolation=(*(told.get("isolation") or ()), *later),
        differences=(*(replayed.get("differences") or ()), *(told.get("differences") or ())),
        world=(score.answer or "") if score is not None else "",
        workspace=str(attempt.get("workspace", "")),
        record=str(attempt.get("record", "")),
        attempts=1 + len(sample.error_retries or ()),
    )


def _unquoted(message: str) -> str:
    """The words of an error, which Inspect keeps as `ServerLost('words')`."""
    found = re.fullmatch(r"""\w+\((['"])(.*?)\1(?:,.*)?\)""", message.strip(), re.DOTALL)
    return (found.group(2) if found else message.strip()).splitlines()[0]


def _outcome(sample: EvalSample, value: Mapping[str, Any], says: str | None) -> tuple[Outcome, str, str]:
    """Outcome, its reason, and the limit that ended the sample; a world that was accepted before a limit is accepted."""
    if sample.error is not None:
        return "error", _unquoted(sample.error.message)[:500], ""
    reached, limit = sample.limit, ""
    if reached is not None:
        reason = reached.reason or f"{reached.type} limit of {reached.limit:g}"
        limit = reason.partition(":")[0] if reached.type == "custom" else reached.type
    if value.get("accepted"):
        return "accepted", str(says), limit
    if reached is not None:
        return "limit", reason, limit
    return "refused", str(says or "it was not scored"), ""

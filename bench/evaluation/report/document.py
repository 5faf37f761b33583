"""The report of a run as plain data: outcomes, figures with intervals, beats by server and judge, films, versions and hashes."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from .... import __version__
from ....worlds.errors import InputError, WorldAgentError
from ..compare import refuse_others
from ..figures import RunFigures, Summary, identity_of, run_figures, unscored
from ..metrics.agreement import Agreement, compare_beats
from ..metrics.sample import sample_output
from ..records import Record
from ..results import SampleResult, counts_of
from ..runs import run_name

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog, EvalSample

__all__ = ["BeatNotes", "beat_notes", "judged_beats", "report_document", "server_beats"]

VERSION = 1
"""Of the document; goes up when a field changes its meaning."""


class BeatNotes(BaseModel):
    """Of one prompt: which beats of the worlds made of it stand for its own, and what somebody found about disputed ones."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    pairs: dict[str, tuple[str, ...]] = {}
    ruled: dict[str, Literal["happened", "did_not"]] = {}


class _Notes(BaseModel):
    """By prompt, or by `PROMPT:REPEAT` where worlds of its repeats differ."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    samples: Annotated[dict[str, BeatNotes], Field(min_length=1)]


def beat_notes(path: Path | None) -> dict[str, BeatNotes]:
    """Read them from `{"samples": {PROMPT: {"pairs": {BEAT: [BEAT OF THE WORLD]}, "ruled": {BEAT: "happened" or "did_not"}}}}`.

    Raises:
        InputError: the file is missing, or holds something else.
    """
    if path is None:
        return {}
    try:
        return _Notes.model_validate_json(path.read_text(encoding="utf-8")).samples
    except OSError as error:
        raise InputError(f"the notes on beats {str(path)!r} cannot be read: {error}") from error
    except ValidationError as error:
        raise InputError(f"{str(path)!r} holds no notes on beats: {error}") from error


def report_document(
    log: EvalLog, beside: Sequence[EvalLog] = (), *, notes: Mapping[str, BeatNotes] | None = None
) -> dict[str, Any]:
    """The document.

    Args:
        log: of the run.
        beside: other runs of the same prompts, as further rows of the tables of averages.
        notes: on beats.

    Raises:
        RefusedError: a run beside it has other prompts, or another template.
    """
    for other in beside:
        refuse_others(log, other)
    run = run_figures(log)
    beats = _beats(log, run.results, notes or {})
    whole = Agreement(tuple(b for a in beats.values() for b in a.beats))
    films = {_key(sample): _film(sample) for sample in log.samples or ()}
    return {
        "version": VERSION,
        "made_by": __version__,
        "run": _run(log),
        "outcomes": counts_of(list(run.results)),
        "made_with": identity_of(log),
        "figures": _figures(run),
        "unscored": unscored(log),
        "samples": [{**asdict(r), "film": films.get(f"{r.id}:{r.epoch}")} for r in run.results],
        "beats": {
            "samples": {key: found.as_json() for key, found in beats.items()},
            **{k: v for k, v in whole.as_json().items() if k not in ("beats", "disputed")},
        },
        "beside": [_beside(other) for other in beside],
    }


def _beside(log: EvalLog) -> dict[str, Any]:
    found = run_figures(log)
    return {
        "run": _run(log),
        "made_with": identity_of(log),
        "outcomes": counts_of(list(found.results)),
        "figures": _figures(found),
    }


def _run(log: EvalLog) -> dict[str, Any]:
    task = log.eval
    return {
        "name": run_name(log),
        "folder": str((task.metadata or {}).get("run") or ""),
        "log": log.location,
        "status": log.status,
        "task": task.task,
        "agent": (task.solver or "").rpartition("/")[2],
        "model": task.model,
        "agent_arguments": dict(task.solver_args_passed or {}),
        "began": str(task.created),
        "repeats": task.config.epochs or 1,
    }


def _figures(run: RunFigures) -> dict[str, Any]:
    return {name: _summary(found) for name, found in run.figures.items()}


def _summary(found: Summary) -> dict[str, Any]:
    by_prompt = {
        p: {"values": list(v), "mean": found.means[p], "interval": (i := found.intervals[p]) and [i.low, i.high]}
        for p, v in found.values.items()
    }
    interval = found.interval
    return {
        "average": found.average,
        "interval": interval and [interval.low, interval.high],
        "prompts": len(found.means),
        "prompts_scored": found.scored,
        "by_prompt": by_prompt,
    }


def _key(sample: EvalSample) -> str:
    return f"{sample.id}:{sample.epoch}"


def _beats(log: EvalLog, results: Sequence[SampleResult], notes: Mapping[str, BeatNotes]) -> dict[str, Agreement]:
    """By sample and repeat; without the judge's Caus there is nothing to compare."""
    found = {}
    for sample, result in zip(log.samples or (), results, strict=True):
        judge = judged_beats(sample)
        if judge:
            note = notes.get(_key(sample)) or notes.get(str(sample.id)) or BeatNotes()
            found[_key(sample)] = compare_beats(
                list(judge), server_beats(sample, result), judge, pairs=note.pairs, ruled=note.ruled
            )
    return found


def judged_beats(sample: EvalSample) -> dict[str, float | None]:
    """Completion of each beat of the prompt as the judge of Caus saw it, in their order."""
    score = (sample.scores or {}).get("caus")
    answers = dict(score.metadata or {}).get("answers", ()) if score is not None else ()
    kinds = [(a["key"].split(":"), a["scores"]) for a in answers]
    return {key[1]: (scores or {}).get("completion") for key, scores in kinds if key[0] == "causal_beat"}


def server_beats(sample: EvalSample, result: SampleResult) -> dict[str, str]:
    """Status of each beat of the specification of the world that was judged.

    The sample's own matrix tells which beats there are; `verify` has the word: what it found open is that, and of the rest only what the
    matrix has as passed has passed.
    """
    record = Record(Path(result.record)).read("matrix.json") if result.record else None
    rows: Mapping[str, Any] = ((record or {}).get(result.world) or {}).get("rows") or {}
    score = (sample.scores or {}).get("verified")
    verdict = dict((score.metadata or {}) if score is not None else {}).get("verdict") or {}
    opened = {str(r.get("id")): str(r.get("status", "unverified")) for r in verdict.get("failing") or ()}
    return {
        name.removeprefix("beat:"): opened.get(name, "pass" if verdict.get("rows") and row["status"] == "pass" else "unverified")
        for name, row in rows.items()
        if name.startswith("beat:")
    }


def _film(sample: EvalSample) -> dict[str, Any] | None:
    """Path, hash, frames, rate and size of the film of a sample; None where there is none."""
    try:
        film = sample_output(sample.metadata).need_film()
        with film.path.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
        return {
            "path": str(film.path),
            "sha256": digest,
            "frames": film.count,
            "fps": film.fps,
            "height": film.size[0],
            "width": film.size[1],
        }
    except WorldAgentError:
        return None

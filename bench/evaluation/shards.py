"""A run spread over workers: each sample is an evaluation of its own, and their logs become one.

`python -m worldagent.bench.evaluation.shards` is such a worker. It reads arguments of `run_task` from standard input and prints where its
log lies. A worker that dies leaves its sample to another one, in a new folder; a sample that came to an end is never run again, and
only logs that a worker handed over count, so that nothing is lost or there twice.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...execution import die_with_parent
from ...worlds.errors import InputError
from .executors import Executor

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog

__all__ = ["main", "merged", "run_spread"]


def run_spread(
    executor: Executor, task: str, agent: str, ids: Sequence[str], *, root: Path, log_dir: Path | None = None, **options: Any
) -> EvalLog:
    """Run samples of a task on an executor; the log of all of them, in the order of `ids`.

    Args:
        executor: runs the workers.
        task: name of a task.
        agent: name of an agent.
        ids: of the samples.
        root: folder of runs, which all workers see.
        log_dir: where the joined log goes; default `logs` in that.
        options: further ones of `run_task`, as data.

    Raises:
        InputError: there is no sample to run.
        EngineError: a worker failed.
    """
    from inspect_ai.log import read_eval_log, write_eval_log

    if not ids:
        raise InputError("there is no sample to run")
    parts = root / "parts"
    common = {"task": task, "agent": agent, "root": str(root), "log_dir": str(parts), "max_samples": 1, **options}
    payloads = [{**common, "sample_id": [name]} for name in ids]
    found: dict[int, EvalLog] = {}
    for done in executor.map("worldagent.bench.evaluation.shards", payloads):
        found[done.number] = read_eval_log(done.result["log"])
        again = f", after {done.deaths} lost workers" if done.deaths else ""
        print(f"{ids[done.number]}: {done.result['status']}{again}", file=sys.stderr, flush=True)
    log = merged([found[k] for k in range(len(ids))])
    place = log_dir or root / "logs"
    place.mkdir(parents=True, exist_ok=True)
    log.location = str(place / f"{Path(found[0].location).stem}_joined.eval")
    write_eval_log(log, log.location)
    return log


def merged(logs: Sequence[EvalLog]) -> EvalLog:
    """One log of several of the same task, agent and model: their samples, the metrics over all, and what they used together.

    Raises:
        InputError: they are not of the same task, agent and model, or a sample is there twice.
    """
    from inspect_ai.log import recompute_metrics

    # Metrics are joined where the first samples had any.
    first = next((log for log in logs if log.results is not None and log.results.scores), logs[0])
    for log in logs:
        for what in ("task", "task_version", "model", "solver", "solver_args"):
            one, other = getattr(first.eval, what), getattr(log.eval, what)
            if one != other:
                raise InputError(f"logs of different runs are not joined: {what} is {one!r} and {other!r}")
    joined = first.model_copy(deep=True)
    samples = [sample for log in logs for sample in log.samples or ()]
    places = [(sample.id, sample.epoch) for sample in samples]
    if len(set(places)) < len(places):
        raise InputError(f"a sample is there twice: {max(places, key=places.count)}")
    joined.samples = samples
    ids = list(dict.fromkeys(str(sample.id) for sample in samples))
    joined.eval.dataset.samples, joined.eval.dataset.sample_ids = len(ids), ids
    joined.status = "success" if all(log.status == "success" for log in logs) else "error"
    if joined.results is not None:
        joined.results.total_samples = len(samples)
        joined.results.completed_samples = sum(sample.error is None for sample in samples)
    if any(sample.scores for sample in samples):
        recompute_metrics(joined)
    joined.stats.started_at = min(log.stats.started_at for log in logs)
    joined.stats.completed_at = max(log.stats.completed_at for log in logs)
    joined.stats.model_usage = {}
    for log in logs:
        for name, usage in log.stats.model_usage.items():
            known = joined.stats.model_usage.get(name)
            joined.stats.model_usage[name] = usage if known is None else known + usage
    return joined


def main() -> None:
    """Run one part of a run; the last line of standard output tells status and log."""
    payload: dict[str, Any] = json.loads(sys.stdin.read())
    die_with_parent(payload.pop("parent"))
    from .commands import run_task

    root, log_dir = Path(payload.pop("root")), Path(payload.pop("log_dir"))
    log = run_task(payload.pop("task"), payload.pop("agent"), root=root, log_dir=log_dir, display="none", **payload)
    print(json.dumps({"status": log.status, "log": log.location}))


if __name__ == "__main__":
    main()

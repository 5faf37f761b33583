"""Finished runs for tests: prompts of the benchmark through a fake server, with films put beside their samples."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from inspect_ai.log import EvalLog, write_eval_log
from inspect_ai.scorer import Score
from worldagent.bench.evaluation.commands import run_task
from worldagent.tests.bench.evaluation.films import film_file

__all__ = ["finished_run", "with_scores"]


def finished_run(root: Path, documents: Callable[..., Path], names: tuple[str, ...]) -> EvalLog:
    """A run of these prompts of the benchmark, each of which calls its server twice and is refused once; every sample stands for two repeats."""
    folder = documents(**{name: [{}, {"do": "refuse"}] for name in names})
    log: EvalLog = run_task("agenticsimbench", "scripted", root=root, agent_args={"folder": str(folder)}, sample_id=list(names))
    for sample in log.samples or ():
        sample.metadata["film"] = str(film_file(root / f"{sample.id}_{sample.epoch}.avi", 40))
    log.samples = [copy.deepcopy(s).model_copy(update={"epoch": epoch}) for s in log.samples or () for epoch in (1, 2)]
    log.eval.config.epochs = 2
    write_eval_log(log)
    return log


def with_scores(log: EvalLog, values: Mapping[str, Mapping[str, Any]], **told: Any) -> EvalLog:
    """A copy of a run whose samples have these values, by metric and prompt."""
    made = copy.deepcopy(log)
    for sample in made.samples or ():
        scores = {m: Score(value=by_prompt[str(sample.id)], metadata=told) for m, by_prompt in values.items()}
        sample.scores = {**(sample.scores or {}), **scores}
    return made

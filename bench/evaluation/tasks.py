"""Tasks: the paper's benchmark, its short set, and a smoke test, on Inspect."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

from inspect_ai import Task, task
from inspect_ai.dataset import MemoryDataset, Sample
from inspect_ai.model import ChatMessageUser
from inspect_ai.solver import Generate, Solver, TaskState, solver

from ...worlds.ablation import ABLATIONS
from ...worlds.errors import InputError
from .agents.react import react_agent
from .attempts import Budget, begin, settle
from .prompting import TEMPLATE_VERSION, prompt_digest, task_prompt
from .prompts.reading import PromptSet, load_set
from .scorers import verified
from .scoring import metric_names, metric_scorers
from .serving import preflight, server_command, server_environment
from .workspace import new_run

__all__ = [
    "TIME_LIMIT_S",
    "TOKEN_LIMIT",
    "agenticsimbench",
    "sample_ids",
    "scene_samples",
    "small",
    "smoke",
    "task_of",
    "with_metrics",
]

DEFAULT_ROOT = "worldagent-eval"
"""Folder of runs, below the present one, where nobody names another."""
TIME_LIMIT_S, TOKEN_LIMIT = 4 * 3600, 5_000_000
"""Limits of a sample of the benchmark: own choice, above what scripted agents need with repairs."""
SMOKE = ("two_blocks",)
"""Examples of the skill `world-building` whose prompts make up the smoke test."""


def scene_samples(scenes: Sequence[dict[str, Any]]) -> MemoryDataset:
    """Samples of scenes: each gets the number of its folder, and its prompt as text.

    Args:
        scenes: with `id`, `text` and `setting`; whatever else they have goes into the metadata.
    """
    samples = [
        Sample(id=scene["id"], input=scene["text"], metadata={"example": k, "scene": scene})
        for k, scene in enumerate(scenes, start=1)
    ]
    return MemoryDataset(samples, name="scenes")


def sample_ids(name: str, prompts: str = "") -> list[str]:
    """Ids of the samples of a task, without making one.

    Args:
        name: of the task.
        prompts: another set, by the path of its JSON file.
    """
    return list(SMOKE) if name == "smoke" else [prompt.id for prompt in load_set(prompts or name).prompts]


@task
def agenticsimbench(
    prompts: str = "agenticsimbench",
    root: str = "",
    ablation: str = "",
    calls: int = 600,
    device_s: float = 6 * 3600.0,
    film: bool = True,
    replay: bool = True,
    metrics: str = "",
) -> Task:
    """The thirteen prompts of AgenticSimBench (ours: the paper's are unpublished).

    Args:
        prompts: another set, by the path of its JSON file.
        root: folder of runs; default `worldagent-eval` below the present folder.
        ablation: checks to leave out: navigability, static, category, causal or all.
        calls: tool calls per sample.
        device_s: seconds of jobs per sample.
        film: ask for the final sequence too.
        replay: verify by simulating intervals again.
        metrics: to score beside the verdict, with commas, or all; some need `--model-role grader=PROVIDER/MODEL`.
    """
    made = task_of(load_set(prompts), Budget(calls, device_s), root=root, ablation=ablation, film=film, replay=replay)
    return with_metrics(made, metrics)


@task
def small(
    prompts: str = "small",
    root: str = "",
    ablation: str = "",
    calls: int = 120,
    device_s: float = 1800.0,
    film: bool = False,
    replay: bool = True,
    metrics: str = "",
) -> Task:
    """The short set: a small prompt per capability. Arguments as of `agenticsimbench`."""
    budget = Budget(calls, device_s)
    made = task_of(load_set(prompts), budget, root=root, ablation=ablation, film=film, replay=replay, time_limit=3600)
    return with_metrics(made, metrics)


def with_metrics(made: Task, metrics: str) -> Task:
    """The task, whose samples are scored by these metrics beside the verdict."""
    made.scorer = [*(made.scorer or ()), *metric_scorers(metric_names(metrics))]
    return made


@task
def smoke(
    root: str = "",
    ablation: str = "",
    calls: int = 60,
    device_s: float = 600.0,
    film: bool = False,
    replay: bool = False,
    call_timeout_s: float = 600.0,
) -> Task:
    """A prompt of an example that ships with the skills, for a look whether everything works. Arguments as of `agenticsimbench`."""
    scenes = [_shipped(name) for name in SMOKE]
    budget = Budget(calls, device_s, call_timeout_s)
    return task_of(scenes, budget, root=root, ablation=ablation, film=film, replay=replay, time_limit=1800)


def _shipped(name: str) -> dict[str, Any]:
    path = files("worldagent.skills") / "world-building" / "examples" / f"{name}.json"
    return {"id": name, "text": json.loads(path.read_text(encoding="utf-8"))["prompt"], "setting": "interior"}


def task_of(
    scenes: PromptSet | Sequence[dict[str, Any]],
    budget: Budget,
    *,
    root: str,
    ablation: str,
    film: bool,
    replay: bool,
    time_limit: int = TIME_LIMIT_S,
) -> Task:
    """A task over scenes, in a new folder of runs.

    Args:
        scenes: a set of prompts, or as of `scene_samples`.
        budget: of every sample.
        root: folder of runs; default `worldagent-eval` below the present folder.
        ablation: checks to leave out.
        film: ask for the final sequence too.
        replay: verify by simulating intervals again.
        time_limit: of a sample [s].

    Raises:
        InputError: there is no such ablation.
    """
    if ablation and ablation not in ABLATIONS:
        raise InputError(f"ablation {ablation!r} must be one of {', '.join(ABLATIONS)}, or empty")
    told = [p.model_dump(mode="json") for p in scenes.prompts] if isinstance(scenes, PromptSet) else scenes
    known = {"name": scenes.name, "version": scenes.version, "sha256": scenes.digest} if isinstance(scenes, PromptSet) else {}
    run = new_run(Path(root or DEFAULT_ROOT))
    return Task(
        dataset=scene_samples(told),
        setup=prepared(str(run), asdict(budget), ablation, film),
        solver=react_agent(),
        cleanup=settle,
        scorer=verified(replay=replay),
        time_limit=time_limit,
        token_limit=TOKEN_LIMIT,
        fail_on_error=False,
        continue_on_fail=True,
        metadata={
            "run": str(run),
            "budget": asdict(budget),
            "ablation": ablation,
            "prompts": known,
            "template": {"version": TEMPLATE_VERSION, "sha256": prompt_digest()},
        },
    )


@solver
def prepared(run: str, budget: dict[str, Any], ablation: str, film: bool) -> Solver:
    """Take a folder, ask the server what it is, and write the whole prompt.

    Args:
        run: folder of the run.
        budget: fields of `Budget`.
        ablation: name, or empty.
        film: ask for the final sequence too.
    """

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        told = dict(state.metadata)
        asked = Path(run) / "records"  # an empty workspace for the question is none of a sample
        found = await preflight(server_command(asked), server_environment(ablation))
        scene = told["scene"]
        made = begin(state, Path(run), Budget(**budget), example=int(told["example"]), prompt=scene["text"], ablation=ablation)
        state.metadata["preflight"] = found.told()
        text = task_prompt(
            scene["text"], example=made.example, setting=scene["setting"], instructions=found.instructions, film=film
        )
        state.messages = [ChatMessageUser(content=text)]
        return state

    return solve

"""`worldagent eval`: a thin front of Inspect. `inspect eval worldagent/smoke --solver worldagent/scripted` does the same."""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...worlds.ablation import ABLATIONS
from ...worlds.errors import EngineError, InputError
from .later_commands import WITHOUT_INSPECT, add_judge, add_later_commands, judge_of, pairs_of

if TYPE_CHECKING:
    from inspect_ai.solver import Solver

__all__ = ["main", "run_task"]


def main(argv: Sequence[str]) -> int:
    """Run one command; 1 where a sample was an error, whatever the others came to.

    Raises:
        EngineError: Inspect is not installed, or the server does not start.
        InputError: an argument is out of range.
    """
    parser = argparse.ArgumentParser(prog="worldagent eval", description=__doc__, allow_abbrev=False)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    commands.add_parser("list", help="tasks, agents and ablations").set_defaults(command=_list)
    _add_run(commands.add_parser("run", help="run a task with an agent"))
    skills = commands.add_parser(
        "skills", help="run the short set against two states of skill and tool texts, and say what moved"
    )
    _add_run(skills, task="small")
    skills.set_defaults(command=_skills)
    skills.add_argument(
        "--against",
        required=True,
        metavar="REV_OR_FOLDER",
        help="the earlier state: a git revision of this tree, or a folder of another",
    )
    skills.add_argument("--seed", type=int, default=1, metavar="N", help="of the draws")
    add_later_commands(commands.add_parser)
    options = parser.parse_args(argv)
    if options.command not in WITHOUT_INSPECT:
        _require_inspect()
    code: int = options.command(options)
    return code


def _add_run(run: argparse.ArgumentParser, *, task: str | None = None) -> None:
    """Options of a run; where the task is given, it is no argument."""
    run.set_defaults(command=_run, task=task)
    if task is None:
        run.add_argument("task", metavar="TASK", help="agenticsimbench, small or smoke")
    run.add_argument("--agent", default="react", help="react, claude_code, codex_cli, scripted, replay, random or external")
    run.add_argument("--model", help="e.g. anthropic/NAME; agents that need none take none")
    run.add_argument("--prompts", metavar="FILE", help="a set of prompts of your own, instead of the task's")
    run.add_argument("--limit", type=int, metavar="N", help="the first N samples only")
    run.add_argument("--samples", metavar="ID,ID", help="these samples only")
    run.add_argument("--epochs", type=int, default=1, metavar="N", help="times each sample is run")
    run.add_argument("--max-samples", type=int, metavar="N", help="samples at a time (default: one for every two cores)")
    run.add_argument("--retries", type=int, default=1, metavar="N", help="further attempts at a sample that was an error")
    run.add_argument("--root", type=Path, metavar="DIR", help="folder of runs (default: ./worldagent-eval)")
    run.add_argument("--log-dir", type=Path, metavar="DIR", help="folder of Inspect's logs (default: DIR/logs)")
    run.add_argument("--time", type=int, metavar="S", help="seconds per sample")
    run.add_argument("--tokens", type=int, metavar="N", help="tokens per sample")
    run.add_argument("--calls", type=int, metavar="N", help="tool calls per sample")
    run.add_argument("--device-s", type=float, metavar="S", help="seconds of jobs per sample")
    run.add_argument(
        "--ablation", default="", choices=("", *ABLATIONS), help="leave these checks out; nothing of it is an acceptance"
    )
    run.add_argument(
        "--executor", choices=("", "local", "ray"), default="", help="spread samples over processes, or over a Ray cluster"
    )
    run.add_argument("--workers", type=int, default=2, metavar="N", help="of the executor (default: %(default)s)")
    run.add_argument("--cluster", default="local", metavar="ADDRESS", help="of Ray; `local` starts one here (default)")
    run.add_argument(
        "--agent-arg", action="append", default=[], metavar="NAME=VALUE", help="argument of the agent, as replay's recording"
    )
    run.add_argument(
        "--metrics",
        default="",
        metavar="NAME,NAME",
        help="pen, caus, qual, comp, align, imag, prod, or all: scored beside the verdict",
    )
    add_judge(run)
    run.add_argument("--model-arg", action="append", default=[], metavar="NAME=VALUE", help="argument of the model")


def _require_inspect() -> None:
    from importlib.util import find_spec

    if find_spec("inspect_ai") is None:
        raise EngineError("evaluations need inspect_ai, which is not installed: pip install 'worldagent[eval]'")


def _list(options: argparse.Namespace) -> int:
    from .registry import AGENTS, MODELS, TASKS

    found = {"tasks": list(TASKS), "agents": {n: "needs a model" if n in MODELS else "needs no model" for n in AGENTS}}
    print(json.dumps({**found, "ablations": {k: sorted(v) for k, v in ABLATIONS.items()}}, indent=1))
    return 0


def _run(options: argparse.Namespace) -> int:
    from .results import counts_of, samples_of

    log = _run_with(options, _metrics_before(options))
    results = samples_of(log)
    for result in results:
        print(f"{result.outcome:9s} {result.id}: {result.reason}", file=sys.stderr)
    told = {"task": options.task, "agent": options.agent, "model": log.eval.model, "status": log.status, "log": log.location}
    print(json.dumps({**told, "outcomes": counts_of(results), "samples": [asdict(r) for r in results]}))
    return 1 if log.status != "success" or any(r.outcome == "error" for r in results) else 0


def _spread(options: argparse.Namespace, chosen: list[str] | None, asked: dict[str, Any]) -> Any:
    from .executors import executor_of
    from .shards import run_spread
    from .tasks import DEFAULT_ROOT, sample_ids

    ids = chosen or sample_ids(options.task, options.prompts or "")[: options.limit]
    executor = executor_of(options.executor, options.workers, options.cluster)
    root = (options.root or Path(DEFAULT_ROOT)).absolute()
    return run_spread(executor, options.task, options.agent, ids, root=root, log_dir=options.log_dir, **asked)


def _skills(options: argparse.Namespace) -> int:
    from .skill_states import compare_states, differing_texts, server_of_tree, this_server, tree_of

    with tree_of(options.against) as other:
        changed = differing_texts(other)
        if not changed["texts"]:
            print(f"no text of a skill or a tool differs from {options.against}", file=sys.stderr)
        if changed["else"]:
            print(
                f"beside texts {len(changed['else'])} files differ, to which a movement may be due: {', '.join(changed['else'][:5])}",
                file=sys.stderr,
            )
        judge = _metrics_before(options, runs=2)
        states = {options.against: server_of_tree(other), "this tree": this_server()}
        found = compare_states(states, lambda name: _run_with(options, judge), seed=options.seed)
    for line in found["says"]:
        print(line, file=sys.stderr)
    print(json.dumps({**found, "changed": changed}))
    return 0


def _run_with(options: argparse.Namespace, judge: Any) -> Any:
    """Run the task of the options; Inspect's log of it."""
    given = {k: getattr(options, k) for k in ("ablation", "calls", "device_s", "prompts")}
    arguments = {k: v for k, v in given.items() if v not in (None, "")}
    if options.metrics:
        arguments["metrics"] = options.metrics
    chosen = options.samples.split(",") if options.samples else None
    asked = {
        "model": options.model,
        "task_args": arguments,
        "agent_args": pairs_of(options.agent_arg),
        "model_args": pairs_of(options.model_arg),
        "epochs": options.epochs,
        "retry_on_error": options.retries,
        "time_limit": options.time,
        "token_limit": options.tokens,
    }
    asked = {k: v for k, v in asked.items() if v is not None}
    if options.executor:
        if judge is not None:
            raise InputError(
                "metrics that ask a judge are taken after a run that is spread: worldagent eval score RUN --metrics ... --judge ..."
            )
        return _spread(options, chosen, asked)
    more = {"limit": options.limit, "sample_id": chosen, "max_samples": options.max_samples}
    roles = None if judge is None else {"grader": judge}
    return run_task(options.task, options.agent, root=options.root, log_dir=options.log_dir, model_roles=roles, **more, **asked)


def _metrics_before(options: argparse.Namespace, *, runs: int = 1) -> Any:
    """The judge of so many runs, or None; what it will cost goes to stderr before anything starts.

    Raises:
        InputError: a metric is unknown, has no judge, or the task has no prompts of the benchmark.
    """
    from .metrics.scorers import prices_of
    from .prompts.reading import load_prompts
    from .scoring import forecast_prompts, metric_names, need_judge

    names = metric_names(options.metrics)
    if not names:
        return None
    if options.task == "smoke":
        raise InputError(
            "the task 'smoke' has no prompt of the benchmark, so that no metric scores it; take small or agenticsimbench"
        )
    asking = need_judge(names, options.judge)
    if not asking:
        return None
    prompts = list(load_prompts(options.prompts or options.task).values())
    wanted = [p for p in prompts if p.id in options.samples.split(",")] if options.samples else prompts[: options.limit]
    told = forecast_prompts(wanted, asking, epochs=runs * options.epochs, prices=prices_of(options.prices))
    print(f"judge {options.judge} for {', '.join(asking)}, at most: {told.words()}", file=sys.stderr, flush=True)
    return judge_of(options)


def run_task(
    task: str,
    agent: str,
    *,
    root: Path | None = None,
    log_dir: Path | None = None,
    model: str | None = None,
    task_args: dict[str, Any] | None = None,
    agent_args: dict[str, Any] | None = None,
    **options: Any,
) -> Any:
    """Run a task with an agent; Inspect's log of it.

    Args:
        task: name of a task.
        agent: name of an agent.
        root: folder of runs.
        log_dir: of Inspect's logs; default `logs` in that.
        model: of the agent.
        task_args: of the task.
        agent_args: of the agent.
        options: of `inspect_ai.eval`, `time_limit` and `token_limit` among them.

    Raises:
        InputError: there is no such task or agent, or the agent needs a model.
        EngineError: the server does not start, or lacks tools.
    """
    from inspect_ai import eval as run_eval

    from .registry import AGENTS, MODELS, TASKS
    from .serving import preflight, server_command, server_environment
    from .tasks import DEFAULT_ROOT

    for what, name, known in (("task", task, TASKS), ("agent", agent, AGENTS)):
        if name not in known:
            raise InputError(f"{what} {name!r} must be one of {', '.join(known)}")
    if agent in MODELS and model is None:
        raise InputError(f"the agent {agent!r} needs a model, e.g. --model anthropic/claude-opus-5")
    place, given = (root or Path(DEFAULT_ROOT)).absolute(), dict(task_args or {})
    place.mkdir(parents=True, exist_ok=True)
    asyncio.run(preflight(server_command(place), server_environment(given.get("ablation", ""))))
    made = TASKS[task](root=str(place), **given)
    options = {k: v for k, v in options.items() if v is not None and v != {}}
    options.setdefault("max_samples", max(1, (os.cpu_count() or 2) // 2))
    solver: Solver = AGENTS[agent](**(agent_args or {}))
    logs = run_eval(
        made,
        model=model or "none",
        solver=solver,
        log_dir=str(log_dir or place / "logs"),
        display=options.pop("display", "plain" if sys.stderr.isatty() else "none"),
        score_on_error=False,
        **options,
    )
    return logs[0]

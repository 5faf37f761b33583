"""A sample ends with its reason, whatever its server or its agent does, and the run goes on."""

from __future__ import annotations

import json
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import anyio
import pytest
from inspect_ai import eval as run_eval
from inspect_ai.agent import Agent, AgentState, agent
from inspect_ai.log import EvalLog
from inspect_ai.solver import Solver
from mcp import Client, StdioServerParameters
from worldagent.bench.evaluation import commands
from worldagent.bench.evaluation.attempts import Budget
from worldagent.bench.evaluation.prompts.reading import load_set
from worldagent.bench.evaluation.records import Record
from worldagent.bench.evaluation.registry import TASKS, claude_code, codex_cli, external, random_calls, react_agent, scripted
from worldagent.bench.evaluation.relay import MOST_BYTES
from worldagent.bench.evaluation.results import SampleResult, counts_of, samples_of
from worldagent.bench.evaluation.serving import preflight
from worldagent.bench.evaluation.tasks import task_of
from worldagent.server.cli import main as command_line
from worldagent.worlds.errors import EngineError, InputError

# Inspect leaves memory streams of its own to the collector, which says so in whatever test comes next, and calls deprecated arguments.
pytestmark = pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning", "ignore::DeprecationWarning"
)
Fake = Callable[[str], None]
BUDGET = Budget(calls=6, device_s=60.0, call_timeout_s=0.5, start_s=20.0)


def run(
    root: Path, names: Sequence[str], solver: Solver, *, budget: Budget = BUDGET, model: str = "none", **options: Any
) -> tuple[dict[str, SampleResult], EvalLog]:
    """Run samples of these names beside each other; results by sample."""
    scenes = [{"id": name, "text": f"A {name} falls.", "setting": "interior"} for name in names]
    task = task_of(scenes, budget, root=str(root / "runs"), ablation="", film=False, replay=False)
    (log,) = run_eval(task, model=model, solver=solver, log_dir=str(root / "logs"), display="none", **options)
    return {r.id: r for r in samples_of(log)}, log


def test_each_sample_ends_with_its_own_reason_and_the_others_go_on(
    tmp_path: Path, fake: Fake, documents: Callable[..., Path]
) -> None:
    hang = {"do": "hang", "world": "w"}
    folder = documents(
        crash=[{}, {"do": "crash"}],
        hang=[hang] * 4,
        flood=[{"do": "flood_bytes", "count": MOST_BYTES + 10}],
        greedy=[{}] * 9,
        patient=[hang, {}],
        fine=[{}, {"do": "refuse"}],
    )
    found, log = run(tmp_path, ["crash", "hang", "flood", "greedy", "patient", "fine", "unknown"], scripted(str(folder)))
    assert log.status == "success"
    assert {k: r.outcome for k, r in found.items()} == {
        "crash": "error", "hang": "error", "flood": "error", "greedy": "limit", "patient": "refused", "fine": "refused", "unknown": "error",
    }  # fmt: skip
    assert found["crash"].reason == "died: the server ended with code 7 while its client was there"
    assert found["hang"].reason.startswith("silent: 3 calls in a row had no answer within 0.5 s")
    assert found["flood"].reason.startswith(f"flood: one message of the server has more than {MOST_BYTES} bytes")
    assert (found["greedy"].limit, found["greedy"].reason) == ("calls", "calls: 7 calls, of which 6 are allowed")
    assert found["fine"].reason == "no world was made"
    assert (found["fine"].calls, found["fine"].refused_calls, found["patient"].calls) == (2, 1, 2)
    assert "no document for the sample 'unknown'" in found["unknown"].reason
    assert counts_of(list(found.values())) == {"accepted": 0, "refused": 2, "limit": 1, "error": 4}
    folders = {r.workspace for r in found.values()}
    assert len(folders) == len(found)
    assert {Path(f).name for f in folders} == {f"example_{k}" for k in range(1, 8)}
    assert not any(r.isolation for r in found.values())


def test_a_sample_whose_server_died_is_tried_again_in_another_folder(
    tmp_path: Path, fake: Fake, documents: Callable[..., Path]
) -> None:
    folder = documents(twice=[{"do": "crash_once", "marker": str(tmp_path / "mark")}])
    found, _ = run(tmp_path, ["twice"], scripted(str(folder)), retry_on_error=1)
    result = found["twice"]
    assert (result.outcome, result.attempts, Path(result.workspace).name) == ("refused", 2, "example_1_a1")
    first = Record(Path(result.record).with_name("example_1"))
    assert first.ending().type == "died"
    assert first.read("isolation.json") == []


def test_a_run_waits_no_longer_than_its_time(tmp_path: Path, fake: Fake) -> None:
    found, _ = run(tmp_path, ["late"], external(), time_limit=2)
    assert (found["late"].outcome, found["late"].limit) == ("limit", "time")


def test_a_loop_on_a_model_calls_the_tools_of_its_own_server(tmp_path: Path, fake: Fake) -> None:
    calls = tmp_path / "calls.json"
    told = {"world": "$world", "prompt": "$prompt"}
    calls.write_text(
        json.dumps(
            [
                {"tool": "edit_spec", "arguments": told},
                {"tool": "inspect_world", "arguments": {"world": "$world", "do": "refuse"}},
            ]
        )
    )
    found, log = run(tmp_path, ["cup", "jug"], react_agent(), model="scripted/x", model_args={"calls": str(calls)})
    assert {k: (r.outcome, r.calls, r.refused_calls, r.tokens) for k, r in found.items()} == {
        "cup": ("refused", 2, 1, 600), "jug": ("refused", 2, 1, 600),
    }  # fmt: skip
    assert found["jug"].model == "scripted/x"
    made = Record(Path(found["jug"].record)).calls()[0]
    assert made.arguments == {"world": "example_2", "prompt": "A jug falls."}
    sample = (log.samples or [])[0]
    prompt = sample.messages[0].text
    assert "Scene prompt (example_1, interior)" in prompt
    assert "Be fake." in prompt
    assert sample.metadata["preflight"]["tools"][0] == "edit_spec"


def test_a_loop_whose_server_dies_is_an_error_and_no_failed_agent(tmp_path: Path, fake: Fake) -> None:
    calls = tmp_path / "calls.json"
    calls.write_text(json.dumps([{"tool": "inspect_world", "arguments": {"world": "w", "do": "crash"}}] * 50))
    found, _ = run(tmp_path, ["cup"], react_agent(), model="scripted/x", model_args={"calls": str(calls)})
    assert (found["cup"].outcome, found["cup"].reason) == (
        "error",
        "died: the server ended with code 7 while its client was there",
    )


def test_random_calls_follow_from_their_seed(tmp_path: Path, fake: Fake) -> None:
    budget = Budget(calls=30, device_s=60.0)
    one, _ = run(tmp_path / "a", ["cup"], random_calls(seed=4, calls=8), budget=budget)
    two, _ = run(tmp_path / "b", ["cup"], random_calls(seed=4, calls=8), budget=budget)
    other, _ = run(tmp_path / "c", ["cup"], random_calls(seed=5, calls=8), budget=budget)
    made = [[(c.tool, c.arguments) for c in Record(Path(found["cup"].record)).calls()] for found in (one, two, other)]
    assert len(made[0]) == 8
    assert made[0] == made[1] != made[2]


def test_a_session_driven_from_elsewhere_connects_by_what_is_written_down(tmp_path: Path, fake: Fake) -> None:
    told: dict[str, Any] = {}

    def drive() -> None:
        while not (files := list(tmp_path.glob("runs/*/records/example_1/connect.json"))):
            time.sleep(0.02)
        connect = json.loads(files[0].read_text())
        told["prompt"] = Path(connect["prompt"]).read_text()

        async def talk() -> None:
            server = StdioServerParameters(command=connect["command"], args=connect["args"], env=connect["env"])
            async with Client(server, mode="legacy") as client:
                await client.call_tool("inspect_world", {"world": "w"})

        anyio.run(talk)
        Path(connect["done"]).write_text("I looked at it.")

    thread = threading.Thread(target=drive)
    thread.start()
    found, log = run(tmp_path, ["cup"], external(), time_limit=60)
    thread.join()
    assert (found["cup"].outcome, found["cup"].calls) == ("refused", 1)
    assert (log.samples or [])[0].output.completion == "I looked at it."
    assert "A cup falls." in told["prompt"]


@pytest.mark.parametrize(("mode", "reason"), [("poor", "lacks the tools bake_sim"), ("dead", "does not start")])
def test_a_server_that_cannot_serve_is_found_out_before_the_run(mode: str, reason: str, tmp_path: Path, fake: Fake) -> None:
    fake(mode)
    with pytest.raises(EngineError, match=reason):
        commands.run_task("smoke", "scripted", root=tmp_path)


def test_a_missing_executable_is_found_out_before_the_run() -> None:
    with pytest.raises(EngineError, match="executable '/nowhere/worldagent' is missing"):
        anyio.run(preflight, ["/nowhere/worldagent", "serve"], {})


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["run", "nothing"], "task 'nothing' must be one of agenticsimbench, small, smoke"),
        (["run", "smoke", "--agent", "nobody"], "agent 'nobody' must be one of react"),
        (["run", "smoke"], "the agent 'react' needs a model"),
        (["run", "smoke", "--agent", "scripted", "--agent-arg", "x"], "'x' must be NAME=VALUE"),
    ],
)
def test_misuse_names_what_there_is(words: list[str], text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command_line(["eval", *words]) == 2
    assert text in capsys.readouterr().err


@pytest.mark.parametrize(("calls", "code", "outcome"), [([{}, {"do": "refuse"}], 0, "refused"), ([{"do": "crash"}], 1, "error")])
def test_the_command_prints_one_object_and_fails_where_a_sample_was_an_error(
    calls: list[dict[str, Any]],
    code: int,
    outcome: str,
    tmp_path: Path,
    fake: Fake,
    documents: Callable[..., Path],
    capsys: pytest.CaptureFixture[str],
) -> None:
    name = load_set("small").prompts[3].id
    words = ["run", "small", "--agent", "scripted", "--samples", name, "--agent-arg", f"folder={documents(**{name: calls})}"]
    words += ["--root", str(tmp_path / "runs"), "--calls", "9", "--time", "60", "--retries", "0"]
    assert command_line(["eval", *words]) == code
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert told["outcomes"][outcome] == 1
    (sample,) = told["samples"]
    assert (sample["id"], sample["agent"], sample["calls"]) == (name, "scripted", len(calls))
    assert Path(sample["workspace"]).name == "example_4"
    assert Path(told["log"]).is_file()


def test_the_list_names_tasks_agents_and_ablations(capsys: pytest.CaptureFixture[str]) -> None:
    assert command_line(["eval", "list"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["agents"]["external"] == "needs no model"
    assert told["ablations"]["static"] == ["interpenetration", "support"]


@pytest.mark.parametrize(("task", "count"), [("agenticsimbench", 13), ("small", 20)])
def test_a_task_has_a_sample_of_every_prompt_with_its_number_and_the_version_of_its_set(
    task: str, count: int, tmp_path: Path
) -> None:
    made = TASKS[task](root=str(tmp_path))
    found = load_set(task)
    samples = list(made.dataset)
    assert [s.id for s in samples] == [p.id for p in found.prompts]
    assert [s.metadata["example"] for s in samples if s.metadata] == list(range(1, count + 1))
    assert samples[0].input == found.prompts[0].text
    assert (made.metadata or {})["prompts"] == {"name": task, "version": found.version, "sha256": found.digest}
    assert (Path((made.metadata or {})["run"]) / "outputs").is_dir()


def test_an_unknown_ablation_makes_no_task(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="ablation 'gravity' must be one of"):
        task_of([], BUDGET, root=str(tmp_path), ablation="gravity", film=False, replay=False)


@pytest.mark.parametrize(("made", "package"), [(claude_code, "anthropic"), (codex_cli, "openai")])
def test_a_program_without_its_packages_is_refused_with_the_line_that_installs_them(
    made: Callable[[], Solver], package: str, tmp_path: Path, fake: Fake, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("worldagent.bench.evaluation.agents.clis.find_spec", lambda name: None)
    found, _ = run(tmp_path, ["cup"], made(), model="mockllm/model")
    assert found["cup"].outcome == "error"
    assert f"pip install inspect_swe {package}" in found["cup"].reason


@pytest.mark.parametrize(("made", "name"), [(claude_code, "claude_code"), (codex_cli, "codex_cli")])
def test_a_program_gets_the_server_of_its_sample_and_a_home_of_its_own(
    made: Callable[[], Solver], name: str, tmp_path: Path, fake: Fake, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: dict[str, Any] = {}

    @agent
    def program(**options: Any) -> Agent:
        async def execute(state: AgentState) -> AgentState:
            given.update(options)
            return state

        return execute

    module = ModuleType("inspect_swe")
    setattr(module, name, program)
    monkeypatch.setitem(sys.modules, "inspect_swe", module)
    monkeypatch.setattr("worldagent.bench.evaluation.agents.clis.find_spec", lambda name: object())
    found, _ = run(tmp_path, ["cup"], made(), model="mockllm/model")
    assert found["cup"].outcome == "refused"
    (server,) = given["mcp_servers"]
    assert (server.name, server.args[server.args.index("--record") + 1]) == ("worldagent", found["cup"].record)
    assert given["cwd"] == str(Path(found["cup"].record) / "home")

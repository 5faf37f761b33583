"""The harness with the real server: from a prompt to a verdict, the same again, at random, out of budget, and with a check left out."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.evaluation import smoke
from worldagent.bench.evaluation.commands import run_task
from worldagent.bench.evaluation.records import Record
from worldagent.bench.evaluation.results import SampleResult, samples_of
from worldagent.execution import JobStore

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings(
        "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning", "ignore::DeprecationWarning"
    ),
]
MARK = "no acceptance: an evaluation without causal"


def only(root: Path, agent: str, **options: Any) -> SampleResult:
    """The one sample of the smoke test."""
    (result,) = samples_of(run_task("smoke", agent, root=root, **options))
    return result


def test_the_smoke_benchmark_accepts_the_example_and_its_replay_and_nothing_at_random() -> None:
    found = smoke.run()
    assert {k: found[k] for k in ("samples", "scripted_accepted", "random_accepted", "replay_equal", "isolated")} == {
        "samples": 3, "scripted_accepted": 1, "random_accepted": 0, "replay_equal": 1, "isolated": 1,
    }  # fmt: skip


def test_a_model_in_a_loop_takes_the_example_to_acceptance_and_a_changed_recording_of_it_is_found_out(tmp_path: Path) -> None:
    spec = json.loads((files("worldagent.skills") / "world-building" / "examples" / "two_blocks.json").read_text())
    del spec["prompt"]
    world = {"world": "$world"}
    steps = [
        {"tool": "edit_spec", "arguments": {**world, "prompt": "$prompt", "spec": spec}},
        {"tool": "place_object", "arguments": world},
        {"tool": "probe_sim", "arguments": {**world, "wait_s": 120}},
        {"tool": "bake_sim", "arguments": {**world, "wait_s": 120}},
        {"tool": "run_checks", "arguments": {**world, "scope": "acceptance", "wait_s": 120}},
    ]
    calls = tmp_path / "calls.json"
    calls.write_text(json.dumps(steps))
    made = only(tmp_path, "react", model="scripted/x", model_args={"calls": str(calls)})
    assert (made.outcome, made.server_verdict, made.calls, made.tokens) == ("accepted", "accepted", 5, 1200)
    assert made.rows["pass"] > 80
    assert (made.rows["fail"], made.rows["unverified"], made.weakenings, made.isolation) == (0, 0, 0, ())
    assert made.readings == ("a hand's width further",)
    assert made.device_s > 0

    record = Record(Path(made.record))
    matrix = record.read("matrix.json")
    row = matrix["example_1"]["rows"]["beat:push"]
    row["measured"] = row["measured"] * (1 + 2**-52) + 2**-60
    record.write("matrix.json", matrix)
    lines = record.calls_file.read_text().splitlines()
    bake = next(k for k, line in enumerate(lines) if '"tool": "bake_sim"' in line)
    lines[bake] = lines[bake].replace('"frames": ', '"frames": 1', 1)
    record.calls_file.write_text("\n".join(lines) + "\n")
    again = only(tmp_path, "replay", agent_args={"recording": str(Path(made.workspace).parents[1])})
    assert again.outcome == "accepted"
    assert [d.partition(":")[0] for d in again.differences] == ["step 4, bake_sim", "example_1"]
    assert "row beat:push" in again.differences[1]


def test_a_sample_out_of_budget_leaves_no_job_behind(tmp_path: Path) -> None:
    result = only(tmp_path, "scripted", task_args={"device_s": 0.5})
    assert (result.outcome, result.limit) == ("limit", "device_s")
    assert "of which 0.5 s are allowed" in result.reason
    jobs = JobStore(Path(result.workspace)).list(pump=False)
    assert jobs
    assert all(job.ended for job in jobs)
    assert [job.state for job in jobs].count("cancelled") == len(Record(Path(result.record)).read("jobs.json")["cancelled"]) == 1


def test_an_evaluation_without_a_check_ends_ablated_and_is_no_acceptance(tmp_path: Path) -> None:
    result = only(tmp_path, "scripted", task_args={"ablation": "causal"})
    assert (result.outcome, result.server_verdict, result.ablation) == ("refused", "ablated", "causal")
    assert MARK in result.reason
    assert all(call.data["ablation"] == MARK for call in Record(Path(result.record)).calls() if call.tool != "job")

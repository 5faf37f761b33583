"""Parts of the harness by themselves: the prompt, random arguments, recordings, matrices, jobs that are left."""

from __future__ import annotations

import json
import os
import random
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

import anyio
import jsonschema  # type: ignore[import-untyped]
import pytest
from mcp import Client
from worldagent.bench.evaluation.agents.replay import recording_of, steps_of, verdict_in
from worldagent.bench.evaluation.agents.schemas import drawn
from worldagent.bench.evaluation.agents.scripted import document_of
from worldagent.bench.evaluation.attempts import device_seconds
from worldagent.bench.evaluation.cleanup import cancel_jobs
from worldagent.bench.evaluation.matrices import matrix_differences
from worldagent.bench.evaluation.prompting import prompt_digest, task_prompt
from worldagent.bench.evaluation.records import Call, Record
from worldagent.bench.evaluation.serving import server_environment
from worldagent.execution import JobStore
from worldagent.server.app import create_server
from worldagent.worlds.errors import InputError

ROOT = Path(__file__).parents[3]


def call(n: int, tool: str, data: Any, **more: Any) -> Call:
    return Call(
        **{
            "n": n,
            "tool": tool,
            "arguments": {"world": "w"},
            "at": 0,
            "seconds": 0,
            "ended": "answered",
            "error": False,
            "data": data,
        }
        | more
    )


# ---------------------------------------------------------------- prompt


def test_the_prompt_holds_scene_folder_and_instructions_and_nothing_of_blender() -> None:
    told = task_prompt("A cup falls for $5.", example="example_4", setting="interior", instructions="Call $edit_spec.", film=True)
    assert "\n\nA cup falls for $5.\n\n" in told
    assert "outputs/example_4/" in told
    assert told.endswith("Instructions of the server:\n\nCall $edit_spec.\n")
    assert "1920x1080" in told
    assert "1920x1080" not in task_prompt("A", example="e", setting="interior", instructions="", film=False)
    assert not {"Blender", "Cycles", "OptiX"} & set(told.replace(".", " ").split())
    assert len(prompt_digest()) == 64


# ---------------------------------------------------------------- random arguments


@pytest.fixture(scope="module")
def schemas() -> dict[str, Any]:
    """Schemas of the arguments of the server's tools."""

    async def listed(server: Any) -> dict[str, Any]:
        async with Client(server) as client:
            return {tool.name: tool.input_schema for tool in (await client.list_tools()).tools}

    return anyio.run(listed, create_server(Path("/nowhere")))


def test_random_arguments_have_the_types_that_a_schema_asks_for(schemas: dict[str, Any]) -> None:
    assert len(schemas) == 10
    wrong = []
    for name, schema in schemas.items():
        validator = jsonschema.Draft202012Validator(schema)
        for seed in range(20):
            found = drawn(schema, random.Random(seed))
            assert set(schema.get("required", ())) <= found.keys()
            wrong += [(name, e.validator, e.message[:90]) for e in validator.iter_errors(found)]
    # A pattern, an exact union or a uniqueness may be missed: what looks valid need not be.
    assert [w for w in wrong if w[1] in ("type", "enum", "required", "minimum", "maximum", "const")] == []


def test_equal_seeds_draw_equal_arguments(schemas: dict[str, Any]) -> None:
    schema = schemas["place_object"]
    assert drawn(schema, random.Random(3)) == drawn(schema, random.Random(3))
    assert len({json.dumps(drawn(schema, random.Random(k)), sort_keys=True) for k in range(6)}) > 1


# ---------------------------------------------------------------- recordings


def test_a_recording_without_its_waits_has_the_results_that_its_jobs_came_to() -> None:
    done = {"passed": True, "counts": {"pass": 3}, "open_rows": [{"id": "a", "status": "fail", "measured": 1.0}]}
    calls = [
        call(1, "probe_sim", {"state": "running", "job_id": "job_1"}),
        call(2, "job", {"state": "running", "job_id": "job_1"}, arguments={"action": "wait", "job_id": "job_1"}),
        call(3, "job", {"state": "done", "job_id": "job_1", "result": done}, arguments={"action": "wait", "job_id": "job_1"}),
        call(4, "edit_spec", "refused: no", error=True),
        call(5, "edit_spec", "no answer", ended="silent", error=True),
    ]
    probe, edit = steps_of(calls)
    assert (probe.tool, probe.outcome) == ("probe_sim", {"passed": True, "counts": {"pass": 3}, "open_rows": [["a", "fail"]]})
    assert (edit.tool, edit.error, edit.outcome) == ("edit_spec", True, {})


def test_a_verdict_is_what_a_reply_decides_and_not_what_it_says_beside() -> None:
    told = {"summary": "x", "seconds": 3.2, "verdict": "accepted", "audit": {"passed": False, "open_rows": []}}
    assert verdict_in(told) == {"verdict": "accepted", "audit": {"passed": False, "open_rows": []}}
    assert verdict_in("refused") == {}


def test_a_recording_is_found_by_its_sample_and_its_latest_attempt(tmp_path: Path) -> None:
    for k, (name, sample) in enumerate((("example_1", "cup"), ("example_1_a1", "cup"), ("example_2", "jug"))):
        record = Record(tmp_path / "records" / name)
        record.folder.mkdir(parents=True)
        record.write("start.json", {"sample": sample})
        record.calls_file.write_text(json.dumps(asdict(call(1, "job", {}))) + "\n")
        os.utime(record.calls_file, (k, k))
    assert recording_of(tmp_path, "cup").folder.name == "example_1_a1"
    with pytest.raises(InputError, match="holds no record of the sample 'pot'"):
        recording_of(tmp_path, "pot")


def test_matrices_differ_by_a_status_a_last_bit_a_row_or_a_world() -> None:
    rows = {"support:a": {"status": "pass", "measured": 0.1}, "scale:b": {"status": "pass", "measured": None}}
    one = {"w": {"revision": 3, "verdict": "accepted", "rows": rows}}

    def other(**changes: Any) -> dict[str, Any]:
        return {"w": {**one["w"], **changes}}

    assert matrix_differences(one, json.loads(json.dumps(one))) == []
    assert matrix_differences(one, other(verdict="incomplete")) == ["w: verdict was 'accepted', is 'incomplete'"]
    nearly = {**rows, "support:a": {"status": "pass", "measured": 0.1 + 2**-55}}
    assert len(matrix_differences(one, other(rows=nearly))) == 1
    assert len(matrix_differences(one, other(rows={k: rows[k] for k in ("scale:b",)}))) == 1
    assert matrix_differences(one, {}) == ["world 'w' is in one of them only"]


def test_a_document_that_is_not_there_is_refused_with_those_that_are(tmp_path: Path) -> None:
    assert "entities" in document_of("two_blocks", None)
    (tmp_path / "cup.json").write_text("{}")
    with pytest.raises(InputError, match="there are cup"):
        document_of("jug", tmp_path)


# ---------------------------------------------------------------- environment and jobs


def test_a_server_gets_neither_token_nor_workspace_nor_ablation_of_the_harness(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("WORLDAGENT_TOKEN", "WORLDAGENT_WORKSPACE", "WORLDAGENT_ABLATION", "AWS_SECRET_ACCESS_KEY", "ANTHROPIC_API_KEY"):
        monkeypatch.setenv(name, "causal")
    for name in ("CUDA_VISIBLE_DEVICES", "WORLDAGENT_WARM", "https_proxy"):
        monkeypatch.setenv(name, "0")
    found = server_environment()
    assert found.keys() >= {"CUDA_VISIBLE_DEVICES", "WORLDAGENT_WARM", "https_proxy"}
    assert "causal" not in found.values()
    assert server_environment("static")["WORLDAGENT_ABLATION"] == "static"
    with pytest.raises(InputError, match="ablation 'gravity'"):
        server_environment("gravity")


def test_jobs_that_a_sample_leaves_are_ended_and_their_seconds_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entries = ROOT / "tests" / "execution"
    monkeypatch.setenv("WORLDAGENT_TEST_ENTRIES", "execution_entries")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(entries), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.syspath_prepend(str(entries))
    assert cancel_jobs(tmp_path) == []
    assert device_seconds(tmp_path) == 0.0
    store = JobStore(tmp_path, slots=1)
    payload = {"gate": str(tmp_path / "never")}
    made = [store.submit("bake", "w", payload, entry="execution_entries:gated").id for _ in range(3)]
    while store.get(made[0]).state != "running":
        time.sleep(0.01)
    assert [j.state for j in store.list(pump=False)].count("queued") == 2
    assert sorted(cancel_jobs(tmp_path)) == sorted(made)
    assert {j.state for j in store.list(pump=False)} == {"cancelled"}
    assert device_seconds(tmp_path) > 0

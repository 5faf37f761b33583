"""Scenarios that the conformance run counts as passed: the run itself is `make conformance`."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from mcp import Client
from worldagent.server.app import create_server

RUN = Path(__file__).resolve().parents[1] / "conformance" / "run.py"


@pytest.fixture(scope="module")
def run() -> ModuleType:
    found = importlib.util.spec_from_file_location("worldagent_conformance_run", RUN)
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[found.name] = module
    found.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("seen", "wanted", "bad"),
    [
        ({"a": (2, 0)}, {"a": 2}, []),
        ({"a": (1, 0)}, {"a": 2}, ["suite: a", "suite"]),
        ({"a": (2, 1)}, {"a": 2}, ["suite: a", "suite"]),
        ({"a": (2, 0)}, {"a": 2, "b": 1}, ["suite: b"]),
        ({"a": (2, 0), "b": (0, 0)}, {"a": 2}, ["suite: b"]),
        ({}, {}, ["suite"]),
        ({"a": (2, 0), "server-sse-polling": (0, 1)}, {"a": 2}, []),
    ],
)
def test_fewer_checks_than_expected_are_a_failure(run: Any, seen: dict[str, Any], wanted: dict[str, int], bad: list[str]) -> None:
    assert [outcome.what for outcome in run._compared("suite", seen, wanted, 0.0) if not outcome.ok] == bad


def test_the_summary_of_the_suite_is_read(run: Any) -> None:
    text = "=== SUMMARY ===\n✓ tasks-lifecycle: 9 passed, 0 failed\n✗ server-sse-polling: 0 passed, 1 failed\n\nTotal: 9 passed\n"
    assert run._scenarios(text) == {"tasks-lifecycle": (9, 0), "server-sse-polling": (0, 1)}


def test_every_tasks_scenario_and_both_revisions_are_expected(run: Any) -> None:
    expected = json.loads((RUN.parent / "expected.json").read_text())
    for kind in ("fixtures", "real"):
        assert set(expected[kind]) == set(run.REVISIONS)
        assert all(count > 0 for counts in expected[kind].values() for count in counts.values())
    tasks = {name for name in expected["fixtures"]["2026-07-28"] if name.startswith("tasks-")}
    assert len(tasks) == 9
    assert tasks | set(run.NOT_CHECKED) >= {"tasks-lifecycle", "tasks-mrtr-input", "tasks-status-notifications"}


@pytest.mark.anyio
async def test_fixtures_are_served_only_on_demand_and_beside_the_real_tools(tmp_path: Path) -> None:
    async with Client(create_server(tmp_path)) as client:
        real = [tool.name for tool in (await client.list_tools()).tools]
        uris = [str(resource.uri) for resource in (await client.list_resources()).resources]
    async with Client(create_server(tmp_path, conformance=True)) as client:
        both = [tool.name for tool in (await client.list_tools()).tools]
    assert both[: len(real)] == real
    assert {"greet", "slow_compute", "test_simple_text", "test_tool_with_task"} <= set(both) - set(real)
    assert not [name for name in real if name.startswith("test_")]
    assert not [uri for uri in uris if uri.startswith("test:")]

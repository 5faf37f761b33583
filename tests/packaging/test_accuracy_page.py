"""The page about the accuracy of checks tells its data, and calls tables stale whose worlds or verifiers have changed since."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.defects import CHECKS
from worldagent.testing.defects.suites import suite_digest, verifiers_digest

DOCS = Path(__file__).parents[2] / "docs"
REFRESH = "run: python docs/generate_accuracy.py --refresh"


@pytest.fixture(scope="module")
def made() -> dict[str, Any]:
    return runpy.run_path(str(DOCS / "generate_accuracy.py"), run_name="generate_accuracy")


@pytest.fixture
def data() -> Any:
    return json.loads((DOCS / "accuracy.json").read_text())


def test_the_page_tells_its_data_and_which_tables_are_stale_today(made: dict[str, Any], data: Any) -> None:
    assert made["page"](data) == (DOCS / "accuracy.md").read_text(), REFRESH


def test_every_suite_has_its_table(data: Any) -> None:
    assert set(data["checks"]) == set(CHECKS)


def test_figures_of_todays_code_are_not_stale_and_others_are(made: dict[str, Any], data: Any) -> None:
    one = data["checks"]["scale"]
    fresh = {**one, "suite": suite_digest("scale"), "verifiers": verifiers_digest()}
    assert made["stale"]({"checks": {"scale": fresh}}) == {}
    assert made["stale"]({"checks": {"scale": {**fresh, "verifiers": "older"}}}) == {"scale": "the verifiers"}
    assert made["stale"]({"checks": {"scale": {**fresh, "suite": "older"}}}) == {"scale": "its worlds"}


def test_a_later_run_replaces_the_figures_of_its_checks_alone(made: dict[str, Any], data: Any) -> None:
    figures = {**data["checks"]["scale"], "detected": 1, "suite": "s"}
    run = {
        "checks": {"scale": figures},
        "verifiers": "v",
        "machine": {"processor": "p", "cores": 2},
        "date": "2026-11-23T10:00",
        "commit": "c",
        "seed": 1,
        "wall_s": 5.0,
    }
    later = made["joined"]([run], data)
    assert later["checks"]["scale"] == {**figures, "verifiers": "v"}
    assert {k: v for k, v in later["checks"].items() if k != "scale"} == {k: v for k, v in data["checks"].items() if k != "scale"}
    assert later["runs"][-1].startswith("Run of scale of 2026-11-23")

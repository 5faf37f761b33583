"""The solutions that a scripted agent plays: each is of its set's prompt, and the harness takes its world to acceptance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.evaluation.agents.scripted import document_of
from worldagent.bench.evaluation.commands import run_task
from worldagent.bench.evaluation.prompts.reading import load_prompts
from worldagent.bench.evaluation.results import SampleResult, samples_of
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.named_materials import declared_by_name, filled_materials
from worldagent.worlds.spec import WorldSpec

SOLUTIONS = Path(__file__).parents[3] / "bench" / "evaluation" / "solutions"
FOUND = sorted((folder.name, path.stem) for folder in SOLUTIONS.iterdir() if folder.is_dir() for path in folder.glob("*.json"))
WHOLE = [(kind, name) for kind, name in FOUND if "spec" in document_of(name, SOLUTIONS / kind)]
QUICK = ("crate_slides",)
"""Played by the fast tests too."""
NOISE = (
    "ignore::pytest.PytestUnraisableExceptionWarning",
    "ignore::ResourceWarning",
    "ignore::DeprecationWarning",
)
"""Warnings of Inspect's own loops and pipes."""


def told_prompts(document: Mapping[str, Any]) -> Iterator[str]:
    """Every prompt that a document names."""
    if "spec" in document:
        yield document["spec"]["prompt"]
    for call in document.get("calls", ()):
        if "prompt" in call["arguments"]:
            yield call["arguments"]["prompt"]


def played(kind: str, name: str, root: Path) -> SampleResult:
    """The one sample of a prompt, as the scripted agent left it."""
    folder = str(SOLUTIONS / kind)
    (result,) = samples_of(run_task(kind, "scripted", root=root, agent_args={"folder": folder}, sample_id=[name]))
    return result


def test_six_small_prompts_at_least_are_solved() -> None:
    assert len([name for kind, name in FOUND if kind == "small"]) >= 6
    assert {("small", name) for name in QUICK} <= set(FOUND)


@pytest.mark.parametrize(("kind", "name"), FOUND)
def test_a_solution_is_of_its_sets_prompt_to_the_letter_and_plays_a_spec_or_calls(kind: str, name: str) -> None:
    document = document_of(name, SOLUTIONS / kind)
    assert list(document) in (["spec"], ["calls"])
    assert list(told_prompts(document)) == [load_prompts(kind)[name].text]
    tools = [call["tool"] for call in document.get("calls", ())]
    assert tools[-1:] in ([], ["run_checks"])


@pytest.mark.parametrize(("kind", "name"), WHOLE)
def test_the_audit_of_a_whole_specification_passes_and_no_word_is_waived(kind: str, name: str) -> None:
    written = document_of(name, SOLUTIONS / kind)["spec"]
    assert not [claim for claim in written["claims"].values() if "waived" in claim]
    report = audit(declared_by_name(WorldSpec.model_validate(filled_materials(written))))
    assert report.passed, [row.id for row in report.rows if row.status == "fail"]


@pytest.mark.filterwarnings(*NOISE)
@pytest.mark.parametrize("name", QUICK)
def test_the_harness_takes_a_quick_solution_to_acceptance(name: str, tmp_path: Path) -> None:
    accepted(played("small", name, tmp_path))


@pytest.mark.slow
@pytest.mark.filterwarnings(*NOISE)
@pytest.mark.parametrize(("kind", "name"), [pair for pair in FOUND if pair[1] not in QUICK])
def test_the_harness_takes_every_solution_to_acceptance(kind: str, name: str, tmp_path: Path) -> None:
    accepted(played(kind, name, tmp_path))


def accepted(result: SampleResult) -> None:
    """It is accepted, as it was written: without a weakening, and with nothing shared."""
    assert (result.outcome, result.server_verdict) == ("accepted", "accepted"), result.reason
    assert (result.rows["fail"], result.rows["unverified"], result.weakenings, result.isolation) == (0, 0, 0, ())

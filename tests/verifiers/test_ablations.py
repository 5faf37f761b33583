"""An evaluation without a check lets through what that check would have caught, and nothing else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import suite_of
from worldagent.verifiers.acceptance import verdict_of
from worldagent.verifiers.checks import CHECKS, run_checks
from worldagent.verifiers.delivery.questions import NEEDED
from worldagent.worlds.ablation import ABLATIONS, ENV_ABLATION, ablation, ablation_words, require_whole
from worldagent.worlds.errors import InputError, RefusedError
from worldagent.worlds.requirements import Row

BROKEN = (
    ("navigability", "navigability", "narrow door"),
    ("static", "interpenetration", "sunk"),
    ("static", "support", "afloat"),
    ("category", "category", "energy_gain"),
    ("causal", "causal", "passes-by"),
    ("all", "support", "afloat"),
)
"""Ablation, suite of seeded defects, mechanism of it that breaks a world."""


def judged(suite: str, mechanism: str, folder: Path) -> dict[str, Row]:
    """Rows of all checks that only look, of a world broken by a mechanism."""
    found = next(m for m in suite_of(suite).mechanisms if m.name == mechanism)
    world = found.build(folder, found.high, np.random.default_rng(3))
    return {r.id: r for r in run_checks(world.candidate, reruns=False)}


def is_open(row: Row) -> bool:
    return row.mandatory and row.status in ("fail", "unverified")


@pytest.mark.parametrize(("name", "suite", "mechanism"), BROKEN)
def test_an_ablation_lets_through_what_its_check_catches_and_nothing_else(
    name: str, suite: str, mechanism: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = judged(suite, mechanism, tmp_path / "a")
    monkeypatch.setenv(ENV_ABLATION, name)
    without = judged(suite, mechanism, tmp_path / "b")
    caught = {i for i, r in whole.items() if is_open(r) and r.check in ABLATIONS[name]}
    assert any(whole[i].status == "fail" for i in caught)
    assert without.keys() == whole.keys()
    assert not {i for i in caught if is_open(without[i])}
    assert all(r.measured is None and not r.corrections for r in without.values() if r.check in ABLATIONS[name])
    left = {i: (r.status, r.measured) for i, r in without.items() if r.check not in ABLATIONS[name]}
    assert left == {i: (r.status, r.measured) for i, r in whole.items() if r.check not in ABLATIONS[name]}


@pytest.mark.parametrize("name", ABLATIONS)
def test_an_ablation_switches_off_checks_that_exist_and_leaves_the_frames_and_the_specification(name: str) -> None:
    assert ABLATIONS[name] <= {c.name for c in CHECKS} | {"review"}
    assert not ABLATIONS[name] & {"audit", "delivery"}


@pytest.mark.parametrize("name", ["", *ABLATIONS])
def test_only_a_process_with_every_check_accepts(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ENV_ABLATION, name)
    rows = [Row(id=f"{c}:x", check=c, group="physical", predicate="p", status="pass") for c in NEEDED]
    assert verdict_of(rows) == ("ablated" if name else "accepted")
    assert verdict_of([*rows, rows[0].model_copy(update={"status": "fail"})]) == "incomplete"


def test_an_unknown_ablation_is_refused_with_those_that_exist(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ENV_ABLATION, "gravity")
    with pytest.raises(InputError, match="'gravity' must be one of navigability, static, category, causal, all"):
        ablation()


def test_what_needs_every_check_is_refused_where_some_are_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ENV_ABLATION, "causal")
    with pytest.raises(RefusedError, match="verify needs every check, and WORLDAGENT_ABLATION='causal' switches some off"):
        require_whole("verify")
    assert ablation_words("static") == "no acceptance: an evaluation without interpenetration, support"

"""The verdict: which rows it needs, which candidate it is about, and what it is bound to (R117-R123)."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, get_args

import pytest
from worldagent.testing.worlds.small_worlds import box, ground, make_candidate, world
from worldagent.verifiers import acceptance
from worldagent.verifiers.acceptance import WaitingJudge, acceptance_subject, find_candidate, judge_fresh, verdict_of
from worldagent.verifiers.checks import CHECKS, names_of
from worldagent.verifiers.register.assemble import approximations
from worldagent.worlds.canonical import spec_digest
from worldagent.worlds.errors import EngineError, EvidenceError, RefusedError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.requirements import Check, Row
from worldagent.worlds.spec import Fastened, Limits, PathDriver, WorldSpec

FREEZE = "f" * 64


def row(check: str, status: str = "pass", *, mandatory: bool = True) -> Row:
    return Row(id=check, check=check, group="physical", predicate="p", status=status, mandatory=mandatory, artifact="x")  # type: ignore[arg-type]


def all_rows() -> list[Row]:
    return [row(c) for c in sorted(acceptance.NEEDED)]


def test_every_check_that_exists_is_needed() -> None:
    always = set(get_args(Check)) - {"relations", "robustness", "terrain", "claim", "review"}  # a world need not have such
    assert always == acceptance.NEEDED
    assert {c.name for c in CHECKS} | {"audit", "review"} == set(get_args(Check))
    assert set(names_of("full")) | {"audit"} >= acceptance.NEEDED


def test_all_passing_rows_are_accepted() -> None:
    assert verdict_of(all_rows()) == "accepted"
    assert verdict_of([*all_rows(), row("scale", "not_applicable")]) == "accepted"
    assert verdict_of([*all_rows(), row("scale", "fail", mandatory=False)]) == "accepted"


@pytest.mark.parametrize("status", ["fail", "unverified"])
def test_one_open_mandatory_row_is_incomplete(status: str) -> None:
    assert verdict_of([*all_rows(), row("scale", status)]) == "incomplete"


@pytest.mark.parametrize("check", sorted(acceptance.NEEDED))
def test_a_check_that_judged_nothing_is_incomplete(check: str) -> None:
    assert verdict_of([r for r in all_rows() if r.check != check]) == "incomplete"


def test_nothing_judged_is_incomplete() -> None:
    assert verdict_of([]) == "incomplete"


def test_an_unjudged_check_gets_a_row_that_says_what_to_do(tmp_path: Path) -> None:
    candidate = make_candidate(tmp_path, small(), stage="full")
    made = acceptance._unjudged(candidate, "causal")
    assert (made.status, made.check, made.mandatory) == ("unverified", "causal", True)
    assert "add a beat of what starts the event" in made.corrections[0].action


def test_where_nothing_can_happen_no_cause_is_missed(tmp_path: Path) -> None:
    still = world({"ground": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="static")})
    for name, spec, status in (("still", still, "not_applicable"), ("moves", small(), "unverified")):
        (tmp_path / name).mkdir()
        assert acceptance._unjudged(make_candidate(tmp_path / name, spec, stage="full"), "causal").status == status
    assert acceptance._unjudged(make_candidate(tmp_path, still, stage="full"), "beat").status == "unverified"


# ---------------------------------------------------------------- which candidate


def small(**more: Any) -> WorldSpec:
    return world({"ground": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="dynamic")}, **more)


def _record(folder: WorldFolder, spec: WorldSpec, freeze: str = FREEZE, *, where: str | None = None) -> Path:
    path = folder.candidate(where or freeze) / "candidate.json"
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps({"freeze": freeze, "spec": spec.model_dump(mode="json"), "built": {}}))
    return path


def test_the_candidate_is_the_one_with_exactly_this_specification(tmp_path: Path) -> None:
    folder = WorldFolder(tmp_path)
    _record(folder, small(frames=30), "a" * 64)
    _record(folder, small())
    assert find_candidate(folder, small()) == FREEZE
    with pytest.raises(RefusedError, match="call probe_sim"):
        find_candidate(folder, small(limits=Limits(max_speed=1.0)))


def test_a_record_in_another_candidates_name_is_passed_over(tmp_path: Path) -> None:
    folder = WorldFolder(tmp_path)
    _record(folder, small(), where="0" * 64)
    with pytest.raises(RefusedError):
        find_candidate(folder, small())


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"freeze": 1, "spec": {}}', '{"freeze": "f", "spec": null}'])
def test_a_damaged_record_does_not_stop_the_search(tmp_path: Path, text: str) -> None:
    folder = WorldFolder(tmp_path)
    broken = folder.root / "candidates" / "0" / "candidate.json"
    broken.parent.mkdir(parents=True)
    broken.write_text(text)
    _record(folder, small())
    assert find_candidate(folder, small()) == FREEZE


def test_an_acceptance_is_bound_to_specification_settings_and_caches() -> None:
    spec = small()
    subject = acceptance_subject(spec, FREEZE, "digest")
    assert subject == acceptance_subject(small(), FREEZE, "digest")
    assert subject != acceptance_subject(spec, "g" * 64, "digest")
    assert subject != acceptance_subject(spec, FREEZE, "other")
    assert subject != acceptance_subject(small(limits=Limits(max_speed=1.0)), FREEZE, "digest")
    assert subject != acceptance_subject(spec.model_copy(update={"prompt": "Another."}), FREEZE, "digest")
    look = spec.model_copy(update={"look": spec.look.model_copy(update={"exposure": 1.0})})
    assert subject == acceptance_subject(look, FREEZE, "digest")
    assert spec_digest(look) != spec_digest(spec)


# ---------------------------------------------------------------- what travels with it


def test_the_register_lists_every_simplification(tmp_path: Path) -> None:
    keys = {"a": {"time": 0, "pose": {}}, "b": {"time": 1, "pose": {"position": (1, 0, 0)}}}
    spec = world(
        {
            "ground": ground(),
            "lift": box(0.1, 0.1, 0.1, motion="kinematic"),
            "a": box(0.1, 0.1, 0.1, at=(0, 0, 1), motion="dynamic"),
        },
        drivers={"up": PathDriver(entity="lift", keys=keys)},  # type: ignore[arg-type]
        relations={"glue": Fastened(a="a", b="ground", max_depth=0.01, reason="glued to the ground")},
    )
    part = spec.entities["a"].parts["p0"].model_copy(update={"collides": False})
    drawn = spec.entities["a"].model_copy(update={"parts": {"p0": part}})
    spec = spec.model_copy(update={"entities": {**spec.entities, "a": drawn}})
    lines = [line["what"] for line in approximations(make_candidate(tmp_path, spec, stage="full"))]
    assert any("collision skin of 0.0005 m" in line for line in lines)
    assert any("'lift' follows an authored path" in line for line in lines)
    assert any("part a/p0 is drawn only" in line for line in lines)
    assert any("authored driver 'up' (path)" in line for line in lines)


# ---------------------------------------------------------------- the fresh process


def test_refusals_of_the_fresh_process_keep_their_kind(tmp_path: Path) -> None:
    with pytest.raises(EvidenceError, match=r"world\.json"):
        judge_fresh(tmp_path)
    (tmp_path / "world.json").write_text(small().model_dump_json())
    with pytest.raises(RefusedError, match="no candidate"):
        judge_fresh(tmp_path)


def test_a_process_that_dies_is_an_engine_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(EngineError, match="ended with code 1"):
        judge_fresh(tmp_path)


def test_the_fresh_process_passes_its_progress_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines that an engine prints between are no records; the last line is."""
    lines = ['{"progress": [0.1, 1.0, "checking causal", 0.4]}', "engine 1.0", '{"progress": "none"}', '{"verdict": "accepted"}']
    script = tmp_path / "python"
    script.write_text("#!/bin/sh\n" + "".join(f"echo '{line}'\n" for line in lines))
    script.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(script))
    told: list[Any] = []
    assert judge_fresh(tmp_path, progress=lambda *report: told.append(report)) == {"verdict": "accepted"}
    assert told == [(0.1, 1.0, "checking causal", 0.4)]


def test_a_process_that_takes_too_long_is_an_engine_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = tmp_path / "python"
    script.write_text('#!/bin/sh\necho \'{"progress": [0.1, 1.0, "a"]}\'\nexec sleep 60\n')
    script.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(script))
    monkeypatch.setattr(acceptance, "TIMEOUT_SECONDS", 0.5)
    with pytest.raises(EngineError, match="ended with code -9"):
        judge_fresh(tmp_path)


def test_a_process_started_before_judges_once_it_is_told_and_ends_where_nobody_tells_it(tmp_path: Path) -> None:
    with WaitingJudge() as waiting, pytest.raises(EvidenceError, match=r"world\.json"):
        judge_fresh(tmp_path, waiting=waiting)
    with pytest.raises(KeyError), WaitingJudge() as waiting:
        raise KeyError
    assert waiting._process.returncode == -9

"""`causal:untold`: the world is run without the drivers that the story does not tell of, and its beats must come all the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._causal_untold import lane, pull
from worldagent.testing.worlds.small_worlds import box
from worldagent.verifiers.checks import rerun_ids, run_checks
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.story import reruns, untold
from worldagent.verifiers.story.untold import check, reached_by, row_ids
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, FieldDriver, ForceDriver, PathDriver

NEEDED, SPARE = 0.35, 0.05
"""[m] Gaps that the block crosses with the force alone, and without it too."""


def world_of(folder: Path, gap: float = NEEDED, **more: Any) -> Candidate:
    return lane(folder, np.random.default_rng(1), gap=gap, **{"drivers": {"wind": pull(0.8)}, **more}).candidate


def row_of(candidate: Candidate, beat: str = "slides", **more: Any) -> Row:
    return next(r for r in check(candidate, **more) if r.id == f"causal:untold:{beat}")


def test_only_beats_for_which_a_driver_is_untold_have_a_row(tmp_path: Path) -> None:
    air = FieldDriver.model_validate({"field": {"kind": "drag"}})
    candidate = world_of(tmp_path, drivers={"wind": pull(0.8), "air": air})
    spec = candidate.spec
    assert row_ids(spec) == {"causal:untold:comes", "causal:untold:slides"} <= rerun_ids(spec)
    owned = spec.story.beats["slides"].model_copy(update={"owner": "wind"})
    told = spec.model_copy(update={"story": spec.story.model_copy(update={"beats": {**spec.story.beats, "slides": owned}})})
    assert row_ids(told) == set(), "the force owns a beat, and still air brings nothing about"


def test_a_beat_that_needs_a_force_of_no_beat_fails_and_names_it(tmp_path: Path) -> None:
    candidate = world_of(tmp_path)
    row = diagnose(row_of(candidate), candidate.spec)
    said = str(row.evidence["explanation"])
    assert (row.status, row.first_failing_entity, row.evidence["needs"]) == ("fail", "b", ["wind"])
    assert "without wind slides does not come" in said
    (run,) = row.evidence["runs"]
    assert (run["without"], run["comes"], run["instances_rerun"]) == (["wind"], False, ["rigid"])
    assert run["frames_rerun"] > 0
    assert run["steps_rerun"] > 0
    story, away = (next(c for c in row.corrections if c.group == group) for group in ("story", "drivers"))
    assert "let wind own a beat that leads to slides: a first beat about m" in story.action
    assert away.patch == ({"op": "remove", "path": "/simulation/drivers/wind"},)
    assert apply_patch(candidate.spec, away.patch).simulation.drivers == {}


def test_a_force_that_is_not_needed_is_told_as_one_that_helps(tmp_path: Path) -> None:
    row = row_of(world_of(tmp_path, gap=SPARE))
    assert (row.status, row.evidence["helps"], row.measured) == ("pass", ["wind"], 0.0)
    assert "it helps and is not needed (wind reaches b at " in row.evidence["explanation"]


def test_two_forces_of_which_either_would_do_are_taken_away_together(tmp_path: Path) -> None:
    row = row_of(world_of(tmp_path, gap=0.3, drivers={"wind": pull(0.45), "gust": pull(0.45)}))
    assert (row.status, row.evidence["needs"]) == ("fail", ["wind", "gust"])
    runs = [(r["without"], r["comes"]) for r in row.evidence["runs"]]
    assert runs == [(["gust", "wind"], False), (["wind"], True), (["gust"], True)]


def test_of_two_forces_the_one_that_is_needed_is_named(tmp_path: Path) -> None:
    row = row_of(world_of(tmp_path, drivers={"breath": pull(0.01), "wind": pull(0.8)}))
    assert (row.status, row.evidence["needs"]) == ("fail", ["wind"])
    assert {p for c in row.corrections for p in c.pointers} >= {"/simulation/drivers/wind"}


def test_what_a_driver_does_not_reach_is_judged_without_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    candidate = world_of(tmp_path)
    assert [(r.driver, r.bodies) for r in reached_by(candidate, "slides")] == [("wind", ("b",))]
    assert reached_by(candidate, "comes") == []
    monkeypatch.setattr(reruns, "run_variant", lambda *a, **k: pytest.fail("a variant was simulated"))
    row = row_of(
        world_of(tmp_path / "late", drivers={"wind": ForceDriver(entity="b", force=(9, 0, 0), start=1.05, end=2.0)}, gap=SPARE)
    )
    assert row.status == "pass"
    assert "no chain of pushes leads from what wind acts on" in row.evidence["explanation"]


def test_a_body_on_a_path_reaches_what_it_pushes_through_others(tmp_path: Path) -> None:
    keys = {k: {"time": time, "pose": {"position": (x, 0, 0.06)}} for k, time, x in (("s", 0.1, -0.2), ("e", 0.5, 0.4))}
    hand = PathDriver.model_validate({"entity": "hand", "keys": keys})
    more = {"hand": box(0.1, 0.1, 0.1, motion="kinematic", at=(-0.2, 0, 0.06))}
    candidate = world_of(tmp_path, gap=SPARE, drivers={"p": hand}, more=more)
    late = candidate.spec.story.beats["slides"].model_copy(update={"predicate": Displacement(entity="b", min=0.2)})
    beats = {**candidate.spec.story.beats, "slides": late}
    spec = candidate.spec.model_copy(update={"story": candidate.spec.story.model_copy(update={"beats": beats})})
    assert [(r.driver, r.bodies) for r in reached_by(replace(candidate, spec=spec), "slides")] == [("p", ("b",))]
    assert reached_by(candidate, "slides") == [], "it had come by itself before the hand arrived"


def test_a_driver_that_another_beat_owns_is_to_be_named_as_a_cause(tmp_path: Path) -> None:
    drawn = Beat(text="m is drawn", owner="wind", subject="m", frames=(0, 26), predicate=Displacement(entity="m", min=0.01))
    candidate = world_of(tmp_path, beats={"drawn": drawn})
    row = row_of(candidate)
    assert (row.status, row.evidence["needs"]) == ("fail", ["wind"])
    named = row.corrections[0]
    assert named.action.startswith("name drawn, which wind owns, among the causes of slides")
    mended = apply_patch(candidate.spec, named.patch)
    assert mended.story.beats["slides"].causes == ["comes", "drawn"]
    assert "causal:untold:slides" not in row_ids(mended)


def test_a_run_that_cannot_be_made_is_no_pass(tmp_path: Path) -> None:
    candidate = world_of(tmp_path, gap=SPARE)
    for path in tmp_path.rglob("*.bin"):
        path.unlink()
    row = row_of(candidate)
    assert row.status == "unverified"
    assert "no checkpoint" in row.evidence["explanation"]


def test_more_sets_than_are_run_are_unverified(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(untold, "MOST_WITHOUT", 0)
    row = row_of(world_of(tmp_path, gap=SPARE))
    assert row.status == "unverified"
    assert "at most 0 are taken away; let wind own beats that lead to slides" in row.evidence["explanation"]


def test_nothing_is_run_while_another_row_fails_or_the_beat_itself_did_not_come(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reruns, "run_variant", lambda *a, **k: pytest.fail("a variant was simulated"))
    candidate = world_of(tmp_path, gap=SPARE)
    row = row_of(candidate, failing="beat:x")
    assert (row.status, row.evidence["follows"]) == ("unverified", "beat:x")
    short = world_of(tmp_path / "short", drivers={"wind": pull(0.01)})
    row = row_of(short)
    assert (row.status, row.evidence["follows"]) == ("unverified", "beat:slides")


def test_the_row_is_judged_at_the_probe_with_its_progress(tmp_path: Path) -> None:
    candidate, told = world_of(tmp_path, gap=SPARE), list[tuple[float, float, str]]()
    assert "causal:untold:slides" in {r.id for r in run_checks(candidate, only=["causal"])}
    full = Candidate(tmp_path, candidate.spec, candidate.built, "full", candidate.caches, "run", candidate.digest)
    assert not [r for r in run_checks(full, only=["causal"]) if r.id.startswith("causal:untold")]
    check(full, lambda *report: told.append(report))
    done = [d / n for d, n, _ in told]
    assert done == sorted(done)
    assert told[-1][2].startswith("checking causal: slides without drivers that no beat tells of, rigid: frame")

"""No row passes over frames that are not there: every check on a run that stopped early."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, Literal

import pytest
from worldagent.construction import build_world, built_paths
from worldagent.simulation.freeze import open_freeze
from worldagent.simulation.schedule import run_frames
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.rows.seen import only_seen, unmended_till_seen
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.probe_length import probe_frames
from worldagent.worlds.requirements import Row, Status

SEEN = 12
"""Frames that are there, of 36."""


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Literal["probe", "full"]], Candidate]:
    """The small world with things kept in place to its end, simulated for twelve frames."""
    document = small_spec()
    document["graph"]["relations"]["stays"] = {"kind": "contains", "a": "shelf", "b": "shelf"}
    spec = parse_spec({**document, "prompt": PROMPT})
    folder = WorldFolder(tmp_path_factory.mktemp("short"))
    built, _ = build_world(folder, spec)
    freeze = open_freeze(folder, spec, built, built_paths(folder, spec), 1)
    where = folder.candidate(freeze) / "bake"
    caches = run_frames(spec, built, where, frames=SEEN)
    made = Candidate(folder.root, spec, built, "full", caches, folder.relative(where), cache_digest(caches))
    return lambda stage: dataclasses.replace(made, stage=stage)


@pytest.mark.parametrize("stage", ["probe", "full"])
def test_no_check_passes_over_frames_that_are_not_there(short: Any, stage: Literal["probe", "full"]) -> None:
    rows = run_checks(short(stage), reruns=False)
    reaching = [r for r in rows if r.frames is not None and r.frames[1] >= SEEN]
    assert {r.id for r in reaching if r.status == "pass"} <= {"shots:tiling", "shots:cover:fall"}  # of the plan alone
    assert {"beat:vacuous:fall", "shots:motion:only", "shots:framed:only"} <= {r.id for r in reaching}
    told = next(r for r in reaching if r.id == "beat:vacuous:fall")
    assert told.evidence["explanation"].startswith("frames 0..11 of 0..24 seen: ")
    assert told.evidence["seen"] == [0, 11]


def test_a_bake_is_asked_for_all_that_a_relation_holds_over_and_a_probe_says_what_it_saw(short: Any) -> None:
    ids = ("support:shelf_on_floor:shelf", "relations:stays")
    probed = {r.id: r for r in run_checks(short("probe"), only=("support", "relations"))}
    baked = {r.id: r for r in run_checks(short("full"), only=("support", "relations"))}
    for name in ids:
        assert (probed[name].status, probed[name].frames) == ("pass", (0, 11))
        assert (baked[name].status, baked[name].frames) == ("unverified", (0, 35))
        assert "frames 0..11 of 0..35 seen" in baked[name].evidence["explanation"]
    assert "over frames 0..11" in probed[ids[0]].predicate


def test_the_guard_takes_the_frames_of_a_row_or_those_needed_and_leaves_failures(short: Any) -> None:
    candidate = short("full")

    def row(status: Status, frames: tuple[int, int] | None) -> Row:
        return Row(id="x", check="support", group="spatial", predicate="a carries b", status=status, artifact="x", frames=frames)

    assert only_seen(candidate, row("pass", (0, 95))).frames == (0, 95)
    assert only_seen(candidate, row("pass", (0, 95))).status == "unverified"
    assert only_seen(candidate, row("pass", (3, 11)), (3, 95)).frames == (3, 95)
    assert only_seen(candidate, row("fail", (0, 95))).status == "fail"
    for frames in (None, (0, 11)):
        seen = row("pass", frames)
        assert only_seen(candidate, seen) is seen


def test_a_row_that_waits_for_frames_has_nothing_to_be_mended(short: Any) -> None:
    """More frames, or other members, would change nothing. A bake that lacks frames is another matter."""
    probed, baked = ({r.id: r for r in run_checks(short(stage), reruns=False)} for stage in ("probe", "full"))
    waiting = [r for r in probed.values() if r.status == "unverified" and r.frames is not None and r.frames[1] >= SEEN]
    assert {"shots:motion:only", "shots:framed:only"} <= {r.id for r in waiting}
    assert all(r.corrections == () for r in waiting)
    assert baked["shots:motion:only"].corrections


@pytest.mark.parametrize(("end", "tool"), [(2, "bake_sim"), (24, "probe_sim")])
def test_rows_of_later_frames_wait_for_the_bake_once_the_probe_is_whole(end: int, tool: str, short: Any) -> None:
    """Twelve frames are more than a probe needs whose beats end at frame 2; one whose beats end at 24 was stopped."""
    candidate = short("probe")
    story = candidate.spec.story
    beats = {k: b.model_copy(update={"frames": (0, end)}) for k, b in story.beats.items()}
    plan = candidate.spec.simulation.model_copy(update={"fps": 12})
    spec = candidate.spec.model_copy(update={"simulation": plan, "story": story.model_copy(update={"beats": beats})})
    assert (probe_frames(spec) <= SEEN) == (tool == "bake_sim")
    row = Row(id="x", check="shots", group="observational", predicate="p", status="unverified", artifact="x", frames=(0, 35))
    told = unmended_till_seen(dataclasses.replace(candidate, spec=spec), row)
    assert [p["tool"] for p in told.evidence["diagnosis"]["cheapest_probe"]] == [tool]

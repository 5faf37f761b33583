"""Corrections help the worlds they are made for: each is applied, taken by the audit, and judged again."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.corrections import SUMMARY, figures, run, tried
from worldagent.testing.corrections import Tried, outcome_of
from worldagent.testing.worlds.small_worlds import MATERIALS, ball, box, ground, make_candidate, world
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.diagnosis.names import names_of
from worldagent.verifiers.rows.corrections import bake_again, without_again
from worldagent.verifiers.scene import interpenetration
from worldagent.worlds.cache import write_container
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.predicates import Broken, Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, Box, Material, Part, Pose

RECORDED = json.loads((Path(__file__).parents[2] / "docs" / "accuracy.json").read_text())["corrections"]["now"]

HELPED = [
    *(("scale", n) for n in ("one axis", "turned part", "exchanged axes", "wrong unit", "missing part", "inner part")),
    *(("scale", n) for n in ("displaced part", "flattened", "out of proportion", "not its role", "too heavy", "absurd")),
    *(("interpenetration", n) for n in ("sunk", "far sunk", "beyond fastened", "twice", "crossed bars", "tiny in huge")),
    *(("support", n) for n in ("afloat", "sunk", "magnet", "overhang", "heavy-pile", "too-steep", "smooth-ladder", "slack")),
    *(("support", n) for n in ("static-in-the-air", "beside-its-post", "carried-untold", "buried-house")),
    *(("shots", n) for n in ("hole", "elsewhere", "behind-a-wall", "out-of-picture", "black")),
    ("flaws", "floating_block"),
]
"""Worlds each of which has a correction that helps, cheap to judge."""


@pytest.mark.parametrize("broken", HELPED, ids=lambda w: f"{w[0]}-{w[1]}")
def test_a_failing_row_has_a_correction_that_the_audit_takes_and_that_helps(broken: tuple[str, str]) -> None:
    found = [t for t in tried(broken) if not SUMMARY.match(t.row)]
    assert any(t.outcome == "helps" for t in found), found
    assert not [t for t in found if t.useless], found


SUITES = ("scale", "interpenetration", "support", "navigability", "causal", "story", "shots", "flaws")
"""Suites whose rows fail by their specification; the others hold recordings that were altered."""


@pytest.mark.slow
@pytest.mark.parametrize("suite", SUITES)
def test_no_fewer_rows_have_a_correction_that_helps_than_the_page_tells(suite: str) -> None:
    found = run(checks=(suite,))["suites"][suite]
    assert found["rows"] > 0
    assert found["helped"] * RECORDED["suites"][suite]["rows"] >= RECORDED["suites"][suite]["helped"] * found["rows"], found


# ---------------------------------------------------------------- what counts as help


def _row(row: str, status: str = "fail", measured: float | None = None, frame: int | None = 0) -> Row:
    told: dict[str, Any] = {
        "id": row,
        "check": "support",
        "group": "spatial",
        "predicate": "p",
        "status": status,
        "artifact": "a",
    }
    return Row.model_validate({**told, "measured": measured, "bound": 1.0, "first_failing_frame": frame})


def _outcome(before: Iterable[Row], now: Iterable[Row], *, again: bool = False, easier: bool = False) -> str:
    return outcome_of(_row("a", measured=2.0), before, now, again=again, easier=easier)[0]


def test_a_row_that_passes_or_comes_nearer_is_helped_and_one_that_stays_or_gets_worse_is_not() -> None:
    bad = [_row("a", measured=2.0)]
    assert _outcome(bad, [_row("a", "pass", 1.0)]) == "helps"
    assert _outcome(bad, [_row("a", measured=1.5)]) == "helps"
    assert _outcome(bad, [_row("a", measured=1.95)]) == "same"
    assert _outcome(bad, [_row("a", measured=3.0)]) == "worse"


def test_what_makes_another_row_fail_breaks_and_what_asks_for_less_eases() -> None:
    bad = [_row("a", measured=2.0), _row("b", "pass")]
    assert _outcome(bad, [_row("a", "pass"), _row("b")]) == "breaks"
    assert _outcome(bad, [_row("a", "pass"), _row("b", "pass")], easier=True) == "eases"


def test_a_row_that_passes_without_the_edit_needs_another_run_only() -> None:
    assert _outcome([_row("a", "pass")], [_row("a", "pass")]) == "needless"
    assert outcome_of(_row("a"), [_row("a")], [_row("a", "pass")], again=True, easier=False)[0] == "helps"


def test_the_share_is_of_rows_and_leaves_out_wrong_recordings_and_summaries() -> None:
    def one(row: str, outcome: Any, why: str = "") -> Tried:
        return Tried("support/w", "support", row, 0, "placement", "c", "a", outcome, why)

    found = figures(
        [
            one("support:x", "helps"),
            one("support:x", "same"),
            one("support:y", "breaks"),
            one("support:z", "needless"),
            one("support:scene", "words"),
        ]
    )
    assert (found["rows"], found["helped"], found["recordings"], found["share"]) == (2, 1, 1, 0.5)
    assert [u["outcome"] for u in found["useless"]] == ["same", "breaks"]


# ---------------------------------------------------------------- useless ones that are gone


def _fallen(tmp_path: Path) -> Candidate:
    made = make_candidate(tmp_path, world({"floor": ground(), "ball": ball(0.1, at=(0, 0, 0.1), motion="dynamic")}), tracks={})
    return replace(made, digest=cache_digest(made.caches))


def test_an_untouched_cache_is_not_said_to_be_edited_and_an_edited_one_is(tmp_path: Path) -> None:
    made = _fallen(tmp_path)
    row = _row("a", frame=3).model_copy(update={"corrections": (bake_again(),)})
    assert without_again(made, row).corrections == ()
    frame = made.caches["rigid"].read(3)
    frame["position"] = frame["position"] + 0.01
    write_container(made.caches["rigid"].path(3), frame)
    assert without_again(made, row) is row
    assert without_again(made, row.model_copy(update={"first_failing_frame": 10})).corrections == ()
    assert without_again(replace(made, digest="of another run"), row) is row


def _named(
    predicate: Any, *, size: tuple[float, float, float] = (0.1, 0.1, 0.1), frame: int = 20, **evidence: Any
) -> dict[str, Any]:
    beat = Beat(text="t", owner="rigid", subject="thing", frames=(0, 20), predicate=predicate)
    thing = box(*size, at=(0, 0, size[2] / 2), motion="dynamic", material="rubber")
    materials = {**MATERIALS, "rubber": Material(density=1100.0, friction=0.9, substance="rubber")}
    spec = world({"floor": ground(), "thing": thing}, beats={"b": beat}, materials=materials)
    told = {"id": "beat:b", "subject": ("b",), "check": "beat", "group": "temporal", "predicate": "p", "status": "fail"}
    more = {"frames": (0, 20), "first_failing_frame": frame, "entities": ("thing",), "evidence": evidence}
    return names_of(Row.model_validate({**told, **more}), spec)


def test_more_frames_are_for_what_is_under_way_at_the_end_and_not_for_what_failed_at_frame_1() -> None:
    moves = Displacement(entity="thing", min=0.5)
    assert "ends" in _named(moves, frame=20)
    assert "ends" not in _named(moves, frame=1)
    assert "ends" not in _named(moves, frame=20, largest_frame=4)


def test_dominoes_are_for_what_stands_and_friction_for_what_is_not_to_break() -> None:
    moves, breaks = Displacement(entity="thing", min=0.5), Broken(entity="thing", min=0.5)
    assert "stands" in _named(moves, size=(0.05, 0.1, 0.3))
    assert "stands" not in _named(moves, size=(0.5, 1.0, 0.2))
    assert _named(moves)["rubs"] == "rubber"
    assert "rubs" not in _named(breaks)


def test_a_part_that_hangs_together_with_no_other_is_moved_by_name_and_its_entity_stays(tmp_path: Path) -> None:
    """A scree of stones of which one lies in a wall: that stone moves."""
    stones = {f"p{k}": Part(shape=Box(size=(0.2, 0.2, 0.2)), pose=Pose(position=(0.5 * k, 0, 0))) for k in range(4)}
    scree = box(0.2, 0.2, 0.2, at=(0, 0, 0.1)).model_copy(update={"parts": stones})
    spec = world({"floor": ground(), "wall": box(0.2, 3, 1, at=(1.65, 0, 0.5)), "scree": scree})
    row = next(r for r in interpenetration.check(make_candidate(tmp_path, spec)) if r.id == "interpenetration:wall:scree")
    best = row.corrections[0]
    assert "p3 of 'scree'" in best.action
    assert [o["path"] for o in best.patch] == ["/entities/scree/parts/p3/pose"]
    after = make_candidate(tmp_path, apply_patch(spec, best.patch))
    assert not [r.id for r in run_checks(after, only=["interpenetration"]) if r.status == "fail"]


def test_a_move_into_something_else_is_not_suggested(tmp_path: Path) -> None:
    """Between two walls, in one of them: only upwards there is room."""
    walls = {"left": box(0.2, 1, 0.4, at=(-0.2, 0, 0.2)), "right": box(0.2, 1, 0.4, at=(0.21, 0, 0.2))}
    spec = world({"floor": ground(), **walls, "thing": box(0.2, 0.2, 0.2, at=(-0.02, 0, 0.1), motion="dynamic")})
    rows = interpenetration.check(make_candidate(tmp_path, spec))
    row = next(r for r in rows if r.id == "interpenetration:left:thing")
    patched = [c for c in row.corrections if c.patch]
    assert patched
    for c in patched:
        after = interpenetration.check(make_candidate(tmp_path, apply_patch(spec, c.patch)))
        assert not [r.id for r in after if r.status == "fail" and r.id != row.id], c.action

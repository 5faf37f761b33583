"""Differences that count as disagreement between a bundled verdict and an own one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import Event, box, ground, make_candidate, world
from worldagent.verifiers.delivery.bounds import NOISE, OTHER_MACHINE
from worldagent.verifiers.delivery.bundle import compare_history, compare_rows, event_list, unequal
from worldagent.worlds.canonical import spec_digest
from worldagent.worlds.requirements import Row


def _row(**more: Any) -> dict[str, Any]:
    row = Row(
        id="scale:a",
        check="scale",
        group="spatial",
        predicate="p",
        status="pass",
        artifact="x",
        measured=1.0,
        bound=2.0,
        unit="m",
    )
    return {**row.model_dump(mode="json"), **more}


def test_equal_rows_agree() -> None:
    assert compare_rows([_row()], [_row()], exact=True) == []
    assert compare_rows([_row(measured=1 + NOISE / 2)], [_row()], exact=True) == []
    assert compare_rows([], [], exact=True) == []


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize(
    "change",
    [
        {"status": "fail"},
        {"mandatory": False},
        {"predicate": "q"},
        {"bound": 2.1},
        {"bound": None},
        {"unit": "mm"},
        {"comparison": "<="},
        {"measured": 1.01},
        {"measured": None},
        {"measured": True},
        {"measured": "1.0"},
        {"check": "support"},
        {"invented": 1},
    ],
)
def test_what_a_row_requires_and_finds_must_agree_everywhere(change: dict[str, Any], exact: bool) -> None:
    (found,) = compare_rows([_row(**change)], [_row()], exact=exact)
    assert found["row"] == "scale:a"
    assert found["differs"] == next(iter(change))


@pytest.mark.parametrize(
    "change", [{"evidence": {"a": 1}}, {"recipe": "r"}, {"artifact": "y"}, {"measured": 1 + OTHER_MACHINE / 2}]
)
def test_what_depends_on_the_machine_must_agree_from_equal_bytes_only(change: dict[str, Any]) -> None:
    assert compare_rows([_row(**change)], [_row()], exact=True)
    assert compare_rows([_row(**change)], [_row()], exact=False) == []


def test_a_row_that_drew_a_sample_may_have_drawn_another_but_only_our_row_says_so() -> None:
    drew, other = _row(evidence={"seed": 1, "intervals": [1]}), _row(evidence={"seed": 2, "intervals": [2]})
    assert compare_rows([other], [drew], exact=True) == []
    assert compare_rows([other], [_row()], exact=True)
    assert compare_rows([{**other, "status": "fail"}], [drew], exact=True)


def test_missing_added_doubled_and_shapeless_rows_differ() -> None:
    assert [d["differs"] for d in compare_rows([], [_row()], exact=True)] == ["missing from the bundle"]
    assert [d["differs"] for d in compare_rows([_row()], [], exact=False)] == ["not a row of this installation"]
    assert [d["differs"] for d in compare_rows([_row(), _row()], [_row()], exact=True)] == ["stands twice in the bundle"]
    assert compare_rows([_row(), None], [_row()], exact=True)[0]["differs"] == "is no row"


def test_numbers_agree_within_noise_and_everything_else_to_the_letter() -> None:
    assert unequal({"a": [1.0, "x", None]}, {"a": [1.0 + 1e-12, "x", None]}, relative=NOISE) is None
    assert unequal({"a": [1.0]}, {"a": [1.0, 2.0]}, relative=NOISE) == "/a"
    assert unequal({"a": {"b": 1}}, {"a": {"c": 1}}, relative=NOISE) == "/a/b"
    assert unequal(1, True, relative=NOISE) == "/"
    assert unequal("1", 1, relative=NOISE) == "/"


# ---------------------------------------------------------------- events and history


def test_events_name_the_pair_and_what_is_missing_is_said(tmp_path: Path) -> None:
    spec = world({"ground": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="dynamic")})
    event = Event(0.1, "a", "ground", impulse=0.25)
    found = event_list(make_candidate(tmp_path / "1", spec, tracks={}, events=[event]))
    (contact,) = found["contacts"]
    assert set(contact["pair"]) == {"a", "ground"}
    assert (contact["time"], contact["impulse"]) == (0.1, 0.25)
    lost = event_list(make_candidate(tmp_path / "2", spec, tracks={}, without=["event/time"]))
    assert lost["contacts"] == []
    assert "event/time" in lost["missing"][0]


def _history(*specs: Any, weakenings: tuple[list[str], ...]) -> dict[str, Any]:
    return {
        "revisions": [
            {"n": k + 1, "spec": s.model_dump(mode="json"), "digest": spec_digest(s), "weakenings": w}
            for k, (s, w) in enumerate(zip(specs, weakenings, strict=True))
        ]
    }


def test_a_history_must_lead_to_the_specification_and_own_up() -> None:
    long, short = world({"ground": ground()}, frames=48), world({"ground": ground()}, frames=24)
    told = _history(long, short, weakenings=([], ["/simulation/frames 48 -> 24"]))
    assert compare_history(told, spec_digest(short)) == []
    assert "is not the specification" in compare_history(told, spec_digest(long))[0]
    assert (
        "hides weakenings: /simulation/frames"
        in compare_history(_history(long, short, weakenings=([], [])), spec_digest(short))[0]
    )
    told["revisions"][0]["digest"] = "0"
    assert "does not give its digest" in compare_history(told, spec_digest(short))[0]
    assert "revision 1 is missing" in compare_history({"revisions": told["revisions"][1:]}, spec_digest(short))[0]
    assert compare_history({"revisions": []}, spec_digest(short))
    assert "does not validate" in compare_history({"revisions": [{"n": 1, "spec": {}, "digest": "", "weakenings": []}]}, "")[0]

"""Golden rows tell every row that is gone, new or other, and forgive rounding."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from worldagent.bench import golden
from worldagent.testing.defects.suites import suite_of

ROW = ["scale:cube", "pass", 0.25, 0.5, "m", None, None]


def test_equal_rows_differ_in_nothing() -> None:
    close = [["scale:cube", "pass", 0.25 * (1 + 1e-9), 0.5, "m", None, None]]
    assert list(golden.differences({"w": [ROW]}, {"w": close})) == []


@pytest.mark.parametrize(
    ("now", "told"),
    [
        ({}, ["w: gone"]),
        ({"v": [], "w": [ROW]}, ["v: new"]),
        ({"w": []}, ["w: scale:cube is gone"]),
        ({"w": [["scale:ball", *ROW[1:]], ROW]}, ["w: scale:ball is new"]),
        ({"w": [["scale:cube", "fail", *ROW[2:]]]}, ["w: scale:cube: status was 'pass', is 'fail'"]),
        ({"w": [[*ROW[:2], 0.2501, *ROW[3:]]]}, ["w: scale:cube: measured was 0.25, is 0.2501"]),
        ({"w": [[*ROW[:5], "cube", 3]]}, ["first_failing_entity was None, is 'cube'", "first_failing_frame was None, is 3"]),
    ],
)
def test_what_differs_is_told(now: dict[str, golden.World], told: list[str]) -> None:
    found = list(golden.differences({"w": [ROW]}, now))
    assert len(found) == len(told)
    assert all(text in line for text, line in zip(told, found, strict=True))


def test_rows_of_a_suite_are_recorded_and_compared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(golden, "GOLDEN", tmp_path)
    found, misjudged = golden.rows_of_suite("scale")
    assert misjudged == []
    assert golden.compare("scale", found) == ["scale: nothing is recorded; run `python -m worldagent.bench.golden record`"]
    golden.write("scale", found)
    assert golden.compare("scale", found) == []
    kept = json.loads((tmp_path / "scale.json").read_text())
    world = next(iter(kept))
    kept[world][0][1] = "unverified"
    (tmp_path / "scale.json").write_text(json.dumps(kept))
    assert len(golden.compare("scale", found)) == 1


def test_a_world_that_is_judged_wrongly_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    suite = suite_of("scale")
    broken, sound = (suite.of(broken=b)[0] for b in (True, False))
    swapped = (replace(broken, broken=False), replace(sound, broken=True))
    monkeypatch.setattr(golden, "suite_of", lambda check: replace(suite, mechanisms=swapped))
    found = golden.rows_of_suite("scale")
    assert found.misjudged == [f"scale: {broken.name} is sound and refused", f"scale: {sound.name} is broken and not found"]


@pytest.mark.parametrize(
    ("measured", "status", "told"),
    [
        (0.26, "pass", 0),  # as another processor measured it
        (0.27, "pass", 1),  # as none did
        (0.26, "fail", 2),  # a status is never a matter of rounding
    ],
)
def test_rows_of_other_processors_are_known(measured: float, status: str, told: int) -> None:
    elsewhere = {"w": [["scale:cube", "pass", 0.26, *ROW[3:]], ["scale:cube", "fail", 0.26, *ROW[3:]]]}
    now = {"w": [["scale:cube", status, measured, *ROW[3:]]]}
    assert len(list(golden.differences({"w": [ROW]}, now, elsewhere))) == told


@pytest.mark.parametrize(
    ("others", "status", "told"), [((0.26, 0.27), "pass", 0), ((0.26, 0.27), "fail", 2), ((0.26, 0.25), "pass", 1)]
)
def test_a_row_that_three_processors_measure_differently_is_noise(others: tuple[float, ...], status: str, told: int) -> None:
    """Its status still counts; a number that equals the recorded one is no other."""
    elsewhere = {"w": [["scale:cube", "pass", value, *ROW[3:]] for value in others]}
    now = {"w": [["scale:cube", status, 0.4, *ROW[3:]]]}
    assert len(list(golden.differences({"w": [ROW]}, now, elsewhere))) == told


def test_only_what_is_measured_is_kept_of_another_processor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(golden, "GOLDEN", tmp_path)
    monkeypatch.setattr(golden, "PROCESSORS", tmp_path / "processors")
    other, failing = ["scale:cube", "pass", 0.26, *ROW[3:]], ["scale:cube", "fail", 0.26, *ROW[3:]]
    golden.write("scale", {"w": [ROW]})
    assert golden.rounded_otherwise("scale", {"w": [ROW]}) == {}
    assert golden.rounded_otherwise("scale", {"w": [failing]}) == {}
    golden.write("scale", golden.rounded_otherwise("scale", {"w": [other]}), tmp_path / "processors")
    assert golden.compare("scale", {"w": [other]}) == []
    assert len(golden.compare("scale", {"w": [failing]})) == 2


@pytest.mark.parametrize(("measured", "bound", "told"), [(0.2549, 0.5, 0), (0.256, 0.5, 1), (0.2549, 0.0, 1), (0.2549, 0.51, 1)])
def test_a_number_may_differ_by_a_share_of_its_bound(measured: float, bound: float, told: int) -> None:
    """By 0.01 of 0.5; not where nothing is allowed, and the bound itself never."""
    was = ["scale:cube", "pass", 0.25, bound if bound == 0.0 else 0.5, "m", None, None]
    now = ["scale:cube", "pass", measured, bound, "m", None, None]
    assert len(list(golden.differences({"w": [was]}, {"w": [now]}, share=0.01))) == told

"""Claims of a quantity: what is measured is the number of the words; half and twice are found where they are the truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.verifiers.claims.claimed import rows

FALL = "/story/beats/fall/predicate/min"


def quantity(folder: Path, quote: str, pointer: str, *, world: str = "drop", predicate: Any = None, **beat: Any) -> Any:
    """The row of a claim of a quantity about a ball that falls one metre, in 0.45 s; None without one."""
    told = predicate or {"kind": "falls", "entity": "ball", "min": 0.4}
    beats = {"fall": {"subject": told.get("entity", "ball"), "predicate": told, **beat}}
    claims = {"q": {"quote": quote, "type": "quantity", "by": [pointer]}}
    return rows(folder, world, claims, beats=beats, prompt=f"The ball falls {quote} to the floor.").get("q")


@pytest.mark.parametrize(("quote", "status"), [
    ("1 m", "pass"), ("about 90 cm", "pass"), ("1.2 m", "pass"), ("1.3 m", "fail"), ("75 cm", "fail"), ("2 m", "fail"), ("about 2 metres", "fail"), ("50 cm", "fail"), ("about 0.4 m", "fail"),
    ("at least 50 cm", "pass"), ("more than 2 m", "fail"), ("at most 1.5 m", "pass"), ("less than 50 cm", "fail"), ("between 0.8 and 1.2 m", "pass"),
])  # fmt: skip
def test_a_bound_of_the_story_is_held_to_what_is_measured(quote: str, status: str, tmp_path: Path) -> None:
    row = quantity(tmp_path, quote, FALL)
    assert (row.status, row.unit, round(row.measured, 1)) == (status, "m", 1.0), row.evidence
    one_sided = any(w in quote for w in ("least", "most", "than"))
    assert bool(row.evidence["rivals"]) != one_sided
    assert row.status == "pass" or row.corrections
    if status == "fail" and not one_sided:
        assert "are what the words say" in row.evidence["explanation"]


@pytest.mark.parametrize(("quote", "pointer", "value", "unit"), [
    ("20 cm", "/entities/ball/dimensions/size/2", 0.2, "m"),
    ("10 cm", "/entities/ball/parts/p0/shape/radius", 0.1, "m"),
    ("1.1 m", "/entities/ball/pose/position/2", 1.1, "m"),
    ("600 kg/m3", "/materials/wood/density", 600.0, "kg/m3"),
    ("1.5 s", "/simulation/frames", 1.5, "s"),
    ("0.2 s", "/story/beats/fall/frames/0", 0.208, "s"),
    ("0.2 s", "/story/beats/fall/predicate/frames", 0.208, "s"),
])  # fmt: skip
def test_a_body_as_it_is_built_and_as_it_starts_and_a_time_are_measured(
    quote: str, pointer: str, value: float, unit: str, tmp_path: Path
) -> None:
    within = {"kind": "within", "beat": "start", "frames": 20, "predicate": {"kind": "falls", "entity": "ball", "min": 0.6}}
    start = {"start": ("ball", {"kind": "falls", "entity": "ball"})}
    told = within if pointer.endswith("predicate/frames") else {"kind": "falls", "entity": "ball", "min": 0.2}
    claims = {"q": {"quote": quote, "type": "quantity", "by": [pointer]}}
    beats = {**start, "fall": {"subject": "ball", "predicate": told}}
    row = rows(tmp_path / "told", "drop", claims, beats=beats, prompt=f"A ball of {quote}.")["q"]
    assert (row.status, row.unit) == ("pass", unit), row.evidence
    assert row.measured == pytest.approx(value, rel=0.15)
    number, name = quote.split(" ")
    for factor in (0.45, 0.75, 1.4, 2.2):
        rival = f"{float(number) * factor:.4g} {name}"
        claims["q"]["quote"] = rival
        found = rows(tmp_path / f"{factor}", "drop", claims, beats=beats, prompt=f"A ball of {rival}.")["q"]
        assert found.status == "fail", found.evidence


def test_what_is_built_is_held_closer_than_what_motion_gives(tmp_path: Path) -> None:
    """A ball 20 cm across is none of 23 cm, as a tolerance of its declared dimensions would allow."""
    at = "/entities/ball/dimensions/size/2"
    told = {"kind": "falls", "entity": "ball", "min": 0.2}
    assert quantity(tmp_path / "a", "20.5 cm", at, predicate=told).status == "pass"
    assert quantity(tmp_path / "b", "23 cm", at, predicate=told).status == "fail"
    assert quantity(tmp_path / "c", "about 23 cm", at, predicate=told).status == "pass"


def test_a_speed_at_the_start_is_measured(tmp_path: Path) -> None:
    at = "/entities/box/physics/linear_velocity/0"
    told = {"kind": "slides", "entity": "box"}
    row = quantity(tmp_path / "told", "2 m/s", at, world="slide", predicate=told)
    assert (row.status, row.measured) == ("pass", pytest.approx(2.0))
    assert quantity(tmp_path / "half", "4 m/s", at, world="slide", predicate=told).status == "fail"


def test_a_quantity_of_another_unit_is_none_of_what_it_names(tmp_path: Path) -> None:
    row = quantity(tmp_path, "1 kg", FALL)
    assert row.status == "fail"
    assert "measured in m" in row.evidence["explanation"]


def test_each_of_several_is_measured(tmp_path: Path) -> None:
    counting = {
        "kind": "count",
        "entities": ["ball", "floor"],
        "predicate": {"kind": "displacement", "entity": "each", "min": 0.5},
        "min": 1,
    }
    row = quantity(tmp_path, "1 m", "/story/beats/fall/predicate/predicate/min", predicate=counting)
    assert (row.status, row.measured) == ("fail", 0.0)


def test_what_nothing_measures_stays_the_reading_of_the_agent(tmp_path: Path) -> None:
    assert quantity(tmp_path / "gravity", "9.81 m/s2", "/simulation/gravity/2") is None
    assert quantity(tmp_path / "words", "a hand's width", FALL) is None

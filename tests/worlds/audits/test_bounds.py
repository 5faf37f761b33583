"""Bounds that a specification may not define away: bounds stand clear of noise, bodies weigh what they are made of, holds let go (R91, R154)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import parse_spec


def _problems(spec: dict[str, Any]) -> str:
    rows = audit(parse_spec({**spec, "prompt": PROMPT})).rows
    return "\n".join(p for r in rows if r.status == "fail" for p in r.evidence["problems"])


def test_the_small_world_is_sound() -> None:
    assert _problems(small_spec()) == ""


NOISE = {
    "displacement": ({"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "max": -1e-5}, "/max", "0.001"),
    "speed": ({"kind": "speed", "entity": "b3", "min": 1e-4}, "/min", "0.02"),
    "topples": ({"kind": "topples", "entity": "b3", "min_angle": 0.01}, "/min_angle", "0.2"),
    "tilts": ({"kind": "tilts", "entity": "b3", "min": 0.001}, "/min", "0.02"),
    "or": ({"kind": "or", "of": [{"kind": "speed", "entity": "b3", "min": 1e-4}]}, "/of/0/min", "0.02"),
    "within": ({"kind": "within", "beat": "strike", "frames": 9, "predicate": {"kind": "speed", "entity": "b3", "min": 1e-4}}, "/predicate/min", "0.02"),
}  # fmt: skip


@pytest.mark.parametrize("name", NOISE)
def test_a_bound_within_noise_is_refused_with_the_least_that_is_taken(name: str) -> None:
    predicate, place, least = NOISE[name]
    spec = small_spec()
    spec["story"]["beats"]["fall"]["predicate"] = predicate
    text = _problems(spec)
    assert f"/story/beats/fall/predicate{place}: " in text
    assert f"at least {least}" in text


def test_a_tilt_that_is_always_small_enough_is_refused() -> None:
    spec = small_spec()
    spec["story"]["requirements"] = {
        "whole": {"text": "it stands", "predicate": {"kind": "tilts", "entity": "b1", "max": 3.2, "when": "always"}}
    }
    assert "always true" in _problems(spec)


def test_a_body_is_no_heavier_than_its_box_full_of_its_material() -> None:
    spec = small_spec()
    spec["entities"]["b2"]["physics"] = {"category": "rigid", "mass": 9000.0}
    assert "'b2' weighs 9000 kg" in _problems(spec)


STEEL_B2 = 0.03 * 0.05 * 0.05
"""[m^3]"""


@pytest.mark.parametrize(
    ("mass", "told"),
    [
        (1e-6, "at least"),
        (0.9 * 7700 * STEEL_B2, "at least"),
        (7700 * STEEL_B2, ""),
        (8100 * STEEL_B2, ""),
        (1.1 * 8100 * STEEL_B2, "at most"),
    ],
)
def test_a_declared_mass_is_that_of_the_volume_of_its_substance(mass: float, told: str) -> None:
    """Steel of a milligram, and steel that is heavier than steel."""
    spec = small_spec()
    spec["entities"]["b2"]["material"] = "steel"
    spec["entities"]["b2"]["physics"] = {"category": "rigid", "mass": mass}
    text = _problems(spec)
    assert (f"'b2' weighs {mass:g} kg, its volume of steel {told}" in text) if told else ("weighs" not in text)


def test_a_hollow_body_says_so_and_has_a_wall() -> None:
    spec = small_spec()
    can = {"category": "rigid", "mass": 0.013}
    spec["entities"]["b2"] |= {"material": "steel", "physics": can}
    assert "or say physics.hollow true where it is a closed shell" in _problems(spec)
    can["hollow"] = True
    assert "weighs" not in _problems(spec)
    can["mass"] = 1e-6
    assert "a wall of 0.0001 m of steel at least" in _problems(spec)


def test_a_rope_and_a_sheet_weigh_what_their_substance_allows() -> None:
    spec = small_spec()
    rope = {"kind": "rope", "points": [[0, 0, 0], [0, 0, 1]], "radius": 0.01, "segments": 10}
    spec["entities"]["rope"] = {"role": "r", "motion": "dynamic", "dimensions": {"size": [0.02, 0.02, 1]}, "material": "steel",
                                "generator": rope, "physics": {"category": "rigid", "mass": 0.001}}  # fmt: skip
    assert "'rope' weighs 0.001 kg, its volume of steel at least" in _problems(spec)
    spec["entities"]["rope"]["physics"]["mass"] = 3.1416e-4 * 7800
    assert "'rope' weighs" not in _problems(spec)
    spec["materials"]["linen"] = {"density": 500, "substance": "fabric"}
    sheet = {"category": "cloth", "area_density": 1e-4, "thickness": 1e-3, "stretch_stiffness": 1000}
    spec["entities"]["flag"] = {"role": "f", "motion": "dynamic", "dimensions": {"size": [1, 1, 0.001]}, "material": "linen",
                                "parts": {"s": {"shape": {"kind": "sheet", "size": [1, 1], "resolution": 0.1}}}, "physics": sheet}  # fmt: skip
    assert "'flag' weighs 0.0001 kg/m^2 at 0.001 m, 0.1 kg/m^3, which is no fabric: allowed 0.05 to 1.6 kg/m^2" in _problems(spec)
    sheet["area_density"] = 0.2
    assert "'flag' weighs" not in _problems(spec)


def test_a_count_that_is_always_true_is_refused() -> None:
    spec = small_spec()
    count = {"kind": "count", "entities": ["b1", "b3"], "predicate": {"kind": "topples", "entity": "each"}, "max": 2}
    spec["story"]["beats"]["fall"]["predicate"] = count
    assert "always true" in _problems(spec)


def test_an_intended_overlap_is_smaller_than_the_bodies() -> None:
    spec = small_spec()
    fastened = {"kind": "fastened", "a": "b2", "b": "b3", "max_depth": 0.03, "reason": "glued together as one"}
    spec["graph"]["relations"]["glue"] = fastened
    assert "give at most 0.005 m" in _problems(spec)
    fastened["max_depth"] = 0.005
    assert _problems(spec) == ""
    fastened |= {"a": "floor", "b": "b3", "max_depth": 0.025, "reason": "half sunk into the ground"}
    assert _problems(spec) == ""
    fastened["max_depth"] = 0.03
    assert "give at most 0.025 m" in _problems(spec)


def test_a_hold_that_never_lets_go_is_no_support() -> None:
    spec = small_spec()
    spec["simulation"]["drivers"] = {"hold": {"kind": "release", "entity": "b2", "time": 100.0}}
    assert "lets go of 'b2' at 100 s, after the last frame" in _problems(spec)

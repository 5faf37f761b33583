"""Least values that are no noise: of a displacement by the size of the body, of an impulse by its mass, of an angle and a speed."""

from __future__ import annotations

import math
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.audits.bounds import bound_problems
from worldagent.worlds.noise import least_impulse, least_margin, least_travel
from worldagent.worlds.patch import parse_spec

B3 = (0.03, 0.05, 0.05)
"""[m] Size of each block of the small world."""
TRAVEL = 0.02 * math.hypot(*B3)


def spec_of(predicate: dict[str, Any] | None = None, margin: float | None = None) -> Any:
    """The small world whose beat `fall` asks for this, with a margin of its cause."""
    spec = small_spec()
    fall = spec["story"]["beats"]["fall"]
    fall["predicate"] = predicate or fall["predicate"]
    if margin is not None:
        fall["margins"] = {"strike": {"value": margin}}
    return parse_spec({**spec, "prompt": PROMPT})


def test_floors_follow_from_size_and_mass() -> None:
    spec = spec_of()
    assert least_travel(spec, "b3").value == pytest.approx(TRAVEL, abs=1e-6)
    assert least_travel(spec, "floor").value == 0.02
    mass = math.prod(B3) * spec.materials[spec.entities["b3"].material].density
    floor = least_impulse(spec, "b3", "floor")
    assert floor is not None
    assert floor.value == pytest.approx(0.001 * mass, rel=1e-2)
    assert least_impulse(spec, "shelf", "floor") is None, "neither moves"


CONTACT = {"kind": "contact", "a": "b3", "b": "floor"}


@pytest.mark.parametrize(("value", "refused"), [(1e-6, True), (0.1, False), (0.0, False)])
def test_an_impulse_within_noise_is_refused_with_the_floor_and_how_it_is_computed(value: float, refused: bool) -> None:
    found = bound_problems(spec_of({**CONTACT, "min_impulse": value}))
    assert bool(found) == refused
    if refused:
        assert found[0].pointer == "/story/beats/fall/predicate/min_impulse"
        assert "1 mm/s of the lighter moving body" in found[0].text
        again = spec_of({**CONTACT, "min_impulse": found[0].patch["value"]})  # type: ignore[index]
        assert bound_problems(again) == []


MEASURED: dict[str, tuple[dict[str, Any], float | None, str | None]] = {
    "displacement": ({"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "max": -0.15}, round(TRAVEL, 6), "m"),
    "tilts": ({"kind": "tilts", "entity": "b3", "min": 0.5}, 0.02, "rad"),
    "topples": ({"kind": "topples", "entity": "b3", "min_angle": 0.5}, 0.02, "rad"),
    "speed": ({"kind": "speed", "entity": "b3", "min": 0.5}, 0.02, "m/s"),
    "contact": ({**CONTACT, "min_impulse": 0.1}, None, "N s"),
    "count": ({"kind": "count", "entities": ["b2", "b3"], "predicate": {"kind": "speed", "entity": "each", "min": 0.5}, "min": 1}, 1.0, "1"),
    "and": ({"kind": "and", "of": [{"kind": "speed", "entity": "b3", "min": 0.5}, {"kind": "tilts", "entity": "b3", "min": 0.5}]}, 0.02, None),
}  # fmt: skip


@pytest.mark.parametrize("name", MEASURED)
def test_a_causal_margin_below_its_floor_is_refused_and_one_at_it_is_taken(name: str) -> None:
    predicate, least, unit = MEASURED[name]
    spec = spec_of(predicate, 1e-9)
    floor = least_margin(spec, spec.story.beats["fall"])
    assert floor is not None
    assert least is None or floor.value == pytest.approx(least)
    assert unit is None or floor.unit == unit
    (problem,) = bound_problems(spec)
    assert problem.pointer == "/story/beats/fall/margins/strike/value"
    assert f"a causal margin of 1e-09 {floor.unit} is within noise; ask for at least {floor.value:g} {floor.unit}" in problem.text
    assert bound_problems(spec_of(predicate, floor.value)) == []

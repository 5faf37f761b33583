"""Bounds of predicates about gases stand clear of noise (R154)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_gas import SMOKE_PROMPT, fire_spec, smoke_spec
from worldagent.worlds.audits.bounds import bound_problems
from worldagent.worlds.noise import least_margin
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

AMBIENT = 293.15
SOOT = 1e-3
CELL = 0.05
AT = {"start": (-1, 0, 0.5), "end": (1, 0, 0.5)}


def asking(predicate: dict[str, Any]) -> WorldSpec:
    """The small room of smoke with a beat that asks for this of its gas."""
    document: dict[str, Any] = {"prompt": SMOKE_PROMPT, **smoke_spec(resolution=CELL)}
    gas = next(n for n, e in document["entities"].items() if e.get("physics", {}).get("category") == "gas")
    document["entities"][gas]["physics"]["soot_density"] = SOOT
    if predicate["kind"] in ("gas_density_in", "gas_arrives"):
        predicate = {"region": "there", **predicate}
    box = {"kind": "box", "min": [-0.5, -0.5, 0.0], "max": [0.5, 0.5, 0.5]}
    document.setdefault("graph", {}).setdefault("regions", {})["there"] = box
    beat = {"text": "it does", "owner": "air", "subject": gas, "frames": [0, 20], "predicate": {"entity": gas, **predicate}}
    document["story"] = {**document.get("story", {}), "beats": {"asked": beat}}
    return parse_spec(document)


@pytest.mark.parametrize(
    ("predicate", "field", "within", "least"),
    [
        ({"kind": "gas_density_in"}, "min", 1e-12, 1e-3 * SOOT),
        ({"kind": "gas_arrives"}, "min_density", 1e-12, 1e-3 * SOOT),
        ({"kind": "gas_temperature_in"}, "min", AMBIENT + 0.01, AMBIENT + 1.0),
        ({"kind": "gas_temperature_in"}, "max", AMBIENT - 0.01, AMBIENT - 1.0),
        ({"kind": "heat_release"}, "min", 1e-3, 10.0),
        ({"kind": "light_through", **AT}, "max", 0.9999, 0.98),
        ({"kind": "light_through", **AT}, "min", 1e-4, 0.02),
        ({"kind": "plume_height"}, "min", 0.1 * CELL, CELL),
    ],
)
def test_a_bound_within_noise_is_refused_and_the_least_that_is_named_is_taken(
    predicate: dict[str, Any], field: str, within: float, least: float
) -> None:
    found = bound_problems(asking({**predicate, field: within}))
    assert [p.pointer.rsplit("/", 1)[1] for p in found] == [field]
    assert "is within noise; ask for at" in found[0].text
    assert found[0].patch is not None
    assert found[0].patch["value"] == pytest.approx(least)
    assert bound_problems(asking({**predicate, field: least})) == []


def test_what_lasts_may_be_asked_as_narrowly_as_one_likes() -> None:
    assert bound_problems(asking({"kind": "gas_temperature_in", "max": AMBIENT + 0.01, "when": "always"})) == []


def test_a_causal_margin_of_a_gas_has_a_floor() -> None:
    spec = asking({"kind": "gas_temperature_in", "min": 330.0})
    floor = least_margin(spec, spec.story.beats["asked"])
    assert floor is not None
    assert (floor.value, floor.unit) == (1.0, "K")


def test_the_small_worlds_of_gases_are_sound() -> None:
    for made in (smoke_spec(), fire_spec()):
        assert bound_problems(parse_spec({"prompt": SMOKE_PROMPT, **made})) == []

"""A look that contradicts the substance of a claim is warned of; paint and honest looks are not (R2, R131)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.worlds.audits.test_bindings import ROLLS, told
from worldagent.worlds.claims import reading_of

MARKED = f"A [steel](property ball) [ball](thing ball) {ROLLS} into a [wooden](property b3) [block](thing b3)."
GREY, BROWN, RED = [0.6, 0.6, 0.62], [0.45, 0.22, 0.08], [0.7, 0.05, 0.03]


def lines(steel: dict[str, Any], wood: dict[str, Any], marked: str = MARKED) -> list[str]:
    looks = [("/materials/steel/appearance", steel), ("/materials/wood/appearance", wood)]
    return [w for w in reading_of(told(marked, *looks)).warnings if "which looks" in w]


EXCHANGED: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "metal of wood": ({"color": BROWN}, {"color": GREY, "metallic": 1}, "'wooden' is 'wood' of wood, which looks like metal"),
    "grain on steel": (
        {"color": BROWN, "pattern": "wood"},
        {"color": BROWN},
        "'steel' is 'steel' of steel, which looks like wood",
    ),
    "colours alone": (
        {"color": BROWN},
        {"color": GREY},
        "'steel' is 'steel' of steel, which looks like wood, and what is claimed",
    ),
    "clear wood": (
        {"color": GREY, "metallic": 1},
        {"color": GREY, "transmission": 0.9},
        "'wooden' is 'wood' of wood, which looks like glass",
    ),
}


@pytest.mark.parametrize("name", EXCHANGED)
def test_a_look_of_another_substance_is_named(name: str) -> None:
    steel, wood, line = EXCHANGED[name]
    assert any(w.startswith(line) for w in lines(steel, wood)), lines(steel, wood)


@pytest.mark.parametrize(
    ("steel", "wood"),
    [
        ({"color": GREY, "metallic": 1}, {"color": BROWN, "pattern": "wood"}),
        ({"color": GREY, "metallic": 1}, {"color": GREY}),
        ({"color": RED}, {"color": RED}),
        ({"color": BROWN}, {"color": BROWN}),
    ],
)
def test_metal_wood_and_paint_are_left_alone(steel: dict[str, Any], wood: dict[str, Any]) -> None:
    assert lines(steel, wood) == []


def test_a_colour_that_the_prompt_says_is_its_own() -> None:
    marked = MARKED.replace("A [steel]", "A [brown](property ball) [steel]")
    assert lines({"color": BROWN}, {"color": GREY}, marked) == []

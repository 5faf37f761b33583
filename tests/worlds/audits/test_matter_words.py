"""Claimed water runs like water: a liquid that stands like clay is none (R131, R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_liquids import tank_spec
from worldagent.worlds.audits.matter_words import THIN, matter_problems
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.spec import WorldSpec


def problems(quote: str, viscosity: float, prompt: str) -> tuple[WorldSpec, list[Any]]:
    document = tank_spec(crate_at=None)
    document["entities"]["water"]["physics"]["viscosity"] = viscosity
    claims = {"it": {"quote": quote, "type": "thing", "by": ["/entities/water"]}}
    spec = WorldSpec.model_validate({**document, "spec_version": "2", "claims": claims, "prompt": prompt})
    return spec, list(matter_problems(spec, "it"))


@pytest.mark.parametrize(
    ("quote", "viscosity", "words"),
    [
        ("water", 0.001, ""),
        ("water", THIN, ""),
        ("water", 1e6, "has a viscosity of 1e+06 Pa s; at most 0.05 Pa s is allowed"),
        ("cold milk", 0.1, "runs like water"),
        ("honey", 7.0, ""),
        ("lava", 100.0, ""),
        ("oil", 0.09, ""),
    ],
)
def test_what_runs_like_water_is_as_thin(quote: str, viscosity: float, words: str) -> None:
    spec, found = problems(quote, viscosity, f"There is {quote} in the tank on the floor.")
    assert [words in p.text for p in found] == ([True] if words else [])
    if found:
        mended = apply_patch(spec, [found[0].patch])
        assert list(matter_problems(mended, "it")) == []


def test_other_languages_know_their_water() -> None:
    _, found = problems("Wasser", 10.0, "Das Wasser steht in einem Becken auf dem Boden und ist ganz ruhig.")
    assert len(found) == 1

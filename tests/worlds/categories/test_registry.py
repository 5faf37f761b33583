"""Every entry of the registry of categories."""

from typing import get_args

import pytest
from worldagent.worlds.categories.registry import CATEGORIES, shape_of
from worldagent.worlds.spec import Entity
from worldagent.worlds.spec.entities import Physics

SHAPES = {
    "rigid": "solid",
    "fracture": "solid",
    "elastic": "deforming",
    "cloth": "deforming",
    "liquid": "loose",
    "particles": "loose",
    "gas": "loose",
}


def test_every_category_of_the_specification_is_registered() -> None:
    """And `fracture`, which rigid bodies declare beside their category."""
    declared = {model.model_fields["category"].default for model in get_args(get_args(Physics)[0])}
    assert set(CATEGORIES) == {*declared, "fracture"}
    assert {n: c.shape for n, c in CATEGORIES.items()} == SHAPES


@pytest.mark.parametrize("name", CATEGORIES)
def test_an_entry_stands_under_its_own_name(name: str) -> None:
    assert CATEGORIES[name].name == name


def test_an_entity_has_the_shape_of_its_category() -> None:
    gas = {
        "role": "smoke",
        "motion": "dynamic",
        "physics": {"category": "gas", "resolution": 0.1},
        "dimensions": {"size": [1, 1, 1]},
        "material": "smoke",
        "parts": {"source": {"shape": {"kind": "box", "size": [1, 1, 1]}}},
    }
    assert shape_of(Entity.model_validate(gas)) == "loose"

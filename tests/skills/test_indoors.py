"""The skills `interiors`, `assets` and `materials`: their data is true of the code, and is what differs between the arms of their evals."""

from __future__ import annotations

import json
from typing import Any

import pytest
from worldagent.bench import skill_assets, skill_interiors, skill_materials
from worldagent.server.skill_files import SKILLS
from worldagent.worlds.materials import friction_between, row_named
from worldagent.worlds.spec import RigidSettings


def _data(skill: str, file: str) -> Any:
    return json.loads((SKILLS / skill / file).read_text())


def test_the_turns_of_the_skill_let_drawers_open_into_the_room_and_those_of_other_entities_do_not() -> None:
    placing = _data("assets", "placing.json")
    for wall, yaw in placing["yaw_deg"].items():
        assert skill_assets.opens_into_the_room("chest_of_drawers", 1, wall, yaw), wall
        assert not skill_assets.opens_into_the_room("chest_of_drawers", 1, wall, skill_assets.FRONT_X[wall]), wall
    assert placing["skin"] == RigidSettings().skin


def test_pairs_of_the_skill_are_those_of_the_table_and_differ_from_the_larger_of_the_two() -> None:
    pairs = _data("materials", "pairs.json")
    assert pairs
    for names, friction in pairs.items():
        a, b = names.split()
        sourced = friction_between(a, b)
        assert sourced is not None
        assert friction == sourced.range[1], names
        own = [row[1].figures["friction"].range[1] for n in (a, b) if (row := row_named(n)) is not None]
        assert abs(max(own) - friction) > 0.02, names


def test_a_slippery_block_goes_as_far_as_its_pair_says_and_not_by_names_alone() -> None:
    friction = _data("materials", "pairs.json")["brass mild_steel"]
    wanted = 1.5**2 / (2 * skill_materials.G * friction)
    assert skill_materials.way("brass", "mild_steel", 1.5, friction) == pytest.approx(wanted, rel=0.05)
    assert skill_materials.way("brass", "mild_steel", 1.5, None) < 0.9 * wanted


def test_a_workshop_without_windows_has_room_for_what_it_lacks_with_them() -> None:
    rule = _data("interiors", "rooms.json")
    assert skill_interiors.lacking("workshop", 28, 1, rule) == 0
    assert skill_interiors.lacking("workshop", 28, 1, {}) > 0

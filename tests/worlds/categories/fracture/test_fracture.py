"""Specifications of bodies that break: what the audit refuses, and the cap on pieces."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from worldagent.construction import build_entity
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import bond, bricks, cantilever, struck_wall
from worldagent.worlds.categories.caps import PIECES
from worldagent.worlds.categories.fracture.audit import fracture_problems
from worldagent.worlds.categories.fracture.facts import piece_count
from worldagent.worlds.errors import LimitError
from worldagent.worlds.groups import group_of
from worldagent.worlds.limits import CAPS
from worldagent.worlds.provenance import recipes
from worldagent.worlds.spec import WorldSpec


def _changed(change: dict[str, Any], spec: WorldSpec | None = None) -> WorldSpec:
    data = (spec or struck_wall(5.0)).model_dump(mode="json")
    data["entities"]["wall"] |= change
    data["entities"]["wall"]["dimensions"] = {"size": [0.75, 0.12, 0.4]}
    return WorldSpec.model_validate(data)


def _breakable(**more: Any) -> dict[str, Any]:
    return {"breakable": {"pattern": bricks(), "bond": bond(), "fixed": ["z-"], **more}}


def test_a_sound_wall_has_no_problems() -> None:
    assert fracture_problems(_changed({})) == []


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"motion": "static"}, "make it dynamic"),
        ({"physics": {"category": "rigid", "linear_damping": 1.0}}, "linear_damping"),
        ({"physics": {"category": "rigid", "linear_velocity": [1, 0, 0]}}, "bonded to the world and has a velocity"),
        (_breakable(pattern=bricks((0.006, 0.006, 0.006), joint=0.0)), "summed skins"),
        (_breakable(bond=bond(contact_time=1e-4)), "contact time"),
        (_breakable(bond=bond(crumble=0.05)), "crumble"),
    ],
    ids=["static", "damped", "moving and fixed", "fine", "short blow", "crumbly"],
)
def test_what_the_engine_cannot_carry_out_is_refused(change: dict[str, Any], said: str) -> None:
    problems = fracture_problems(_changed(change))
    assert any(said in p.text for p in problems), problems


def test_a_shelf_that_cannot_bear_itself_is_refused() -> None:
    data = cantilever(1e3).model_dump(mode="json")
    data["entities"]["beam"]["dimensions"] = {"size": [1.0, 0.1, 0.2]}
    problems = fracture_problems(WorldSpec.model_validate(data))
    assert any("own weight" in p.text for p in problems)


def test_a_breakable_body_may_be_coupled_both_ways() -> None:
    data = _changed({}).model_dump(mode="json")
    pair = {"source": "water", "target": "main", "variables": ["motion", "wrench"], "direction": "two_way"}
    data["simulation"]["couplings"] = {"push": pair}
    assert fracture_problems(WorldSpec.model_validate(data)) == []


def test_joints_on_a_breakable_body_are_refused() -> None:
    data = struck_wall(5.0).model_dump(mode="json")
    data["simulation"]["joints"] = {
        "h": {"kind": "hinge", "child": "ball", "parent": "wall", "anchor": [0, 0, 0], "axis": [0, 0, 1]}
    }
    assert any("hangs on 'wall'" in p.text for p in fracture_problems(WorldSpec.model_validate(data)))


def test_too_many_pieces_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    spec = _changed({})
    fewer = replace(PIECES, value=5)
    monkeypatch.setattr("worldagent.worlds.categories.fracture.audit.PIECES", fewer)
    monkeypatch.setitem(CAPS, "pieces", fewer)
    assert any("at most 5" in p.text for p in fracture_problems(spec))
    with pytest.raises(LimitError, match="at most 5"):
        build_entity(spec, "wall", rigid_world.NO_ASSETS)


def test_the_estimate_of_pieces_is_near() -> None:
    spec = _changed({})
    built = build_entity(spec, "wall", rigid_world.NO_ASSETS)
    assert piece_count(spec.entities["wall"]) == pytest.approx(len(built.bodies), rel=0.3)


def test_a_strength_is_of_the_motion_and_a_pattern_of_the_shape() -> None:
    one, two = recipes(_changed({})), recipes(_changed(_breakable(bond=bond(9e5))))
    assert one["built:wall"] == two["built:wall"]
    assert one["motion"] != two["motion"]
    three = recipes(_changed(_breakable(pattern=bricks((0.3, 0.11, 0.07)))))
    assert one["built:wall"] != three["built:wall"]
    assert group_of("/entities/wall/breakable/bond/tension").name == "bonds"
    assert group_of("/entities/wall/breakable/pattern/size").name == "shape"

"""Interiors that never move but for what is named: static from the start, fixed as they stand, and without air between them."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from worldagent.construction.assets.documents import body_boxes
from worldagent.construction.assets.made import Made
from worldagent.construction.assets.registry import make
from worldagent.construction.interiors.build import build_interior
from worldagent.construction.interiors.built import BuiltInterior
from worldagent.construction.interiors.stilled import stilled
from worldagent.construction.kept_shapes import kept_shape
from worldagent.construction.scenes import Body, clearance
from worldagent.geometry import kept_solid
from worldagent.worlds.arrays import RigidPose, pose_of
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Interior

GAP = 1e-3
"""[m] Two collision skins."""
SHOP = {"kind": "workshop", "area": 20.0, "doors": ["outside"], "windows": False}


@lru_cache(maxsize=4)
def _shop(*moves: str, still: bool = True) -> BuiltInterior:
    plan = {"rooms": {"shop": SHOP}, "seed": 4, "density": 0.5, "still": still, "moves": list(moves)}
    return build_interior("flat", Interior.model_validate(plan), gap=GAP)


def _moving(made: BuiltInterior) -> set[str]:
    return {key for key, entity in made.entities.items() if entity["motion"] == "dynamic"}


def _carrier(made: BuiltInterior, key: str) -> str:
    return str(made.relations[f"{key}_stands"]["a"])


def _low(entity: dict[str, Any]) -> float:
    return float(entity["pose"]["position"][2])


def test_nothing_of_a_still_interior_moves_or_hangs_on_a_joint() -> None:
    """The same things, as a control, move and hang on joints where the interior is not still."""
    still, free = _shop(), _shop(still=False)
    assert set(still.entities) == set(free.entities)
    assert len(_moving(free)) > 50
    assert free.joints
    assert _moving(still) == set()
    assert still.joints == {}
    hung = {joint["child"] for joint in free.joints.values()}
    assert {r["b"] for r in still.relations.values() if r["kind"] == "fastened"} == hung


def test_kinds_ids_and_rooms_are_named_that_move() -> None:
    tins = {key for key in _shop().entities if "_tin_can" in key}
    assert len(tins) > 1
    assert _moving(_shop("tin_can")) == tins
    one = min(tins)
    assert _moving(_shop(one)) == {one}
    assert _moving(_shop("shop")) == _moving(_shop(still=False))


def test_what_lies_on_something_that_moves_moves_as_well() -> None:
    """A static thing would hang in the air as soon as its carrier is gone."""
    free = _shop(still=False)
    carriers = {_carrier(free, f"{key}") for key in free.entities if f"{key}_stands" in free.relations}
    table = min(c for c in carriers if c in _moving(free) and c not in ("flat_floor", "flat_walls"))
    made = _shop(table)
    on_it = {key for key in free.entities if f"{key}_stands" in free.relations and _carrier(free, key) == table}
    assert on_it
    assert {table, *on_it} <= _moving(made)
    assert len(_moving(made)) < len(_moving(free))


def test_still_things_touch_what_carries_them_and_those_that_move_keep_room_for_skins() -> None:
    """Three gaps of 1 mm between floor, bench, box and lid are more air than a chain of static things may have."""
    made, free = _shop("tin_can"), _shop(still=False)
    checked = set()
    for key, entity in made.entities.items():
        if f"{key}_stands" not in made.relations:
            continue
        carrier = _carrier(made, key)
        if carrier not in ("flat_floor", "flat_walls"):
            closed = (_low(free.entities[key]) - _low(free.entities[carrier])) - (_low(entity) - _low(made.entities[carrier]))
            wall = f"{carrier}_stands" in made.relations and _carrier(made, carrier) == "flat_walls"
            checked.add((entity["motion"], wall))
            assert closed == pytest.approx(0.0 if entity["motion"] == "dynamic" else 9e-4, abs=1e-6), key
        elif carrier == "flat_floor":
            assert _low(entity) == pytest.approx(1e-4, abs=1e-6), key
    assert {motion for motion, _ in checked} == {"static", "dynamic"}


@pytest.mark.parametrize("name", ["pile_of_books", "jar", "cooking_pot", "bottle"])
def test_what_lies_loosely_on_a_still_thing_touches_it(name: str) -> None:
    made = make(name, {}, 1)
    still = stilled(made)
    assert made.carries
    assert {body.motion for body in still.bodies.values()} == {"static"}
    before, after = body_boxes(made), body_boxes(still)
    for _, child in made.carries:
        shift = before[child][0] - after[child][0]
        np.testing.assert_allclose(shift[:2], 0.0, atol=1e-9)
        assert shift[2] >= 0.8e-3, "its gap was more than 1 mm and is 0.1 mm"
    order = [child for _, child in made.carries]
    shifts = [float(before[c][0][2] - after[c][0][2]) for c in order]
    assert shifts == sorted(shifts), "what lies on what was lowered comes down with it"


@pytest.mark.parametrize("name", ["bucket", "toilet", "shower_tray", "kitchen_base", "lantern"])
def test_what_hangs_on_joints_of_a_still_thing_touches_what_holds_it(name: str) -> None:
    """Handles, lids and doors hang 1 to 3 mm from what they turn on; static ones that far off floated."""
    made = make(name, {}, 1)
    still = stilled(made)
    assert made.joints
    before, after = _apart(made), _apart(still)
    assert max(before.values()) > 0.9e-3
    assert max(after.values()) <= 1.1e-4
    assert min(after.values()) >= 0.9e-4, "nothing is pushed into anything"


@pytest.mark.parametrize("name", ["picture_frame", "bucket", "lantern"])
def test_a_still_thing_stays_before_its_back_and_above_its_foot(name: str) -> None:
    """A picture that was brought to its hook was pushed into the wall."""
    made = make(name, {}, 1)
    before, after = (np.array([*body_boxes(m).values()]) for m in (made, stilled(made)))
    assert after[:, 1, 1].max() <= before[:, 1, 1].max() + 1e-9
    assert after[:, 0, 2].min() >= before[:, 0, 2].min() - 1e-9


def _apart(made: Made) -> dict[str, float]:
    """Clearance of each body that hangs on a joint to all the others [m]."""
    here = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))

    def surfaces(names: list[str]) -> Body:
        parts = [part for n in names for part in made.bodies[n].parts.values()]
        solids = [(pose_of(p.pose), kept_solid(kept_shape(p.shape, Path()).geometry.render, closed=True)) for p in parts]
        return Body(tuple(solids))

    return {
        j.child: clearance(surfaces([j.child]), here, surfaces([n for n in made.bodies if n != j.child]), here)
        for j in made.joints.values()
    }


def test_names_that_mean_nothing_are_refused_and_kinds_that_are_not_there_told() -> None:
    with pytest.raises(InputError, match=r"moves names 'flat_shop_tin_cam'.*did you mean 'flat_shop_tin_can'"):
        _shop("flat_shop_tin_cam")
    assert "no bathtub stands here, which moves names" in _shop("bathtub").lacking


def test_moves_without_still_is_refused() -> None:
    with pytest.raises(ValidationError, match="give still: true"):
        Interior.model_validate({"rooms": {"shop": SHOP}, "moves": ["tin_can"]})

"""Buildings on slopes: the floor follows the ground at the entrance, a plinth and steps close what is left, too much is refused."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from worldagent.construction.interiors.build import build_interior
from worldagent.construction.interiors.built import BuiltInterior
from worldagent.construction.interiors.ground import MOST_PLINTH, OVER, RISE, Heights
from worldagent.worlds.arrays import F64
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Interior

HUT: dict[str, Any] = {
    "rooms": {
        "hall": {"kind": "hall", "area": 8, "doors": ["outside"], "furniture": False},
        "store": {"kind": "store", "doors": ["hall"], "furniture": False},
    },
    "on": "hill",
    "at": [20.0, -10.0, 99.0],
}
BASE = 7.0


def _slope(east: float, north: float) -> Heights:
    def heights(points: F64) -> F64:
        found: F64 = BASE + east * (points[:, 0] - 20.0) + north * (points[:, 1] + 10.0)
        return found

    return heights


def _hut(ground: Heights, **more: Any) -> BuiltInterior:
    return build_interior("hut", Interior.model_validate({**HUT, **more}), gap=1e-3, ground=ground)


def _boxes(found: BuiltInterior, entity: str) -> list[tuple[F64, F64]]:
    document = found.entities[entity]
    own = np.array(document["pose"]["position"])
    places = [(own + np.array(p["pose"]["position"]), np.array(p["shape"]["size"]) / 2) for p in document["parts"].values()]
    return [(middle - half, middle + half) for middle, half in places]


def test_on_level_ground_the_floor_lies_a_little_over_it_and_no_steps_are_needed() -> None:
    found = _hut(_slope(0.0, 0.0))
    assert found.site["floor"] == pytest.approx(BASE + OVER)
    assert found.site["steps"] == {"hall": 0}
    assert found.corner[2] == pytest.approx(BASE + OVER), "z of `at` is not asked"
    assert "hut_hall_steps_outside" not in found.entities
    assert found.relations["hut_hall_outside_to_hall"]["kind"] == "connects"


@pytest.mark.parametrize(("side", "steps"), [("north", 0), ("south", 3)])
def test_a_door_uphill_is_level_and_one_downhill_has_steps_of_legal_rise(side: str, steps: int) -> None:
    found = _hut(_slope(0.0, 0.1), entrance=side)
    assert found.site["steps"] == {"hall": pytest.approx(steps, abs=1)}
    floor = found.corner[2]
    if not steps:
        assert "hut_hall_steps_outside" not in found.entities
        return
    tops = sorted({round(float(high[2]), 6) for _, high in _boxes(found, "hut_hall_steps_outside")}, reverse=True)
    assert tops[0] == pytest.approx(floor)
    assert all(0 < a - b <= RISE + 1e-6 for a, b in itertools.pairwise(tops))
    low = min((b for b in _boxes(found, "hut_hall_steps_outside")), key=lambda b: float(b[1][2]))
    foot = _slope(0.0, 0.1)(np.array([[float(low[0][0]), float(low[0][1]) - 0.15]]))[0]
    assert 0 < low[1][2] - foot <= RISE + 0.02, "the last step down to the ground is one of them"


def test_a_plinth_closes_the_gap_from_the_ground_to_the_floor_all_around() -> None:
    ground = _slope(0.05, 0.08)
    found = _hut(ground)
    pieces = _boxes(found, "hut_plinth")
    floor = _boxes(found, "hut_floor")
    low, high = np.min([b[0] for b in floor], axis=0), np.max([b[1] for b in floor], axis=0)
    length = 0.0
    for a, b in pieces:
        corners = np.array([[x, y] for x in (a[0], b[0]) for y in (a[1], b[1])])
        assert a[2] < ground(corners).min(), "it stands in the ground"
        assert b[2] == pytest.approx(low[2], abs=2e-4), "it reaches the underside of the floor"
        length += max(b[0] - a[0], b[1] - a[1])
    around = 2 * (high[0] - low[0] + high[1] - low[1])
    assert length == pytest.approx(around, rel=0.05)
    assert found.relations["hut_plinth_founded"]["kind"] == "fastened"
    deepest = max(float(ground(np.array([[x, y] for x in (a[0], b[0]) for y in (a[1], b[1])])).max() - a[2]) for a, b in pieces)
    assert deepest <= found.relations["hut_plinth_founded"]["max_depth"] < 0.6


def test_ground_that_is_too_steep_missing_or_before_the_wrong_side_is_refused_with_the_numbers() -> None:
    with pytest.raises(InputError, match=rf"slope about 0\.\d+\), its plinth would be \d\.\d+ m high, at most {MOST_PLINTH:g} m"):
        _hut(_slope(0.0, 0.6))
    with pytest.raises(InputError, match="no ground of 'hill' at x, y ="):
        _hut(lambda points: np.full(len(points), math.nan))
    with pytest.raises(InputError, match="has no entrance; give a room of storey 0 a door to 'outside'"):
        _hut(_slope(0.0, 0.0), rooms={"store": {"kind": "store", "furniture": False}})
    ditch = _slope(0.0, 0.0)

    def moat(points: F64) -> F64:
        inside = (np.abs(points - np.array([20.0, -10.0])) < 2.2).all(axis=1)
        return np.where(inside, ditch(points), BASE - 3.0)

    with pytest.raises(InputError, match=r"more than 5 steps of 0\.17 m; turn the door uphill"):
        _hut(moat, rooms={"hall": {"kind": "hall", "area": 16, "doors": ["outside"], "furniture": False}}, size=[4.0, 4.0])

"""Barns, museum halls and roofs: rooms of other sizes, doors, windows and walls, made by the same machinery."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.construction.interiors.build import build_interior
from worldagent.construction.interiors.built import BuiltInterior
from worldagent.construction.interiors.floor_space import in_rows
from worldagent.construction.interiors.plans import Rect
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Interior


def _built(**document: Any) -> BuiltInterior:
    return build_interior("b", Interior.model_validate(document), gap=1e-3)


def _one(kind: str, **more: Any) -> dict[str, Any]:
    return {"rooms": {"r": {"kind": kind, "doors": ["outside"], "furniture": False}}, **more}


def test_a_barn_has_a_gate_of_two_leaves_walls_of_wood_and_a_roof_on_them() -> None:
    found = _built(**_one("barn", roof="gable"))
    door = found.entities["b_r_outside_door"]["asset"]
    assert (door["generator"], door["parameters"]["width"]) == ("double_door", 2.6)
    assert {"b_r_outside_door_left", "b_r_outside_door_right"} <= set(found.entities)
    assert found.entities["b_walls"]["material"] == "larch"
    roof, walls = found.entities["b_roof"], found.entities["b_walls"]
    top = walls["pose"]["position"][2] + walls["dimensions"]["size"][2]
    assert roof["pose"]["position"][2] == pytest.approx(top, abs=3e-4)
    assert found.relations["b_roof_lies"] == {"kind": "supports", "a": "b_walls", "b": "b_roof"}
    assert roof["asset"]["parameters"]["length"] == pytest.approx(max(found.plan.width, found.plan.depth) + 0.12)


def test_a_museum_hall_is_high_lit_from_above_eye_level_with_columns_in_two_rows_and_exhibits_in_cases() -> None:
    found = _built(rooms={"r": {"kind": "museum", "doors": ["outside"]}}, density=0.5)
    region = found.regions["b_r"]
    assert region["max"][2] - region["min"][2] > 4.0
    sills = [e["pose"]["position"][2] for k, e in found.entities.items() if k.endswith("_window")]
    assert len(sills) >= 6
    assert min(sills) > 2.0
    columns = [e for k, e in found.entities.items() if k.startswith("b_r_column")]
    assert len(columns) == 6
    assert {c["asset"]["parameters"]["height"] for c in columns} == {4.38}
    places = np.array([c["pose"]["position"][:2] for c in columns])
    across = 1 if found.plan.width >= found.plan.depth else 0
    assert len({round(float(v), 3) for v in places[:, across]}) == 2
    assert len({round(float(v), 3) for v in places[:, 1 - across]}) == 3
    cases = [k for k in found.entities if k.startswith("b_r_display_case") and "asset" in found.entities[k]]
    assert len(cases) >= 5
    carried = [
        r["b"]
        for r in found.relations.values()
        if r["kind"] == "supports" and r["a"] in cases and "asset" in found.entities[r["b"]]
    ]
    assert len(carried) >= len(cases), "exhibits stand in them"


def test_things_in_rows_stand_along_the_longer_side() -> None:
    room, foot = Rect(0, 0, 8, 4), Rect(-0.1, -0.2, 0.3, 0.2)
    pairs = [in_rows(room, foot, k, 4, 2) for k in range(4)]
    assert [(s.x + 0.1, s.y) for s in pairs] == [pytest.approx(p) for p in ((2, 1), (2, 3), (6, 1), (6, 3))]
    line = [in_rows(Rect(0, 0, 4, 9), foot, k, 3, 1) for k in range(3)]
    assert [(s.x + 0.1, s.y) for s in line] == [pytest.approx(p) for p in ((2, 1.5), (2, 4.5), (2, 7.5))]


@pytest.mark.parametrize(
    ("document", "said"),
    [
        (_one("barn", height=2.7), r"the gate of room 'r' is 2.6 m high: walls of 2.7 m, .* give height >= 2.9 m"),
        (_one("barn", wall=0.1), r"0.1 m thick, do not hold it; .* wall >= 0.12 m"),
        (_one("museum", roof="gable", size=[14.0, 7.0]), r"the building is 14.12 x 7.12 m, roofs reach over 12 x 8 m"),
    ],
)
def test_gates_and_roofs_that_do_not_fit_are_refused_with_the_numbers(document: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        _built(**document)

"""Lists of flats of the benchmark: fixed, whole, and what counts is what they say."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import worldagent
from worldagent.bench.interiors import NAME, flat_of, judged
from worldagent.construction.assets.registry import GENERATORS
from worldagent.construction.interiors.build import BuiltInterior
from worldagent.construction.interiors.plans import Plan

LISTS = json.loads((Path(worldagent.__file__).parent / "bench/flats.json").read_text(encoding="utf-8"))


def test_a_hundred_flats_of_six_rooms_are_fixed() -> None:
    assert len(LISTS["flats"]) == 100
    assert (LISTS["least"]["things"], LISTS["least"]["generators"]) == (60, 15)
    for number in range(100):
        flat = flat_of(number)
        assert len(flat.rooms) == 6
        assert {r.things for r in flat.rooms.values()} == {60}
        assert Counter(r.kind for r in flat.rooms.values())["hall"] == 1
    for kind, own in LISTS["kinds"].items():
        named = {n for k in own["furniture"] for n in k.split(" or ")}
        assert named <= set(own["counts"]) <= set(GENERATORS), kind


def test_boxes_count_where_the_list_says_so_and_missing_furniture_is_without_a_place() -> None:
    number = next(n for n, f in enumerate(LISTS["flats"]) if "store" in f["rooms"])
    made = BuiltInterior(
        Plan(1.0, 1.0, {}), (0.0, 0.0, 0.0), lacking=["flat_hall: a bench found no place: the walls stood in the way"]
    )
    for room in ("store", "hall"):
        made.entities[f"{NAME}_{room}_cardboard_box"] = {"asset": {"generator": "cardboard_box"}}
        made.entities[f"{NAME}_{room}_bookcase"] = {"asset": {"generator": "bookcase"}}
    found = judged(number, made)
    assert found["rooms"]["store"] == {"things": 2, "generators": 2}
    assert found["rooms"]["hall"] == {"things": 1, "generators": 1}, "a box is no clutter there"
    assert "store: 1 of 2 bookcase" in found["unplaced"]
    assert "bathroom: 0 of 1 bathtub or shower_tray" in found["unplaced"]
    assert found["unplaced"][0].startswith("flat_hall: a bench")

"""A built landscape tells of things that nobody asked for, and of things asked for that it lacks (R35, R38, R39, R44)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.terrain.store import build_terrain_file
from worldagent.workflow.land_warnings import land_warnings
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec

PIT = {"kind": "crater", "radius": 90, "depth": 9, "floor": 0.5, "late": True}
SLOPE = {"kind": "ramp", "rise": 12, "direction_deg": 180}
VALLEY = {"kind": "valley", "line": [[-200, 0], [200, 0]], "width": 80, "depth": 6, "fall": 8}


def warned(
    folder: Path, layers: dict[str, Any], *, story: dict[str, Any] | None = None, water: dict[str, Any] | None = None, **land: Any
) -> list[str]:
    """Warnings about a land of 400 x 400 m."""
    terrain = {
        "extent": [400, 400], "cell": 5, "layers": layers, "erosion": {"years": 0, "steps": 1, "creep": 0},
        "hydrology": {"density": 0}, **land,
    }  # fmt: skip
    spec = parse_spec({
        "spec_version": "2", "title": "t", "prompt": "A land.", "simulation": {"frames": 24}, "terrains": {"land": terrain},
        "materials": {"snow": {"density": 300, "substance": "other"}, "stone": {"density": 2600, "substance": "stone"}},
        "story": story or {},
    })  # fmt: skip
    folder = folder / "w"
    folder.mkdir(exist_ok=True)
    world = WorldFolder.at(folder)
    world.assets.mkdir(exist_ok=True)
    saved, _ = build_terrain_file(world, spec, "land")
    return land_warnings(spec, "land", saved, water or {})


def test_a_lake_that_nobody_asked_for_is_told_with_its_size_and_what_leaves_it_dry(tmp_path: Path) -> None:
    (told,) = warned(tmp_path, {"slope": SLOPE, "pit": PIT})
    assert told.startswith("/terrains/land/hydrology/required: 1 lakes lie on the land and none is asked for")
    area = float(told.split("least_lake_area over ")[1].split(" m^2")[0])
    assert warned(tmp_path, {"slope": SLOPE, "pit": PIT}, hydrology={"density": 0, "least_lake_area": 1.01 * area}) == []


def test_a_lake_that_is_required_or_that_the_story_speaks_of_is_not_told(tmp_path: Path) -> None:
    assert warned(tmp_path, {"slope": SLOPE, "pit": PIT}, hydrology={"density": 0, "required": ["lake"]}) == []
    asked = {
        "requirements": {"lake": {"text": "a lake", "predicate": {"kind": "landscape_water", "terrain": "land", "water": "lake"}}}
    }
    assert warned(tmp_path, {"slope": SLOPE, "pit": PIT}, story=asked) == []
    assert warned(tmp_path, {"slope": SLOPE}) == []


def river(folder: Path, place: list[float], discharge: float = 2.0, water: dict[str, Any] | None = None) -> list[str]:
    """Warnings about a land whose required river comes in at a place."""
    inflow = {"upstream": {"position": place, "discharge": discharge}}
    return warned(
        folder,
        {"slope": SLOPE, "valley": VALLEY},
        water=water,
        hydrology={"density": 0, "inflows": inflow, "required": ["river"]},
    )


def test_a_required_river_that_soon_leaves_the_map_is_told_with_its_length(tmp_path: Path) -> None:
    (told,) = [w for w in river(tmp_path, [182, 0]) if "leaves the map" in w]
    length = float(told.split("leaves the map after ")[1].split(" m,")[0])
    assert 5 <= length < 50
    assert "at least 100 m is wanted" in told
    assert not [w for w in river(tmp_path, [-195, 0]) if "leaves the map" in w]


def test_what_a_river_brings_is_told_where_it_is_not_what_was_declared(tmp_path: Path) -> None:
    assert river(tmp_path, [-195, 0]) == []
    (told,) = river(tmp_path, [-195, 0], discharge=1e-4)
    assert told.startswith(
        "/terrains/land/hydrology/inflows/upstream/discharge: 0.0001 m^3/s are declared, and river 3, which it feeds, carries"
    )


def test_the_bankfull_discharge_of_a_liquids_inflows_is_told_beside_the_declared_mean(tmp_path: Path) -> None:
    (told,) = river(tmp_path, [-195, 0], water={"inflows": [{"rate_m3_s": 8.4}]})
    assert (
        "the liquid's inflows bring 8.4 m^3/s, the bankfull discharge of the beds; hydrology declares 2 m^3/s, the yearly mean"
        in told
    )


@pytest.mark.parametrize(("line", "count"), [(500.0, 1), (-300.0, 0)])
def test_snow_that_does_not_come_is_told_with_the_highest_ground(line: float, count: int, tmp_path: Path) -> None:
    told = warned(tmp_path, {"slope": SLOPE}, climate={"snow_line": line})
    assert len(told) == count
    assert all(
        w.startswith("/terrains/land/climate/snow_line: the most snow on the land is a cover of 0, 0.5 is wanted") for w in told
    )


def test_a_ground_of_snow_that_lies_nowhere_is_told(tmp_path: Path) -> None:
    ground = {"white": {"material": "snow", "where": [{"field": "snow", "at_least": 0.3}]}}
    (told,) = warned(tmp_path, {"slope": SLOPE}, ground=ground)
    assert told.startswith("/terrains/land/ground/white/where:")
    assert "without a snow line it lies where the yearly mean is below -2 deg C" in told
    assert warned(tmp_path, {"slope": SLOPE}, ground=ground, climate={"temperature": -12}, vegetation=None) == []


def test_plants_that_find_no_room_are_told_by_name_with_what_the_land_offers(tmp_path: Path) -> None:
    wanted = {"species": ["birch", "oak"], "density": 0.3}
    assert warned(tmp_path, {"slope": SLOPE}, vegetation=wanted) == []
    (told,) = warned(tmp_path, {"slope": SLOPE}, vegetation=wanted, climate={"snow_line": -300})
    assert told.startswith("/terrains/land/vegetation: 0 plants found room, at least 1 is wanted")
    assert "100% is under water or snow" in told
    (some,) = warned(tmp_path, {"slope": SLOPE}, vegetation=wanted, climate={"temperature": 2.5})
    assert some.startswith("/terrains/land/vegetation/species: of oak 0 plants found room")
    assert warned(tmp_path, {"slope": SLOPE}, vegetation={**wanted, "density": 0.0}, climate={"snow_line": -300}) == []

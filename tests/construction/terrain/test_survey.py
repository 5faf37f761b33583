"""Answers about a landscape are those of its fields, and found places are what was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.store import build_terrain_file
from worldagent.construction.terrain.survey import at_points, flat_places, river_places, river_station, shore_places, water_at
from worldagent.worlds.errors import InputError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.landscape import SavedLandscape
from worldagent.worlds.spec import WorldSpec

LAND = {
    "extent": [800, 800],
    "cell": 8,
    "datum": -20,
    "sea_level": 0,
    "zones": {"yard": {"center": [90, 60], "radius": 45}},
    "layers": {
        "hill": {"kind": "cone", "radius": 350, "height": 120, "irregularity": 0.0, "order": 1},
        "crater": {"kind": "crater", "radius": 60, "depth": 30, "order": 2, "late": True},
        "site": {"kind": "flatten", "zone": "yard", "falloff": 30, "order": 3},
    },
    "hydrology": {"inflows": {"spring": {"position": [0, 0], "discharge": 0.4}}, "required": ["lake", "sea", "river"]},
    "climate": {"biome": "tropical"},
}


@pytest.fixture(scope="module")
def land(tmp_path_factory: pytest.TempPathFactory) -> SavedLandscape:
    folder = WorldFolder(tmp_path_factory.mktemp("w"))
    spec = {"title": "t", "prompt": "p", "terrains": {"land": LAND}, "simulation": {"frames": 2}}
    return build_terrain_file(folder, WorldSpec.model_validate(spec), "land")[0]


def test_a_cell_centre_tells_its_own_fields(land: SavedLandscape) -> None:
    row, col = 70, 40
    at = [(col - 49.5) * 8, (row - 49.5) * 8]
    (told,) = at_points(land, [at], sea_level=0)
    assert told["height"] == pytest.approx(land.field("height")[row, col], abs=0.01)
    assert told["cover"] == land.about["cover"][int(land.raw("cover")[row, col])]
    assert np.linalg.norm(told["normal"]) == pytest.approx(1.0, abs=2e-3)
    assert told["normal"][1] > 0, "the north side of a hill faces north"


def test_water_is_told_with_its_depth(land: SavedLandscape) -> None:
    lake, sea = at_points(land, [(0, 0), (390, 390)], sea_level=0)
    assert (lake["water"], sea["water"]) == ("lake", "sea")
    assert lake["water_depth"] == pytest.approx(land.about["lakes"][0]["level"] - lake["height"], abs=0.02)
    assert sea["water_level"] == 0


def test_flat_places_are_flat_dry_apart_and_nearest_first(land: SavedLandscape) -> None:
    found, limit = flat_places(land, size=40, near=(90, 60))
    assert limit == 0.1
    assert np.hypot(found[0]["center"][0] - 90, found[0]["center"][1] - 60) < 40, "the levelled yard"
    assert [p["distance"] for p in found] == sorted(p["distance"] for p in found)
    slope, wet = land.field("slope"), land.raw("wet").astype(bool)
    for place in found:
        x, y = place["center"]
        rows, cols = (slice(*(int(np.ceil((c + o) / 8 + 49.5 - 1e-9)) for o in (-19.9, 20.1))) for c in (y, x))
        assert slope[rows, cols].max() <= 0.1 + 1e-6
        assert not wet[rows, cols].any()


def test_places_beside_water_are_dry_and_touch_it(land: SavedLandscape) -> None:
    for kind in ("sea", "lake"):
        place = shore_places(land, kind, sea_level=0, near=(0, 0), apart=20)[0]
        here, there = at_points(land, [place["at"], place["water_at"]], sea_level=0)
        assert "water" not in here
        assert there["water"] == kind
        assert np.hypot(*np.subtract(place["at"], place["water_at"])) < 8 * 1.5


def test_river_places_carry_the_discharge_of_their_reach(land: SavedLandscape) -> None:
    found = river_places(land, near=(0, 0), apart=30)
    assert found[0]["discharge"] >= 0.4
    downhill = [np.cos(np.radians(found[0]["flows_toward_deg"])), np.sin(np.radians(found[0]["flows_toward_deg"]))]
    here, below = at_points(land, [found[0]["at"], (np.array(found[0]["at"]) + 40 * np.array(downhill)).tolist()], sea_level=0)
    assert below["height"] < here["height"]


def test_a_station_of_a_river_lies_on_its_course_and_across_it(land: SavedLandscape) -> None:
    """The ends of a reach are its first and last cell; a step along the course goes the way it flows, and left is left of that."""
    grid = Grid(*land.shape, land.cell)
    reach = max(land.about["reaches"], key=lambda r: len(r["cells"]))
    first = river_station(land, reach["number"], 0.0, 0.0)
    last = river_station(land, reach["number"], first["length"] - 0.06, 0.0)
    assert first["at"] == pytest.approx(grid.place(reach["cells"][0]), abs=0.01)
    assert np.hypot(*np.subtract(last["at"], grid.place(reach["cells"][-1]))) < 0.2
    here, there = (np.array(river_station(land, reach["number"], s, 0.0)["at"]) for s in (30.0, 30.5))
    told = river_station(land, reach["number"], 30.0, 2.0)
    flow = np.array(told["flows"])
    assert 0.4 < (there - here) @ flow <= 0.501
    left = np.array(told["at"]) - here
    assert left == pytest.approx(2.0 * np.array([-flow[1], flow[0]]), abs=2e-3)
    assert reach["width"][0] - 0.01 <= told["width"] <= reach["width"][1] + 0.01
    with pytest.raises(InputError, match="m long from its upper end"):
        river_station(land, reach["number"], first["length"] + 1, 0.0)
    with pytest.raises(InputError, match="reach 999"):
        river_station(land, 999, 0.0, 0.0)


def test_the_level_of_water_is_told_and_none_where_it_is_dry(land: SavedLandscape) -> None:
    shore = shore_places(land, "shore", sea_level=None, near=(0, 0), apart=30)[0]
    wet, dry = (water_at(land, np.array(shore[k]), sea_level=None) for k in ("water_at", "at"))
    assert wet["level"] == pytest.approx(shore["water_level"], abs=0.011)
    assert "level" not in dry
    assert dry["bed"] == pytest.approx(shore["height"], abs=0.01)


def test_what_is_not_there_is_refused_in_words(land: SavedLandscape) -> None:
    with pytest.raises(InputError, match="outside the landscape"):
        at_points(land, [(500, 0)], sea_level=0)
    with pytest.raises(InputError, match="larger than the landscape"):
        flat_places(land, size=2000, near=(0, 0))

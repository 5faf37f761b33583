"""Answers about a landscape are those of its fields, and found places are what was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction.terrain.store import build_terrain_file
from worldagent.construction.terrain.survey import at_points, flat_places, river_places, shore_places
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


def test_what_is_not_there_is_refused_in_words(land: SavedLandscape) -> None:
    with pytest.raises(InputError, match="outside the landscape"):
        at_points(land, [(500, 0)], sea_level=0)
    with pytest.raises(InputError, match="larger than the landscape"):
        flat_places(land, size=2000, near=(0, 0))

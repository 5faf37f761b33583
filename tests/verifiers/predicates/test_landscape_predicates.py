"""Predicates about the land: true of lands that have it, false of lands that do not, unverified without evidence."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from worldagent.construction.terrain.store import build_terrain_file
from worldagent.testing.worlds.small_worlds import ground, make_candidate, world
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.landscape import zone_cells
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.landscape import open_landscape
from worldagent.worlds.predicates import LandscapeField, LandscapeWater, Not
from worldagent.worlds.spec.terrain import Terrain

LAND: dict[str, Any] = {
    "extent": [2000, 2000],
    "cell": 20,
    "datum": -60,
    "sea_level": 0,
    "zones": {
        "summit": {"center": [0, 0], "radius": 250},
        "east": {"polygon": [[100, -900], [900, -900], [900, 900], [100, 900]]},
        "west": {"polygon": [[-900, -900], [-100, -900], [-100, 900], [-900, 900]]},
        "shore": {"line": [[-900, 0], [-700, 0]], "width": 100},
    },
    "layers": {
        "mountain": {"kind": "cone", "radius": 900, "height": 330, "steepness": 1.3, "order": 1},
        "rough": {"kind": "noise", "style": "ridged", "amplitude": 30, "wavelength": 500, "order": 2},
        "crater": {"kind": "crater", "radius": 160, "depth": 60, "rim": 8, "order": 3, "late": True},
    },
    "erosion": {"years": 20000, "steps": 4},
    "climate": {"biome": "volcanic-island", "rain": 4, "rain_shadow": 0.9, "wind_deg": 0},
    "vegetation": {"forms": ["tree"], "density": 0.3},
}


@pytest.fixture(scope="module")
def island(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    root = tmp_path_factory.mktemp("island")
    spec = world({"floor": ground()}, frames=3).model_copy(update={"terrains": {"land": Terrain.model_validate(LAND)}})
    build_terrain_file(WorldFolder(root), spec, "land")
    return dataclasses.replace(make_candidate(root, spec), stage="static", caches={})


def judged(candidate: Candidate, predicate: Any) -> Outcome:
    return evaluate(candidate, predicate, (0, 0))


def water(**more: Any) -> LandscapeWater:
    return LandscapeWater(terrain="land", **more)


def test_the_crater_holds_a_lake_of_the_depth_that_the_file_shows(island: Candidate) -> None:
    land = open_landscape(island.folder, island.spec, "land")
    found = judged(island, water(water="lake", zone="summit", min_depth=5))
    assert found.status == "pass", found.explanation
    lake = found.details["bodies"][0]
    mask = land.raw("lake") == int(lake["name"].split()[1])
    assert lake["area"] == pytest.approx(mask.sum() * 400.0)
    deepest = (land.field("filled") - land.field("ground"))[mask].max()
    assert lake["depth"] == pytest.approx(deepest, abs=1e-3)
    assert judged(island, water(water="lake", zone="summit", min_depth=deepest + 1)).status == "fail"
    assert judged(island, water(water="lake", zone="shore")).status == "fail"


def test_rivers_are_followed_to_where_their_water_goes(island: Candidate) -> None:
    to_sea = judged(island, water(water="river", ends_in="sea", min_length=100))
    assert to_sea.status == "pass", to_sea.explanation
    longest = max(b["length"] for b in judged(island, water(water="river")).details["bodies"])
    assert judged(island, water(water="river", min_length=10 * longest + 1e4)).status == "fail"
    most = int(to_sea.value or 0)
    assert judged(island, water(water="river", ends_in="sea", min_length=100, max=most)).status == "pass"
    if most > 1:
        over = judged(island, water(water="river", ends_in="sea", min_length=100, max=most - 1))
        assert (over.status, over.comparison) == ("fail", "<=")


def test_the_wet_side_has_more_rain_and_more_trees(island: Candidate) -> None:
    ratio = judged(island, LandscapeField(terrain="land", field="rain", zone="east", relative_to="west", min=1.1))
    assert ratio.status == "pass", ratio.explanation
    turned = judged(island, LandscapeField(terrain="land", field="rain", zone="west", relative_to="east", min=1.0))
    assert turned.status == "fail"
    assert turned.value == pytest.approx(1.0 / (ratio.value or 1.0))
    land = open_landscape(island.folder, island.spec, "land")
    east = zone_cells(land, island.spec.terrains["land"], "east") & ~land.raw("wet").astype(bool)
    mean = judged(island, LandscapeField(terrain="land", field="height", zone="east", min=0))
    assert mean.value == pytest.approx(float(land.field("height")[east].mean()))
    assert judged(island, LandscapeField(terrain="land", field="height", zone="east", max=-5)).status == "fail"


def test_zones_hold_the_cells_that_geometry_says(island: Candidate) -> None:
    land = open_landscape(island.folder, island.spec, "land")
    terrain = island.spec.terrains["land"]
    area = {n: float(zone_cells(land, terrain, n).sum()) * 400.0 for n in terrain.zones}
    assert area["summit"] == pytest.approx(np.pi * 250**2, rel=0.03)
    assert area["east"] == pytest.approx(800 * 1800, rel=0.03)
    assert area["shore"] == pytest.approx(200 * 100 + np.pi * 50**2, rel=0.2)


def test_without_evidence_nothing_is_said(island: Candidate, tmp_path: Path) -> None:
    lost = dataclasses.replace(island, folder=tmp_path)
    assert judged(lost, water(water="sea")).status == "unverified"
    assert judged(lost, Not(predicate=water(water="sea"))).status == "unverified"
    assert judged(island, LandscapeWater(terrain="moon", water="sea")).status == "unverified"
    assert judged(island, water(water="sea", zone="nowhere")).status == "unverified"
    snowless = LandscapeField(terrain="land", field="grass_density", min=0)
    assert judged(island, snowless).status == "unverified"


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"water": "lake", "ends_in": "sea"}, "does not apply"),
        ({"water": "river", "min_area": 3}, "does not apply"),
        ({"water": "sea", "min": 3, "max": 2}, "max must be"),
        ({"water": "puddle"}, "Input should be"),
    ],
)
def test_what_cannot_be_asked_is_refused(fields: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        water(**fields)
    with pytest.raises(ValidationError, match="unknown field"):
        LandscapeField(terrain="land", field="aspect", min=0)

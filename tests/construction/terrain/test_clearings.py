"""Areas without plants: what the scatterer keeps free, and what the judge finds in them by a route of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.store import build_world
from worldagent.construction.terrain.store import build_terrain_file
from worldagent.verifiers.land.terrain import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError, InputError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.landscape import SavedLandscape, open_landscape, save_landscape
from worldagent.worlds.provenance import recipes
from worldagent.worlds.spec import WorldSpec

HUT: dict[str, Any] = {
    "role": "log cabin",
    "motion": "static",
    "material": "wood",
    "dimensions": {"size": [6, 4, 3]},
    "pose": {"position": [37, -22, 40], "euler": [0, 0, 0.6]},
    "parts": {"walls": {"shape": {"kind": "box", "size": [6, 4, 3]}}},
}
AREAS: dict[str, Any] = {
    "by_the_hut": {"around": "hut", "margin": 20},
    "glade": {"center": [-60, 50], "radius": 15, "margin": 2},
    "field": {"polygon": [[-90, -90], [-30, -90], [-60, -40]], "margin": 3},
    "track": {"zone": "track", "margin": 1},
}


def _spec(clear: dict[str, Any], *, at: tuple[float, float, float] = (37, -22, 40)) -> WorldSpec:
    return WorldSpec.model_validate(
        {
            "title": "t",
            "prompt": "p",
            "materials": {"wood": {"density": 600, "substance": "wood"}},
            "entities": {"hut": {**HUT, "pose": {"position": at, "euler": [0, 0, 0.6]}}},
            "terrains": {
                "land": {
                    "extent": [240, 240],
                    "cell": 3,
                    "datum": 30,
                    "zones": {"track": {"line": [[-110, 100], [100, 60]], "width": 8}},
                    "layers": {"roll": {"kind": "noise", "amplitude": 6, "wavelength": 120}},
                    "climate": {"biome": "temperate"},
                    "vegetation": {"forms": ["tree", "rock"], "density": 2, "clear": clear},
                }
            },
            "simulation": {"frames": 2},
        }
    )


def _to_box(points: np.ndarray) -> np.ndarray:
    """Distance to the hut's outline, by the formula of a rectangle."""
    c, s = np.cos(0.6), np.sin(0.6)
    local = (points - [37, -22]) @ np.array([[c, -s], [s, c]])
    return np.asarray(np.hypot(*np.maximum(np.abs(local) - [3, 2], 0).T))


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[WorldFolder, SavedLandscape]:
    folder = WorldFolder(tmp_path_factory.mktemp("w"))
    return folder, build_terrain_file(folder, _spec(AREAS), "land")[0]


def _plants_row(folder: WorldFolder, spec: WorldSpec) -> Any:
    entities, _ = build_world(folder, spec)
    rows = {r.id: r for r in check(Candidate(folder.root, spec, entities, "static"))}
    return rows.get("terrain:land:plants", rows.get("terrain:land"))


def test_no_stem_stands_in_a_clearing_or_its_margin(built: tuple[WorldFolder, SavedLandscape]) -> None:
    place = built[1].raw("plant_position")[:, :2]
    assert len(place) > 300
    assert _to_box(place).min() > 20
    assert np.hypot(*(place - [-60, 50]).T).min() > 17
    along = np.array([210.0, -40.0]) / np.hypot(210, 40)
    assert np.abs((place - [-110, 100]) @ [-along[1], along[0]])[place[:, 0] < 90].min() > 5
    inside = (place[:, 1] > -90) & (place[:, 1] < -90 + 50 / 30 * np.minimum(place[:, 0] + 90, -30 - place[:, 0]))
    assert not inside.any()
    # And the forest goes on right beyond.
    assert _to_box(place).min() < 20 + 3 * 3 + 4


def test_the_row_of_plants_judges_clearings(built: tuple[WorldFolder, SavedLandscape]) -> None:
    row = _plants_row(built[0], _spec(AREAS))
    assert (row.status, row.measured) == ("pass", 0)


@pytest.mark.parametrize("place", [(37, -22), (37, -1.5), (-60, 63), (-60, -60), (-31, -92), (0, 80)])
def test_a_plant_put_into_a_clearing_fails_the_row(
    place: tuple[float, float], built: tuple[WorldFolder, SavedLandscape], tmp_path: Path
) -> None:
    folder, land = WorldFolder(tmp_path), built[1]
    arrays = {name: land.raw(name).copy() for name in land.names}
    rows, cols = land.shape
    row, col = round(place[1] / land.cell + 0.5 * (rows - 1)), round(place[0] / land.cell + 0.5 * (cols - 1))
    at = [(col - 0.5 * (cols - 1)) * land.cell, (row - 0.5 * (rows - 1)) * land.cell]
    arrays["plant_position"][0] = [*at, arrays["height"][row, col]]
    save_landscape(folder.root / "terrain" / land.path.name, arrays, land.about)
    found = _plants_row(folder, _spec(AREAS))
    assert (found.status, found.measured) == ("fail", 1)
    assert "1 in a clearing" in found.evidence["explanation"]


def test_moving_what_stands_in_the_clearing_makes_the_landscape_stale_and_lifting_it_does_not(
    built: tuple[WorldFolder, SavedLandscape],
) -> None:
    lifted, moved = _spec(AREAS, at=(37, -22, 44)), _spec(AREAS, at=(30, -22, 40))
    before = recipes(_spec(AREAS))["terrain:land"]
    assert recipes(lifted)["terrain:land"] == before != recipes(moved)["terrain:land"]
    assert open_landscape(built[0].root, lifted, "land").path == built[1].path
    with pytest.raises(EvidenceError, match="build_terrain"):
        open_landscape(built[0].root, moved, "land")
    free = {k: v for k, v in AREAS.items() if k != "by_the_hut"}
    assert recipes(_spec(free))["terrain:land"] == recipes(_spec(free, at=(30, -22, 40)))["terrain:land"]


@pytest.mark.parametrize(
    ("area", "words"),
    [
        ({"margin": 5}, "give one of polygon, center with radius, zone, around"),
        ({"center": [0, 0]}, "center with radius"),
        ({"center": [0, 0], "radius": 2, "around": "hut"}, "give one of"),
        ({"around": "hut", "margin": -1}, "greater than or equal to 0"),
    ],
)
def test_an_area_that_is_no_area_is_refused(area: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        _spec({"a": area})


@pytest.mark.parametrize(
    ("area", "words"),
    [
        ({"around": "hutt"}, "did you mean 'hut'"),
        ({"zone": "trak"}, "zone 'trak' is not declared; the terrain has \\['track'\\]"),
    ],
)
def test_a_clearing_around_nothing_says_what_there_is(area: dict[str, Any], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        build_terrain_file(WorldFolder(tmp_path), _spec({"a": area}), "land")

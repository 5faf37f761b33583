"""Landscapes in pictures: plants are whole forms, the ground has the colours of its cover, water lies where it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.store import build_world
from worldagent.construction.terrain.store import build_terrain_file, cut_patch
from worldagent.construction.terrain.vegetation import species_of
from worldagent.geometry.camera import Camera
from worldagent.rendering import field_map, render_frame
from worldagent.rendering.plants import form_of, placed
from worldagent.rendering.scenery import cut_from, ground_image, landscapes_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import InputError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.landscape import FIELDS
from worldagent.worlds.spec import WorldSpec

LAND = {
    "extent": [600, 600],
    "cell": 6,
    "datum": -20,
    "sea_level": 0,
    "layers": {"hill": {"kind": "cone", "radius": 240, "height": 90, "irregularity": 0.0}},
    "climate": {"biome": "tropical"},
    "ground": {"beach": {"material": "sand", "where": [{"field": "height", "at_most": 25}]}},
    "vegetation": {"density": 0.5},
}


@pytest.fixture(scope="module")
def candidate(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    folder = WorldFolder(tmp_path_factory.mktemp("w"))
    spec = {
        "title": "t",
        "prompt": "p",
        "materials": {"rock": {"density": 2600}, "sand": {"density": 1600, "appearance": {"color": [0.9, 0.1, 0.1]}}},
        "terrains": {"land": LAND},
        "simulation": {"frames": 2},
    }
    land, _ = build_terrain_file(folder, WorldSpec.model_validate(spec), "land")
    patch = cut_patch(folder, "land", land, center=(0.0, 0.0), size=(60.0, 60.0), cells=20)
    shape = {"kind": "heightfield", "size": [60, 60], "file": patch.file, "digest": patch.digest}
    spec["entities"] = {
        "ground": {
            "role": "g",
            "motion": "static",
            "material": "rock",
            "dimensions": {"size": [60, 60, 30]},
            "parts": {"land": {"shape": shape}},
        }
    }
    made = WorldSpec.model_validate(spec)
    built, _ = build_world(folder, made)
    return Candidate(folder.root, made, built, "static")


@pytest.mark.parametrize("near", [False, True])
@pytest.mark.parametrize("shape", sorted({s.shape for b in ("temperate", "desert", "tropical") for s in species_of(b)}))
def test_every_form_is_about_one_unit_high_and_stands_on_its_foot(shape: str, near: bool) -> None:
    form = form_of(shape, near=near, seed=3)
    assert np.isfinite(form.vertices).all()
    assert form.faces.max() < len(form.vertices)
    assert len(form.foliage) == len(form.faces)
    assert -0.45 < form.vertices[:, 2].min() < 0.15
    assert 0.6 < form.vertices[:, 2].max() < 1.3
    assert near or len(form.faces) < 90


def test_instances_are_scaled_turned_and_set_on_their_place() -> None:
    form = form_of("cone", near=False, seed=1)
    position = np.array([[10.0, 20.0, 5.0], [0.0, 0.0, 1.0]])
    vertices, faces = placed(form, position, np.array([4.0, 2.0]), np.array([np.pi / 2, 0.0]))
    first, second = vertices[: len(form.vertices)], vertices[len(form.vertices) :]
    assert second == pytest.approx(form.vertices * 2 + [0, 0, 1])
    x, y, z = form.vertices.T
    assert first == pytest.approx(np.stack([-y, x, z], 1) * 4 + [10, 20, 5])
    assert faces.max() == len(vertices) - 1


def test_the_ground_has_the_colours_of_its_cover(candidate: Candidate) -> None:
    land = landscapes_of(candidate)["land"]
    image = ground_image(candidate, land)
    sand = land.raw("cover") == land.about["cover"].index("sand")
    dry = sand & (land.field("water_distance") > 20)
    assert image.shape == (*land.shape, 3)
    assert dry.any()
    assert (image[dry][:, 0] > 3 * image[dry][:, 1]).all()
    assert cut_from(candidate, "ground") == "land"


def test_a_picture_shows_sea_round_green_land(candidate: Candidate) -> None:
    view = Camera(np.array([0.0, 0.0, 900.0]), np.array([0.0, 1.0, 0.0]), 40.0, 96, 96)
    picture = render_frame(candidate, 0, camera=view, width=96, height=96, samples=8).astype(float)
    middle, corner = picture[42:54, 42:54].reshape(-1, 3).mean(0), picture[:8, :8].reshape(-1, 3).mean(0)
    assert middle[1] > middle[2], "green land in the middle"
    assert corner[2] > corner[0], "blue water around"


@pytest.mark.parametrize("field", ["hillshade", "height", "accumulation", "cover", "flow_direction", "water_level", "curvature"])
def test_a_map_shows_every_kind_of_field(candidate: Candidate, field: str) -> None:
    land = landscapes_of(candidate)["land"]
    image = field_map(land, field, width=400, height=300)
    assert image.shape == (300, 400, 3)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 20
    with pytest.raises(InputError, match="hillshade"):
        field_map(land, "nothing")


def test_every_stored_field_is_described_and_none_else(candidate: Candidate) -> None:
    names = {n for n in landscapes_of(candidate)["land"].names if not n.startswith("plant_")}
    assert names <= set(FIELDS)
    assert {n for n in FIELDS if not n.endswith("_density")} <= names


def test_a_landscape_of_another_specification_is_not_drawn(candidate: Candidate, tmp_path: Path) -> None:
    assert landscapes_of(Candidate(tmp_path, candidate.spec, candidate.built, "static")) == {}

"""Landscapes in pictures: plants are whole forms, the ground has the colours of its cover, water lies where it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.stems import cut_stems
from worldagent.construction.store import build_world
from worldagent.construction.terrain.store import build_terrain_file, cut_patch
from worldagent.construction.terrain.vegetation import species_of
from worldagent.geometry.camera import Camera
from worldagent.rendering import field_map, preview, render_frame
from worldagent.rendering.land.field_map import _contours
from worldagent.rendering.land.ground_look import ground_image
from worldagent.rendering.land.haze import hazed
from worldagent.rendering.land.planting import NEAR_M, eyes_of, nearest_eye
from worldagent.rendering.land.plants import form_of, placed
from worldagent.rendering.land.scenery import cut_from, drawn_land, landscapes_of, scenery_shapes
from worldagent.rendering.land.waters import Course, courses, drawn_height, ribbon_of, surface_height
from worldagent.rendering.preview import PreviewRenderer
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.rendering.tracer.variant import load_mitsuba
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
    "zones": {"north": {"polygon": [[-300, 60], [300, 60], [300, 300], [-300, 300]]}},
    "ground": {
        "beach": {"material": "sand", "where": [{"field": "height", "at_most": 25}]},
        "north": {"material": "clay", "zone": "north", "order": 2},
    },
    "vegetation": {"density": 0.5},
}


@pytest.fixture(scope="module")
def candidate(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    folder = WorldFolder(tmp_path_factory.mktemp("w"))
    spec = {
        "title": "t",
        "prompt": "p",
        "materials": {
            "rock": {"density": 2600},
            "sand": {"density": 1600, "appearance": {"color": [0.9, 0.1, 0.1]}},
            "clay": {"density": 1600, "appearance": {"color": [0.05, 0.05, 0.9]}},
        },
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


@pytest.mark.parametrize("detail", [0, 1, 2])
@pytest.mark.parametrize("shape", sorted({s.shape for b in ("temperate", "desert", "tropical") for s in species_of(b)}))
def test_every_form_is_about_one_unit_high_and_stands_on_its_foot(shape: str, detail: int) -> None:
    form = form_of(shape, detail=detail, seed=3)
    assert np.isfinite(form.vertices).all()
    assert form.faces.max() < len(form.vertices)
    assert len(form.foliage) == len(form.faces)
    assert -0.45 < form.vertices[:, 2].min() < (0.75 if detail == 0 else 0.15)
    assert 0.6 < form.vertices[:, 2].max() < 1.3
    assert len(form.faces) < (21, 90, 10_000)[detail]


def test_instances_are_scaled_turned_and_set_on_their_place() -> None:
    form = form_of("cone", detail=1, seed=1)
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


def test_the_colours_of_the_ground_lie_where_their_ground_lies(candidate: Candidate) -> None:
    view = Camera(np.array([0.0, 0.0, 500.0]), np.array([0.0, 1.0, 0.0]), 30.0, 60, 60)
    albedo = SceneRenderer(candidate).features(view).albedo
    north, south = albedo[4:20, 20:40].reshape(-1, 3).mean(0), albedo[40:56, 20:40].reshape(-1, 3).mean(0)
    assert north[2] > 2 * north[0], "blue clay in the north"
    assert south[2] < south[0] + south[1], "none in the south"


def test_haze_leaves_what_is_near_and_hides_what_is_far(candidate: Candidate) -> None:
    class Scene:
        def depth(self, view: Camera) -> Any:
            return np.array([[0.0, 10.0, 1e7]], dtype=np.float32)

        def radiance(self, view: Camera, samples: int, *, seed: int) -> Any:
            return np.full((4, 8, 3), 2.0, dtype=np.float32)

    up = Camera(np.zeros(3), np.array([1.0, 0.0, 3.0]), 20.0, 3, 1)
    air = hazed(Scene(), up, np.ones((1, 3, 3), dtype=np.float32), seed=0)  # type: ignore[arg-type]
    assert air[0, :, 0] == pytest.approx([1.0, 1.0, 2.0], abs=1e-3)


def test_plants_near_any_camera_are_told_by_its_eyes(candidate: Candidate) -> None:
    position = landscapes_of(candidate)["land"].raw("plant_position")
    own = position[0] + [0.0, 0.0, 2.0]
    assert len(eyes_of(candidate)) == 0, "the plan has no shot"
    assert not np.isfinite(nearest_eye(position, eyes_of(candidate))).any()
    away = nearest_eye(position, eyes_of(candidate, (own,)))
    assert away[0] == pytest.approx(2.0)
    assert (away < NEAR_M).any()


def test_rivers_follow_smooth_courses_of_their_width_on_the_drawn_land(tmp_path: Path) -> None:
    terrain = {
        "extent": [900, 900], "cell": 10,
        "layers": {"fall": {"kind": "ramp", "rise": 60, "direction_deg": 63}, "rough": {"kind": "noise", "amplitude": 8, "wavelength": 300}},
        "hydrology": {"inflows": {"in": {"position": [150, 350], "discharge": 0.5}}, "required": ["river"]},
    }  # fmt: skip
    spec = {"title": "t", "prompt": "p", "terrains": {"land": terrain}, "simulation": {"frames": 2}}
    land, _ = build_terrain_file(WorldFolder(tmp_path), WorldSpec.model_validate(spec), "land")
    x, y, height = drawn_land(land)
    course = max(courses(land), key=lambda c: c.width.max())
    reach = max(land.about["reaches"], key=lambda r: max(r["width"]))
    assert course.width[-1] == pytest.approx(reach["width"][1], rel=0.05)
    assert (np.diff(course.level) <= 0).all()
    steps = np.diff(course.line, axis=0)
    steps = steps[np.linalg.norm(steps, axis=1) > 1e-9]
    turns = np.degrees(np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))))
    assert np.percentile(turns, 90) < 20, "no stairs of 45 degrees"
    corner = np.array([[x[3], y[7]], [0.5 * (x[3] + x[4]), 0.5 * (y[7] + y[8])]])
    found = surface_height(x, y, height, corner)
    assert found[0] == pytest.approx(height[7, 3])
    assert found[1] == pytest.approx(0.5 * (height[7, 3] + height[8, 4])), "the edge from south-west to north-east"


def test_a_preview_shows_land_sea_and_plants_quickly(candidate: Candidate) -> None:
    view = Camera(np.array([0.0, -420.0, 260.0]), np.array([0.0, 0.0, 20.0]), 45.0, 320, 180)
    picture = preview(candidate, 0, camera=view).astype(float)
    land, sea = picture[95:115, 140:180].reshape(-1, 3).mean(0), picture[40:44, 4:30].reshape(-1, 3).mean(0)
    assert land[1] > land[2] or land[0] > land[2], "land in the middle"
    assert sea[2] > sea[0], "sea beside it"
    bare = candidate.spec.model_copy(update={"terrains": {}})
    assert np.abs(preview(Candidate(candidate.folder, bare, candidate.built, "static"), 0, camera=view) - picture).mean() > 10


def test_maps_of_height_carry_contours_and_say_their_interval(candidate: Candidate) -> None:
    land = landscapes_of(candidate)["land"]
    image = np.full((90, 120, 3), 200, dtype=np.uint8)
    height = np.broadcast_to(np.linspace(0.0, 100.0, 120), (90, 120)).copy()
    height[:20] = np.nan
    assert _contours(image, height) == 5.0
    lines = image[60, :, 0] < 200
    assert lines.sum() == pytest.approx(20, abs=1), "one line each 5 m"
    assert (image[5] == 200).all(), "none where there is no land"
    assert _contours(image, np.full((90, 120), 7.0)) == 0.0, "level land has none"
    assert (field_map(land, "height") != field_map(land, "slope")).any()


def test_solid_trunks_are_drawn_once_as_plants(candidate: Candidate) -> None:
    """Their part is for bodies: neither the path tracer nor a preview shows it, and whoever looks for what hides a body sees it."""
    land = landscapes_of(candidate)["land"]
    cut = cut_stems(WorldFolder(candidate.folder), "land", land, center=(0.0, 0.0), size=(60.0, 60.0))
    assert cut is not None
    document = candidate.spec.model_dump(mode="json")
    shape = {"kind": "stems", "file": cut.file, "digest": cut.digest, "count": cut.number}
    document["entities"]["ground"]["parts"]["stems"] = {"shape": shape}
    spec = WorldSpec.model_validate(document)
    solid = Candidate(candidate.folder, spec, build_world(WorldFolder(candidate.folder), spec)[0], "static")
    names = [set(scenery_shapes(load_mitsuba(), one)) for one in (candidate, solid)]
    assert names[0] == names[1]
    assert "ground-ground-land" in names[1]
    x, y, z = np.load(candidate.folder / "assets" / cut.file)[0, :3]
    camera = Camera(np.array([x + 3.0, y, z + 1.0]), np.array([x, y, z + 0.3]), 0.8, 120, 80)
    before, after = (PreviewRenderer(one).preview(0, camera) for one in (candidate, solid))
    assert (before == after).all(), "no trunk appears"
    parts = PreviewRenderer(solid).parts
    stems = next(k for k, (_, part) in enumerate(parts) if part.part == "stems")
    assert (PreviewRenderer(solid).cast(0, camera).ids == stems).any()


def test_no_land_stands_out_of_a_river_narrower_than_a_cell() -> None:
    """A winding ribbon over rough land, drawn as triangles: its own triangles lie over the land everywhere."""
    rng = np.random.default_rng(5)
    x, y = np.linspace(-60, 60, 21), np.linspace(-30, 30, 11)
    drawn = [(x, y, rng.uniform(-1.2, 1.2, (11, 21)))]
    along = np.linspace(-55, 55, 75)
    course = Course(np.column_stack([along, 12 * np.sin(along / 14)]), np.linspace(2.0, 5.0, 75), np.zeros(75), "river")
    ribbon = ribbon_of(course, 6.0, drawn)
    lowest = np.inf
    for s in (0.25, 0.5, 0.75):
        for t in (0.2, 0.5, 0.8):
            u, v = (1 - s, s), (1 - t, t)
            point = sum(u[i] * v[j] * ribbon[i : i - 1 or None, j : j - 1 or None] for i in (0, 1) for j in (0, 1)).reshape(-1, 3)
            lowest = min(lowest, float((point[:, 2] - drawn_height(drawn, point[:, :2])).min()))
    assert lowest > 0.0
    assert (
        ribbon[:, 1:-1, 2] - drawn_height(drawn, ribbon[:, 1:-1, :2].reshape(-1, 2)).reshape(ribbon[:, 1:-1].shape[:2])
    ).max() < 2.0

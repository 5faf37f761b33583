"""Light and geometry of the path-traced picture."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering import preview
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.rendering.views import automatic_camera, camera_for, focus_bounds
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import STONE, bricks, simulate, struck_wall
from worldagent.worlds.errors import InputError

FURNACE_TOLERANCE = 0.03
"""Relative; leaves room for the specular lobe's estimate and sampling noise."""
PIXEL_TOLERANCE = 1.0
"""Between a ball's centre in the picture and its projection [pixels]."""


def _only(candidate, name):
    return dataclasses.replace(candidate, built={name: candidate.built[name]})


def _burley_albedo(roughness: float) -> float:
    """Directional albedo of Burley's diffuse lobe (2012, "Physically-based shading at Disney") seen along the normal."""
    cosine = (np.arange(2000) + 0.5) / 2000
    half = np.cos(np.arccos(cosine) / 2)
    grazing = 0.5 + 2 * roughness * half**2
    return float(np.mean((1 + (grazing - 1) * (1 - cosine) ** 5) * 2 * cosine))


def test_a_diffuse_ball_in_a_uniform_dome_has_the_radiance_that_its_albedo_says(make_candidate):
    """Law: in a furnace the radiance is albedo times the dome's; specular reflection at 1.5 adds 4 % of the dome."""

    def grey(data):
        data["materials"]["red"]["appearance"] = {"color": (0.5, 0.5, 0.5), "roughness": 0.6}

    scene = SceneRenderer(
        _only(make_candidate(change=grey), "ball"),
        lights={"dome": {"type": "constant", "radiance": {"type": "rgb", "value": 2.0}}},
    )
    camera = Camera(np.array([-0.5, -2.0, 0.1]), np.array([-0.5, -0.1, 0.1]), 2.0, 12, 12)
    measured = float(scene.radiance(camera, 512).mean())
    assert measured == pytest.approx(2.0 * (0.5 * _burley_albedo(0.6) + 0.04), rel=FURNACE_TOLERANCE)


def test_a_white_ball_gives_back_no_more_light_than_it_gets(make_candidate):
    """Law: energy; but known of Burley's lobe: at grazing angles it adds up to some percent, so the bound is 1.08."""

    def white(data):
        data["materials"]["red"]["appearance"] = {"color": (1, 1, 1), "roughness": 0.5}

    scene = SceneRenderer(
        _only(make_candidate(change=white), "ball"),
        lights={"dome": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}},
    )
    camera = Camera(np.array([-0.5, -2.0, 0.1]), np.array([-0.5, -0.1, 0.1]), 7.0, 32, 32)
    seen = np.abs(scene.features(camera).normals).sum(-1) > 0.5
    assert 0.8 < float(scene.radiance(camera, 128)[seen].mean()) < 1.08


def test_area_light_gives_the_irradiance_of_its_watts(make_candidate):
    """Law: a small Lambertian panel of flux P at distance d above a plane gives E = P / (pi d^2) below it."""

    def lit(data):
        data["materials"]["grey"]["appearance"] = {"color": (0.5, 0.5, 0.5), "roughness": 0.6}
        data["entities"]["table"]["material"] = "grey"
        data["look"]["lights"] = {"lamp": {"position": (0.5, 0.3, 3), "target": (0.5, 0.3, 0), "size": 0.2, "power": 100}}

    candidate = _only(make_candidate(change=lit), "table")
    from worldagent.rendering.tracer.lights import light_dicts
    from worldagent.rendering.tracer.variant import load_mitsuba

    lights = {k: v for k, v in light_dicts(load_mitsuba(), candidate).items() if k == "light-lamp"}
    scene = SceneRenderer(candidate, lights=lights)
    camera = Camera(np.array([0.5, 0.3, 1.0]), np.array([0.5, 0.3, 0.0]), 2.0, 8, 8)
    # The eye sees the plane along its normal, where the light also comes from: both lobes at zero angle.
    radiance = float(scene.radiance(camera, 256).mean())
    irradiance = 100 / (math.pi * 9)
    assert radiance / irradiance == pytest.approx(0.5 / math.pi, rel=0.25)


def test_a_moved_ball_is_where_the_camera_projects_it(make_candidate):
    scene = SceneRenderer(_only(make_candidate(), "ball"), lights={"dome": {"type": "constant"}})
    camera = Camera(np.array([0.2, -4.0, 1.0]), np.array([0.0, 0.0, 0.1]), 30.0, 96, 54)
    candidate = scene.candidate
    for frame in (0, 3, 5, 1):
        scene.pose(frame)
        normals = scene.features(camera).normals
        rows, columns = np.nonzero(np.abs(normals).sum(-1) > 0.5)
        expected = camera.project(candidate.center("ball", frame)[None])[0][0]
        assert np.hypot(columns.mean() + 0.5 - expected[0], rows.mean() + 0.5 - expected[1]) < PIXEL_TOLERANCE


def test_an_entity_that_does_not_exist_yet_is_not_drawn(make_candidate):
    def later(data):
        data["entities"]["ball"]["active"] = (3, 5)

    scene = SceneRenderer(_only(make_candidate(change=later), "ball"), lights={"dome": {"type": "constant"}})
    camera = automatic_camera(scene.candidate, 48, 27)
    assert np.abs(scene.features(camera).normals).max() == 0
    scene.pose(4)
    assert np.abs(scene.features(camera).normals).max() > 0.5


def test_wood_is_not_a_flat_colour(candidate):
    scene = SceneRenderer(candidate)
    camera = Camera(np.array([0.5, -0.2, 0.8]), np.array([0.5, -0.19, 0.0]), 40.0, 64, 48)
    albedo = scene.features(camera).albedo
    assert albedo.std(axis=(0, 1)).max() > 0.02
    assert albedo[..., 0].mean() > 1.3 * albedo[..., 2].mean()


def test_automatic_view_frames_everything(candidate):
    camera = automatic_camera(candidate, 160, 90)
    for name in candidate.built:
        assert camera.in_frame(candidate.vertices(name, 0)).all()
    box = focus_bounds(candidate)
    assert box.high[0] >= 0.5 + 0.1, "the ball's whole path counts"


def test_follow_moves_the_target_with_the_entity(make_candidate):
    def follow(data):
        data["shots"]["all"]["follow"] = "ball"

    candidate = make_candidate(change=follow)
    first, last = (camera_for(candidate, k, width=64, height=36) for k in (0, 5))
    assert np.allclose(np.asarray(last.target) - np.asarray(first.target), [1.0, 0, 0])


def test_an_unknown_shot_is_refused_by_name(candidate):
    with pytest.raises(InputError, match="no shot 'nope'"):
        camera_for(candidate, 0, shot="nope", width=64, height=36)


def test_a_picture_does_not_depend_on_the_frames_before_it(candidate):
    scene = SceneRenderer(candidate)
    camera = camera_for(candidate, 3, width=48, height=27)
    pictures = []
    for path in ((3,), (2, 3), (1, 2, 3)):
        for frame in path:
            scene.pose(frame)
        pictures.append(scene.radiance(camera, 2, seed=1))
        scene.pose(0)
    assert pictures[0].max() > 0, "a black picture equals any other"
    assert np.array_equal(pictures[1], pictures[0])
    assert np.array_equal(pictures[2], pictures[0])


@pytest.mark.parametrize("elevation", [15.0, 50.0])
def test_the_far_disc_gives_the_light_of_the_sun_that_it_replaces(make_candidate, elevation):
    """Own choice against a reference: our sky and disc on a table, against Mitsuba's `sunsky` with its sun."""

    def high(data):
        data["look"]["sun_elevation_deg"] = elevation
        data["materials"]["grey"]["appearance"] = {"color": (0.5, 0.5, 0.5), "roughness": 0.6}
        data["entities"]["table"]["material"] = "grey"

    candidate = _only(make_candidate("sunsky", change=high), "table")
    from worldagent.rendering.tracer.lights import SUN_SKY_SCALE, light_dicts
    from worldagent.rendering.tracer.variant import load_mitsuba

    ours = {k: v for k, v in light_dicts(load_mitsuba(), candidate).items() if k in ("sky", "sun")}
    whole = ours["sky"] | {"sun_scale": SUN_SKY_SCALE, "sun_aperture": 10.0}
    camera = Camera(np.array([0.5, 0.3, 1.0]), np.array([0.5, 0.31, 0.0]), 2.0, 16, 16)
    measured = SceneRenderer(candidate, lights=ours).radiance(camera, 256).mean((0, 1))
    expected = SceneRenderer(candidate, lights={"sky": whole}).radiance(camera, 2048).mean((0, 1))
    assert np.allclose(measured, expected, rtol=0.06)


@pytest.mark.parametrize(("kind", "tones"), [("bricks", 3), ("voronoi", 1)])
def test_a_whole_wall_shows_its_bricks_and_a_pot_no_cracks(tmp_path, kind, tones):
    """Bricks lie there before a wall breaks; cells of other patterns are not to be seen before."""
    pattern = bricks() if kind == "bricks" else {"kind": "voronoi", "pieces": 12}
    entities = struck_wall(0.0).model_dump(mode="json")["entities"]
    wall = entities["wall"] | {"breakable": entities["wall"]["breakable"] | {"pattern": pattern}}
    spec = rigid_world.world({"floor": entities["floor"], "wall": wall}, seconds=1 / 24, materials=STONE)
    candidate = simulate(tmp_path, spec)
    camera = Camera(np.array([0.0, -1.2, 0.2]), np.array([0.0, 0.0, 0.2]), 20.0, 160, 90)
    image = preview(candidate, 0, camera=camera)[30:60, 40:120].reshape(-1, 3)
    albedo = SceneRenderer(candidate).features(camera).albedo[30:60, 40:120].reshape(-1, 3)
    assert len(np.unique(albedo.round(3), axis=0)) == tones, "three of the four tones lie in this window"
    # Previews shade by the light as well, the same all over a wall's front, and draw no lines within an entity.
    assert len(np.unique(image // 8, axis=0)) >= tones if tones > 1 else np.ptp(image.astype(int), axis=0).max() < 8


def test_panes_are_where_glass_is_the_first_hit(make_candidate):
    def glass(data):
        data["materials"]["red"]["appearance"] = {"color": (0.9, 0.9, 0.9), "roughness": 0.05, "transmission": 1.0}

    camera = Camera(np.array([-0.5, -2.0, 0.1]), np.array([-0.5, -0.1, 0.1]), 20.0, 40, 24)
    scene = SceneRenderer(_only(make_candidate(change=glass), "ball"), lights={})
    seen = scene.depth(camera) > 0
    panes = scene.panes(camera)
    assert 0.02 < seen.mean() < 0.9
    assert (panes != seen).mean() < 0.06  # rims: a sample within the pixel, and its middle
    assert SceneRenderer(_only(make_candidate(), "ball"), lights={}).panes(camera) is None

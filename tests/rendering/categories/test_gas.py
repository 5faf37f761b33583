"""Gas in pictures: what it takes of light by its optical depth, what it sends back, and what stands before it."""

from __future__ import annotations

import copy
import dataclasses
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering import FrameRenderer, PreviewRenderer, section_view
from worldagent.rendering.categories.gas.boxes import GasBox
from worldagent.rendering.categories.gas.layer import GasLayer
from worldagent.rendering.categories.gas.look import SOOT_ALBEDO, GasLook, look_of
from worldagent.rendering.categories.gas.shading import DAYLIGHT, depth_towards, source_of
from worldagent.rendering.categories.layer import Daylight
from worldagent.rendering.glow import glow
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.testing.worlds.by_category import spec_of
from worldagent.testing.worlds.small_gas import SMOKE_PROMPT, smoke_spec
from worldagent.tests.rendering.categories.test_layers import candidate_of, gas_cache
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import Appearance, Material

CELL = 0.05
CELLS = (8, 6, 8)
THROUGH = 6 * CELL
"""Way through the box along y [m]."""
MIDDLE = np.array([0.0, 0.0, 0.5])
SIZE = (24, 24)
AHEAD = Camera(MIDDLE + np.array([0.0, -3.0, 0.0]), MIDDLE, 1.0, *SIZE)
"""Sees the box and nothing beside it."""
SPREAD = 0.03
"""Relative: looking up between cells, slice after slice, lets a little of the air beside the box in."""
NOISE = 0.02
"""Relative, of the mean over a picture; its samples are free flights."""
WHITE = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}
Smoky = Callable[..., Candidate]


@pytest.fixture
def smoky(tmp_path: Path) -> Smoky:
    """Makes a room with a plate and a box of soot (nx, ny, nz) [kg/m^3] in the air before it."""

    def make(soot: np.ndarray, color: tuple[float, float, float] = (0.0, 0.0, 0.0), **more: Any) -> Candidate:
        data = copy.deepcopy(smoke_spec(frames=4, resolution=CELL))
        data["materials"]["smoke"]["appearance"] = {"color": color}
        data["materials"]["stone"]["appearance"] = {"color": (0.5, 0.5, 0.5), "roughness": 1.0}
        data["entities"]["smoke"]["pose"]["position"] = MIDDLE.tolist()
        data["entities"]["plate"]["pose"]["position"] = more.get("plate", [5.0, 0, 0.5])
        spec, folder = spec_of(data, SMOKE_PROMPT), Path(tempfile.mkdtemp(dir=tmp_path))
        plain = candidate_of(folder / "plain", spec)
        name = next(iter(spec.simulation.gas))
        cache = gas_cache(folder / "gas", spec, name, soot, more.get("temperature", 300.0))
        return Candidate(folder, spec, plain.built, "full", {name: cache})

    return make


def _even(tau: float) -> np.ndarray:
    """Soot of which the way through the box has an optical depth."""
    return np.full(CELLS, tau / (8700.0 * THROUGH))


@pytest.mark.parametrize("tau", [0.3, 1.0, 3.0])
def test_previews_see_through_an_even_slab_what_its_optical_depth_leaves(smoky: Smoky, tau: float) -> None:
    """Law: Beer and Lambert; black soot sends nothing back."""
    candidate = smoky(_even(tau))
    drawn = PreviewRenderer(candidate)
    (layer,) = drawn._volumes
    spans = np.tile(np.array([0.0, 1e9]), (*SIZE, 1))
    assert layer.depths(0, AHEAD, spans) == pytest.approx(tau, rel=1e-3)
    behind = np.full((*SIZE, 3), 0.7)
    laid, shown = layer.laid(behind, np.full(SIZE, np.inf), 0, AHEAD, drawn._daylight(0))
    assert shown == pytest.approx(np.exp(-tau), rel=1e-3)
    assert laid == pytest.approx(0.7 * np.exp(-tau), rel=2e-3)


@pytest.mark.parametrize("tau", [0.3, 1.0, 3.0])
def test_the_path_tracer_sees_through_an_even_slab_what_its_optical_depth_leaves(smoky: Smoky, tau: float) -> None:
    """Law: the same; from within half of the way is left, because the eye is told that it is in gas."""
    scene = SceneRenderer(smoky(_even(tau)), lights={"dome": WHITE})
    assert float(scene.radiance(AHEAD, 128).mean()) == pytest.approx(np.exp(-tau), rel=NOISE + 0.01 * tau)
    within = Camera(MIDDLE, MIDDLE - np.array([0.0, 1.0, 0.0]), 1.0, *SIZE)
    assert float(scene.radiance(within, 128).mean()) == pytest.approx(np.exp(-0.5 * tau), rel=NOISE)


def test_a_body_behind_gas_is_dimmed_by_the_analytic_factor_and_one_before_it_hides_it(smoky: Smoky) -> None:
    candidate = smoky(_even(1.0), plate=[0, 0.6, 0.5])
    drawn = PreviewRenderer(candidate)
    (layer,) = drawn._volumes
    behind, before = AHEAD, Camera(MIDDLE + np.array([0.0, 3.0, 0.0]), MIDDLE, 1.0, *SIZE)
    seen = drawn._cast_opaque(0, behind)
    assert (seen.ids >= 0).all()
    grey = np.full((*SIZE, 3), 0.5)
    day = drawn._daylight(0)
    assert layer.laid(grey, seen.depth, 0, behind, day)[0] == pytest.approx(0.5 * np.exp(-1.0), rel=2e-3)
    assert (layer.laid(grey, drawn._cast_opaque(0, before).depth, 0, before, day)[0] == grey).all()
    names = [drawn.entities[k] for k in (*np.unique(drawn.entity_ids(drawn.cast(0, behind))),)]
    assert names == ["smoke"], "it is thick"
    assert [drawn.entities[k] for k in np.unique(drawn.entity_ids(drawn.cast(0, before)))] == ["plate"]


def test_the_path_tracer_hides_gas_behind_a_body(smoky: Smoky) -> None:
    candidate = smoky(_even(3.0), plate=[0, 0.6, 0.5])
    scene = SceneRenderer(candidate, lights={"dome": WHITE})
    before = Camera(MIDDLE + np.array([0.0, 3.0, 0.0]), MIDDLE, 1.0, *SIZE)
    with_gas, normals = scene.radiance(before, 64), scene.features(before).normals
    scene.pose(0, "smoke")
    assert float(with_gas.mean()) == pytest.approx(float(scene.radiance(before, 64).mean()), rel=NOISE)
    assert np.allclose(normals, scene.features(before).normals)


def test_an_empty_box_changes_no_pixel(smoky: Smoky) -> None:
    candidate = smoky(np.zeros(CELLS), plate=[0, 0.6, 0.5])
    bare = dataclasses.replace(candidate, stage="static", caches={})
    camera = Camera(np.array([1.2, -2.0, 1.2]), MIDDLE, 40.0, 64, 36)
    assert (PreviewRenderer(candidate).preview(0, camera) == PreviewRenderer(bare).preview(0, camera)).all()
    shown, plain = (FrameRenderer(one, camera=camera).render(0, camera=camera, samples=2) for one in (candidate, bare))
    assert (shown == plain).all()


def test_a_lopsided_gas_lies_where_previews_and_the_path_tracer_both_say(smoky: Smoky) -> None:
    """The order and direction of all three axes."""
    soot = np.zeros(CELLS)
    soot[:3, :, :5] = _even(2.0)[:3, :, :5]
    soot[3:5, :2, 5:] = _even(2.0)[3:5, :2, 5:]
    candidate = smoky(soot)
    camera = Camera(MIDDLE + np.array([0.9, -1.6, 0.7]), MIDDLE, 22.0, 32, 32)
    scene = SceneRenderer(candidate, lights={"dome": WHITE})
    radiance = scene.radiance(camera, 256)[..., 1]
    (layer,) = PreviewRenderer(candidate)._volumes
    left = np.exp(-layer.depths(0, camera, np.tile(np.array([0.0, 1e9]), (32, 32, 1))))
    sky = np.abs(scene.features(camera).normals).sum(-1) == 0
    assert left.min() < 0.3
    assert sky.sum() > 300
    assert np.abs(radiance - left)[sky].mean() < 0.02
    assert np.abs(radiance[:, ::-1] - left)[sky].mean() > 0.06, "mirrored it would not fit"


def test_white_gas_takes_nothing_from_light_that_comes_from_all_sides(smoky: Smoky) -> None:
    """Law: conservation; in previews and in the path tracer alike, thin or thick."""
    white = np.ones(3)
    day = Daylight(np.array([0.0, 0.0, 1.0]), 0 * white, white, white, lambda points: np.ones(len(points)))
    sigma = np.random.default_rng(1).uniform(0, 60, CELLS).astype(np.float32)
    box = GasBox(sigma, np.full(CELLS, 300, np.float32), np.zeros(3), CELL, GasLook(8700.0, white))
    assert source_of(box, day) == pytest.approx(1.0, abs=1e-5)
    cloud = smoky(_even(2.0), color=(1.0, 1.0, 1.0))
    alone = dataclasses.replace(cloud, built={"smoke": cloud.built["smoke"]})
    scene = SceneRenderer(alone, lights={"dome": WHITE})
    assert float(scene.radiance(AHEAD, 64).mean()) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("way", [(0, 0, 1), (0, 0.6, 0.8), (-0.48, 0.36, 0.8), (0.8, 0, -0.6)])
def test_depth_towards_the_sun_is_that_of_the_way_out(way: tuple[float, float, float]) -> None:
    """In an even box, away from the sides through which a slanted ray enters."""
    sigma = np.full((20, 20, 20), 2.0, np.float32)
    towards = np.array(way, dtype=float)
    found = depth_towards(sigma, towards, CELL)
    centers = CELL * (np.stack(np.meshgrid(*[np.arange(20)] * 3, indexing="ij"), axis=-1) + 0.5)
    ways = np.full(centers.shape, np.inf)
    for k in np.flatnonzero(towards):
        ways[..., k] = ((1.0 if towards[k] > 0 else 0.0) - centers[..., k]) / towards[k]
    axis = int(np.abs(towards).argmax())
    out = ways[..., axis]
    inner = out + 5 * CELL < np.delete(ways, axis, axis=-1).min(-1)
    assert inner.sum() > 200
    assert found[inner] == pytest.approx(2.0 * out[inner], rel=SPREAD)


def test_sunlight_under_smoke_is_dimmed_and_by_white_steam_less(smoky: Smoky) -> None:
    points, sun = MIDDLE[None] - np.array([[0.0, 2.0, 0.0]]), np.array([0.0, 1.0, 0.0])
    assert GasLayer(smoky(_even(1.0)), ()).dimmed(0, points, sun) == pytest.approx(np.exp(-1.0), rel=2e-3)
    steam = look_of(Material(density=1.0, substance="water"))
    assert (steam.shading < 0.25).all()
    assert steam.extinction < 1000.0


def test_the_look_of_gas_is_that_of_its_material() -> None:
    plain = look_of(Material(density=1.0))
    assert plain.albedo == pytest.approx(SOOT_ALBEDO)
    shades = [look_of(Material(density=1.0, appearance=Appearance(color=(c, c, c)))).albedo[0] for c in (0.0, 0.2, 0.5, 0.9, 1.0)]
    assert shades == sorted(shades)
    assert shades[0] == pytest.approx(0.0, abs=1e-3)
    assert shades[-1] == pytest.approx(1.0, abs=2e-3)


def test_a_section_shows_gas_behind_its_plane_only(smoky: Smoky) -> None:
    candidate = smoky(_even(2.0))
    near, far = (section_view(candidate, 0, axis="y", at=at, width=300, height=240) for at in (-0.4, 0.4))
    assert (np.abs(near.astype(int) - far).max(-1) > 40).sum() > 200


def test_hot_gas_glows_and_the_more_the_hotter(smoky: Smoky) -> None:
    """Law: a thick black gas has the radiance of a black body; red light first."""
    camera = Camera(MIDDLE + np.array([0.0, -2.0, 0.3]), MIDDLE, 5.0, *SIZE)
    seen = []
    for kelvin in (300.0, 900.0, 1300.0):
        drawn = PreviewRenderer(smoky(_even(20.0), temperature=kelvin))
        (layer,) = drawn._volumes
        seen.append(layer.laid(np.zeros((*SIZE, 3)), np.full(SIZE, np.inf), 0, camera, drawn._daylight(0))[0].mean((0, 1)))
    cold, warm, hot = seen
    assert cold == pytest.approx(0.0, abs=0.01)
    assert (hot > warm).all()
    assert hot - cold == pytest.approx(glow(np.array([1300.0]))[0] / DAYLIGHT, rel=0.02)
    assert hot[0] > 3 * hot[1] > 9 * hot[2]


def test_the_path_tracer_shows_the_glow_and_its_light_on_what_stands_near(smoky: Smoky) -> None:
    """Law: a thin gas of depth tau and albedo 0 sends tau of a black body's radiance ahead; into the round, its volume times k J."""
    tau, kelvin = 0.1, 1300.0
    candidate = smoky(_even(tau), temperature=kelvin)
    dark = {"dome": {"type": "constant", "radiance": {"type": "rgb", "value": 0.0}}}
    scene = SceneRenderer(candidate, lights=dark)
    black = glow(np.array([kelvin]))[0]
    assert scene.radiance(AHEAD, 4).mean((0, 1)) == pytest.approx(black * (1 - np.exp(-tau)), rel=0.03)
    floor = Camera(np.array([0.0, -0.05, 0.2]), np.zeros(3), 4.0, *SIZE)
    cells = MIDDLE + CELL * (np.stack(np.meshgrid(*[np.arange(n) - 0.5 * (n - 1) for n in CELLS], indexing="ij"), axis=-1))
    irradiance = black * tau / THROUGH * CELL**3 * (cells[..., 2] / np.linalg.norm(cells, axis=-1) ** 3).sum()
    color = candidate.spec.materials["stone"].appearance.color
    seen = scene.radiance(floor, 64).mean((0, 1))
    assert seen == pytest.approx(irradiance * np.array(color) / np.pi, rel=0.15), "eight points stand for the box"
    cold = SceneRenderer(smoky(_even(tau)), lights=dark)
    assert float(cold.radiance(floor, 4).max()) == 0.0

"""Liquids in pictures: previews, ids, sections, path-traced frames; missing, stale and tampered surfaces."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.geometry.camera import Camera
from worldagent.rendering import highlight, id_view, preview, section_view
from worldagent.rendering.categories.balls import joined_balls
from worldagent.rendering.categories.liquid.meshes import liquids_of, look_of
from worldagent.rendering.glow import glow
from worldagent.rendering.preview import PreviewRenderer
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.rendering.tracer.surfaces import soft_normals
from worldagent.simulation.liquid.surface import mesh_surfaces
from worldagent.simulation.liquid.surface_mesh import closed_volume
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.spec import Material, WorldSpec

S = 0.05
DEPTH = 8 * S
ABOVE = Camera(np.array([0.0, 0.0, 3.0]), np.array([0.0, 0.0, 0.0]), 20.0, 32, 32)
ASIDE = Camera(np.array([0.3, -3.0, 1.4]), np.array([0.0, 0.0, 0.2]), 40.0, 160, 90)


def _thing(motion: str, material: str, size: tuple[float, ...], place: tuple[float, ...], **more: Any) -> dict[str, Any]:
    shape = {"kind": "box", "size": size}
    return {
        "role": "thing",
        "motion": motion,
        "material": material,
        "dimensions": {"size": size},
        "pose": {"position": place},
        "parts": {"body": {"shape": shape}},
        **more,
    }


def specification(water: dict[str, Any], floor: float = 0.8) -> WorldSpec:
    pool = (24 * S, 24 * S, DEPTH)
    liquid = {"category": "liquid", "resolution": S}
    return WorldSpec.model_validate(
        {
            "title": "Pool",
            "prompt": "A pool lies still.",
            "materials": {
                "white": {"density": 2000, "appearance": {"color": (floor,) * 3, "roughness": 1.0}},
                "glass": {"density": 2500, "appearance": {"color": (1, 1, 1), "transmission": 1.0, "roughness": 0.0}},
                "water": {"density": 1000, "substance": "water", **water},
            },
            "entities": {
                "floor": _thing("static", "white", (4, 4, 0.1), (0, 0, -0.05)),
                "pane": _thing("static", "glass", (1.2, 0.02, 0.6), (0, -0.62, 0.3)),
                "water": _thing("dynamic", "water", pool, (0, 0, DEPTH / 2), physics=liquid),
            },
            "simulation": {
                "fps": 24,
                "frames": 24,
                "solvers": {
                    "sea": {
                        "engine": "dfsph",
                        "members": ["water"],
                        "settings": {"domain": {"center": (0, 0, 0.5), "size": (1.2, 1.2, 1)}},
                    }
                },
            },
            "look": {"sky": "overcast"},
        }
    )


def particles() -> dict[str, Any]:
    axes = [(np.arange(n) + 0.5) * S for n in (24, 24, 8)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3) - [12 * S, 12 * S, 0]
    points = np.concatenate([points, [[0.0, 0.0, 0.9], [0.2, 0.1, 0.8]]])
    n = len(points)
    return {
        "origin": np.zeros(3),
        "particle/position": points.astype(np.float32),
        "particle/velocity": np.zeros((n, 3), dtype=np.float32),
        "particle/id": np.arange(n, dtype=np.int32),
        "particle/fluid": np.zeros(n, dtype=np.int32),
        "particle/volume": np.full(n, S**3, dtype=np.float32),
    }


def make(
    folder: Path, water: dict[str, Any] | None = None, *, stage: str = "full", surface: bool = True, floor: float = 0.8
) -> Candidate:
    spec = specification(water or {}, floor)
    built = {n: build_entity(spec, n, folder) for n in spec.entities}
    if stage == "static":
        return Candidate(folder, spec, built, "static")
    cache = Cache(folder / "sea")
    cache.folder.mkdir(parents=True)
    cache.write_index(CacheIndex("sea", "dfsph", 24, 1, ("water",), (), (), (), "", {}))
    cache.begin_digests([write_container(cache.path(0), particles())])
    if surface:
        mesh_surfaces(cache)
    return Candidate(folder, spec, built, "full", {"sea": cache})


@pytest.fixture(scope="module")
def pool(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return make(tmp_path_factory.mktemp("pool"))


def test_a_liquid_has_an_id_in_front_of_what_lies_behind_it_even_through_glass(pool: Candidate) -> None:
    drawn = PreviewRenderer(pool)
    seen = drawn.entity_ids(drawn.cast(0, ASIDE))
    names = np.array(drawn.entities)[seen[seen >= 0]]
    assert {"floor", "pane", "water"} == set(names)
    behind = drawn.mask(0, ASIDE, "pane") & drawn.mask(0, ASIDE, "water")
    assert behind.sum() > 100
    assert (seen[behind] == drawn.entities.index("water")).all()


def test_previews_show_water_over_the_ground_that_is_seen_through_it(pool: Candidate, tmp_path: Path) -> None:
    wet = PreviewRenderer(pool).mask(0, ASIDE, "water")
    inner = wet & np.roll(wet, 3, 0) & np.roll(wet, -3, 0) & np.roll(wet, 3, 1) & np.roll(wet, -3, 1)
    picture = preview(pool, 0, camera=ASIDE)[inner].astype(float)
    assert picture[:, 2].mean() > picture[:, 0].mean() + 8
    opaque = make(tmp_path, {"substance": "oil", "appearance": {"color": (0.02, 0.02, 0.02)}})
    assert preview(opaque, 0, camera=ASIDE)[inner].astype(float).mean() < 0.6 * picture.mean()
    assert id_view(pool, 0, camera=ASIDE).shape == (90, 160, 3)
    assert highlight(pool, 0, ["water"]).shape == (315, 560, 3)


def test_a_section_fills_the_water_that_it_cuts(pool: Candidate) -> None:
    cut, over = (section_view(pool, 0, at=at, width=300, height=200).astype(int) for at in (0.0, 3.0))
    assert (np.abs(cut - over).sum(-1) > 60).sum() > 1000


@pytest.mark.parametrize(("stage", "surface"), [("static", False), ("full", False), ("full", True)])
def test_every_stage_shows_as_much_water_as_there_is(tmp_path: Path, stage: str, surface: bool) -> None:
    """Declared volume before a simulation, particles before surfaces: all cover about the same pixels."""
    candidate = make(tmp_path, stage=stage, surface=surface)
    share = PreviewRenderer(candidate).mask(0, ABOVE, "water").mean()
    true = (24 * S / (2 * (3.0 - DEPTH) * np.tan(np.radians(10)))) ** 2
    assert share == pytest.approx(min(true, 1.0), abs=0.08)


def test_an_altered_surface_is_never_drawn(tmp_path: Path) -> None:
    candidate = make(tmp_path)
    path = candidate.caches["sea"].folder / "surface" / "frame_000000.npz"
    found = dict(liquids_of(candidate)[0].surface.read(0))  # type: ignore[union-attr]
    found["surface/vertices"] = found["surface/vertices"] * np.float32(1.1)
    write_container(path, found)
    with pytest.raises(EvidenceError, match="altered"):
        preview(candidate, 0, camera=ASIDE)


def test_spray_is_drawn_as_drops_of_its_volume(pool: Candidate) -> None:
    drawn = liquids_of(pool)[0].drawn(0)
    assert len(drawn.drops) == 8
    assert (4 / 3 * np.pi * drawn.drop_radius**3).sum() == pytest.approx(2 * S**3, rel=1e-6)
    vertices, faces = joined_balls(drawn.drops, drawn.drop_radius)
    assert closed_volume(vertices, faces) == pytest.approx(0.605 * 2 * S**3, rel=0.01)


def test_the_look_of_a_liquid_follows_its_material() -> None:
    plain = look_of(Material(density=1000, substance="water"))
    kept = look_of(Material.model_validate(Material(density=1000, substance="water").model_dump()))
    assert (kept.clear, kept.color) == (True, plain.color)
    assert plain.clear
    assert plain.absorption[0] > 5 * plain.absorption[2] > 0
    milk = look_of(Material(density=1030, substance="other", appearance={"color": (0.9, 0.9, 0.85)}))
    assert not milk.clear
    assert look_of(Material(density=2600, substance="lava")).glows


def test_lava_glows_red_first_and_not_below_seven_hundred_kelvin() -> None:
    cold, red, yellow = glow(np.array([600.0, 1100.0, 1500.0]))
    assert cold.max() == 0
    assert red[0] > 4 * red[1] > 8 * red[2] > 0
    assert yellow[1] / yellow[0] > 1.5 * red[1] / red[0]


def test_soft_normals_of_a_ball_point_outwards() -> None:
    vertices, faces = joined_balls(np.zeros((1, 3)), np.ones(1))
    np.testing.assert_allclose(soft_normals(vertices, faces), vertices, atol=1e-6)


def test_a_path_traced_pool_is_wet_in_the_variant_that_exists_everywhere(pool: Candidate) -> None:
    scene = SceneRenderer(pool)
    water, dry = scene.radiance(ASIDE, 4), SceneRenderer(make_dry(pool)).radiance(ASIDE, 4)
    inside = PreviewRenderer(pool).mask(0, ASIDE, "water")
    assert np.isfinite(water).all()
    assert np.abs(water - dry)[inside].mean() > 3 * np.abs(water - dry)[~inside].mean()


def make_dry(pool: Candidate) -> Candidate:
    built = {k: v for k, v in pool.built.items() if k != "water"}
    return Candidate(pool.folder, pool.spec, built, "static")


CHILD = """
import json, sys
sys.path.insert(0, {folder!r})
from pathlib import Path
import numpy as np
from test_liquid import ABOVE, DEPTH, make, make_dry
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.worlds.spec import Appearance
sun = {{"sun": {{"type": "directional", "direction": [0.0, 0.0, -1.0], "irradiance": {{"type": "rgb", "value": [1.0, 1.0, 1.0]}}}}}}
found = {{}}
for name, color in (("clear", (0.999, 0.999, 0.999)), ("tinted", (0.2, 0.5, 0.9))):
    look = {{"appearance": {{"color": color, "transmission": 1.0}}}}
    pool = make(Path({out!r}) / name, look, floor=0.05)
    found[name] = SceneRenderer(pool, lights=sun).radiance(ABOVE, 64)[12:20, 12:20].mean((0, 1)).tolist()
found["dry"] = SceneRenderer(make_dry(pool), lights=sun).radiance(ABOVE, 64)[12:20, 12:20].mean((0, 1)).tolist()
print(json.dumps(found))
"""


def test_light_reaches_the_ground_under_water_and_is_absorbed_along_its_way(tmp_path: Path) -> None:
    """Law: Beer-Lambert down and up; the face takes 2 % each way, and radiance that comes out is spread over n^2 the angle.

    Of what a floor of albedo 0.05 scatters, 1 - 1/n^2 is mirrored back, which adds 2 %.
    """
    command = CHILD.format(folder=str(Path(__file__).parent), out=str(tmp_path))
    environment = {k: v for k, v in os.environ.items() if k != "WORLDAGENT_MITSUBA_VARIANT"}
    ask = "from worldagent.rendering.tracer.variant import choose_variant; print(choose_variant().name)"
    name = subprocess.run([sys.executable, "-c", ask], env=environment, capture_output=True, text=True, check=True).stdout
    if name.strip().startswith("scalar"):
        pytest.skip("no vectorised variant of Mitsuba on this machine")
    done = subprocess.run([sys.executable, "-c", command], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    found = {k: np.array(v) for k, v in json.loads(done.stdout.splitlines()[-1]).items()}
    held = 1 - 1 / 1.333**2
    np.testing.assert_allclose(found["clear"], 0.98**2 / 1.333**2 / (1 - 0.05 * held) * found["dry"], rtol=0.03)
    way = 2 * DEPTH
    np.testing.assert_allclose(found["tinted"] / found["clear"], np.array([0.2, 0.5, 0.9]) ** way, rtol=0.04)


def test_lava_is_drawn_with_the_heat_of_its_surface_and_of_its_drops(tmp_path: Path) -> None:
    """Hot lava is brighter than cold, from its faces and from its drops, in a scene without any other light."""
    spec = specification({"substance": "lava", "density": 2700})
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    dark = {"none": {"type": "constant", "radiance": {"type": "rgb", "value": 1e-6}}}
    seen = []
    for kelvin in (600.0, 1400.0):
        cache = Cache(tmp_path / f"{kelvin:g}")
        cache.folder.mkdir()
        cache.write_index(CacheIndex("sea", "dfsph", 24, 1, ("water",), (), (), (), "", {}))
        data = particles()
        data["particle/temperature"] = np.full(len(data["particle/id"]), kelvin, dtype=np.float32)
        cache.begin_digests([write_container(cache.path(0), data)])
        mesh_surfaces(cache)
        candidate = Candidate(tmp_path, spec, built, "full", {"sea": cache})
        drawn = liquids_of(candidate)[0].drawn(0)
        assert drawn.drop_temperature is not None
        assert drawn.temperature is not None
        np.testing.assert_allclose([drawn.temperature.min(), drawn.drop_temperature.max()], kelvin, rtol=1e-3)
        seen.append(SceneRenderer(candidate, lights=dark).radiance(ABOVE, 4).mean())
    assert seen[1] > 1000 * seen[0]

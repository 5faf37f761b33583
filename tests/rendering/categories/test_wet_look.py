"""Solids that were wetted look darker where they were, and lighter again as their film dries."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering.categories.liquid.wet_look import Wetness, darkened, finely
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.rendering.tracer.surfaces import Surface
from worldagent.simulation.surfaces import map_wet_solids
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import Flow, lattice, liquid_world, water
from worldagent.worlds.arrays import F64
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import Appearance, Material

S = 0.05
DRYING = 0.2
"""[s] So that two frames of 1/24 s take a third of the film."""
COLOR = 0.5


def test_a_film_darkens_middling_colours_most() -> None:
    """A / (A + n^2 (1 - A)): black and white stay; one half becomes 0.361."""
    assert darkened([0.0, 0.5, 1.0]) == pytest.approx([0.0, 0.5 / (0.5 + 1.33**2 * 0.5), 1.0])


def test_only_chosen_triangles_are_cut_and_nothing_else_changes() -> None:
    positions = np.array([[0, 0, 0], [3, 0, 0], [3, 1, 0], [0, 1, 0]], dtype=float)
    uv = positions[:, :2] * 0.5
    surface = Surface(positions, np.tile([0.0, 0.0, 1.0], (4, 1)), uv, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))
    fine = finely(surface, np.array([True, False]), 0.3)
    corner = fine.positions[fine.faces]
    area = 0.5 * np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2]
    assert (area > 0).all()
    assert area.sum() == pytest.approx(3.0)
    assert (fine.faces[0] == [0, 2, 3]).all()
    edge = np.linalg.norm(np.roll(corner[1:], -1, axis=1) - corner[1:], axis=2)
    assert edge.max() <= 0.3
    assert fine.uv == pytest.approx(fine.positions[:, :2] * 0.5)


@pytest.fixture(scope="module")
def spilled(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """Water stands on a slab at frames 0 and 1, and then is far away."""
    size = (8 * S, 8 * S, 4 * S)
    slab = sw.box(1.6, 1.6, 0.1, at=(0, 0, -0.05)).model_copy(update={"material": "stone"})
    entities = {"slab": slab, "pool": water(size, (0, 0, size[2] / 2), S)}
    spec = liquid_world(entities, spacing=S, low=(-0.8, -0.8, -0.1), high=(60, 0.8, 1.0), frames=5)
    looks = {
        "stone": Material(density=2000, appearance=Appearance(color=(COLOR,) * 3, roughness=1.0)),
        "water": Material(density=1000, substance="water", appearance=Appearance(drying=DRYING)),
    }
    spec = spec.model_copy(update={"materials": {**spec.materials, **looks}})
    points = lattice((-4 * S, -4 * S, 0.0), size, S)
    position = [points if k < 2 else points + np.array([50.0, 0.0, 0.0]) for k in range(5)]
    flow = Flow(spec, position, [np.zeros_like(points)] * 5, [np.arange(len(points))] * 5, S**3, ("slab/body",))
    candidate = flow.candidate(tmp_path_factory.mktemp("spilled"))
    map_wet_solids(candidate.spec, candidate.built, candidate.caches)
    return candidate


def test_films_are_those_of_the_map_at_every_corner(spilled: Candidate) -> None:
    wetness = Wetness(spilled)
    assert wetness.entities() == {"slab"}
    film = wetness.film("water", 3)
    wet = film > 0
    assert film[wet] == pytest.approx(np.exp(-(2 / 24) / DRYING))
    places = wetness.maps["water"].texels.position[wet]
    assert np.abs(places[:, :2]).max() < 5.5 * S
    assert wetness.film("water", 0).max() < 0.2, "under a hand's breadth of clear water the slab shows dry"


def _shares(scene: SceneRenderer, frame: int) -> tuple[float, float]:
    """Radiance of the slab where water stood, and where it never was."""
    camera = Camera(np.array([0.0, -0.1, 2.5]), np.array([0.0, 0.0, 0.0]), 30.0, 32, 32)
    scene.pose(frame)
    picture: F64 = scene.radiance(camera, 64).mean(axis=2).astype(np.float64)
    return float(picture[13:19, 13:19].mean()), float(picture[3:6].mean())


def test_a_wet_place_is_darker_and_dries(spilled: Candidate) -> None:
    """The blend of film and dry look by exp(-t / drying), at frames 2 and 4."""
    scene = SceneRenderer(spilled, frame=2, lights={"dome": {"type": "constant"}})
    ratio = {}
    for frame in (2, 4):
        inner, outer = _shares(scene, frame)
        ratio[frame] = inner / outer
    film = {k: np.exp(-((k - 1) / 24) / DRYING) for k in ratio}
    wet = {k: (1.0 - ratio[k]) / film[k] for k in ratio}
    expected = 1.0 - float(darkened(COLOR)) / COLOR
    assert ratio[2] < ratio[4] < 1.0
    assert wet[2] == pytest.approx(expected, abs=0.08), "less what the film itself mirrors"
    assert wet[4] == pytest.approx(wet[2], abs=0.05)


def test_without_wet_maps_nothing_changes(spilled: Candidate, tmp_path: Path) -> None:
    bare = Wetness(sw.make_candidate(tmp_path, sw.world({"slab": sw.box(1, 1, 0.1, at=(0, 0, 0))}, frames=2)))
    assert (bare.maps, bare.entities()) == ({}, frozenset())

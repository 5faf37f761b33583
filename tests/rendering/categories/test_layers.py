"""Every category of matter that has a layer is seen in pictures, and what has none is said or refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.geometry.camera import Camera
from worldagent.rendering import PreviewRenderer, camera_for, id_view, plan_view
from worldagent.rendering.categories.deforming import DeformingLayer
from worldagent.rendering.categories.layer import LooseLayer, PartsLayer
from worldagent.rendering.categories.registry import LAYERS, category_of, layers_of
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.testing.worlds.by_category import SMALL_WORLDS, spec_of
from worldagent.testing.worlds.small_grains import sand_spec
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.registry import CATEGORIES
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import WorldSpec

SIZE = (96, 54)
BASES = {"solid": PartsLayer, "deforming": DeformingLayer, "loose": LooseLayer}


SMOKY = (6, 6, 8)
"""Cells of gas about the middle of its source."""


def gas_cache(folder: Path, spec: WorldSpec, name: str, soot: np.ndarray, temperature: float = 300.0) -> Cache:
    """One frame of the gas of an instance, with soot (nx, ny, nz) [kg/m^3] about its entity's place."""
    (member,) = spec.simulation.gas[name].members
    entity = spec.entities[member]
    cache = Cache(folder)
    cache.folder.mkdir(parents=True)
    cache.write_index(CacheIndex(name, "gas", 24, 1, (member,), (), (), (), "", {}))
    corner = np.array(entity.pose.position) - 0.5 * entity.physics.flow_cell * np.array(soot.shape)
    warm = np.full(soot.shape, temperature, np.float32)
    data = {"gas_soot": soot.astype(np.float32), "gas_temperature": warm, "gas_corner": corner}
    cache.begin_digests([write_container(cache.path(0), data)])
    return cache


def candidate_of(folder: Path, spec: WorldSpec) -> Candidate:
    """The world as it is built; particles and gas, which the static stage does not show, have one frame written by hand."""
    built = {name: build_entity(spec, name, folder) for name in spec.entities}
    caches = {}
    for name, instance in spec.simulation.particles.items():
        cache = Cache(folder / name)
        cache.folder.mkdir(parents=True)
        cache.write_index(CacheIndex(name, "dem", 24, 1, tuple(instance.members), (), (), (), "", {}))
        at = np.stack(np.meshgrid(*[np.linspace(-0.1, 0.1, 9)] * 2, [0.02, 0.05]), axis=-1).reshape(-1, 3)
        data = {
            "origin": np.zeros(3),
            "particle/position": at.astype(np.float32),
            "particle/radius": np.full(len(at), 0.012, dtype=np.float32),
            "particle/member": np.zeros(len(at), dtype=np.int32),
        }
        cache.begin_digests([write_container(cache.path(0), data)])
        caches[name] = cache
    caches |= {name: gas_cache(folder / name, spec, name, np.full(SMOKY, 5e-4)) for name in spec.simulation.gas}
    return Candidate(folder, spec, built, "full" if caches else "static", caches)


@pytest.mark.parametrize("name", LAYERS)
def test_a_preview_shows_every_category(name: str, tmp_path: Path) -> None:
    entity, make = SMALL_WORLDS[name]
    candidate = candidate_of(tmp_path, make())
    assert category_of(candidate.spec.entities[entity]) == name
    drawn = PreviewRenderer(candidate)
    assert type(layers_of(candidate).of[entity]) is LAYERS[name]
    camera = camera_for(candidate, 0, width=SIZE[0], height=SIZE[1])
    seen = drawn.mask(0, camera, entity)
    assert seen.sum() > 10, "would be seen if nothing stood before it"
    middle = candidate.vertices(entity, 0).mean(0)
    near = Camera(middle + np.array([0.3, -0.5, 1.0]), middle, 40.0, *SIZE)
    ids = drawn.entity_ids(drawn.cast(0, near))
    assert (ids == drawn.entities.index(entity)).sum() > 10
    picture = drawn.preview(0, near)
    assert picture.shape == (SIZE[1], SIZE[0], 3)
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 10


@pytest.mark.parametrize("name", LAYERS)
def test_a_layer_fits_the_shape_that_its_category_declares(name: str) -> None:
    assert issubclass(LAYERS[name], BASES[CATEGORIES[name].shape])


def test_what_has_no_layer_is_left_out_of_previews_with_a_note_and_refused_by_the_tracer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A source of smoke is no opaque box."""
    monkeypatch.delitem(LAYERS, "gas")
    data = sand_spec()
    size = [0.3, 0.3, 0.3]
    data["entities"]["smoke"] = {
        "role": "smoke",
        "motion": "dynamic",
        "physics": {"category": "gas", "resolution": 0.1},
        "dimensions": {"size": size},
        "material": "sand",
        "pose": {"position": [0, 0, 0.2]},
        "parts": {"source": {"shape": {"kind": "box", "size": size}}},
    }
    candidate = candidate_of(tmp_path, spec_of(data, "p"))
    layers = layers_of(candidate)
    assert layers.undrawn == {"smoke": "gas"}
    assert "smoke (gas)" in layers.note
    drawn = PreviewRenderer(candidate)
    assert "smoke" not in drawn.entities
    assert not drawn.mask(0, camera_for(candidate, 0, width=SIZE[0], height=SIZE[1]), "smoke").any()
    bare = data | {"entities": {k: v for k, v in data["entities"].items() if k != "smoke"}}
    without = candidate_of(tmp_path / "bare", spec_of(bare, "p"))
    camera = camera_for(without, 0, width=640, height=360)
    assert (drawn.cast(0, camera).ids == PreviewRenderer(without).cast(0, camera).ids).all()
    shown, plain = (id_view(one, 0, camera=camera) for one in (candidate, without))
    assert (shown != plain).any(), "the note"
    assert (plan_view(candidate) != plan_view(without)).any()
    with pytest.raises(InputError, match="'smoke' is of category 'gas'"):
        SceneRenderer(candidate)


def test_no_layer_is_drawn_for_an_entity_of_another_category(tmp_path: Path) -> None:
    candidate = candidate_of(tmp_path, spec_of(sand_spec(), "p"))
    layers = layers_of(candidate)
    assert set(layers.of) == set(candidate.spec.entities)
    for entity, layer in layers.of.items():
        assert type(layer) is LAYERS[category_of(candidate.spec.entities[entity])]
    layers.refuse_undrawn()

"""Wet maps: areas, depths and times of closed-form flows; resumed, altered and stale ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree
from worldagent.simulation.liquid.wet import WetPart, _spread, _tops
from worldagent.simulation.surfaces import map_wet_solids
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds.liquid_worlds import Flow, pool_in_tank
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.workflow.wetness import wetness
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.cache import read_container, write_container
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.derived import DERIVED
from worldagent.worlds.categories.liquid.wet import WetMap
from worldagent.worlds.errors import EvidenceError, RefusedError
from worldagent.worlds.predicates import WetArea

S = scenes.SPACING
SIZE = (0.4, 0.3, 0.16)


def still(frames: int = 4) -> Flow:
    return pool_in_tank(size=SIZE, spacing=S, wall=S / 2, frames=frames)


def made(candidate: Candidate) -> WetMap:
    return map_wet_solids(candidate.spec, candidate.built, candidate.caches)["water"]


def test_a_pool_wets_its_tank_up_to_its_level(tmp_path: Path) -> None:
    """The uppermost particles are half a spacing under the level and half a spacing off the wall, and wet places within one."""
    wet = made(still().candidate(tmp_path))
    state, texels = wet.state(3), wet.texels
    now = np.isfinite(state.depth)
    x, y, z = SIZE
    beyond = np.sqrt(1.0 - 0.25) * S - S / 2
    # Above the level on the walls, and under the walls on the slab that they stand on.
    walls = 2 * (x + y) * (z + 2 * beyond)
    assert texels.area[now].sum() == pytest.approx(x * y + walls, rel=0.01)
    assert texels.area.sum() > 2 * texels.area[now].sum(), "outer sides of walls half a spacing thin stay dry"
    assert (texels.normal[now][:, 2] >= -1e-6).all()
    expected = np.maximum(z - texels.position[now][:, 2], 0.0)
    assert state.depth[now] == pytest.approx(expected, abs=1e-6)
    assert (state.first[now] == 0.0).all()
    assert state.last[now] == pytest.approx(3 / 24)
    assert state.total[now] == pytest.approx(4 / 24)
    assert np.isnan(state.first[~now]).all()


def test_times_are_those_of_the_frames_and_films_fade_as_declared(tmp_path: Path) -> None:
    """Water is there at frames 2 and 3 only."""
    flow = still(frames=6)
    away = [p if k in (2, 3) else p + np.array([0.0, 0.0, 5.0]) for k, p in enumerate(flow.position)]
    wet = made(flow.edited(position=away).candidate(tmp_path))
    state = wet.state(5)
    ever = np.isfinite(state.last)
    assert ever.any()
    assert not np.isfinite(state.depth).any()
    assert (state.first[ever], state.last[ever], state.total[ever]) == tuple(
        pytest.approx(np.full(ever.sum(), t)) for t in (2 / 24, 3 / 24, 2 / 24)
    )
    film = state.film(5 / 24, np.array([0.1]))
    assert film[ever] == pytest.approx(np.exp(-(2 / 24) / 0.1))
    assert (film[~ever] == 0.0).all()
    assert np.isnan(wet.state(1).first).all(), "an earlier frame may be asked for after a later one"


def test_places_go_along_with_a_moving_body(tmp_path: Path) -> None:
    """A crate that floats keeps its places while it sinks, and more of them get wet."""
    wet = made(scenes.crate_afloat(np.random.default_rng(3), sinking=0.02).candidate(tmp_path))
    crate = wet.texels.of("crate")
    assert np.abs(wet.texels.position[crate]).max() <= scenes.CRATE / 2 + 1e-6
    counts = [np.isfinite(wet.state(k).depth[crate]).sum() for k in (0, 17)]
    assert 0 < counts[0] < counts[1]


def test_the_predicate_measures_the_same_area(tmp_path: Path) -> None:
    candidate = still().candidate(tmp_path)
    wet = made(candidate)
    mine = wet.texels.of("tank")
    area = wet.texels.area[mine][np.isfinite(wet.state(3).depth[mine])].sum()
    outcome = evaluate(candidate, WetArea(liquid="pool", entity="tank", min=0.0), (3, 3))
    assert outcome.value == pytest.approx(area, rel=0.03)


def test_maps_are_resumed_and_those_of_other_particles_are_noticed(tmp_path: Path) -> None:
    candidate = still().candidate(tmp_path)
    bare = cache_digest(candidate.caches)
    wet = made(candidate)
    whole = wet.digest()
    assert cache_digest(candidate.caches) != bare
    wet.files.begin_digests(wet.files.digests()[:2])
    assert made(candidate).digest() == whole
    held = read_container(wet.files.path(1))
    write_container(wet.files.path(1), {**held, "wet/depth": held["wet/depth"] + np.float32(1)})
    with pytest.raises(EvidenceError, match="wet map of 'water' at frame 1 was altered; bake again"):
        WetMap(wet.cache).read(1)
    assert made(candidate).digest() == whole
    cache = candidate.caches["water"]
    digests = cache.digests()
    digests[2] = write_container(cache.path(2), {**cache.read(2), "particle/velocity": cache.read(2)["particle/velocity"] + 1})
    cache.begin_digests(digests)
    with pytest.raises(EvidenceError, match="of other particles"):
        WetMap(cache).read(2)


def test_a_bundle_holds_them(tmp_path: Path) -> None:
    """Their inputs are digested with the caches, so a bundle without them would be one of another run."""
    candidate = still().candidate(tmp_path)
    folder = made(candidate).files.folder
    held = {path for made in DERIVED for path in made(candidate.caches["water"]).present()}
    assert set(folder.iterdir()) <= held
    assert len(held) == 4 + 4, "index, digests, note and places; a file per frame"


def test_what_was_wet_can_be_asked_for(tmp_path: Path) -> None:
    candidate = still().candidate(tmp_path)
    with pytest.raises(RefusedError, match="no wet maps; bake_sim"):
        wetness(candidate, "w", None, 3, limit=10, offset=0)
    made(candidate)
    told = wetness(candidate, "w", ["tank"], 3, limit=10, offset=0)
    (tank,) = told["solids"]
    assert tank["deepest_m"] == pytest.approx(SIZE[2], abs=0.01)
    assert tank["ever_wet_m2"] == tank["wet_now_m2"] == pytest.approx(tank["film_m2"])
    assert (tank["first_wet_s"], tank["last_wet_s"]) == (0.0, 0.125)


def test_water_in_a_narrow_glass_is_as_deep_everywhere_however_its_columns_lie() -> None:
    """Law: depth under a level. Columns cut by the wall held slivers, which called up to half of the floor of a glass shallow."""
    rng = np.random.default_rng(0)
    axes = [np.arange(-6, 7) * S, np.arange(-6, 7) * S, (np.arange(14) + 0.5) * S]
    stack = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    glass = stack[np.hypot(stack[:, 0], stack[:, 1]) < 3.7 * S]
    glass = glass + rng.normal(0, 0.1 * S, glass.shape)
    floor = glass[:, 2] < 0.7 * S
    for _ in range(20):
        tops = _tops(glass + np.append(rng.uniform(0, S, 2), 0.0), np.array([0.0, 0.0, 1.0]), S)[floor]
        assert (tops < 12.0 * S).mean() < 0.1


def test_places_on_slender_triangles_leave_no_gaps() -> None:
    """A log has long triangles along it: no place of its surface is farther than three texels from one of the map."""
    turn = np.linspace(0, 2 * np.pi, 65)[:-1]
    ring = 0.3 * np.column_stack([np.cos(turn), np.sin(turn)])
    ends = [np.column_stack([ring, np.full(64, z)]) for z in (0.0, 3.2)]
    k, after = np.arange(64), (np.arange(64) + 1) % 64
    faces = np.concatenate([np.column_stack([k, after, after + 64]), np.column_stack([k, after + 64, k + 64])])
    mesh = TriangleMesh(np.concatenate(ends), faces)
    texels, size = _spread([WetPart(("log", "body", "body"), mesh, lambda _: None, False)], [(np.zeros(3), np.ones(3))], 0.06)
    along = np.array([[0.3 * np.cos(a), 0.3 * np.sin(a), z] for a in turn[::4] for z in np.linspace(0, 3.2, 60)])
    assert cKDTree(texels["texel/position"]).query(along)[0].max() < 3 * size

"""Liquids as solver instances: one-way and two-way runs repeat, resume and replay by the byte, and their books close."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.probe import replay
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.runs import make_run
from worldagent.simulation.schedule import run_frames
from worldagent.simulation.surfaces import map_wet_solids, mesh_liquids, take_made
from worldagent.simulation.variants import run_variant, simulated
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.worlds.bake_plan import groups_of
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.cache import Cache, write_container
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.liquid.surface import LiquidSurface
from worldagent.worlds.channels import names_written
from worldagent.worlds.errors import EvidenceError, InputError
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec

FRAMES = 14
KILLED = 13
SMALL: dict[str, Any] = {"spacing": 0.04, "frames": FRAMES}


class Stopped(Exception):
    """Error that ends a run from outside."""


def build(**options: Any) -> tuple[WorldSpec, dict[str, BuiltEntity]]:
    spec = parse_spec({**tank_spec(**{**SMALL, **options}), "prompt": PROMPT})
    return spec, {n: build_entity(spec, n, Path()) for n in spec.entities}


@pytest.fixture(scope="module", params=[True, False], ids=["two-way", "one-way"])
def baked(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    spec, built = build(coupled=request.param)
    folder = tmp_path_factory.mktemp("baked")
    return Candidate(folder, spec, built, "full", run_frames(spec, built, folder / "a" / "bake", frames=FRAMES))


def test_surfaces_come_with_a_run_hold_its_volume_and_belong_to_its_digest(baked: Candidate, tmp_path: Path) -> None:
    cache = baked.caches["water"]
    surface = LiquidSurface(cache)
    assert surface.count() == FRAMES
    assert all(surface.records(frame)["surface_volume"] > 0 for frame in range(FRAMES))
    held, particles = surface.records(0), cache.read(0, ("particle/volume",))["particle/volume"]
    assert held["surface_volume"] + held["spray_volume"] == pytest.approx(float(particles.sum()), rel=0.02)
    copied = shutil.copytree(cache.folder, tmp_path / "water")
    assert cache_digest({"water": Cache(copied)}) == cache_digest({"water": cache})
    shutil.rmtree(copied / "surface")
    assert cache_digest({"water": Cache(copied)}) != cache_digest({"water": cache})


def test_a_killed_run_goes_on_to_the_same_bytes(baked: Candidate, tmp_path: Path) -> None:
    root = tmp_path / "a" / "bake"

    def check() -> None:
        if (root / "water" / f"frame_{KILLED:06d}.npz").exists():
            raise Stopped

    with pytest.raises(Stopped):
        run_frames(baked.spec, baked.built, root, frames=FRAMES, check=check)
    again = run_frames(baked.spec, baked.built, root, frames=FRAMES)
    for name, cache in baked.caches.items():
        assert again[name].digests() == cache.digests(), name
        assert again[name].index == cache.index


def _bare(baked: Candidate, folder: Path) -> dict[str, Cache]:
    """Copies of the caches without what was made of them."""
    leave = shutil.ignore_patterns("surface", "wet")
    return {n: Cache(shutil.copytree(c.folder, folder / n, ignore=leave)) for n, c in baked.caches.items()}


def _frames_made(baked: Candidate, caches: Mapping[str, Cache]) -> list[str]:
    """Progress texts of the surfaces and wet maps that had to be made; the end equals that of the first run."""
    told: list[str] = []
    for make in (mesh_liquids, map_wet_solids):
        make(baked.spec, baked.built, caches, progress=lambda done, total, text: told.append(text.split(": ")[1]))
    assert cache_digest(caches) == cache_digest(baked.caches)
    return told


def test_surfaces_and_wet_maps_of_the_same_frames_are_taken_and_not_made_again(baked: Candidate, tmp_path: Path) -> None:
    caches = _bare(baked, tmp_path)
    take_made(baked.spec, caches, baked.caches)
    assert _frames_made(baked, caches) == []


def test_a_whole_run_takes_them_too(baked: Candidate, tmp_path: Path) -> None:
    told: list[str] = []
    again = run_frames(
        baked.spec, baked.built, tmp_path, frames=FRAMES, progress=lambda *said: told.append(said[2]), earlier=baked.caches
    )
    assert cache_digest(again) == cache_digest(baked.caches)
    assert f"frame {FRAMES} of {FRAMES}" in " ".join(told)
    assert not [t for t in told if "surface" in t or "wet" in t]


def test_of_an_earlier_run_only_what_is_whole_is_taken(baked: Candidate, tmp_path: Path) -> None:
    """Altered bytes are found frame by frame, and all after them are made anew."""
    earlier = {n: Cache(shutil.copytree(c.folder, tmp_path / "earlier" / n)) for n, c in baked.caches.items()}
    surface = LiquidSurface(earlier["water"])
    found = surface.read(9) | {"spray/id": np.zeros(0, dtype=np.int32)}
    found["surface/vertices"] = found["surface/vertices"] + np.float32(0.01)
    write_container(surface.files.path(9), found)
    caches = _bare(baked, tmp_path / "later")
    take_made(baked.spec, caches, earlier)
    assert _frames_made(baked, caches) == [f"surface of frame {k + 1} of {FRAMES}" for k in range(9, FRAMES)]


@pytest.mark.parametrize("other", ["rigid", "water"])
def test_nothing_is_taken_of_another_motion(baked: Candidate, tmp_path: Path, other: str) -> None:
    """A crate elsewhere wets and holds the water otherwise, whatever the water itself does."""
    earlier = {n: Cache(shutil.copytree(c.folder, tmp_path / "earlier" / n)) for n, c in baked.caches.items()}
    digests = earlier[other].digests()
    earlier[other].begin_digests([*digests[:7], "0" * len(digests[7]), *digests[8:]])
    caches = _bare(baked, tmp_path / "later")
    take_made(baked.spec, caches, earlier)
    assert len(_frames_made(baked, caches)) == 2 * FRAMES


def test_intervals_replay_from_their_checkpoints_by_the_byte(baked: Candidate) -> None:
    results = replay(baked, intervals=2, seed=3)
    assert {r["solver"] for r in results} == {"rigid", "water"}
    assert all(r["identical"] for r in results), results


def test_the_cache_holds_what_was_promised(baked: Candidate) -> None:
    cache = baked.liquid_caches["water"]
    frame = cache.read(FRAMES - 1)
    assert set(frame) == names_written(frozenset({"liquid"}))
    assert cache.index.bodies == ("water",)
    assert cache.index.colliders == ("crate/body", "tank/body")
    count = len(frame["particle/id"])
    assert len(set(frame["particle/id"].tolist())) == count == frame["record/particles"]
    assert frame["particle/position"].dtype == np.float32
    assert frame["particle/volume"].sum() * 1000.0 == pytest.approx(float(frame["record/mass"]), rel=1e-5)
    start = float(cache.read(0)["record/mass"])
    assert float(frame["record/mass"] + frame["record/domain_outflow"]) == pytest.approx(start, rel=1e-6)
    assert frame["record/lost"] == 0


def _series(cache: Cache, name: str) -> Any:
    return np.array([cache.read(k, (name,))[name] for k in range(cache.index.frames)])


def test_action_equals_reaction_and_both_sides_are_counted_apart(baked: Candidate) -> None:
    """Law: what the liquid gave is what it lost; of two-way runs, also what MuJoCo integrated."""
    water = baked.liquid_caches["water"]
    given, lost = _series(water, "exchange/impulse"), _series(water, "exchange/reaction")
    scale = np.abs(given[..., :3]).max()
    assert scale > 0.1, "the water carries something"
    assert np.abs((given + lost).sum(axis=1)[:, :3]).max() < 1e-5 * scale
    rigid = baked.rigid_caches["rigid"]
    if not baked.spec.simulation.couplings:
        assert "exchange/impulse" not in rigid.read(0)
        return
    received = _series(rigid, "exchange/impulse")
    row = water.index.colliders.index("crate/body")
    assert np.abs(received[:, 0] - given[:, row]).max() < 1e-9 * scale
    weight = 0.12**3 * 500 * 9.81 / 24
    assert received[8:, 0, 2].mean() > 0.5 * weight, "the crate is carried"


def test_one_way_liquid_does_not_move_the_crate(tmp_path: Path) -> None:
    spec, built = build(coupled=False, frames=8)
    dry = parse_spec(tank_without_water(spec))
    with_water = run_frames(spec, built, tmp_path / "a" / "bake", frames=8)["rigid"].series("position")
    without = run_frames(dry, {n: b for n, b in built.items() if n != "water"}, tmp_path / "b" / "bake", frames=8)
    assert np.array_equal(with_water, without["rigid"].series("position"))


def tank_without_water(spec: WorldSpec) -> dict[str, Any]:
    document = spec.model_dump(mode="json", exclude_none=True)
    del document["entities"]["water"], document["simulation"]["solvers"]["water"]
    return document


def test_a_counterfactual_of_a_coupled_run_holds_the_crate_and_leaves_the_past(baked: Candidate) -> None:
    variant = run_variant(baked, Intervention(held=frozenset({"crate"}), since=5 / 24), start=5, end=8)
    height = variant.caches["rigid"].series("position")[:, 0, 2]
    assert np.ptp(height[5:]) < 1e-9
    assert np.array_equal(height[:6], baked.caches["rigid"].series("position")[:6, 0, 2])
    before, after = (variant.caches["water"].read(k, ("particle/position",))["particle/position"] for k in (5, 8))
    assert np.array_equal(before, baked.caches["water"].read(5, ("particle/position",))["particle/position"])
    untouched = baked.caches["water"].read(8, ("particle/position",))["particle/position"]
    assert after.shape != untouched.shape or not np.array_equal(after, untouched)


def test_a_liquid_that_nobody_asks_about_is_not_simulated_without_a_cause(tmp_path: Path) -> None:
    """It reads the crate, so that a held crate may change it; the crate's own fate is known without it."""
    spec, built = build(coupled=False)
    caches = run_frames(spec, built, tmp_path / "bake", frames=3)
    candidate = Candidate(folder=tmp_path, spec=spec, built=built, stage="full", caches=caches, digest=cache_digest(caches))
    told: list[str] = []
    done = Intervention(held=frozenset({"crate"}), since=0.0)
    variant = run_variant(candidate, done, start=0, end=2, progress=lambda _, __, text: told.append(text))
    variant.caches["rigid"].series("position")
    assert simulated(variant) == ("rigid",)
    variant.caches["water"].read(2)
    assert set(simulated(variant)) == {"rigid", "water"}
    assert told == [f"{name}: frame {k} of 2" for name in ("rigid", "water") for k in (1, 2)]


def test_held_water_neither_moves_nor_pushes(baked: Candidate) -> None:
    variant = run_variant(baked, Intervention(held=frozenset({"water"}), since=5 / 24), start=5, end=7)
    held = [variant.caches["water"].read(k)["particle/position"] for k in (5, 6, 7)]
    assert np.array_equal(held[1], held[0])
    assert np.array_equal(held[2], held[0])
    assert np.abs(variant.caches["water"].read(7)["exchange/impulse"]).max() == 0.0


def test_a_liquid_that_reads_bodies_needs_their_cache() -> None:
    spec, built = build(coupled=False)
    assert groups_of(spec) == [("rigid",), ("water",)]
    with pytest.raises(EvidenceError, match="bake it first"):
        make_run(spec, built, ("water",))


def test_a_liquid_cannot_be_let_through_a_solid(baked: Candidate) -> None:
    with pytest.raises(EvidenceError, match="cannot be let through"):
        run_variant(baked, Intervention(apart=frozenset({("crate", "water")})), start=0, end=2).caches["water"].read(1)


def test_frames_of_a_group_come_in_order(baked: Candidate) -> None:
    names = groups_of(baked.spec)[-1]
    run = make_run(baked.spec, baked.built, names, caches=baked.caches)
    run.prepare()
    with pytest.raises(InputError, match="the next frame is 1"):
        run.advance(2)


def test_solids_outside_the_domain_do_not_drop_a_liquid(tmp_path: Path) -> None:
    """A chair that moves outside the domain leaves the river's cache; moved into it, the river is simulated again."""
    spec, _ = build(coupled=False, crate_at=None, frames=4)
    chair = {**spec.entities["tank"].model_dump(mode="json", exclude_none=True), "role": "chair"}
    chair |= {"parts": {"body": {"shape": {"kind": "box", "size": [0.1, 0.1, 0.1]}}}, "dimensions": {"size": [0.1, 0.1, 0.1]}}
    spec = apply_patch(
        spec,
        [
            {"op": "add", "path": "/entities/chair", "value": {**chair, "pose": {"position": [2.0, 0, 0]}}},
            {"op": "add", "path": "/simulation/solvers/rigid/members/-", "value": "chair"},
        ],
    )
    caches: list[Mapping[str, Cache]] = []
    made: list[int] = []
    for number, x in enumerate((2.0, 2.5, 0.0)):
        moved = apply_patch(spec, [{"op": "replace", "path": "/entities/chair/pose/position", "value": [x, 0, 0.25]}])
        built = {n: build_entity(moved, n, Path()) for n in moved.entities}
        steps: list[str] = []
        root = tmp_path / str(number) / "bake"
        caches.append(run_frames(moved, built, root, frames=4, progress=lambda _, __, text, to=steps: to.append(text)))
        made.append(sum("water: frame" in s for s in steps))
    assert made == [4, 0, 4]
    assert caches[1]["water"].digests() == caches[0]["water"].digests()
    assert caches[2]["water"].index.settings != caches[0]["water"].index.settings

"""Trunks and boulders on a ground that is cut from a landscape: bodies bounce off them, and the ground is judged with them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.construction.stems import cut_stems
from worldagent.construction.store import build_world
from worldagent.construction.terrain.store import cut_patch
from worldagent.geometry.solids import Solid
from worldagent.rendering.land.planting import free_plants
from worldagent.simulation.rigid import SolverRigid
from worldagent.testing.defects._lands import NAME, keep
from worldagent.tests.physics.rigid_world import ball, world
from worldagent.verifiers.land.ground_stems import stem_gap
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.scene.interpenetration import check as interpenetration
from worldagent.verifiers.scene.scale import check as scale
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import InputError, LimitError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.landscape import SavedLandscape
from worldagent.worlds.spec import StemField, WorldSpec
from worldagent.worlds.spec.terrain import Terrain, Vegetation

SIZE, CENTER, BASE = (20.0, 16.0), (2.0, -1.0), 1.0
TERRAIN = Terrain(extent=(41.0, 41.0), cell=1.0, vegetation=Vegetation())
TREE, ROCK = (5.0, 0.0), (-4.0, 3.0)
PLANTS = [(*TREE, 10.0, "broad"), (*ROCK, 1.0, "rock"), (0.0, 4.0, 1.0, "bush"), (-14.0, 0.0, 10.0, "broad")]
"""The last one stands beside the ground."""


def _land(root: Path, plants: list[tuple[float, float, float, str]]) -> SavedLandscape:
    keep(root, TERRAIN, np.zeros((41, 41)), plants=plants)
    return SavedLandscape(next((root / "terrain").iterdir()))


def _world(
    folder: WorldFolder, land: SavedLandscape, bodies: Mapping[str, Any], *, stems: bool = True, seconds: float = 1.5
) -> WorldSpec:
    """Bodies over the ground that build_terrain would cut."""
    patch = cut_patch(folder, NAME, land, center=CENTER, size=SIZE, cells=20)
    cut = cut_stems(folder, NAME, land, center=CENTER, size=SIZE) if stems else None
    shape = {"kind": "heightfield", "size": list(SIZE), "file": patch.file, "digest": patch.digest, "base": BASE}
    parts: dict[str, Any] = {"land": {"shape": shape}}
    top = 0.0
    if cut is not None:
        parts["stems"] = {"shape": {"kind": "stems", "file": cut.file, "digest": cut.digest, "count": cut.number}}
        top = float(cut.high[2])
    ground = {
        "role": "ground",
        "motion": "static",
        "material": "m",
        "dimensions": {"size": [*SIZE, top + BASE]},
        "pose": {"position": [*CENTER, 0.0]},
        "parts": parts,
    }
    spec = world({"ground": ground, **bodies}, seconds=seconds, friction=0.0, restitution=0.8)
    return WorldSpec.model_validate({**spec.model_dump(mode="json"), "terrains": {NAME: TERRAIN.model_dump(mode="json")}})


@pytest.fixture
def place(tmp_path: Path) -> tuple[WorldFolder, SavedLandscape]:
    return WorldFolder(tmp_path), _land(tmp_path, PLANTS)


def _candidate(folder: WorldFolder, spec: WorldSpec) -> Candidate:
    return Candidate(folder.root, spec, build_world(folder, spec)[0], "static")


def _path(folder: WorldFolder, spec: WorldSpec, body: str) -> np.ndarray:
    built = {n: build_entity(spec, n, folder.assets) for n in spec.entities}
    solver = SolverRigid(spec, built, "main")
    solver.prepare()
    row = solver.index().bodies.index(f"{body}/body")
    found = [solver.frame_data()["position"][row].copy()]
    for frame in range(1, spec.simulation.frames):
        solver.advance(frame)
        found.append(solver.frame_data()["position"][row].copy())
    return np.array(found)


@pytest.mark.parametrize(("target", "radius"), [(TREE, 0.28), (ROCK, 0.75)])
def test_a_ball_bounces_off_a_trunk_and_a_boulder(
    place: tuple[WorldFolder, SavedLandscape], target: tuple[float, float], radius: float
) -> None:
    """It slides at 4 m/s without friction; without stems it passes."""
    folder, land = place
    x, y = target
    ahead = {"s": ball(0.3, at=(x - 2.0, y, 0.302), v=(4.0, 0.0, 0.0))}
    met = _path(folder, _world(folder, land, ahead), "s")
    assert met[:, 0].max() <= x - radius + 0.02
    assert met[:, 0].max() > x - radius - 0.45, "it reaches the surface"
    assert met[-1, 0] < x - 1.5, "and comes back"
    passed = _path(folder, _world(folder, land, ahead, stems=False), "s")
    assert passed[-1, 0] > x + 2.0


def test_the_ground_has_its_stems_as_a_part_of_its_size(place: tuple[WorldFolder, SavedLandscape]) -> None:
    folder, land = place
    spec = _world(folder, land, {})
    candidate = _candidate(folder, spec)
    land_part, stems = candidate.entity("ground").parts
    assert (land_part.part, stems.part) == ("land", "stems")
    assert [p.kind for p in stems.collision] == ["cylinder", "hull"], "neither the bush nor the tree beside the ground"
    solid = Solid.from_mesh(stems.render, closed=True)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(np.pi * 0.28**2 * 4.3 + 4 / 3 * np.pi * 0.75**2 * 0.65, rel=0.1)
    assert stems.deviation[0] == pytest.approx(0.28 * (1 - np.cos(np.pi / 32)))
    assert {r.status for r in scale(candidate) if r.id == "scale:ground"} == {"pass"}


def test_a_body_in_a_trunk_is_found(place: tuple[WorldFolder, SavedLandscape]) -> None:
    folder, land = place
    rows = {}
    for name, x in (("apart", TREE[0] - 0.6), ("inside", TREE[0] - 0.5)):
        spec = _world(folder, land, {"s": ball(0.3, at=(x, TREE[1], 1.0))})
        rows[name] = next(r for r in interpenetration(_candidate(folder, spec)) if r.id == "interpenetration:scene")
    assert rows["apart"].status == "pass"
    assert rows["inside"].status == "fail"


def test_stems_of_another_landscape_are_told_apart(place: tuple[WorldFolder, SavedLandscape]) -> None:
    folder, land = place
    candidate = _candidate(folder, _world(folder, land, {}))
    assert stem_gap(candidate, "ground", NAME, land) == pytest.approx(0.0, abs=1e-6)
    tree, rest = (*TREE, 10.0, "broad"), PLANTS[1:]
    for change, least in (
        ([(TREE[0] + 0.1, TREE[1], 10.0, "broad"), *rest], 0.099),
        ([(*TREE, 11.0, "broad"), *rest], 0.4),
        (rest, 4.0),
        ([tree, *rest, (7.0, 3.0, 8.0, "cone")], 3.0),
    ):
        gap = stem_gap(candidate, "ground", NAME, _land(folder.root, change))
        assert gap is not None
        assert gap > least, change
    bare = _candidate(folder, _world(folder, land, {}, stems=False))
    assert stem_gap(bare, "ground", NAME, land) is None


def test_a_file_of_stems_that_was_changed_is_refused(place: tuple[WorldFolder, SavedLandscape]) -> None:
    folder, land = place
    spec = _world(folder, land, {})
    file = next(folder.assets.glob("*-stems-*.npy"))
    whole = file.read_bytes()
    file.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    with pytest.raises(InputError, match=r"/entities/ground/parts/stems/shape: file 'land-stems-.*' has digest"):
        build_entity(spec, "ground", folder.assets)
    file.unlink()
    with pytest.raises(InputError, match="is missing"):
        build_entity(spec, "ground", folder.assets)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (np.zeros((2, 7)), "not positive"),
        (np.ones((2, 6)), "seven columns"),
        (np.full((2, 7), np.nan), "finite"),
        (np.ones((3, 7)), "holds 3, the specification says 2"),
    ],
)
def test_a_file_that_is_no_table_of_stems_is_refused(tmp_path: Path, table: np.ndarray, words: str) -> None:
    from worldagent.construction.stems import load_stems

    np.save(tmp_path / "a-stems-0.npy", table)
    digest = hashlib.sha256((tmp_path / "a-stems-0.npy").read_bytes()).hexdigest()
    with pytest.raises(InputError, match=words):
        load_stems(StemField(file="a-stems-0.npy", digest=digest, count=2), tmp_path)


def test_too_many_stems_are_refused_and_none_are_no_part(tmp_path: Path) -> None:
    folder = WorldFolder(tmp_path)
    x, y = np.meshgrid(np.linspace(-7, 7, 50), np.linspace(-7, 7, 41))
    many = _land(tmp_path, [(float(a), float(b), 10.0, "broad") for a, b in zip(x.ravel(), y.ravel(), strict=True)])
    with pytest.raises(LimitError, match=r"stems: estimated 2,050 trunks and boulders.*cap 2,000.*Knob: "):
        cut_stems(folder, NAME, many, center=(0.0, 0.0), size=(20.0, 20.0))
    few = cut_stems(folder, NAME, many, center=(0.0, 0.0), size=(4.0, 4.0))
    assert few is not None
    assert few.number == int(((np.abs(x) <= 2) & (np.abs(y) <= 2)).sum())
    assert cut_stems(folder, NAME, many, center=(14.0, 14.0), size=(10.0, 10.0)) is None


def test_what_bodies_bounce_off_is_drawn_and_told(place: tuple[WorldFolder, SavedLandscape]) -> None:
    """Nothing grows where a body stands, but a trunk that it bounces off."""
    folder, land = place
    near = {"s": ball(0.3, at=(TREE[0] - 0.5, 0.0, 0.302))}
    told = {}
    for stems in (False, True):
        candidate = _candidate(folder, _world(folder, land, near, stems=stems))
        assert (0 in free_plants(candidate, land)) == stems
        told[stems] = [a["what"] for a in approximations(candidate)]
    assert "plants of the landscape 'land' are drawn only" in told[False]
    assert any("within the ground 'ground' are solid" in line for line in told[True])
    assert "plants of the landscape 'land' are drawn only" not in told[True]


def test_a_wood_of_overlapping_trunks_has_a_definite_inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is proven: searching for its crossings would take a minute at 500 trunks."""
    folder = WorldFolder(tmp_path)
    land = _land(tmp_path, [(0.2 * k - 6.0, 0.0, 10.0, "broad") for k in range(60)])
    monkeypatch.setattr("worldagent.verifiers.scene.self_crossing.self_crossings", lambda *_, **__: pytest.fail("searched"))
    rows = {r.id: r.status for r in interpenetration(_candidate(folder, _world(folder, land, {})))}
    assert rows["interpenetration:scene"] == "pass"

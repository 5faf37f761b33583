"""The check `terrain` on a landscape that holds and on ones broken on purpose, one field at a time."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.store import build_world
from worldagent.construction.terrain.store import build_terrain_file, cut_patch
from worldagent.verifiers.land.terrain import check
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.landscape import SavedLandscape, save_landscape
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec

TERRAIN: dict[str, Any] = {
    "extent": [1200, 1200],
    "cell": 12,
    "datum": -40,
    "sea_level": 0,
    "layers": {
        "hill": {"kind": "cone", "radius": 540, "height": 260, "order": 1},
        "rough": {"kind": "noise", "style": "ridged", "amplitude": 30, "wavelength": 300, "order": 2},
        "crater": {"kind": "crater", "radius": 100, "depth": 50, "order": 3},
        "way": {"kind": "road", "line": [[-250, -300], [250, -280]], "width": 10, "order": 4},
    },
    "erosion": {"years": 10000, "steps": 3},
    "hydrology": {"required": ["sea", "lake", "river"], "density": 2},
    "climate": {"biome": "volcanic-island"},
    "vegetation": {"density": 1.0},
}


def _spec(**terrain: Any) -> WorldSpec:
    return WorldSpec.model_validate(
        {
            "title": "t",
            "prompt": "p",
            "materials": {"rock": {"density": 2600, "substance": "stone"}},
            "terrains": {"land": {**TERRAIN, **terrain}},
            "simulation": {"frames": 2},
        }
    )


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[WorldFolder, SavedLandscape]:
    folder = WorldFolder(tmp_path_factory.mktemp("w"))
    return folder, build_terrain_file(folder, _spec(), "land")[0]


def _rows(folder: WorldFolder, spec: WorldSpec) -> dict[str, Row]:
    entities, _ = build_world(folder, spec)
    return {r.id: r for r in check(Candidate(folder.root, spec, entities, "static"))}


def test_a_landscape_that_holds_passes_every_claim(built: tuple[WorldFolder, SavedLandscape]) -> None:
    rows = _rows(built[0], _spec())
    assert set(rows) == {f"terrain:land:{n}" for n in ("fill", "drainage", "water", "ledger", "plants", "tight")}
    assert {r.status for r in rows.values()} == {"pass"}
    assert all(r.measured is not None and r.measured <= (r.bound or 0) for r in rows.values())


Break = Callable[[dict[str, np.ndarray], dict[str, Any]], None]


def _dig(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["filled"][40, 40] -= 0.5


def _lift(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["ground"][a["lake"] == 1] += 1.0


def _turn(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["flow_direction"][30, 30] = {1: 16}.get(int(a["flow_direction"][30, 30]), 1)


def _circle(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    sea = np.argwhere(a["sea"].astype(bool))
    row, col = next((r, c) for r, c in sea if 1 < r < 98 and 1 < c < 97 and a["sea"][r, c + 1])
    a["flow_direction"][row, col], a["flow_direction"][row, col + 1] = 1, 16


def _spill(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["accumulation"][50, 50] += 144.0


def _tilt(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    about["lakes"][0]["level"] += 0.01


def _drain(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    about["lakes"][0]["volume"] *= 1.001


def _cut(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    longest = max(about["reaches"], key=lambda r: len(r["cells"]))
    del longest["cells"][len(longest["cells"]) // 2]
    del longest["cells"][len(longest["cells"]) // 2]


def _uphill(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    longest = max(about["reaches"], key=lambda r: len(r["cells"]))
    longest["cells"].reverse()


def _dry(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["wet"][a["lake"] == 1] = False


def _lose(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["deposit"][20:60, 20:60] *= 0.99


def _cook(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    about["figures"]["river_erosion"]["exported"] *= 1.0001


def _drown(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    row, col = np.argwhere(a["lake"] == 1)[0]
    a["plant_position"][0, :2] = (col - 49.5) * 12, (row - 49.5) * 12


def _float(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["plant_position"][3, 2] += 0.1


def _crowd(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["plant_position"][5] = a["plant_position"][6] + [0.05, 0, 0]


def _hole(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["height"][60:62, 30] = np.nan


def _pave(a: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    a["plant_position"][7, :2] = 0, -290


BROKEN: list[tuple[str, Break]] = [
    ("fill", _dig), ("water", _lift), ("drainage", _turn), ("drainage", _circle), ("drainage", _spill), ("water", _tilt), ("water", _drain),
    ("water", _cut), ("water", _uphill), ("water", _dry), ("ledger", _lose), ("ledger", _cook), ("plants", _drown), ("plants", _float),
    ("plants", _crowd), ("plants", _pave), ("tight", _hole),
]  # fmt: skip


@pytest.mark.parametrize(("claim", "change"), BROKEN, ids=[f"{c} {f.__name__}" for c, f in BROKEN])
def test_a_landscape_broken_on_purpose_fails_its_claim(
    claim: str, change: Break, built: tuple[WorldFolder, SavedLandscape], tmp_path: Path
) -> None:
    source = built[1]
    arrays = {n: source.raw(n).copy() for n in source.names}
    about = copy.deepcopy(source.about)
    change(arrays, about)
    save_landscape(tmp_path / "terrain" / source.path.name, arrays, about)
    row = _rows(WorldFolder(tmp_path), _spec())[f"terrain:land:{claim}"]
    assert row.status == "fail"
    assert row.corrections
    assert row.evidence["explanation"]


def test_a_landscape_of_another_specification_is_no_evidence(built: tuple[WorldFolder, SavedLandscape]) -> None:
    rows = _rows(built[0], _spec(seed=3))
    assert [r.status for r in rows.values()] == ["unverified"]
    assert "build_terrain" in rows["terrain:land"].evidence["explanation"]


def test_a_truncated_file_is_no_evidence(built: tuple[WorldFolder, SavedLandscape], tmp_path: Path) -> None:
    data = built[1].path.read_bytes()
    (tmp_path / "terrain").mkdir()
    (tmp_path / "terrain" / built[1].path.name).write_bytes(data[: len(data) // 2])
    assert [r.status for r in _rows(WorldFolder(tmp_path), _spec()).values()] == ["unverified"]


def _with_ground(folder: WorldFolder, land: SavedLandscape, position: tuple[float, float, float]) -> WorldSpec:
    patch = cut_patch(folder, "land", land, center=(60.0, -100.0), size=(200.0, 150.0), cells=64)
    entity = {
        "role": "ground",
        "motion": "static",
        "material": "rock",
        "dimensions": {"size": [200, 150, patch.high - patch.low + 1]},
        "pose": {"position": list(position)},
        "parts": {
            "land": {
                "shape": {"kind": "heightfield", "size": [200, 150], "file": patch.file, "digest": patch.digest, "base": 1.0}
            }
        },
    }
    return WorldSpec.model_validate({**_spec().model_dump(mode="json"), "entities": {"ground": entity}})


def test_the_ground_is_a_part_of_the_landscape(built: tuple[WorldFolder, SavedLandscape]) -> None:
    folder, land = built
    held = _rows(folder, _with_ground(folder, land, (60.0, -100.0, 0.0)))["terrain:land:ground:ground"]
    assert held.status == "pass"
    for moved in ((60.0, -100.0, 0.01), (61.0, -100.0, 0.0)):
        row = _rows(folder, _with_ground(folder, land, moved))["terrain:land:ground:ground"]
        assert row.status == "fail", moved


def _two_grounds(folder: WorldFolder, land: SavedLandscape, gap: float) -> WorldSpec:
    entities = {}
    for name, x in (("west", -50.0), ("east", 50.0 + gap)):
        patch = cut_patch(folder, "land", land, center=(x, 0.0), size=(100.0, 80.0), cells=32)
        shape = {"kind": "heightfield", "size": [100, 80], "file": patch.file, "digest": patch.digest, "base": 1.0}
        entities[name] = {
            "role": "ground",
            "motion": "static",
            "material": "rock",
            "dimensions": {"size": [100, 80, patch.high - patch.low + 1]},
            "pose": {"position": [x, 0.0, 0.0]},
            "parts": {"land": {"shape": shape}},
        }
    return WorldSpec.model_validate({**_spec().model_dump(mode="json"), "entities": entities})


@pytest.mark.parametrize(("gap", "status"), [(0.0, "pass"), (0.02, "fail"), (11.0, "fail"), (20.0, "pass")])
def test_grounds_that_adjoin_leave_no_gap(built: tuple[WorldFolder, SavedLandscape], gap: float, status: str) -> None:
    """Farther apart than a cell of the landscape they are two grounds."""
    folder, land = built
    row = _rows(folder, _two_grounds(folder, land, gap))["terrain:land:tight"]
    assert row.status == status
    if status == "fail":
        assert row.evidence["place"][0] == pytest.approx(0.5 * gap, abs=1e-6)


def test_a_ground_with_a_missing_triangle_is_open(built: tuple[WorldFolder, SavedLandscape]) -> None:
    folder, land = built
    spec = _two_grounds(folder, land, 0.0)
    entities, _ = build_world(folder, spec)
    whole = entities["west"].parts[0]
    torn = replace(whole, render=TriangleMesh(whole.render.vertices, np.delete(whole.render.faces, 100, axis=0)))
    entities = {**entities, "west": replace(entities["west"], parts=(torn,))}
    rows = {r.id: r for r in check(Candidate(folder.root, spec, entities, "static"))}
    assert rows["terrain:land:tight"].status == "fail"
    assert "'west' is open" in rows["terrain:land:tight"].evidence["explanation"]

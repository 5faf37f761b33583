"""Gas as files of volumes for other renderers."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import warp
from worldagent.testing.worlds.by_category import SMALL_WORLDS
from worldagent.tests.rendering.categories.test_layers import candidate_of, gas_cache
from worldagent.workflow.openvdb import ENV_PYTHON, Volume, python_with_openvdb, write_volumes
from worldagent.workflow.volumes import volume_files
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import InputError


def _smoky(folder: Path, soot: np.ndarray) -> Candidate:
    plain = candidate_of(folder / "plain", SMALL_WORLDS["gas"].make())
    name = next(iter(plain.spec.simulation.gas))
    return Candidate(folder, plain.spec, plain.built, "full", {name: gas_cache(folder / "gas", plain.spec, name, soot)})


def test_a_volume_reads_back_with_its_mass_where_the_cells_are(tmp_path: Path) -> None:
    """Law: mass; another reader than the one that wrote it tells where each value lies."""
    soot = np.random.default_rng(4).uniform(0, 1e-3, (9, 5, 12))
    candidate = _smoky(tmp_path, soot)
    files = volume_files(candidate, tmp_path / "out", [0])
    assert sorted(p.name for p in files) == ["smoke_soot_000000.nvdb", "smoke_temperature_000000.nvdb"]
    volume = warp.Volume.load_from_nvdb((tmp_path / "out" / "smoke_soot_000000.nvdb").read_bytes(), device="cpu")
    info = volume.get_grid_info()
    (cache,) = candidate.gas_caches.values()
    cell = candidate.spec.entities["smoke"].physics.flow_cell
    assert np.array(info.translation) == pytest.approx(cache.read(0, ("gas_corner",))["gas_corner"] + 0.5 * cell, abs=1e-6)
    assert volume.get_voxel_size() == pytest.approx((cell, cell, cell))
    raw = (tmp_path / "out" / "smoke_soot_000000.nvdb").read_bytes()
    assert soot[3, 2, 7].astype(np.float32).tobytes() in raw


def test_openvdb_is_refused_where_its_module_is_missing_and_gas_where_there_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setenv(ENV_PYTHON, sys.executable)  # which has none either
    with pytest.raises(InputError, match=f"openvdb.*{ENV_PYTHON}.*nvdb"):
        volume_files(_smoky(tmp_path, np.ones((2, 2, 2))), tmp_path / "out", [0], "vdb")
    with pytest.raises(InputError, match="no gas"):
        volume_files(candidate_of(tmp_path / "sand", SMALL_WORLDS["particles"].make()), tmp_path / "out", [0])
    assert not (tmp_path / "out").exists()


STAND_IN = """\
import json
class _Grid:
    def __init__(self, background=0.0):
        self.told = {"kind": type(self).__name__, "background": background}
    def copyFromArray(self, values):
        self.told |= {"shape": list(values.shape), "sum": float(values.sum())}
class FloatGrid(_Grid): pass
class Vec3SGrid(_Grid): pass
def createLinearTransform(matrix):
    return matrix
def write(path, grids):
    open(path, "w").write(json.dumps([{**g.told, "name": g.name, "transform": g.transform} for g in grids]))
"""


def test_another_python_writes_openvdb_and_its_failure_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stand-in for the module, in a Python of its own, says what it was asked to write."""
    (tmp_path / "pyopenvdb.py").write_text(STAND_IN)
    python = tmp_path / "python"
    python.write_text(f'#!/bin/sh\nPYTHONPATH={tmp_path} exec {sys.executable} "$@"\n')
    python.chmod(0o755)
    monkeypatch.setenv(ENV_PYTHON, str(python))
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    values = np.arange(24, dtype=np.float32).reshape(2, 3, 4) + 1
    files = [
        Volume(tmp_path / f"{k}.vdb", {"density": values, "glow": np.ones((2, 3, 4, 3), np.float32)}, np.ones(3), 0.5)
        for k in "ab"
    ]
    write_volumes(files)
    density, glow = json.loads(files[1].path.read_text())
    assert (density["kind"], density["background"], density["shape"], density["sum"]) == ("FloatGrid", 1.0, [2, 3, 4], 300.0)
    assert (glow["kind"], glow["name"], glow["transform"][3], glow["transform"][1]) == (
        "Vec3SGrid",
        "glow",
        [1, 1, 1, 1],
        [0, 0.5, 0, 0],
    )
    with pytest.raises(InputError, match="could not write"):
        write_volumes([Volume(tmp_path / "nowhere" / "a.vdb", {"density": values}, np.ones(3), 0.5)])


def test_the_real_module_writes_what_it_reads_back(tmp_path: Path) -> None:
    try:
        python = python_with_openvdb()
    except InputError:
        pytest.skip("no Python here has the module openvdb")
    values = np.zeros((3, 4, 5), np.float32)
    values[1, 2, 3] = 2.0
    write_volumes([Volume(tmp_path / "a.vdb", {"density": values}, np.array([1.0, 2.0, 3.0]), 0.25)])
    read = (
        "import importlib, importlib.util as u, sys\n"
        "vdb = importlib.import_module(next(filter(u.find_spec, ('openvdb', 'pyopenvdb'))))\n"
        "grid = vdb.read(sys.argv[1], 'density')\n"
        "print(grid.getAccessor().getValue((1, 2, 3)), grid.transform.indexToWorld((0, 0, 0)), grid.activeVoxelCount())"
    )
    told = subprocess.run([python, "-c", read, str(tmp_path / "a.vdb")], capture_output=True, text=True, check=True).stdout
    assert told.split()[0] == "2.0"
    assert "1.0, 2.0, 3.0" in told

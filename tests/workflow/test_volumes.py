"""Gas as files of volumes for other renderers."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import warp
from worldagent.testing.worlds.by_category import SMALL_WORLDS
from worldagent.tests.rendering.categories.test_layers import candidate_of, gas_cache
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
    with pytest.raises(InputError, match="openvdb"):
        volume_files(_smoky(tmp_path, np.ones((2, 2, 2))), tmp_path / "out", [0], "vdb")
    with pytest.raises(InputError, match="no gas"):
        volume_files(candidate_of(tmp_path / "sand", SMALL_WORLDS["particles"].make()), tmp_path / "out", [0])
    assert not (tmp_path / "out").exists()

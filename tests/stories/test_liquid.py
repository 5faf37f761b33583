"""A client declares a tank of water with a crate of half its density, probes it, and the crate floats at half its height."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.bake import run_bake
from worldagent.simulation.probe import replay
from worldagent.testing.worlds.small_liquids import CRATE, LINER, PROMPT, tank_spec
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.workflow import jobs
from worldagent.workflow.session import Session
from worldagent.workflow.work import Work
from worldagent.worlds.cache import write_container
from worldagent.worlds.candidate import Candidate, open_candidate
from worldagent.worlds.categories.liquid.surface import LiquidSurface
from worldagent.worlds.folder import WorldFolder

SPACING, DEPTH, FRAMES = 0.03, 0.15, 24
WATER: dict[str, Any] = {
    "spacing": SPACING,
    "depth": DEPTH,
    "frames": FRAMES,
    "closed": True,
    "crate_at": LINER + DEPTH + CRATE / 2,
}
KEPT = ("mass", "start", "identity", "records", "coupling", "energy", "density", "iterations")
"""Rows about the liquid that hold whatever its walls do."""


class Killed(Exception):
    """Error that ends a bake from outside."""


@pytest.fixture(scope="module")
def probed(agent_of: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[dict[str, Any], dict[str, str], Candidate]]:
    """The probe's reply, the statuses of the matrix, and the probe's caches."""
    workspace = tmp_path_factory.mktemp("liquid")
    with pytest.MonkeyPatch.context() as patch, agent_of(workspace) as agent:
        run_jobs_inline(patch)
        created = agent.call("edit_spec", world="w", prompt=PROMPT, spec=tank_spec(**WATER))
        assert created["audit"]["passed"]
        assert created["bake_order"] == ["rigid", "water"]
        assert agent.call("place_object", world="w")["static_passed"]
        told = agent.call("probe_sim", world="w")
        rows = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
        folder = WorldFolder.at(workspace / "w")
        yield told, rows, open_candidate(folder, _freeze(folder), "probe")


def _freeze(folder: WorldFolder) -> str:
    (made,) = (folder.root / "candidates").iterdir()
    return str(json.loads((made / "candidate.json").read_text())["freeze"])


def test_a_crate_of_half_the_density_floats_at_half_its_height(probed: Any) -> None:
    """Law: draft = density ratio times height; gate half a spacing. What the water gives, it loses, and MuJoCo receives."""
    told, rows, candidate = probed
    assert told["frames_probed"] == FRAMES
    judged = {n: rows[f"category:liquid:{n}:water"] for n in KEPT if f"category:liquid:{n}:water" in rows}
    assert len(judged) >= 4
    assert set(judged.values()) <= {"pass"}, judged
    rigid, water = candidate.rigid_caches["rigid"], candidate.liquid_caches["water"]
    height = rigid.series("position")[:, 0, 2]
    spread = 0.4 - 2 * LINER
    level = LINER + DEPTH + 0.5 * CRATE**3 / spread**2
    assert height[FRAMES // 2 :].mean() == pytest.approx(level, abs=0.5 * SPACING)
    received = rigid.series("exchange/impulse")[:, 0]
    crate = water.index.colliders.index("crate/body")
    given, lost = (np.array([water.read(k, (n,))[n] for k in range(FRAMES)]) for n in ("exchange/impulse", "exchange/reaction"))
    weight = 0.5 * 1000.0 * CRATE**3 * 9.81 / 24
    assert np.abs(received - given[:, crate]).max() < 1e-9 * weight
    assert np.abs((given + lost).sum(axis=1)[:, :3]).max() < 1e-4 * weight
    assert received[FRAMES // 2 :, 2].mean() == pytest.approx(weight, rel=0.1)


def test_a_killed_bake_goes_on_to_the_bytes_of_the_probe(probed: Any) -> None:
    """The bake runs the probe's settings: its frames are the probe's, killed in between or not."""
    _, _, candidate = probed
    folder = WorldFolder.at(candidate.folder)
    freeze = _freeze(folder)
    seen: list[str] = []

    def check() -> None:
        if len(seen) == 15:
            raise Killed

    with pytest.raises(Killed):
        run_bake(folder, freeze, progress=lambda _, __, text: seen.append(text), check=check)
    baked = run_bake(folder, freeze)
    for name, cache in baked.caches.items():
        assert cache.digests() == candidate.caches[name].digests(), name
    assert all(r["identical"] for r in replay(baked, intervals=1, seed=2))
    assert Path(baked.artifact).name == "bake"


def test_a_coarser_probe_runs_fewer_particles_and_gives_way_to_a_finer_one(agent_of: Any, tmp_path: Path) -> None:
    with pytest.MonkeyPatch.context() as patch, agent_of(tmp_path) as agent:
        run_jobs_inline(patch)
        agent.call("edit_spec", world="w", prompt=PROMPT, spec=tank_spec(**{**WATER, "frames": 14}))
        agent.call("place_object", world="w")
        counts = {}
        for coarser in (1.5, 1.0):
            told = agent.call("probe_sim", world="w", coarser=coarser)
            folder = WorldFolder.at(tmp_path / "w")
            candidate = open_candidate(folder, _freeze(folder), "probe")
            counts[coarser] = len(candidate.caches["water"].read(0)["particle/id"])
            resolution = candidate.spec.entities["water"].physics.resolution  # type: ignore[union-attr]
            assert resolution == pytest.approx(coarser * SPACING)
            assert told.get("overrides", {}) == ({"/entities/water/physics/resolution": resolution} if coarser > 1 else {})
            apart = told.get("not_carried_over", {"rows": []})["rows"]
            assert ("category:liquid:jumps:water" in apart) is (coarser > 1)
            assert "category:liquid:across:water" not in apart, "it is judged for the spacing of the world"
        assert 2.0 < counts[1.0] / counts[1.5] < 5.0
        assert "allowed" in agent.refused("probe_sim", world="w", coarser=3.0)


def test_a_surface_forged_in_the_probe_with_its_digest_does_not_reach_the_bake(probed: Any, tmp_path: Path) -> None:
    """The record of the probe has the digest of its surfaces; what differs from it, and a coarser probe, is not taken from."""
    _, _, candidate = probed
    session = Session.at(WorldFolder.at(Path(shutil.copytree(candidate.folder, tmp_path / "w"))))
    freeze = _freeze(session.folder)
    record = session.ledger.freeze(freeze)
    assert record is not None
    work, detail = Work(session, freeze, dict(candidate.built)), record["detail"]
    taken = jobs._same_probe(work, detail)
    assert taken is not None
    assert taken.digest == candidate.digest
    assert jobs._same_probe(work, {**detail, "overrides": {"/entities/water/physics/resolution": 2 * SPACING}}) is None
    surface = LiquidSurface(taken.caches["water"])
    found = dict(surface.read(FRAMES - 1))
    found["surface/vertices"] = found["surface/vertices"] + np.float32(0.1 * SPACING)
    digests = surface.files.digests()
    surface.files.begin_digests([*digests[:-1], write_container(surface.files.path(FRAMES - 1), found)])
    LiquidSurface(taken.caches["water"]).read(FRAMES - 1)  # by itself it passes for whole
    assert jobs._same_probe(work, detail) is None

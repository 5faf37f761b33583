"""A client declares a sea in which a crate floats; the crate bobs with the period of the waves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_liquids import sea_spec
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.worlds.candidate import open_candidate
from worldagent.worlds.folder import WorldFolder

PERIOD = 0.8
"""[s] of the waves of `sea_spec`."""


@pytest.mark.slow
def test_a_crate_bobs_in_declared_waves(agent_of: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The judge finds the declared sea where it leaves its zone; the crate's height has its period and half its height at least."""
    run_jobs_inline(monkeypatch)
    with agent_of(tmp_path) as agent:
        created = agent.call("edit_spec", world="w", prompt="A crate bobs in the waves of the sea.", spec=sea_spec())
        assert created["audit"]["passed"]
        assert agent.call("place_object", world="w")["static_passed"]
        agent.call("probe_sim", world="w")
        rows = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
    for name in ("waves_height", "waves_period", "energy", "momentum", "mass", "domain"):
        assert rows[f"category:liquid:{name}:water"] == "pass", name
    folder = WorldFolder.at(tmp_path / "w")
    (made,) = (folder.root / "candidates").iterdir()
    candidate = open_candidate(folder, str(json.loads((made / "candidate.json").read_text())["freeze"]), "probe")
    height = candidate.rigid_caches["rigid"].series("position")[:, 0, 2]
    fps = candidate.spec.simulation.fps
    late = height[-round(2 * PERIOD * fps) :]
    assert float(np.ptp(late)) > 0.5 * 0.07
    turn = np.exp(2j * np.pi * np.arange(len(late)) / (PERIOD * fps))
    share = 2.0 * abs(np.mean((late - late.mean()) * turn)) ** 2 / float(late.var())
    assert share > 0.7

"""A client tells of a jelly that falls, wobbles and is dented by a die, and the jelly of the skill is probed as it says."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from worldagent.server.skill_files import SKILLS
from worldagent.tests.stories.inline_jobs import run_jobs_inline


@pytest.mark.slow
def test_a_jelly_falls_and_is_dented(agent_of: Any, tmp_path: Path) -> None:
    spec = json.loads((SKILLS / "elastic-bodies" / "jelly.json").read_text())
    prompt = spec.pop("prompt")
    with pytest.MonkeyPatch.context() as patch, agent_of(tmp_path) as agent:
        run_jobs_inline(patch)
        assert agent.call("edit_spec", world="w", prompt=prompt, spec=spec)["audit"]["passed"]
        assert agent.call("place_object", world="w")["static_passed"]
        told = agent.call("probe_sim", world="w")
        rows = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
    assert told["passed"], told["open_rows"]
    judged = ("shape", "strain", "self", "volume", "step", "flight")
    assert {rows[f"category:elastic:{n}:jelly"] for n in judged} == {"pass"}
    assert {rows[f"category:elastic:{n}:rigid"] for n in ("energy", "solve", "records", "mass")} == {"pass"}
    assert {rows[f"beat:{n}"] for n in spec["story"]["beats"]} == {"pass"}
    touching = {i: status for i, status in rows.items() if i.startswith("contact:") and "jelly" in i}
    assert len(touching) == 2
    assert set(touching.values()) == {"pass"}

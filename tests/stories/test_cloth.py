"""The flag that the skill of cloth records, through the tools: it sinks, and a gust makes it flutter."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from worldagent.server.skill_files import SKILLS
from worldagent.tests.stories.inline_jobs import run_jobs_inline


@pytest.mark.slow
def test_the_flag_in_a_gust_is_accepted(agent_of: Any, tmp_path: Path) -> None:
    spec = json.loads((SKILLS / "cloth" / "flag.json").read_text())
    prompt = spec.pop("prompt")
    with pytest.MonkeyPatch.context() as patch, agent_of(tmp_path) as agent:
        run_jobs_inline(patch)
        assert agent.call("edit_spec", world="w", prompt=prompt, spec=spec)["audit"]["passed"]
        assert agent.call("place_object", world="w")["static_passed"]
        told = agent.call("probe_sim", world="w")
        assert told["passed"], told["open_rows"]
        rows = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
        assert {rows[f"beat:{n}"] for n in spec["story"]["beats"]} == {"pass"}
        assert {rows[f"category:cloth:{n}:sheets"] for n in ("stretch", "self", "solids", "pins", "momentum", "energy")} == {
            "pass"
        }
        assert agent.call("bake_sim", world="w")["passed"]
        assert agent.call("run_checks", world="w", scope="acceptance")["verdict"] == "accepted"

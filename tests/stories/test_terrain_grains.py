"""A client builds a landscape, lets gravel go on the wall of its crater, and probes the slide."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline

PROMPT = "Gravel slides down the wall of a crater."
CLAIMS = "[Gravel](thing gravel) [slides down](route slides) the [wall of a crater](thing land)."
FRAMES = 40
LAND = {
    "extent": [80, 80],
    "cell": 1,
    "layers": {"pit": {"kind": "crater", "radius": 20, "depth": 12, "floor": 0.3, "order": 1}},
}
AT = (12.0, 0.0)
"""[m] Where the gravel starts, on the wall."""


def _spec(height: float) -> dict[str, Any]:
    low, high = [-10, -6, height - 9], [AT[0] + 4, 6, height + 4]
    return {
        "title": "Gravel",
        "materials": {
            "stone": {"density": 2600, "substance": "stone", "friction": 0.6, "restitution": 0.3, "appearance": {"color": [0.4, 0.36, 0.3]}},
        },
        "entities": {
            "gravel": {
                "role": "gravel on the wall of the crater", "motion": "dynamic", "material": "stone",
                "dimensions": {"size": [1.6, 2.4, 1.2]}, "pose": {"position": [*AT, height + 1.6]},
                "physics": {"category": "particles", "radius": 0.13, "young_modulus": 4e8, "rolling": 0.1},
                "parts": {"volume": {"shape": {"kind": "box", "size": [1.6, 2.4, 1.2]}}},
            }
        },
        "terrains": {"land": LAND},
        "graph": {"regions": {"lower": {"kind": "box", "min": low, "max": [AT[0] - 2.5, 6, height]}, "around": {"kind": "box", "min": low, "max": high}}},
        "story": {
            "beats": {
                "slides": {"text": "the gravel slides down", "owner": "grains", "subject": "gravel", "frames": [0, FRAMES - 1],
                           "predicate": {"kind": "particle_count_in", "entity": "gravel", "region": "lower", "min": 20}}
            },
            "requirements": {"all": {"text": "no stone is lost", "predicate": {"kind": "particle_count_in", "entity": "gravel", "region": "around", "min": 140, "when": "always"}}},
        },
        "shots": {"only": {"frames": [0, FRAMES - 1], "covers": ["slides"],
                           "keys": {"a": {"frame": 0, "position": [2, -14, height + 5], "target": [7, 0, height - 3], "fov_deg": 50}}}},
        "simulation": {
            "frames": FRAMES, "fps": 24,
            "solvers": {
                "grains": {"engine": "dem", "members": ["gravel"], "settings": {"domain": {"center": [2, 0, height - 2], "size": [26, 14, 16]}}},
            },
        },
    }  # fmt: skip


@pytest.mark.slow
def test_gravel_slides_down_a_built_slope_and_none_is_lost(agent_of: Any, tmp_path: Any) -> None:
    with pytest.MonkeyPatch.context() as patch, agent_of(tmp_path) as agent:
        run_jobs_inline(patch)
        agent.call("edit_spec", world="w", prompt=PROMPT, spec=_spec(0.0), claims=CLAIMS)
        where = {"world": "w", "terrain": "land", "size": [30, 30], "center": [0, 0], "cells": 60, "wait_s": 120}
        assert agent.call("build_terrain", **where)["built"]
        places = agent.call("inspect_world", world="w", part="terrain", points=[list(AT), [AT[0] - 3, 0]])["places"]
        high, low = (p["height"] for p in places)
        assert high - low > 1.5
        fresh = _spec(high)
        patches = [
            {"op": "replace", "path": path, "value": value}
            for path, value in (
                ("/entities/gravel/pose", fresh["entities"]["gravel"]["pose"]),
                ("/graph/regions", fresh["graph"]["regions"]),
                ("/shots/only/keys", fresh["shots"]["only"]["keys"]),
                ("/simulation/solvers/grains/settings", fresh["simulation"]["solvers"]["grains"]["settings"]),
            )
        ]
        edited = agent.call("edit_spec", world="w", patch=patches, hypothesis="the gravel hangs at height 0; put it on the wall")
        assert edited["audit"]["passed"], edited["audit"]
        placed = agent.call("place_object", world="w")
        assert placed["static_passed"], placed
        agent.call("probe_sim", world="w")
        rows = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
    own = {n: s for n, s in rows.items() if n.endswith(":grains") or n.startswith(("requirement", "beat:"))}
    assert len(own) > 15
    assert {n: s for n, s in own.items() if s not in ("pass", "not_applicable")} == {}

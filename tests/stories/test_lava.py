"""A client lets hot lava creep down a turned trough, from the prompt to acceptance; it stays hot, glows and never gets below its bed."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline

TILT = 0.3
LAST = 47
PROMPT = "Glowing lava flows down a rocky slope and stays hot."
CLAIMS = "[Glowing lava](thing lava) [flows down](event flows) a [rocky](property slope) [slope](thing slope) and [stays hot](property hot)."


def _box(size: tuple[float, ...], at: tuple[float, ...]) -> dict[str, Any]:
    return {"shape": {"kind": "box", "size": list(size)}, "pose": {"position": list(at)}}


def _placed(along: float, above: float) -> dict[str, Any]:
    """Pose of something on the slope, along it and above its bed."""
    x, z = math.cos(TILT), math.sin(TILT)
    return {"position": [along * x + above * z, 0, above * x - along * z], "euler": [0, TILT, 0]}


def _beat(text: str, frames: tuple[int, int], predicate: dict[str, Any], *causes: str) -> dict[str, Any]:
    whose = {"owner": "lava", "subject": "lava", "predicate": {"entity": "lava", **predicate}}
    return {"text": text, "frames": list(frames), "causes": list(causes), **whose}


def lava_spec() -> dict[str, Any]:
    """The specification without its prompt."""
    trough = {"bed": _box((2.4, 1.0, 0.2), (0, 0, -0.1)), "left": _box((2.4, 0.2, 0.2), (0, 0.4, 0.1)), "right": _box((2.4, 0.2, 0.2), (0, -0.4, 0.1))}  # fmt: skip
    hot = {"viscosity": 60, "surface_tension": 0.35, "resolution": 0.04, "temperature": 1400, "conductivity": 1.5, "heat_capacity": 1200, "activation": 20000}  # fmt: skip
    passes = {
        "kind": "flows",
        "point": _placed(-0.5, 0.05)["position"],
        "normal": [math.cos(TILT), 0, -math.sin(TILT)],
        "radius": 0.4,
    }
    far = {"kind": "box", "min": [-0.3, -0.5, -1], "max": [1.5, 0.5, 1]}
    return {
        "title": "Lava",
        "materials": {
            "lava": {"density": 2600, "substance": "lava", "appearance": {"color": [0.05, 0.03, 0.02], "roughness": 0.8}},
            "rock": {"density": 2700, "substance": "stone", "friction": 0.6},
        },
        "entities": {
            "slope": {"role": "rocky slope with sides", "motion": "static", "material": "rock", "dimensions": {"size": [2.4, 1, 0.4]},
                      "pose": _placed(0, 0), "parts": trough},
            "lava": {"role": "lava", "motion": "dynamic", "material": "lava", "dimensions": {"size": [0.5, 0.6, 0.16]},
                     "pose": _placed(-0.85, 0.08), "parts": {"b": _box((0.5, 0.6, 0.16), (0, 0, 0))}, "physics": {"category": "liquid", **hot}},
        },
        "graph": {"regions": {"far": far}},
        "story": {"beats": {
            "flows": _beat("lava flows down the slope", (2, LAST), passes),
            "reaches": _beat("it reaches the lower half", (8, LAST), {"kind": "liquid_volume_in", "region": "far", "min": 0.002}, "flows"),
            "hot": _beat("it stays hot", (0, LAST), {"kind": "liquid_temperature", "measure": "mean", "min": 1300, "when": "always"}),
        }},
        "shots": {"wide": {"frames": [0, LAST], "covers": ["flows", "reaches", "hot"], "subjects": ["lava"],
                           "keys": {"k": {"frame": 0, "position": [0.8, -1.9, 1.5], "target": [-0.3, 0, 0.1]}}}},
        "simulation": {"fps": 24, "frames": LAST + 1, "solvers": {
            "rigid": {"engine": "mujoco", "members": ["slope"]},
            "lava": {"engine": "dfsph", "members": ["lava"],
                     "settings": {"domain": {"center": [0, 0, 0.2], "size": [2.8, 1.4, 1.8]}, "wall_friction": 1.0}},
        }},
    }  # fmt: skip


@pytest.mark.slow
def test_lava_creeps_down_a_slope_and_is_accepted(agent_of: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)
    with agent_of(tmp_path) as agent:
        assert agent.call("edit_spec", world="w", prompt=PROMPT, spec=lava_spec(), claims=CLAIMS)["audit"]["passed"]
        assert agent.call("place_object", world="w")["static_passed"]
        assert agent.call("probe_sim", world="w")["passed"]
        assert agent.call("bake_sim", world="w")["passed"]
        assert agent.call("run_checks", world="w", scope="acceptance")["verdict"] == "accepted"

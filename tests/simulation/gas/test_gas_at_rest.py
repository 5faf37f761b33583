"""Bodies that have moved in a gas and stand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_gas import DUST_PROMPT, dust_spec
from worldagent.worlds.spec import WorldSpec


def test_a_body_that_stops_in_the_air_leaves_the_gas_in_peace(tmp_path: Path) -> None:
    """Cells that it cuts to slivers while it moves stay so while it stands: no more leaves them than they hold, and steps stay long."""
    spec = dust_spec(frames=10)
    low = [0.013, 0.021, 0.287]
    high = [0.013, 0.021, 0.6]
    keys = {"a": {"time": 0.0, "pose": {"position": high}}, "b": {"time": 0.1, "pose": {"position": low}}}
    spec["entities"]["ball"] |= {"motion": "kinematic", "pose": {"position": high}}
    spec["simulation"]["drivers"] = {
        "leak": {"kind": "emission", "entity": "dust", "rate": 1e-6},
        "path": {"kind": "path", "entity": "ball", "keys": keys},
    }
    world = simulate(tmp_path, WorldSpec.model_validate({"prompt": DUST_PROMPT, **spec}))
    frames = [world.caches["air"].read(k) for k in range(1, 10)]
    assert max(float(f["record/steps"]) for f in frames) <= 12
    assert max(float(np.abs(f["gas_temperature"] - 293.15).max()) for f in frames) < 1.0

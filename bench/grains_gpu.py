"""Grain-steps per second on one device, and whether it gives the same bytes twice, as one JSON object.

    python -m worldagent.bench.grains_gpu [--grains 1000000] [--device cuda] [--settle 1500] [--steps 400]

Needs numpy, scipy and warp-lang only, and this package on the path.
"""

from __future__ import annotations

import argparse
import hashlib
import json
from typing import Any

import numpy as np

from ..geometry.launch import chosen_device
from ..simulation.particles.engine import Grains
from .grains import RADIUS, box_of_grains, measure

__all__ = ["apart_from_cpu", "same_twice"]

FALL = 1200, 2e-5
"""Steps, and seconds of each, after which the places of a GPU and of a CPU are compared: later, every rounding has its own history."""


def same_twice(grains: int, device: str, steps: int = 200) -> bool:
    """True if two runs from the same start, the second over a checkpoint in its middle, give the same bytes."""
    digests = []
    for middle in (False, True):
        setup, still = box_of_grains(grains, chosen_device(device))
        engine = Grains(setup)
        dt = engine.stable_dt()
        engine.step(steps // 2 * dt, still)
        state = engine.checkpoint()
        if middle:
            engine = Grains(setup)
        engine.restore(state)
        engine.step(steps // 2 * dt, still)
        digests.append(hashlib.sha256(engine.checkpoint()).hexdigest())
    return digests[0] == digests[1]


def apart_from_cpu(grains: int, device: str) -> float:
    """Greatest distance between the places of the same grains on a device and on the CPU, in radii, while they begin to settle."""
    places = []
    for where in ("cpu", chosen_device(device)):
        setup, still = box_of_grains(grains, where)
        engine = Grains(setup)
        steps, seconds = FALL
        engine.step(steps * seconds, still)
        c = engine.columns()
        places.append(c["position"][np.argsort(c["identity"])])
    return float(np.linalg.norm(places[0] - places[1], axis=1).max() / RADIUS)


def _main() -> dict[str, Any]:
    parser = argparse.ArgumentParser()
    parser.add_argument("--grains", type=int, default=1_000_000)
    parser.add_argument("--device", default="cuda")
    parser.add_argument("--settle", type=int, default=1500)
    parser.add_argument("--steps", type=int, default=400)
    given = parser.parse_args()
    found = measure(given.grains, given.device, settle=given.settle, steps=given.steps)
    return {
        **found,
        "same_bytes_twice": same_twice(min(given.grains, 50_000), given.device),
        "radii_from_cpu": apart_from_cpu(min(given.grains, 3000), given.device),
    }


if __name__ == "__main__":
    print(json.dumps(_main(), indent=1))

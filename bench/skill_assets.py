"""Does the table of turns in `assets` help? Furniture with its back to a wall, turned by the skill and as an entity whose front is its +x.

The figure is the share of things whose drawers slide away from the wall, into the room.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..construction.assets.documents import asset_documents
from ..construction.assets.registry import make
from ..worlds.arrays import RigidPose, euler_to_quaternion

__all__ = ["FRONT_X", "measure", "opens_into_the_room"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "assets"
FRONT_X: Mapping[str, float] = {"-x": 0, "-y": 90, "+x": 180, "+y": -90}
"""Turn [deg] by the wall of what has its front at +x, as entities have that no generator made."""
ROOM: Mapping[str, tuple[float, float]] = {"-x": (1, 0), "+x": (-1, 0), "-y": (0, 1), "+y": (0, -1)}
"""Direction from each wall into the room."""
ALONG = 0.99
"""Cosine between the way of a drawer and the direction into the room."""


def opens_into_the_room(generator: str, seed: int, wall: str, yaw_deg: float) -> bool:
    """True where all drawers of a thing at a wall, turned by `yaw_deg` about z, slide away from that wall."""
    pose = RigidPose(np.zeros(3), euler_to_quaternion((0.0, 0.0, math.radians(yaw_deg))))
    record = {"generator": generator, "parameters": {}, "seed": seed, "positions": {}}
    documents = asset_documents("thing", record, make(generator, {}, seed), pose, motion="dynamic")
    slides = [j for j in documents.joints.values() if j["kind"] == "slide"]
    ways = [np.array(j["axis"]) * np.sign(sum(j["range"])) for j in slides]
    return bool(slides) and all(float(w[:2] @ ROOM[wall]) > ALONG for w in ways)


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Things at walls, and how many open into the room per arm."""
    turns = {"with": json.loads((SKILL / "placing.json").read_text())["yaw_deg"], "without": FRONT_X}
    things, right = 0, dict.fromkeys(turns, 0)
    for seed in seeds:
        for name, case in json.loads((SKILL / "evals" / "cases.json").read_text()).items():
            for wall in ROOM:
                things += 1
                for arm, yaw in turns.items():
                    right[arm] += opens_into_the_room(case["generator"], seed, wall, yaw[wall])
            print(f"{name} {seed}: {right}", file=sys.stderr)
    return {"things": things, **{f"right_{arm}": n for arm, n in right.items()}}

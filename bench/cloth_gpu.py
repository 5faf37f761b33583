"""Time of a frame of cloth on one device, hung and crumpled with self-collision, as one JSON object.

    python -m worldagent.bench.cloth_gpu [--side 100] [--frames 4] [--crumple 12] [--device cuda]

`--side` squared is the number of vertices. Needs numpy, scipy, pydantic and warp-lang only, and this package on the path.
"""

from __future__ import annotations

import argparse
import json

from ..geometry.launch import chosen_device
from .cloth import ours

__all__ = ["run"]


def run(side: int = 100, frames: int = 4, crumple: int = 12, device: str = "cuda") -> dict[str, object]:
    """Figures of `cloth.ours` on a device."""
    return {**ours(side, device=chosen_device(device), frames=frames, crumple=crumple), "device": device}


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--side", type=int, default=100)
    parser.add_argument("--frames", type=int, default=4)
    parser.add_argument("--crumple", type=int, default=12)
    parser.add_argument("--device", default="cuda")
    told = parser.parse_args()
    print(json.dumps(run(told.side, told.frames, told.crumple, told.device)))

"""Time of a frame of cloth on one device, hung and crumpled with self-collision, as one JSON object.

    python -m worldagent.bench.cloth_gpu [--side 100] [--frames 4] [--crumple 12] [--device cuda] [--newton]

`--side` squared is the number of vertices. Needs numpy, scipy, numba, PyYAML, pydantic and warp-lang only, and this package on the path. `--newton` runs
Newton's VBD on the device as well, frames captured as graphs, with more and more iterations until the hung strip errs by no more than
`cloth.ALLOWED`; its Python is the one that `$WORLDAGENT_NEWTON_PYTHON` names.
"""

from __future__ import annotations

import argparse
import json

from ..geometry.launch import chosen_device
from .cloth import newton_setting, ours

__all__ = ["run"]


NEWTON = ((10, 40), (20, 100), (40, 200), (60, 200), (100, 200))
"""Sub-steps and iterations, from cheap to dear."""


def run(side: int = 100, frames: int = 4, crumple: int = 12, device: str = "cuda", *, newton: bool = False) -> dict[str, object]:
    """Figures of `cloth.ours` on a device, beside Newton's where asked for."""
    found = {**ours(side, device=chosen_device(device), frames=frames, crumple=crumple), "device": device}
    if newton:
        found["newton"] = peer = newton_setting(NEWTON, side, device=device)
        if "ms_per_frame" in peer:
            found["ratio_vs_newton"] = round(found["ms_per_frame"] / peer["ms_per_frame"], 4)
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--side", type=int, default=100)
    parser.add_argument("--frames", type=int, default=4)
    parser.add_argument("--crumple", type=int, default=12)
    parser.add_argument("--device", default="cuda")
    parser.add_argument("--newton", action="store_true")
    told = parser.parse_args()
    print(json.dumps(run(told.side, told.frames, told.crumple, told.device, newton=told.newton)))

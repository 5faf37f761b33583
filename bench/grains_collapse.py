"""Columns of grains that collapse and heaps that drain, against measured run-outs and slopes: a line of JSON each.

    python -m worldagent.bench.grains_collapse [--case round planar repose slopes] [--across 25] [--aspects 0.5 1 2 4] [--flat]
        [--device cuda]

Needs numpy, scipy and warp-lang only, and this package on the path. `grain_columns.py` and `grain_heaps.py` name the sources.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from typing import Any

from ..geometry.launch import chosen_device
from .grain_columns import collapse, planar_column, round_column
from .grain_heaps import SLOPES, drain, heap
from .grain_scenes import SAND


def _main() -> list[dict[str, Any]]:
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "--case", nargs="+", default=["round", "planar", "repose"], choices=["round", "planar", "repose", "slopes"]
    )
    parser.add_argument("--across", type=float, nargs="+", default=[25.0])
    parser.add_argument("--aspects", type=float, nargs="+", default=[0.5, 1.0, 2.0, 4.0])
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--flat", action="store_true", help="a flat floor in place of a rough one")
    parser.add_argument("--friction", type=float, default=SAND.friction)
    parser.add_argument("--rolling", type=float, default=SAND.rolling)
    given = parser.parse_args()
    kind = replace(SAND, friction=given.friction, rolling=given.rolling)
    made = {"round": round_column, "planar": planar_column}
    found = []
    for diameter in (0.01, 0.005, 0.002) if "repose" in given.case else ():
        found.append(drain(heap(diameter, chosen_device(given.device))))
        print(json.dumps(found[-1]), flush=True)
    for friction, rolling in SLOPES if "slopes" in given.case else ():
        kind = replace(SAND, friction=friction, rolling=rolling, young=2e6)
        found.append(drain(heap(0.01, chosen_device(given.device), sand=kind, thick=8.0)))
        print(json.dumps(found[-1]), flush=True)
    for case in (c for c in given.case if c in made):
        for across in given.across:
            for aspect in given.aspects:
                column = made[case](across, aspect, chosen_device(given.device), kind=kind, rough=not given.flat)
                found.append(collapse(column))
                print(json.dumps(found[-1]), flush=True)
    return found


if __name__ == "__main__":
    _main()

"""Columns of grains that collapse and heaps that drain, against measured run-outs and slopes: a line of JSON each.

    python -m worldagent.bench.grains_collapse [--case round planar repose slopes] [--across 25] [--aspects 0.5 1 2 3 4 6 8] [--flat]
        [--thick 12] [--sides 0.3] [--young 5e6] [--device cuda]

The last lines tell the exponents of run-outs over aspect; columns of aspect 2 to 8 take an H200 some minutes, a CPU hours.

Needs numpy, scipy and warp-lang only, and this package on the path. `grain_columns.py` and `grain_heaps.py` name the sources.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from ..geometry.launch import chosen_device
from .grain_columns import GLASS_SIDES, NARROW, Column, collapse, exponents, planar_column, round_column
from .grain_heaps import SLOPES, drain, heap
from .grain_scenes import SAND


def _main() -> list[dict[str, Any]]:
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "--case", nargs="+", default=["round", "planar", "repose"], choices=["round", "planar", "repose", "slopes"]
    )
    parser.add_argument("--across", type=float, nargs="+", default=[25.0])
    parser.add_argument("--aspects", type=float, nargs="+", default=[0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0])
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--flat", action="store_true", help="a flat floor in place of a rough one")
    parser.add_argument("--friction", type=float, default=SAND.friction)
    parser.add_argument("--rolling", type=float, default=SAND.rolling)
    parser.add_argument("--young", type=float, default=5e6, help="of the grains of columns [Pa]")
    parser.add_argument("--thick", type=float, default=NARROW, help="diameters between the walls of the channel")
    parser.add_argument("--sides", type=float, default=GLASS_SIDES, help="friction of those walls")
    given = parser.parse_args()
    kind = replace(SAND, friction=given.friction, rolling=given.rolling)
    made: dict[str, Callable[..., Column]] = {
        "round": round_column,
        "planar": partial(planar_column, thick=given.thick, sides=given.sides),
    }
    sand = replace(kind, young=given.young)
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
                column = made[case](across, aspect, chosen_device(given.device), kind=sand, rough=not given.flat)
                found.append(collapse(column))
                print(json.dumps(found[-1]), flush=True)
    for line in exponents(found):
        print(json.dumps(line), flush=True)
    return found


if __name__ == "__main__":
    _main()

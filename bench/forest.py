"""Benchmark `forest`: what a hundred thousand trees cost the checks, of which only one needs them, and a walk through them."""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..testing.defects._lands import NAME, axes, declared, keep
from ..testing.worlds.small_worlds import ball, box, make_candidate, world
from ..verifiers.checks import run_checks
from ..worlds.spec import BoxRegion, Connects

__all__ = ["run"]

SIDE, CELL = 1024, 4.0
INSTANCES = 100_000
ROUNDS = 5
SPATIAL = ("scale", "interpenetration", "relations", "support")
"""Checks that have nothing to do with plants."""


def run(*, instances: int = INSTANCES, rounds: int = ROUNDS) -> dict[str, Any]:
    """Seconds of the static checks with and without the forest, and of one search for a way through it."""
    with tempfile.TemporaryDirectory() as root:
        bare, grown = (_world(Path(root) / name, count) for name, count in (("bare", 0), ("grown", instances)))
        spent: dict[str, list[float]] = {"without": [], "with": [], "way_without": [], "way_with": []}
        for turn in range(rounds + 1):
            for name, build in (("without", bare), ("with", grown)):
                for key, checks in ((name, SPATIAL), (f"way_{name}", ("navigability",))):
                    candidate = build()
                    start = time.perf_counter()
                    rows = run_checks(candidate, only=checks)
                    if turn:  # the first round compiles and reads
                        spent[key].append(time.perf_counter() - start)
                    wrong = [r.id for r in rows if r.status not in ("pass", "not_applicable")]
                    if wrong:
                        raise RuntimeError(f"rows of the benchmark's own world do not pass: {wrong}")
            print(f"round {turn} of {rounds}", file=sys.stderr, flush=True)
    middle = {k: statistics.median(v) for k, v in spent.items()}
    return {
        "instances": instances,
        "cells": SIDE * SIDE,
        "checks_without_s": round(middle["without"], 4),
        "checks_with_s": round(middle["with"], 4),
        "ratio": round(middle["with"] / middle["without"], 3),
        "way_without_s": round(middle["way_without"], 3),
        "way_with_s": round(middle["way_with"], 3),
    }


def _world(folder: Path, instances: int) -> Any:
    """A function that opens the world anew: hills of 4 x 4 km, a house, a tower, a ball and a walker's way of 3 km."""
    x, y = axes(SIDE, SIDE, CELL)
    height = 60.0 * np.cos(x / 450.0) * np.cos(y / 600.0) + 4.0 * np.cos(x / 60.0 + y / 90.0)
    height[np.hypot(x, y) < 60.0] = float(height[SIDE // 2, SIDE // 2])
    terrain = declared(SIDE, SIDE, CELL)
    rng = np.random.default_rng(3)
    half = 0.5 * (SIDE - 2) * CELL
    places = rng.uniform(-half, half, (instances, 2))
    shapes = ("broad", "cone", "rock")
    plants = [(float(a), float(b), 2.0 if k % 3 == 2 else 14.0, shapes[k % 3]) for k, (a, b) in enumerate(places)]
    keep(folder, terrain, height, plants=plants)
    level = float(height[SIDE // 2, SIDE // 2])
    regions = {}
    for name, at in (("a", -1500.0), ("b", 1500.0)):
        z = float(height[np.hypot(x - at, y).argmin() // SIDE, np.hypot(x - at, y).argmin() % SIDE])
        regions[name] = BoxRegion(min=(at - 6, -6, z - 6), max=(at + 6, 6, z + 6))
    spec = world(
        {
            "house": box(8, 6, 5, at=(20, 0, level + 2.5)),
            "tower": box(4, 4, 12, at=(-20, 10, level + 6.0)),
            "table": box(2, 2, 0.8, at=(0, -20, level + 0.4)),
            "ball": ball(0.2, motion="dynamic", at=(0, -20, level + 1.001)),
        },
        regions=regions,
        relations={"way": Connects(a="a", b="b")},
        terrains={NAME: terrain},
    )
    return lambda: make_candidate(folder, spec)

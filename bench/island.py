"""Benchmark `island`: a whole volcanic island of 2048^2 cells, from its specification to a picture, with everything."""

from __future__ import annotations

import json
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from ..construction.terrain.store import build_terrain_file
from ..rendering import field_map
from ..worlds.folder import WorldFolder
from ..worlds.spec import WorldSpec

__all__ = ["run"]

CELLS = 2048
LANDFORMS = Path(__file__).resolve().parent.parent / "skills" / "outdoor-terrain" / "landforms.json"


def run() -> dict[str, Any]:
    """Seconds from specification to preview, and the most memory taken. Kernels are compiled before."""
    island = json.loads(LANDFORMS.read_text())["volcanic-island"]["terrain"]

    def world(cells: int) -> WorldSpec:
        land = {**island, "cell": island["extent"][0] / cells}
        return WorldSpec.model_validate({"title": "t", "prompt": "p", "terrains": {"land": land}, "simulation": {"frames": 2}})

    with tempfile.TemporaryDirectory() as folder:
        build_terrain_file(WorldFolder(Path(folder) / "small"), world(96), "land")
        steps: list[tuple[float, str]] = []
        start, before = time.perf_counter(), time.process_time()

        def say(done: float, text: str) -> None:
            steps.append((round(time.perf_counter() - start, 2), text))
            print(f"{steps[-1][0]:7.2f} s  {text}", file=sys.stderr, flush=True)

        land, _ = build_terrain_file(WorldFolder(Path(folder) / "large"), world(CELLS), "land", say=say)
        built = time.perf_counter() - start
        field_map(land, "hillshade")
        seconds, cpu = time.perf_counter() - start, time.process_time() - before
        figures = land.about["figures"]
    return {
        "seconds": round(seconds, 2),
        "cpu_s": round(cpu, 2),
        "peak_gb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20, 2),
        "cells": CELLS * CELLS,
        "build_s": round(built, 2),
        "steps": steps,
        **{k: figures[k] for k in ("lakes", "rivers", "streams", "plants")},
        "mass_residual": figures["river_erosion"]["residual"],
    }

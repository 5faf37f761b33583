"""Running water over a landscape on the CPU and on a GPU: the same storm, differences and times, as one JSON object.

    python -m worldagent.bench.terrain_gpu [--cells 512] [--large 2048] [--duration 120] [--device cuda]

The small grid runs on both and is compared; the large one on the GPU only. Needs numpy, scipy, numba and warp-lang, and this
package on the path.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

from ..construction.terrain.erosion import Ground
from ..construction.terrain.grid import Grid
from ..construction.terrain.noise import fractal
from ..construction.terrain.pipes import Rain, run_off
from ..geometry.launch import cores

__all__ = ["compare"]

EXTENT = 2048.0
"""Side of the land [m]."""


def _land(cells: int) -> Ground:
    grid = Grid(cells, cells, EXTENT / cells)
    x, y = grid.points()
    relief = 160 * fractal(x, y, wavelength=900, octaves=10, gain=0.5, seed=4, cell=grid.cell)
    return Ground.bare(grid, relief + 0.1 * x, soil=1.0)


def _storm(cells: int, duration: float, device: str) -> tuple[Ground, dict[str, Any]]:
    rain = Rain(rate=4e-5, duration=duration, capacity=20, dissolving=0.05, settling=0.05)
    run_off(_land(64), Rain(duration=1.0), device=device)
    land, balance, record = run_off(_land(cells), rain, device=device)
    return land, {
        "cells": cells * cells,
        "steps": record.steps,
        "seconds": round(record.seconds, 3),
        "ns_per_cell_step": round(record.seconds / record.steps / cells**2 * 1e9, 3),
        "mass_residual": balance.residual,
        "water_residual": record.water_residual,
        "worn_m3": balance.worn,
    }


def compare(cells: int, large: int, duration: float, device: str) -> dict[str, Any]:
    """Both runs of the small grid and the GPU's run of the large one. Kernels are compiled before."""
    ours, on_cpu = _storm(cells, duration, "cpu")
    figures: dict[str, Any] = {"duration_s": duration, "cpu_cores": cores(), "cpu": on_cpu}
    if device != "cpu":
        theirs, figures[device] = _storm(cells, duration, device)
        apart = np.abs(ours.height - theirs.height)
        figures["height_difference_m"] = {"largest": float(apart.max()), "mean": float(apart.mean())}
        figures["worn_difference"] = abs(figures[device]["worn_m3"] / on_cpu["worn_m3"] - 1)
        _, figures[f"{device}_large"] = _storm(large, duration, device)
    return figures


def main() -> None:
    """Parse arguments, print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=512)
    parser.add_argument("--large", type=int, default=2048)
    parser.add_argument("--duration", type=float, default=120.0)
    parser.add_argument("--device", default="cuda")
    given = parser.parse_args()
    print(json.dumps(compare(given.cells, given.large, given.duration, given.device)))


if __name__ == "__main__":
    main()

"""Benchmark `hydrology`: Priority-Flood and D8 beside pyflwdir and topotoolbox, exactness beside greyscale reconstruction.

Alternating in one run on the same terrain; medians. topotoolbox is GPL-3 and runs in a process of its own, in this Python or in
the one that `$WORLDAGENT_PEER_PYTHON` names.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..construction.terrain.flood import Drainage, drain
from ..construction.terrain.grid import Grid
from ..construction.terrain.noise import fractal
from ..worlds.arrays import F64

__all__ = ["run"]

ENV_PEER = "WORLDAGENT_PEER_PYTHON"
SIZE, LARGE, ROUNDS = 1024, 4096, 5
CELL = 10.0
_TOPOTOOLBOX = """
import json, sys, time
import numpy as np, topotoolbox as tt
dem = tt.GridObject()
dem.z, dem.cellsize = np.load(sys.argv[1]).astype(np.float32), 10.0
times = []
for _ in range(int(sys.argv[2])):
    start = time.perf_counter()
    filled = dem.fillsinks()
    flow = tt.FlowObject(dem)
    times.append(time.perf_counter() - start)
print(json.dumps(times))
"""


def _terrain(size: int) -> tuple[Grid, F64]:
    """Fractal relief of 600 m on a slope, 10 m cells: about 20 % of the cells lie in depressions."""
    grid = Grid(size, size, CELL)
    x, y = grid.points()
    return grid, 300 * fractal(x, y, wavelength=6000, octaves=10, gain=0.5, seed=1, cell=CELL) + 0.01 * x


def _timed(work: Callable[[], Any]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def _steepest_fraction(found: Drainage) -> float:
    """Share of the cells with a lower neighbour that drain to their steepest one."""
    grid, filled = found.grid, found.filled
    receiver = found.receiver
    here = np.arange(receiver.size).reshape(grid.shape)
    steepest = np.zeros(grid.shape)
    padded = np.pad(filled, 1, constant_values=np.inf)
    for dr, dc in ((a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if (a, b) != (0, 0)):
        steepest = np.maximum(
            steepest, (filled - padded[1 + dr : 1 + dr + grid.rows, 1 + dc : 1 + dc + grid.cols]) / np.hypot(dr, dc)
        )
    away = np.hypot(receiver // grid.cols - here // grid.cols, receiver % grid.cols - here % grid.cols)
    own = (filled - filled.ravel()[receiver]) / np.maximum(away, 1)
    falls = steepest > 0
    return float((own[falls] >= steepest[falls]).mean())


def _topotoolbox(height: F64) -> tuple[float | None, str]:
    with tempfile.TemporaryDirectory() as folder:
        np.save(Path(folder) / "dem.npy", height)
        command = [os.environ.get(ENV_PEER, sys.executable), "-c", _TOPOTOOLBOX, str(Path(folder) / "dem.npy"), str(ROUNDS)]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode != 0:
        return None, ended.stderr.strip().splitlines()[-1] if ended.stderr.strip() else "it ended without a word"
    return statistics.median(json.loads(ended.stdout.splitlines()[-1])), ""


def run() -> dict[str, Any]:
    """Seconds for fill and routing of 1024^2 cells, ratios to the peers (ours / theirs), exactness, scaling to 4096^2."""
    from skimage.morphology import reconstruction

    grid, height = _terrain(SIZE)
    found = drain(grid, height)
    seed = height.copy()
    seed[1:-1, 1:-1] = height.max()
    truth = reconstruction(seed, height, method="erosion", footprint=np.ones((3, 3)))
    ours, theirs = [], []
    why: dict[str, str] = {}
    try:
        from pyflwdir.dem import fill_depressions

        fill_depressions(height[:64, :64].astype(np.float32), outlets="edge")
        fill_depressions(height.astype(np.float32), outlets="edge")
    except ImportError as error:
        why["pyflwdir"] = str(error)
    for _ in range(ROUNDS):
        ours.append(_timed(lambda: drain(grid, height)))
        if "pyflwdir" not in why:
            theirs.append(_timed(lambda: fill_depressions(height.astype(np.float32), outlets="edge")))
        print(
            f"round: ours {ours[-1]:.3f} s, pyflwdir {theirs[-1] if theirs else float('nan'):.3f} s", file=sys.stderr, flush=True
        )
    topo, reason = _topotoolbox(height)
    if reason:
        why["topotoolbox"] = reason
    large, tall = _terrain(LARGE)
    long = min(_timed(lambda: drain(large, tall)) for _ in range(2))
    seconds = statistics.median(ours)
    return {
        "seconds_1024": round(seconds, 4),
        "ratio_vs_pyflwdir": round(seconds / statistics.median(theirs), 3) if theirs else None,
        "ratio_vs_topotoolbox": round(seconds / topo, 3) if topo else None,
        "fill_error_m": float(np.abs(found.filled - truth).max()),
        "steepest_fraction": _steepest_fraction(found),
        "seconds_4096": round(long, 3),
        "scaling_exponent": round(float(np.log(long / min(ours)) / np.log((LARGE / SIZE) ** 2)), 3),
        "in_depressions": round(float((found.depth > 0).mean()), 4),
        "left_out": why,
    }

"""Benchmark `gas-fire`: a methane burner in an open box, by cells; and how far another device is from figures saved before.

`WORLDAGENT_DEVICE=cuda worldagent bench gas-fire` takes finer boxes too. `python -m worldagent.bench.gas_fire save FILE` keeps the sums of the
coarsest box, `... compare FILE` prints the relative difference of this device.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.launch import chosen_device
from ..physics.combustion import FUELS
from ..simulation.gas.engine import FUEL, Gas
from ..simulation.gas.settings import GasSettings, Side

__all__ = ["burner", "run"]

SIDES: tuple[Side, ...] = ("open", "open", "open", "open", "closed", "open")
POWER = 5.0e4
"""Power of the fuel [W]."""
WIDE = 1.0
"""Width of the box [m]."""
SECONDS = 0.5
FPS = 24
CELLS, GPU_CELLS = (32, 64), (128, 256)


def burner(cells: int, seconds: float = SECONDS) -> dict[str, float]:
    """Sums of a burner after a time, and the wall time of the second half of its frames [s per frame]."""
    fuel, cell = FUELS["methane"], WIDE / cells
    gas = Gas((cells,) * 3, cell, SIDES, GasSettings(fuel=fuel))
    source = np.zeros(gas.shape)
    middle, half = cells // 2, max(1, round(0.1 / cell / 2))
    source[middle - half : middle + half, middle - half : middle + half, 0:2] = 1.0
    volume = POWER / fuel.heat / gas.density
    gas.emit(source * volume / (source.sum() * cell**3), [0.0, 0.0, gas.density, 0.0])
    gas.ignite(source)
    frames = round(seconds * FPS)
    half_way = frames // 2
    for frame in range(frames):
        if frame == half_way:
            start = time.perf_counter()
        gas.advance(1.0 / FPS)
    inside = gas.totals() * cell**3
    spent = (time.perf_counter() - start) / (frames - half_way)
    out = gas.border.take()[:4] * cell**3
    fire = gas.fire
    assert fire is not None
    burnt = seconds * volume * gas.density - float(inside[FUEL] + out[FUEL])
    return {
        "released_J": fire.released,
        "radiated_J": fire.radiated,
        "burnt_kg": burnt,
        "released_over_fuel": fire.released / (burnt * fuel.heat),
        "hottest_K": float(gas.temperature.max()),
        "seconds_per_frame": spent,
        "steps": float(gas.steps),
    }


def run() -> dict[str, Any]:
    """Figures by cells along a side."""
    sizes = CELLS + (GPU_CELLS if chosen_device(None) != "cpu" else ())
    return {"device": chosen_device(None), "cells": {str(n): burner(n) for n in sizes}}


def main(arguments: list[str]) -> int:
    """Keep the sums of the coarsest box, or compare with those kept."""
    command, path = arguments[0], Path(arguments[1])
    found = burner(CELLS[0])
    if command == "save":
        path.write_text(json.dumps(found))
        return 0
    kept = json.loads(path.read_text())
    for name in ("released_J", "radiated_J", "burnt_kg", "hottest_K"):
        print(f"{name}: {found[name]:.6g} here, {kept[name]:.6g} kept, {found[name] / kept[name] - 1.0:+.1e} of it")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))

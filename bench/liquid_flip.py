"""Benchmark `liquid-flip`: a collapsing column on the grid engine beside Mantaflow (Blender, GPL, a process of its own).

    worldagent bench liquid-flip
    python -m worldagent.bench.liquid_flip --device cuda --particles 1000000 --seconds 1

A closed cube of 1 m, a column of 0.4 x 1 x 0.6 m of water at one side, 24 frames a second. The peer runs in the same run, in turns with
ours, on the same column at the same resolution with its own defaults (8 particles per cell, FLIP ratio 0.97, adaptive steps); both
write the particles of every frame. The second form measures our engine alone and needs numpy and warp-lang only.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..simulation.boundaries import BodyState
from ..simulation.liquid.engine import Fluid, LiquidSetup
from ..simulation.liquid.flip.engine import Flip
from ..simulation.liquid.flip.settings import FlipSettings
from .mantaflow import bake

__all__ = ["measure", "run"]

COLUMN = (0.4, 1.0, 0.6)
FPS = 24
GRAVITY = np.array([0.0, 0.0, -9.81])
KNOWN = {64: 1.84, 128: 21.1}
"""Seconds per frame of Mantaflow on two 2.5 GHz cores, by resolution; used where it is not installed."""
CFL = 4.0
"""Cells that the fastest particle crosses in a step: the peer's own default, which besides makes at most four steps a frame."""
SETTLE_SECONDS = 8.0
"""Time of the run that measures the drift of volume: the wave has broken and come to rest but for its slow sloshing."""
_PEER = """
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.2, 0.5, 0.3))
column = bpy.context.object
column.scale = (0.4, 1.0, 0.6)
settings.use_mesh = False
flow = column.modifiers.new("fluid", "FLUID")
flow.fluid_type = "FLOW"
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "LIQUID", "GEOMETRY"
"""


def _setup(resolution: int, device: str) -> LiquidSetup:
    cell = 1.0 / resolution
    ticks = [np.arange(cell / 2, side, cell) for side in COLUMN]
    position = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    n = len(position)
    return LiquidSetup(
        spacing=cell,
        lower=np.zeros(3),
        upper=np.ones(3),
        sides=("closed",) * 6,
        fluids=(Fluid("water", 1000.0, 1e-3),),
        gravity=GRAVITY,
        position=position,
        velocity=np.zeros_like(position),
        fluid=np.zeros(n, np.int32),
        volume=np.full(n, float(np.prod(COLUMN)) / n),
        device=device,
    )


def _bodies() -> BodyState:
    none = np.zeros((0, 3))
    turn = np.zeros((0, 3, 3))
    return BodyState(none, turn, none, none, none, np.zeros(0), turn, none)


def _frame(engine: Flip, bodies: BodyState) -> int:
    """Advance by one frame; number of steps."""
    steps, passed = 0, 0.0
    while passed < 1.0 / FPS - 1e-9:
        passed += engine.step(1.0 / FPS - passed, bodies).dt
        steps += 1
    return steps


def measure(resolution: int, seconds: float, device: str, settings: FlipSettings, folder: Path | None = None) -> dict[str, Any]:
    """Figures of our engine over some seconds, compilation excluded; particles of every frame are written to `folder`."""
    bodies = _bodies()
    _frame(Flip(_setup(8, device), settings), bodies)
    engine = Flip(_setup(resolution, device), settings)
    steps, capped, frames = 0, 0, round(seconds * FPS)
    start, cpu = time.perf_counter(), time.process_time()
    for frame in range(frames):
        steps += _frame(engine, bodies)
        if folder is not None:
            particles = engine.particles()
            path = folder / f"{frame:06d}.npz"
            np.savez(path, position=particles.position.astype(np.float32), velocity=particles.velocity.astype(np.float32))
    wall, cpu = time.perf_counter() - start, time.process_time() - cpu
    return {"wall": wall, "cpu": cpu, "frames": frames, "steps": steps, "capped": capped, "particles": engine.markers.live}


def _drift(resolution: int, settings: FlipSettings) -> dict[str, float]:
    """Relative change of the volume under the surface after collapse and settling: mean over the last second, and the extremes."""
    engine, bodies = Flip(_setup(resolution, "cpu"), settings), _bodies()
    volume = float(np.prod(COLUMN))
    course = []
    for _ in range(round(SETTLE_SECONDS * FPS)):
        _frame(engine, bodies)
        course.append(engine.volume / volume - 1.0)
    return {
        "volume_drift": round(abs(float(np.mean(course[-FPS:]))), 5),
        "volume_drift_worst": round(float(np.abs(course).max()), 5),
    }


def run(*, resolution: int = 64, frames: int = 24, rounds: int = 2) -> dict[str, Any]:
    """Time against Mantaflow's over the same frames (least of `rounds` turns each), and the drift of volume in a run of its own."""
    settings = FlipSettings(cfl=CFL)
    ours: list[dict[str, Any]] = []
    theirs: list[dict[str, Any]] = []
    for turn in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            ours.append(measure(resolution, frames / FPS, "cpu", settings, Path(folder)))
        theirs.append(bake(_PEER, "LIQUID", resolution, frames))
        print(f"turn {turn + 1}: ours {ours[-1]}, Mantaflow {theirs[-1]}", file=sys.stderr, flush=True)
    best = min(ours, key=lambda found: found["wall"])
    figures: dict[str, Any] = {
        "resolution": resolution,
        "cells": resolution**3,
        "particles": best["particles"],
        "seconds_per_frame": round(best["wall"] / frames, 4),
        "cpu_seconds_per_frame": round(min(found["cpu"] for found in ours) / frames, 4),
        "steps_per_frame": round(best["steps"] / frames, 2),
        **_drift(resolution // 2, settings),
        "volume_drift_resolution": resolution // 2,
    }
    measured = [found for found in theirs if "wall" in found]
    if measured:
        wall, cpu = min(found["wall"] for found in measured) / frames, min(found["cpu"] for found in measured) / frames
        return {
            **figures,
            "mantaflow_seconds_per_frame": round(wall, 4),
            "mantaflow_cpu_seconds_per_frame": round(cpu, 4),
            "ratio_vs_mantaflow": round(figures["seconds_per_frame"] / wall, 3),
            "cpu_ratio_vs_mantaflow": round(figures["cpu_seconds_per_frame"] / cpu, 3),
            "peer": {key: measured[0][key] for key in ("version", "cfl", "most_steps")},
        }
    known = KNOWN.get(resolution)
    return {
        **figures,
        "ratio_vs_mantaflow": None,
        "reason": theirs[0]["reason"],
        "ratio_vs_mantaflow_elsewhere": round(figures["seconds_per_frame"] / known, 3) if known else None,
    }


def main() -> None:
    """Our engine alone, on a chosen device."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--particles", type=int, default=1_000_000, help="about; sets the resolution at 8 per cell")
    parser.add_argument("--seconds", type=float, default=1.0, help="simulated")
    parser.add_argument("--cfl", type=float, default=FlipSettings().cfl)
    given = parser.parse_args()
    resolution = max(8, round((given.particles / 8 / float(np.prod(COLUMN))) ** (1 / 3)))
    found = measure(resolution, given.seconds, given.device, FlipSettings(cfl=given.cfl))
    rate = found["particles"] * found["steps"] / found["wall"]
    print(json.dumps({**found, "resolution": resolution, "device": given.device, "particle_steps_per_s": round(rate)}))


if __name__ == "__main__":
    main()

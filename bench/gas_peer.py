"""Benchmark `gas-peer`: smoke past a ball beside Mantaflow.

An open cube of 1 m with a floor, a hot source of 8 cm radius below a ball of 15 cm, 24 frames a second. The peer runs in the same run, in
turns with ours, at the same resolution with its own defaults (adaptive steps); both write every frame.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from .gas import smoke_box
from .mantaflow import bake

__all__ = ["run"]

FPS = 24
_PEER = """
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.08, location=(0.5, 0.5, 0.1))
source = bpy.context.object
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.15, location=(0.5, 0.5, 0.6))
ball = bpy.context.object
settings.use_adaptive_domain, settings.use_noise = False, False
for side in ("front", "back", "left", "right", "top"):
    setattr(settings, "use_collision_border_" + side, False)
settings.use_collision_border_bottom = True
flow = source.modifiers.new("fluid", "FLUID")
flow.fluid_type = "FLOW"
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "SMOKE", "INFLOW"
effector = ball.modifiers.new("fluid", "FLUID")
effector.fluid_type = "EFFECTOR"
"""


def _ours(resolution: int, frames: int) -> dict[str, Any]:
    """Figures of our engine, compilation excluded."""
    smoke_box(8, "reflection").advance(1.0 / FPS)
    gas = smoke_box(resolution, "reflection")
    steps, capped = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        start, cpu = time.perf_counter(), time.process_time()
        for frame in range(frames):
            reports = gas.advance(1.0 / FPS)
            steps, capped = steps + len(reports), capped + sum(r.capped for r in reports)
            np.savez(Path(folder) / f"{frame:06d}.npz", state=gas.state, velocity=gas.velocity)
        return {"wall": time.perf_counter() - start, "cpu": time.process_time() - cpu, "steps": steps, "capped": capped}


def run(*, resolution: int = 64, frames: int = 12, rounds: int = 2) -> dict[str, Any]:
    """Time against Mantaflow's over the same frames: least of `rounds` turns each."""
    ours, theirs = [], []
    for turn in range(rounds):
        ours.append(_ours(resolution, frames))
        theirs.append(bake(_PEER, "GAS", resolution, frames))
        print(f"turn {turn + 1}: ours {ours[-1]}, Mantaflow {theirs[-1]}", file=sys.stderr, flush=True)
    figures: dict[str, Any] = {"resolution": resolution, "steps_per_frame": round(ours[0]["steps"] / frames, 2)}
    measured = [found for found in theirs if "wall" in found]
    for kind in ("wall", "cpu"):
        own = min(found[kind] for found in ours) / frames
        figures[f"{kind}_seconds_per_frame"] = round(own, 4)
        if measured:
            peer = min(found[kind] for found in measured) / frames
            figures[f"mantaflow_{kind}_seconds_per_frame"] = round(peer, 4)
            figures[f"{kind}_ratio_vs_mantaflow"] = round(own / peer, 3)
    return {**figures, "peer": measured[0] if measured else theirs[0]}

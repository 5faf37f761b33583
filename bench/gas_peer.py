"""Benchmark `gas-peer`: hot smoke that rises past a ball, beside Mantaflow: time, and detail at the same stages.

    worldagent bench gas-peer

An open cube of 1 m with a floor, a hot source of 8 cm radius below a ball of 15 cm, 24 frames a second. The peer runs in the same run, in
turns with ours, at the same resolution with its own defaults (adaptive steps, MacCormack); both write every frame. Its buoyancy is a number
without a unit: `BUOYANCY` lets its smoke rise as fast as ours (`front`), which was set first. Detail: `gas_detail.py`.

Both are measured twice: in the whole cube, and in a part of it that follows the smoke (ours: `follows`; Mantaflow's: its adaptive domain, with
its own defaults). Mantaflow's frames then hold that part alone, so that its detail is that of the whole cube.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..worlds.arrays import F64
from .gas import SMOKE, smoke_box
from .gas_detail import centred, detail
from .mantaflow import bake, grid_of

__all__ = ["run"]

FPS = 24
STAGES = (18, 24, 30, 36, 42, 48)
"""Frames at which detail is compared: smoke meets the ball at 24 and has passed it at 48. Both fronts come to the ball within a frame of each other,
which moves single frames by more than solvers differ; so the means over these stages are compared too."""
BUOYANCY = 0.25
"""For smoke and for heat, where Mantaflow's default is 1: with it both fronts stand within 2 cells of each other at both stages of 64^3."""
SEEN = 0.02
"""Own choice: of the source's smoke, from which on it counts for the front."""
_PEER = f"""
settings.alpha, settings.beta = {BUOYANCY}, {BUOYANCY}
settings.cache_data_format = "UNI"
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.08, location=(0.5, 0.5, 0.1))
source = bpy.context.object
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.15, location=(0.5, 0.5, 0.6))
ball = bpy.context.object
settings.use_adaptive_domain, settings.use_noise = ADAPTIVE, False
for side in ("front", "back", "left", "right", "top"):
    setattr(settings, "use_collision_border_" + side, False)
settings.use_collision_border_bottom = True
flow = source.modifiers.new("fluid", "FLUID")
flow.fluid_type = "FLOW"
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "SMOKE", "INFLOW"
effector = ball.modifiers.new("fluid", "FLUID")
effector.fluid_type = "EFFECTOR"
"""


def _told(velocity: F64, smoke: F64) -> dict[str, float]:
    """Detail of one frame, and the height that smoke has reached [sides]."""
    layers = np.flatnonzero(smoke.max(axis=(0, 1)) > SEEN)
    return {"front": float((layers[-1] + 1) / smoke.shape[2]) if len(layers) else 0.0, **detail(velocity)}


def _ours(resolution: int, frames: int, *, follows: bool = False) -> dict[str, Any]:
    """Figures of our engine, compilation excluded."""
    smoke_box(32 if follows else 8, "reflection", follows=follows).advance(1.0 / FPS)
    gas = smoke_box(resolution, "reflection", follows=follows)
    steps, capped, stages, wall, cpu = 0, 0, {}, 0.0, 0.0
    with tempfile.TemporaryDirectory() as folder:
        for frame in range(1, frames + 1):
            began, worked = time.perf_counter(), time.process_time()
            reports = gas.advance(1.0 / FPS)
            steps, capped = steps + len(reports), capped + sum(r.capped for r in reports)
            np.savez(Path(folder) / f"{frame:06d}.npz", state=gas.state, velocity=gas.velocity)
            wall, cpu = wall + time.perf_counter() - began, cpu + time.process_time() - worked
            if frame in STAGES:
                stages[frame] = _told(centred(gas.velocity.astype(np.float64)), gas.state[..., 1].astype(np.float64) / SMOKE[1])
    return {"wall": wall, "cpu": cpu, "steps": steps, "capped": capped, "stages": stages}


def _theirs(resolution: int, frames: int, *, follows: bool = False) -> dict[str, Any]:
    """Figures of Mantaflow, or the reason why there are none."""
    with tempfile.TemporaryDirectory() as folder:
        found = bake(_PEER.replace("ADAPTIVE", str(follows)), "GAS", resolution, frames, cache=Path(folder))
        if "wall" in found and not follows:
            read = {
                frame: [grid_of(Path(folder), name, frame) for name in ("vel", "density")] for frame in STAGES if frame <= frames
            }
            # Its velocities are those of lower faces, without the last upper ones.
            found["stages"] = {
                f: _told(centred(np.pad(v, ((0, 1),) * 3 + ((0, 0),), mode="edge")), d[..., 0]) for f, (v, d) in read.items()
            }
        return found


def _compared(ours: dict[int, dict[str, float]], theirs: dict[int, dict[str, float]]) -> dict[str, dict[str, float]]:
    """Ratio of our detail to the peer's, by figure: of the means over all stages, and the least at one stage."""
    stages = sorted(set(ours) & set(theirs))
    names = [name for name in ours[stages[0]] if name != "front"]
    return {
        name: {
            "of_means": round(sum(ours[f][name] for f in stages) / sum(theirs[f][name] for f in stages), 3),
            "least": round(min(ours[f][name] / theirs[f][name] for f in stages), 3),
        }
        for name in names
    }


def run(*, resolution: int = 64, frames: int = 48, rounds: int = 2) -> dict[str, Any]:
    """Time against Mantaflow's over the same frames, least of `rounds` turns each, and detail of both."""
    ours: dict[bool, list[dict[str, Any]]] = {False: [], True: []}
    theirs: dict[bool, list[dict[str, Any]]] = {False: [], True: []}
    for turn in range(rounds):
        for follows in (False, True):
            ours[follows].append(_ours(resolution, frames, follows=follows))
            theirs[follows].append(_theirs(resolution, frames, follows=follows))
            print(f"turn {turn + 1}: ours {ours[follows][-1]}, Mantaflow {theirs[follows][-1]}", file=sys.stderr, flush=True)
    figures: dict[str, Any] = {"resolution": resolution, "steps_per_frame": round(ours[False][0]["steps"] / frames, 2)}
    for follows, name in ((False, ""), (True, "followed_")):
        measured = [found for found in theirs[follows] if "wall" in found]
        for kind in ("wall", "cpu"):
            own = min(found[kind] for found in ours[follows]) / frames
            figures[f"{name}{kind}_seconds_per_frame"] = round(own, 4)
            if measured:
                peer = min(found[kind] for found in measured) / frames
                figures[f"mantaflow_{name}{kind}_seconds_per_frame"] = round(peer, 4)
                figures[f"{name}{kind}_ratio_vs_mantaflow"] = round(own / peer, 3)
        figures[f"{name}detail"] = ours[follows][0]["stages"]
    known = [found for found in theirs[False] if "wall" in found]
    if not known:
        return {**figures, "peer": theirs[False][0]}
    peer = {k: v for k, v in known[0].items() if k != "stages"}
    stages = known[0]["stages"]
    return {
        **figures,
        "mantaflow_detail": stages,
        "detail_ratio_vs_mantaflow": _compared(ours[False][0]["stages"], stages),
        "peer": peer,
    }

"""Mantaflow as a peer: Blender (GPL) in a process of its own."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..worlds.arrays import F64

__all__ = ["bake", "grid_of"]

ENV_BLENDER = "WORLDAGENT_BLENDER"
_HEAD = """
import bpy, json, sys, time
kind, res, first, last, folder = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.frame_start, scene.frame_end, scene.render.fps = 1, int(last), 24
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.5, 0.5, 0.5))
domain = bpy.context.object
settings = domain.modifiers.new("fluid", "FLUID")
settings.fluid_type = "DOMAIN"
settings = settings.domain_settings
settings.domain_type = kind
settings.resolution_max, settings.cache_directory, settings.cache_type = int(res), folder, "ALL"
settings.cache_frame_start, settings.cache_frame_end = 1, int(last)
"""
"""A unit cube as domain; a script adds what is in it and how it is solved."""
_TAIL = """
start, cpu = time.perf_counter(), time.process_time()
with bpy.context.temp_override(object=domain, active_object=domain):
    bpy.ops.fluid.bake_all()
figures = {"wall": time.perf_counter() - start, "cpu": time.process_time() - cpu, "version": bpy.app.version_string}
print("PEER" + json.dumps({**figures, "cfl": settings.cfl_condition, "most_steps": settings.timesteps_max}))
"""


def bake(
    script: str, kind: Literal["GAS", "LIQUID"], resolution: int, frames: int, *, cache: Path | None = None
) -> dict[str, Any]:
    """Seconds by the clock and of the processor that a bake takes, with version and settings, or the reason why there are none.

    Args:
        script: Python for Blender between the making of a unit cube `domain` with its `settings` and the bake.
        kind: of the domain.
        resolution: cells along the domain's longest side.
        frames: to bake.
        cache: folder that keeps its frames; left out: they are deleted.
    """
    blender = os.environ.get(ENV_BLENDER) or shutil.which("blender")
    if blender is None:
        return {"reason": f"blender is not installed; ${ENV_BLENDER} may name it (Debian package blender 3.4.1)"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "peer.py"
        path.write_text(_HEAD + script + _TAIL)
        command = [
            blender,
            "-b",
            "-P",
            str(path),
            "--",
            kind,
            str(resolution),
            "1",
            str(frames),
            str(cache or Path(folder) / "cache"),
        ]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
    for line in ended.stdout.splitlines():
        if line.startswith("PEER"):
            found: dict[str, Any] = json.loads(line[4:])
            return found
    return {"reason": (ended.stderr.strip().splitlines() or ["blender ended without a word"])[-1]}


def grid_of(cache: Path, name: str, frame: int) -> F64:
    """A field of a frame that was baked with the data format UNI, shape (nx, ny, nz, components).

    Args:
        cache: folder of the bake.
        name: of the field: `vel` (lower faces, cells per unit of its time), `density`, `heat`.
        frame: from 1 on.
    """
    raw = gzip.decompress((cache / "data" / f"{name}_{frame:04d}.uni").read_bytes())
    nx, ny, nz, _, _, size = np.frombuffer(raw, dtype="<i4", count=6, offset=4)
    values = np.frombuffer(raw, dtype="<f4", offset=len(raw) - int(nx) * int(ny) * int(nz) * int(size))
    return np.asarray(values.reshape(nz, ny, nx, -1).transpose(2, 1, 0, 3), dtype=np.float64)

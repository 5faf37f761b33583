"""Mantaflow as a peer: Blender (GPL) in a process of its own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

__all__ = ["bake"]

ENV_BLENDER = "WORLDAGENT_BLENDER"


def bake(script: str, resolution: int, frames: int) -> dict[str, Any]:
    """Figures that a script prints after the word PEER, or the reason why there are none.

    Args:
        script: Python for Blender; its arguments after -- are resolution, first and last frame, and a folder for the cache.
        resolution: cells along the domain's longest side.
        frames: to bake.
    """
    blender = os.environ.get(ENV_BLENDER) or shutil.which("blender")
    if blender is None:
        return {"reason": f"blender is not installed; ${ENV_BLENDER} may name it (Debian package blender 3.4.1)"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "peer.py"
        path.write_text(script)
        command = [blender, "-b", "-P", str(path), "--", str(resolution), "1", str(frames), str(Path(folder) / "cache")]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
    for line in ended.stdout.splitlines():
        if line.startswith("PEER"):
            found: dict[str, Any] = json.loads(line[4:])
            return found
    return {"reason": (ended.stderr.strip().splitlines() or ["blender ended without a word"])[-1]}

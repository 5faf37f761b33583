"""World folders as a bake leaves them, without server and ledger."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from worldagent.construction.store import build_world, built_paths
from worldagent.simulation.freeze import open_freeze
from worldagent.simulation.schedule import run_frames
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec

__all__ = ["baked_folder"]


def baked_folder(root: Path, document: dict[str, Any], *, frames: int | None = None) -> WorldFolder:
    """A world folder whose specification is baked, or its first frames are."""
    folder = WorldFolder(root)
    root.mkdir(parents=True, exist_ok=True)
    folder.spec_path.write_text(json.dumps(document))
    spec = parse_spec(document)
    built, _ = build_world(folder, spec)
    freeze = open_freeze(folder, spec, built, built_paths(folder, spec), 1)
    if frames != 0:
        run_frames(spec, built, folder.candidate(freeze) / "bake", frames=frames or spec.simulation.frames)
    return folder

"""Surfaces of a liquid instance: closed meshes, spray and foam per frame, beside the particles they were made of.

They stand in `surface/` in the folder of the instance's cache, one container per frame, and are a cache of their own. Positions are
relative to `origin`, which is that of the particles. `worlds/channels.py` says what the channels hold.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...cache import Cache
from ...derived import Derived
from ...kept import kept

__all__ = ["LiquidSurface", "mesh_of", "surface_folder"]


def surface_folder(cache: Cache) -> Path:
    """Folder of the surfaces of an instance."""
    return cache.folder / "surface"


class LiquidSurface(Derived):
    """Reader of the surfaces that were made of a cache; its note says recipe, settings, versions and spacing [m]."""

    one, many, note = "surface", "surfaces", "surface.json"
    writes = "surface"

    def __init__(self, cache: Cache) -> None:
        super().__init__(cache, surface_folder(cache))

    def _understand(self, data: dict[str, Any]) -> None:
        if not isinstance(data["spacing"], float):
            raise ValueError("it has no spacing")

    @kept(4)
    def read(self, frame: int) -> dict[str, Any]:
        """All channels of a frame; see `Derived.read`."""
        return super().read(frame)

    def records(self, frame: int) -> dict[str, float]:
        """Recorded quantities of a frame, without the prefix."""
        found = self.read(frame)
        return {k.removeprefix("record/"): float(v) for k, v in found.items() if k.startswith("record/")}


def mesh_of(found: dict[str, Any], fluid: int | None = None) -> tuple[Any, Any]:
    """World vertices (v, 3) [m] and faces (m, 3) of a frame's surface, of one liquid or of all."""
    faces = found["surface/faces"]
    if fluid is not None:
        faces = faces[found["surface/fluid"] == fluid]
    used = np.zeros(len(found["surface/vertices"]), dtype=bool)
    used[faces] = True
    number = np.cumsum(used) - 1
    return found["surface/vertices"][used].astype(np.float64) + found["origin"], number[faces].astype(np.int32)

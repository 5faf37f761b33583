"""Runs of variants that are kept with their candidate, so that judging the same motion again does not simulate it again.

Another candidate of the world has the same run where it differs in nothing that the run follows from: in a driver that is taken away in it,
or in what acts after its end.

One file holds all frames of one run. Its name is the recipe of the run, and a seal over recipe and content stands in it: what is
damaged, altered or of another recipe is as good as absent. Acceptance is given no such folder: it simulates for itself.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..worlds.cache import digest_arrays, read_container, write_container
from ..worlds.errors import EvidenceError

__all__ = ["FILE_BYTES", "FOLDER_BYTES", "Frames", "KeptRuns"]

Frames = Mapping[str, Mapping[int, Mapping[str, Any]]]
"""Channels by instance and frame."""
FILE_BYTES = 256_000_000
"""A larger run is not kept [bytes]: reading it takes as much memory again. Own choice."""
FOLDER_BYTES = 1_000_000_000
"""Those used longest ago go when the runs of a candidate are larger together [bytes]. Own choice."""
_SEAL = "seal"


class KeptRuns:
    """The kept runs of one candidate.

    Args:
        folder: where they are; None keeps and finds nothing.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder

    def find(self, recipe: str) -> dict[str, dict[int, Mapping[str, Any]]] | None:
        """The frames of a run, of this candidate or of another of its world; None where they are not kept, or not as they were."""
        if self._folder is None or not recipe:
            return None
        own = self._path(recipe)
        candidates = sorted(self._folder.parent.parent.glob("*/candidate.json"))
        others = [c.parent / self._folder.name / own.name for c in candidates if self._folder.parent / c.name in candidates]
        found = (self._read(path, recipe) for path in (own, *others) if path.is_file())
        return next((frames for frames in found if frames is not None), None)

    def _read(self, path: Path, recipe: str) -> dict[str, dict[int, Mapping[str, Any]]] | None:
        try:
            held = read_container(path)
            sealed = bytes(held.pop(_SEAL))
            if sealed != _seal(recipe, held):
                return None
            found: dict[str, dict[int, dict[str, Any]]] = {}
            for name, array in held.items():
                instance, frame, channel = name.split("/", 2)
                found.setdefault(instance, {}).setdefault(int(frame), {})[channel] = array
            os.utime(path)
        except (EvidenceError, OSError, KeyError, ValueError):
            return None
        return {instance: {**frames} for instance, frames in found.items()}

    def keep(self, recipe: str, frames: Frames) -> None:
        """Keep the frames of a run; a run that is too large, and one that the disk does not take, is not kept."""
        if self._folder is None:
            return
        held = {f"{n}/{k}/{c}": np.asarray(a) for n, own in frames.items() for k, data in own.items() for c, a in data.items()}
        if not held or sum(a.nbytes for a in held.values()) > FILE_BYTES:
            return
        try:
            write_container(self._path(recipe), {**held, _SEAL: np.frombuffer(_seal(recipe, held), np.uint8)})
            self._make_room()
        except OSError:  # the verdict stands without it
            return

    def _path(self, recipe: str) -> Path:
        assert self._folder is not None
        return self._folder / f"{recipe[:32]}.npz"

    def _make_room(self) -> None:
        assert self._folder is not None
        known = sorted(((p.stat(), p) for p in self._folder.glob("*.npz")), key=lambda item: -item[0].st_mtime_ns)
        held = 0
        for told, path in known:
            held += told.st_size
            if held > FOLDER_BYTES:
                path.unlink(missing_ok=True)


def _seal(recipe: str, held: Mapping[str, Any]) -> bytes:
    return hashlib.sha256(f"{recipe}|{digest_arrays(held)}".encode()).digest()

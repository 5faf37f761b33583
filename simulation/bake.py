"""Bake (R79-R81): the full sequence of a frozen candidate, in its own folder, resumable."""

from __future__ import annotations

from collections.abc import Callable

from ..worlds.candidate import Candidate, open_candidate
from ..worlds.folder import WorldFolder
from .probe import recorded_inputs
from .schedule import run_frames

__all__ = ["run_bake"]


def run_bake(
    folder: WorldFolder,
    freeze: str,
    *,
    progress: Callable[[float, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
    reuse: bool = True,
) -> Candidate:
    """Bake every frame of a freeze, resuming from its last checkpoint, and open it for checking.

    `reuse` lets a liquid take its frames from another candidate with the same recipe.
    """
    spec, built = recorded_inputs(folder, freeze)
    run_frames(
        spec, built, folder.candidate(freeze) / "bake", frames=spec.simulation.frames, progress=progress, check=check, reuse=reuse
    )
    return open_candidate(folder, freeze, "full")

"""Bake (R79-R81): the full sequence of a frozen candidate, in its own folder, resumable."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..worlds.built import BuiltEntity
from ..worlds.candidate import Candidate, open_candidate, recorded_inputs
from ..worlds.folder import WorldFolder
from .schedule import run_frames

__all__ = ["run_bake"]


def run_bake(
    folder: WorldFolder,
    freeze: str,
    *,
    built: Mapping[str, BuiltEntity] | None = None,
    progress: Callable[[float, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
    reuse: bool = True,
    probe: Candidate | None = None,
) -> Candidate:
    """Bake every frame of a freeze, resuming from its last checkpoint, and open it for checking.

    `built` are entities at hand, which need not be read again (`recorded_inputs`). `reuse` lets a liquid take its frames from another candidate with the same recipe.
    `probe` is one of this freeze at production settings: the bake simulates for itself, and takes the surfaces and wet maps of liquids
    from it where it came to the same frames.
    """
    spec, found = recorded_inputs(folder, freeze, built)
    run_frames(
        spec, found, folder.candidate(freeze) / "bake", frames=spec.simulation.frames, progress=progress, check=check, reuse=reuse,
        earlier=probe.caches if probe is not None else None,
    )  # fmt: skip
    return open_candidate(folder, freeze, "full", found)

"""Bake (R79-R81): the full sequence of a frozen candidate, in its own folder, resumable."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..worlds.built import BuiltEntity
from ..worlds.candidate import Candidate, open_candidate, recorded_inputs
from ..worlds.folder import WorldFolder
from .origins import Origins
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

    `built` are entities at hand, which need not be read again (`recorded_inputs`). `reuse` lets it take frames that another run has of it: a liquid's
    from another candidate with the same recipe; and all that a `probe` of this freeze at production settings has simulated, with the surfaces and
    wet maps of liquids where all frames are the same. It goes on from there, byte for byte as if it had simulated them itself.
    """
    spec, found = recorded_inputs(folder, freeze, built)
    root = folder.candidate(freeze)
    taking = Origins(root / "bake", spec, found, own=root / "probe") if reuse and probe is not None else reuse
    run_frames(
        spec, found, root / "bake", frames=spec.simulation.frames, progress=progress, check=check, reuse=taking,
        earlier=probe.caches if probe is not None else None,
    )  # fmt: skip
    return open_candidate(folder, freeze, "full", found)

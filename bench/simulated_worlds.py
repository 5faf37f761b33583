"""Small worlds whose motion is really simulated, with checkpoints: for what only a run without its cause can tell."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..simulation.schedule import run_frames
from ..worlds.candidate import Candidate, Stage, cache_digest
from ..worlds.spec import Beat, Material, WorldSpec
from ..worlds.vocabulary import SpecModel
from .small_worlds import build_all

__all__ = ["SLICK", "beat", "simulate"]

SLICK = {"wood": Material(density=600.0, friction=0.1, restitution=0.0, substance="wood")}
"""Material on which things slide far and do not bounce."""


def simulate(folder: Path, spec: WorldSpec, *, stage: Stage = "probe") -> Candidate:
    """The specification's motion, simulated into `folder/run`, with its checkpoints."""
    built = build_all(spec)
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, stage, caches, "run", cache_digest(caches))


def beat(subject: str, predicate: SpecModel, *, frames: tuple[int, int], causes: Sequence[str] = (), **more: Any) -> Beat:
    """A beat owned by the solver, unless told."""
    return Beat(
        text="",
        owner=more.pop("owner", "rigid"),
        subject=subject,
        frames=frames,
        predicate=predicate,
        causes=list(causes),
        **more,
    )

"""Small worlds whose motion is really simulated, with checkpoints: for what only a run without its cause can tell; and forged copies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...simulation.schedule import run_frames
from ...worlds.cache import Cache, write_container
from ...worlds.candidate import Candidate, Stage, cache_digest
from ...worlds.spec import Beat, Material, WorldSpec
from ...worlds.vocabulary import SpecModel
from .small_worlds import build_all

__all__ = ["SLICK", "beat", "edited", "simulate"]

SLICK = {"wood": Material(density=600.0, friction=0.1, restitution=0.0, substance="wood")}
"""Material on which things slide far and do not bounce."""


def simulate(folder: Path, spec: WorldSpec, *, stage: Stage = "probe") -> Candidate:
    """The specification's motion, simulated into `folder/run`, with its checkpoints."""
    built = build_all(spec)
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, stage, caches, "run", cache_digest(caches))


def edited(base: Candidate, folder: Path, solver: str, change: Callable[[int, dict[str, Any]], None]) -> Candidate:
    """The same candidate with other frames of one instance, kept in `folder`; digests fit what is written.

    `change(frame, data)` edits copies of the channels and records of a frame.
    """
    old, new = base.caches[solver], Cache(folder / solver)
    new.folder.mkdir(parents=True)
    new.write_index(old.index)
    new.begin_digests([])
    for frame in range(old.index.frames):
        data = {name: np.array(values) for name, values in old.read(frame).items()}
        change(frame, data)
        new.add_digest(write_container(new.path(frame), data))
    caches = {**base.caches, solver: new}
    return replace(base, folder=folder, caches=caches, digest=cache_digest(caches))


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

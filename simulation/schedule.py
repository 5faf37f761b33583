"""The frame loop: advances the solver instances of a world in their declared order and writes their caches (R80)."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path

from ..worlds.audit import audit
from ..worlds.built import BuiltEntity
from ..worlds.cache import Cache, write_container
from ..worlds.errors import EngineError, EvidenceError, InputError
from ..worlds.folder import write_atomically
from ..worlds.spec import WorldSpec
from .protocol import Intervention, Solver

__all__ = ["CHECKPOINT_SECONDS", "checkpoint_frames", "checkpoint_path", "make_solver", "run_frames"]

CHECKPOINT_SECONDS = 0.5
"""Interval between checkpoints [s of the world]: what a resumed or replayed run repeats at most."""


def make_solver(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, intervention: Intervention | None = None) -> Solver:
    """The solver of one instance, not yet prepared; with an intervention, of the run in which it is made.

    Raises:
        InputError: a member has no engine in this build.
    """
    others = [m for m in spec.simulation.solvers[name].members if spec.entities[m].physics.category != "rigid"]
    if others:
        raise InputError(f"members {others[:5]} of solver {name!r} are not rigid; this build simulates rigid bodies only")
    import mujoco

    from .rigid import SolverRigid

    # Warnings are counted in the `overflows` record; the engine would also write a log file into the working directory.
    mujoco.set_mju_user_warning(_ignore)

    return SolverRigid(spec, built, name, intervention)


def _ignore(message: str) -> None:
    del message


def checkpoint_frames(spec: WorldSpec, frames: int) -> list[int]:
    """Frames at which checkpoints are taken, frame 0 first."""
    every = max(1, round(CHECKPOINT_SECONDS * spec.simulation.fps))
    return list(range(0, frames, every))


def checkpoint_path(folder: Path, frame: int) -> Path:
    """File of the solver's state at a frame, in the folder of its cache."""
    return folder / "checkpoints" / f"{frame:06d}.bin"


def _trusted_frames(cache: Cache, frames: int) -> int:
    """Frames at the start of a cache that are there and match their digests."""
    try:
        digests = cache.digests()
    except EvidenceError:
        return 0
    for frame in range(min(len(digests), frames)):
        try:
            if cache.frame_digest(frame) != digests[frame]:
                return frame
        except EvidenceError:
            return frame
    return min(len(digests), frames)


def _resume(solver: Solver, cache: Cache, marks: list[int]) -> int:
    """Continue from the first of some checkpoints that is whole; its frame, or -1."""
    for mark in marks:
        try:
            solver.restore(checkpoint_path(cache.folder, mark).read_bytes(), mark)
        except (OSError, EngineError):
            continue
        return mark
    return -1


def run_frames(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    folder: Path,
    *,
    frames: int,
    progress: Callable[[int, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
) -> dict[str, Cache]:
    """Simulate frames 0 to `frames` - 1 of every instance into `folder/<solver>/`, resuming what is there.

    Args:
        spec: the specification.
        built: its geometry.
        folder: where the caches go.
        frames: how many frames.
        progress: called with (done, total, message).
        check: called between frames; raises to stop.

    Raises:
        InputError: an instance cannot be prepared.
        EngineError: a solver failed.
    """
    order = audit(spec).bake_order
    caches: dict[str, Cache] = {}
    total = frames * len(order)
    for rank, name in enumerate(order):
        cache = caches[name] = Cache(folder / name)
        trusted = _trusted_frames(cache, frames)
        solver = make_solver(spec, built, name)
        solver.prepare()
        cache.write_index(dataclasses.replace(solver.index(), frames=frames))
        if trusted >= frames:
            continue
        marks = set(checkpoint_frames(spec, frames))
        start = _resume(solver, cache, [k for k in sorted(marks, reverse=True) if k < trusted])
        if start < 0 and trusted > 0:
            solver = make_solver(spec, built, name)
            solver.prepare()
        cache.begin_digests(cache.digests()[: start + 1] if start >= 0 else [])
        for frame in range(start + 1, frames):
            if frame > 0:
                solver.advance(frame)
            cache.add_digest(write_container(cache.path(frame), solver.frame_data()))
            if frame in marks:
                write_atomically(checkpoint_path(cache.folder, frame), solver.checkpoint())
            if progress is not None:
                progress(rank * frames + frame + 1, total, f"{name}: frame {frame + 1} of {frames}")
            if check is not None:
                check()
    return caches

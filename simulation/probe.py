"""Probes (R76-R79): short runs of the production settings, and replays of baked intervals."""

from __future__ import annotations

import dataclasses
import math
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..worlds.bake_plan import checkpoint_frames, groups_of
from ..worlds.built import BuiltEntity
from ..worlds.cache import Cache, digest_arrays
from ..worlds.candidate import Candidate, open_candidate, recorded_inputs
from ..worlds.coarsening import coarsened, read_overrides, write_overrides
from ..worlds.errors import EngineError, EvidenceError
from ..worlds.folder import WorldFolder
from ..worlds.probe_length import probe_frames
from ..worlds.settled import SettledFrames
from .origins import Origins, checkpoint_path
from .protocol import Solver
from .runs import Run, make_run, reads
from .schedule import run_frames
from .settling import Settled, settle

__all__ = ["positions_of", "replay", "run_probe"]


def run_probe(
    folder: WorldFolder,
    freeze: str,
    *,
    built: Mapping[str, BuiltEntity] | None = None,
    overrides: Mapping[str, float] | None = None,
    progress: Callable[[float, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
) -> Candidate:
    """Run the probe of a freeze and open it for checking.

    `built` are entities at hand, which need not be read again (`recorded_inputs`). `overrides` are settings that it leaves coarser than production (`worlds/coarsening.py`); frames of a probe with others go.
    """
    spec, found = recorded_inputs(folder, freeze, built)
    root, wanted = folder.candidate(freeze) / "probe", dict(overrides or {})
    spec = coarsened(spec, wanted)
    if _recorded(root) != wanted:
        _discard(root)
        write_overrides(root, wanted)
    run_frames(spec, found, root, frames=probe_frames(spec), progress=progress, check=check, reuse=Origins(root, spec, found))
    return open_candidate(folder, freeze, "probe", found)


def _discard(root: Path) -> None:
    """Take a folder away as a whole: frames that a kill left without the record of their settings would pass for others."""
    gone = root.with_name(f".{root.name}.gone")
    shutil.rmtree(gone, ignore_errors=True)  # what an earlier kill left
    if root.exists():
        root.rename(gone)
    shutil.rmtree(gone, ignore_errors=True)


def _recorded(root: Path) -> dict[str, float] | None:
    try:
        return read_overrides(root)
    except EvidenceError:
        return None


def replay(
    candidate: Candidate,
    *,
    intervals: int,
    seed: int,
    also: frozenset[int] = frozenset(),
    progress: Callable[[float, float, str], None] | None = None,
) -> list[dict[str, object]]:
    """Re-simulate randomly chosen checkpoint intervals of a bake and compare bytes (acceptance and replay).

    The start is compared too: what the rows of the cache stand for, frame 0 and its checkpoint. Each interval ends at the
    checkpoint that the next one starts from, so that no link of the chain is taken on trust. Intervals that begin at the
    frames of `also` are simulated besides.

    Returns one record per interval: solver, first and last frame, whether all frames equal the cache, the first that does
    not, and by how much positions differ [m] (None where they cannot be compared).

    Raises:
        EvidenceError: a checkpoint is missing.
    """
    rng = np.random.default_rng(seed)
    results: list[dict[str, object]] = []
    # In the order of the specification, so that the same intervals are drawn for the same seed.
    groups = sorted(groups_of(candidate.spec), key=lambda group: min(list(candidate.caches).index(n) for n in group))
    for gone, names in enumerate(groups):
        caches = {n: candidate.caches[n] for n in names}
        count = min(c.index.frames for c in caches.values())
        marks = checkpoint_frames(candidate.spec, count)
        drawn = rng.choice(marks, size=min(intervals, len(marks)), replace=False).tolist()
        chosen = sorted({*drawn, *(also & set(marks))})
        settled = _settled_again(candidate, names, progress, gone / len(groups))
        run = make_run(candidate.spec, candidate.built, names, caches=candidate.caches, settled=settled.states)
        run.prepare()
        results += [_replay_start(run.solvers[n], c, settled.digests.get(n, ())) for n, c in caches.items()]
        ends = dict(zip(marks, [*marks[1:], count - 1], strict=True))
        for rank, start in enumerate(chosen):
            share = 1.0 / len(chosen) / len(groups)
            tell = _teller(progress, names, (gone / len(groups) + rank * share, share), (start, ends[start]))
            results += _replay_interval(run, caches, start, ends[start], set(marks), tell)
    return results


def _settled_again(
    candidate: Candidate, names: tuple[str, ...], progress: Callable[[float, float, str], None] | None, before: float
) -> Settled:
    """The end of the settle run of a group, simulated anew; `before`: where its replay begins in the whole."""

    def tell(share: float, doing: str) -> None:
        if progress is not None:
            progress(before, 1.0, f"replaying {' and '.join(names)}: {doing}")

    read = {n: candidate.caches[n] for n in reads(candidate.spec, *names)}
    return settle(candidate.spec, candidate.built, names, read=read, tell=tell)


def _teller(
    progress: Callable[[float, float, str], None] | None,
    names: tuple[str, ...],
    part: tuple[float, float],
    interval: tuple[int, int],
) -> Callable[[int], None]:
    """Takes the frames of an interval; `part`: where it begins in the whole replay, and its share of it."""
    (before, share), (start, end) = part, interval

    def tell(frame: int) -> None:
        if progress is not None:
            done = before + share * (frame - start) / max(1, end - start)
            progress(done, 1.0, f"replaying {' and '.join(names)}: frame {frame} of {start} to {end}")

    return tell


def _checkpoint(cache: Cache, frame: int) -> bytes:
    try:
        return checkpoint_path(cache.folder, frame).read_bytes()
    except OSError as error:
        raise EvidenceError(f"checkpoint of frame {frame} is missing from {cache.folder.name!r}; bake again") from error


def _replay_start(solver: Solver, cache: Cache, settled: Sequence[str]) -> dict[str, object]:
    """Record of frame 0; `settled` are the digests of the last frames in which it came to rest, where it did."""
    index = dataclasses.replace(solver.index(), frames=cache.index.frames)
    data = dict(solver.frame_data())
    kept = SettledFrames(cache)
    rest = [kept.files.frame_digest(k) for k in range(kept.files.index.frames)] if kept.there() else []
    same = index == cache.index and digest_arrays(data) == cache.frame_digest(0) and solver.checkpoint() == _checkpoint(cache, 0)
    same = same and rest == [*settled]
    # What the rows stand for is the same on every machine; only the versions beside it are not.
    alike = dataclasses.replace(index, versions=cache.index.versions) == cache.index
    return {
        "solver": cache.index.solver,
        "frames": [0, 0],
        "identical": same,
        "alike": alike,
        "first_different_frame": None if same else 0,
        "largest_difference_m": 0.0 if same else _apart(cache, 0, data),
    }


def positions_of(data: Mapping[str, Any]) -> str:
    """Name of the channel that tells where the things of an instance are, or how they move where cells hold them."""
    if len(data.get("position", ())):
        return "position"
    return next((n for n in ("vertex/position", "particle/position", "gas_velocity") if n in data), "position")


def _apart(cache: Cache, frame: int, data: Mapping[str, Any]) -> float | None:
    """Largest distance [m] between positions simulated and cached; None where they cannot be compared."""
    name = positions_of(data)
    stored = cache.read(frame, (name,))[name]
    if stored.shape != data[name].shape:
        return None
    distance = float(np.abs(data[name] - stored).max(initial=0.0))
    return distance if math.isfinite(distance) else None


def _replay_interval(
    run: Run, caches: Mapping[str, Cache], start: int, end: int, marks: set[int], tell: Callable[[int], None]
) -> list[dict[str, object]]:
    """One record per instance of the run."""
    try:
        run.restore({n: _checkpoint(c, start) for n, c in caches.items()}, start)
    except EngineError as error:
        return [
            {
                "solver": cache.index.solver,
                "frames": [start, end],
                "identical": False,
                "first_different_frame": start,
                "largest_difference_m": None,
                "reason": str(error),
            }
            for cache in caches.values()
        ]
    first_bad: dict[str, int] = {}
    apart: dict[str, list[float | None]] = {n: [] for n in caches}
    for frame in range(start + 1, end + 1):
        run.advance(frame)
        for name, cache in caches.items():
            data = dict(run.solvers[name].frame_data())
            if digest_arrays(data) != cache.frame_digest(frame):
                first_bad.setdefault(name, frame)
                apart[name].append(_apart(cache, frame, data))
        tell(frame)
    for name, cache in caches.items():
        if end in marks and name not in first_bad and run.solvers[name].checkpoint() != _checkpoint(cache, end):
            first_bad[name] = end
    return [
        {
            "solver": cache.index.solver,
            "frames": [start, end],
            "identical": name not in first_bad,
            "first_different_frame": first_bad.get(name),
            "largest_difference_m": None if None in apart[name] else max((d for d in apart[name] if d is not None), default=0.0),
        }
        for name, cache in caches.items()
    ]

"""Probes (R76-R79): short runs of the production settings, and replays of baked intervals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..worlds.built import BuiltEntity, load_built
from ..worlds.cache import Cache, digest_arrays
from ..worlds.candidate import Candidate, open_candidate
from ..worlds.errors import EvidenceError
from ..worlds.folder import WorldFolder
from ..worlds.patch import parse_spec
from ..worlds.spec import WorldSpec
from .protocol import Solver
from .schedule import checkpoint_frames, make_solver, run_frames

__all__ = ["probe_frames", "recorded_inputs", "replay", "run_probe"]

SETTLING_SECONDS = 0.75
"""Simulated after the last beat's end, so that early settling can be seen [s]."""


def probe_frames(spec: WorldSpec) -> int:
    """Frames a probe of this world needs: through its last beat, and early settling.

    Rigid contact depends on its step, so a rigid probe keeps every production setting and shortens the interval only.
    """
    plan = spec.simulation
    last = max((b.frames[1] for b in spec.story.beats.values()), default=plan.frames - 1)
    return min(plan.frames, last + 1 + round(SETTLING_SECONDS * plan.fps))


def run_probe(
    folder: WorldFolder,
    freeze: str,
    *,
    progress: Callable[[int, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
) -> Candidate:
    """Run the probe of a freeze and open it for checking."""
    spec, built = recorded_inputs(folder, freeze)
    root = folder.candidate(freeze) / "probe"
    run_frames(spec, built, root, frames=probe_frames(spec), progress=progress, check=check)
    return open_candidate(folder, freeze, "probe")


def recorded_inputs(folder: WorldFolder, freeze: str) -> tuple[WorldSpec, dict[str, BuiltEntity]]:
    """Specification and geometry that a freeze recorded."""
    record = folder.read_json(folder.candidate(freeze) / "candidate.json")
    return parse_spec(record["spec"]), {name: load_built(folder.root / file) for name, (file, _) in record["built"].items()}


def replay(candidate: Candidate, *, intervals: int, seed: int) -> list[dict[str, object]]:
    """Re-simulate randomly chosen checkpoint intervals of a bake and compare bytes (acceptance and replay).

    Returns one record per interval: solver, first and last frame, whether all frames equal the cache, and the first
    that does not.

    Raises:
        EvidenceError: a checkpoint is missing.
    """
    rng = np.random.default_rng(seed)
    results: list[dict[str, object]] = []
    for name, cache in candidate.caches.items():
        marks = checkpoint_frames(candidate.spec, cache.index.frames)
        chosen = sorted(rng.choice(marks, size=min(intervals, len(marks)), replace=False).tolist())
        solver = make_solver(candidate.spec, candidate.built, name)
        solver.prepare()
        ends = {m: n for m, n in zip(marks, [*marks[1:], cache.index.frames - 1], strict=True)}
        for start in chosen:
            results.append(_replay_interval(solver, cache, start, ends[start]))
    return results


def _replay_interval(solver: Solver, cache: Cache, start: int, end: int) -> dict[str, object]:
    path = cache.folder / "checkpoints" / f"{start:06d}.bin"
    if not path.exists():
        raise EvidenceError(f"checkpoint of frame {start} is missing from {cache.folder.name!r}; bake again")
    solver.restore(path.read_bytes(), start)
    first_bad = None
    worst = 0.0
    for frame in range(start + 1, end + 1):
        solver.advance(frame)
        data = dict(solver.frame_data())
        if digest_arrays(data) != cache.frame_digest(frame):
            first_bad = frame if first_bad is None else first_bad
            stored = cache.read(frame, ("position",))["position"]
            worst = max(worst, float(np.abs(data["position"] - stored).max(initial=0.0)))
    return {
        "solver": cache.index.solver,
        "frames": [start, end],
        "identical": first_bad is None,
        "first_different_frame": first_bad,
        "largest_difference_m": worst,
    }

"""Variants of a run that was made: the same world with something in it prevented, or with other start values.

Verifiers use them to ask what would have happened (counterfactuals, robustness). A variant lives in memory, so that
whoever judges a world writes nothing into it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..worlds.built import BuiltEntity
from ..worlds.cache import Cache, CacheIndex
from ..worlds.candidate import Candidate
from ..worlds.errors import EngineError, EvidenceError, InputError
from ..worlds.fields import acting_on
from ..worlds.spec import FieldDriver, WorldSpec
from .probe import positions_of
from .protocol import Intervention, Solver
from .runs import Run, groups_of, make_run, reads
from .schedule import checkpoint_frames, checkpoint_path

__all__ = ["CONTINUES", "first_frame", "run_altered", "run_variant"]

CONTINUES = 1e-4
"""[m] A run that goes on from a checkpoint may differ from its cache by so much at the frame where the variant begins. Equal
bytes are expected on the device that baked it; another device rounds otherwise, for at most `CHECKPOINT_SECONDS`. Own choice:
a tenth of the summed skins."""


class _VariantCache(Cache):
    """Frames of a variant: the original's up to the first one of its own, then its own, which are kept in memory."""

    def __init__(self, original: Cache, index: CacheIndex, own: Mapping[int, Mapping[str, Any]]) -> None:
        super().__init__(original.folder)
        vars(self)["index"] = index
        self._original, self._own = original, own
        self._first = min(own, default=index.frames)
        self._kept: dict[Any, Any] = {}

    def read(self, frame: int, names: Iterable[str] | None = None) -> dict[str, Any]:
        """Channels of one frame."""
        if frame not in self._own:
            return self._original.read(frame, names)
        data = self._own[frame]
        missing = [n for n in (names or ()) if n not in data]
        if missing:
            raise EvidenceError(f"the variant's frames lack channels {missing}")
        return {n: data[n] for n in (data if names is None else names)}

    def series(self, name: str) -> Any:
        """One channel over all frames."""
        if name not in self._kept:
            own = [np.asarray(self.read(k, (name,))[name])[None] for k in range(self._first, self.index.frames)]
            self._kept[name] = np.concatenate([self._original.series(name)[: self._first], *own] if self._first else own)
        return self._kept[name]

    def ragged(self, *names: str) -> list[dict[str, Any]]:  # type: ignore[override]
        """Channels of varying length, one dict per frame."""
        if names not in self._kept:
            before = self._original.ragged(*names)[: self._first] if self._first else []
            self._kept[names] = [*before, *(self.read(k, names) for k in range(self._first, self.index.frames))]
        kept: list[dict[str, Any]] = self._kept[names]
        return kept


def _nearest_checkpoint(candidate: Candidate, cache: Cache, frame: int) -> int:
    """Last frame up to `frame` with a checkpoint.

    Raises:
        EvidenceError: there is none.
    """
    for mark in reversed(checkpoint_frames(candidate.spec, frame + 1)):
        if checkpoint_path(cache.folder, mark).is_file():
            return mark
    raise EvidenceError(
        f"cache {cache.folder.name!r} has no checkpoint up to frame {frame}, so nothing can be simulated again; probe and bake again"
    )


def first_frame(candidate: Candidate, start: int) -> int:
    """Frame from which a variant that begins at `start` is simulated: the earliest of its instances' checkpoints.

    Raises:
        EvidenceError: an instance has no checkpoint up to there.
    """
    return min((_nearest_checkpoint(candidate, c, start) for c in candidate.caches.values()), default=0)


def _concerned(spec: WorldSpec, name: str, done: Intervention) -> bool:
    """Whether an intervention touches an instance."""
    plan = spec.simulation
    members = set(plan.solvers[name].members)
    drivers = [plan.drivers[d] for d in done.without if d in plan.drivers]
    joints = [plan.joints[d.joint].child for d in drivers if hasattr(d, "joint") and d.joint in plan.joints]
    blown = {e for d in drivers if isinstance(d, FieldDriver) for e in acting_on(spec, d)}
    driven = {*(getattr(d, "entity", None) for d in drivers), *joints, *blown}
    parted = any(set(pair) <= members or (name in plan.liquid and set(pair) & members) for pair in done.apart)
    return bool(members & (driven | done.held)) or parted


def run_variant(candidate: Candidate, done: Intervention, *, start: int, end: int) -> Candidate:
    """The candidate as it goes on from frame `start` to `end` under an intervention; frames up to `start` are its own.

    Raises:
        EvidenceError: there is no checkpoint to start from, the cache is not what its checkpoint leads to, or the variant
            cannot be simulated.
    """
    spec = candidate.spec
    caches: dict[str, Cache] = {}
    changed: set[str] = set()
    for names in groups_of(spec):
        own = {n: candidate.caches[n] for n in names}
        if not any(_concerned(spec, n, done) or changed & set(reads(spec, n)) for n in names):
            caches |= {n: _VariantCache(c, dataclasses.replace(c.index, frames=end + 1), {}) for n, c in own.items()}
            continue
        changed |= set(names)
        mark = min(_nearest_checkpoint(candidate, c, start) for c in own.values())
        frames: dict[str, dict[int, Mapping[str, Any]]] = {n: {} for n in names}
        try:
            states = {n: checkpoint_path(c.folder, mark).read_bytes() for n, c in own.items()}
            if done.apart and mark < start:
                # Pairs that rest on each other until then must not part before.
                states, mark = _states_at(candidate, own, states, (mark, start)), start
            run = make_run(spec, candidate.built, names, caches=caches, intervention=done)
            run.prepare(resumed=True)
            run.restore(states, mark)
            for frame in range(mark + 1, end + 1):
                run.advance(frame)
                for name, cache in own.items():
                    if frame == start:
                        _require_same(cache, run.solvers[name], frame)
                    elif frame > start:
                        frames[name][frame] = _finite(run.solvers[name], frame)
        except (EngineError, InputError, OSError) as error:
            raise EvidenceError(f"the run cannot be repeated: {error}") from error
        caches |= {n: _VariantCache(c, dataclasses.replace(c.index, frames=end + 1), frames[n]) for n, c in own.items()}
    caches = {n: caches[n] for n in candidate.caches}
    return dataclasses.replace(candidate, caches=caches, digest=f"{candidate.digest}+variant", apart=done.apart)


def _states_at(
    candidate: Candidate, caches: Mapping[str, Cache], states: Mapping[str, bytes], frames: tuple[int, int]
) -> dict[str, bytes]:
    """The states at the second frame of the untouched run, from those at the first."""
    run: Run = make_run(candidate.spec, candidate.built, tuple(caches), caches=candidate.caches)
    run.prepare(resumed=True)
    run.restore(states, frames[0])
    for frame in range(frames[0] + 1, frames[1] + 1):
        run.advance(frame)
    for name, cache in caches.items():
        _require_same(cache, run.solvers[name], frames[1])
    return {n: s.checkpoint() for n, s in run.solvers.items()}


def run_altered(candidate: Candidate, spec: WorldSpec, built: Mapping[str, BuiltEntity], *, end: int) -> Candidate:
    """The candidate's world with another specification of the same bodies, simulated from frame 0 to `end`.

    Raises:
        EvidenceError: it cannot be simulated.
    """
    caches: dict[str, Cache] = {}
    for names in groups_of(spec):
        frames: dict[str, dict[int, Mapping[str, Any]]] = {n: {} for n in names}
        try:
            run = make_run(spec, built, names, caches=caches)
            run.prepare()
            for frame in range(end + 1):
                if frame:
                    run.advance(frame)
                for name in names:
                    frames[name][frame] = _finite(run.solvers[name], frame)
        except (EngineError, InputError) as error:
            raise EvidenceError(f"the altered world cannot be simulated: {error}") from error
        for name in names:
            cache = candidate.caches[name]
            caches[name] = _VariantCache(cache, dataclasses.replace(cache.index, frames=end + 1), frames[name])
    caches = {n: caches[n] for n in candidate.caches}
    return dataclasses.replace(candidate, spec=spec, built=built, caches=caches, digest=f"{candidate.digest}+altered")


def _finite(solver: Solver, frame: int) -> Mapping[str, Any]:
    data = solver.frame_data()
    if not np.isfinite(data[positions_of(data)]).all():
        raise EngineError(f"coordinates are not finite at frame {frame}")
    return data


def _require_same(cache: Cache, solver: Solver, frame: int) -> None:
    """That the checkpoint led to where the cache says the bodies are."""
    name = positions_of(solver.frame_data())
    stored, found = cache.read(frame, (name,))[name], solver.frame_data()[name]
    apart = float(np.abs(stored - found).max(initial=0.0)) if stored.shape == found.shape else np.inf
    if not apart <= CONTINUES:
        raise EvidenceError(
            f"frame {frame} of {cache.folder.name!r} is {apart:.3g} m (allowed {CONTINUES:g} m) from what its checkpoint leads to; "
            "it was altered, or baked by another version: probe and bake again"
        )

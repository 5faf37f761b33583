"""Variants of a run that was made: the same world with something in it prevented, or with other start values.

Verifiers use them to ask what would have happened (counterfactuals, robustness). A group of instances is simulated when one of
its frames is first read: what nobody asks about costs nothing. A variant lives in memory, so that whoever judges a world writes
nothing into it, unless the candidate names a folder for `kept_runs`.
"""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import numpy as np

from ..worlds.bake_plan import checkpoint_frames, groups_of
from ..worlds.built import BuiltEntity
from ..worlds.cache import Cache, CacheIndex
from ..worlds.candidate import Candidate
from ..worlds.canonical import digest_of
from ..worlds.common_past import settings_until
from ..worlds.errors import EngineError, EvidenceError, InputError
from ..worlds.fields import acting_on
from ..worlds.spec import FieldDriver, WorldSpec
from .kept_runs import KeptRuns
from .origins import checkpoint_path
from .probe import positions_of
from .protocol import Intervention, Solver
from .recipes import coupled_recipe, recipe_of
from .runs import Run, make_run, reads
from .settling import settle

__all__ = ["CONTINUES", "first_frame", "run_altered", "run_variant", "simulated"]

CONTINUES = 1e-4
"""[m] A run that goes on from a checkpoint may differ from its cache by so much at the frame where the variant begins. Equal
bytes are expected on the device that baked it; another device rounds otherwise, for at most `CHECKPOINT_SECONDS`. Own choice:
a tenth of the summed skins."""


Tell = Callable[[int, int, str], None]
"""Takes (done, total, message) after every simulated frame."""
_Own = dict[str, dict[int, Mapping[str, Any]]]


class _Once:
    """The value of a function, or the evidence that it found missing: it is called at the first question, and once."""

    def __init__(self, make: Callable[[], _Own]) -> None:
        self._make = make
        self._found: _Own | EvidenceError | None = None

    def __call__(self) -> _Own:
        if self._found is None:
            try:
                self._found = self._make()
            except EvidenceError as error:
                self._found = error
        if isinstance(self._found, EvidenceError):
            raise self._found
        return self._found

    @property
    def done(self) -> bool:
        """True if it was asked and gave something."""
        return isinstance(self._found, dict)


class _VariantCache(Cache):
    """Frames of a variant: the original's up to the first one of its own, then its own, which are kept in memory."""

    def __init__(self, original: Cache, name: str, index: CacheIndex, first: int, frames: _Once | None = None) -> None:
        super().__init__(original.folder)
        vars(self)["index"] = index
        self._original, self._name, self._first, self.frames = original, name, first, frames
        self._kept: dict[Any, Any] = {}

    def read(self, frame: int, names: Iterable[str] | None = None) -> dict[str, Any]:
        """Channels of one frame."""
        if frame < self._first or self.frames is None:
            return self._original.read(frame, names)
        data = self.frames()[self._name].get(frame)
        if data is None:
            raise EvidenceError(f"the variant ends before frame {frame}")
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
    """True if an intervention touches an instance."""
    plan = spec.simulation
    members = set(plan.solvers[name].members)
    drivers = [plan.drivers[d] for d in done.without if d in plan.drivers]
    joints = [plan.joints[d.joint].child for d in drivers if hasattr(d, "joint") and d.joint in plan.joints]
    blown = {e for d in drivers if isinstance(d, FieldDriver) for e in acting_on(spec, d)}
    driven = {*(getattr(d, "entity", None) for d in drivers), *joints, *blown}
    parted = any(set(pair) <= members or (name in plan.liquid and set(pair) & members) for pair in done.apart)
    return bool(members & (driven | done.held)) or parted


def run_variant(candidate: Candidate, done: Intervention, *, start: int, end: int, progress: Tell | None = None) -> Candidate:
    """The candidate as it goes on from frame `start` to `end` under an intervention; frames up to `start` are its own.

    A group of instances is simulated when one of its later frames is first read; that read raises EvidenceError where there is no
    checkpoint to start from, the cache is not what its checkpoint leads to, or the variant cannot be simulated.
    """
    spec = candidate.spec
    caches: dict[str, Cache] = {}
    changed: set[str] = set()
    for names in groups_of(spec):
        own = {n: candidate.caches[n] for n in names}
        frames = None
        if any(_concerned(spec, n, done) or changed & set(reads(spec, n)) for n in names):
            changed |= set(names)
            frames = _Once(partial(_continued, candidate, own, dict(caches), done, (start, end), progress))
        for name, cache in own.items():
            index = dataclasses.replace(cache.index, frames=end + 1)
            caches[name] = _VariantCache(cache, name, index, end + 1 if frames is None else start + 1, frames)
    caches = {n: caches[n] for n in candidate.caches}
    return dataclasses.replace(candidate, caches=caches, digest=f"{candidate.digest}+variant", apart=done.apart)


def simulated(variant: Candidate) -> tuple[str, ...]:
    """Instances of a variant that were simulated so far, because somebody read what they do in it."""
    return tuple(n for n, c in variant.caches.items() if isinstance(c, _VariantCache) and c.frames is not None and c.frames.done)


def _continued(
    candidate: Candidate,
    own: Mapping[str, Cache],
    read: Mapping[str, Cache],
    done: Intervention,
    span: tuple[int, int],
    progress: Tell | None,
) -> _Own:
    """Frames after the first of the span, up to its last, of one group under an intervention; `read` are caches of those before it."""
    start, end = span
    mark = min(_nearest_checkpoint(candidate, c, start) for c in own.values())
    frames: _Own = {n: {} for n in own}
    try:
        states = {n: checkpoint_path(c.folder, mark).read_bytes() for n, c in own.items()}
        kept = KeptRuns(candidate.variants)
        recipe = "" if candidate.variants is None else _recipe(candidate, own, read, states, done, span)
        found = kept.find(recipe)
        if found is not None and all(set(found.get(n, ())) == set(range(start + 1, end + 1)) for n in own):
            return found
        if done.apart and mark < start:
            # Pairs that rest on each other until then must not part before.
            states, mark = _states_at(candidate, own, states, (mark, start)), start
        run = make_run(candidate.spec, candidate.built, tuple(own), caches=read, intervention=done)
        run.prepare(resumed=True)
        run.restore(states, mark)
        for frame in range(mark + 1, end + 1):
            run.advance(frame)
            for name, cache in own.items():
                if frame == start:
                    _require_same(cache, run.solvers[name], frame)
                elif frame > start:
                    frames[name][frame] = _finite(run.solvers[name], frame)
            _tell(progress, tuple(own), frame - mark, end - mark)
    except (EngineError, InputError, OSError) as error:
        raise EvidenceError(f"the run cannot be repeated: {error}") from error
    kept.keep(recipe, frames)
    return frames


def _tell(progress: Tell | None, names: tuple[str, ...], done: int, total: int) -> None:
    if progress is not None:
        progress(done, total, f"{' and '.join(names)}: frame {done} of {total}")


def _recipe(
    candidate: Candidate,
    own: Mapping[str, Cache],
    read: Mapping[str, Cache],
    states: Mapping[str, bytes],
    done: Intervention,
    span: tuple[int, int],
) -> str:
    """Hash of all that the frames of a group follow from: settings up to its end, geometry, engines, the run that it continues, the frames that
    it reads, what is prevented."""
    spec = candidate.spec
    checkpoints = {n: hashlib.sha256(s).hexdigest() for n, s in states.items()}
    # As they are, not as they were recorded: a run is not continued from a frame that was altered.
    begins = {n: c.frame_digest(span[0]) for n, c in own.items()}
    prevented = {k: sorted(v) if isinstance(v, frozenset) else v for k, v in dataclasses.asdict(done).items()}
    settings = recipe_of(settings_until(spec, span[1] / spec.simulation.fps, done.without), candidate.built)
    met = {r: _read_recipe(candidate, read[r], span[1]) for n in own for r in reads(spec, n) if r in read}
    return digest_of("continued", settings, met, checkpoints, begins, prevented, span)


def _read_recipe(candidate: Candidate, cache: Cache, end: int) -> Any:
    """Digests of the frames of an instance that another one reads; where it is simulated anew too, all that the candidate is."""
    if isinstance(cache, _VariantCache) and cache.frames is not None:
        return candidate.digest
    return [cache.frame_digest(k) for k in range(end + 1)]


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


def run_altered(
    candidate: Candidate, spec: WorldSpec, built: Mapping[str, BuiltEntity], *, end: int, progress: Tell | None = None
) -> Candidate:
    """The candidate's world with another specification of the same bodies, simulated from frame 0 to `end`.

    Raises:
        EvidenceError: it cannot be simulated.
    """
    caches: dict[str, Cache] = {}
    kept = KeptRuns(candidate.variants)
    whole = "" if candidate.variants is None else digest_of("altered", coupled_recipe(spec, built), end)
    for names in groups_of(spec):
        recipe = digest_of(whole, names)
        frames = kept.find(recipe)
        if frames is None or any(set(frames.get(n, ())) != set(range(end + 1)) for n in names):
            frames = _from_start(spec, built, names, caches, end, progress)
            kept.keep(recipe, frames)
        for name in names:
            index = dataclasses.replace(candidate.caches[name].index, frames=end + 1)
            caches[name] = _VariantCache(candidate.caches[name], name, index, 0, _Once(partial(dict, frames)))
    caches = {n: caches[n] for n in candidate.caches}
    return dataclasses.replace(candidate, spec=spec, built=built, caches=caches, digest=f"{candidate.digest}+altered")


def _from_start(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    names: tuple[str, ...],
    caches: Mapping[str, Cache],
    end: int,
    progress: Tell | None,
) -> _Own:
    """All frames of one group."""
    frames: _Own = {n: {} for n in names}
    try:
        settled = settle(spec, built, names, read={n: caches[n] for n in reads(spec, *names)})
        run = make_run(spec, built, names, caches=caches, settled=settled.states)
        run.prepare()
        for frame in range(end + 1):
            if frame:
                run.advance(frame)
            for name in names:
                frames[name][frame] = _finite(run.solvers[name], frame)
            _tell(progress, names, frame, end)
    except (EngineError, InputError) as error:
        raise EvidenceError(f"the altered world cannot be simulated: {error}") from error
    return frames


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

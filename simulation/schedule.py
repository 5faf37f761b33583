"""The frame loop: advances the solver instances of a world in their declared order and writes their caches (R80)."""

from __future__ import annotations

import dataclasses
import shutil
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from ..worlds.bake_plan import checkpoint_frames, groups_of
from ..worlds.built import BuiltEntity
from ..worlds.cache import Cache, CacheIndex
from ..worlds.errors import EngineError, EvidenceError
from ..worlds.folder import write_atomically
from ..worlds.spec import WorldSpec
from ..worlds.writers import writers_of
from .origins import Offer, Origins, checkpoint_path, trusted_frames
from .protocol import Within
from .runs import Run, make_run, reads
from .settling import settle

__all__ = ["run_frames", "run_groups", "stretch_count"]

SLOW_FRAME_SECONDS = 2.0
"""A frame that takes longer tells how far it is and in what steps [s]: else a step that has become a thousand times shorter, or a frame
that is made again, looks like one that stands still. Own choice; the clock decides what is told, never what is computed."""


def _resume(run: Run, caches: Mapping[str, Cache], marks: list[int]) -> int:
    """Continue from the first of some checkpoints that all instances of a run have whole; its frame, or -1."""
    for mark in marks:
        try:
            run.restore({n: checkpoint_path(c.folder, mark).read_bytes() for n, c in caches.items()}, mark)
        except (OSError, EngineError):
            continue
        return mark
    return -1


def _cut(cache: Cache, *, whole: bool) -> None:
    """Take away what lies beyond the last frame of the index, where a longer run of the same motion stood; `whole`: all up to that is there."""
    for name in cache.beyond():
        (cache.folder / name).unlink()
    if whole and len(known := cache.digests()) > cache.index.frames:
        cache.begin_digests(known[: cache.index.frames])


def _take_over(cache: Cache, index: CacheIndex) -> Path | None:
    """Take an equal liquid's cache from another candidate of this world; its folder there, if there is one.

    Equal means the same recipe: nothing that reaches its domain differs, whatever else of the world does.
    """
    stage = cache.folder.parent
    for other in sorted(stage.parent.parent.glob(f"*/{stage.name}/{cache.folder.name}")):
        there = Cache(other)
        try:
            if other == cache.folder or there.index != index or trusted_frames(there, index.frames) < index.frames:
                continue
        except EvidenceError:
            continue
        shutil.rmtree(cache.folder, ignore_errors=True)
        shutil.copytree(other, cache.folder)
        return other
    return None


def _taken(
    caches: Mapping[str, Cache], indices: Mapping[str, CacheIndex], offers: list[Offer], trusted: int, reuse: bool | Origins
) -> int:
    """Frames at the start of a group's caches that are to be trusted after some were taken from other runs; before, there were `trusted`."""
    (name, cache), *others = caches.items()
    frames, origins = indices[name].frames, reuse if isinstance(reuse, Origins) else None
    for offer in offers:
        if trusted < offer.frames and origins is not None:
            trusted = max(trusted, origins.take(offer, caches, indices, trusted))
    if not reuse or trusted >= frames or others or not indices[name].settings:
        return trusted
    other = _take_over(cache, indices[name])
    if other is not None and origins is not None:
        origins.took({name: Cache(other)}, frames)
    return trusted if other is None else frames


def stretch_count(spec: WorldSpec) -> int:
    """In how many equal stretches `run_frames` tells its progress: one per group of instances, then surfaces and wet maps of liquids."""
    return len(groups_of(spec)) + 2 * bool(spec.simulation.liquid)


def run_frames(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    folder: Path,
    *,
    frames: int,
    progress: Callable[[float, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
    reuse: bool | Origins = True,
    earlier: Mapping[str, Cache] | None = None,
) -> dict[str, Cache]:
    """Simulate frames 0 to `frames` - 1 of every instance into `folder/<solver>/`, and the surfaces and wet maps of liquids, resuming what is there.

    Args:
        spec: the specification.
        built: its geometry.
        folder: where the caches go.
        frames: how many frames.
        progress: called with (done, total, message); `done` may fall where a frame is made again.
        check: called between frames and within them; raises to stop.
        reuse: whether a liquid's frames may come from another candidate; not where nothing else is to be trusted. Other runs of this world:
            also any frames of theirs that are the same here.
        earlier: caches of another run of this specification and geometry, whose surfaces and wet maps are taken where all its frames
            are those of this run.

    Raises:
        InputError: an instance cannot be prepared.
        EngineError: a solver failed.
    """
    groups, stretches = groups_of(spec), stretch_count(spec)

    def tell(stretch: int, done: float, total: int, message: str) -> None:
        if progress is not None:
            progress(stretch * total + done, stretches * total, message)

    caches = run_groups(spec, built, folder, frames=frames, tell=tell, check=check, reuse=reuse)
    if spec.simulation.liquid:
        from .surfaces import map_wet_solids, mesh_liquids, take_made, take_surfaces

        take_made(spec, caches, earlier or {})
        if isinstance(reuse, Origins):
            take_surfaces(spec, caches, reuse)
        mesh_liquids(spec, built, caches, progress=partial(tell, len(groups)), check=check)
        map_wet_solids(spec, built, caches, progress=partial(tell, len(groups) + 1), check=check)
    return caches


def run_groups(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    folder: Path,
    *,
    frames: int,
    tell: Callable[[int, float, int, str], None],
    check: Callable[[], None] | None = None,
    reuse: bool | Origins = True,
    only: frozenset[str] | None = None,
) -> dict[str, Cache]:
    """Simulate frames of instances into `folder/<solver>/`, group after group, without surfaces; arguments and errors as `run_frames`.

    `tell` takes (rank of the group, done, total, message). `only` names instances: the groups of these run, and those that they read.
    """
    caches: dict[str, Cache] = {}
    wanted = None if only is None else _with_read(spec, only)
    for rank, names in enumerate(groups_of(spec)):
        if wanted is not None and wanted.isdisjoint(names):
            continue
        say = _Frames(partial(tell, rank), check, names, frames)
        caches |= _run_group(spec, built, {n: Cache(folder / n) for n in names}, caches, frames=frames, say=say, reuse=reuse)
    return caches


def _with_read(spec: WorldSpec, names: frozenset[str]) -> frozenset[str]:
    """Some instances, those that they read, those that these read, and so on."""
    found, more = names, names
    while more:
        more = frozenset(r for group in groups_of(spec) if not more.isdisjoint(group) for r in reads(spec, *group)) - found
        found |= more
    return found


class _Frames:
    """Tells of the frames of one group, and how far one is that takes long.

    Args:
        tell: takes (done, total, message).
        check: raises to stop.
        names: of the group's instances.
        count: of all frames.
    """

    def __init__(
        self, tell: Callable[[float, int, str], None], check: Callable[[], None] | None, names: tuple[str, ...], count: int
    ) -> None:
        self._tell, self._check, self._count = tell, check, count
        self._who = " and ".join(names)
        self._since = time.monotonic()

    def reached(self, frame: int) -> None:
        """A frame is written."""
        self._say(frame + 1, f"frame {frame + 1} of {self._count}")
        self._since = time.monotonic()

    def preroll(self, share: float, doing: str) -> None:
        """The preroll goes on, which comes before the frames."""
        self.before(share, f"{share:.0%} of the preroll, {doing}")

    def before(self, share: float, doing: str) -> None:
        """The settle run, or what else comes before the frames, goes on."""
        self._say(0.0, doing)
        self._since = time.monotonic()

    def within(self, frame: int) -> Within:
        """A function that takes how far a frame is."""

        def tell(share: float, doing: str) -> None:
            if time.monotonic() - self._since >= SLOW_FRAME_SECONDS:
                self._say(frame + share, f"{share:.1%} of frame {frame + 1} of {self._count}, {doing}")
            elif self._check is not None:
                self._check()

        return tell

    def _say(self, done: float, text: str) -> None:
        self._tell(done, self._count, f"{self._who}: {text}")
        if self._check is not None:
            self._check()


def _run_group(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    caches: dict[str, Cache],
    done: Mapping[str, Cache],
    *,
    frames: int,
    say: _Frames,
    reuse: bool | Origins,
) -> dict[str, Cache]:
    """Simulate one group into its caches; `done` are those of the groups before it."""
    names, origins = tuple(caches), reuse if isinstance(reuse, Origins) else None
    trusted = min(trusted_frames(c, frames) for c in caches.values())
    offers = [] if origins is None or trusted >= frames else origins.offers(names, done, frames, trusted)
    read = {n: done[n] for n in reads(spec, *names)}
    say.before(0.0, "setting up the engines")
    settled = settle(spec, built, names, read=read, into=caches, reuse=bool(reuse), tell=say.before)
    run = make_run(spec, built, names, caches=done, settled=settled.states)
    # A checkpoint replaces the preroll.
    resumed = bool(trusted or offers)
    run.prepare(resumed=resumed, tell=say.preroll)
    indices = {n: dataclasses.replace(run.solvers[n].index(), frames=frames) for n in names}
    trusted = _taken(caches, indices, offers, trusted, reuse)
    for name, cache in caches.items():
        cache.write_index(indices[name])
    # A reader keeps the index that it saw first; another world's frames may have stood here.
    caches = {n: Cache(c.folder) for n, c in caches.items()}
    for cache in caches.values():
        _cut(cache, whole=trusted >= frames)
    if trusted >= frames:
        return caches
    marks = set(checkpoint_frames(spec, frames))
    start = _resume(run, caches, [k for k in sorted(marks, reverse=True) if k < trusted])
    if origins is not None:
        origins.keep_to(names, start + 1)
    if start < 0 and resumed:
        run = make_run(spec, built, names, caches=done, settled=settled.states)
        run.prepare(tell=say.preroll)
    writers = {name: writers_of(spec, name) for name in names}
    for cache in caches.values():
        cache.begin_digests(cache.digests()[: start + 1] if start >= 0 else [])
    for frame in range(start + 1, frames):
        if frame > 0:
            run.advance(frame, tell=say.within(frame))
        for name, cache in caches.items():
            cache.write(frame, run.solvers[name].frame_data(), writers[name])
        if frame in marks:
            for name, cache in caches.items():
                write_atomically(checkpoint_path(cache.folder, frame), run.solvers[name].checkpoint())
        say.reached(frame)
    return caches

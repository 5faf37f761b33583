"""Frames that a probe takes over from other probes of its world, where an edit acts later or not on an instance at all; and a bake from the
probe of its own settings.

A run goes on from the last checkpoint before the edit acts (`worlds/common_past.py`). Frames and checkpoints are taken as they are, by
hard link or copy, after their digests were compared; `taken.json` beside the instances says how many and from where. One channel is
laid out anew: `driver/active`, where a force was added or taken away, has a row for every driver.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import shutil
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..worlds.bake_plan import checkpoint_frames
from ..worlds.cache import DAMAGE, Cache, CacheIndex, write_container
from ..worlds.coarsening import coarsened, read_overrides
from ..worlds.common_past import Settings, alike_until, frames_alike
from ..worlds.errors import EvidenceError, SpecError
from ..worlds.folder import write_atomically
from ..worlds.patch import parse_spec
from .freeze import engine_versions, settings_hash, solver_source
from .runs import reads

if TYPE_CHECKING:
    from ..worlds.built import BuiltEntity
    from ..worlds.spec import WorldSpec

__all__ = ["Offer", "Origins", "Taken", "checkpoint_path", "taken_in", "trusted_frames"]

RECORD = "taken.json"
"""File in the folder of a probe that says which frames it took over."""
MOST_RECORDS = 8
"""Candidates that are looked at, the newest first: reading one of a thousand entities takes about a second. Own choice."""
ACTIVE = "driver/active"


class Taken(NamedTuple):
    """Frames at the start of an instance that were taken over."""

    origin: str
    """Folder of the run that they come from, relative to the candidates."""
    frames: int
    digest: str
    """SHA-256 over their digests there."""


class Origin(NamedTuple):
    """Another run of the world."""

    folder: Path
    name: str
    settings: Settings


class Offer(NamedTuple):
    """Frames at the start of a group that another run has in common with this one."""

    origin: Origin
    frames: int


def checkpoint_path(folder: Path, frame: int) -> Path:
    """File of the solver's state at a frame, in the folder of its cache."""
    return folder / "checkpoints" / f"{frame:06d}.bin"


def trusted_frames(cache: Cache, frames: int) -> int:
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


def taken_in(root: Path) -> dict[str, Taken]:
    """The frames that the run in a folder took over, by instance.

    Raises:
        EvidenceError: the record is damaged.
    """
    path = root / RECORD
    if not path.exists():
        return {}
    try:
        return {n: Taken(str(t["from"]), int(t["frames"]), str(t["digest"])) for n, t in json.loads(path.read_text()).items()}
    except DAMAGE as error:
        raise EvidenceError(f"{RECORD} of the {root.name} is damaged ({error}); call probe_sim again") from error


class Origins:
    """Probes of a world, whose frames another run of it may take. A bake is no origin: what acceptance may refute is not handed on.

    Args:
        root: folder of the run that takes, in the folder of its candidate.
        spec: that it simulates.
        built: its geometry.
        own: folder of a probe of just these settings, the only origin where it is given; else the probes of other candidates are.
    """

    def __init__(self, root: Path, spec: WorldSpec, built: Mapping[str, BuiltEntity], own: Path | None = None) -> None:
        self._root, self._probe = root, own
        self._own = Settings(spec, {n: b.digest() for n, b in built.items()})
        self._same: dict[tuple[str, str], int] = {}
        """Frames that instances have in common with an origin, whatever their digests say."""

    @cached_property
    def _known(self) -> list[Origin]:
        """Probes by the present engines whose records are whole, the newest first."""
        if self._probe is not None:
            return [Origin(self._probe, f"{self._probe.parent.name}/{self._probe.name}", self._own)]
        stage, records = self._root.name, []
        for path in self._root.parent.parent.glob("*/candidate.json"):
            try:
                if path.parent != self._root.parent and (path.parent / stage).is_dir():
                    records.append((path.stat().st_mtime_ns, path))
            except OSError:
                continue
        found = []
        for _, path in sorted(records, reverse=True)[:MOST_RECORDS]:
            settings, folder = _recorded(path), path.parent / stage
            try:
                if settings is not None:
                    settings = dataclasses.replace(settings, spec=coarsened(settings.spec, read_overrides(folder)))
                    found.append(Origin(folder, f"{path.parent.name}/{stage}", settings))
            except EvidenceError:
                continue
        return found

    def offers(self, names: tuple[str, ...], done: Mapping[str, Cache], frames: int, least: int) -> list[Offer]:
        """Runs that have more than `least` of the frames of a group in common with this one, the most first.

        `done` are the caches of the groups before it in this run.
        """
        spec = self._own.spec
        read = reads(spec, *names)
        found = []
        for origin in self._known:
            alike = frames_alike(alike_until(origin.settings, self._own, names, read), spec.simulation.fps)
            most = int(min(alike, frames, *(_written(origin.folder / n) for n in names)))
            most = min((most, *(self._common(origin, r, done[r]) for r in read if r in done)))
            if most < frames:
                whole = [
                    m
                    for m in checkpoint_frames(spec, most)
                    if all(checkpoint_path(origin.folder / n, m).is_file() for n in names)
                ]
                most = whole[-1] + 1 if whole else 0
            if most > least:
                found.append(Offer(origin, most))
        return sorted(found, key=lambda offer: -offer.frames)

    def _common(self, origin: Origin, name: str, cache: Cache) -> int:
        """Frames at the start of an instance's cache that an origin has too."""
        try:
            pairs = zip(cache.digests(), Cache(origin.folder / name).digests(), strict=False)
            same = next(
                (k for k, (a, b) in enumerate(pairs) if a != b), min(len(cache.digests()), _written(origin.folder / name))
            )
        except EvidenceError:
            same = 0
        return max(same, self._same.get((origin.name, name), 0))

    def take(self, offer: Offer, caches: Mapping[str, Cache], indices: Mapping[str, CacheIndex], least: int) -> int:
        """Take the frames of an offer and their checkpoints into caches; how many, or 0 where its layout is another one or no more than `least`
        are whole there."""
        spec, origin = self._own.spec, offer.origin
        there = {n: Cache(origin.folder / n) for n in caches}
        try:
            if not all(_same_layout(there[n].index, indices[n]) for n in caches):
                return 0
        except EvidenceError:
            return 0
        count = min(trusted_frames(c, offer.frames) for c in there.values())
        if count < offer.frames:  # damaged frames there: go on before them
            count = max((m + 1 for m in checkpoint_frames(spec, count) if m < count), default=0)
        if count <= least:
            return 0
        marks = checkpoint_frames(spec, count)
        for name, cache in caches.items():
            digests = there[name].digests()[:count]
            own = [self._lay(there[name], cache, k, digest, indices[name]) for k, digest in enumerate(digests)]
            for mark in marks:
                source = checkpoint_path(there[name].folder, mark)
                if source.is_file():
                    _link(source, checkpoint_path(cache.folder, mark))
            cache.begin_digests(own)  # last: a frame counts when its digest stands here
            self._same[origin.name, name] = count
        self.took(there, count)
        return count

    def took(self, there: Mapping[str, Cache], frames: int) -> None:
        """Record that the first frames of instances come from caches of another run."""
        runs = {n: c.folder.parent.relative_to(self._root.parent.parent).as_posix() for n, c in there.items()}
        told = {n: Taken(runs[n], frames, _over(c.digests()[:frames])) for n, c in there.items()}
        self._tell({**taken_in(self._root), **told})

    def _tell(self, taken: Mapping[str, Taken]) -> None:
        told = {n: {"from": t.origin, "frames": t.frames, "digest": t.digest} for n, t in taken.items()}
        write_atomically(self._root / RECORD, json.dumps(told, indent=1, sort_keys=True).encode())

    def keep_to(self, names: Sequence[str], frames: int) -> None:
        """Record that frames from `frames` on are this run's own."""
        told = taken_in(self._root)
        kept = {n: t for n, t in told.items() if n not in names or t.frames <= frames}
        for name in names:
            if name in told and 0 < frames < told[name].frames:
                there = Cache(self._root.parent.parent / told[name].origin / name)
                kept[name] = Taken(told[name].origin, frames, _over(there.digests()[:frames]))
        if kept != told:
            self._tell(kept)

    def surfaces_of(self, name: str, caches: Mapping[str, Cache]) -> tuple[Path, int] | None:
        """Folder of the run from which a liquid's frames were taken, and how many of them have all solids where they are here."""
        taken = taken_in(self._root).get(name)
        origin = next((o for o in self._known if taken is not None and o.name == taken.origin), None)
        if taken is None or origin is None:
            return None
        others = [self._common(origin, n, c) for n, c in caches.items() if n != name]
        return origin.folder / name, min((taken.frames, *others))

    def _lay(self, there: Cache, cache: Cache, frame: int, digest: str, index: CacheIndex) -> str:
        """Put a frame into a cache; its digest there."""
        if there.index.drivers == index.drivers:
            _link(there.path(frame), cache.path(frame))
            return digest
        data = there.read(frame)
        rows = dict(zip(there.index.drivers, data[ACTIVE], strict=True))
        # A driver that the other run lacks acts later: that is why its frames may be taken.
        data[ACTIVE] = np.array([rows.get(n, 0) for n in index.drivers], dtype=data[ACTIVE].dtype)
        return write_container(cache.path(frame), data)


def _recorded(path: Path) -> Settings | None:
    """Settings that `candidate.json` records, where they are of the present engines and whole."""
    try:
        record = json.loads(path.read_text())
        if (record["source"], record["versions"]) != (solver_source(), engine_versions()):
            return None
        spec, contents = parse_spec(record["spec"]), {n: str(d) for n, (_, d) in record["built"].items()}
    except (*DAMAGE, SpecError):
        return None
    return Settings(spec, contents) if settings_hash(spec, contents)[:16] == path.parent.name else None


def _written(folder: Path) -> int:
    try:
        return len(Cache(folder).digests())
    except EvidenceError:
        return 0


def _same_layout(there: CacheIndex, here: CacheIndex) -> bool:
    """True if rows stand for the same; those of a rigid instance's drivers can be laid out anew."""
    free: dict[str, Any] = {"frames": 0, "settings": ""}
    if here.engine == "mujoco":
        free["drivers"] = ()
    return dataclasses.replace(there, **free) == dataclasses.replace(here, **free)


def _link(source: Path, target: Path) -> None:
    """The same file under another name, else a copy; files of caches are replaced and never written into."""
    target.parent.mkdir(parents=True, exist_ok=True)
    spare = target.with_name(f".{target.name}.taken")
    spare.unlink(missing_ok=True)
    try:
        os.link(source, spare)
    except OSError:
        shutil.copyfile(source, spare)
    spare.replace(target)
    spare.unlink(missing_ok=True)  # renaming a link to a file onto another link to it leaves both


def _over(digests: Sequence[str]) -> str:
    return hashlib.sha256("".join(digests).encode()).hexdigest()

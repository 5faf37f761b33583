"""Settle runs (`simulation.settle`): the world without drivers until what is listed rests; its end is the state at frame 0.

Groups of instances settle one after the other, as they are baked: those before them stand as they are at frame 0. A run is kept beside
the frames of every instance (`worlds/settled.py`), and taken over wherever its recipe is the same: an edit of drivers, story, shots or
frames does not settle again.
"""

from __future__ import annotations

import json
import shutil
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from ..worlds.arrays import F64, RigidPose
from ..worlds.built import BuiltEntity
from ..worlds.cache import Cache, CacheIndex
from ..worlds.canonical import digest_of
from ..worlds.errors import EvidenceError
from ..worlds.folder import write_atomically
from ..worlds.settled import SettledFrames, hold_frames, rest_way, settling, settling_world
from ..worlds.spec import WorldSpec
from ..worlds.writers import writers_of
from .protocol import Intervention, Within
from .recipes import coupled_recipe
from .runs import Run, make_run, standing

__all__ = ["Settled", "settle"]


@dataclass(frozen=True)
class Settled:
    """The end of the settle run of a group."""

    states: Mapping[str, bytes] = field(default_factory=dict)
    """Of the engine of each instance; empty where none of the group settles."""
    recipe: str = ""
    """Hash of everything that decides it."""
    digests: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Of the last frames, by instance."""


class _End(NamedTuple):
    """States, last frames and note that a settle run leaves."""

    states: dict[str, bytes]
    indices: dict[str, CacheIndex]
    frames: dict[str, list[Mapping[str, Any]]]
    """The last ones."""
    note: dict[str, Any]


class _Standing(Cache):
    """A cache whose every frame is the first one of another."""

    def __init__(self, cache: Cache) -> None:
        super().__init__(cache.folder)
        self._first = cache
        vars(self)["index"] = cache.index

    def read(self, frame: int, names: Any = None) -> dict[str, Any]:
        """Channels of the first frame."""
        return self._first.read(0, names)


def settle(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    names: tuple[str, ...],
    *,
    read: Mapping[str, Cache],
    into: Mapping[str, Cache] | None = None,
    reuse: bool = True,
    tell: Within | None = None,
) -> Settled:
    """Let a group of instances come to rest, or take the state that an equal run came to.

    Args:
        spec: the specification.
        built: its geometry.
        names: the group.
        read: caches of the groups before it.
        into: caches of the group, beside which the end is kept; None keeps and takes nothing.
        reuse: whether an end that was kept may be taken.
        tell: takes how far it is.

    Raises:
        InputError: an instance cannot be prepared.
        EngineError: a solver failed, or something broke while it settled.
    """
    members = {m for n in names for m in spec.simulation.solvers[n].members}
    listed = frozenset(settling(spec)) & members
    if not listed:
        return Settled()
    still = settling_world(spec)
    recipe = digest_of(
        "settled", coupled_recipe(still, built), names, sorted(listed), {n: c.frame_digest(0) for n, c in read.items()}
    )
    found = None if into is None or not reuse else _kept(into, recipe)
    if found is None:
        end = _settled(still, built, names, listed, read, tell)
        found = Settled(end.states, recipe, {n: tuple(_digests(f)) for n, f in end.frames.items()})
        if into is not None:
            _keep(still, into, end, recipe)
    return found


def _digests(frames: list[Mapping[str, Any]]) -> list[str]:
    from ..worlds.cache import digest_arrays

    return [digest_arrays(data) for data in frames]


def _settled(
    still: WorldSpec,
    built: Mapping[str, BuiltEntity],
    names: tuple[str, ...],
    listed: frozenset[str],
    read: Mapping[str, Cache],
    tell: Within | None,
) -> _End:
    """Run a group until what is listed rests, or its time is over.

    Whenever the kinetic energy has passed a peak, all is stopped (kinetic damping, as in dynamic relaxation: Barnes 1999,
    doi:10.1260/0266351991494722), so that what would swing for long comes to the same place of rest soon. What has not been stopped
    for `HOLD_SECONDS` and kept its place rests.
    """
    plan = still.simulation
    free = {n for n, e in still.entities.items() if e.motion == "dynamic"}
    if names[0] not in plan.rigid:
        still = standing(still, read)
    run = make_run(
        still,
        built,
        names,
        caches={n: _Standing(c) for n, c in read.items()},
        intervention=Intervention(held=frozenset(free - listed)),
    )
    run.prepare()
    indices = {n: replace(s.index(), settings="") for n, s in run.solvers.items()}
    window = hold_frames(still)
    last: deque[dict[str, Mapping[str, Any]]] = deque([_frame(run)], maxlen=window)
    moving: dict[str, float] = {}
    stopped, before, restless = 0, 0.0, {"": 0.0}
    for frame in range(1, plan.frames):
        run.advance(frame)
        last.append(_frame(run))
        energy = sum(float(data["record/kinetic_energy"]) for data in last[-1].values())
        if restless and energy < before:  # past a peak: what is left would only swing about the place of rest
            for solver in run.solvers.values():
                solver.stop()
            stopped, energy = frame, 0.0
        before = energy
        if len(last) == window:
            found = [_ways(built, indices[name], [f[name] for f in last], still) for name in names]
            moving = {n: way for ways in found for n, way in ways.items() if n in listed}
            restless = {n: way for n, way in moving.items() if not way <= rest_way(still, n)}
        if tell is not None:
            tell(frame / (plan.frames - 1), _doing(still, restless, frame))
        if not restless and frame - stopped >= window - 1:
            break
    seconds = float(frame / plan.fps)
    note = {"seconds": seconds, "moving": {n: float(way) for n, way in sorted(moving.items())}}
    frames = {n: [f[n] for f in last] for n in names}
    return _End({n: s.end_of_settling() for n, s in run.solvers.items()}, indices, frames, note)


def _frame(run: Run) -> dict[str, Mapping[str, Any]]:
    return {n: dict(s.frame_data()) for n, s in run.solvers.items()}


def _doing(still: WorldSpec, restless: Mapping[str, float], frame: int) -> str:
    text = f"settling before frame 0, {frame / still.simulation.fps:.2f} s"
    if not restless:
        return f"{text}: at rest"
    if "" in restless:
        return text
    worst = max(restless, key=lambda n: restless[n] / max(rest_way(still, n), 1e-12))
    return f"{text}: {len(restless)} move, {worst} most"


def _ways(
    built: Mapping[str, BuiltEntity], index: CacheIndex, frames: list[Mapping[str, Any]], still: WorldSpec
) -> dict[str, float]:
    """Farthest that each entity of an instance was in some frames from where it is in the last one [m]."""
    found: dict[str, float] = {}
    now = frames[-1]
    for row, name in enumerate(index.bodies if index.engine == "mujoco" else ()):
        entity, body = name.split("/", 1)
        corners = _corners(built[entity], body)
        end = RigidPose(now["position"][row], now["quaternion"][row]).apply(corners)
        for data in frames[:-1]:
            there = RigidPose(data["position"][row], data["quaternion"][row]).apply(corners)
            found[entity] = max(found.get(entity, 0.0), float(np.linalg.norm(there - end, axis=1).max(initial=0.0)))
    start = 0
    for name, count in zip(index.deformables, index.vertices, strict=True):
        entity, rows = name.split("/", 1)[0], slice(start, start + count)
        start += count
        apart = [np.linalg.norm(d["vertex/position"][rows] - now["vertex/position"][rows], axis=1) for d in frames[:-1]]
        found[entity] = max([found.get(entity, 0.0), *(float(a.max(initial=0.0)) for a in apart)])
    if "particle/id" in now:
        members = still.simulation.solvers[index.solver].members
        of = np.asarray(now.get("particle/member", now.get("particle/fluid")))
        for k, member in enumerate(members):
            mine = np.asarray(now["particle/id"])[of == k]
            found[member] = max((_typical(d, now, mine) for d in frames[:-1]), default=0.0)
    return found


def _typical(data: Mapping[str, Any], now: Mapping[str, Any], mine: Any) -> float:
    """Root of the mean squared distance of particles between two frames [m]; those that are in one of them only do not count."""
    ids, back, ahead = np.intersect1d(data["particle/id"], now["particle/id"], return_indices=True)
    own = np.isin(ids, mine)
    if not own.any():
        return 0.0
    way: F64 = np.asarray(now["particle/position"], dtype=np.float64)[ahead[own]] - data["particle/position"][back[own]]
    return float(np.sqrt((way**2).sum(axis=1).mean()))


def _corners(entity: BuiltEntity, body: str) -> F64:
    """Corners of the box around a body, in its frame (8, 3) [m]."""
    points = np.concatenate([p.render.vertices for p in entity.parts_of(body)] or [np.zeros((1, 3))])
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


# ---------------------------------------------------------------- kept runs


def _kept(into: Mapping[str, Cache], recipe: str) -> Settled | None:
    """The end of an equal run, of this world's or another candidate; None where there is none."""
    own = _read(into, recipe)
    if own is not None:
        return own
    stage = next(iter(into.values())).folder.parent
    for other in sorted(stage.parent.parent.glob("*/*")):
        there = {n: Cache(other / n) for n in into}
        found = _read(there, recipe) if other != stage else None
        if found is not None:
            for n, cache in into.items():
                target = SettledFrames(cache).files.folder
                shutil.rmtree(target, ignore_errors=True)
                shutil.copytree(SettledFrames(there[n]).files.folder, target)
            return _read(into, recipe)
    return None


def _read(caches: Mapping[str, Cache], recipe: str) -> Settled | None:
    states, digests = {}, {}
    for name, cache in caches.items():
        kept = SettledFrames(cache)
        try:
            if not kept.there() or kept.about()["recipe"] != recipe:
                return None
            states[name] = kept.state_path.read_bytes()
            digests[name] = tuple(kept.files.digests())
            if any(kept.files.frame_digest(k) != d for k, d in enumerate(digests[name])):
                return None
        except (OSError, EvidenceError):
            return None
    return Settled(states, recipe, digests)


def _keep(still: WorldSpec, into: Mapping[str, Cache], end: _End, recipe: str) -> None:
    """Write the end of a run beside the frames of its instances."""
    for name, cache in into.items():
        kept = SettledFrames(cache)
        shutil.rmtree(kept.files.folder, ignore_errors=True)
        kept.files.write_index(replace(end.indices[name], frames=len(end.frames[name])))
        files = SettledFrames(cache).files
        files.begin_digests([])
        for frame, data in enumerate(end.frames[name]):
            files.write(frame, data, writers_of(still, name))
        write_atomically(kept.state_path, end.states[name])
        write_atomically(files.folder / kept.note, json.dumps({"recipe": recipe, **end.note}, indent=1, sort_keys=True).encode())

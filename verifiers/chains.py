"""Chains of impulses through the contact log: who could have moved whom, and when (R96, R97, S8).

An entity is *reached* when an impulse chain that starts at a source arrives at it. Contacts carry the chain when the
sender was reached before the contact ended and the impulse is large enough for the receiver; joints, springs and
rope ends carry it at once while they hold. Static entities receive but never send: a shared floor connects nothing.
Kinematic entities send but never receive, because nothing acts on them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64
from ..worlds.errors import EvidenceError
from ..worlds.spec import DetachDriver
from . import motion

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate

__all__ = ["MIN_IMPULSE", "MOMENTUM_SHARE", "Chains", "Hop", "begins"]

MIN_IMPULSE = 1e-6
"""[N s] Smallest impulse that carries a chain: 1 mm/s of a 1 g body."""
MOMENTUM_SHARE = 0.01
"""Own choice: a contact must give at least this share of the momentum that its receiver has in that frame."""
NEVER = np.inf


class Hop(NamedTuple):
    """One step of a chain."""

    source: str
    target: str
    time: float
    """[s] at which the target was reached."""
    impulse: float | None
    """[N s] within the frame; None through a joint."""
    frame: int


class _Edges(NamedTuple):
    """Directed contacts of one frame."""

    sender: NDArray[np.intp]
    receiver: NDArray[np.intp]
    begin: F64
    end: F64
    impulse: F64


@dataclass(frozen=True)
class Reach:
    """Where chains from given sources had arrived by a time."""

    names: tuple[str, ...]
    arrival: F64
    """[s] per entity, infinite where none arrived."""
    hop_to: Mapping[int, Hop]

    def time(self, entity: str) -> float | None:
        """When the entity was reached [s]."""
        value = self.arrival[self.names.index(entity)]
        return None if np.isinf(value) else float(value)

    def chain(self, entity: str) -> list[Hop]:
        """Hops from a source to the entity, in order."""
        hops: list[Hop] = []
        at = self.names.index(entity)
        while at in self.hop_to:
            hops.append(self.hop_to[at])
            at = self.names.index(hops[-1].source)
        return hops[::-1]

    def reached(self) -> list[str]:
        """Entities in order of arrival."""
        order = np.argsort(self.arrival, kind="stable")
        return [self.names[i] for i in order if np.isfinite(self.arrival[i])]


class Chains:
    """Contact and joint graph of a candidate, prepared once.

    Raises:
        EvidenceError: a contact or event channel is missing.
    """

    def __init__(self, candidate: Candidate) -> None:
        if not candidate.caches:
            raise EvidenceError("no contact log: simulate first")
        self.candidate = candidate
        spec = candidate.spec
        self.names = tuple(spec.entities)
        self._index = {n: i for i, n in enumerate(self.names)}
        motions = [spec.entities[n].motion for n in self.names]
        self._sends = np.array([m != "static" for m in motions])
        self._receives = np.array([m != "kinematic" for m in motions])
        self._fps = spec.simulation.fps
        self._frames = [self._frame_edges(k) for k in range(candidate.frame_count)]
        self._joints = self._joint_edges()
        self._floor = self._floors()

    def _floors(self) -> F64:
        """Smallest impulse that carries a chain to each entity [N s], shape (frames, entities)."""
        floors = np.full((self.candidate.frame_count, len(self.names)), MIN_IMPULSE)
        for i, name in enumerate(self.names):
            if self.candidate.moves(name):
                momentum = motion.entity_mass(self.candidate, name) * np.linalg.norm(
                    motion.velocities(self.candidate, name), axis=1
                )
                floors[:, i] = np.maximum(MIN_IMPULSE, MOMENTUM_SHARE * np.nan_to_num(momentum, nan=NEVER))
        return floors

    def _frame_edges(self, frame: int) -> _Edges:
        found: dict[tuple[int, int], tuple[float, float]] = {}
        start = (frame - 1) / self._fps
        for cache in self.candidate.caches.values():
            ids = [self._index.get(n, -1) for n in cache.index.colliders]
            contacts = cache.ragged("contact/pair", "contact/impulse")
            events = cache.ragged("event/time", "event/pair", "event/impulse")
            before = {tuple(p) for p in contacts[frame - 1]["contact/pair"].tolist()} if frame else set()
            for pair, impulse in zip(contacts[frame]["contact/pair"].tolist(), contacts[frame]["contact/impulse"], strict=True):
                found[ids[pair[0]], ids[pair[1]]] = (start, float(impulse))
            log = events[frame]
            seen = set()
            for time, pair, impulse in zip(log["event/time"], log["event/pair"].tolist(), log["event/impulse"], strict=True):
                if tuple(pair) in before or tuple(pair) in seen:
                    continue  # touching since the last frame, or the first contact of this frame is already noted
                seen.add(tuple(pair))
                key = (ids[pair[0]], ids[pair[1]])
                found[key] = (float(time), found[key][1] if key in found else float(impulse))
        pairs = [(k, v) for k, v in found.items() if min(k) >= 0]
        sender = np.array([k[0] for k, _ in pairs] + [k[1] for k, _ in pairs], dtype=np.intp)
        receiver = np.array([k[1] for k, _ in pairs] + [k[0] for k, _ in pairs], dtype=np.intp)
        begin = np.array([v[0] for _, v in pairs] * 2, dtype=np.float64)
        impulse_twice = np.array([v[1] for _, v in pairs] * 2, dtype=np.float64)
        return _Edges(sender, receiver, begin, np.full(len(begin), frame / self._fps), impulse_twice)

    def _joint_edges(self) -> _Edges:
        plan = self.candidate.spec.simulation
        opened = {d.joint: d.time for d in plan.drivers.values() if isinstance(d, DetachDriver)}
        ends: list[tuple[str | None, str | None, float]] = [
            (j.parent, j.child, opened.get(name, NEVER)) for name, j in plan.joints.items()
        ]
        for name, entity in self.candidate.spec.entities.items():
            rope = entity.generator
            ends += [(name, to, NEVER) for to in (rope.attach_start, rope.attach_end)] if rope is not None else []
        pairs = [(self._index[a], self._index[b], t) for a, b, t in ends if a in self._index and b in self._index]
        sender = np.array([p[0] for p in pairs] + [p[1] for p in pairs], dtype=np.intp)
        receiver = np.array([p[1] for p in pairs] + [p[0] for p in pairs], dtype=np.intp)
        count = len(sender)
        end = np.array([p[2] for p in pairs] * 2, dtype=np.float64)
        return _Edges(sender, receiver, np.full(count, -NEVER), end, np.full(count, NEVER))

    def spread(self, sources: Iterable[str], start: float, until_frame: int, *, mute: Iterable[str] = ()) -> Reach:
        """Earliest arrivals of chains that leave `sources` at `start` [s], over contacts up to `until_frame`; `mute` sends none."""
        sends = self._sends.copy()
        sends[[self._index[m] for m in mute]] = False
        arrival = np.full(len(self.names), NEVER)
        hops: dict[int, Hop] = {}
        arrival[[self._index[s] for s in sources if s in self._index]] = start
        first = max(0, int(np.floor(start * self._fps)))
        for frame in range(first, min(until_frame, self.candidate.frame_count - 1) + 1):
            while self._relax(arrival, hops, frame, sends):
                pass
        return Reach(self.names, arrival, hops)

    def _relax(self, arrival: F64, hops: dict[int, Hop], frame: int, sends: NDArray[np.bool_]) -> bool:
        changed = False
        here, joints = self._frames[frame], self._joints
        sender, receiver, begin, end, impulse = (np.concatenate([a, b]) for a, b in zip(here, joints, strict=True))
        now = frame / self._fps
        usable = sends[sender] & self._receives[receiver] & (arrival[sender] <= np.minimum(end, now))
        usable &= impulse >= self._floor[frame, receiver]
        offered = np.maximum(arrival[sender], begin)
        for k in np.flatnonzero(usable & (offered < arrival[receiver])):
            to = int(receiver[k])
            if offered[k] < arrival[to]:
                arrival[to] = offered[k]
                through = None if np.isinf(impulse[k]) else float(impulse[k])
                hops[to] = Hop(self.names[int(sender[k])], self.names[to], float(offered[k]), through, frame)
                changed = True
        return changed


def begins(candidate: Candidate, a: str, b: str, frames: tuple[int, int]) -> float | None:
    """Time [s] at which the first contact of the pair within the frames began; None without one.

    A pair that already touched before the interval began counts from the interval's first instant.
    """
    fps = candidate.spec.simulation.fps
    for cache in motion.caches_with(candidate, a, b):
        pair = sorted((cache.index.colliders.index(a), cache.index.colliders.index(b)))
        contacts, events = cache.ragged("contact/pair", "contact/impulse"), cache.ragged("event/time", "event/pair")
        for frame in range(frames[0], frames[1] + 1):
            log = events[frame]
            times = [float(t) for t, p in zip(log["event/time"], log["event/pair"].tolist(), strict=True) if p == pair]
            if pair in contacts[frame]["contact/pair"].tolist():
                return min(times, default=(frame - 1) / fps)
            if times:
                return min(times)
    return None

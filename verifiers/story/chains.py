"""Chains of pushes through the logs: who could have set whom going, and when (R96, R97, S8).

A chain is *live* in an entity while the motion that it brought lasts. It leaves a source, and goes from a live sender to a
receiver through a link of a frame:

- a **contact**, from its beginning on, if its impulse is large enough for the receiver. A receiver at rest passes on, within
  the frame, only what presses it harder than what it carried all along: resting contacts link nothing.
- a **push** between matter and a body, over the whole frame: liquid, grains, cloth and what holds its pins. Such matter moves while it
  does on the whole. A body that no coupling lets feel it receives nothing from it.
- **heat** that a gas gives a solid which may burn, over the whole frame; the solid need not move;
- **dust** that a body raises where it hits something, and **steam** where hot matter touches water, while they come;
- a **joint**, spring or rope end while it holds, if the receiver moves.

A live entity that comes to rest for longer than `PAUSE` is live no more; if it moves again by itself, that motion is
another story. Static entities receive but never send: a shared floor connects nothing. Kinematic entities send but never
receive, because nothing acts on them; nor do those that a release driver holds. What set a source going is no effect of it:
a hammer that strikes two bells does not link the first with the second. Where something came to a source that stood still, what it bore
until then did not set it going: a wall that is struck lets the water go that it held, however that slopped.

Who pushes whom, and what is still, the judges of the categories say (`categories/registry.py`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ...worlds.spec import ForceDriver, ReleaseDriver
from ..categories.pushes import MIN_IMPULSE
from ..categories.registry import JUDGES, judge_of
from ..ledgers.fields import blown_at
from .links import Links, both_ways

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec
    from ..categories.judge import Push, Tie

__all__ = ["MOMENTUM_SHARE", "PAUSE", "PRESSED", "Chains", "Hop", "Reach", "chains_of", "joined"]

MOMENTUM_SHARE = 0.01
"""Own choice: a contact must give at least this share of the momentum that its receiver has in that frame, and a chain this
share of the impulses by which others push the effect's subject meanwhile."""
PRESSED = 0.1
"""Own choice: a contact presses a resting receiver if its impulse exceeds what it was at rest by this share."""
PAUSE = 0.125
"""[s] A rest shorter than this (an apex, a reversal) does not interrupt a motion. Own choice."""
STARTS = 2
"""Frames within which what touches a source that was still counts as what set it going: one to move, one to be seen moving."""
NEVER = np.inf
SAME = 1e-9
"""[s] Times this close are equal."""
Flags = NDArray[np.bool_]


class Hop(NamedTuple):
    """One step of a chain."""

    source: str
    target: str
    time: float
    """[s] at which the target was reached."""
    impulse: float | None
    """[N s] within the frame; None through a joint or as heat."""
    frame: int


@dataclass
class Reach:
    """Where chains from given sources had arrived by a time."""

    names: tuple[str, ...]
    arrival: F64
    """[s] per entity: when it was first reached, infinite where it was not."""
    alien: Flags
    """Per entity: whether what moves it in the end is not of the chain, shape (entities,)."""
    stopped: dict[str, int] = field(default_factory=dict)
    """First frame of a rest in which a chain ended, by entity."""
    paths: dict[int, tuple[Hop, ...]] = field(default_factory=dict)
    """Hops from a source, by index of the entity that they lead to."""
    given: float = 0.0
    """[N s] by which the chain pushed the subject."""
    others: dict[str, float] = field(default_factory=dict)
    """[N s] by which others that were already moving, and drivers, pushed the subject meanwhile."""

    def time(self, entity: str) -> float | None:
        """When the entity was first reached [s]; None if it was not, or what moves it in the end is not of the chain."""
        at = self.names.index(entity)
        return None if np.isinf(self.arrival[at]) or self.alien[at] else float(self.arrival[at])

    def ever(self, entity: str) -> bool:
        """True if a chain arrived at the entity at all."""
        return bool(np.isfinite(self.arrival[self.names.index(entity)]))

    def chain(self, entity: str) -> list[Hop]:
        """Hops from a source to the entity, in order."""
        return list(self.paths.get(self.names.index(entity), ()))

    def reached(self) -> list[str]:
        """Entities in order of arrival."""
        order = np.argsort(self.arrival, kind="stable")
        return [self.names[i] for i in order if np.isfinite(self.arrival[i])]

    @property
    def negligible(self) -> bool:
        """True if others pushed the subject so much harder that the chain decided nothing."""
        return self.given < MOMENTUM_SHARE * sum(self.others.values())


@dataclass
class _Spread:
    """State of one spread, frame by frame."""

    reach: Reach
    sends: Flags
    receives: Flags
    banned: dict[int, set[tuple[int, int]]]
    """Directed pairs that carry nothing, by frame."""
    resting: Mapping[tuple[int, int], float]
    subject: int | None
    limit: float
    """[s] Nothing counts that is later."""
    live: Flags
    rest: NDArray[np.int64]
    since: F64
    """[s] From when on each entity passes on within the present frame; infinite where it does not."""


class Chains:
    """Links and motion of a candidate, prepared once.

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
        self._pause = max(2, round(PAUSE * self._fps))
        self._joined = self._joint_links()
        deaf = [pair for judge in JUDGES.values() for pair in judge.unfelt(spec) if set(pair) <= set(self.names)]
        self._deaf = np.array([self._index[a] * len(self.names) + self._index[b] for a, b in deaf], dtype=np.intp)
        pushes = [judge.pushes(candidate) for judge in JUDGES.values()]
        self._links = [self._directed([p for found in pushes for p in found[k]]) for k in range(candidate.frame_count)]
        self._heated = [
            {(self._index[p.a], self._index[p.b]) for found in pushes for p in found[k] if p.heat}
            for k in range(candidate.frame_count)
        ]
        """Pairs of which the first heats the second, per frame."""
        self._moving, self._floor = self._motions()
        self._freed = np.full(len(self.names), -NEVER)
        for driver in spec.simulation.drivers.values():
            if isinstance(driver, ReleaseDriver) and driver.entity in self._index:
                at = self._index[driver.entity]
                self._freed[at] = max(self._freed[at], driver.time)

    def _motions(self) -> tuple[Flags, F64]:
        """Flags of entities that are not still, and the smallest impulse [N s] that carries a chain to each: (frames, entities)."""
        shape = (self.candidate.frame_count, len(self.names))
        moving, floors = np.zeros(shape, dtype=bool), np.full(shape, MIN_IMPULSE)
        for i, name in enumerate(self.names):
            judge = judge_of(self.candidate.spec, name)
            if judge.known(self.candidate, name):
                moving[:, i] = judge.moving(self.candidate, name)
                momentum = np.linalg.norm(judge.momentum(self.candidate, name), axis=1)
                floors[:, i] = np.maximum(MIN_IMPULSE, MOMENTUM_SHARE * np.nan_to_num(momentum, nan=NEVER))
        return moving, floors

    # ---------------------------------------------------------------- links

    def _directed(self, pushes: Iterable[Push]) -> Links:
        """Links of one frame, both ways but to bodies that do not feel them."""
        known = [p for p in pushes if p.a in self._index and p.b in self._index]
        links = both_ways([(self._index[p.a], self._index[p.b], p.begin, p.end, p.impulse) for p in known])
        ok = ~np.isin(links.sender * len(self.names) + links.receiver, self._deaf)
        return Links(links.sender[ok], links.receiver[ok], links.begin[ok], links.end[ok], links.impulse[ok])

    def _joint_links(self) -> Links:
        index = self._index
        ends = _ties(self.candidate.spec)
        return both_ways([(index[a], index[b], -NEVER, t, NEVER) for a, b, t in ends if a in index and b in index])

    @cached_property
    def _pairs(self) -> list[dict[tuple[int, int], float]]:
        """Impulse [N s] per directed pair of each frame, the largest of its links."""
        found = []
        for links in self._links:
            here: dict[tuple[int, int], float] = {}
            for a, b, j in zip(links.sender.tolist(), links.receiver.tolist(), links.impulse.tolist(), strict=True):
                here[a, b] = max(j, here.get((a, b), 0.0))
            found.append(here)
        return found

    def _resting(self, until: int) -> dict[tuple[int, int], float]:
        """Largest impulse per frame [N s] of pairs that touched while both were still, up to a frame."""
        found: dict[tuple[int, int], float] = {}
        for frame in range(min(until, len(self._pairs) - 1) + 1):
            still = ~self._moving[frame]
            for pair, impulse in self._pairs[frame].items():
                if still[pair[0]] and still[pair[1]]:
                    found[pair] = max(impulse, found.get(pair, 0.0))
        return found

    def _initiators(self, sources: list[int], onset: int, subject: int | None) -> dict[int, set[tuple[int, int]]]:
        """Links back to what set a resting source going, as long as that very contact lasts."""
        banned: dict[int, set[tuple[int, int]]] = {}
        last = len(self._pairs) - 1
        for source in sources:
            if self._moving[min(onset, last), source] or not self._receives[source]:
                continue
            struck = next((k for k in range(onset, min(onset + STARTS, last) + 1) if self._came(source, k)), None)
            for first in range(onset, min(onset + STARTS, last) + 1):
                for a, b in list(self._pairs[first]):
                    if a != source or b in (*sources, subject) or not self._moving[max(0, first - 1), b]:
                        continue
                    if struck is not None and self._borne_before(source, b, struck):
                        continue
                    frame = first
                    while frame <= last and (a, b) in self._pairs[frame]:
                        banned.setdefault(frame, set()).add((a, b))
                        frame += 1
        return banned

    def _borne_before(self, source: int, other: int, first: int) -> bool:
        """True if a source touched another in every frame of a `PAUSE` before one, and stood still all the same: what a vessel holds."""
        frames = range(max(1, first - self._pause), first)
        return len(frames) > 0 and all((source, other) in self._pairs[k] and not self._moving[k - 1, source] for k in frames)

    def _came(self, source: int, first: int) -> bool:
        """True if something that moved came to a source in a frame."""
        met = [b for a, b in self._pairs[first] if a == source and self._moving[max(0, first - 1), b]]
        return first > 0 and any((source, b) not in self._pairs[first - 1] for b in met)

    # ---------------------------------------------------------------- spreading

    def spread(
        self,
        sources: Iterable[str],
        start: float,
        until_frame: int,
        *,
        subject: str | None = None,
        mute: Iterable[str] = (),
        acting_until: int = 0,
        limit: float = NEVER,
    ) -> Reach:
        """Follow chains that leave `sources` at `start` [s], over links up to `until_frame`.

        Args:
            sources: where they start.
            start: when.
            until_frame: last frame.
            subject: the effect's; it sends nothing, and what pushes it is summed.
            mute: further entities that send nothing.
            acting_until: frame up to which the sources are live even at rest.
            limit: links that begin later [s] do not count.
        """
        count = len(self.names)
        own = [self._index[s] for s in dict.fromkeys(sources) if s in self._index]
        sends = self._sends.copy()
        at = self._index.get(subject) if subject is not None and self._index.get(subject) not in own else None
        sends[[self._index[m] for m in mute] + ([at] if at is not None else [])] = False
        onset = max(0, int(np.floor(start * self._fps + SAME)))
        arrival = np.full(count, NEVER)
        arrival[own] = start
        state = _Spread(
            Reach(self.names, arrival, np.zeros(count, dtype=bool)),
            sends,
            self._receives,
            self._initiators(own, onset, at),
            self._resting(onset),
            at,
            limit,
            np.isfinite(arrival),
            np.zeros(count, dtype=np.int64),
            np.full(count, NEVER),
        )
        last = min(until_frame, len(self._links) - 1)
        for frame in range(onset, last + 1):
            self._frame(state, frame, own if frame <= acting_until else [], start)
        return state.reach

    def _frame(self, state: _Spread, frame: int, acting: list[int], start: float) -> None:
        now, before = self._moving[frame], self._moving[max(0, frame - 1)]
        active = state.live & (now | before)
        active[acting] = True
        state.since[:] = np.where(active, state.reach.arrival, NEVER)
        state.since[acting] = start
        links = Links(*(np.concatenate([a, b]) for a, b in zip(self._links[frame], self._joined, strict=True)))
        after = self._moving[min(frame + 1, len(self._moving) - 1)]
        ok = self._usable(state, links, frame, now | after)
        while self._relax(state, links, ok, frame):
            pass
        hot = np.isfinite(state.since)
        state.live |= hot
        going = (state.live & now) | (hot & ~active)
        going[acting] = True
        state.rest = np.where(going, 0, state.rest + 1)
        for i in np.flatnonzero(state.live & (state.rest > self._pause)).tolist():
            state.live[i] = False
            state.reach.stopped[self.names[i]] = frame - int(state.rest[i]) + 1
        state.reach.alien = np.where(state.live, False, state.reach.alien | now)
        if state.subject is not None and np.isfinite(state.reach.arrival[state.subject]):
            self._sum_pushes(state, frame)

    def _usable(self, state: _Spread, links: Links, frame: int, responds: Flags) -> Flags:
        """Links that can carry in this frame, whoever is live."""
        sender, receiver, impulse = links.sender, links.receiver, links.impulse
        ok: Flags = state.sends[sender] & state.receives[receiver] & (impulse >= self._floor[frame, receiver])
        ok &= self._freed[receiver] < frame / self._fps - SAME
        ok &= links.begin <= state.limit + SAME
        for k in np.flatnonzero(ok & ~responds[receiver]).tolist():
            pair = int(sender[k]), int(receiver[k])
            pressed = bool(np.isfinite(impulse[k])) and impulse[k] > (1 + PRESSED) * state.resting.get(pair, 0.0)
            ok[k] = pressed or pair in self._heated[frame]
        for pair in state.banned.get(frame, ()):
            ok &= ~((sender == pair[0]) & (receiver == pair[1]))
        return ok

    def _relax(self, state: _Spread, links: Links, ok: Flags, frame: int) -> bool:
        sender, receiver = links.sender, links.receiver
        in_time = state.since[sender] <= np.minimum(links.end, frame / self._fps) + SAME
        offered = np.maximum(state.since[sender], links.begin)
        changed = False
        for k in np.flatnonzero(ok & in_time & (offered < state.since[receiver]) & (offered <= state.limit + SAME)).tolist():
            one, to = int(sender[k]), int(receiver[k])
            if offered[k] >= state.since[to]:
                continue
            if not (state.live[to] and state.since[to] < NEVER):
                through = None if np.isinf(links.impulse[k]) else float(links.impulse[k])
                hop = Hop(self.names[one], self.names[to], float(offered[k]), through, frame)
                state.reach.paths[to] = (*state.reach.paths.get(one, ()), hop)
            state.since[to] = offered[k]
            state.reach.arrival[to] = min(state.reach.arrival[to], offered[k])
            changed = True
        return changed

    def _sum_pushes(self, state: _Spread, frame: int) -> None:
        """Add up by whom the subject is pushed in this frame: the chain, or others that were moving before they met it."""
        reach, subject = state.reach, state.subject
        assert subject is not None
        path = reach.paths.get(subject, ())
        if path and path[-1].impulse is None:
            reach.given = NEVER  # joints log no impulse
        for (one, to), impulse in self._pairs[frame].items():
            if to != subject or not self._sends[one]:
                continue
            if np.isfinite(state.since[one]):
                reach.given += impulse
            elif self._moving[self._episode(one, to, frame), one]:
                reach.others[self.names[one]] = reach.others.get(self.names[one], 0.0) + impulse
        begin = (frame - 1) / self._fps
        for name, driver in self.candidate.spec.simulation.drivers.items():
            if isinstance(driver, ForceDriver) and driver.entity == self.names[subject]:
                lasted = max(0.0, min(driver.end, frame / self._fps) - max(driver.start, begin))
                if lasted > 0:
                    reach.others[name] = reach.others.get(name, 0.0) + lasted * float(np.linalg.norm(driver.force))
        for name, impulse in blown_at(self.candidate, self.names[subject], frame).items():
            reach.others[name] = reach.others.get(name, 0.0) + impulse

    def _episode(self, one: int, to: int, frame: int) -> int:
        """Frame before the contact that lasts at `frame` began."""
        while frame > 0 and (one, to) in self._pairs[frame]:
            frame -= 1
        return frame


def chains_of(candidate: Candidate) -> Chains:
    """Links and motion of a candidate, prepared once.

    Raises:
        EvidenceError: a contact or event channel is missing.
    """
    return candidate.memo("chains", lambda: Chains(candidate))


def _ties(spec: WorldSpec) -> list[Tie]:
    return [tie for judge in JUDGES.values() for tie in judge.ties(spec)]


def joined(spec: WorldSpec) -> list[set[str | None]]:
    """Pairs of entities that joints, springs and ropes hold together; None is the world."""
    return [{a, b} for a, b, _ in _ties(spec)]

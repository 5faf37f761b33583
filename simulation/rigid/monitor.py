"""Contact bookkeeping at step resolution: events, summed impulses, clearances.

Per step only what MuJoCo lists is copied; a frame's worth is evaluated at once.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .contact_gain import ContactGain
from .holds import FIXED
from .model import RigidModel
from .sides import sides_of

__all__ = ["ContactMonitor"]

DEBOUNCE = 0.005
"""A pair that touches again within this time [s] continues its contact; no new event."""
BATCH = 256
"""Steps after which what was copied is evaluated, so that a long preroll needs no memory."""
_NEVER = -1e9


@dataclass
class _Steps:
    """Copies of one batch, one entry per step with contacts."""

    rows: list[Any]
    geoms: list[Any]
    gaps: list[Any]
    points: list[Any]
    axes: list[Any]
    forces: list[Any]
    speeds: list[Any]
    times: list[float]
    lengths: list[float]

    @classmethod
    def empty(cls) -> _Steps:
        return cls([], [], [], [], [], [], [], [], [])


class _Impacts(NamedTuple):
    """Impacts of single contacts in one step, shape (k, ...)."""

    time: F64
    pair: NDArray[np.int64]
    turn: NDArray[np.int64]
    normal: F64
    vector: F64


class _Contacts(NamedTuple):
    """All listed contacts of one batch, shape (n,) each."""

    key: NDArray[np.int64]
    """Number that stands for the pair of colliders."""
    step: NDArray[np.int64]
    live: NDArray[np.bool_]
    """True where it was solved."""
    impulse: F64
    """Normal [N s]."""


@dataclass
class _Event:
    time: float
    key: int
    point: F64
    speed: float
    impulse: float


class ContactMonitor:
    """Accumulates one frame. The memory of contacts outlives frames and is part of checkpoints.

    A pair *touches* in a step in which MuJoCo solves a contact of it. An event is a touch after more than `DEBOUNCE`
    without one. Contacts among sleeping bodies are not listed: a pair that was last seen when one of its bodies fell
    asleep, and is seen again when that body wakes, touched all the while.
    """

    def __init__(self, rigid: RigidModel) -> None:
        self.rigid = rigid
        self.count = len(rigid.colliders)
        self.gain = ContactGain(rigid.model)
        # Instances with elastic bodies do not sleep.
        trees = np.append(rigid.model.body_treeid[rigid.model.geom_bodyid], np.full(len(rigid.flexes), -1))
        self._trees: list[NDArray[np.int64]] = []
        for collider in range(self.count):
            own = np.unique(trees[rigid.geom_collider == collider])
            self._trees.append(own[own >= 0].astype(np.int64))
        self.seen: dict[int, float] = {}
        """Time [s] at which each pair touched last."""
        self.slept = np.full(rigid.model.ntree, np.inf)
        self.woke = np.full(rigid.model.ntree, _NEVER)
        self._awake = b""
        self.begin()

    def begin(self) -> None:
        """Start a frame."""
        self.gain.begin()
        self._steps = _Steps.empty()
        self._events: list[_Event] = []
        self._impacts: list[_Impacts] = []
        self._total: dict[int, list[float]] = {}
        """Normal impulse, largest force, smallest gap and impulse on the later collider of every pair."""
        self.max_contacts = 0
        self.iterations = 0
        self.capped = 0

    def memory(self) -> bytes:
        """The contact memory as bytes."""
        asleep = np.flatnonzero(np.isfinite(self.slept)).tolist()
        return json.dumps([sorted(self.seen.items()), [(t, self.slept[t], self.woke[t]) for t in asleep]]).encode()

    def recall(self, memory: bytes) -> None:
        """Return to a contact memory and start the frame anew."""
        seen, asleep = json.loads(memory)
        self.seen = {int(k): float(t) for k, t in seen}
        self.slept[:], self.woke[:] = np.inf, _NEVER
        for tree, slept, woke in asleep:
            self.slept[tree], self.woke[tree] = slept, woke
        self._awake = b""
        self.begin()

    def wake_all(self, time: float) -> None:
        """Note that every sleeping body was woken at `time` [s], as a restored checkpoint does."""
        sleeping = np.isfinite(self.slept) & (self.woke < self.slept)
        self.woke[sleeping] = time

    def take_over(self, other: ContactMonitor, time: float) -> None:
        """Go on with a frame that the monitor of the model before has begun; all bodies are awake from `time` [s] on."""
        other._evaluate()
        self.seen = other.seen
        for key, last in self.seen.items():
            # Trees of the two models differ, so that what a sleeping pair touched is remembered by the pair itself.
            trees = [t for side in divmod(key, self.count) for t in other._trees[side]]
            if any(abs(other.slept[t] - last) <= DEBOUNCE and other.woke[t] < other.slept[t] for t in trees):
                self.seen[key] = time
        self._events, self._total, self._impacts = other._events, other._total, other._impacts
        self.gain.take_over(other.gain)
        self.max_contacts, self.iterations, self.capped = other.max_contacts, other.iterations, other.capped

    def sleeping(self, data: Any, bodies: Any, since: float) -> NDArray[np.uint8]:
        """Which of the model's `bodies` sleep: 1, or 2 where they fell asleep after `since` [s], shape (n,)."""
        asleep = data.body_awake[bodies] == 0
        tree = self.rigid.model.body_treeid[bodies]
        late = (tree >= 0) & (self.slept[np.maximum(tree, 0)] > since) if len(self.slept) else np.zeros(len(tree), dtype=bool)
        return np.where(asleep, np.where(late, 2, 1), 0).astype(np.uint8)

    def adopt(self, data: Any, time: float) -> None:
        """Take the contacts listed in `data` as having begun before `time` [s]."""
        if data.ncon:
            for key in np.unique(self._keys(sides_of(self.rigid.model, data.contact))).tolist():
                self.seen[key] = time

    def _keys(self, geoms: Any) -> NDArray[np.int64]:
        sides = self.rigid.geom_collider[geoms]
        return np.asarray(sides.min(axis=1) * self.count + sides.max(axis=1))

    # ------------------------------------------------------------------ per step

    def watch_sleep(self, data: Any, time: float) -> None:
        """Note which bodies fell asleep or woke, in the step that ends at `time` [s]."""
        awake = data.body_awake_ind[: data.nbody_awake].tobytes()
        if awake != self._awake:
            self._note_sleep(data, time)
            self._awake = awake

    def watch_contacts(self, data: Any, time: float, dt: float) -> None:
        """Record the solved contacts of the step that ends at `time` [s].

        Before the integration: where a body falls asleep in it, MuJoCo evaluates the contacts once more, without what
        `contact_law` has written, and those forces never acted.
        """
        self.watch_sleep(data, time)
        if not data.ncon:
            return
        if data.nefc:
            self.gain.watch(data)
            worst = int(data.solver_niter[: data.nisland or 1].max())
            if worst > self.iterations:
                self.iterations = worst
            self.capped += worst >= self.rigid.model.opt.iterations
            steps, contact = self._steps, data.contact
            rows = contact.efc_address.copy()
            steps.rows.append(rows)
            steps.geoms.append(sides_of(self.rigid.model, contact).copy())
            steps.gaps.append(contact.dist.copy())
            steps.points.append(contact.pos.copy())
            steps.axes.append(contact.frame.copy())
            steps.forces.append(_components(data.efc_force, rows, contact.dim))
            steps.speeds.append(data.efc_vel[rows])
            steps.times.append(time)
            steps.lengths.append(dt)
            if len(steps.times) >= BATCH:
                self._evaluate()
            if self.rigid.law.blow is not None:
                self._note_impacts(data, self.rigid.law.blow.told, time)
        self.max_contacts = max(self.max_contacts, data.ncon)

    def _note_impacts(self, data: Any, told: F64, time: float) -> None:
        """Copy the impacts of a step; each row of `told` is a contact, a turn and an impulse along the axes of the contact."""
        contact, which = data.contact, told[:, 0].astype(np.int64)
        pair = self.rigid.geom_collider[sides_of(self.rigid.model, contact)[which]]
        axes = contact.frame[which].reshape(-1, 3, 3)
        way = np.sign(pair[:, 1] - pair[:, 0])[:, None]
        vector = way * np.einsum("ni,nij->nj", told[:, 2:5], axes)
        self._impacts.append(
            _Impacts(np.full(len(which), time), np.sort(pair, axis=1), told[:, 1].astype(np.int64), way * axes[:, 0], vector)
        )

    def _note_sleep(self, data: Any, time: float) -> None:
        self._evaluate()
        asleep = data.tree_asleep >= 0
        before = np.isfinite(self.slept) & (self.woke < self.slept)
        self.slept[asleep & ~before] = time
        self.woke[asleep & ~before] = _NEVER
        self.woke[before & ~asleep] = time

    # ------------------------------------------------------------------ per frame

    def _slept_through(self, key: int, last: float, now: float, dt: float) -> bool:
        """True if a pair was not seen from `last` to `now` only because a body of it slept."""
        for side in divmod(key, self.count):
            for tree in self._trees[side]:
                slept, woke = self.slept[tree], self.woke[tree]
                if abs(slept - last) <= DEBOUNCE and last <= woke and now - woke <= DEBOUNCE + dt:
                    return True
        return False

    def _evaluate(self) -> None:
        """Turn the copied steps into totals and events."""
        steps = self._steps
        if not steps.times:
            return
        self._steps = _Steps.empty()
        rows = np.concatenate(steps.rows)
        sizes = [len(r) for r in steps.rows]
        place = np.repeat(np.arange(len(sizes)), sizes)
        geoms = np.concatenate(steps.geoms)
        keys = self._keys(geoms)
        live = rows >= 0
        model = self.rigid.model
        fixed = (np.append(model.geom_contype, model.flex_contype)[geoms] == FIXED[0]).all(axis=1)
        parts = np.where((live & ~fixed)[:, None], np.concatenate(steps.forces), 0.0)
        force = parts[:, 0]
        gaps = np.concatenate(steps.gaps)
        lengths = np.array(steps.lengths)
        impulse = force * lengths[place]
        # The frame's first axis leads from the first side to the second, which the force pushes.
        pushed = np.einsum("ni,nij->nj", parts * lengths[place, None], np.concatenate(steps.axes).reshape(-1, 3, 3))
        pushed *= np.sign(self.rigid.geom_collider[geoms[:, 1]] - self.rigid.geom_collider[geoms[:, 0]])[:, None]
        pairs, inverse = _among(keys, self.count**2)
        total = np.bincount(inverse, weights=impulse)
        vector = np.stack([np.bincount(inverse, weights=pushed[:, i]) for i in range(3)], axis=1)
        nearest = np.full(len(pairs), np.inf)
        np.minimum.at(nearest, inverse, gaps)
        code, which = _among(inverse * len(sizes) + place, len(pairs) * len(sizes))
        per_step = np.bincount(which, weights=force)
        strongest = np.zeros(len(pairs))
        np.maximum.at(strongest, code // len(sizes), per_step)
        given = dict(zip(pairs.tolist(), total.tolist(), strict=True))
        for event in self._events:
            event.impulse += given.get(event.key, 0.0)
        table = np.column_stack((total, strongest, nearest, vector)).tolist()
        for key, (a, b, c, x, y, z) in zip(pairs.tolist(), table, strict=True):
            old = self._total.get(key, [0.0, 0.0, np.inf, 0.0, 0.0, 0.0])
            self._total[key] = [old[0] + a, max(old[1], b), min(old[2], c), old[3] + x, old[4] + y, old[5] + z]
        touching = np.bincount(which, weights=live) > 0
        self._find_events(steps, _Contacts(keys, place, live, impulse), pairs, code[touching])

    def _find_events(self, steps: _Steps, contacts: _Contacts, pairs: NDArray[np.int64], touches: NDArray[np.int64]) -> None:
        """Touches are sorted by (pair, step); an event is the first touch after a pause."""
        keys, place, live, impulse = contacts
        times, lengths = np.array(steps.times), np.array(steps.lengths)
        pair, step = np.divmod(touches, len(times))
        when = times[step]
        before = np.empty(len(touches))
        heads = np.flatnonzero(np.diff(pair, prepend=-1) != 0)
        before[1:] = when[:-1]
        before[heads] = [self.seen.get(int(k), _NEVER) for k in pairs[pair[heads]]]
        tails = np.append(heads[1:], len(touches)) - 1
        last = dict(zip(pairs[pair[tails]].tolist(), when[tails].tolist(), strict=True)) if len(touches) else {}
        self.seen.update(last)
        fresh = np.flatnonzero(when - before > DEBOUNCE + lengths[step])
        if not len(fresh):
            return
        points, speeds = np.concatenate(steps.points), -np.concatenate(steps.speeds)
        found = []
        for i in fresh:
            key, at = int(pairs[pair[i]]), int(step[i])
            if self._slept_through(key, float(before[i]), float(when[i]), float(lengths[at])):
                continue
            mine = keys == key
            rows = np.flatnonzero(mine & live & (place == at))
            first = rows[np.argmax(speeds[rows])]
            given = float(impulse[mine & (place >= at)].sum())
            found.append(_Event(float(when[i]), key, points[first].copy(), float(speeds[first]), given))
        self._events += sorted(found, key=lambda e: (e.time, e.key))

    def arrays(self) -> dict[str, Any]:
        """Channels `contact/*` and `event/*` of the frame."""
        self._evaluate()
        events, pairs = self._events, np.array(sorted(self._total), dtype=np.int64)
        totals = np.array([self._total[k] for k in pairs.tolist()]).reshape(-1, 6)
        return {
            "contact/pair": np.stack([pairs // self.count, pairs % self.count], axis=-1).astype(np.int32),
            "contact/impulse": totals[:, 0].copy(),
            "contact/vector": totals[:, 3:].copy(),
            "contact/max_force": totals[:, 1].copy(),
            "contact/min_gap": totals[:, 2].copy(),
            "event/time": np.array([e.time for e in events], dtype=np.float64),
            "event/pair": np.array([divmod(e.key, self.count) for e in events], dtype=np.int32).reshape(-1, 2),
            "event/point": np.array([e.point for e in events], dtype=np.float64).reshape(-1, 3),
            "event/speed": np.array([e.speed for e in events], dtype=np.float64),
            "event/impulse": np.array([e.impulse for e in events], dtype=np.float64),
            **_impact_channels(self._impacts),
        }


def _impact_channels(impacts: list[_Impacts]) -> dict[str, Any]:
    """Channels `impact/*` of the impacts of a frame."""

    def joined(name: str, shape: tuple[int, ...], kind: str) -> Any:
        parts = [getattr(step, name) for step in impacts]
        return np.concatenate([np.zeros(shape), *parts]).astype(kind)

    return {
        "impact/time": joined("time", (0,), "f8"),
        "impact/pair": joined("pair", (0, 2), "i4"),
        "impact/turn": joined("turn", (0,), "i4"),
        "impact/normal": joined("normal", (0, 3), "f8"),
        "impact/vector": joined("vector", (0, 3), "f8"),
    }


def _components(forces: Any, rows: Any, sizes: Any) -> Any:
    """Normal force and both of friction [N] of contacts whose first constraint is at `rows`, shape (n, 3)."""
    found = np.zeros((len(rows), 3))
    found[:, 0] = forces[rows]
    sliding = np.flatnonzero((sizes >= 3) & (rows >= 0))
    for k in (1, 2):
        found[sliding, k] = forces[rows[sliding] + k]
    return found


def _among(values: NDArray[np.int64], count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Which of `count` numbers from 0 on occur, and the place of each value among those: `numpy.unique` without sorting."""
    found = np.zeros(count, dtype=bool)
    found[values] = True
    return np.flatnonzero(found), (np.cumsum(found) - 1)[values]

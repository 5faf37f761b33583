"""Contact bookkeeping at step resolution: events, summed impulses, clearances, driver work."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from .model import RigidModel

__all__ = ["ContactMonitor"]

DEBOUNCE = 0.005
"""A pair that touches again within this time [s] continues its contact; no new event."""


class ContactMonitor:
    """Accumulates one frame. The contact memory outlives frames and is part of checkpoints.

    A pair is *touching* while MuJoCo lists it. Sleeping bodies have no contacts, so their pairs wait as *dormant*
    and resume without an event when the body wakes.
    """

    def __init__(self, rigid: RigidModel) -> None:
        self.rigid = rigid
        self.count = len(rigid.colliders)
        self.touching: set[int] = set()
        self.dormant: set[int] = set()
        self.left: dict[int, float] = {}
        self.awake = -1
        self._trees: list[frozenset[int]] = [frozenset() for _ in range(self.count)]
        for geom in range(rigid.model.ngeom):
            tree = int(rigid.model.body_treeid[rigid.model.geom_bodyid[geom]])
            if tree >= 0:
                self._trees[rigid.geom_collider[geom]] |= {tree}
        self.begin()

    def begin(self) -> None:
        """Start a frame."""
        self._keys: list[Any] = []
        self._forces: list[Any] = []
        self._gaps: list[Any] = []
        self._steps: list[float] = []
        self.events: list[tuple[float, int, Any, float, int]] = []
        self.max_contacts = 0
        self.iterations = 0
        self.capped = 0

    def memory(self) -> bytes:
        """The contact memory as bytes."""
        state = [sorted(self.touching), sorted(self.dormant), sorted(self.left.items()), self.awake]
        return json.dumps(state).encode()

    def recall(self, memory: bytes) -> None:
        """Return to a contact memory and start the frame anew."""
        touching, dormant, left, self.awake = json.loads(memory)
        self.touching, self.dormant = set(touching), set(dormant)
        self.left = {int(k): float(t) for k, t in left}
        self.begin()

    def _asleep(self, key: int, asleep: Any) -> bool:
        a, b = divmod(key, self.count)
        return any(asleep[t] >= 0 for t in self._trees[a] | self._trees[b])

    def after_step(self, data: Any, time: float, dt: float) -> None:
        """Record the step that ended at `time` [s]; contacts are those of its beginning."""
        if data.nefc:
            worst = int(data.solver_niter[: max(1, data.nisland)].max())
            self.iterations = max(self.iterations, worst)
            self.capped += worst >= self.rigid.model.opt.iterations
        current: set[int] = set()
        contact = data.contact
        if data.ncon:
            self.max_contacts = max(self.max_contacts, data.ncon)
            rows = contact.efc_address
            sides = self.rigid.geom_collider[contact.geom]
            keys = sides.min(axis=1) * self.count + sides.max(axis=1)
            live = rows >= 0
            force = np.where(live, data.efc_force[np.where(live, rows, 0)], 0.0)
            self._keys.append(keys)
            self._forces.append(force)
            self._gaps.append(contact.dist.copy())
            self._steps.append(dt)
            current = set(keys[live].tolist())
        if data.ntree_awake != self.awake:
            self.awake = int(data.ntree_awake)
            asleep = data.tree_asleep
            woken = {k for k in self.dormant if not self._asleep(k, asleep)}
            self.dormant -= woken
            self.touching |= woken
        if current == self.touching:
            return
        for key in sorted(current - self.touching):
            if key in self.dormant:
                self.dormant.discard(key)
            elif time - self.left.get(key, -np.inf) > DEBOUNCE:
                first = int(np.flatnonzero((keys == key) & live)[0])
                speed = float(-data.efc_vel[rows[first]])
                self.events.append((time, key, contact.pos[first].copy(), speed, len(self._keys) - 1))
        for key in self.touching - current:
            if self._asleep(key, data.tree_asleep):
                self.dormant.add(key)
            else:
                self.left[key] = time
        self.touching = current

    def arrays(self) -> dict[str, Any]:
        """Channels `contact/*` and `event/*` of the frame."""
        events = self.events
        if self._keys:
            keys = np.concatenate(self._keys)
            sizes = [len(k) for k in self._keys]
            force = np.concatenate(self._forces)
            impulse = force * np.repeat(self._steps, sizes)
            at_step = np.repeat(np.arange(len(sizes)), sizes)
            pairs, inverse = np.unique(keys, return_inverse=True)
            per_step = np.zeros(0)
            total = np.bincount(inverse, weights=impulse)
            joint, place = np.unique(inverse * len(sizes) + at_step, return_inverse=True)
            per_step = np.bincount(place, weights=force)
            strongest = np.zeros(len(pairs))
            np.maximum.at(strongest, joint // len(sizes), per_step)
            nearest = np.full(len(pairs), np.inf)
            np.minimum.at(nearest, inverse, np.concatenate(self._gaps))
            given = [float(impulse[(keys == e[1]) & (at_step >= e[4])].sum()) for e in events]
        else:
            pairs, total, strongest, nearest, given = np.zeros(0, dtype=np.int64), *(np.zeros(0) for _ in range(3)), []
        return {
            "contact/pair": np.stack([pairs // self.count, pairs % self.count], axis=-1).astype(np.int32),
            "contact/impulse": total,
            "contact/max_force": strongest,
            "contact/min_gap": nearest,
            "event/time": np.array([e[0] for e in events], dtype=np.float64),
            "event/pair": np.array([divmod(e[1], self.count) for e in events], dtype=np.int32).reshape(-1, 2),
            "event/point": np.array([e[2] for e in events], dtype=np.float64).reshape(-1, 3),
            "event/speed": np.array([e[3] for e in events], dtype=np.float64),
            "event/impulse": np.array(given, dtype=np.float64),
        }

"""Judges whether what a bond is said to have broken by had the impulse for it.

The load on a piece is the contact force smoothed over the contact time tau: an impulse J makes it J / tau at most. What a step
that is taken again would have given is not in the log of contacts; but nothing gives more than both sides' momenta, twice where
they bounce. Contacts log normal impulses; with friction a contact gives at most `WITH_FRICTION` of that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ...ledgers.exchanged import partners
from .bounds import BOUNCE, FAINT, WITH_FRICTION

if TYPE_CHECKING:
    from .frames import Broken, Frames

__all__ = ["PARTNER", "Budget"]

PARTNER = -2
"""As a cause: what liquids, cloth or grains of a two-way coupling give."""


class Budget:
    """Impulses that an entity may have got, per frame and cause.

    Args:
        frames: of the entity.
        solver: its instance.
        contact_time: of its bonds [s].
    """

    def __init__(self, frames: Frames, solver: str, contact_time: float) -> None:
        self._frames, self._time = frames, contact_time
        self._own = frames.cache.index.colliders.index(frames.entity)
        self._coupled = bool(partners(frames.candidate.spec, solver))

    def excess(self, event: Broken, frame: int, loads: F64) -> float:
        """Largest load on a piece in parts of what its cause can have given.

        Args:
            event: whose case the loads are.
            frame: in which it broke.
            loads: lasting and sudden, shape (n, 12).
        """
        force = float(np.linalg.norm(loads[:, :3] + loads[:, 6:9], axis=1).max(initial=0.0))
        if event.cause == PARTNER and self._coupled:
            given = self._frames.exchanged(frame)
        elif event.cause < 0:
            weight = float(np.linalg.norm(self._frames.local_gravity))
            return force / (FAINT * weight * max(b.mass for b in self._frames.built.bodies))
        else:
            given = self._impulse(event.cause, frame)
        return force * self._time / max(WITH_FRICTION * given, 1e-300)

    def _impulse(self, cause: int, frame: int) -> float:
        """[N s] From a collider; from pieces of the entity itself also what others gave those."""
        frames = self._frames
        touching = frames.touching(frame)
        owners = {cause, self._own} | (set(touching) if cause == self._own else set())
        logged = sum(touching.get(k, 0.0) for k in (touching if cause == self._own else (cause,)))
        return logged + BOUNCE * sum(frames.momentum(k, frame) for k in sorted(owners))

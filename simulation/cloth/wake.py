"""Sheets in a medium that feels them: it is asked before an exchange, triangle by triangle, and told after it what they took (R66)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.fields import Answer, Dragged, Fields

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from .engine import Cloth

__all__ = ["Breeze", "Wake"]

TINY = 1e-12


class Breeze:
    """Velocity of the medium at triangles' centres; its density comes as the fourth column.

    Args:
        fields: by member.
        members: of the instance.
        owner: member of each triangle.

    Attributes:
        change: by how much a medium that gives way is faster at each triangle, in the mean over an exchange [m/s].
    """

    def __init__(self, fields: Mapping[str, Fields], members: Sequence[str], owner: NDArray[np.int64]) -> None:
        self._fields, self._members, self._owner = fields, members, owner
        self.change: F64 | None = None
        carried = [k for k, m in enumerate(members) if fields[m].carriers]
        self._felt = np.flatnonzero(np.isin(owner, carried))
        self._of = fields[members[carried[0]]] if carried else None

    def __call__(self, points: F64, time: float) -> F64:
        """At points [m], one per triangle, and a time [s], (n, 4)."""
        result = np.zeros((len(points), 4))
        for k, member in enumerate(self._members):
            own = self._owner == k
            if self._fields[member] and own.any():
                medium = self._fields[member].medium(points[own], time)
                result[own, :3], result[own, 3] = medium.velocity, medium.density
        if self.change is not None:
            result[:, :3] += self.change
        return result

    @property
    def yields(self) -> bool:
        """True if a medium feels the sheets."""
        return self._of is not None and self._of.yields

    def ask(self, points: F64, time: float, dragged: Dragged) -> tuple[Answer, NDArray[np.int64]] | None:
        """The medium's answer to triangles, and which these are; None where it does not give way."""
        own = self._felt
        if self._of is None or not len(own):
            return None
        velocity, mass, share, rate, seconds, _ = dragged
        answer = self._of.answer(points[own], time, Dragged(velocity[own], mass[own], share[own], rate[own], seconds))
        return None if answer is None else (answer, own)


class _Blown(NamedTuple):
    """Triangles in the air."""

    force: F64
    """[N], (n, 3)."""
    rate: F64
    """Force over relative speed [kg/s], (n,)."""
    center: F64
    velocity: F64
    area: F64


class Wake:
    """An exchange of sheets as the medium feels it."""

    def __init__(self, engine: Cloth, breeze: Breeze, time: float, limit: float) -> None:
        self._engine, self._breeze = engine, breeze
        breeze.change = None
        longest = min(engine.setup.exchange, engine.setup.max_step)
        seconds = limit / max(1, math.ceil(limit / longest - 1e-6))
        self._air = breeze(self._centers(), time)
        before = self._blown()
        mass = np.maximum((engine.mass[engine.faces] / self._shared()).sum(axis=1), TINY)
        rate = before.rate / mass
        dragged = Dragged(before.velocity, mass, -np.expm1(-rate * seconds), rate, seconds)
        found = breeze.ask(before.center, time, dragged)
        self.answer = None if found is None else found[0]
        if found is not None:
            self._own, change = found[1], np.zeros_like(before.center)
            change[self._own] = found[0].change
            breeze.change = change
            self._air[:, :3] += change
            self._start = self._blown()

    def take(self, total: F64, seconds: float) -> None:
        """Take from the medium what it gave the sheets over an exchange [N s], (3,): to each triangle as at its start and end, the rest by area."""
        if self.answer is None:
            return
        end = self._blown()
        given = 0.5 * seconds * (self._start.force + end.force)[self._own]
        area = self._start.area[self._own]
        given += (total - given.sum(axis=0)) * (area / area.sum())[:, None]
        self.answer.take(given)

    def _centers(self) -> F64:
        x = self._engine.x.numpy()[: self._engine.n]
        return np.asarray(x[self._engine.faces].mean(axis=1))

    def _shared(self) -> F64:
        """Triangles about each corner of each triangle, (n, 3)."""
        faces = self._engine.faces
        return np.bincount(faces.ravel(), minlength=self._engine.n)[faces].astype(np.float64)

    def _blown(self) -> _Blown:
        """Forces of the air on the triangles as they are now, by the law of the engine (`step_kernels.blow`)."""
        engine = self._engine
        x, v = engine.vertices()
        corner = x[engine.faces]
        normal = 0.5 * np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        area = np.linalg.norm(normal, axis=1)
        normal /= np.maximum(area, TINY)[:, None]
        speed = v[engine.faces].mean(axis=1)
        past = self._air[:, :3] - speed
        across = (past * normal).sum(axis=1)[:, None] * normal
        drag = np.concatenate(
            [np.tile(d, (len(s.faces), 1)) for s, d in zip(engine.setup.sheets, engine.setup.drag, strict=True)]
        )
        weight = 0.5 * self._air[:, 3] * area * np.linalg.norm(past, axis=1)
        force = weight[:, None] * (drag[:, :1] * across + drag[:, 1:] * (past - across))
        size = np.linalg.norm(force, axis=1) / np.maximum(np.linalg.norm(past, axis=1), TINY)
        return _Blown(force, size, corner.mean(axis=1), speed, area)

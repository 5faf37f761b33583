"""A gas between its cells and frames as what it carries meets it, and impulses that it gives (R66, R105)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....physics.substances import air_density
from ....worlds.arrays import F64
from ....worlds.fields import fields_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from .frames import GasBox

__all__ = ["Given", "Stream", "pull_of"]

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Given:
    """Impulses of a gas on what one record tells of together, over each interval between frames."""

    entities: tuple[str, ...]
    recorded: F64
    """As the instance that moves them tells, without pulls of fields [N s], shape (F - 1, 3)."""
    worked_out: F64
    """As cells and motion tell, shape (F - 1, 3)."""
    shares: dict[str, F64]
    """The same by entity."""
    judged: Flags
    """True where it is free, awake and within the box at both ends, shape (F - 1,)."""
    inside: Flags
    """True where all of it is within the box at both ends, shape (F - 1,)."""
    doubt: F64 | None = None
    """Size of the impulse on what comes or goes within an interval, which nothing tells [N s], shape (F - 1,)."""
    at_once: F64 | None = None
    """By how much it is another if a gas that feels them gives way at once in each interval [N s], shape (F - 1, 3)."""

    def off(self) -> F64:
        """Distance of the sums of both since frame 0, whatever part of how the gas gives way is at once, in the intervals that are judged
        [N s], shape (F - 1,)."""

        def summed(values: F64) -> F64:
            return np.cumsum(np.where(self.judged[:, None], values, 0.0), axis=0)

        gap = summed(self.recorded) - summed(self.worked_out)
        if self.at_once is not None:
            whole = summed(self.at_once)
            part = (gap * whole).sum(axis=1) / np.maximum((whole**2).sum(axis=1), 1e-300)
            gap = gap - np.clip(part, 0.0, 1.0)[:, None] * whole
        found: F64 = np.linalg.norm(gap, axis=1)
        return found


class Stream:
    """Velocity and density of a gas between its cells and frames; `yields`: what it carries moves it."""

    def __init__(self, box: GasBox, *, yields: bool = False) -> None:
        self.box, self.yields = box, yields

    def at_once(self, force: Callable[[float], F64]) -> F64:
        """Difference of the impulse over an interval if a gas that feels what it carries gives way at once, and not evenly as is supposed:
        half of what `force`, a function of the share of the way between both frames of the gas [N], changes by [N s], (3,)."""
        if not self.yields:
            return np.zeros(3)
        return np.asarray(0.5 * self.box.duration * (force(1.0) - force(0.0)))

    def within(self, points: F64, frame: int) -> Flags:
        """True for points [m] in the box at a frame, (n, 3) -> (n,)."""
        place = points - self.box.read(frame).corner
        return np.asarray(((place >= 0.0) & (place <= self.box.size)).all(axis=1))

    def at(self, points: F64, frame: int, share: float = 0.0) -> tuple[F64, F64]:
        """Velocity [m/s] (n, 3) and density [kg/m^3] (n,) at points [m], `share` of the way from a frame to the next."""
        found = self._between(points, frame, share)
        return found[:, :3], air_density(1.0) / found[:, 3] + found[:, 4]

    def warmth(self, points: F64, frame: int, share: float = 0.0) -> F64:
        """Temperature [K] (n,) there."""
        return self._between(points, frame, share)[:, 3]

    def _between(self, points: F64, frame: int, share: float) -> F64:
        found = self._look(points, frame)
        return found if share <= 0.0 else (1.0 - share) * found + share * self._look(points, frame + 1)

    def _look(self, points: F64, frame: int) -> F64:
        from scipy.ndimage import map_coordinates

        now = self.box.read(frame)
        place = ((points - now.corner) / now.cell - 0.5).T
        fields = (*np.moveaxis(now.velocity, 3, 0), now.temperature, now.soot)
        return np.stack([map_coordinates(f.astype(np.float64), place, order=1, mode="nearest") for f in fields], axis=1)


def pull_of(candidate: Candidate, entity: str) -> Callable[[F64, float], F64]:
    """Function that gives the acceleration by gravity and fields without a medium at points [m] and a time [s], (n, 3) -> (n, 3) [m/s^2]."""
    fields, gravity = fields_of(candidate.spec, entity), np.array(candidate.spec.simulation.gravity, dtype=np.float64)
    return lambda points, time: gravity + fields.acceleration(points, time)

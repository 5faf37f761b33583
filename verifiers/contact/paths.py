"""Paths of all bodies between written frames, as the searches between frames share them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...geometry import State, aabb_of, wall_thickness
from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..scene.surfaces import NOWHERE
from .flights import ContactLog, Flight

if TYPE_CHECKING:
    from ..scene.shapes import PartSurface
    from ..scene.surfaces import Surfaces

__all__ = ["Paths"]


@dataclass
class _Body:
    """Motion of one body over all frame intervals."""

    flight: Flight
    static: bool


class Paths:
    """Flights, walls and boxes of all parts of a candidate between its frames."""

    def __init__(self, surfaces: Surfaces) -> None:
        self.surfaces = surfaces
        self.intervals = surfaces.frames - 1
        self.step = 1.0 / surfaces.candidate.spec.simulation.fps
        self.bodies: dict[tuple[str, str], _Body] = {}
        self.walls: dict[int, float] = {}
        self.log = ContactLog(surfaces.candidate)

    def body(self, part: PartSurface) -> _Body:
        """Motion of the body of a part."""
        key = (part.entity, part.body)
        if key not in self.bodies:
            self.bodies[key] = _Body(self._flight(*key), self.surfaces.is_static(part.entity))
        return self.bodies[key]

    def _flight(self, entity: str, body: str) -> Flight:
        """Broken poses are replaced by the last sound one; `usable` leaves their intervals out."""
        candidate = self.surfaces.candidate
        position, quaternion = self.surfaces.track(entity, body)
        sound = self.surfaces.broken.get(entity, self.surfaces.frames)
        keep = np.minimum(np.arange(self.surfaces.frames), max(sound - 1, 0))
        if sound == 0:
            position, quaternion = np.zeros_like(position), np.tile([1.0, 0.0, 0.0, 0.0], (len(quaternion), 1))
        position, quaternion = position[keep], quaternion[keep]
        velocity = spin = None
        place = candidate.cache_row(entity, body)
        if place is not None:
            cache, row = place
            try:
                velocity = np.nan_to_num(cache.series("velocity")[: self.surfaces.frames, row][keep])
                spin = np.nan_to_num(cache.series("angular_velocity")[: self.surfaces.frames, row][keep])
            except EvidenceError:
                velocity = spin = None
        center = candidate.body(entity, body).center
        states = State(position, quaternion, velocity, spin)
        gravity = np.array(candidate.spec.simulation.gravity)
        falls = candidate.spec.entities[entity].motion == "dynamic"
        return Flight.of(states, center, self.step, gravity if falls else np.zeros(3))

    def usable(self, entity: str) -> int:
        """Number of first intervals with sound poses at both ends."""
        return max(0, min(self.intervals, self.surfaces.broken.get(entity, self.surfaces.frames) - 1))

    def wall(self, index: int) -> float:
        """Thickness of the wall of a part [m]."""
        if index not in self.walls:
            self.walls[index] = wall_thickness(self.surfaces.parts[index].solid)
        return self.walls[index]

    @cached_property
    def radius(self) -> list[float]:
        """Radius of every part about the centre of its body [m]."""
        return [
            float(np.linalg.norm(p.solid.vertices - self.body(p).flight.motion.center, axis=1).max()) for p in self.surfaces.parts
        ]

    def boxes(self) -> tuple[F64, F64]:
        """Boxes that hold every part on its way through each interval [m], shapes (parts, intervals, 3)."""
        parts = self.surfaces.parts
        low, high = np.full((len(parts), self.intervals, 3), NOWHERE), np.full((len(parts), self.intervals, 3), -NOWHERE)
        for i, part in enumerate(parts):
            body, count = self.body(part), self.usable(part.entity)
            if count == 0:
                continue
            track = self.surfaces.track(part.entity, part.body)
            if body.static:
                low[i, :count], high[i, :count] = aabb_of(part.solid.vertices, track.position[:1], track.quaternion[:1])
                continue
            corners = np.array(list(itertools.product(*zip(part.solid.lower, part.solid.upper, strict=True))))
            lower, upper = aabb_of(corners, track.position[: count + 1], track.quaternion[: count + 1])
            sag = body.flight.motion.sag(self.radius[i])[:count, None]
            low[i, :count] = np.minimum(lower[:-1], lower[1:]) - sag
            high[i, :count] = np.maximum(upper[:-1], upper[1:]) + sag
        return low, high

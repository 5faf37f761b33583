"""Force fields on a running liquid: accelerations and media change the velocities of its particles between the engine's steps.

As zones of waves do: gravity and pressure follow in the same step. A push is divided by one plus the share of the relative
velocity that it would take within the step, so that it never turns a drop round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64, I64
from ...worlds.liquid_air import LEE, Matter, pushed, surface_points
from ..protocol import SHORTEST
from .engine import LiquidSetup

if TYPE_CHECKING:
    from ..boundaries import BodyState

__all__ = ["Blowing", "Blown"]


class Blown(NamedTuple):
    """Effect of fields in a step."""

    change: F64
    """Change of the velocities [m/s], shape (n, 3)."""
    given: F64
    """Momentum [N s] and energy [J], shape (4,)."""


class Blowing:
    """The fields of one run.

    Args:
        setup: of the liquid; times of its fields count from `setup.preroll`.
    """

    def __init__(self, setup: LiquidSetup) -> None:
        self.setup = setup
        self._points: list[tuple[int, F64]] = []
        if any(f.has_medium for f in setup.fields):
            low, high = setup.lower - LEE * setup.spacing, setup.upper + LEE * setup.spacing
            for row, boundary in enumerate(setup.boundaries):
                box = (low, high) if boundary.motion == "static" else (None, None)
                self._points.append((row, surface_points(boundary.mesh, setup.spacing, *box)))

    def acts(self, time: float, dt: float) -> bool:
        """True if any field acts within a step of the engine."""
        since = time - self.setup.preroll
        # A clock that adds up steps may end a rounding after a field begins.
        return any(f.acts(since + SHORTEST, since + dt - SHORTEST) for f in self.setup.fields)

    def kick(
        self, position: F64, velocity: F64, volume: F64, fluid: I64, free: F64, bodies: BodyState, time: float, dt: float
    ) -> Blown:
        """Changes of velocities over a step.

        Args:
            position: of the particles in the world [m], shape (n, 3).
            velocity: theirs [m/s], shape (n, 3).
            volume: theirs [m^3], shape (n,).
            fluid: index of the liquid of each, shape (n,).
            free: 0 for what an opening holds, which nothing moves, else 1, shape (n,).
            bodies: at the start of the step.
            time: the engine's, at the start of the step [s].
            dt: [s]
        """
        setup = self.setup
        mass = volume * np.array([f.density for f in setup.fluids])[fluid]
        matter, now = Matter(position, velocity, mass, volume, fluid), time - setup.preroll + 0.5 * dt
        gain, push = pushed(setup.fields, matter, now, setup.spacing, self._solids(bodies))
        change = dt * (gain + push.force / (mass * (1.0 + dt * push.rate))[:, None]) * free[:, None]
        work = (mass[:, None] * change * (velocity + 0.5 * change)).sum()
        return Blown(change, np.array([*(mass @ change), work]))

    def _solids(self, bodies: BodyState) -> F64:
        """Points on the surfaces of the boundaries, in the world."""
        found = [np.zeros((0, 3))]
        for row, points in self._points:
            found.append(points @ bodies.rotation[row].T + bodies.position[row])
        return np.concatenate(found)

"""Inflows and outflows that hold a level: how much of each is open, by the height of the surface over its gauge.

The surface is read from what particles fill of an upright column: the layer of three spacings about the level, against as thick a
one below it, so that banks beside the gauge do not count.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64

if TYPE_CHECKING:
    from .engine import LiquidSetup, Stage

__all__ = ["Stages"]

COLUMN = 2.0
"""Half width of the column [spacings]."""
HALF = 1.5
"""Half thickness of a layer [spacings]."""
BAND = 0.5
"""Height about the level over which an outflow goes from shut to fully open [spacings]."""
GAIN, RATE = 0.25, 0.5
"""By how much an inflow opens per spacing that the surface is low at once, and in each second."""
SHUT = 1.0
"""Height over the level from which on an inflow gives nothing; half of it below, it begins to close [spacings]."""
DRY = 0.25
"""Share of its room from which on the layer below counts as liquid; under it, the surface is lower than the level."""


class Stages:
    """Open shares of the inflows and outflows of a setup; 1 of those that hold no level.

    Inflows are steered by what is missing now and by what was missing before, so that a steady stream ends at the level itself.

    Attributes:
        inflow: open share of each inflow's speed, shape (k,).
        held: what each inflow has learnt: the share that keeps the level; part of the state of a run.
        outflow: open share of each outflow's box, shape (m,).
    """

    def __init__(self, setup: LiquidSetup) -> None:
        self._spacing = setup.spacing
        self._held = [(n, i.stage) for n, i in enumerate(setup.inflows) if i.stage is not None]
        self._drained = [(n, o.stage) for n, o in enumerate(setup.outflows) if o.stage is not None]
        self.inflow, self.outflow = np.ones(len(setup.inflows)), np.ones(len(setup.outflows))
        self.held = np.full(len(setup.inflows), 0.5)
        self.acts = bool(self._held or self._drained)
        """True if any of them holds a level."""

    def look(self, position: F64, volume: F64, dt: float) -> None:
        """Read the surface.

        Args:
            position: of the particles, world, shape (n, 3) [m].
            volume: of each (n,) [m^3].
            dt: of the step that comes [s].
        """
        for n, stage in self._held:
            low = -self._height(stage, position, volume)
            self.held[n] = np.clip(self.held[n] + RATE * low * dt, 0.0, 1.0)
            self.inflow[n] = np.clip(self.held[n] + GAIN * low, 0.0, 1.0) * np.clip(2.0 * (low / SHUT + 1.0), 0.0, 1.0)
        for n, stage in self._drained:
            self.outflow[n] = np.clip(0.5 + 0.5 * self._height(stage, position, volume) / BAND, 0.0, 1.0)

    def _height(self, stage: Stage, position: F64, volume: F64) -> float:
        """Height of the surface over the level [spacings], within HALF of it."""
        reach = COLUMN * self._spacing
        near = (np.abs(position[:, 0] - stage.x) <= reach) & (np.abs(position[:, 1] - stage.y) <= reach)
        layer = np.floor(((position[near, 2] - stage.level) / self._spacing + HALF) / (2.0 * HALF))
        about, below = (float(volume[near][layer == k].sum()) for k in (0, -1))
        room = (2.0 * COLUMN) ** 2 * 2.0 * HALF * self._spacing**3
        return HALF * (2.0 * min(about / below, 1.0) - 1.0) if below > DRY * room else -HALF

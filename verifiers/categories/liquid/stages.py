"""Inflows and outflows that hold a level: whether the surface over their gauge lets them give or take (R57, R99).

The surface is read from the particles: what lies in an upright column about the gauge, in layers of one spacing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.categories.liquid.facts import gauge_of

if TYPE_CHECKING:
    from .frames import Frame, Liquid, Step

__all__ = ["holds_back"]

COLUMN = 2.0
"""[spacings] Half width of the column, as of `liquid_level_at`."""
OFF = 1.0
"""[spacings] Own choice: the surface counts as higher, or lower, than a level when the layer from here on says so."""
FULL = 0.5
"""[1] Own choice: share of what two spacings deep under the level hold with which as much above it counts as liquid."""
EMPTY = 0.1
"""[1] Own choice: share of its room with which a layer of one spacing below the level counts as empty."""


def holds_back(step: Step, name: str) -> bool:
    """True if an inflow or outflow may not have let anything pass in the frame that ends: its level was passed before it and after it."""
    liquid = step.liquid
    driver = liquid.inflows.get(name) or liquid.outflows[name]
    if driver.level is None or step.before is None:
        return False
    above = name in liquid.inflows
    return all(_passed(liquid, frame, gauge_of(driver), driver.level, above=above) for frame in (step.before, step.now))


def _passed(liquid: Liquid, frame: Frame, gauge: tuple[float, float], level: float, *, above: bool) -> bool:
    s = liquid.spacing
    near = (np.abs(frame.position[:, :2] - np.array(gauge)) <= COLUMN * s).all(axis=1)
    height, volume = frame.position[near, 2] - level, frame.volume[near]

    def held(low: float, high: float) -> float:
        return float(volume[(height > low * s) & (height <= high * s)].sum())

    if above:
        deep = held(-OFF - 2.0, -OFF)
        return deep > 0.0 and held(OFF, OFF + 2.0) >= FULL * deep
    return held(-OFF - 1.0, -OFF) <= EMPTY * (2.0 * COLUMN) ** 2 * s**3

"""Zones along the sides of a liquid's domain that make declared waves and take in those that arrive.

Between the steps of an engine, the velocity of every particle in a zone is drawn towards that of the sea (or towards rest) at a
rate that falls to 0 at the zone's inner end, implicitly: v' = (v + r dt u) / (1 + r dt). Gravity and pressure follow in the same
step, so that a zone at rest stays in hydrostatic balance. Either engine works with it, since both move particles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64
from .engine import LiquidSetup, WaveZones

__all__ = ["Zones"]

RATE = 2.5
"""Rate of the pull at the side, in angular frequencies of the highest waves. Own calculation in linear theory: a zone of one wavelength
reflects 3 % of waves of that frequency, 7 % at 0.8 and 1 % at 1.5 times it (Peric and Abdel-Maksoud find about pi)."""
BLOCKS = 1024
"""Partial sums on a CPU; they decide the last digits of the ledger and nothing else."""
BLOCKS_GPU = 8192


class Zones:
    """The zones of one run.

    Args:
        setup: of the liquid.
        origin: what the engine's places are relative to [m].
        device: where its particles lie.
    """

    def __init__(self, setup: LiquidSetup, origin: F64, device: str) -> None:
        self.device = device
        self.blocks = BLOCKS if device == "cpu" else BLOCKS_GPU
        self._made = [_Made(setup, zones, np.asarray(origin, dtype=np.float64), device) for zones in setup.waves]
        self._given: Any = warp().zeros(self.blocks, dtype=warp().vec4d, device=device) if self._made else None

    def pull(
        self, launch: Callable[[Any, int, list[Any]], None], kernel: str, count: int, particles: list[Any], time: float, dt: float
    ) -> F64:
        """Draw the particles towards the sea for one step from `time` [s].

        Args:
            launch: runs a kernel over so many elements with these inputs.
            kernel: of `zone_kernels`, by name.
            count: particles.
            particles: its arrays of them.
            time: of the engine [s].
            dt: [s]

        Returns:
            Momentum [N s] and energy [J] given to them, (4,).
        """
        from . import zone_kernels

        total = np.zeros(4)
        block = -(-count // self.blocks)
        for one in self._made if count else ():
            one.at(time + 0.5 * dt, dt)
            inputs = [count, block, one.zones, one.state, one.wave, one.pace, *particles, self._given]
            launch(getattr(zone_kernels, kernel), self.blocks, inputs)
            total += self._given.numpy().sum(axis=0)
        return total


class _Made:
    """Arrays of one sea and its zones on a device."""

    def __init__(self, setup: LiquidSetup, zones: WaveZones, origin: F64, device: str) -> None:
        from .zone_kernels import Zones as Struct

        wp, sea = warp(), zones.sea
        self.sea = sea
        low, high = (np.asarray(corner, dtype=np.float64)[:2] - origin[:2] for corner in (setup.lower, setup.upper))
        made = Struct()
        made.low, made.high = wp.vec2(*low), wp.vec2(*high)
        made.generate = wp.vec4(*(zones.width * side for side in zones.generate))
        made.absorb = wp.vec4(*(zones.width * side for side in zones.absorb))
        made.level, made.depth = sea.level - float(origin[2]), sea.depth
        peak = int(np.argmax(sea.amplitude))
        made.rate = RATE * float(sea.omega[peak])
        made.count = len(sea.omega)
        self.zones = made
        self._phase = sea.phase + (sea.number[:, None] * sea.direction) @ origin[:2]
        self._wave = np.zeros((len(sea.omega), 4), dtype=np.float32)
        self._wave[:, :2] = sea.number[:, None] * sea.direction
        self._wave[:, 3] = sea.amplitude
        drift = sea.gravity * sea.amplitude**2 * sea.number / (2.0 * sea.omega * sea.depth)
        self.pace = wp.array(
            np.column_stack([sea.number, sea.omega, -np.expm1(-2.0 * sea.number * sea.depth), drift]).astype(np.float32),
            dtype=wp.vec4,
            device=device,
        )
        self.wave = wp.zeros(len(sea.omega), dtype=wp.vec4, device=device)
        self.state = wp.zeros(2, dtype=wp.float32, device=device)

    def at(self, time: float, dt: float) -> None:
        """Set the clock."""
        self._wave[:, 2] = np.remainder(self._phase - self.sea.omega * time, 2.0 * np.pi)
        self.wave.assign(self._wave)
        self.state.assign(np.array([dt, float(self.sea.strength(time))], dtype=np.float32))

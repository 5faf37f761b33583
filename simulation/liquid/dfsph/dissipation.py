"""Numerical dissipation of motion that particles cannot resolve."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry.launch import warp
from ..engine import LiquidSetup

if TYPE_CHECKING:
    from ...passes import Passes
    from .store import Work

__all__ = ["Dissipation"]

SIGNAL = 1.0
"""Signal velocity in units of sqrt(g spacing). By measurement (`liquid_cases standing-wave`): a wave in water ten spacings deep keeps 0.56
of its height over three periods, 0.48 without, since motion of single particles takes what it would damp, and still water comes to rest."""
MOST = 0.25
"""Signal velocity at most, in spacings per step: the explicit damping of one step stays below the difference itself."""


class Dissipation:
    """Damps what differs between neighbours beyond a smooth field."""

    def __init__(self, setup: LiquidSetup, passes: Passes) -> None:
        self.passes, self.spacing = passes, setup.spacing
        self.signal = SIGNAL * float(np.sqrt(np.linalg.norm(setup.gravity) * setup.spacing))
        self._room = 0

    def apply(self, w: Work, s: Any, n: int, dt: float) -> None:
        """Change velocities by one step of damping."""
        from . import dissipation_kernels as kernels

        wp, run = warp(), self.passes
        if self._room < w.capacity:
            self._room = w.capacity
            self._tensor = wp.zeros(self._room, dtype=wp.mat33, device=run.device)
            self._known = wp.zeros(self._room, dtype=wp.float32, device=run.device)
        lists = [*w.lists, self._tensor, self._known]
        run("shear", kernels.shear, n, [s.x, s.v, *lists])()
        inputs = [s.x, s.v, w.lightness, *lists, self.signal, 0.0, w.settings, w.way]
        run("damp", kernels.damp, n, inputs)({len(inputs) - 2: float(MOST * self.spacing / dt)})
        wp.copy(s.v, w.way, count=n)

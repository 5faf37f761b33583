"""Surface tension of one step: particles attract each other over twice the reach of their pressure, which holds them apart.

Pair forces (Tartakovsky and Meakin 2005, doi:10.1103/PhysRevE.72.026301) are central and equal on both sides, so they keep momentum
and angular momentum; a smooth shape that is long against the spacing does not freeze the particles, as shorter ones do (measured).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.capillarity import is_felt

if TYPE_CHECKING:
    from ...passes import Passes
    from ..engine import LiquidSetup
    from .bodies import Coupling
    from .store import Work

__all__ = ["Tension"]

REACH = 2.0
"""Of the attraction, in supports of the pressure's kernel: two cells of the grid."""
MEAN = 31.0 / 70.0
"""Mean distance of the cubic spline in supports: the integral of 4 pi r^3 W."""
CALIBRATION = 0.74
"""Measured: drops of 5 to 8 spacings radius then swing at Lamb's frequency within 10 %. Sharp surfaces of an even liquid would
have 1 (Fowler 1937, less the pull of the pressure's own kernel)."""
WETTING = 2.3
"""Measured: drops then stand on closed sides at about 90 degrees, on bodies at about 105 (1 + cos(contact angle) were there liquid up to the wall)."""
INNER = 2.75
"""Measured: pressure that the attraction makes inside the liquid, in tension / spacing."""
CAPILLARY = 0.2
"""Step in units of sqrt(density spacing^3 / tension): waves as short as two spacings turn by half a radian."""


class Tension:
    """Surface tension of the fluids on a device."""

    def __init__(self, setup: LiquidSetup, passes: Passes) -> None:
        wp, s = warp(), setup.spacing
        self.passes, self._spacing = passes, s
        gravity = float(np.linalg.norm(setup.gravity))
        felt = [f.surface_tension if is_felt(f.surface_tension, f.density, gravity, s) else 0.0 for f in setup.fluids]
        self.felt = max(felt) > 0.0
        """Whether any fluid has a tension that is felt at this spacing."""
        scale = 8.0 * CALIBRATION / (MEAN * 2.0 * (REACH - 1.0) * s)
        self._strength = wp.array(np.sqrt(np.array(felt) * scale), dtype=wp.float32, device=passes.device)
        self._adhesion = WETTING / (MEAN * s * scale)
        self.inner = np.array([INNER * one / s for one in felt])
        """Pressure that attraction adds inside each fluid [Pa]."""
        steps = [CAPILLARY * np.sqrt(f.density * s**3 / one) for f, one in zip(setup.fluids, felt, strict=True) if one > 0.0]
        self.longest = float(min(steps, default=np.inf))
        """Largest stable step [s]."""

    def apply(self, w: Work, s: Any, coupling: Coupling, grid: list[Any], sides: list[Any], h: float, n: int) -> None:
        """Change velocities by surface tension and adhesion, and give bodies their share."""
        from . import tension_kernels as kernels

        if not self.felt:
            return
        run, k = self.passes, self._strength
        inputs = [s.x, s.volume, w.lightness, s.fluid, k, w.span, *grid, REACH * h, *sides, h, self._adhesion, w.settings, s.v]
        run("attract", kernels.attract, n, inputs)()
        if not coupling.total:
            return
        for sign, force in ((1.0, coupling.pair_force), (-1.0, coupling.pair_return)):
            run(
                f"adhere{sign}",
                kernels.adhere,
                n,
                [s.volume, w.lightness, s.fluid, k, coupling.pairs, self._adhesion, sign, force],
            )()
        run("cling", kernels.cling, n, [s.volume, w.lightness, coupling.pairs, coupling.pair_force, w.settings, s.v])()
        coupling.rubbed()

"""Surface tension of one step: particles attract each other over twice the reach of their pressure, and push each other over a shorter one.

Pair forces (Tartakovsky and Meakin 2005, doi:10.1103/PhysRevE.72.026301) are central and equal on both sides, so they keep momentum
and angular momentum. The push (as in Tartakovsky and Panchenko 2016, doi:10.1016/j.jcp.2015.08.037) holds what the outermost particles
are drawn in with. Attraction alone presses them into a dense skin, and what lies inside against each other: both resist small changes
of shape like something elastic, the more so the finer the particles (measured: drops of 8 spacings radius swung at 1.21 of their frequency).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry.launch import warp
from ....physics.capillarity import is_felt

if TYPE_CHECKING:
    from ...passes import Passes
    from ..engine import LiquidSetup
    from .bodies import Coupling
    from .store import Work

__all__ = ["Tension"]

REACH = 2.0
"""Reach of the attraction, in supports of the pressure's kernel: two cells of the grid."""
CORE_REACH = 1.25
"""Reach of the push, in the same unit."""
CORE = CORE_REACH / REACH
"""Strength of the push in that of the attraction: the pulls of half-spaces on their outermost particles are as 1 / reach, so none is left."""
MEAN = 31.0 / 70.0
"""Mean distance of the cubic spline in supports: the integral of 4 pi r^3 W."""
CALIBRATION = 0.74
"""Measured: drops of 5 to 8 spacings radius then swing at Lamb's frequency within 4 %. Sharp surfaces of an even liquid would
have 1 (Fowler 1937, less the pull of the pressure's own kernel)."""
WETTING = 0.8
"""Measured: drops then stand on bodies at about 105 degrees (1 + cos(contact angle) were there liquid up to the wall)."""
INNER = 1.5
"""Measured: pressure that these forces make inside the liquid beyond that of its surface's curvature, in tension / spacing."""
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
        """True if any fluid has a tension that is felt at this spacing."""
        scale = 8.0 * CALIBRATION / (MEAN * 2.0 * (REACH - 1.0 - CORE * (CORE_REACH - 1.0)) * s)
        self._strength = wp.array(np.sqrt(np.array(felt) * scale), dtype=wp.float32, device=passes.device)
        self._adhesion = WETTING / (MEAN * s * scale)
        self.inner = np.array([INNER * one / s for one in felt])
        """Pressure that pair forces add inside each fluid [Pa]."""
        steps = [CAPILLARY * np.sqrt(f.density * s**3 / one) for f, one in zip(setup.fluids, felt, strict=True) if one > 0.0]
        self.longest = float(min(steps, default=np.inf))
        """Largest stable step [s]."""

    def apply(self, w: Work, s: Any, coupling: Coupling, grid: list[Any], sides: list[Any], h: float, n: int) -> None:
        """Change velocities by surface tension and adhesion, and give bodies their share."""
        from . import tension_kernels as kernels

        if not self.felt:
            return
        run, k = self.passes, self._strength
        ratio = REACH / CORE_REACH
        shape = [REACH * h, ratio, CORE * ratio**5]
        inputs = [s.x, s.volume, w.lightness, s.fluid, k, w.span, *grid, *shape, *sides, h, self._adhesion, w.settings, s.v]
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

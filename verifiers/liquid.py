"""Liquids (R57, R58, R66-R68, R70, R99, R102, R105): one pass over the frames of an instance, seen by one watch per family of claims.

Rows: `category:liquid:<claim>:<solver>` and, of counters, `numerical:<claim>:<solver>`. A claim whose channels are missing is
`unverified`, and the others are judged all the same. Nothing here knows a solver: particles, their surfaces, what was exchanged
and recorded, and the solids of the candidate are all there is.
"""

from __future__ import annotations

from .liquid_across import Across
from .liquid_blown import Blown
from .liquid_coupling import Coupling
from .liquid_density import Density
from .liquid_energy import Energy, Momentum
from .liquid_flight import Flight
from .liquid_frames import liquid_of
from .liquid_leaks import Leaks
from .liquid_ledger import Books, Identity
from .liquid_motion import Motion, Trapped
from .liquid_numerical import Numbers
from .liquid_resolved import Resolved
from .liquid_rows import Watch
from .liquid_sticking import Sticking
from .liquid_surface import Shown
from .liquid_walls import Walls
from .liquid_waves import Waves
from .liquid_wet import Wetted
from .watches import Watching

__all__ = ["WATCHES", "check_instance", "findings_of", "numerical_rows"]

WATCHES: tuple[type[Watch], ...] = (
    *(
        Numbers,
        Books,
        Identity,
        Energy,
        Momentum,
        Walls,
        Leaks,
        Motion,
        Flight,
        Trapped,
        Sticking,
        Resolved,
        Across,
        Density,
        Coupling,
        Shown,
        Waves,
        Blown,
        Wetted,
    ),
)
"""All families, in the order of their rows."""


_WATCHING = Watching(WATCHES, Numbers, liquid_of, lambda liquid: ((step,) for step in liquid.steps()))
findings_of = _WATCHING.findings_of
check_instance = _WATCHING.check_instance
numerical_rows = _WATCHING.numerical_rows

"""Dust that impacts raise.

References:
    Energy of an impact: W. J. Stronge, Impact Mechanics (Cambridge, 2000), 3.3: the work of an impulse is the impulse times the mean of the
    closing speeds before and after it; a dead stop takes half the impulse times the speed before, at most the energy of the reduced mass.
    Dust: S. C. Alfaro, L. Gomes, Modeling mineral aerosol production by wind erosion, Journal of Geophysical Research 106 (2001) 18075,
    doi:10.1029/2000JD900339: the dust that a grain knocks out of soil goes with its kinetic energy.
"""

from __future__ import annotations

import numpy as np

from .arrays import F64

__all__ = ["impact_energy", "reduced_mass"]


def impact_energy(impulse: F64, speed: F64, mass: F64) -> F64:
    """Energy that impacts take if they are dead stops [J].

    Args:
        impulse: normal impulses [N s]; what carries a body after it has landed may be among them.
        speed: closing speeds before [m/s]; bodies that part count as 0.
        mass: reduced masses of both bodies [kg]: a dead stop takes no larger impulse than mass times speed.
    """
    closing = speed.clip(min=0.0)
    return np.asarray(0.5 * closing * np.minimum(impulse, mass * closing), dtype=np.float64)


def reduced_mass(a: F64, b: F64) -> F64:
    """Reduced mass of two bodies [kg]; one that does not give way has an infinite mass."""
    return np.asarray(1.0 / (1.0 / a + 1.0 / b), dtype=np.float64)

"""Names of the numbers of a step and its solves that kernels read and write (`Work.settings`)."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["Slot"]


class Slot(IntEnum):
    """Place of each number in the array."""

    DT = 0
    """Time step [s]."""
    COUNT = 1
    """Particles."""
    BETA = 2
    """Momentum of the solve."""
    NESTEROV = 3
    """Its counter."""
    ERROR = 4
    """Mean error."""
    OMEGA = 5
    """Relaxation: step along the scaled gradient."""
    TIME = 6
    """[s]"""
    OPEN = 8
    """Residual that is left."""
    ASKED = 9
    """Compression that was asked away."""
    FULL = 10
    """Fill of liquid at rest."""
    FRESH = 11
    """Nonzero until an iteration has been made."""
    TOLERANCE = 12
    """Mean error to stop at."""
    MOST = 13
    """Iterations at most."""
    DONE = 14
    """Iterations that were made."""
    MET = 15
    """Nonzero where they met what was asked."""

"""Settings of the particle engine."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DfsphSettings"]


@dataclass(frozen=True)
class DfsphSettings:
    """Bounds of steps and errors; the names are those of the specification."""

    max_step: float = 5e-3
    """Longest step [s]."""
    cfl: float = 0.4
    """Largest travel of a particle per step, in spacings."""
    density_error: float = 5e-4
    """Mean compression at which the density solve ends."""
    divergence_error: float = 1e-3
    """Mean rate of compression times the step at which the divergence solve ends."""
    viscosity_error: float = 1e-2
    """Relative residual at which the implicit viscosity solve ends."""
    iterations: int = 100
    """Most iterations of one solve."""

"""Settings of the grid engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ....worlds.errors import InputError

__all__ = ["FlipSettings"]


@dataclass(frozen=True)
class FlipSettings:
    """Settings of `Flip`; the cell size is `LiquidSetup.spacing`."""

    transfer: Literal["flip", "apic"] = "flip"
    """FLIP is the default: it is the paper's method, needs a third of the memory traffic of APIC and keeps splashes. APIC keeps
    angular momentum and stays calmer."""
    flip_ratio: float = 0.97
    """Share of FLIP in the particles' velocity, the rest PIC; without effect on APIC. 0.95 to 0.99 is usual."""
    particles_per_cell: int = 8
    """Marker particles of a full cell; 1, 8 or 27. Coarser initial particles are split until they are as fine."""
    cfl: float = 3.0
    """Cells that the fastest particle crosses in a step."""
    max_step: float = 1.0 / 24.0
    """Longest step [s]."""
    pressure_error: float = 1e-3
    """Largest relative change of volume of any cell that the projection may leave in one step."""
    iterations: int = 100
    """Cap of a solve; reaching it is reported."""
    volume_correction: float = 0.5
    """Share of the measured compression that is undone in a step, by moving particles (Kugelstadt et al. 2019,
    doi:10.1111/cgf.13620); 0 turns it off."""
    roughness: float = 0.0
    """Roughness length z0 of boundaries and closed sides [m], for friction by the law of the wall; 0: they slip freely.
    A smooth wall has about viscosity / (9 friction velocity), 2e-6 m for water at 1 m/s."""

    def __post_init__(self) -> None:
        """Refuse values outside their range.

        Raises:
            InputError: a value is out of range.
        """
        ranges = {
            "flip_ratio": (0.0, 1.0),
            "cfl": (0.1, 4.0),
            "max_step": (1e-6, 1.0),
            "pressure_error": (1e-6, 0.1),
            "iterations": (1, 10_000),
            "volume_correction": (0.0, 1.0),
            "roughness": (0.0, 10.0),
        }
        for name, (low, high) in ranges.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(f"flip setting {name} = {value!r} is outside [{low:g}, {high:g}]; give a value in that range")
        if self.particles_per_cell not in (1, 8, 27):
            raise InputError(f"flip setting particles_per_cell = {self.particles_per_cell!r}; use 1, 8 or 27")
        if self.transfer not in ("flip", "apic"):
            raise InputError(f"flip setting transfer = {self.transfer!r}; use 'flip' or 'apic'")

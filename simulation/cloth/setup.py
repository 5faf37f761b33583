"""Input and step report of the cloth engine: plain arrays, so that it knows nothing of worlds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from ...physics.substances import AIR_DENSITY
from ...worlds.arrays import F64, I32
from ..step_reports import StepReport
from .mesh import Sheet

if TYPE_CHECKING:
    from ..boundaries import Boundary

__all__ = ["Air", "ClothReport", "ClothSetup", "Hold", "still_air"]

Air = Callable[[F64, float], F64]
"""Function of points (n, 3) [m] and a time [s]: velocity [m/s] and density [kg/m^3] of the air, (n, 4); or acceleration [m/s^2], (n, 3)."""


def still_air(points: F64, time: float) -> F64:
    """Air at rest."""
    del time
    return np.tile([0.0, 0.0, 0.0, AIR_DENSITY], (len(points), 1))


@dataclass(frozen=True)
class Hold:
    """Vertices that go where something takes them."""

    vertices: I32
    """(k,) among all sheets' vertices."""
    boundary: int
    """Row of the body that leads them; -1: they stay where they are."""
    place: F64
    """(k, 3): in the body's frame, or in the world [m]."""


@dataclass(frozen=True)
class ClothSetup:
    """Everything that does not change during a run. Vertices of all sheets stand one after the other."""

    sheets: tuple[Sheet, ...]
    shell: tuple[float, ...]
    """Half the distance at which two layers touch, by sheet [m]."""
    drag: tuple[tuple[float, float], ...]
    """Coefficients of the air across and along the sheet, by sheet."""
    friction: tuple[float, ...]
    """Among the sheets, then with each boundary."""
    gravity: F64
    boundaries: tuple[Boundary, ...] = ()
    holds: tuple[Hold, ...] = ()
    velocity: F64 | None = None
    """At the start, (n, 3) [m/s]; default: at rest."""
    air: Air = still_air
    acceleration: Air | None = None
    """Acceleration by force fields at vertices [m/s^2]."""
    self_collision: bool = True
    integrator: Literal["implicit", "explicit"] = "implicit"
    """implicit: long steps wherever nothing is met and explicit ones would be many."""
    max_step: float = 1 / 240
    """Longest step [s]."""
    exchange: float = 1 / 240
    """Longest time over which bodies are taken to go on as they move [s]."""
    iterations: int = 2
    """Rounds of contact impulses in a step."""
    device: str = "cpu"


@dataclass(frozen=True, kw_only=True)
class ClothReport(StepReport):
    """One exchange of cloth."""

    contact: F64 = field(default_factory=lambda: np.zeros((0, 6)))
    """Part of `impulse` that contact gave, not what hangs on the body (b, 6)."""
    air: F64 = field(default_factory=lambda: np.zeros(4))
    """Momentum [N s] and energy [J] that air and force fields gave, (4,)."""
    held: F64 = field(default_factory=lambda: np.zeros(4))
    """Momentum and energy that what holds vertices in place gave, (4,)."""
    cut: F64 = field(default_factory=lambda: np.zeros(4))
    """Momentum that was lost where displacements were cut short, and how many vertices that were, (4,)."""
    load: F64 = field(default_factory=lambda: np.zeros(4))
    """Momentum and energy that others gave to the vertices, (4,)."""
    work: float = 0.0
    """Energy that moving boundaries gave [J]."""
    contacts: int = 0
    """Pairs that were looked at in the last step."""

"""Step reports: impulses that a sub-step of a coupled solver gave to bodies, and how long it was."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from ..worlds.arrays import F64

if TYPE_CHECKING:
    from .boundaries import Surround

__all__ = ["StepReport"]


@dataclass(frozen=True, kw_only=True)
class StepReport:
    """One exchange of an instance with the bodies that it meets; categories add what they count besides.

    Both sides of the exchange are counted by themselves: `impulse` as given to the bodies, `reaction` on the matter.
    """

    dt: float
    """[s]"""
    impulse: F64
    """Given to each boundary, linear and angular about `BodyState.center` (b, 6) [N s, N m s]."""
    reaction: F64 = field(default_factory=lambda: np.zeros((0, 6)))
    """Change of the matter's own momentum through each boundary, measured on the matter (b, 6)."""
    vertex_impulse: Mapping[int, F64] = field(default_factory=lambda: MappingProxyType({}))
    """Part of `impulse` on each vertex of the deforming boundaries that react: row -> (v, 3) [N s]."""
    steps: int = 1
    """Steps of the engine."""
    fastest: float = 0.0
    """Speed of the fastest particle or vertex [m/s]."""

    @classmethod
    def still(cls, seconds: float, surround: Surround, **more: Any) -> Self:
        """Zero exchange over some seconds."""
        none = np.zeros((len(surround.boundaries), 6))
        at_vertices = {row: np.zeros((len(soft.mass), 3)) for row, soft in surround.soft.items()}
        return cls(dt=seconds, impulse=none, reaction=none, vertex_impulse=at_vertices, **more)

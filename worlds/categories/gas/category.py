"""Gas: declared in the specification, moved by no engine of this build."""

from __future__ import annotations

from ...parameters import PHYSICS, parameters
from ..category import CategorySpec
from ..shared import RESOLUTION, TEMPERATURE
from .models import GasPhysics

__all__ = ["GAS"]

GAS = CategorySpec(
    name="gas",
    shape=GasPhysics.shape,
    physics=GasPhysics,
    parameters=(
        *TEMPERATURE,
        *RESOLUTION,
        *parameters(PHYSICS, "soot_density fuel", "mass", "repair", "no engine moves gas"),
    ),
)

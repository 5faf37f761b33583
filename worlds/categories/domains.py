"""The box in which a fluid is followed, with sides that let it out or hold it."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..vocabulary import Positive, SpecModel, Vec3

__all__ = ["SidedDomain"]

Side = Literal["open", "closed"]


class SidedDomain(SpecModel):
    """Axis-aligned box in which a liquid or gas is simulated. Solids that reach into it are its boundaries."""

    center: Vec3 = Field(description="[m]")
    size: tuple[Positive, Positive, Positive] = Field(description="full extents x, y, z [m]")
    sides: tuple[Side, Side, Side, Side, Side, Side] = Field(
        default=("open", "open", "open", "open", "open", "open"),
        description="-x, +x, -y, +y, -z, +z. open: what leaves is counted as outflow; closed: a smooth wall",
    )

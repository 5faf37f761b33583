"""Names that cloth fills into the diagnosis tables: the wind that blows it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ....worlds.spec import WorldSpec

__all__ = ["wind_names"]

AIRS = ("wind", "turbulence", "vortex")
"""Kinds of fields that make air move."""
STEADY = 0.3
"""Own choice: gusts below this share of the wind's speed are weak."""


def wind_names(spec: WorldSpec, entity: str) -> dict[str, Any]:
    """The strongest wind on a sheet, the same if it hardly gusts, and the sheet itself where no air moves around it."""
    fields = {n: d for n, d in spec.simulation.drivers.items() if d.kind == "field" and d.field.kind in AIRS}
    airs = {n: d.field for n, d in fields.items() if d.entities is None or entity in d.entities}
    winds = {n: f for n, f in airs.items() if f.kind == "wind"}
    wind = max(winds, key=lambda n: sum(v * v for v in winds[n].velocity), default=None)
    steady = wind if winds and max(w.gust for w in winds.values()) < STEADY else None
    return {"wind": wind, "steady": steady, "becalmed": None if airs else entity}

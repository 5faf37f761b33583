"""Registry of recorded quantities: unit, meaning, sign, and whether physics conserves it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["QUANTITIES", "Quantity"]


@dataclass(frozen=True)
class Quantity:
    """One per-frame quantity, written as channel `record/<name>`."""

    name: str
    unit: str
    meaning: str
    conserved: bool = False


_ALL = (
    Quantity("kinetic_energy", "J", "sum over moving bodies"),
    Quantity("potential_energy", "J", "gravity, against z = 0, plus springs"),
    Quantity("driver_work", "J", "work done by drivers since frame 0, positive into the bodies"),
    Quantity("momentum_x", "kg m/s", "sum over moving bodies"),
    Quantity("momentum_y", "kg m/s", "sum over moving bodies"),
    Quantity("momentum_z", "kg m/s", "sum over moving bodies"),
    Quantity("mass", "kg", "sum over moving bodies", conserved=True),
    Quantity("body_count", "1", "moving bodies", conserved=True),
    Quantity("max_speed", "m/s", "fastest centre of mass over all steps of the frame"),
    Quantity("max_travel_per_step", "m", "largest surface travel in one step of the frame"),
    Quantity("steps", "1", "solver steps taken in the frame"),
    Quantity("step", "s", "time step used in the frame"),
    Quantity("contacts_max", "1", "most contacts in one step of the frame"),
    Quantity("iterations_max", "1", "most solver iterations in one step of the frame"),
    Quantity("iterations_capped", "1", "steps that ended at the iteration cap"),
    Quantity("overflows", "1", "engine warnings: full contact or constraint buffers, bad states"),
    Quantity("joint_error", "m", "largest gap of a welded, hinged or sliding joint"),
)
QUANTITIES: Mapping[str, Quantity] = {q.name: q for q in _ALL}

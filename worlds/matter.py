"""Bases of the models of a category: physics of entities, instances that move them, drivers that act on them."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal, Self, get_args

from pydantic import model_validator

from .vocabulary import SpecModel

__all__ = ["DriverBase", "Instance", "Matter", "MatterShape", "TimedDriver"]

STEP_SLACK = 1e-6
"""Clocks of engines that add up their steps may be this far from the time of a frame [s]: far more than rounding, far less than a step."""
MatterShape = Literal["solid", "deforming", "loose"]
"""`solid`: surfaces that keep their form; `deforming`: surfaces that bend; `loose`: matter without a surface of its own."""


class Matter(SpecModel):
    """Physics of an entity of one category, a member of the union `Physics`."""

    shape: ClassVar[MatterShape]
    feels_fields: ClassVar[bool] = False
    """True if force fields act on it."""
    body: ClassVar[bool] = False
    """True if its entities are bodies that rigid instances move and whose contacts they log."""
    levels: ClassVar[bool] = False
    """True if it flows up to a level, above which it leaves its container empty."""

    @property
    def sheet_thickness(self) -> float:
        """Thickness of a sheet, whose surface is its middle [m]; 0 for matter that its surface encloses."""
        return 0.0

    @property
    def lifted(self) -> bool:
        """True if a medium pushes it across the flow too, and turns it."""
        return False

    @property
    def flow_cell(self) -> float:
        """Cell or particle spacing that must fit an opening for it to flow through [m]; 0 for what is no fluid."""
        return 0.0

    def geometry(self) -> dict[str, Any]:
        """Fields on which the geometry and mass of the entity depend, for recipes."""
        return {}


class Instance(SpecModel):
    """A running engine with the entities that it moves, a member of the union `SolverInstance`."""

    moves: ClassVar[tuple[str, ...]]
    """Categories of the members that it moves."""
    meets: ClassVar[tuple[str, ...]] = ()
    """Deforming categories whose surfaces its matter meets: elastic bodies always, cloth where a coupling joins them."""
    carries: ClassVar[bool] = False
    """True if its matter is a medium that drags the members of another instance along, by a one_way coupling to that."""

    @classmethod
    def engine_name(cls) -> str:
        """Name of its engine, by which specifications choose among the instances."""
        return str(get_args(cls.model_fields["engine"].annotation)[0])


class DriverBase(SpecModel):
    """A driver, a member of the union `Driver`."""

    later: ClassVar[frozenset[str]] = frozenset()
    """Fields that decide nothing before it begins: no model, no step length, no state of an engine knows of them earlier."""
    absent: ClassVar[frozenset[str]] = frozenset()
    """Fields that nothing reads in a run from which it is taken away."""
    switched: ClassVar[bool] = False
    """True if no engine lets it act on the state at the very time when it begins: what a step asks of it, it asks before its end."""

    @property
    def watched(self) -> tuple[str, ...]:
        """Entities whose motion it reads, besides that of bodies: the instance of its own entity comes after theirs."""
        return ()

    @property
    def begins(self) -> float:
        """Time at which it acts first within the sequence [s]."""
        return max(0.0, float(getattr(self, "start", getattr(self, "time", 0.0))))

    @property
    def slack(self) -> float:
        """By how much before it begins and ends a state may know of it [s]."""
        return 0.0 if self.switched else STEP_SLACK

    def alike_until(self, other: DriverBase | None) -> float:
        """Time until which motion is the same to the byte with another driver in its place, or with none [s].

        0 where that is not known: only fields named in `later` can give more.
        """
        if type(other) is not type(self):
            return 0.0
        changed = {name for name in type(self).model_fields if getattr(self, name) != getattr(other, name)}
        if not changed <= self.later:
            return 0.0 if changed else math.inf
        times = [d.begins for d in (self, other)]
        if changed == {"end"}:
            times = [math.inf if end is None else float(end) for end in (getattr(d, "end", None) for d in (self, other))]
        return max(0.0, min(times) - self.slack)


class TimedDriver(DriverBase):
    """A driver that acts during [start, end) seconds."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        end = getattr(self, "end", None)
        if end is not None and end <= getattr(self, "start", -math.inf):
            raise ValueError("end must be > start")
        return self

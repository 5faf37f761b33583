"""Types of the registry of fields: causal parameter groups (`groups.py`) and directions (`directions.py`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

__all__ = [
    "BREAKABLE",
    "DRIVER",
    "PHYSICS",
    "POSE",
    "SETTINGS",
    "Direction",
    "EditClass",
    "GroupInfo",
    "Parameter",
    "Way",
    "parameters",
]

EditClass = Literal["scene", "solver", "shot", "story", "text"]
Direction = Literal["harder_up", "harder_down", "either", "repair", "none"]

PHYSICS = "/entities/*/physics"
BREAKABLE = "/entities/*/breakable"
SETTINGS = "/simulation/solvers/*/settings"
DRIVER = "/simulation/drivers/*"
POSE = ". position quaternion euler"
"""Names of a pose and its fields, for `parameters`."""


class GroupInfo(NamedTuple):
    """One causal parameter group."""

    name: str
    edit_class: EditClass
    meaning: str


class Way(NamedTuple):
    """Effect of changing a field on what is asked, with the reason."""

    direction: Direction
    why: str


@dataclass(frozen=True)
class Parameter:
    """A field of the specification, or what holds fields."""

    pointer: str
    """JSON pointer with `*` for ids."""
    group: str
    """Name of its causal parameter group."""
    way: Way
    physical: bool = False
    """It is a quantity of nature: a weakening only where something binds it, or where it leaves its default."""
    eases: tuple[str, ...] = ()
    """Kinds of predicates whose measured value grows as the field becomes smaller."""
    absent: float | None = None
    """Value that it has in effect where it is left out; None: then it is not compared."""


def parameters(root: str, names: str, group: str, direction: Direction, why: str, **more: Any) -> tuple[Parameter, ...]:
    """Fields below `root` that are alike.

    Args:
        root: pointer with `*` for ids.
        names: the fields, separated by spaces; `.` is `root` itself, and a slash leads to what is below a field.
        group: of all of them.
        direction: of all of them.
        why: reason of the direction.
        more: other fields of `Parameter`.
    """
    places = (root if name == "." else f"{root}/{name}" for name in names.split())
    return tuple(Parameter(place, group, Way(direction, why), **more) for place in places)

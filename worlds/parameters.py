"""Types of the registries of fields: causal parameter groups (`groups.py`) and directions (`directions.py`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

__all__ = ["BREAKABLE", "DRIVER", "PHYSICS", "SETTINGS", "Direction", "EditClass", "GroupInfo", "Parameter", "Way", "parameters"]

EditClass = Literal["scene", "solver", "shot", "story", "text"]
Direction = Literal["harder_up", "harder_down", "either", "bound", "repair", "none"]

PHYSICS = "/entities/*/physics"
BREAKABLE = "/entities/*/breakable"
SETTINGS = "/simulation/solvers/*/settings"
DRIVER = "/simulation/drivers/*"


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
    """A field that belongs to a category."""

    pointer: str
    """JSON pointer with `*` for ids."""
    group: str
    """Name of its causal parameter group."""
    way: Way
    below: bool = False
    """It speaks for all that stands below it, too."""
    eases: tuple[str, ...] = ()
    """Kinds of predicates whose measured value grows as the field becomes smaller."""
    absent: float | None = None
    """Value that it has in effect where it is left out; None: then it is not compared."""


def parameters(root: str, names: str, group: str, direction: Direction, why: str, **more: Any) -> tuple[Parameter, ...]:
    """Fields below `root` that are alike.

    Args:
        root: pointer with `*` for ids.
        names: the fields, separated by spaces.
        group: of all of them.
        direction: of all of them.
        why: reason of the direction.
        more: other fields of `Parameter`.
    """
    return tuple(Parameter(f"{root}/{name}", group, Way(direction, why), **more) for name in names.split())

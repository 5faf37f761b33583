"""Vocabulary of what belongs into a room: wishes for furniture, and kinds of rooms that have them (R95)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

__all__ = ["RoomKind", "Rule", "Wish"]

Rule = Literal["wall", "row", "free", "around", "before", "facing", "beside", "on", "flat", "hung", "above", "pairs", "line"]


@dataclass(frozen=True)
class Wish:
    """Furniture that a room has, in order of importance."""

    generators: tuple[str, ...]
    """One of these."""
    rule: Rule = "wall"
    """wall: back to a wall; row: so too, side by side with others of the row; free: in the room; around, before, facing, beside, on: relative
    to `to`; flat: on the floor, walked over; hung: on a wall; above: on the wall above `to`; pairs, line: in two rows along the room, or one
    in the middle."""
    count: tuple[int, int] = (1, 1)
    """So many are asked for where the room is large enough, and at most so many are welcome."""
    to: str = ""
    """Generator of the thing that it belongs to."""
    use: float = 0.0
    """Depth of floor before it from which it is used [m]."""
    seat: bool = False
    """One has to get to it."""
    height: float = 0.0
    """Height above the floor of the middle of what hangs on a wall [m]."""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    sizes: tuple[Mapping[str, Any], ...] = ({},)
    """Further parameters, the most welcome first: the next are for smaller rooms. With `of` it is a thing of that generator instead."""

    under: float = 0.0
    """It is as high as the room less this [m]; 0 for things of their own height."""

    def parameter_sets(self, room_height: float) -> tuple[tuple[str, dict[str, Any]], ...]:
        """Other generator, if any, and all parameters of each size in a room of a height [m]."""
        own = {**self.parameters, "height": round(room_height - self.under, 3)} if self.under else self.parameters
        return tuple((str(s.get("of", "")), {**own, **{k: v for k, v in s.items() if k != "of"}}) for s in self.sizes)


@dataclass(frozen=True)
class RoomKind:
    """A kind of room."""

    area: float
    """[m^2]"""
    width: float
    """Least clear side [m]."""
    aspect: float
    daylight: bool
    floor: str
    """Material of its floor."""
    wishes: tuple[Wish, ...]
    clutter: Mapping[str, tuple[str, ...]]
    """Small things by the generator of what they lie on; "" for all other furniture with surfaces."""
    loose: tuple[str, ...] = ()
    """Small things on the floor along the walls."""
    floor_share: float = 0.5
    """Own choice: share of the floor apart from doors that furniture takes, at most."""
    height: float = 2.6
    """From floor to ceiling where nothing is asked for [m]."""
    walls: str = "gypsum_plaster"
    """Material of its walls."""
    gate: tuple[float, float] | None = None
    """Clear width and height of its doors to the outside, with two leaves [m]; None for doors as asked for."""
    high: bool = False
    """Its windows are under the ceiling."""

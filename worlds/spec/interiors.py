"""Interiors: rooms of a storey with walls, openings and furniture (R48, R95)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ..vocabulary import EntityRef, Id, Positive, SpecModel, Vec3

__all__ = ["Interior", "Room"]

RoomKindName = Literal["living", "kitchen", "bedroom", "bathroom", "hall", "study", "workshop", "store"]


class Room(SpecModel):
    """One room: a rectangle of the plan."""

    kind: RoomKindName = Field(description="decides area, daylight, floor and furniture where nothing else is said")
    area: Annotated[float, Field(ge=2, le=200)] | None = Field(
        default=None, description="[m^2], met within 30 %; default by kind"
    )
    doors: Annotated[list[Id], Field(max_length=12)] = Field(default=[], description="rooms to which a door leads, or `outside`")
    windows: bool | None = Field(default=None, description="windows in its outer walls; default by kind")
    furniture: bool = True
    things: Annotated[int, Field(ge=0, le=300)] | None = Field(
        default=None, description="fill surfaces evenly up to so many things in the room; default by density"
    )


class Interior(SpecModel):
    """A storey of rooms, which build_interior makes entities of: floor, walls, doors, windows, furniture and what lies on it."""

    rooms: Annotated[dict[Id, Room], Field(min_length=1, max_length=12)]
    size: tuple[Positive, Positive] | None = Field(
        default=None, description="extent x, y between the middles of the outer walls [m]; default what the areas need"
    )
    at: Vec3 = Field(default=(0.0, 0.0, 0.0), description="middle of the plan at the upper side of the floor [m]")
    height: float = Field(default=2.6, ge=2.1, le=8.0, description="from floor to ceiling [m]")
    wall: float = Field(default=0.12, ge=0.09, le=0.5, description="thickness of walls [m]")
    door: float = Field(default=0.86, ge=0.62, le=1.2, description="clear width of doors [m]")
    ceiling: bool = Field(default=False, description="a slab over the rooms; without one pictures look in from above")
    density: float = Field(default=0.7, ge=0.0, le=1.0, description="of small things: 0 none, 1 every surface full")
    seed: int = Field(default=0, ge=0, le=2**31 - 1, description="of plan and furniture")
    entities: Annotated[list[EntityRef], Field(max_length=5000)] = Field(
        default=[], description="what build_interior made, written by it"
    )

"""Interiors: rooms of storeys with walls, openings, stairs and furniture (R48, R95)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints, model_validator

from ..vocabulary import EntityRef, Id, Positive, SpecModel, Vec3

__all__ = ["Interior", "Room"]

RoomKindName = Literal[
    "living", "kitchen", "bedroom", "bathroom", "hall", "study", "workshop", "store", "corridor", "stairs", "barn", "museum"
]

ONE_RECTANGLE = ("corridor", "stairs", "barn", "museum")
"""Kinds of rooms that stairs, or things in rows, need as one rectangle."""


class Room(SpecModel):
    """One room: a rectangle of the plan of its storey, or an L of two."""

    kind: RoomKindName = Field(
        description="decides area, daylight, floor and furniture where nothing else is said; corridor: with rooms on both sides; stairs: a "
        "stairwell that joins the storeys of the rooms to which it has doors, one door a storey"
    )
    storey: int = Field(default=0, ge=0, le=5, description="0 is the ground floor")
    area: Annotated[float, Field(ge=2, le=200)] | None = Field(
        default=None, description="[m^2], met within 30 %; default by kind"
    )
    doors: Annotated[list[Id], Field(max_length=12)] = Field(default=[], description="rooms to which a door leads, or `outside`")
    shape: Literal["rectangle", "L"] = Field(
        default="rectangle",
        description="L: two rectangles without a wall between them; the other rooms of its storey fill the corner",
    )
    windows: bool | None = Field(default=None, description="windows in its outer walls; default by kind")
    furniture: bool = True
    things: Annotated[int, Field(ge=0, le=300)] | None = Field(
        default=None, description="fill surfaces evenly up to so many things in the room; default by density"
    )
    width: Annotated[float, Field(ge=0.9, le=4.0)] | None = Field(
        default=None, description="clear width of a corridor [m]; default 1.6"
    )
    stairs: Literal["two_flights", "straight"] = Field(
        default="two_flights",
        description="of kind stairs: two flights with a landing, or a straight flight in an opening with railings, floor beside it (2 x 6 m)",
    )
    open: bool = Field(default=False, description="of kind stairs: no wall and door between it and its rooms")
    steps: int = Field(
        default=0, ge=0, le=6, description="steps across a corridor, 0.16 m each: rooms beyond them have the higher floor"
    )

    @model_validator(mode="after")
    def _of_corridors(self) -> Room:
        if self.kind != "corridor" and (self.width is not None or self.steps):
            raise ValueError(f"width and steps are those of a corridor, not of a {self.kind}")
        if self.kind != "stairs" and (self.stairs != "two_flights" or self.open):
            raise ValueError(f"stairs and open are those of a room of kind stairs, not of a {self.kind}")
        if self.shape == "L" and self.kind in ONE_RECTANGLE:
            raise ValueError(
                f"a {self.kind} is a rectangle; an L may be a living, kitchen, bedroom, bathroom, hall, study, workshop or store"
            )
        return self


class Interior(SpecModel):
    """Storeys of rooms, which build_interior makes entities of: floors, walls, stairs, doors, windows, furniture and what lies on it."""

    rooms: Annotated[dict[Id, Room], Field(min_length=1, max_length=30)]
    size: tuple[Positive, Positive] | None = Field(
        default=None, description="extent x, y between the middles of the outer walls [m]; default what the areas need"
    )
    at: Vec3 = Field(default=(0.0, 0.0, 0.0), description="middle of the plan at the upper side of the lowest floor [m]")
    on: EntityRef | None = Field(
        default=None,
        description="ground on which it stands, e.g. what build_terrain made: the floor follows the ground at the first door to the outside, "
        "a plinth closes the gap below the walls, steps lead up to doors; z of `at` is then ignored",
    )
    entrance: Literal["west", "south", "east", "north"] | None = Field(
        default=None, description="side of the doors to the outside; default any"
    )
    height: Annotated[float, Field(ge=2.1, le=8.0)] | None = Field(
        default=None, description="from floor to ceiling [m]; default 2.6, more for barns and museums"
    )
    wall: float = Field(default=0.12, ge=0.09, le=0.5, description="thickness of walls [m]")
    door: float = Field(default=0.86, ge=0.62, le=1.2, description="clear width of doors [m]")
    ceiling: bool = Field(default=False, description="a slab over the highest rooms; without one pictures look in from above")
    roof: Literal["none", "gable", "hipped"] = Field(
        default="none", description="over the walls, the ridge along the longer side; at most 12 x 8 m"
    )
    walls: str | None = Field(
        default=None, min_length=1, max_length=64, description="material of the walls; default plaster, of a barn larch"
    )
    density: float = Field(default=0.7, ge=0.0, le=1.0, description="of small things: 0 none, 1 every surface full")
    still: bool = Field(
        default=False,
        description="furniture, doors and small things are static from the start, what hangs on joints or lies loose on them too, as they stand",
    )
    moves: Annotated[list[Annotated[str, StringConstraints(min_length=1, max_length=64)]], Field(max_length=60)] = Field(
        default=[],
        description="of a still interior what moves all the same: ids of things, kinds (tin_can), rooms; what lies on them moves as well",
    )
    seed: int = Field(default=0, ge=0, le=2**31 - 1, description="of plan and furniture")
    entities: Annotated[list[EntityRef], Field(max_length=5000)] = Field(
        default=[], description="what build_interior made, written by it"
    )

    @model_validator(mode="after")
    def _still(self) -> Interior:
        if self.moves and not self.still:
            raise ValueError("moves names what moves of an interior that is still: give still: true with it, or leave it out")
        return self

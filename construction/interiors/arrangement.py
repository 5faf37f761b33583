"""A room while it is furnished: what stands, hangs and lies in it so far, and how a step is taken back (R48, R95)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from .floor_space import APART, FloorSpace, Spot
from .pieces import Piece
from .plans import Rect
from .swept import Volume

__all__ = ["Arrangement", "Fixture", "Frame", "Hung", "Mark", "Standing", "over", "within"]

TOUCHING = 0.02
"""[m] Own choice: what opens may come so far over the face of a wall; boxes of what turns are a little too large."""


@dataclass
class Standing:
    """A thing in its place."""

    piece: Piece
    x: float
    y: float
    z: float
    yaw: float
    """[rad]"""
    carrier: str
    """`floor`, `walls`, or the id of what it lies on."""
    body: str = ""
    """Body of the carrier, "" for the main one."""
    id: str = ""
    still: bool = False
    """It never moves: what hangs on a wall."""
    spot: Spot | None = None
    """Where it stands on the floor or hangs; None of what lies on other things."""
    row: bool = False
    """It is one of a row of cabinets."""

    @cached_property
    def solid(self) -> Volume:
        """Boxes of its bodies in the room."""
        return self.piece.solid.placed(self.x, self.y, self.z, self.yaw)

    @cached_property
    def swept(self) -> Volume:
        """Boxes that its joints sweep, in the room."""
        return self.piece.swept.placed(self.x, self.y, self.z, self.yaw)


class Fixture(NamedTuple):
    """A window: it is in a wall of the room and opens into it."""

    name: str
    solid: Volume
    swept: Volume


class Frame(NamedTuple):
    """Name, height and gaps of a room."""

    id: str
    """Beginning of the ids of all that stands in it."""
    height: float
    """[m]"""
    gap: float
    """[m] between a thing and what carries it: two collision skins."""


class Hung(NamedTuple):
    """A thing on a wall: from above, and from which height to which [m]."""

    foot: Rect
    low: float
    high: float


class Mark(NamedTuple):
    """Numbers of things that stood in a room at some time."""

    standing: int
    hung: int
    flat: int
    solid: int
    access: int


@dataclass
class Arrangement:
    """Things of a room in the order in which they were placed."""

    frame: Frame
    space: FloorSpace
    rng: np.random.Generator
    standing: list[Standing] = field(default_factory=list)
    hung: list[Hung] = field(default_factory=list)
    flat: list[Rect] = field(default_factory=list)
    fixtures: list[Fixture] = field(default_factory=list)
    """Footprints of what lies flat on the floor and is walked over."""

    def put(self, own: Piece, spot: Spot, z: float, carrier: str, *, still: bool = False) -> Standing:
        """Add a thing on the floor or a wall at a height [m]."""
        return self.lay(Standing(own, spot.x, spot.y, z, spot.yaw, carrier, still=still, spot=spot))

    def lay(self, found: Standing) -> Standing:
        """Add a thing in its place and name it."""
        name = found.piece.generator
        number = 1 + sum(s.piece.generator == name for s in self.standing)
        found.id = f"{self.frame.id}_{name}" if number == 1 else f"{self.frame.id}_{name}_{number}"
        self.standing.append(found)
        return found

    def mark(self) -> Mark:
        """This state, to come back to."""
        space = self.space
        return Mark(*(len(v) for v in (self.standing, self.hung, self.flat, space.solid, space.access)))

    def back(self, mark: Mark) -> None:
        """Take away all that was placed since."""
        del self.standing[mark.standing :]
        del self.hung[mark.hung :]
        del self.flat[mark.flat :]
        del self.space.solid[mark.solid :]
        del self.space.access[mark.access :]

    def barred(self, own: Piece, at: tuple[float, float, float], yaw: float, *, seat_of: str = "") -> str | None:
        """The thing that opens and would meet another at a point [m], or that keeps the other's own doors and drawers shut, in words.

        Args:
            own: the thing.
            at: where its own frame stands.
            yaw: its turn about z [rad].
            seat_of: generator of what it stands at on purpose, as a chair at its desk: it is pulled out to sit on.
        """
        solid, swept = own.solid.placed(*at, yaw), own.swept.placed(*at, yaw)
        skin = self.frame.gap
        if any(f.solid.meets(Volume(solid.low - skin, solid.high + skin)) for f in self.fixtures):
            return "a window"
        why = self.shut(solid, seat_of=seat_of)
        if why is not None or len(swept.low) == 0:
            return why
        room, above = self.space.room, self.frame.height
        low, high = (room.x0 - TOUCHING, room.y0 - TOUCHING, -TOUCHING), (room.x1 + TOUCHING, room.y1 + TOUCHING, above)
        corner = room_beyond(self.space, above)
        if not swept.within(low, high) or (corner is not None and swept.meets(corner)):
            return "the walls, as it opens,"
        named = [*((f.name, f.solid) for f in self.fixtures), *((s.piece.generator, s.solid) for s in self.standing)]
        return next((f"a {name}, as it opens," for name, there in named if swept.meets(there)), None)

    def shut(self, solid: Volume, *, seat_of: str = "") -> str | None:
        """The thing that could not open any more if something took a volume, in words."""
        for fixture in self.fixtures:
            if fixture.swept.meets(solid):
                return f"the sashes of a {fixture.name}"
        for other in self.standing:
            if other.piece.swept.low.size and other.piece.generator != seat_of and other.swept.meets(solid):
                return f"what opens of a {other.piece.generator}"
        return None

    def on_floor(self) -> Iterator[tuple[Standing, Rect]]:
        """Things on the floor with their footprints [m]."""
        return ((s, s.spot.rect(s.piece.foot)) for s in self.standing if s.carrier == "floor" and s.spot is not None)


def room_beyond(space: FloorSpace, height: float) -> Volume | None:
    """The corner that an L-shaped room leaves out, less what may be touched; None of a rectangular one."""
    n = space.notch
    if n is None:
        return None
    low, high = (n.x0 + TOUCHING, n.y0 + TOUCHING, 0.0), (n.x1 - TOUCHING, n.y1 - TOUCHING, height)
    return Volume(np.array([low]), np.array([high]))


def over(a: Rect, b: Rect, gap: float = APART) -> bool:
    """True if two rectangles are nearer than a gap [m]."""
    return a.x0 < b.x1 + gap and b.x0 < a.x1 + gap and a.y0 < b.y1 + gap and b.y0 < a.y1 + gap


def within(a: Rect, b: Rect) -> bool:
    """True if a rectangle lies in another."""
    return a.x0 >= b.x0 and a.y0 >= b.y0 and a.x1 <= b.x1 and a.y1 <= b.y1

"""Things that never move: which of an interior's are, and how they lie on each other and hold their doors and lids (R48).

What moves needs room for the collision skins of two bodies, and comes to rest on them. What never moves is drawn with that room for ever,
and several such gaps on the way to the ground are told as air; so it is placed as near as walls are to floors.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...geometry import Solid, kept_solid
from ...worlds.arrays import RigidPose, pose_of
from ...worlds.errors import InputError
from ...worlds.hints import did_you_mean
from ...worlds.spec import Interior
from ..assets.documents import body_boxes, part_boxes
from ..assets.made import Body, Made
from ..assets.registry import GENERATORS
from ..kept_shapes import kept_shape
from ..placing import lowered
from ..scenes import STILL_GAP
from ..scenes import Body as Surfaces
from .arrangement import Standing
from .pieces import Piece

__all__ = ["Still", "lowerings", "stilled"]

REACH = 3e-3
"""[m] Own choice: what lies loosely on another body of its thing is no further above it than 2 mm (`testing/assets.py`)."""
TOLD = 20
"""Names that a refusal tells."""


class Still:
    """What of an interior never moves.

    Args:
        interior: what is asked for.
    """

    def __init__(self, interior: Interior) -> None:
        self.all, self.moves = interior.still, frozenset(interior.moves)
        self._met: set[str] = set()
        self._pieces: dict[int, tuple[Piece, Piece]] = {}

    def of(self, key: str, kind: str, *rooms: str) -> bool:
        """True if a thing never moves of which the id, the generator and the rooms are known."""
        met = self.moves & {key, kind, *rooms}
        self._met |= met
        return self.all and not met

    def among(self, standing: Sequence[Standing], room: str) -> dict[str, bool]:
        """Whether each thing of a room never moves, by id: what lies on something that moves moves as well."""
        found: dict[str, bool] = {}
        for thing in standing:  # carriers are placed before what they carry
            found[thing.id] = self.of(thing.id, thing.piece.generator, room) and found.get(thing.carrier, True)
        return found

    def piece(self, moving: Piece) -> Piece:
        """A thing as one that never moves, see `stilled`; it stands in many places."""
        if id(moving) not in self._pieces:
            made = stilled(moving.made)
            self._pieces[id(moving)] = moving, replace(moving, made=made, parts=part_boxes(made))
        return self._pieces[id(moving)][1]

    def unmet(self, ids: Collection[str], rooms: Collection[str]) -> list[str]:
        """Sentences about kinds that are said to move and of which nothing stands there.

        Raises:
            InputError: a name is neither that of a thing, a kind nor a room.
        """
        missing = sorted(self.moves - self._met)
        for name in (n for n in missing if n not in GENERATORS):
            known = [*rooms, *GENERATORS, *ids]
            hint = did_you_mean(name, known) or ";"
            raise InputError(
                f"moves names {name[:64]!r}, which is no thing, kind or room of this interior{hint} things are {sorted(ids)[:TOLD]}; "
                "build it without moves to see all ids, or give a kind as inspect_world(part='assets') lists them"
            )
        return [f"no {name} stands here, which moves names" for name in missing]


def lowerings(standing: Sequence[Standing], still: Mapping[str, bool], gap: float) -> dict[str, float]:
    """How much lower than with the gap of skins each thing stands [m], by id.

    Args:
        standing: things of a room, carriers before what they carry.
        still: whether each never moves, by id.
        gap: at which they were placed [m].
    """
    found: dict[str, float] = {}
    for thing in standing:
        below = found.get(thing.carrier, 0.0)
        closer = still[thing.id] and thing.carrier != "walls"
        found[thing.id] = below + (max(0.0, gap - STILL_GAP) if closer else 0.0)
    return found


def stilled(made: Made) -> Made:
    """The thing with all its bodies static, and what lies loosely on them lowered until it touches."""
    bodies = {name: replace(body, motion="static") for name, body in made.bodies.items()}
    boxes = body_boxes(made)
    places = dict(made.places)
    for name in sorted({b for _, b in made.carries}, key=lambda b: float(boxes[b][0][2])):
        above = {name, *_carried(made, name)}
        others = [part for n, body in bodies.items() if n not in above for part in _parts(body)]
        here = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        down = np.array([0.0, 0.0, -1.0])
        found = lowered(Surfaces(tuple(_parts(bodies[name]))), here, Surfaces(tuple(others)), here, down, STILL_GAP, REACH)
        # What also stands on the ground is not let into it.
        way = 0.0 if found is None else min(-float(found.position[2]), max(0.0, float(boxes[name][0][2])))
        if way > 0.0:
            for n in above:
                bodies[n] = _shifted(bodies[n], way)
            places = {k: replace(p, center=_lower(p.center, way)) if p.body in above else p for k, p in places.items()}
    return replace(made, bodies=bodies, places=places)


def _carried(made: Made, name: str) -> Iterator[str]:
    """Bodies that lie on a body or hang on it, and what these carry."""
    known = [name]
    for one in known:
        known += [b for a, b in made.carries if a == one and b not in known]
        known += [j.child for j in made.joints.values() if j.parent == one and j.child not in known]
    yield from known[1:]


def _parts(body: Body) -> Iterator[tuple[RigidPose, Solid]]:
    for part in body.parts.values():
        yield pose_of(part.pose), kept_solid(kept_shape(part.shape, Path()).geometry.render, closed=True)


def _lower(point: Sequence[float], way: float) -> tuple[float, float, float]:
    x, y, z = (float(c) for c in point)
    return (x, y, z - way)


def _shifted(body: Body, way: float) -> Body:
    parts = {
        key: part.model_copy(update={"pose": part.pose.model_copy(update={"position": _lower(part.pose.position, way)})})
        for key, part in body.parts.items()
    }
    return replace(body, parts=parts)

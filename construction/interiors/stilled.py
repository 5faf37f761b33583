"""Things that never move: which of an interior's are, and how they lie on each other and hold their doors and lids (R48).

What moves needs room for the collision skins of two bodies, and comes to rest on them. What never moves is drawn with that room for ever,
and several such gaps on the way to the ground are told as air; so it is placed as near as walls are to floors.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...geometry import Solid, kept_solid, signed_clearance
from ...worlds.arrays import F64, RigidPose, pose_of
from ...worlds.errors import InputError
from ...worlds.hints import did_you_mean
from ...worlds.spec import Interior
from ..assets.documents import body_boxes, part_boxes
from ..assets.made import Body, Made, Point
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
HUNG = 5e-3
"""[m] Own choice: what hangs further than that from its holder hangs on a rope or chain; generators make joints within 3 mm."""
HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
Part = tuple[RigidPose, Solid]
"""Place and surface of a part, in the thing's frame."""
TOLD = 20
"""Names that a refusal tells."""


class Still:
    """Decides on the things of an interior that never move.

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
        """True for each thing of a room that never moves, by id: what lies on something that moves moves as well."""
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
    """Way that each thing of a room stands lower than with the gap of skins [m], by id.

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
    """The thing with all its bodies static; those that hang on joints or lie loosely on others are brought to what holds them."""
    still = replace(made, bodies={name: replace(body, motion="static") for name, body in made.bodies.items()})
    hung: list[str] = []
    for joint in made.joints.values():
        hung += [joint.child] if joint.child not in hung else []
    for name in sorted(hung, key=lambda child: len(_owners(made, child))):
        still = _hung(still, name)
    low = {name: float(box[0][2]) for name, box in body_boxes(made).items()}
    for name in sorted({b for _, b in made.carries}, key=low.__getitem__):
        still = _lowered(still, name)
    return still


def _hung(made: Made, name: str) -> Made:
    """The thing with one body, and what that carries, moved to what its joint hangs it on, as far as nothing else is in the way."""
    above = {name, *_carried(made, name)}
    parent = next(j.parent for j in made.joints.values() if j.child == name)
    if parent in above:
        return made
    gap, way = _nearest([*_parts(made.bodies[name])], [*_parts(made.bodies[parent])])
    others = [part for n, body in made.bodies.items() if n not in above for part in _parts(body)]
    room, _ = _nearest([part for n in above for part in _parts(made.bodies[n])], others)
    # Whatever is at least so far away is not met by a move of that length, in any direction.
    far = min(gap, room) - STILL_GAP
    if not 0.0 < far < gap <= HUNG:
        return made
    # It stays before the back of the thing, at which a wall may be, and above its foot; other things stand a centimetre apart.
    boxes = body_boxes(made)
    (low, high), (own_low, own_high) = _around(boxes.values()), _around(boxes[n] for n in above)
    move = far / gap * way
    back, foot = max(0.0, float(high[1] - own_high[1])), min(0.0, float(low[2] - own_low[2]))
    return _shifted(made, above, np.array([move[0], min(float(move[1]), back), max(float(move[2]), foot)]))


def _lowered(made: Made, name: str) -> Made:
    """The thing with one body that lies loosely on others, and what that carries, lowered until it touches."""
    above = {name, *_carried(made, name)}
    own = Surfaces(tuple(_parts(made.bodies[name])))
    others = Surfaces(tuple(part for n, body in made.bodies.items() if n not in above for part in _parts(body)))
    found = lowered(own, HERE, others, HERE, np.array([0.0, 0.0, -1.0]), STILL_GAP, REACH)
    # What also stands on the ground is not let into it.
    way = 0.0 if found is None else min(-float(found.position[2]), max(0.0, float(body_boxes(made)[name][0][2])))
    return _shifted(made, above, np.array([0.0, 0.0, -way])) if way > 0.0 else made


def _around(boxes: Iterable[tuple[F64, F64]]) -> tuple[F64, F64]:
    """Least and greatest corner of boxes [m]."""
    low, high = zip(*boxes, strict=True)
    return np.min(low, axis=0), np.max(high, axis=0)


def _owners(made: Made, name: str) -> list[str]:
    """Bodies on which a body hangs by joints, one on the other; the nearest first."""
    found: list[str] = []
    parents = {j.child: j.parent for j in made.joints.values()}
    while name in parents and parents[name] not in found:
        name = parents[name]
        found.append(name)
    return found


def _nearest(own: Sequence[Part], others: Sequence[Part]) -> tuple[float, F64]:
    """Least clearance [m] between parts, and the way that closes it, shape (3,); infinite where there are none."""
    best, way = np.inf, np.zeros(3)
    low, high = (np.array([f(place.apply(solid.vertices), axis=0) for place, solid in others]) for f in (np.min, np.max))
    for place, solid in own if len(others) else ():
        points = place.apply(solid.vertices)
        apart = np.linalg.norm(np.maximum(np.maximum(low - points.max(0), points.min(0) - high), 0.0), axis=1)
        for k in np.argsort(apart, kind="stable"):
            if apart[k] >= best:
                break
            found = signed_clearance(solid, place, others[k][1], others[k][0])
            if found.distance < best:
                best, way = float(found.distance), np.asarray(found.point_b) - np.asarray(found.point_a)
    return best, way


def _carried(made: Made, name: str) -> Iterator[str]:
    """Bodies that lie on a body or hang on it, and what these carry."""
    known = [name]
    for one in known:
        known += [b for a, b in made.carries if a == one and b not in known]
        known += [j.child for j in made.joints.values() if j.parent == one and j.child not in known]
    yield from known[1:]


def _parts(body: Body) -> Iterator[Part]:
    for part in body.parts.values():
        yield pose_of(part.pose), kept_solid(kept_shape(part.shape, Path()).geometry.render, closed=True)


def _moved(point: Point, way: F64) -> tuple[float, float, float]:
    x, y, z = (float(c) + float(w) for c, w in zip(point, way, strict=True))
    return (x, y, z)


def _shifted(made: Made, names: Collection[str], way: F64) -> Made:
    """The thing with some bodies, and the places on them, moved [m]."""
    bodies = dict(made.bodies)
    for name in names:
        parts = {
            key: part.model_copy(update={"pose": part.pose.model_copy(update={"position": _moved(part.pose.position, way)})})
            for key, part in bodies[name].parts.items()
        }
        bodies[name] = replace(bodies[name], parts=parts)
    places = {k: replace(p, center=_moved(p.center, way)) if p.body in names else p for k, p in made.places.items()}
    return replace(made, bodies=bodies, places=places)

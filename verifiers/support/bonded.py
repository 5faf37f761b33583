"""Rows about what points of space hold of cloth, elastic and breakable bodies: something drawn that never moves is there, or `afloat` says why not.

A pin without a carrier and a side that is bonded to the world bear any load, as joints without a parent do (`support/anchored.py`), and
have the same duty: a thing that never moves lies at what they hold, or a landscape, or the body gives a reason, which is printed (R92, R154).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, pose_of
from ...worlds.errors import EvidenceError
from ...worlds.spec import ClothPhysics, ElasticPhysics
from ..land.grounds import lands
from ..rows.answers import row_of
from ..rows.corrections import correction, move_by, pointer, say_afloat
from ..rows.findings import Finding
from .bounds import RIM, SIDE_LEVEL, SIDE_SAMPLES
from .joined import reach_of, way_to
from .pinned import pin_bound, pinned_points
from .questions import BONDED, PIN
from .stillness import is_still

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ..scene.surfaces import Surfaces

__all__ = ["bonded_rows"]


class Fixture(NamedTuple):
    """A pin or a bonded side of a body at points of space."""

    entity: str
    key: str
    """Id of the pin; name of the side."""
    what: str
    """In words."""
    where: tuple[str | int, ...]
    """Steps of the pointer to it."""
    low: F64
    """Corner of the box that it holds, in the entity's frame [m]."""
    high: F64


class Footing(NamedTuple):
    """The nearest thing that never moves."""

    entity: str
    distance: float
    """[m]"""
    bound: float
    """[m]"""
    way: F64
    """From what is held to it [m], shape (3,)."""


def bonded_rows(surfaces: Surfaces) -> list[Row]:
    """Rows `support:pin:<entity>:<pin>` of pins that no body carries, and `support:bonded:<entity>:<side>` of sides bonded to the world."""
    candidate, found = surfaces.candidate, []
    for name, entity in candidate.spec.entities.items():
        physics = entity.physics
        if isinstance(physics, ClothPhysics | ElasticPhysics):
            for key, pin in physics.pins.items():
                if pin.to is None:
                    judge = partial(_pin, surfaces, name, key)
                    found.append(row_of(candidate, PIN, (name, key), judge, entities=(name,)))
        if entity.breakable is not None:
            for side in dict.fromkeys(entity.breakable.fixed):
                judge = partial(_side, surfaces, name, side)
                found.append(row_of(candidate, BONDED, (name, side), judge, entities=(name,)))
    return found


def _pin(surfaces: Surfaces, name: str, key: str) -> Finding:
    surfaces.require(name)
    entity = surfaces.candidate.spec.entities[name]
    parts = surfaces.candidate.entity(name).parts
    own = pinned_points(entity, key, np.concatenate([(p.simulation or p.render).vertices for p in parts]))
    if not len(own):
        raise EvidenceError(f"pin {key!r} of {name!r} holds no vertex")
    low, high = own.min(axis=0), own.max(axis=0)
    if isinstance(entity.physics, ElasticPhysics):
        pin = entity.physics.pins[key]
        low, high = (np.array(pin.center) + sign * 0.5 * np.array(pin.size) for sign in (-1.0, 1.0))
    one = Fixture(name, key, f"pin {key!r} of {name!r}", ("entities", name, "physics", "pins", key), low, high)
    return _judged(surfaces, one, pose_of(entity.pose).apply(own))


def _side(surfaces: Surfaces, name: str, side: str) -> Finding:
    surfaces.require(name)
    candidate = surfaces.candidate
    # Triangles of what is drawn, in the entity's frame.
    drawn = [
        candidate.body(name, p.body).pose.apply(surfaces.shapes.solid(i, 0).vertices)[surfaces.shapes.solid(i, 0).faces]
        for i, p in ((i, surfaces.parts[i]) for i in surfaces.parts_of[name])
    ]
    corners = np.concatenate(drawn)
    axis, sign = "xyz".index(side[0]), 1.0 if side[1] == "+" else -1.0
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    slack = SIDE_LEVEL * float(np.linalg.norm(high - low))
    level = high[axis] if sign > 0 else low[axis]
    flat = corners[(np.abs(corners[:, :, axis] - level) <= slack).all(axis=1)]
    if not len(flat):
        raise EvidenceError(f"no drawn face of {name!r} lies on its side {side}")
    # What only meets the rim of a side, as the ground does that a wall stands on, is not what the side is bonded to.
    rim = np.minimum(RIM * _reach(surfaces, name, name), 0.5 * (high - low))
    low, high = low + rim, high - rim
    low[axis], high[axis] = level, level
    place = ("entities", name, "breakable", "fixed")
    one = Fixture(name, side, f"side {side} of {name!r}", place, low, high)
    return _judged(surfaces, one, pose_of(candidate.spec.entities[name].pose).apply(np.clip(_sampled(flat), low, high)))


def _sampled(triangles: F64) -> F64:
    """Points of triangles (n, 3, 3), corners among them, shape (m, 3)."""
    count = SIDE_SAMPLES
    share = np.array([(i, j, count - i - j) for i in range(count + 1) for j in range(count + 1 - i)]) / count
    return np.unique(np.round((share @ triangles).reshape(-1, 3), 9), axis=0)


def _in_land(surfaces: Surfaces, points: F64) -> bool:
    bound = surfaces.candidate.spec.simulation.limits.contact_gap
    try:
        return any(bool((points[:, 2] <= land.heights_at(points) + bound).any()) for land in lands(surfaces.candidate))
    except EvidenceError:
        return False


def _footing(surfaces: Surfaces, one: Fixture, points: F64) -> Footing | None:
    """The thing that never moves and is nearest to what is held, compared with what counts as reached."""
    best: Footing | None = None
    for name in surfaces.entities:
        if not is_still(surfaces.candidate.spec, name) or name in surfaces.broken or name == one.entity:
            continue
        bound = _bound(surfaces, one, name)
        distance, point, nearest = way_to(surfaces, name, points)
        if distance > bound:
            distance = min(distance, _met(surfaces, one, name, bound))
        if best is None or distance - bound < best.distance - best.bound:
            best = Footing(name, distance, bound, nearest - point)
        if best.distance <= best.bound:
            break
    return best


def _bound(surfaces: Surfaces, one: Fixture, name: str) -> float:
    if surfaces.candidate.spec.entities[one.entity].breakable is None:
        return pin_bound(surfaces, one.entity, name)
    return _reach(surfaces, one.entity, name)


def _reach(surfaces: Surfaces, a: str, b: str) -> float:
    """Largest distance of a bonded side from what holds it [m]: the contact tolerance (S3) and two collision skins."""
    return 2.0 * reach_of(surfaces, a, b) - surfaces.contact_gap(a, b)


def _met(surfaces: Surfaces, one: Fixture, name: str, bound: float) -> float:
    """Clearance of the two where they are nearest [m], if that is at what is held: things narrower than the points lie apart."""
    if isinstance(surfaces.candidate.spec.entities[one.entity].physics, ClothPhysics):
        return float(np.inf)
    gap = surfaces.gap(one.entity, name, 0)
    own = pose_of(surfaces.candidate.spec.entities[one.entity].pose).inverse().apply(np.asarray(gap.point_a)[None])[0]
    slack = np.where(one.high > one.low, 0.0, bound)
    inside = bool(((own >= one.low - slack) & (own <= one.high + slack)).all())
    return max(0.0, float(gap.distance)) if inside else float(np.inf)


def _judged(surfaces: Surfaces, one: Fixture, points: F64) -> Finding:
    reason = surfaces.candidate.spec.entities[one.entity].afloat
    common: dict[str, Any] = {
        "frames": (0, 0),
        "extra": [reason],
        "predicate": f"{one.what} holds it at something that never moves, or {one.entity} says why nothing does: afloat",
    }
    if _in_land(surfaces, points):
        return Finding("pass", f"what {one.what} holds lies at the ground", **common)
    found = _footing(surfaces, one, points)
    if found is not None and found.distance <= found.bound:
        text = f"what {one.what} holds is {found.distance:.3g} m from {found.entity!r}, which never moves"
        return Finding("pass", text, found.distance, found.bound, entities=(one.entity, found.entity), **common)
    if reason is not None:
        return Finding("pass", f"{one.what} is held at points of space: {reason}", **common)
    text = f"{one.what} is held at points of space, where nothing is drawn that never moves"
    if found is not None:
        text += f": {found.entity!r} is the nearest, {found.distance * 1e3:.4g} mm away, at most {found.bound * 1e3:.4g} mm are allowed"
    return Finding(
        "fail",
        text,
        None if found is None else found.distance,
        None if found is None else found.bound,
        hints=tuple(_corrections(surfaces, one, points, found)),
        entities=(one.entity,) if found is None else (one.entity, found.entity),
        **common,
    )


def _corrections(surfaces: Surfaces, one: Fixture, points: F64, found: Footing | None) -> Iterator[Correction]:
    low, high = ([round(float(c), 4) for c in (points.min(axis=0), points.max(axis=0))[k]] for k in (0, 1))
    yield correction(
        "what holds it is not drawn",
        "shape",
        f"Add a static post, rail, wall or foot that is held and reaches what is held between {low} and {high}.",
        pointers=("/entities", pointer(*one.where)),
    )
    if found is not None:
        move = ", ".join(f"{c:+.4g}" for c in found.way)
        cause, action = f"{one.entity!r} is placed away from {found.entity!r}", f"Move it by ({move}) m, to {found.entity!r}."
        yield move_by(surfaces.candidate, one.entity, found.way, cause, action)
    yield say_afloat(one.entity, "it is meant to hang on nothing")

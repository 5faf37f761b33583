"""Moves that separate two entities which overlap at frame 0: the least ones, that make no other overlap."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import apart, signed_clearance
from ...worlds.arrays import F64, RigidPose
from .bounds import FARTHER, MARGIN, SAME_MOVE, WIDEST

if TYPE_CHECKING:
    from .surfaces import Gap, Surfaces

__all__ = ["Barred", "barred", "clear_of", "moves_apart", "separating_move", "upward"]


class Barred(NamedTuple):
    """The least way out of an overlap where another part of the same entity stands."""

    offset: F64
    """[m], shape (3,)."""
    part: str
    """Part of the other entity that stands in that way."""


HALVINGS = 16
"""Most bisections of a suggested move, which end where it is short to within `MARGIN`."""


def separating_move(
    surfaces: Surfaces,
    mover: str,
    other: str,
    frame: int,
    direction: F64,
    depth: float,
    *,
    most: float = np.inf,
    parts: Sequence[int] | None = None,
) -> float | None:
    """Distance along a unit `direction` after which `mover`, or `parts` of it, clear `other` by `MARGIN` [m], short to within `MARGIN`.

    Starts at the measured `depth` [m], which no move can undercut, then doubles and bisects; None where it takes more
    than `most` [m], or four sizes of the mover.
    """
    rows = surfaces.parts_of[mover] if parts is None else parts
    margin = _margin(surfaces, mover, other)

    def clear(distance: float) -> bool:
        return clear_of(surfaces, rows, other, frame, distance * direction, margin)

    low, high = 0.0, depth + margin + 0.5 * MARGIN
    while not clear(high):
        low, high = high, 2.0 * high
        if low > most or high > WIDEST * surfaces.size(mover) + depth:
            return None
    for _ in range(HALVINGS if low > 0.0 else 0):
        if high - low <= MARGIN:
            break
        middle = 0.5 * (low + high)
        low, high = (low, middle) if clear(middle) else (middle, high)
    return high


def _margin(surfaces: Surfaces, mover: str, other: str) -> float:
    """Clearance that a suggested move leaves between two entities [m]: where their engine keeps them apart, that of both skins."""
    skins = [s.settings.skin for s in surfaces.candidate.spec.simulation.rigid.values() if {mover, other} <= set(s.members)]
    sheet = any(surfaces.candidate.spec.entities[n].physics.sheet_thickness for n in (mover, other))
    moving = not sheet and not (surfaces.is_static(mover) and surfaces.is_static(other))
    return MARGIN + (2.0 * max(skins, default=0.0) if moving else 0.0)


def clear_of(surfaces: Surfaces, rows: Sequence[int], other: str, frame: int, offset: F64, margin: float = MARGIN) -> bool:
    """True if parts, displaced by `offset` [m], clear `other` by a margin [m]; those that touch it now may go on touching it."""
    low, high = (box[:, 0] for box in surfaces.boxes(np.array([frame])))
    for i in rows:
        one = surfaces.parts[i]
        here = surfaces.track(one.entity, one.body).at(frame)
        moved = RigidPose(here.position + offset, here.quaternion)
        for j in surfaces.parts_of[other]:
            two = surfaces.parts[j]
            if (low[j] > high[i] + offset + margin).any() or (high[j] < low[i] + offset - margin).any():
                continue
            solids = surfaces.shapes.solid(i, frame), surfaces.shapes.solid(j, frame)
            there = surfaces.track(other, two.body).at(frame)
            if apart(solids[0], moved, solids[1], there, gap=margin):
                continue
            noise = surfaces.noise(one.entity, other)
            now = float(signed_clearance(solids[0], here, solids[1], there).distance)
            if not -noise <= now < margin or not offset.any():
                return False
            if float(signed_clearance(solids[0], moved, solids[1], there).distance) < -noise:
                return False
    return True


def _middle(surfaces: Surfaces, rows: Sequence[int]) -> F64:
    """Middle of the bounding box of parts at frame 0 [m], shape (3,)."""
    low, high = (box[list(rows), 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    return np.asarray((low.min(0) + high.max(0)) / 2)


def upward(surfaces: Surfaces) -> F64:
    """Unit vector against gravity, along z without any, shape (3,)."""
    gravity = np.array(surfaces.candidate.spec.simulation.gravity)
    strength = float(np.linalg.norm(gravity))
    return -gravity / strength if strength > 0 else np.array([0.0, 0.0, 1.0])


def _along_axes(surfaces: Surfaces, names: tuple[str, str], rows: Sequence[int], depth: float, most: float) -> dict[str, F64]:
    """Moves along each axis of the world that clear the second entity, the shorter way of each, and none over `most` [m]."""
    found: dict[str, F64] = {}
    for axis, name in enumerate("xyz"):
        least = most
        for sign in (-1.0, 1.0):
            direction = sign * np.eye(3)[axis]
            distance = separating_move(surfaces, names[0], names[1], 0, direction, depth, most=least, parts=rows)
            if distance is not None and distance < least:
                least, found[f"along {name}"] = distance, distance * direction
    return found


def _different(moves: dict[str, F64]) -> dict[str, F64]:
    """The moves without those that are nearly the same as a shorter one."""
    found: dict[str, F64] = {}
    for name, move in sorted(moves.items(), key=lambda item: float(np.linalg.norm(item[1]))):
        if not any(np.linalg.norm(move - other) < SAME_MOVE * np.linalg.norm(move) for other in found.values()):
            found[name] = move
    return found


def moves_apart(surfaces: Surfaces, names: tuple[str, str], rows: Sequence[int], gap: Gap, *, swapped: bool) -> dict[str, F64]:
    """Moves of these parts of the first entity that clear the second [m], by the words for their direction."""
    mover, other = names
    out = gap.point_b - gap.point_a if not swapped else gap.point_a - gap.point_b
    length = float(np.linalg.norm(out))
    up = upward(surfaces)
    directions = {"up": up}
    if length > 0.0:
        directions["out along the shortest way"] = out / length
    # The deepest point need not show the shortest way out: a neighbour is left sideways, away from its middle.
    between = _middle(surfaces, rows) - _middle(surfaces, surfaces.parts_of[other])
    level = between - float(between @ up) * up
    if float(np.linalg.norm(level)) > 0.0:
        directions["away from its neighbour"] = level / float(np.linalg.norm(level))
    moves = {}
    for name, direction in directions.items():
        distance = separating_move(surfaces, mover, other, 0, direction, -gap.distance, parts=rows)
        if distance is not None:
            moves[name] = distance * direction
    sheet = any(surfaces.candidate.spec.entities[n].physics.sheet_thickness for n in names)
    # A sheet has no inside that its deepest point could show the way out of: its way out may be longer than the others.
    most = np.inf if sheet else min((float(np.linalg.norm(m)) for m in moves.values()), default=np.inf)
    moves = _different(moves | _along_axes(surfaces, names, rows, -gap.distance, most))
    least = min((float(np.linalg.norm(m)) for m in moves.values()), default=0.0)
    return {name: move for name, move in moves.items() if np.linalg.norm(move) <= FARTHER * least}


def barred(surfaces: Surfaces, names: tuple[str, str], rows: Sequence[int], gap: Gap, *, swapped: bool) -> Barred | None:
    """The least way of these parts out of the deepest overlap, if they would overlap a part of the other entity that they clear now."""
    mover, other = names
    out = gap.point_b - gap.point_a if not swapped else gap.point_a - gap.point_b
    length = float(np.linalg.norm(out))
    if length == 0.0:
        return None
    offset: F64 = (-gap.distance + _margin(surfaces, mover, other)) / length * out
    deepest = gap.part_a if swapped else gap.part_b
    for j in surfaces.parts_of[other]:
        two = surfaces.parts[j]
        if two.part == deepest:
            continue
        there = surfaces.track(other, two.body).at(0)
        for i in rows:
            one = surfaces.parts[i]
            here = surfaces.track(one.entity, one.body).at(0)
            solids = surfaces.shapes.solid(i, 0), surfaces.shapes.solid(j, 0)
            noise = surfaces.noise(one.entity, other)
            moved = RigidPose(here.position + offset, here.quaternion)
            if float(signed_clearance(solids[0], moved, solids[1], there).distance) >= -noise:
                continue
            if float(signed_clearance(solids[0], here, solids[1], there).distance) >= -noise:
                return Barred(offset, two.part)
    return None

"""Rows about what opens: doors, drawers, lids and windows can be moved with the world as it stands (R49, R95).

The surfaces of what moves are tried over the range of the joint against everything that is no part of it. Things that stand on what moves
go along; free things that are light are pushed away; what a beat has it push or jam against stands there on purpose.

Cost: a flat of six rooms with 70 such joints among 690 entities in about 1 s on one core.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, RigidPose, rotation_matrix
from ...worlds.assemblies import Edit, add_move
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from ..scene.surfaces import surfaces_of
from .bounds import MOVES, SEARCHED
from .openings import Opening, assembly_of, openings_of
from .questions import JOINT
from .swept import Hit, Reach, reach_of, way_boxes

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import WorldSpec
    from ..scene.surfaces import Surfaces

__all__ = ["check"]

FREE = 1e-3
"""[m] A suggested move leaves this free."""
LEAST_LEVEL = 0.7
"""[1] Axes of what opens that lie more level than this are tried as ways of a move."""
MOST_MOVED = 40
"""Entities that a suggested move takes along, at most: more are no furniture but a floor."""
STEPS = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.4, 2.0, MOVES)
"""[m] Moves of an obstacle that are tried, shortest first."""


@guarded(JOINT)
def check(candidate: Candidate) -> list[Row]:
    """One row per joint by which something opens; none where there is no such joint."""
    surfaces = surfaces_of(candidate)
    whole = candidate.recipe("navigability", candidate.spec.entities)
    rows: list[Row] = []
    for opening in openings_of(surfaces):
        searched = sum(r.status == "fail" for r in rows) < SEARCHED
        judge = partial(_finding, surfaces, opening, searched=searched)
        rows.append(row_of(candidate, JOINT, (opening.joint,), judge, entities=(opening.child,), extra=[whole, opening.needed]))
    return rows


def _finding(surfaces: Surfaces, opening: Opening, *, searched: bool) -> Finding:
    if surfaces.missing:
        raise EvidenceError(f"the scene is incomplete: {next(iter(surfaces.missing.values()))}")
    if any(frame == 0 for frame in surfaces.broken.values()):
        raise EvidenceError(f"the pose of {next(iter(surfaces.broken))!r} is not finite; see the numerical rows")
    if opening.welded is not None:
        text = f"{opening.child!r} is welded to {opening.welded!r} too: it is held shut until a driver opens the weld"
        return Finding("not_applicable", text, frames=(0, 0), extra=[opening.welded])
    reach = reach_of(surfaces, opening)
    share = (reach.high - reach.low) / opening.span
    ok = share >= opening.needed
    hit = _nearer(reach)
    return Finding(
        "pass" if ok else "fail",
        _told(surfaces, opening, reach, share),
        share,
        opening.needed,
        hints=() if ok or hit is None else _hints(surfaces, opening, reach, hit, searched=searched),
        evidence={
            "free": [reach.low, reach.high],
            "range": [opening.low, opening.high],
            "unit": opening.unit,
            "obstacle": None if hit is None else surfaces.parts[hit.obstacle].entity,
            "obstacle_part": None if hit is None else surfaces.parts[hit.obstacle].part,
            "part": None if hit is None else surfaces.parts[hit.mover].part,
            "reason": opening.reason,
        },
        entities=(opening.child,) if ok or hit is None else (opening.child, surfaces.parts[hit.obstacle].entity),
        frames=(0, 0),
        predicate=f"{opening.child} can be moved by {opening.needed * opening.span:.4g} {opening.unit} "
        f"of the {opening.span:.4g} {opening.unit} of {opening.joint} at frame 0",
    )


def _nearer(reach: Reach) -> Hit | None:
    """The hit that comes first, as the joint moves either way."""
    hits = [h for h in (reach.below, reach.above) if h is not None]
    return min(hits, key=lambda h: abs(h.position), default=None)


def _amount(opening: Opening, value: float) -> str:
    return f"{value:.3g} m" if opening.slides else f"{np.degrees(value):.3g} degrees"


def _told(surfaces: Surfaces, opening: Opening, reach: Reach, share: float) -> str:
    free = f"{opening.child!r} can be moved by {_amount(opening, reach.high - reach.low)} of {_amount(opening, opening.span)} ({share:.0%})"
    ends = [
        f"{surfaces.parts[h.mover].entity}/{surfaces.parts[h.mover].part} meets "
        f"{surfaces.parts[h.obstacle].entity}/{surfaces.parts[h.obstacle].part} at {_amount(opening, h.position)}"
        for h in (reach.below, reach.above)
        if h is not None
    ]
    return "; ".join([free, *ends])


def _hints(surfaces: Surfaces, opening: Opening, reach: Reach, hit: Hit, *, searched: bool) -> tuple[Correction, ...]:
    obstacle = surfaces.parts[hit.obstacle].entity
    child, spec = opening.child, surfaces.candidate.spec
    main = assembly_of(spec).get(child, child)
    cause = f"{obstacle!r} stands in the way of {child!r}"
    hints = []
    for move in _moves(surfaces, opening, reach, hit) if searched else ():
        more = f" with {', '.join(n for n in move.names[1:4])}" if len(move.names) > 1 else ""
        way = ", ".join(f"{v:+.3g}" for v in move.offset)
        action = (
            f"Move {move.names[0]!r}{more}{' and more' if len(move.names) > 4 else ''} by ({way}) m, so that {child!r} can open."
        )
        place = pointer("entities", move.names[0], "pose")
        hints.append(correction(cause, "placement", action, pointers=(place,), patch=_patch(spec, move)))
    missing = _amount(opening, (opening.needed * opening.span) - (reach.high - reach.low))
    turned = "." if opening.slides else ", or hinge it on its other side."
    action = f"Move {obstacle!r} out of the way, or place {main!r} where {child!r} has {missing} more{turned}"
    places = (pointer("entities", obstacle, "pose"), pointer("entities", main, "pose"))
    return (*hints, correction(cause, "placement", action, pointers=places))


class _Move(NamedTuple):
    """Entities that are moved together, the one that is meant first, and by how much [m]."""

    names: list[str]
    offset: F64


def _patch(spec: WorldSpec, move: _Move) -> tuple[dict[str, Any], ...]:
    edit = Edit()
    add_move(edit, spec, move.names, RigidPose(move.offset, np.array([1.0, 0.0, 0.0, 0.0])))
    return tuple(edit.operations)


def _moves(surfaces: Surfaces, opening: Opening, reach: Reach, hit: Hit) -> list[_Move]:
    """The shortest level move of the obstacle that lets the joint move as far as it must; else one of what opens."""
    spec, obstacle = surfaces.candidate.spec, surfaces.parts[hit.obstacle].entity
    assembly = assembly_of(spec)
    wanted = opening.needed * opening.span + 1e-6
    low, high = (reach.low, reach.low + wanted) if reach.above is hit else (reach.high - wanted, reach.high)
    boxes = way_boxes(surfaces, opening, (max(low, opening.low), min(high, opening.high)))
    turn = rotation_matrix(surfaces.track_of(hit.mover).at(0).quaternion)
    ways = [np.array([*(s * turn[:2, k]), 0.0]) for k in range(3) for s in (1.0, -1.0)]
    ways = [w / np.linalg.norm(w) for w in ways if np.linalg.norm(w) > LEAST_LEVEL]
    sides = [(assembly.get(obstacle, obstacle), 1.0), (assembly.get(opening.child, opening.child), -1.0)]
    for first, sign in sides:
        names = _group(surfaces, first)
        if (sign > 0 and (opening.child in names or obstacle in opening.hung)) or not _furniture(surfaces, names):
            continue
        rows = [i for n in names for i in surfaces.parts_of.get(n, ())]
        stays = (
            rows
            if sign > 0
            else [i for n in _group(surfaces, assembly.get(obstacle, obstacle)) for i in surfaces.parts_of.get(n, ())]
        )
        for length in STEPS:
            for way in ways:
                offset = np.round(length * way, 6)
                if not _in_way(surfaces, boxes, stays, sign * offset) and not _lands_on(surfaces, rows, names, offset):
                    return [_Move(names, offset)]
    return []


def _furniture(surfaces: Surfaces, names: list[str]) -> bool:
    """True if a group may be moved: no walls and floors, nothing that others hang on or stand on unsaid."""
    ends = {n for j in surfaces.candidate.spec.simulation.joints.values() for n in (j.child, j.parent) if n is not None}
    spec = surfaces.candidate.spec
    bound = any(
        {j.child, j.parent} & set(names) and not {j.child, j.parent} <= set(names) for j in spec.simulation.joints.values()
    )
    return not bound and (spec.entities[names[0]].asset is not None or names[0] not in ends) and len(names) <= MOST_MOVED


def _in_way(surfaces: Surfaces, boxes: tuple[F64, F64], rows: list[int], offset: F64) -> bool:
    """True if the boxes of parts, moved by an offset [m], meet those of the way."""
    low, high = (b[:, 0] for b in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    mine = low[rows] + offset - FREE, high[rows] + offset + FREE
    return bool(((mine[0][:, None] < boxes[1]) & (mine[1][:, None] > boxes[0])).all(axis=2).any())


def _group(surfaces: Surfaces, name: str) -> list[str]:
    """An entity with the bodies of its thing, and what stands on them as relations say."""
    spec, assembly = surfaces.candidate.spec, assembly_of(surfaces.candidate.spec)
    found = [name]
    for one in found:
        own = [n for n in spec.entities if n not in found and assembly.get(one) is not None and assembly.get(n) == assembly[one]]
        borne = [r.b for r in spec.graph.relations.values() if r.kind in ("supports", "contains") and r.a == one]
        found += dict.fromkeys(n for n in (*own, *borne) if n in spec.entities and n not in found)
    return found


def _lands_on(surfaces: Surfaces, rows: list[int], names: list[str], offset: F64) -> bool:
    """True if moved parts would come into the boxes of others, or off what carries them."""
    low, high = (b[:, 0] for b in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    others = np.array([p.entity not in names for p in surfaces.parts])
    for i in rows:
        meets = others & (low < high[i] + offset - FREE).all(axis=1) & (high > low[i] + offset + FREE).all(axis=1)
        met = others & (low < high[i] - FREE).all(axis=1) & (high > low[i] + FREE).all(axis=1)
        if (meets & ~met).any():
            return True
    bottom = min(rows, key=lambda i: float(low[i][2]))
    under = others & (np.abs(high[:, 2] - low[bottom][2]) < surfaces.reach)
    spot = 0.5 * (low[bottom] + high[bottom]) + offset
    return not bool((under & (low[:, :2] <= spot[:2]).all(axis=1) & (high[:, :2] >= spot[:2]).all(axis=1)).any())

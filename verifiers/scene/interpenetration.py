"""Interpenetration: no unintended overlap of visible surfaces at frame 0 (R89-R91), static pairs included.

The bound is query noise and no allowance (R90). Overlap that a `fastened` relation declares is judged against its
depth; everything else fails, seen by a camera or not. Bodies of one entity are compared too, except neighbours along a
rope. A surface that passes through itself gets a row of its own (`scene/self_crossing.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...geometry import apart
from ...worlds.arrays import F64, RigidPose
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, move_by, move_parts, pointer
from ..rows.findings import Finding
from .bounds import MARGIN, SAME_MOVE, WIDEST
from .own_bodies import own_gap, own_pairs
from .questions import OVERLAP, OVERLAP_SCENE
from .room import in_the_way, moves_alone
from .self_crossing import self_rows
from .surfaces import surfaces_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from .own_bodies import OwnPair
    from .surfaces import Gap, Surfaces

__all__ = ["check", "correction_order", "separating_move"]

HALVINGS = 16
"""Most bisections of a suggested move, which end where it is short to within `MARGIN`."""
NAMED = 4
"""Parts that a correction tells by name."""
DETAILED = 20
"""Failing pairs whose separating move is computed; a pile of failures is mended one by one anyway."""


@guarded(OVERLAP_SCENE)
def check(candidate: Candidate) -> list[Row]:
    """One row per pair that comes within twice the contact tolerance, and one for the scene."""
    surfaces = surfaces_of(candidate)
    rows: list[Row] = []
    failed = 0
    for a, b in surfaces.first:
        judge = partial(_pair, surfaces, a, b, detailed=failed < DETAILED)
        rows.append(row_of(candidate, OVERLAP, (a, b), judge, entities=(a, b)))
        failed += rows[-1].status == "fail"
    for entity, pairs in own_pairs(surfaces, np.zeros(1, dtype=np.intp)).items():
        rows.append(row_of(candidate, OVERLAP, (entity, entity), _own(surfaces, entity, pairs), entities=(entity,)))
    crossed = [r for entity in surfaces.entities for r in self_rows(surfaces, entity)]
    return [row_of(candidate, OVERLAP_SCENE, (), _scene(surfaces, rows, crossed)), *rows, *crossed]


def _predicate(surfaces: Surfaces, a: str, b: str) -> str:
    depth = surfaces.allowed_depth(a, b)
    if depth > 0.0:
        return f"clearance({a}, {b}) >= -{depth:g} m at frame 0 (declared fastened)"
    return f"clearance({a}, {b}) >= -eps at frame 0, eps = query noise {surfaces.noise(a, b):.2g} m"


def _own(surfaces: Surfaces, entity: str, pairs: list[OwnPair]) -> Finding:
    """The nearest two bodies of one entity that are not joined."""
    gap = min((own_gap(surfaces, pair, 0) for pair in pairs), key=lambda g: g.distance)
    allowed, noise = surfaces.allowed_depth(entity, entity), surfaces.noise(entity, entity)
    ok = gap.distance >= -(allowed + noise)
    bend = correction(
        f"{entity!r} is laid out through itself",
        "placement",
        f"Lay {entity}/{gap.part_a} and {entity}/{gap.part_b} at least {-gap.distance * 1e3:.4g} mm farther apart.",
        pointers=(pointer("entities", entity, "generator", "points"),),
    )
    return Finding(
        "pass" if ok else "fail",
        f"{entity}/{gap.part_a} and {entity}/{gap.part_b} have a clearance of {gap.distance * 1e3:.4g} mm",
        gap.distance,
        -(allowed + noise),
        hints=(bend,),
        evidence={
            "point_a": gap.point_a.tolist(),
            "point_b": gap.point_b.tolist(),
            "part_a": gap.part_a,
            "part_b": gap.part_b,
        },
        frames=(0, 0),
        predicate=f"clearance between bodies of {entity} that are not joined >= -eps at frame 0, eps = query noise {noise:.2g} m",
        extra=[allowed],
    )


def _scene(surfaces: Surfaces, rows: list[Row], crossed: list[Row]) -> Finding:
    names = list(surfaces.candidate.solids)
    broken = [n for n, frame in surfaces.broken.items() if frame == 0]
    bad = [r for r in [*rows, *crossed] if r.status != "pass"]
    failing = list(dict.fromkeys([*broken, *(n for r in bad for n in r.entities)]))
    worst = min((d for (a, b), d in surfaces.first.items() if surfaces.allowed_depth(a, b) == 0.0), default=None)
    liquid_only = not names and bool(surfaces.candidate.liquids)
    unverified = not (names or liquid_only) or bool(surfaces.missing) or any(r.status == "unverified" for r in bad)
    failed = bool(broken) or any(r.status == "fail" for r in bad)
    if broken:
        text = f"the pose of {broken[0]!r} is not finite at frame 0"
    elif liquid_only:
        text = "the scene has liquids alone, and no solid that could overlap another"
    elif not names:
        text = "the scene has no entity to inspect"
    elif surfaces.missing:
        text = f"{len(surfaces.missing)} of {len(names)} entities cannot be inspected: {next(iter(surfaces.missing.values()))}"
    else:
        pairs = len(names) * (len(names) - 1) // 2
        text = f"{pairs} pairs of {len(names)} entities searched, {len(rows)} within {surfaces.reach:g} m, {len(bad)} overlap"
    return Finding(
        "fail" if failed else "unverified" if unverified else "not_applicable" if liquid_only else "pass",
        text,
        float(len(bad) + len(broken)),
        0.0,
        evidence={
            "entities": len(names),
            "missing": list(surfaces.missing)[:20],
            "pairs_near": len(rows),
            "worst_clearance_m": worst,
            "overlapping": [r.id for r in bad][:20],
        },
        entities=tuple(failing or names),
        frames=(0, 0),
    )


def _pair(surfaces: Surfaces, a: str, b: str, *, detailed: bool) -> Finding:
    gap = surfaces.gap(a, b, 0)
    allowed = surfaces.allowed_depth(a, b)
    noise = surfaces.noise(a, b)
    bound = -(allowed + noise)
    ok = gap.distance >= bound
    names = correction_order(surfaces, a, b)
    if gap.distance >= 0.0:
        text = f"{a!r} and {b!r} are {gap.distance * 1e3:.4g} mm apart"
    else:
        text = f"{a}/{gap.part_a} and {b}/{gap.part_b} overlap by {-gap.distance * 1e3:.4g} mm"
        text += f", allowed {allowed * 1e3:.4g} mm" if allowed else ", which no relation declares"
    return Finding(
        "pass" if ok else "fail",
        text,
        gap.distance,
        bound,
        hints=() if ok else _corrections(surfaces, names, gap, swapped=names[0] != a, detailed=detailed),
        evidence={
            "point_a": gap.point_a.tolist(),
            "point_b": gap.point_b.tolist(),
            "part_a": gap.part_a,
            "part_b": gap.part_b,
            "eps_m": noise,
            "allowed_depth_m": allowed,
        },
        entities=names,
        frames=(0, 0),
        predicate=_predicate(surfaces, a, b),
        extra=[allowed],
    )


def correction_order(surfaces: Surfaces, a: str, b: str) -> tuple[str, str]:
    """The pair with the entity first that is easier to move: a moving one before a static one, then the smaller."""
    rank = {name: (surfaces.is_static(name), surfaces.size(name)) for name in (a, b)}
    return (a, b) if rank[a] <= rank[b] else (b, a)


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

    def clear(distance: float) -> bool:
        return _apart(surfaces, rows, other, frame, distance * direction)

    low, high = 0.0, depth + 1.5 * MARGIN
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


def _apart(surfaces: Surfaces, rows: Sequence[int], other: str, frame: int, offset: F64) -> bool:
    """True if parts, displaced by `offset` [m], clear `other` by `MARGIN`."""
    for i in rows:
        one = surfaces.parts[i]
        pose = surfaces.track(one.entity, one.body).at(frame)
        moved = RigidPose(pose.position + offset, pose.quaternion)
        for j in surfaces.parts_of[other]:
            two = surfaces.parts[j]
            solids = surfaces.shapes.solid(i, frame), surfaces.shapes.solid(j, frame)
            if not apart(solids[0], moved, solids[1], surfaces.track(other, two.body).at(frame), gap=MARGIN):
                return False
    return True


def _middle(surfaces: Surfaces, rows: Sequence[int]) -> F64:
    """Middle of the bounding box of parts at frame 0 [m], shape (3,)."""
    low, high = (box[list(rows), 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    return np.asarray((low.min(0) + high.max(0)) / 2)


def _movers(surfaces: Surfaces, mover: str, other: str) -> tuple[int, ...]:
    """The parts to move: those in `other` where they hang together with no further part of their entity, else all of it."""
    rows = surfaces.parts_of[mover]
    inside = tuple(i for i in rows if len(rows) > 1 and not _apart(surfaces, (i,), other, 0, np.zeros(3)))
    return inside if inside and len(inside) < len(rows) and all(moves_alone(surfaces, i) for i in inside) else tuple(rows)


def _stands_elsewhere(surfaces: Surfaces, mover: str, other: str) -> bool:
    """True if something else is said to carry an entity, which a lift would take it off."""
    relations = surfaces.candidate.spec.graph.relations.values()
    return any(r.kind == "supports" and r.b == mover and r.a != other for r in relations)


def _up(surfaces: Surfaces) -> F64:
    """Unit vector against gravity, along z without any, shape (3,)."""
    gravity = np.array(surfaces.candidate.spec.simulation.gravity)
    strength = float(np.linalg.norm(gravity))
    return -gravity / strength if strength > 0 else np.array([0.0, 0.0, 1.0])


def _fixed(surfaces: Surfaces, entity: str) -> bool:
    """True if an entity stays where it is placed: it is static, or pins hold it."""
    return surfaces.is_static(entity) or bool(getattr(surfaces.candidate.spec.entities[entity].physics, "pins", None))


def _along_axes(surfaces: Surfaces, names: tuple[str, ...], depth: float) -> dict[str, F64]:
    """Moves of the first entity along each axis of the world that clear the second, the shorter way of each [m].

    A sheet has no inside that its deepest point could show the way out of: the shortest way out may lead along the sheet.
    """
    found: dict[str, F64] = {}
    for axis, name in enumerate("xyz"):
        least = np.inf
        for sign in (-1.0, 1.0):
            direction = sign * np.eye(3)[axis]
            distance = separating_move(surfaces, names[0], names[1], 0, direction, depth, most=least)
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


def _moves(surfaces: Surfaces, names: tuple[str, str], rows: Sequence[int], gap: Gap, *, swapped: bool) -> dict[str, F64]:
    """Moves of these parts of the first entity that clear the second [m], by the words for their direction."""
    mover, other = names
    out = gap.point_b - gap.point_a if not swapped else gap.point_a - gap.point_b
    length = float(np.linalg.norm(out))
    up = _up(surfaces)
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
    if any(surfaces.candidate.spec.entities[n].physics.sheet_thickness for n in names):
        moves = _different(moves | _along_axes(surfaces, names, -gap.distance))
    return moves


def _move(surfaces: Surfaces, names: tuple[str, str], rows: Sequence[int], name: str, offset: F64, either: str) -> Correction:
    """Move these parts of the first entity out of the second, in the direction of that name."""
    mover, other = names
    text, length = ", ".join(f"{c:+.4g}" for c in offset), float(np.linalg.norm(offset)) * 1e3
    way = f"{name} by {length:.4g} mm, that is ({text}) m."
    if len(rows) == len(surfaces.parts_of[mover]):
        cause = f"{mover!r} is placed inside {other!r}"
        return move_by(surfaces.candidate, mover, offset, cause, f"Move {mover!r} {way}{either}")
    parts = [surfaces.parts[i].part for i in rows]
    told = ", ".join(parts[:NAMED]) + (f" and {len(parts) - NAMED} more" if len(parts) > NAMED else "")
    cause = f"part {told} of {mover!r} is placed inside {other!r}"
    return move_parts(surfaces.candidate, mover, dict.fromkeys(parts, offset), cause, f"Move {told} of {mover!r} {way}{either}")


def _corrections(
    surfaces: Surfaces, names: tuple[str, str], gap: Gap, *, swapped: bool, detailed: bool
) -> tuple[Correction, ...]:
    mover, other = names
    rows = _movers(surfaces, mover, other) if detailed else ()
    moves = _moves(surfaces, names, rows, gap, swapped=swapped) if detailed else {}
    pose = pointer("entities", mover, "pose")
    either = f" Both are fixed: either may move, {other!r} the opposite way." if all(_fixed(surfaces, n) for n in names) else ""
    lifted, up = _stands_elsewhere(surfaces, mover, other), _up(surfaces)
    hits = {name: in_the_way(surfaces, rows, offset, (other,)) for name, offset in moves.items()}
    found = [
        _move(surfaces, names, rows, name, offset, either)
        for name, offset in sorted(moves.items(), key=lambda item: float(np.linalg.norm(item[1])))
        if hits[name] is None and not (lifted and float(offset @ up) > surfaces.contact_gap(mover, other))
    ]
    struck = {n: m for n, m in moves.items() if hits[n] is not None}
    if struck and not found:
        name, offset = min(struck.items(), key=lambda item: float(np.linalg.norm(item[1])))
        text, length = ", ".join(f"{c:+.4g}" for c in offset), float(np.linalg.norm(offset)) * 1e3
        found.append(
            correction(
                f"{mover!r} is placed inside {other!r}",
                "placement",
                f"{name.capitalize()} by {length:.4g} mm, that is ({text}) m, {mover!r} would overlap {hits[name]!r}: move that too, or make room.",
                pointers=(pose, pointer("entities", str(hits[name]), "pose")),
            )
        )
    if not found:
        found.append(
            correction(
                f"{mover!r} is inside {other!r}",
                "placement",
                f"Place {mover!r} elsewhere, at least {-gap.distance:.4g} m away, or make an opening in {other!r}.",
                pointers=(pose, pointer("entities", other, "parts")),
            )
        )
    found.append(
        correction(
            "the two are meant to be embedded or fastened",
            "relations",
            f"If the prompt says so, declare a `fastened` relation of {mover!r} and {other!r} with max_depth >= "
            f"{-gap.distance:.4g} m and the reason.",
            pointers=("/graph/relations",),
        )
    )
    return tuple(found)

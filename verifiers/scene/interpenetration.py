"""Interpenetration: no unintended overlap of visible surfaces at frame 0 (R89-R91), static pairs included.

The bound is query noise and no allowance (R90). Overlap that a `fastened` relation declares is judged against its
depth; everything else fails, seen by a camera or not. Bodies of one entity are compared too, except neighbours along a
rope. A surface that passes through itself gets a row of its own (`scene/self_crossing.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...geometry import apart
from ...worlds.arrays import F64, RigidPose
from ...worlds.requirements import Correction, RowId
from ..rows.guards import guarded, guarded_rows, pointer, translation_patch
from ..rows.verdicts import make_row
from .own_bodies import own_gap, own_pairs
from .self_crossing import self_rows
from .surfaces import surfaces_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from .own_bodies import OwnPair
    from .surfaces import Gap, Surfaces

__all__ = ["MARGIN", "check", "correction_order", "separating_move"]

MARGIN = 1e-4
"""[m] Own choice: a suggested move leaves this clearance, so that its rounding cannot touch again."""
WIDEST = 4.0
"""Own choice: a suggested move longer than this many sizes of the moved body is not suggested."""
SAME_MOVE = 0.05
"""Own choice: of two suggested moves that differ by less than this part of their length, one is enough."""
HALVINGS = 8
DETAILED = 20
"""Failing pairs whose separating move is computed; a pile of failures is mended one by one anyway."""


@guarded("interpenetration", "visible surfaces of different entities do not overlap at frame 0")
def check(candidate: Candidate) -> list[Row]:
    """One row per pair that comes within twice the contact tolerance, and one for the scene."""
    surfaces = surfaces_of(candidate)
    rows: list[Row] = []
    for a, b in surfaces.first:
        failed = sum(r.status == "fail" for r in rows)
        rows += guarded_rows(
            candidate,
            lambda a=a, b=b, n=failed: [_pair(surfaces, a, b, detailed=n < DETAILED)],  # type: ignore[misc]
            row_id=RowId("interpenetration", a, b),
            predicate=_predicate(surfaces, a, b),
            entities=(a, b),
        )
    for entity, pairs in own_pairs(surfaces, np.zeros(1, dtype=np.intp)).items():
        rows.append(_own(surfaces, entity, pairs))
    crossed = [r for entity in surfaces.entities for r in self_rows(surfaces, entity)]
    return [_scene(surfaces, rows, crossed), *rows, *crossed]


def _predicate(surfaces: Surfaces, a: str, b: str) -> str:
    depth = surfaces.allowed_depth(a, b)
    if depth > 0.0:
        return f"clearance({a}, {b}) >= -{depth:g} m at frame 0 (declared fastened)"
    return f"clearance({a}, {b}) >= -eps at frame 0, eps = query noise {surfaces.noise(a, b):.2g} m"


def _own(surfaces: Surfaces, entity: str, pairs: list[OwnPair]) -> Row:
    """The nearest two bodies of one entity that are not joined."""
    gap = min((own_gap(surfaces, pair, 0) for pair in pairs), key=lambda g: g.distance)
    allowed, noise = surfaces.allowed_depth(entity, entity), surfaces.noise(entity, entity)
    ok = gap.distance >= -(allowed + noise)
    bend = Correction(
        cause=f"{entity!r} is laid out through itself",
        edit_class="scene",
        group="placement",
        action=f"Lay {entity}/{gap.part_a} and {entity}/{gap.part_b} at least {-gap.distance * 1e3:.4g} mm farther apart.",
        pointers=(pointer("entities", entity, "generator", "points"),),
    )
    return make_row(
        surfaces.candidate,
        row_id=RowId("interpenetration", entity, entity),
        predicate=f"clearance between bodies of {entity} that are not joined >= -eps at frame 0, eps = query noise {noise:.2g} m",
        status="pass" if ok else "fail",
        explanation=f"{entity}/{gap.part_a} and {entity}/{gap.part_b} have a clearance of {gap.distance * 1e3:.4g} mm",
        measured=gap.distance,
        bound=-(allowed + noise),
        comparison=">=",
        unit="m",
        frames=(0, 0),
        entities=(entity,),
        corrections=() if ok else (bend,),
        evidence={"point_a": gap.point_a.tolist(), "point_b": gap.point_b.tolist(), "part_a": gap.part_a, "part_b": gap.part_b},
        extra=[allowed],
    )


def _scene(surfaces: Surfaces, rows: list[Row], crossed: list[Row]) -> Row:
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
    return make_row(
        surfaces.candidate,
        row_id=RowId("interpenetration:scene"),
        predicate="every pair of entities is inspected and none overlaps at frame 0",
        status="fail" if failed else "unverified" if unverified else "not_applicable" if liquid_only else "pass",
        explanation=text,
        measured=float(len(bad) + len(broken)),
        bound=0.0,
        comparison="<=",
        unit="1",
        frames=(0, 0),
        entities=failing or names,
        evidence={
            "entities": len(names),
            "missing": list(surfaces.missing)[:20],
            "pairs_near": len(rows),
            "worst_clearance_m": worst,
            "overlapping": [r.id for r in bad][:20],
        },
    )


def _pair(surfaces: Surfaces, a: str, b: str, *, detailed: bool) -> Row:
    candidate = surfaces.candidate
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
    return make_row(
        candidate,
        row_id=RowId("interpenetration", a, b),
        predicate=_predicate(surfaces, a, b),
        status="pass" if ok else "fail",
        explanation=text,
        measured=gap.distance,
        bound=bound,
        comparison=">=",
        unit="m",
        frames=(0, 0),
        entities=names,
        corrections=() if ok else _corrections(surfaces, names, gap, swapped=names[0] != a, detailed=detailed),
        evidence={
            "point_a": gap.point_a.tolist(),
            "point_b": gap.point_b.tolist(),
            "part_a": gap.part_a,
            "part_b": gap.part_b,
            "eps_m": noise,
            "allowed_depth_m": allowed,
        },
        extra=[allowed],
    )


def correction_order(surfaces: Surfaces, a: str, b: str) -> tuple[str, str]:
    """The pair with the entity first that is easier to move: a moving one before a static one, then the smaller."""
    rank = {name: (surfaces.is_static(name), surfaces.size(name)) for name in (a, b)}
    return (a, b) if rank[a] <= rank[b] else (b, a)


def separating_move(
    surfaces: Surfaces, mover: str, other: str, frame: int, direction: F64, depth: float, *, most: float = np.inf
) -> float | None:
    """Distance along a unit `direction` after which `mover` clears `other` by `MARGIN` [m], short to within 1 %.

    Starts at the measured `depth` [m], which no move can undercut, then doubles and bisects; None where it takes more
    than `most` [m], or four sizes of the mover.
    """

    def clear(distance: float) -> bool:
        return _apart(surfaces, mover, other, frame, distance * direction)

    low, high = 0.0, depth + 2.0 * MARGIN
    while not clear(high):
        low, high = high, 2.0 * high
        if low > most or high > WIDEST * surfaces.size(mover) + depth:
            return None
    for _ in range(HALVINGS if low > 0.0 else 0):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if clear(middle) else (middle, high)
    return high


def _apart(surfaces: Surfaces, mover: str, other: str, frame: int, offset: F64) -> bool:
    """Whether `mover`, displaced by `offset` [m], clears `other` by `MARGIN`."""
    for i in surfaces.parts_of[mover]:
        one = surfaces.parts[i]
        pose = surfaces.track(mover, one.body).at(frame)
        moved = RigidPose(pose.position + offset, pose.quaternion)
        for j in surfaces.parts_of[other]:
            two = surfaces.parts[j]
            solids = surfaces.shapes.solid(i, frame), surfaces.shapes.solid(j, frame)
            if not apart(solids[0], moved, solids[1], surfaces.track(other, two.body).at(frame), gap=MARGIN):
                return False
    return True


def _middle(surfaces: Surfaces, entity: str) -> F64:
    """Middle of an entity's bounding box at frame 0 [m], shape (3,)."""
    vertices = surfaces.candidate.vertices(entity, 0)
    return np.asarray((vertices.min(0) + vertices.max(0)) / 2)


def _struck(surfaces: Surfaces, mover: str, other: str, offset: F64) -> str | None:
    """An entity that `mover` would overlap after moving by `offset`, `other` apart; None when the place is free."""
    vertices = surfaces.candidate.vertices(mover, 0) + offset
    low, high = vertices.min(0), vertices.max(0)
    for name in surfaces.entities:
        if name in (mover, other):
            continue
        there = surfaces.candidate.vertices(name, 0)
        if (there.min(0) > high).any() or (there.max(0) < low).any() or surfaces.allowed_depth(mover, name) > 0.0:
            continue
        if surfaces.gap(mover, name, 0, offset=offset).distance < -surfaces.noise(mover, name):
            return name
    return None


def _category(surfaces: Surfaces, entity: str) -> str:
    return surfaces.candidate.spec.entities[entity].physics.category


def _fixed(surfaces: Surfaces, entity: str) -> bool:
    """Whether an entity stays where it is placed: it is static, or a cloth that pins hold."""
    physics = surfaces.candidate.spec.entities[entity].physics
    return surfaces.is_static(entity) or (physics.category == "cloth" and bool(physics.pins))


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
    """Of moves that are nearly the same the shortest only."""
    found: dict[str, F64] = {}
    for name, move in sorted(moves.items(), key=lambda item: float(np.linalg.norm(item[1]))):
        if not any(np.linalg.norm(move - other) < SAME_MOVE * np.linalg.norm(move) for other in found.values()):
            found[name] = move
    return found


def _corrections(surfaces: Surfaces, names: tuple[str, str], gap: Gap, *, swapped: bool, detailed: bool) -> list[Correction]:
    mover, other = names
    out = gap.point_b - gap.point_a if not swapped else gap.point_a - gap.point_b
    length = float(np.linalg.norm(out))
    gravity = np.array(surfaces.candidate.spec.simulation.gravity)
    strength = float(np.linalg.norm(gravity))
    up = -gravity / strength if strength > 0 else np.array([0.0, 0.0, 1.0])
    directions = {"up": up}
    if length > 0.0:
        directions["out along the shortest way"] = out / length
    # The deepest point need not show the shortest way out: a neighbour is left sideways, away from its middle.
    between = _middle(surfaces, mover) - _middle(surfaces, other)
    level = between - float(between @ up) * up
    if float(np.linalg.norm(level)) > 0.0:
        directions["away from its neighbour"] = level / float(np.linalg.norm(level))
    moves = {}
    for name, direction in directions.items():
        distance = separating_move(surfaces, mover, other, 0, direction, -gap.distance) if detailed else None
        if distance is not None:
            moves[name] = distance * direction
    if detailed and "cloth" in (_category(surfaces, n) for n in names):
        moves = _different(moves | _along_axes(surfaces, names, -gap.distance))
    pose = pointer("entities", mover, "pose")
    either = f" Both are fixed: either may move, {other!r} the opposite way." if all(_fixed(surfaces, n) for n in names) else ""
    found = []
    hits = {name: _struck(surfaces, mover, other, offset) for name, offset in moves.items()}
    for name, offset in sorted(moves.items(), key=lambda item: (hits[item[0]] is not None, float(np.linalg.norm(item[1])))):
        text = ", ".join(f"{c:+.4g}" for c in offset)
        found.append(
            Correction(
                cause=f"{mover!r} is placed inside {other!r}",
                edit_class="scene",
                group="placement",
                action=f"Move {mover!r} {name} by {float(np.linalg.norm(offset)) * 1e3:.4g} mm, that is ({text}) m."
                + (f" It would then overlap {hits[name]!r}." if hits[name] else "")
                + either,
                pointers=(pose,),
                patch=translation_patch(surfaces.candidate, mover, offset),
            )
        )
    if not found:
        found.append(
            Correction(
                cause=f"{mover!r} is inside {other!r}",
                edit_class="scene",
                group="placement",
                action=f"Place {mover!r} elsewhere, at least {-gap.distance:.4g} m away, or make an opening in {other!r}.",
                pointers=(pose, pointer("entities", other, "parts")),
            )
        )
    found.append(
        Correction(
            cause="the two are meant to be embedded or fastened",
            edit_class="scene",
            group="relations",
            action=f"If the prompt says so, declare a `fastened` relation of {mover!r} and {other!r} with max_depth >= "
            f"{-gap.distance:.4g} m and the reason.",
            pointers=("/graph/relations",),
        )
    )
    return found

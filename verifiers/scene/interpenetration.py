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

from ...worlds.arrays import F64
from ...worlds.assemblies import bodies_with
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, move_by, move_parts, pointer
from ..rows.findings import Finding
from .bounds import FARTHER
from .own_bodies import own_gap, own_pairs
from .questions import OVERLAP, OVERLAP_SCENE
from .room import in_the_way, moves_alone
from .self_crossing import search_together, self_rows
from .separating import Barred, barred, clear_of, moves_apart, upward
from .surfaces import surfaces_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from .own_bodies import OwnPair
    from .surfaces import Gap, Surfaces

__all__ = ["check", "correction_order"]

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
    search_together(surfaces)
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


def _movers(surfaces: Surfaces, mover: str, other: str) -> tuple[int, ...]:
    """The parts to move: those in `other` where they hang together with no further part of their entity, else all of it."""
    rows = surfaces.parts_of[mover]
    inside = tuple(i for i in rows if len(rows) > 1 and not clear_of(surfaces, (i,), other, 0, np.zeros(3)))
    if inside and len(inside) < len(rows) and all(moves_alone(surfaces, i) for i in inside):
        return inside
    kin = _kin(surfaces, mover, other)
    return tuple(i for name in kin for i in surfaces.parts_of.get(name, ()))


def _kin(surfaces: Surfaces, mover: str, other: str) -> list[str]:
    """Entities that go along where one moves: all of its generated thing, unless the other is of it, too."""
    kin = bodies_with(surfaces.candidate.spec, mover)
    return [mover] if other in kin else kin


def _stands_elsewhere(surfaces: Surfaces, mover: str, other: str) -> bool:
    """True if something else is said to carry an entity, which a lift would take it off."""
    relations = surfaces.candidate.spec.graph.relations.values()
    return any(r.kind == "supports" and r.b == mover and r.a != other for r in relations)


def _fixed(surfaces: Surfaces, entity: str) -> bool:
    """True if an entity stays where it is placed: it is static, or pins hold it."""
    return surfaces.is_static(entity) or bool(getattr(surfaces.candidate.spec.entities[entity].physics, "pins", None))


def _move(surfaces: Surfaces, names: tuple[str, str], rows: Sequence[int], name: str, offset: F64, either: str) -> Correction:
    """Move these parts of the first entity out of the second, in the direction of that name."""
    mover, other = names
    text, length = ", ".join(f"{c:+.4g}" for c in offset), float(np.linalg.norm(offset)) * 1e3
    way = f"{name} by {length:.4g} mm, that is ({text}) m."
    if len(rows) >= len(surfaces.parts_of[mover]):
        cause = f"{mover!r} is placed inside {other!r}"
        whole = other not in bodies_with(surfaces.candidate.spec, mover)
        return move_by(surfaces.candidate, mover, offset, cause, f"Move {mover!r} {way}{either}", whole=whole)
    parts = [surfaces.parts[i].part for i in rows]
    told = ", ".join(parts[:NAMED]) + (f" and {len(parts) - NAMED} more" if len(parts) > NAMED else "")
    cause = f"part {told} of {mover!r} is placed inside {other!r}"
    return move_parts(surfaces.candidate, mover, dict.fromkeys(parts, offset), cause, f"Move {told} of {mover!r} {way}{either}")


def _make_way(names: tuple[str, str], bar: Barred) -> Correction:
    """Move the first entity the least way, and the part of the second that stands there with it."""
    mover, other = names
    text, length = ", ".join(f"{c:+.4g}" for c in bar.offset), float(np.linalg.norm(bar.offset)) * 1e3
    return correction(
        f"{mover!r} is placed inside {other!r}, and {other}/{bar.part} stands in its least way out",
        "placement",
        f"Move {mover!r} out by {length:.4g} mm, that is ({text}) m, with all that belongs to it, and {other}/{bar.part} by as much: "
        f"an opening goes along with what stands in it. Or shorten the part that overlaps by as much.",
        pointers=(pointer("entities", mover, "pose"), pointer("entities", other, "parts", bar.part)),
    )


def _corrections(
    surfaces: Surfaces, names: tuple[str, str], gap: Gap, *, swapped: bool, detailed: bool
) -> tuple[Correction, ...]:
    mover, other = names
    rows = _movers(surfaces, mover, other) if detailed else ()
    moves = moves_apart(surfaces, names, rows, gap, swapped=swapped) if detailed else {}
    bar = barred(surfaces, names, rows, gap, swapped=swapped) if detailed else None
    if bar is not None:  # then the others lead around what stands there
        most = FARTHER * float(np.linalg.norm(bar.offset))
        moves = {name: move for name, move in moves.items() if np.linalg.norm(move) <= most}
    pose = pointer("entities", mover, "pose")
    either = f" Both are fixed: either may move, {other!r} the opposite way." if all(_fixed(surfaces, n) for n in names) else ""
    lifted, up = _stands_elsewhere(surfaces, mover, other), upward(surfaces)
    hits = {name: in_the_way(surfaces, rows, offset, (other,)) for name, offset in moves.items()}
    found = [
        _move(surfaces, names, rows, name, offset, either)
        for name, offset in sorted(moves.items(), key=lambda item: float(np.linalg.norm(item[1])))
        if hits[name] is None and not (lifted and float(offset @ up) > surfaces.contact_gap(mover, other))
    ]
    if bar is not None:
        found.insert(0, _make_way(names, bar))
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

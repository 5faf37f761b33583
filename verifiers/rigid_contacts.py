"""Laws of contact on the ledgers of a rigid instance.

- `contacts`: pairs that are logged as touching can reach each other.
- `friction`: a body that slides all the frame long without turning loses what Coulomb's law takes, no more and no less.
- `restitution`: a ball that hits once in a frame, and nothing else, leaves with the declared share of its closing speed; not where it goes
  on over ground whose facets turn it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..geometry import aabb_of
from ..worlds.arrays import F64
from ..worlds.spec import HeightField
from .ledgers import Books, books_of
from .rigid_rows import largest, law_row
from .uneven import even_ground
from .verdicts import correction

if TYPE_CHECKING:
    from ..worlds.cache import Cache
    from ..worlds.candidate import Candidate
    from ..worlds.requirements import Row

__all__ = ["BOUNCE", "FRICTION", "PREDICATES", "REACH", "contacts", "friction", "restitution"]

REACH = 1e-3
"""[m] Rounding of boxes and a frame's fall beyond the contact tolerance."""
FRICTION = 0.05
"""Own choice: relative; the engine's cone is met to 1e-3 while a body slides."""
BOUNCE = 0.05
"""Own choice: of restitution; measured 0.01 for single hits of balls at steps up to 2 ms."""
SLOW_BOUNCE = 0.25
"""[m/s] Slower hits are not judged: gravity in a step and the resting threshold are then a visible part of them."""
TURNED = 0.5 * BOUNCE
"""Own choice: part of the closing speed that a turn of the ground under a rolling ball may add to what it keeps."""
SLIDING = 0.1
"""[m/s] Slower bodies may stick within the frame."""
STRAIGHT = 0.9995
"""Cosine of the angle between the velocities at both frames from which on a body slides straight."""
ROLLS = 0.02
"""Share of the speed that turning may give the surface of a sliding body."""

PREDICATES = {
    "contacts": "pairs that are logged as touching are within reach of each other",
    "friction": f"a sliding body loses mu times the normal impulse, within {FRICTION:.0%}",
    "restitution": f"a ball leaves a single hit with the declared restitution within {BOUNCE:g}",
}


def _boxes(books: Books) -> tuple[F64, F64]:
    """Lowest and highest corners of every collider over the frames [m], each shape (F, colliders, 3)."""
    candidate, names = books.candidate, books.cache.index.colliders
    low = np.full((books.frames, len(names), 3), np.inf)
    high = -low
    for column, name in enumerate(names):
        built = candidate.entity(name)
        for body in built.bodies:
            parts = built.parts_of(body.name)
            if not parts:
                continue
            points = np.concatenate([p.render.vertices for p in parts])
            lo, hi = aabb_of(points, *candidate.track(name, body.name))
            low[: len(lo), column] = np.minimum(low[: len(lo), column], lo)
            high[: len(hi), column] = np.maximum(high[: len(hi), column], hi)
    return low, high


def contacts(candidate: Candidate, solver: str, cache: Cache) -> Row:
    """Row `contacts`: boxes swept over the interval, grown by the way that the fastest step of it could have led."""
    books = books_of(candidate, cache)
    found = books.contacts
    low, high = _boxes(books)
    k = found.frame
    low, high = np.minimum(low[k - 1], low[k]), np.maximum(high[k - 1], high[k])
    rows = np.arange(len(k))
    gap = np.maximum(low[rows, found.a] - high[rows, found.b], low[rows, found.b] - high[rows, found.a]).max(
        axis=1, initial=-np.inf
    )
    peak = books.record("max_speed")[k]
    excess = gap - candidate.spec.simulation.limits.contact_gap - 0.5 * books.duration * peak * 2.0
    table = np.full((books.frames - 1, len(books.entities)), -np.inf)
    for side in (found.a, found.b):
        row = books.collider_row[side]
        np.maximum.at(table, (k[row >= 0] - 1, row[row >= 0]), excess[row >= 0])
    worst = largest(table, np.isfinite(table), books.entities, REACH)
    return law_row(
        candidate,
        solver,
        "contacts",
        PREDICATES["contacts"],
        worst,
        bound=REACH,
        unit="m",
        what="distance of bodies that are logged as touching",
        none="no contact is logged in this interval",
        entities=books.entities,
    )


# ---------------------------------------------------------------- friction


def friction(candidate: Candidate, solver: str, cache: Cache) -> Row:
    """Row `friction`.

    All normals of a body that slides along without turning are perpendicular to its velocity, so that the momentum it loses
    along its way is the friction of all its contacts: mu times the sum of their normal impulses, at least and at most.
    """
    books = books_of(candidate, cache)
    found = books.contacts
    share, judged = np.zeros((2, books.frames - 1, len(books.entities)))
    total, least, most = np.zeros((3, books.frames - 1, len(books.entities)))
    moving = np.zeros((books.frames - 1, len(books.entities)), dtype=bool)
    for (
        side,
        other,
    ) in ((found.a, found.b), (found.b, found.a)):
        row, partner = books.collider_row[side], books.collider_row[other]
        mine = row >= 0
        at = (found.frame[mine] - 1, row[mine])
        np.add.at(total, at, found.impulse[mine])
        np.add.at(least, at, found.impulse[mine] * books.friction[0][mine])
        np.add.at(most, at, found.impulse[mine] * books.friction[1][mine])
        np.logical_or.at(moving, at, _moves(books, partner[mine], found.frame[mine] - 1))
    v0, v1 = books.velocities[:-1], books.velocities[1:]
    speeds = np.linalg.norm(v0, axis=2), np.linalg.norm(v1, axis=2)
    straight = np.sum(v0 * v1, axis=2) > STRAIGHT * speeds[0] * speeds[1]
    spin = np.linalg.norm(books.spin[:, books.first], axis=2) * books.reach
    turning = np.maximum(spin[:-1], spin[1:]) > ROLLS * np.minimum(*speeds)
    slides = (np.minimum(*speeds) > SLIDING) & straight & ~turning & ~moving & ~books.dozing & ~books.switching
    judged = slides & books.lone & (total > 0) & (books.free_time > books.duration - 1e-9)
    along = v0 + v1
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
    lost = -np.sum(books.residual * along, axis=2)
    scale = np.maximum(total, 1e-12)
    # In units of the normal impulse; a frictionless contact must not brake either.
    share = np.maximum(least - lost, lost - most) / scale
    allowed = FRICTION * np.maximum(most / scale, 0.02)
    worst = largest(share / allowed * FRICTION, judged, books.entities, FRICTION)
    hints = (
        correction(
            "the friction that acts is not the declared one",
            "material",
            "look at the materials and pairs of its contacts",
            pointers=("/materials",),
        ),
    )
    return law_row(
        candidate,
        solver,
        "friction",
        PREDICATES["friction"],
        worst,
        bound=FRICTION,
        unit="1",
        what="deviation from Coulomb's law",
        none="no free body slides straight on something that rests for a whole frame",
        entities=books.entities,
        hints=hints,
    )


def _moves(
    books: Books, rows: np.ndarray[tuple[int, ...], np.dtype[np.int64]], interval: np.ndarray[tuple[int, ...], np.dtype[np.int64]]
) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Whether a contact's partner moves at either end of the interval; static ones (row -1) do not."""
    speed = np.linalg.norm(books.velocity, axis=2) + np.linalg.norm(books.spin, axis=2) * books.body_reach
    fastest = np.zeros((books.frames, len(books.entities)))
    for body, owner in enumerate(books.owner):
        fastest[:, owner] = np.maximum(fastest[:, owner], speed[:, body])
    known = np.maximum(rows, 0)
    result = (rows >= 0) & (np.maximum(fastest[interval, known], fastest[interval + 1, known]) > 1e-3)
    return np.asarray(result)


# ---------------------------------------------------------------- restitution


class _Hit(NamedTuple):
    """One judged hit."""

    frame: int
    entity: int
    deviation: float
    closing: float
    kept: tuple[float, float]
    declared: tuple[float, float]


def restitution(candidate: Candidate, solver: str, cache: Cache) -> Row:
    """Row `restitution`.

    Velocities just before and after the hit follow from those of the frames before and after by the free flight between.
    Where the ball stays in contact, gravity may or may not have acted on it until the frame's end: an interval.
    """
    books = books_of(candidate, cache)
    hits = _hits(books)
    table = np.full((books.frames - 1, len(books.entities)), -np.inf)
    for hit in hits:
        table[hit.frame - 1, hit.entity] = max(table[hit.frame - 1, hit.entity], hit.deviation)
    worst = largest(table, np.isfinite(table), books.entities, BOUNCE)
    evidence: dict[str, object] = {
        "hits": [
            {
                "frame": h.frame,
                "entity": books.entities[h.entity],
                "closing_m_s": h.closing,
                "kept": h.kept,
                "declared": h.declared,
            }
            for h in sorted(hits, key=lambda h: -h.deviation)[:10]
        ]
    }
    hints = (
        correction(
            "restitution is not the declared one",
            "material",
            "look at the materials and pairs of the two",
            pointers=("/materials",),
        ),
    )
    return law_row(
        candidate,
        solver,
        "restitution",
        PREDICATES["restitution"],
        worst,
        bound=BOUNCE,
        unit="1",
        what="deviation of the restitution",
        none="no ball hits once, and nothing else, within a frame",
        entities=books.entities,
        hints=hints,
        evidence=evidence,
    )


def _radius(books: Books, collider: str) -> float | None:
    """Radius of an entity that is one ball about its centre of mass."""
    built = books.candidate.built.get(collider)
    if built is None or len(built.bodies) != 1:
        return None
    pieces = [c for p in built.parts for c in p.collision]
    if len(pieces) != 1 or pieces[0].kind != "sphere" or np.linalg.norm(pieces[0].pose.position - built.bodies[0].center) > 1e-6:
        return None
    return float(pieces[0].params[0])


def _declared(books: Books, a: str, b: str) -> tuple[float, float]:
    """Least and greatest declared restitution of a pair: the smaller of two materials', or the pair's own."""
    spec = books.candidate.spec
    for pair in spec.simulation.contacts.values():
        if {pair.a, pair.b} == {a, b} and pair.restitution is not None:
            return pair.restitution, pair.restitution
    own = [[spec.materials[p.material].restitution for p in books.candidate.entity(n).parts] for n in (a, b)]
    return min(min(own[0]), min(own[1])), min(max(own[0]), max(own[1]))


def _hits(books: Books) -> list[_Hit]:
    """Every hit that can be judged."""
    names = books.cache.index.colliders
    balls = {n for n in names if _radius(books, n) is not None and n in books.row}
    if not balls:
        return []
    logs = books.ragged("event/time", "event/pair", "event/point", "event/speed", "contact/pair")
    partners: list[dict[int, set[int]]] = []
    for log in logs:
        seen: dict[int, set[int]] = {}
        for a, b in log["contact/pair"].tolist():
            seen.setdefault(a, set()).add(b)
            seen.setdefault(b, set()).add(a)
        partners.append(seen)
    found = []
    for frame in range(1, books.frames):
        log = logs[frame]
        pairs = log["event/pair"].tolist()
        for i, (a, b) in enumerate(pairs):
            ball, other = (a, b) if names[a] in balls else (b, a)
            if names[ball] not in balls or any(
                ball in p or (other in p and names[other] in books.row) for j, p in enumerate(pairs) if j != i
            ):
                continue
            if partners[frame].get(ball, {other}) != {other} or other in partners[frame - 1].get(ball, set()):
                continue
            hit = _judge(books, frame, ball, other, float(log["event/time"][i]), log["event/point"][i], partners)
            if hit is not None:
                found.append(hit)
    return found


def _even(books: Books, ball: str, other: str, point: F64, velocity: F64, normal: F64, rest: float, closing: float) -> bool:
    """Whether a hit on ground of facets can be told from rolling: neither facets nor a step's travel turn the normal by too much."""
    contract = books.candidate.spec.entities[other]
    if contract.motion != "static" or not any(isinstance(p.shape, HeightField) for p in contract.parts.values()):
        return True
    along = velocity - (normal @ velocity) * normal
    speed = max(float(np.linalg.norm(along)), 1e-9)
    most = TURNED * closing / speed
    # Events are told to a step: so far the ball moved on between its place and the point.
    if speed * books.step / (_radius(books, ball) or np.inf) > most:
        return False
    return even_ground(books.candidate, other, point, along * rest, most=most)


def _turned(books: Books, ends: list[tuple[F64, F64]], normal: F64, size: float) -> float:
    """Speed that a glancing hit may seem to have along its normal [m/s]: the point is told to a step, in which the ball slides on."""
    most = 0.0
    for velocity in np.subtract(ends[0], ends[1] if len(ends) > 1 else np.zeros((2, 3))):
        along = float(np.linalg.norm(velocity - (normal @ velocity) * normal))
        most += along * min(1.0, along * books.step / size)
    return most


def _judge(
    books: Books, frame: int, ball: int, other: int, time: float, point: F64, partners: list[dict[int, set[int]]]
) -> _Hit | None:
    """One hit of a ball, if both sides are in free flight but for it, or the other side rests."""
    names, k = books.cache.index.colliders, frame - 1
    row, partner = books.row[names[ball]], books.row.get(names[other])
    before, after = time - books.times[k], books.times[frame] - time
    if not (0 <= before <= books.duration + 1e-9):
        return None
    sides = [row]
    if partner is not None and not (books.kinematic[partner] or books.free_time[k, partner] <= 0):
        if partners[frame].get(other, {ball}) != {ball}:
            return None
        sides.append(partner)
    elif partner is not None and bool(_moves(books, np.array([partner]), np.array([k]))[0]):
        return None
    for side in sides:
        unsteady = books.switching[k, side] or books.dozing[k, side] or books.drag[side] > 0
        if unsteady or not books.lone[side] or books.free_time[k, side] < books.duration - 1e-9:
            return None
    ends, centers = [], []
    for side in sides:
        force = books.driver_wrench[0][k, side] / books.mass[side] / books.duration + books.gravity
        v0 = books.velocities[k, side] + force * before
        v1 = books.velocities[frame, side] - force * after
        centers.append(books.centers[k, side] + books.velocities[k, side] * before + 0.5 * force * before**2)
        ends.append((v0, v1))
    normal = centers[0] - point
    size = float(np.linalg.norm(normal))
    if size < 1e-9:
        return None
    normal = normal / size
    still = np.zeros(3)
    other_before, other_after = ends[1] if len(ends) > 1 else (still, still)
    # The other side's surface moves with its spin too; only balls hit each other centrally.
    if len(ends) > 1 and _radius(books, names[other]) is None:
        return None
    closing = -float(normal @ (ends[0][0] - other_before))
    if closing < max(SLOW_BOUNCE, 6.0 * float(np.linalg.norm(books.gravity)) * books.step):
        return None
    away = float(normal @ (ends[0][1] - other_after))
    at_end = float(normal @ (books.velocities[frame, row] - (books.velocities[frame, partner] if len(sides) > 1 else still)))
    lasting = frame + 1 < len(partners) and other in partners[frame + 1].get(ball, set())
    lasting |= frame + 1 >= len(partners) or bool(books.asleep[frame, books.first[row]]) or abs(at_end) < 0.05
    low, high = (min(away, at_end), max(away, at_end)) if lasting else (away, away)
    kept = (max(low, 0.0) / closing, high / closing)
    declared = _declared(books, names[ball], names[other])
    if (lasting or declared[0] == 0.0) and not _even(books, names[ball], names[other], point, ends[0][1], normal, after, closing):
        return None
    off = _turned(books, ends, normal, size) / closing
    deviation = max(kept[0] - off - declared[1], declared[0] - kept[1] - off, 0.0)
    return _Hit(frame, row, deviation, closing, kept, declared)

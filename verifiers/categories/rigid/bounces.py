"""Bounces of balls, on the ledgers of a rigid instance.

- `restitution`: a ball that hits once in a frame, and nothing else, leaves with the declared share of its closing speed; not where it goes
  on over ground whose facets turn it, nor from an elastic body.

Velocities just before and after the hit follow from those of the frames before and after by the free flight between. Liquids and
force fields are known by their impulse over the whole frame, and not by how much of it came before the hit. Where they push, what the
contact gave is the change of momentum less gravity and all that they gave, which is exact; the closing speed is the logged one,
and must be that of free flight within what they give in the frames about the hit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ....worlds.spec import HeightField
from ...land.uneven import even_ground
from ...ledgers.balance import Books
from .bounds import BOUNCE, SLOW_BOUNCE, TURNED
from .contacts import moves
from .corrections import compare_materials
from .rows import Law

if TYPE_CHECKING:
    from ...rows.findings import Finding

__all__ = ["ball_radius", "declared_restitution", "restitution"]


class _Hit(NamedTuple):
    """One judged hit."""

    frame: int
    entity: int
    deviation: float
    closing: float
    kept: tuple[float, float]
    declared: tuple[float, float]


class _Event(NamedTuple):
    """A logged hit of a ball."""

    frame: int
    ball: int
    other: int
    time: float
    point: F64
    speed: float
    """At which the two closed [m/s]."""


def restitution(books: Books) -> Finding:
    """Deviation of the restitution of single hits.

    Where the ball stays in contact, gravity may or may not have acted on it until the frame's end: an interval.
    """
    hits = _hits(books)
    table = np.full((books.frames - 1, len(books.entities)), -np.inf)
    for hit in hits:
        table[hit.frame - 1, hit.entity] = max(table[hit.frame - 1, hit.entity], hit.deviation)
    law = Law(
        BOUNCE,
        "1",
        "deviation of the restitution",
        "no ball hits once, and nothing else, within a frame",
        lambda entity: compare_materials(f"restitution of {entity} is not the declared one"),
    )
    strongest = [
        {
            "frame": h.frame,
            "entity": books.entities[h.entity],
            "closing_m_s": h.closing,
            "kept": h.kept,
            "declared": h.declared,
        }
        for h in sorted(hits, key=lambda h: -h.deviation)[:10]
    ]
    return law.judge(books.entities, table, evidence={"hits": strongest})


def ball_radius(books: Books, collider: str) -> float | None:
    """Radius of an entity that is one ball about its centre of mass."""
    built = books.candidate.built.get(collider)
    if built is None or len(built.bodies) != 1:
        return None
    pieces = [c for p in built.parts for c in p.collision]
    if len(pieces) != 1 or pieces[0].kind != "sphere" or np.linalg.norm(pieces[0].pose.position - built.bodies[0].center) > 1e-6:
        return None
    return float(pieces[0].params[0])


def declared_restitution(books: Books, a: str, b: str) -> tuple[float, float]:
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
    balls = {n for n in names if ball_radius(books, n) is not None and n in books.row}
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
            if books.candidate.spec.entities[names[other]].physics.category == "elastic":
                continue  # what gives way throws the ball back by its own elasticity, over many frames
            if partners[frame].get(ball, {other}) != {other} or other in partners[frame - 1].get(ball, set()):
                continue
            event = _Event(frame, ball, other, float(log["event/time"][i]), log["event/point"][i], float(log["event/speed"][i]))
            hit = _judge(books, event, partners)
            if hit is not None:
                found.append(hit)
    return found


def _even(books: Books, ball: str, other: str, point: F64, velocity: F64, normal: F64, rest: float, closing: float) -> bool:
    """True if a hit on ground of facets can be told from rolling: neither facets nor a step's travel turn the normal by too much."""
    contract = books.candidate.spec.entities[other]
    if contract.motion != "static" or not any(isinstance(p.shape, HeightField) for p in contract.parts.values()):
        return True
    along = velocity - (normal @ velocity) * normal
    speed = max(float(np.linalg.norm(along)), 1e-9)
    most = TURNED * closing / speed
    # Events are told to a step: so far the ball moved on between its place and the point.
    if speed * books.step / (ball_radius(books, ball) or np.inf) > most:
        return False
    return even_ground(books.candidate, other, point, along * rest, most=most)


def _turned(books: Books, ends: list[tuple[F64, F64]], normal: F64, size: float) -> float:
    """Speed that a glancing hit may seem to have along its normal [m/s]: the point is told to a step, in which the ball slides on."""
    most = 0.0
    for velocity in np.subtract(ends[0], ends[1] if len(ends) > 1 else np.zeros((2, 3))):
        along = float(np.linalg.norm(velocity - (normal @ velocity) * normal))
        most += along * min(1.0, along * books.step / size)
    return most


def _judge(books: Books, event: _Event, partners: list[dict[int, set[int]]]) -> _Hit | None:
    """One hit of a ball, if both sides are in free flight but for it and what blows or bathes them, or the other side rests."""
    frame, ball, other, time, point, logged = event
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
    elif partner is not None and bool(moves(books, np.array([partner]), np.array([k]))[0]):
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
    if len(ends) > 1 and ball_radius(books, names[other]) is None:
        return None
    closing = -float(normal @ (ends[0][0] - other_before))
    pushed = sum(_pushed(books, k, side) for side in sides)
    if min(closing, logged if pushed > 0.0 else closing) < max(
        SLOW_BOUNCE, 6.0 * float(np.linalg.norm(books.gravity)) * books.step
    ):
        return None
    away = float(normal @ (ends[0][1] - other_after))
    at_end = float(normal @ (books.velocities[frame, row] - (books.velocities[frame, partner] if len(sides) > 1 else still)))
    lasting = frame + 1 < len(partners) and other in partners[frame + 1].get(ball, set())
    lasting |= frame + 1 >= len(partners) or bool(books.asleep[frame, books.first[row]]) or abs(at_end) < 0.05
    low, high = (min(away, at_end), max(away, at_end)) if lasting else (away, away)
    kept = (max(low, 0.0) / closing, high / closing)
    declared = declared_restitution(books, names[ball], names[other])
    if pushed > 0.0:
        kept = _wet(books, k, sides, normal, logged, pushed, resting=after if lasting else 0.0)
    if (lasting or declared[0] == 0.0) and not _even(books, names[ball], names[other], point, ends[0][1], normal, after, closing):
        return None
    off = _turned(books, ends, normal, size) / closing
    deviation = max(kept[0] - off - declared[1], declared[0] - kept[1] - off, 0.0)
    if pushed > 0.0:
        deviation = max(deviation, (abs(logged - closing) - pushed) / closing - off)
        closing = logged
    return _Hit(frame, row, deviation, closing, kept, declared)


def _pushed(books: Books, k: int, side: int) -> float:
    """Change of an entity's velocity by liquids and fields in the three frames about a hit [m/s]; 0 where none was there.

    What they gave until the hit and after it may cancel in its own frame, so that the frames beside it count too.
    """
    if not books.outside.wet[k, side]:
        return 0.0
    about = books.outside.linear[max(k - 1, 0) : k + 2, side]
    return float(np.linalg.norm(about, axis=1).sum() / books.mass[side])


def _wet(
    books: Books, k: int, sides: list[int], normal: F64, closing: float, pushed: float, *, resting: float
) -> tuple[float, float]:
    """Least and greatest share kept of a logged closing speed [m/s], by the impulse that the ledgers leave to the contact.

    The contact also bears the ball for as long as it lasts, against gravity and all that pushes it.
    """
    speed = float(normal @ books.residual[k, sides[0]]) * sum(1.0 / books.mass[side] for side in sides)
    borne = float(np.linalg.norm(books.gravity)) * resting + (pushed if resting > 0.0 else 0.0)
    return max((speed - borne) / closing - 1.0, 0.0), (speed + borne) / closing - 1.0

"""Every impact of balls by itself, also where several follow one another within a step: a row of balls that touch, a break of billiards.

The log tells the impacts one after another: when, between whom, along which normal, and what each gave. From the velocities at the frame
before, masses and these impulses alone follow the speeds before and after each. `rebounds` asks that a ball leaves
every impact with the declared share of its closing speed, no less and no more; no more where it meets several things at
once, for friction at one of them takes part in what another gives back. The log is held against the motion: what it leaves of a frame's change
of momentum along a normal is the doubt of that impact, or the friction of all else that the balls touch, if that is more (it may turn round within
the frame); normals of two balls lie along the line of their centres, and a contact that begins at speed has an impact.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ...ledgers.balance import Books, frictions
from ...rows.findings import Finding
from .bounces import ball_radius, declared_restitution
from .bounds import ASKEW, BOUNCE, DECIDED, SLOW_BOUNCE, UNTOLD
from .contacts import moves
from .corrections import compare_materials
from .rows import Law

__all__ = ["rebounds"]


class _Rebound(NamedTuple):
    """A judged impact."""

    frame: int
    entities: tuple[str, str]
    closing: float
    kept: float
    declared: tuple[float, float]
    alone: bool
    deviation: float


class _Side(NamedTuple):
    """One side of an impact: the row of a ball, or of nothing that moves (-1)."""

    row: int
    known: bool
    """False where it moves otherwise than by gravity, its driver and impacts."""


def rebounds(books: Books) -> Finding:
    """Deviation of the restitution of impacts."""
    spec, solver = books.candidate.spec, books.cache.index.solver
    members = [spec.entities[m] for m in spec.simulation.solvers[solver].members if m in spec.entities]
    if any(e.breakable is not None for e in members):
        return Finding("not_applicable", f"impacts of {solver!r}, which holds debris, are not told one by one")
    found = [r for k in range(1, books.frames) for r in _frame(books, k)]
    table = np.full((books.frames - 1, len(books.entities)), -np.inf)
    for rebound in found:
        row = next(books.row[n] for n in rebound.entities if n in books.row)
        table[rebound.frame - 1, row] = max(table[rebound.frame - 1, row], rebound.deviation)
    law = Law(
        BOUNCE,
        "1",
        "deviation of the restitution of an impact",
        "no ball has an impact that frames decide",
        lambda entity: compare_materials(f"an impact of {entity} gives back another share than the declared one"),
    )
    strongest = sorted(found, key=lambda r: -r.deviation)[:10]
    return law.judge(books.entities, table, evidence={"impacts": len(found), "worst": [r._asdict() for r in strongest]})


def _side(books: Books, k: int, collider: int) -> _Side:
    """A collider as the side of an impact in the interval that ends at frame k."""
    name = books.cache.index.colliders[collider]
    row = books.row.get(name)
    if row is None:
        return _Side(-1, known=True)
    if books.kinematic[row] or books.free_time[k - 1, row] <= 0:
        return _Side(-1, known=not bool(moves(books, np.array([row]), np.array([k - 1]))[0]))
    unsteady = books.switching[k - 1, row] or books.drag[row] > 0 or books.outside.wet[k - 1, row]
    free = bool(books.lone[row]) and not unsteady and books.free_time[k - 1, row] >= books.duration - 1e-9
    return _Side(row, known=free and ball_radius(books, name) is not None)


class _Balls:
    """Balls in one frame, from impact to impact."""

    def __init__(self, books: Books, k: int) -> None:
        self.books, self.k, self.time = books, k, float(books.times[k - 1])
        self.speed, self.place = books.velocities[k - 1].copy(), books.centers[k - 1].copy()
        force = books.driver_wrench[0][k - 1] / books.mass[:, None] / books.duration
        self.pull: F64 = force + books.gravity

    def fly(self, time: float) -> None:
        """Go on to `time` [s]."""
        span = time - self.time
        self.place = self.place + self.speed * span + 0.5 * self.pull * span**2
        self.speed = self.speed + self.pull * span
        self.time = time

    def along(self, sides: tuple[_Side, _Side], normal: F64) -> float:
        """Speed at which two sides close along a normal that leads from the first to the second [m/s]."""
        one, two = (self.speed[s.row] if s.row >= 0 else np.zeros(3) for s in sides)
        return float(normal @ (one - two))

    def push(self, sides: tuple[_Side, _Side], vector: F64) -> None:
        """Give the second side an impulse [N s], and the first the opposite."""
        for side, sign in zip(sides, (-1.0, 1.0), strict=True):
            if side.row >= 0:
                self.speed[side.row] += sign * vector / self.books.mass[side.row]


def _frame(books: Books, k: int) -> list[_Rebound]:
    """The impacts of the interval that ends at frame k, and what begins at speed without one."""
    names = ("impact/time", "impact/pair", "impact/turn", "impact/normal", "impact/vector")
    log = books.cache.ragged(*names)[k]
    pairs, balls = log["impact/pair"].tolist(), _Balls(books, k)
    sides = [(_side(books, k, a), _side(books, k, b)) for a, b in pairs]
    found: list[tuple[_Rebound, tuple[_Side, _Side], F64]] = []
    order = np.lexsort((log["impact/turn"], log["impact/time"]))
    turns = np.flatnonzero(
        np.diff(log["impact/time"][order], prepend=-1.0).astype(bool)
        | np.diff(log["impact/turn"][order], prepend=-1).astype(bool)
    )
    for group in np.split(order, turns[1:]) if len(order) else []:
        balls.fly(float(log["impact/time"][group[0]]))
        before = {int(i): balls.along(sides[i], log["impact/normal"][i]) for i in group}
        met = [s.row for i in group for s in sides[i] if s.row >= 0]
        straight = {int(i): _straight(balls, sides[i], log["impact/normal"][i]) for i in group}
        for i in group:
            balls.push(sides[i], log["impact/vector"][i])
        for i in map(int, group):
            if before[i] < _slowest(books) or not all(s.known for s in sides[i]) or all(s.row < 0 for s in sides[i]):
                continue
            alone = all(met.count(s.row) == 1 for s in sides[i] if s.row >= 0)
            kept = -balls.along(sides[i], log["impact/normal"][i]) / before[i]
            ends = tuple(books.cache.index.colliders[c] for c in pairs[i])
            low, high = declared_restitution(books, ends[0], ends[1])
            off = 0.0 if straight[i] else UNTOLD
            rebound = _Rebound(k, (ends[0], ends[1]), before[i], kept, (low, high), alone, off)
            found.append((rebound, sides[i], log["impact/normal"][i]))
    balls.fly(float(books.times[k]))
    left = books.velocities[k] - balls.speed
    rubbed = _rubbed(books, k, log) if found else np.zeros(0)
    judged = (_weighed(*one, left, rubbed) for one in found)
    return [r for r in judged if r is not None] + _untold(books, k, log)


def _slowest(books: Books) -> float:
    """Closing speed from which on an impact is judged [m/s]."""
    return max(SLOW_BOUNCE, 6.0 * float(np.linalg.norm(books.gravity)) * books.step)


def _straight(balls: _Balls, sides: tuple[_Side, _Side], normal: F64) -> bool:
    """True unless two balls meet along another line than that of their centres."""
    if any(s.row < 0 or not s.known for s in sides):
        return bool(abs(np.linalg.norm(normal) - 1.0) < 1e-6)
    line = balls.place[sides[1].row] - balls.place[sides[0].row]
    return bool(normal @ line > ASKEW * np.linalg.norm(line))


def _rubbed(books: Books, k: int, log: dict[str, NDArray[Any]]) -> F64:
    """Most speed that friction outside the impacts of the interval that ends at frame k can have given each entity [m/s], shape (E,)."""
    names, result = books.cache.index.colliders, np.zeros(len(books.entities))
    impacts: dict[tuple[int, ...], float] = {}
    for pair, given in zip(map(tuple, log["impact/pair"].tolist()), _along(log), strict=True):
        impacts[pair] = impacts.get(pair, 0.0) + given
    found = books.cache.ragged("contact/pair", "contact/impulse")[k]
    rough = frictions(books.candidate, names)[1]
    for (a, b), impulse in zip(found["contact/pair"].tolist(), found["contact/impulse"].tolist(), strict=True):
        friction = rough[a, b] * max(impulse - impacts.get((a, b), 0.0), 0.0)
        for row in {books.row[names[c]] for c in (a, b) if names[c] in books.row and a != b}:
            result[row] += friction / books.mass[row]
    return result


def _weighed(rebound: _Rebound, sides: tuple[_Side, _Side], normal: F64, left: F64, rubbed: F64) -> _Rebound | None:
    """The impact with its deviation; None where too much else acted along its normal.

    That is the change of velocity that the log leaves, `left` [m/s], or what friction can have given, `rubbed` [m/s], before the impact or after it.
    """
    doubt = sum(max(abs(float(normal @ left[s.row])), float(rubbed[s.row])) for s in sides if s.row >= 0)
    if rebound.deviation == UNTOLD:
        return rebound
    if doubt > DECIDED * rebound.closing:
        return None
    low, high = rebound.declared
    after = rebound.kept * rebound.closing
    least, most = (after - doubt) / (rebound.closing + doubt), (after + doubt) / (rebound.closing - doubt)
    return rebound._replace(deviation=max(least - high, (low - most) if rebound.alone else 0.0, 0.0))


def _untold(books: Books, k: int, log: dict[str, NDArray[Any]]) -> list[_Rebound]:
    """Contacts of balls that begin in the frame at speed, or push as only an impact does, and of which no impact is told."""
    events, names = books.ragged("event/pair", "event/speed")[k], books.cache.index.colliders
    pairs, slowest = {tuple(p) for p in log["impact/pair"].tolist()}, _slowest(books)
    suspects = {
        (a, b): speed
        for (a, b), speed in zip(events["event/pair"].tolist(), events["event/speed"].tolist(), strict=True)
        if speed >= slowest and (a, b) not in pairs
    }
    if pairs:
        struck = {c for p in pairs for c in p if names[c] in books.row}
        for (a, b), speed in _pushes(books, k, log).items():
            if {a, b} & struck and speed > slowest:
                suspects.setdefault((a, b), speed)
    found = []
    for (a, b), speed in suspects.items():
        sides = _side(books, k, a), _side(books, k, b)
        if all(s.known for s in sides) and any(s.row >= 0 for s in sides):
            declared = declared_restitution(books, names[a], names[b])
            found.append(_Rebound(k, (names[a], names[b]), speed, np.nan, declared, alone=True, deviation=UNTOLD))
    return found


def _pushes(books: Books, k: int, log: dict[str, NDArray[Any]]) -> dict[tuple[int, int], float]:
    """Speed that each pair of colliders gave each other as only an impact does, beside the impacts told [m/s].

    By the largest force of a step, less what a body that is no ball presses a ball against the other with; and by all that the pair gave in the
    frame, less what can have pressed balls that touch together: what anything else gives them.
    """
    names, step = books.cache.index.colliders, float(books.record("step")[k])
    told: dict[tuple[int, ...], dict[float, float]] = {}
    for pair, time, given in zip(map(tuple, log["impact/pair"].tolist()), log["impact/time"].tolist(), _along(log), strict=True):
        steps = told.setdefault(pair, {})
        steps[time] = steps.get(time, 0.0) + given
    found = books.cache.ragged("contact/pair", "contact/impulse", "contact/max_force")[k]
    pressed, squeezed, result = _pressed(books, k, found), _squeezed(books, k, found), {}
    for i, ((a, b), impulse, force) in enumerate(
        zip(found["contact/pair"].tolist(), found["contact/impulse"].tolist(), found["contact/max_force"].tolist(), strict=True)
    ):
        light = sum(1.0 / books.mass[books.row[names[c]]] for c in (a, b) if names[c] in books.row)
        steps = told.get((a, b), {0.0: 0.0})
        in_a_step, in_all = (
            (force - float(squeezed[i])) * step - max(steps.values()),
            impulse - sum(steps.values()) - float(pressed[i]),
        )
        result[a, b] = light * max(in_a_step, in_all)
    return result


def _squeezed(books: Books, k: int, found: dict[str, NDArray[Any]]) -> F64:
    """Largest force with which bodies that move, and are no balls, press the balls of each contact of a frame from elsewhere [N], shape (n,).

    A domino that wedges a marble onto its table gives the table as much in that very step as the marble: no impact of these two alone.
    """
    names, pair, force = books.cache.index.colliders, found["contact/pair"], found["contact/max_force"]
    rough, presses = frictions(books.candidate, names)[1], np.zeros(len(names))
    sides = {c: _side(books, k, c) for c in np.unique(pair).tolist()}
    ball = {c: side.row >= 0 and side.known for c, side in sides.items()}
    moving = {c: names[c] in books.row and not ball[c] for c in sides}
    given = np.zeros((len(force), 2))
    for i, (a, b) in enumerate(pair.tolist()):
        for end, (mine, other) in enumerate(((a, b), (b, a))):
            if ball[mine] and moving[other]:
                given[i, end] = force[i] * (1.0 + rough[a, b])
                presses[mine] += given[i, end]
    return np.asarray([presses[a] + presses[b] - own.sum() for (a, b), own in zip(pair.tolist(), given, strict=True)])


def _pressed(books: Books, k: int, found: dict[str, NDArray[Any]]) -> F64:
    """Most that anything but balls can press into the set of touching balls that each contact of a frame belongs to [N s], shape (n,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    names, pair, count = books.cache.index.colliders, found["contact/pair"], len(books.cache.index.colliders)
    is_ball = np.zeros(count, dtype=bool)
    for c in np.unique(pair).tolist():
        side = _side(books, k, c)
        is_ball[c] = side.row >= 0 and side.known
    both = is_ball[pair].all(axis=1)
    graph = coo_array((np.ones(both.sum()), (pair[both, 0], pair[both, 1])), shape=(count, count))
    group = connected_components(graph, directed=False)[1]
    rough = frictions(books.candidate, names)[1][pair[:, 0], pair[:, 1]]
    outside = np.where(both, 0.0, found["contact/impulse"] * (1.0 + rough))
    given = np.zeros(count)
    for end in (0, 1):
        np.add.at(given, group[pair[:, end]], np.where(is_ball[pair[:, end]], outside, 0.0))
    return np.where(both, given[group[pair[:, 0]]], np.inf)


def _along(log: dict[str, NDArray[Any]]) -> list[float]:
    """Normal impulses of the impacts told [N s]."""
    given: list[float] = np.einsum("ni,ni->n", log["impact/normal"], log["impact/vector"]).tolist()
    return given

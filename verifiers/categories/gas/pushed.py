"""Impulses that a gas gives to the bodies, sheets and particles that it carries, worked out anew from its cells and from how these move (R66, R105).

Another route than the solvers': cells are looked up by spline interpolation of order one, the area that a body shows is that of the outline of
its hull across the flow, and each interval between frames is summed by Simpson's rule with the way between both ends. What declares lift is flown
anew through the cells' stream from frame to frame (`verifiers/ledgers/gliding.py`).
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.categories.gas.carrying import carried_members
from ....worlds.fields import fields_of
from ....worlds.instances import felt_by
from ...ledgers.balance import books_of
from ...ledgers.fields import recorded
from ...ledgers.gliding import Air, ends_of, glide, hull_in
from ..cloth.frames import cloth_run
from .pushed_particles import on_particles
from .stream import Given, Stream

if TYPE_CHECKING:
    from ....physics.lift import Hull
    from ....worlds.candidate import Candidate
    from ...ledgers.balance import Books
    from ..cloth.frames import ClothRun
    from .frames import GasBox

__all__ = ["given_by"]

FLAT = 1e-12
"""[m^2] An outline of less is none."""


def given_by(box: GasBox) -> list[Given]:
    """Impulses on everything that a gas carries and whose records tell of them: bodies one by one, sheets and particles by instance.

    Raises:
        EvidenceError: a cache or a channel is missing.
    """
    return box.candidate.memo(("given by gas", box.solver), lambda: _given(box))


def _given(box: GasBox) -> list[Given]:
    candidate, found = box.candidate, []
    felt = felt_by(candidate.spec, box.solver)
    for other, members in carried_members(candidate.spec, box.solver).items():
        stream = Stream(box, yields=other in felt)
        if other in candidate.rigid_caches and candidate.rigid_caches[other].index.bodies:
            books = books_of(candidate, candidate.rigid_caches[other])
            found += [_on_body(stream, books, b) for b, o in enumerate(books.owner) if books.entities[o] in members]
        elif other in candidate.cloth_caches:
            found.append(_on_sheets(stream, cloth_run(candidate, other)))
        elif other in candidate.particle_caches:
            found.append(on_particles(stream, candidate, other))
    return found


# ---------------------------------------------------------------- bodies


def _on_body(stream: Stream, books: Books, body: int) -> Given:
    """Impulses on one body."""
    candidate, owner, h = books.candidate, books.owner[body], books.duration
    entity, name = books.cache.index.bodies[body].split("/", 1)
    parts = candidate.entity(entity).parts_of(name)
    hull = _hull(np.concatenate([p.render.vertices for p in parts])) if parts else np.zeros((0, 3))
    x, v, turn = books.body_centers[:, body], books.velocity[:, body], books.turns[:, body]
    middle = 0.5 * (x[:-1] + x[1:]) + h / 8 * (v[:-1] - v[1:])
    inside = np.array([k < stream.box.frames and stream.within(x[k : k + 1], k)[0] for k in range(books.frames)])
    both, lifted = inside[:-1] & inside[1:], hull_in(books, body)
    if lifted is not None:
        worked_out, at_once = _lifted(stream, books, body, lifted, both)
    else:
        worked_out, at_once = _dragged(stream, hull, turn, (x, v, middle), inside)
    given = recorded(books)[:, body] - float(books.body_mass[body]) * _pulled(candidate, entity, x, books.times)
    awake = ~(books.asleep[:-1, body] | books.asleep[1:, body])
    judged = both & awake & (books.free_time[:, owner] > h - 1e-9)
    if lifted is not None:
        judged &= books.lone[owner] & ~books.touched[:, owner]
    return Given((entity,), given, worked_out, {entity: worked_out}, judged, both, None, at_once)


def _dragged(stream: Stream, hull: F64, turn: F64, way: tuple[F64, F64, F64], inside: NDArray[np.bool_]) -> tuple[F64, F64]:
    """Impulses by drag on a body [N s], (F - 1, 3), and by how much they are others if the gas gives way at once.

    Args:
        stream: of the gas.
        hull: of the body.
        turn: its orientations, shape (F, 3, 3).
        way: its places [m] and velocities [m/s] at the frames, and its places between them.
        inside: whether it is in the box at each frame.
    """
    (x, v, middle), h = way, stream.box.duration
    coefficient, count = float(stream.box.settings.coefficient), len(x) - 1
    ends, between, at_once = np.zeros((count + 1, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    for k in np.flatnonzero(inside).tolist():
        ends[k] = _force(stream, coefficient, hull, turn[k], (x[k], v[k]), (k, 0.0))
    both = inside[:-1] & inside[1:]
    for k in np.flatnonzero(both).tolist():
        moves = (middle[k], 0.5 * (v[k] + v[k + 1]))
        between[k] = _force(stream, coefficient, hull, turn[k], moves, (k, 0.5))
        at_once[k] = stream.at_once(partial(_force_at, stream, coefficient, hull @ turn[k].T, moves, k))
    return np.where(both[:, None], h / 6 * (ends[:-1] + 4 * between + ends[1:]), 0.0), at_once


def _lifted(stream: Stream, books: Books, body: int, hull: Hull, both: NDArray[np.bool_]) -> tuple[F64, F64]:
    """The same of a body that declares lift, in the intervals in which it is in the box at `both` ends."""
    x, v, h, count = books.body_centers[:, body], books.velocity[:, body], books.duration, books.frames - 1
    middle = 0.5 * (x[:-1] + x[1:]) + h / 8 * (v[:-1] - v[1:])
    coefficient = 0.5 * float(stream.box.settings.coefficient)
    velocity, pressure, at_once = np.zeros((3, count, 3)), np.zeros((3, count)), np.zeros((count, 3))
    for k in np.flatnonzero(both).tolist():
        for row, (place, share) in enumerate(((x[k], 0.0), (middle[k], 0.5), (x[k + 1], 1.0))):
            flow, density = stream.at(place[None], k, share)
            velocity[row, k], pressure[row, k] = flow[0], coefficient * float(density[0])
    entity = books.cache.index.bodies[body].split("/", 1)[0]
    pull = np.repeat(_pulled(books.candidate, entity, x, books.times)[None] / h, 3, axis=0)
    air, mass = Air(velocity, pressure, pull), float(books.body_mass[body])
    rest = (mass, books.inertia[body]), books.gravity
    impulse = glide(hull, *rest, air, ends_of(books, body), h).impulse
    if stream.yields:
        # As it is at the start or at the end of the interval, all through it.
        still = [Air(*(np.repeat(a[j : j + 1], 3, axis=0) for a in air)) for j in (0, 2)]
        one, two = (glide(hull, *rest, a, ends_of(books, body), h).impulse for a in still)
        at_once = 0.5 * (two - one)
    return np.where(both[:, None], impulse - mass * h * pull[0], 0.0), np.where(both[:, None], at_once, 0.0)


def _hull(points: F64) -> F64:
    """Corners of the convex hull of points."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points


def _force(stream: Stream, coefficient: float, hull: F64, turn: F64, moves: tuple[F64, F64], when: tuple[int, float]) -> F64:
    """Drag [N] on a body of a hull, at a place with a velocity, at a frame and a share of the way to the next."""
    place, speed = moves
    velocity, density = stream.at(place[None], *when)
    past = velocity[0] - speed
    fast = float(np.linalg.norm(past))
    if fast == 0.0:
        return np.zeros(3)
    return np.asarray(0.5 * density[0] * coefficient * _outline(hull @ turn.T, past / fast) * fast * past)


def _force_at(stream: Stream, coefficient: float, hull: F64, moves: tuple[F64, F64], frame: int, share: float) -> F64:
    """Drag [N] on a body of a hull as it is turned, in the gas as it is a share of the way between two frames."""
    return _force(stream, coefficient, hull, np.eye(3), moves, (frame, share))


def _outline(points: F64, along: F64) -> float:
    """Area of the outline of points seen along a unit vector [m^2]."""
    from scipy.spatial import ConvexHull, QhullError

    first = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    first /= np.linalg.norm(first)
    seen = points @ np.stack([first, np.cross(along, first)], axis=1)
    if len(seen) < 3 or min(np.ptp(seen, axis=0)) ** 2 < FLAT:
        return 0.0
    try:
        return float(ConvexHull(seen).volume)
    except QhullError:
        return 0.0


def _pulled(candidate: Candidate, entity: str, x: F64, times: F64) -> F64:
    """Velocity that fields without a medium gave over each interval [m/s], shape (F - 1, 3)."""
    fields = fields_of(candidate.spec, entity)
    if not any(d.field.kind == "attraction" for d in fields.drivers):
        return np.zeros((len(x) - 1, 3))
    pull = np.array([fields.acceleration(p[None], t)[0] for p, t in zip(x, times, strict=True)])
    return np.asarray(0.5 * np.diff(times)[:, None] * (pull[:-1] + pull[1:]))


# ---------------------------------------------------------------- sheets


def _on_sheets(stream: Stream, run: ClothRun) -> Given:
    """Impulses on all sheets of an instance, whose record tells of them together."""
    candidate, frames = run.candidate, stream.box.frames
    h, names = stream.box.duration, tuple(dict.fromkeys(p.entity for p in run.pieces))
    ends = {n: np.zeros((frames, 3)) for n in names}
    middle = {n: np.zeros((frames - 1, 3)) for n in names}
    inside, pulled, at_once = np.ones(frames, dtype=bool), np.zeros((frames, 3)), np.zeros((frames - 1, 3))
    before: Any = None
    for k in range(frames):
        x, v = run.frame(k)
        inside[k] = all(bool(stream.within(x[p.faces].mean(axis=1), k).all()) for p in run.pieces)
        for name, force in _blown(stream, run, x, v, (k, 0.0)).items():
            ends[name][k] = force
        if before is not None:
            a, b = before
            way = 0.5 * (a + x) + h / 8 * (b - v)
            speed = 1.5 / h * (x - a) - 0.25 * (b + v)
            for name, force in _blown(stream, run, way, speed, (k - 1, 0.5)).items():
                middle[name][k - 1] = force
            at_once[k - 1] = stream.at_once(partial(_all_blown, stream, run, way, speed, k - 1))
        pulled[k] = _weights(candidate, run, x, k * h)
        before = x, v
    sums = {n: h / 6 * (ends[n][:-1] + 4 * middle[n] + ends[n][1:]) for n in names}
    told = np.stack([run.record(f"air_impulse_{a}") for a in "xyz"], axis=1)[:frames]
    given = np.diff(told, axis=0) - 0.5 * h * (pulled[:-1] + pulled[1:])
    free = np.arange(frames - 1) * h >= run.start - 1e-9
    kept = inside[:-1] & inside[1:]
    return Given(names, given, sum(sums.values(), np.zeros((frames - 1, 3))), sums, kept & free, kept, None, at_once)


def _blown(stream: Stream, run: ClothRun, x: F64, v: F64, when: tuple[int, float]) -> dict[str, F64]:
    """Force of the gas on each sheet [N]: of its speed across each face and along it."""
    found: dict[str, F64] = {}
    for piece in run.pieces:
        a, b, c = (x[piece.faces[:, j]] for j in range(3))
        area = 0.5 * np.cross(b - a, c - a)
        size = np.linalg.norm(area, axis=1)
        normal = area / np.maximum(size, 1e-300)[:, None]
        velocity, density = stream.at((a + b + c) / 3.0, *when)
        past = velocity - v[piece.faces].mean(axis=1)
        across = (past * normal).sum(axis=1)[:, None] * normal
        pressure = piece.physics.drag * across + piece.physics.skin_drag * (past - across)
        force = ((0.5 * density * size * np.linalg.norm(past, axis=1))[:, None] * pressure).sum(axis=0)
        found[piece.entity] = found.get(piece.entity, np.zeros(3)) + force
    return found


def _all_blown(stream: Stream, run: ClothRun, x: F64, v: F64, frame: int, share: float) -> F64:
    """Force of the gas on all sheets [N], (3,), in the gas as it is a share of the way between two frames."""
    return sum(_blown(stream, run, x, v, (frame, share)).values(), np.zeros(3))


def _weights(candidate: Candidate, run: ClothRun, x: F64, time: float) -> F64:
    """Force of fields without a medium on all sheets [N]."""
    total: F64 = np.zeros(3)
    for piece in run.pieces:
        fields = fields_of(candidate.spec, piece.entity)
        if any(d.field.kind == "attraction" for d in fields.drivers):
            total += run.mass[piece.rows] @ fields.acceleration(x[piece.rows], time)
    return total

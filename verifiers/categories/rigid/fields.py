"""Judges whether what force fields gave to rigid bodies is what the declared fields say (R18, R63).

`fields` asks the declared fields again at the poses and velocities of the frames: Simpson's rule over each
interval, with the state in its middle from both ends. Where contacts, joints, cloth or liquids may have turned a body's way between two
frames, drag is known only so far (`_astray`). Bodies that declare lift are another matter (`lifted.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....physics.drag import area_vectors, drag_force, projected_area
from ....worlds.arrays import F64, rotation_matrix
from ....worlds.fields import Fields
from ...ledgers.fields import feels_fields, fields_in, recorded, twisted
from ...ledgers.gliding import hull_in
from .bounds import FIELD
from .lifted import lifted_off
from .rows import Law

if TYPE_CHECKING:
    from ...ledgers.balance import Books
    from ...rows.findings import Finding

__all__ = ["fields"]


def fields(books: Books) -> Finding:
    """Deviation of recorded impulses from those of the declared fields."""
    spec = books.candidate.spec
    excess = np.full((books.frames - 1, len(books.owner)), -np.inf)
    if feels_fields(spec, books.cache.index.solver):
        given, twist = recorded(books), twisted(books)
        for body in range(len(books.owner)):
            found = fields_in(books.candidate, books.entities[books.owner[body]])
            if found:
                excess[:, body] = _excess(books, body, found, (given[:, body], twist[:, body]))
            else:
                excess[:, body] = np.where(np.abs(given[:, body]).any(axis=1), np.inf, -np.inf)
    names = tuple(books.entities[o] for o in books.owner)
    law = Law(
        FIELD,
        "1",
        "deviation of a field's impulse from the declared field, as share of its largest,",
        "no force field acts on a body of this instance",
    )
    return law.judge(names, excess, np.isfinite(excess) | (excess > 0))


def _excess(books: Books, body: int, found: Fields, told: tuple[F64, F64]) -> F64:
    """Deviation of recorded impulses and twists beyond what the frames leave open, as share of the largest, shape (F - 1,)."""
    times, free, h = books.times, books.free_time[:, books.owner[body]], books.duration
    given = np.concatenate(told, axis=1)
    hull = hull_in(books, body) if found.has_medium else None
    if hull is not None:
        off = lifted_off(books, body, found, hull, told, _astray(books, body))
    else:
        off = _off(books, body, found, told[0])
    switch = [t for d in found.drivers for t in (d.start, d.start + d.rise, d.end) if t is not None]
    within = [(times[:-1] < t - 1e-9) & (times[1:] > t + 1e-9) for t in switch]
    steady = (free > h - 1e-9) & ~np.any([books.asleep[:-1, body] | books.asleep[1:, body], *within], axis=0)
    silent = (free <= 0) & (np.abs(given).max(axis=1) > 0)
    if not np.isfinite(off).any():
        return np.where(np.abs(given).max(axis=1) > 0, np.inf, 0.0)
    return np.where(silent, np.inf, np.where(steady, off, -np.inf))


def _off(books: Books, body: int, found: Fields, given: F64) -> F64:
    """The same of impulses by drag and accelerations, whatever the body does; infinite where the fields give none."""
    times, h = books.times, books.duration
    center, velocity, turn = books.body_centers[:, body], books.velocity[:, body], books.turns[:, body]
    entity, name = books.cache.index.bodies[body].split("/", 1)
    parts = books.candidate.entity(entity).parts_of(name)
    vectors = area_vectors(np.concatenate([p.render.vertices for p in parts])) if parts else np.zeros((1, 3))
    mass = float(books.body_mass[body])
    between = 0.5 * (center[:-1] + center[1:]) - h / 8 * (velocity[1:] - velocity[:-1])
    half = (
        books.quaternion[:-1, body]
        + books.quaternion[1:, body] * np.sign((books.quaternion[:-1, body] * books.quaternion[1:, body]).sum(axis=1))[:, None]
    )
    turned = rotation_matrix(half / np.linalg.norm(half, axis=1)[:, None])
    now = _forces(found, mass, vectors, times, center, velocity, turn)
    # A field that ends with the frame acts in all of it: the force at the end is that of just before.
    then = _forces(found, mass, vectors, times[1:] - 1e-9, center[1:], velocity[1:], turn[1:])
    middle = _forces(found, mass, vectors, times[:-1] + h / 2, between, 0.5 * (velocity[:-1] + velocity[1:]), turned)
    simpson, straight = h / 6 * (now[:-1] + 4 * middle + then), h / 2 * (now[:-1] + then)
    spread = np.linalg.norm(simpson - straight, axis=1) + h * np.linalg.norm(then - now[:-1], axis=1)
    scale = max(
        h * float(np.linalg.norm(now, axis=1).max(initial=0.0)), h * float(np.linalg.norm(middle, axis=1).max(initial=0.0))
    )
    if found.has_medium:
        spread += h * _astray(books, body) * _resistance(books, body, found, vectors)
    if scale <= 0:
        return np.full(books.frames - 1, np.inf)
    return np.asarray((np.linalg.norm(given - simpson, axis=1) - spread) / scale)


def _astray(books: Books, body: int) -> F64:
    """Largest deviation of a body's velocity between two frames from the straight line between theirs [m/s], shape (F - 1,).

    By all that contacts and coupled engines gave it, at whatever moments, and by its turn about a joint; but no farther than what
    the fastest recorded speed leaves.
    """
    owner, speed = books.owner[body], np.linalg.norm(books.velocity[:, body], axis=1)
    ends = np.maximum(speed[:-1], speed[1:])
    given = books.contact_budget[:, owner] + np.linalg.norm(books.liquid.linear[:, owner], axis=1)
    found = given / books.body_mass[body]
    if books.jointed[owner] or not books.single[owner]:
        turn = np.linalg.norm(books.spin[:, body], axis=1) * books.duration
        found = found + ends * (1.0 - np.cos(np.minimum(0.5 * np.maximum(turn[:-1], turn[1:]), np.pi)))
    return np.asarray(np.minimum(found, np.maximum(books.record("max_speed")[1:], ends) + ends))


def _resistance(books: Books, body: int, found: Fields, vectors: F64) -> F64:
    """Most that drag changes with a change of the velocity by what `_astray` says, per that change [N s/m], shape (F - 1,)."""
    push, flow = np.zeros(books.frames), np.zeros(books.frames)
    for k, time in enumerate(books.times.tolist()):
        medium = found.medium(books.body_centers[k : k + 1, body], time)
        push[k] = 0.5 * float(medium.density[0] * medium.coefficient[0])
        flow[k] = float(np.linalg.norm(medium.velocity[0] - books.velocity[k, body]))
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    widest = 0.5 * np.abs(vectors @ (vectors / np.maximum(size, 1e-300)).T).sum(axis=0).max()
    both = 2.0 * np.maximum(flow[:-1], flow[1:]) + _astray(books, body)
    return np.asarray(np.maximum(push[:-1], push[1:]) * widest * both)


def _forces(found: Fields, mass: float, vectors: F64, times: F64, center: F64, velocity: F64, turns: F64) -> F64:
    """Forces on one body at several times [N], shape (k, 3)."""
    result = np.zeros((len(times), 3))
    owner = np.zeros(len(vectors), dtype=np.int64)
    for k, time in enumerate(times.tolist()):
        at, speed = center[k : k + 1], velocity[k : k + 1]
        result[k] = mass * found.acceleration(at, time)[0]
        if found.has_medium:
            medium = found.medium(at, time)
            area = projected_area(vectors, owner, turns[k : k + 1], medium.velocity - speed)
            result[k] += drag_force(medium, area, speed)[0]
    return result

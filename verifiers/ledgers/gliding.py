"""Flight of a free body through a medium that lifts it: its way between two frames integrated anew, and what the medium gives it on it (R18, R66).

The solver steps once with a force that is limited, in world axes; this is the classical Runge-Kutta scheme in body axes, in steps that resolve
what the flow does. The law itself is that of `physics/lift.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...physics.lift import PEAK, Hull, hull_of, stacked, wrenches
from ...worlds.arrays import F64, rotation_matrix

if TYPE_CHECKING:
    from .balance import Books

__all__ = ["Air", "Ends", "Given", "along", "ends_of", "glide", "hull_in", "most", "slope"]

TURN = 0.05
"""[1] Share of a turn of a radian, and of whatever else has a time, per substep."""
MOST = 1024
"""Substeps at most."""
POINTS = 17
"""Own choice: points of the way between two frames at which what is not free is looked at."""


class Air(NamedTuple):
    """Medium and pulls about a body at the start, in the middle and at the end of k intervals."""

    velocity: F64
    """[m/s], shape (3, k, 3)."""
    pressure: F64
    """1/2 rho C [kg/m^3], shape (3, k)."""
    pull: F64
    """Acceleration by fields without a medium [m/s^2], shape (3, k, 3)."""


class Ends(NamedTuple):
    """Motion of a body at both ends of k intervals."""

    velocity: F64
    """[m/s], shape (2, k, 3)."""
    spin: F64
    """[rad/s], shape (2, k, 3)."""
    quaternion: F64
    """Shape (2, k, 4)."""


class Given(NamedTuple):
    """Impulse and twist that fields gave over k intervals."""

    impulse: F64
    """[N s], shape (k, 3)."""
    twist: F64
    """About the centre of mass [N m s], shape (k, 3)."""
    uneven: F64
    """Greatest changes of the force and the torque within them, times their length [N s, N m s], shape (k, 2)."""


def hull_in(books: Books, body: int) -> Hull | None:
    """Hull of a body of an instance that lift acts on; None of another."""
    entity, name = books.cache.index.bodies[body].split("/", 1)
    parts = books.candidate.entity(entity).parts_of(name)
    if not books.candidate.spec.entities[entity].physics.lifted or not parts:
        return None
    return hull_of(np.concatenate([p.render.vertices for p in parts]), books.offset[body])


def ends_of(books: Books, body: int) -> Ends:
    """Its motion at both ends of every interval."""

    def both(values: F64) -> F64:
        return np.stack([values[:-1, body], values[1:, body]])

    return Ends(both(books.velocity), both(books.spin), both(books.quaternion))


def most(hull: Hull, air: Air, speed: F64) -> F64:
    """Most that the law gives at a speed past the medium [N], shape (k,)."""
    return np.asarray(air.pressure.max(axis=0) * PEAK * hull.surface * speed**2)


def slope(hull: Hull, air: Air, speed: F64) -> F64:
    """Most by which the force changes with the velocity up to a speed past the medium [N s/m], shape (k,): as the law does with the angle too."""
    return np.asarray(2.0 * air.pressure.max(axis=0) * PEAK * hull.surface * speed)


def _between(three: F64, share: float) -> F64:
    """Parabola through values at the start, in the middle and at the end."""
    first, middle, last = (1 - share) * (1 - 2 * share), 4 * share * (1 - share), share * (2 * share - 1)
    return np.asarray(first * three[0] + middle * three[1] + last * three[2])


class _Law:
    """Force and torque on one body in k intervals, in what is about it."""

    def __init__(self, hull: Hull, air: Air, mass: float) -> None:
        self.hulls, self.air, self.mass = stacked([hull] * air.velocity.shape[1]), air, mass

    def at(self, turn: F64, velocity: F64, spin: F64, share: float) -> tuple[F64, F64]:
        """Force of all fields [N] and torque [N m], each shape (k, 3)."""
        flow = _between(self.air.velocity, share) - velocity
        found = wrenches(self.hulls, turn, flow, spin, _between(self.air.pressure, share))
        return found.force + self.mass * _between(self.air.pull, share), found.turning(spin)


def glide(hull: Hull, body: tuple[float, F64], gravity: F64, air: Air, ends: Ends, seconds: float) -> Given:
    """Impulse and twist that fields give to a body that nothing else touches over intervals of so many seconds.

    Args:
        hull: of the body.
        body: its mass [kg], and its inertia about its centre of mass, body axes [kg m^2], shape (3, 3).
        gravity: [m/s^2], shape (3,).
        air: about it.
        ends: its motion; that at the ends bounds how it turns on the way.
        seconds: length of the intervals.
    """
    (mass, inertia), law = body, _Law(hull, air, body[0])
    inverse, many = np.linalg.inv(inertia), ends.spin.shape[1]
    count = _substeps(hull, body, air, ends, seconds)

    def slopes(state: list[F64], share: float) -> list[F64]:
        velocity, turn, spin = state[:3]
        force, torque = law.at(turn, velocity, np.einsum("nij,nj->ni", turn, spin), share)
        load = np.einsum("nji,nj->ni", turn, torque) - np.cross(spin, spin @ inertia.T)
        return [force / mass + gravity, turn @ _crossed(spin), load @ inverse.T, force, torque]

    turn = rotation_matrix(ends.quaternion[0])
    state = [ends.velocity[0], turn, np.einsum("nji,nj->ni", turn, ends.spin[0]), np.zeros((many, 3)), np.zeros((many, 3))]
    first, spread = slopes(state, 0.0)[3:], np.zeros((many, 2))
    for k in range(count):
        state = _stepped(slopes, state, k / count, 1.0 / count, seconds)
        spread = np.maximum(spread, _apart(slopes(state, (k + 1) / count)[3:], first))
    return Given(state[3], state[4], seconds * spread)


def along(hull: Hull, mass: float, air: Air, ends: Ends, seconds: float) -> Given:
    """Impulse and twist that fields give to a body on the way that lies evenly between its motion at both ends: where joints or contacts lead it."""
    law, step = _Law(hull, air, mass), 1.0 / (POINTS - 1)
    forces, torques = [], []
    for share in np.linspace(0.0, 1.0, POINTS):
        turn = rotation_matrix(_mixed(ends.quaternion, float(share)))
        velocity, spin = ((1.0 - share) * v[0] + share * v[1] for v in (ends.velocity, ends.spin))
        force, torque = law.at(turn, velocity, spin, float(share))
        forces.append(force)
        torques.append(torque)
    weight = np.ones(POINTS) * 2.0
    weight[1::2], weight[0], weight[-1] = 4.0, 1.0, 1.0
    force, torque = np.array(forces), np.array(torques)
    sums = [seconds * step / 3.0 * np.einsum("p,pki->ki", weight, v) for v in (force, torque)]
    spread = np.stack([np.linalg.norm(v - v[0], axis=2).max(axis=0) for v in (force, torque)], axis=1)
    return Given(sums[0], sums[1], seconds * spread)


def _apart(one: list[F64], other: list[F64]) -> F64:
    return np.stack([np.linalg.norm(a - b, axis=1) for a, b in zip(one, other, strict=True)], axis=1)


def _stepped(
    slopes: Callable[[list[F64], float], list[F64]], state: list[F64], share: float, part: float, seconds: float
) -> list[F64]:
    """State a part of the interval later."""

    def moved(by: list[F64], much: float) -> list[F64]:
        return [a + much * part * seconds * b for a, b in zip(state, by, strict=True)]

    one = slopes(state, share)
    two = slopes(moved(one, 0.5), share + 0.5 * part)
    three = slopes(moved(two, 0.5), share + 0.5 * part)
    four = slopes(moved(three, 1.0), share + part)
    return moved([a + 2.0 * b + 2.0 * c + d for a, b, c, d in zip(one, two, three, four, strict=True)], 1.0 / 6.0)


def _substeps(hull: Hull, body: tuple[float, F64], air: Air, ends: Ends, seconds: float) -> int:
    """Steps within an interval that resolve how the body turns, is turned and is stopped."""
    (mass, inertia), past = body, np.linalg.norm(air.velocity[::2] - ends.velocity, axis=2).max(initial=0.0)
    pressure, least = float(air.pressure.max(initial=0.0)), float(np.linalg.eigvalsh(inertia)[0])
    length = hull.length + float(np.linalg.norm(hull.center))
    spin = float(np.linalg.norm(ends.spin, axis=2).max(initial=0.0))
    swing = past * math.sqrt(pressure * hull.surface * length / least)
    slows = 2.0 * pressure * past * max(hull.surface / mass, float(np.linalg.eigvalsh(hull.rolls)[-1]) / least)
    wanted = seconds * (spin + swing + slows) / TURN
    return int(min(max(math.ceil(wanted), 4), MOST))


def _crossed(spin: F64) -> Any:
    out = np.zeros((len(spin), 3, 3))
    out[:, 2, 1], out[:, 0, 2], out[:, 1, 0] = spin.T
    return out - np.swapaxes(out, 1, 2)


def _mixed(ends: F64, share: float) -> F64:
    """Orientations a share of the way from the first to the second, at an even spin."""
    one, two = ends
    cosine = (one * two).sum(axis=1)
    two, half = np.where(cosine[:, None] < 0.0, -two, two), np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    even = half < 1e-6
    sine = np.where(even, 1.0, np.sin(half))
    first = np.where(even, 1.0 - share, np.sin((1.0 - share) * half) / sine)
    second = np.where(even, share, np.sin(share * half) / sine)
    found: F64 = first[:, None] * one + second[:, None] * two
    return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])

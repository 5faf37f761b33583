"""Rigid motions between known states: a cubic for the centre, a turn at constant rate about a fixed axis.

Where nothing but gravity acts the cubic through both velocities is the true path of the centre of mass, and the turn is
that of a body whose rotation keeps its axis. Time s runs from 0 to 1 over each interval.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, quaternion_product, rotation_matrix

__all__ = ["Motion", "State", "points_travel", "relative_travel", "turned"]

STILL_TURN = 1e-9
"""[rad] A shorter rotation has no axis of its own; a whole number of turns takes the axis of the known spin."""


class State(NamedTuple):
    """States of one body at n moments."""

    position: F64
    """Body frame origin [m], shape (n, 3)."""
    quaternion: F64
    """Unit quaternions, shape (n, 4)."""
    velocity: F64 | None = None
    """Velocity of the centre [m/s], shape (n, 3); None where unknown."""
    spin: F64 | None = None
    """Angular velocity in world axes [rad/s], shape (n, 3); None where unknown."""


def turned(quaternion: F64, vector: F64) -> F64:
    """Orientations after a rotation by `vector` [rad, world axes], shapes (..., 4) and (..., 3)."""
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    # sin(a/2)/a tends to 1/2.
    share = 0.5 * np.sinc(angle / (2.0 * np.pi))
    return quaternion_product(np.concatenate([np.cos(0.5 * angle), share * vector], axis=-1), quaternion)


def _turn(first: F64, last: F64, expected: F64 | None) -> F64:
    """Rotation vectors [rad], shape (n, 3), from one orientation to the next: the short way, or the number of whole turns
    that comes nearest to the `expected` rotation."""
    delta = quaternion_product(last, first * np.array([1.0, -1.0, -1.0, -1.0]))
    delta = np.where(delta[:, :1] < 0.0, -delta, delta)
    sine = np.linalg.norm(delta[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(sine, delta[:, 0])
    axis = delta[:, 1:] / np.maximum(sine, np.finfo(float).tiny)[:, None]
    if expected is None:
        return np.asarray(angle[:, None] * axis)
    length = np.linalg.norm(expected, axis=1)
    free = angle < STILL_TURN
    axis = np.where(free[:, None], expected / np.maximum(length, np.finfo(float).tiny)[:, None], axis)
    along = np.einsum("ni,ni->n", expected, axis)
    whole = np.round((along - angle) / (2.0 * np.pi))
    return np.asarray((angle + 2.0 * np.pi * whole)[:, None] * axis)


@dataclass(frozen=True)
class Motion:
    """Motion of one body over n intervals."""

    control: F64
    """Bezier points of the centre in the world [m], shape (n, 4, 3)."""
    start: F64
    """Orientation at s = 0, shape (n, 4)."""
    turn: F64
    """Rotation vector over the interval, world axes [rad], shape (n, 3)."""
    center: F64
    """The centre in the body's frame [m], shape (3,)."""

    @classmethod
    def between(cls, first: State, last: State, center: F64, duration: float | F64) -> Motion:
        """Motion from each first state to its last one.

        Args:
            first: states at s = 0.
            last: states at s = 1.
            center: the point that `velocity` belongs to, in the body's frame [m], shape (3,).
            duration: of each interval [s], a number or shape (n,).
        """
        p0 = first.position + rotation_matrix(first.quaternion) @ center
        p1 = last.position + rotation_matrix(last.quaternion) @ center
        third = (p1 - p0) / 3.0
        time = np.broadcast_to(np.asarray(duration, dtype=np.float64), (len(p0),))[:, None]
        known = first.velocity is not None and last.velocity is not None
        out = time * first.velocity / 3.0 if known and first.velocity is not None else third
        into = time * last.velocity / 3.0 if known and last.velocity is not None else third
        expected = None
        if first.spin is not None and last.spin is not None:
            expected = 0.5 * time * (first.spin + last.spin)
        turn = _turn(first.quaternion, last.quaternion, expected)
        return cls(np.stack([p0, p0 + out, p1 - into, p1], axis=1), first.quaternion, turn, np.asarray(center))

    def __len__(self) -> int:
        return len(self.start)

    def take(self, rows: NDArray[np.intp]) -> Motion:
        """Some of the intervals."""
        return Motion(self.control[rows], self.start[rows], self.turn[rows], self.center)

    def centers(self, s: F64) -> F64:
        """The centre of each interval at its time s, shapes (n,) -> (n, 3)."""
        t = s[:, None]
        weights = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3], axis=1)
        return np.asarray((weights * self.control).sum(axis=1))

    def at(self, s: F64) -> tuple[F64, F64]:
        """Body frame of each interval at its time s, shape (n,): positions (n, 3) and quaternions (n, 4)."""
        quaternion = turned(self.start, s[:, None] * self.turn)
        return self.centers(s) - rotation_matrix(quaternion) @ self.center, quaternion

    def restrict(self, s: float, e: float) -> Motion:
        """The same motion from time s to time e of each interval, with its own time from 0 to 1."""
        points = self.control
        corners = ((s, s, s), (s, s, e), (s, e, e), (e, e, e))
        control = np.stack([_blossom(points, c) for c in corners], axis=1)
        return Motion(control, turned(self.start, s * self.turn), (e - s) * self.turn, self.center)

    def bent(self, offset: F64) -> Motion:
        """The same motion, displaced by `offset` [m], shape (n, 3), in the middle and not at its ends."""
        shape = np.array([0.0, 4.0 / 3.0, 4.0 / 3.0, 0.0])[None, :, None]
        return Motion(self.control + shape * offset[:, None], self.start, self.turn, self.center)

    def straight(self) -> Motion:
        """The centre along the chord at constant speed."""
        p0, p1 = self.control[:, 0], self.control[:, 3]
        step = (p1 - p0) / 3.0
        return Motion(np.stack([p0, p0 + step, p1 - step, p1], axis=1), self.start, self.turn, self.center)

    def sag(self, radius: float) -> F64:
        """Farthest that a point within `radius` of the centre strays from its own chord [m], shape (n,); an upper bound.

        Of the cubic: Bernstein weights 1 and 2 are at most 4/9 each, their sum at most 3/4. Of the turn: the height of
        an arc, at most the diameter.
        """
        chord = self.control[:, 3] - self.control[:, 0]
        off = [
            np.linalg.norm(self.control[:, k] - self.control[:, 0] - share * chord, axis=1)
            for k, share in ((1, 1 / 3), (2, 2 / 3))
        ]
        angle = np.linalg.norm(self.turn, axis=1)
        return np.asarray(0.75 * np.maximum(off[0], off[1]) + radius * np.minimum(angle * angle / 8.0, 2.0))


def _blossom(points: F64, times: Sequence[float | F64]) -> F64:
    """Polar form of Bezier curves, shape (n, k + 1, 3), at k times: symmetric and affine in each of them.

    A time is a number or one of each curve, shape (n, 1).
    """
    for t in times:
        share = t if isinstance(t, float) else t[:, None]
        points = (1.0 - share) * points[:, :-1] + share * points[:, 1:]
    return np.asarray(points[:, 0])


def points_travel(a: Motion, radius_a: float, b: Motion, radius_b: float, s: F64, e: F64) -> F64:
    """Upper bound of the way that points of two bodies can move against each other from s to e [m], shape (n,).

    The hodograph of the cubic lies in the hull of its Bezier points on [s, e]; a turn moves a point within `radius` of
    its centre by at most angle x radius.
    """
    rate = _rate(a, b, s[:, None], e[:, None])
    turns = radius_a * np.linalg.norm(a.turn, axis=1) + radius_b * np.linalg.norm(b.turn, axis=1)
    return np.asarray((np.linalg.norm(rate, axis=2).max(axis=1) + turns) * (e - s))


def _rate(a: Motion, b: Motion, s: F64, e: F64) -> F64:
    """Bezier points on [s, e] of the velocity of b's centre against a's [m], shape (n, 3, 3); times of shape (n, 1)."""
    d = 3.0 * np.diff(b.control - a.control, axis=1)
    return np.stack([_blossom(d, t) for t in ((s, s), (s, e), (e, e))], axis=1)


def relative_travel(a: Motion, radius_a: float, b: Motion, radius_b: float, s: F64, e: F64) -> F64:
    """Upper bound of the way that the surfaces of two bodies can move against each other from s to e [m], shape (n,).

    A clearance or depth between a point of one and a point of the other changes as fast as the one body moves past the
    other at either point, along the line through both. With centres c, turns w and u = c_b - c_a that speed is at most

    - |u'| + r_a |w_a| + r_b |w_b|, as in `points_travel`, whatever they do;
    - |u' - w_a x u| + r_b |w_b - w_a| at the point of b, and |u' - w_b x u| + r_a |w_b - w_a| at that of a: nothing for
      bodies that turn together.

    Each first term is a polynomial in time, which lies in the hull of its Bezier points on [s, e].
    """
    way, s_, e_ = b.control - a.control, s[:, None], e[:, None]
    rate = _rate(a, b, s_, e_)
    place = np.stack([_blossom(way, t) for t in ((s_, s_, s_), (s_, s_, e_), (s_, e_, e_), (e_, e_, e_))], axis=1)
    # The rate as a cubic, as the place is one.
    raised = np.stack(
        [rate[:, 0], (rate[:, 0] + 2.0 * rate[:, 1]) / 3.0, (2.0 * rate[:, 1] + rate[:, 2]) / 3.0, rate[:, 2]], axis=1
    )
    apart = np.linalg.norm(b.turn - a.turn, axis=1)
    found = points_travel(a, radius_a, b, radius_b, s, e)
    for turn, radius in ((a.turn, radius_b), (b.turn, radius_a)):
        past = np.linalg.norm(raised - np.cross(turn[:, None], place), axis=2).max(axis=1)
        found = np.minimum(found, (past + radius * apart) * (e - s))
    return np.asarray(found)

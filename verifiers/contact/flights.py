"""Paths of bodies between written frames, and what the contact log says about those intervals."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry import Motion, State
from ...worlds.arrays import F64, rotation_matrix
from ...worlds.errors import EvidenceError
from .bounds import JOIN

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["ContactLog", "Flight", "reconstructed"]


class ContactLog:
    """Contacts and events of all caches, by frame."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate

    @cached_property
    def _gaps(self) -> dict[tuple[str, str, int], float]:
        """Smallest distance of collision shapes of a pair over the steps of a frame [m]."""
        found: dict[tuple[str, str, int], float] = {}
        for names, frame, log in self._logs("contact/pair", "contact/min_gap"):
            for (i, j), gap in zip(log["contact/pair"], log["contact/min_gap"], strict=True):
                for key in ((names[i], names[j], frame), (names[j], names[i], frame)):
                    found[key] = min(float(gap), found.get(key, np.inf))
        return found

    def _logs(self, *channels: str) -> Iterator[tuple[Sequence[str], int, Mapping[str, Any]]]:
        """Names of colliders, frame and ragged channels of every frame of the rigid instances that record them."""
        for cache in self.candidate.rigid_caches.values():
            try:
                frames = cache.ragged(*channels)
            except EvidenceError:
                continue
            yield from ((cache.index.colliders, frame, log) for frame, log in enumerate(frames))

    def pushed(self) -> dict[tuple[str, str], list[int]]:
        """Frames up to which a pair of two entities gave each other an impulse, the pair in the order of the alphabet."""
        found: dict[tuple[str, str], list[int]] = {}
        for cache in self.candidate.rigid_caches.values():
            names = cache.index.colliders
            for frame, log in enumerate(cache.ragged("contact/pair", "contact/impulse")[: self.candidate.frame_count]):
                for (i, j), given in zip(log["contact/pair"], log["contact/impulse"], strict=True):
                    if frame > 0 and given > 0.0 and i != j:
                        first, second = sorted((names[i], names[j]))
                        found.setdefault((first, second), []).append(frame)
        return found

    @cached_property
    def _events(self) -> dict[tuple[str, int], list[float]]:
        """Times [s] at which a contact of an entity begins in a frame."""
        found: dict[tuple[str, int], list[float]] = {}
        for names, frame, log in self._logs("event/time", "event/pair"):
            for time, pair in zip(log["event/time"], log["event/pair"], strict=True):
                for k in {int(p) for p in pair}:
                    found.setdefault((names[k], frame), []).append(float(time))
        return found

    def gap(self, a: str, b: str, frame: int) -> float | None:
        """Smallest distance of the collision shapes over the steps up to `frame` [m]; None where they did not touch."""
        return self._gaps.get((a, b, frame))

    def times(self, entity: str, frame: int, step: float) -> list[float]:
        """Moments within the interval that ends at `frame`, in 0..1, at which a contact of the entity begins."""
        start = (frame - 1) * step
        return sorted(min(1.0, max(0.0, (t - start) / step)) for t in self._events.get((entity, frame), []))


@dataclass(frozen=True)
class Flight:
    """Motion of one body over all intervals between frames."""

    states: State
    motion: Motion
    step: float
    """Length of an interval [s]."""
    gravity: F64
    """[m/s^2]; zero for bodies that do not fall."""

    @classmethod
    def of(cls, states: State, center: F64, step: float, gravity: F64) -> Flight:
        """From the states at all frames."""
        first, last = (State(*(None if x is None else x[s] for x in states)) for s in (slice(None, -1), slice(1, None)))  # type: ignore[arg-type]
        return cls(states, Motion.between(first, last, center, step), step, gravity)

    def slack(self, radius: float) -> F64:
        """Distance that a point within `radius` may stray from the cubic because of forces other than gravity [m], shape (n,).

        A quarter of the change of velocity times the interval is the farthest that a path with one bend in its middle
        leaves the straight one. Without velocities nothing is known but the ends, and the cubic is the chord.
        """
        velocity, spin = self.states.velocity, self.states.spin
        if velocity is None or spin is None:
            return np.zeros(len(self.motion))
        bend = np.linalg.norm(np.diff(velocity, axis=0) - self.step * self.gravity, axis=1)
        twist = np.linalg.norm(np.diff(spin, axis=0), axis=1)
        return np.asarray(0.25 * self.step * (bend + radius * twist))

    def _pose(self, interval: int, s: float, *, forward: bool) -> _Pose | None:
        """Free flight from the interval's first state, or back from its last one; None where velocities are unknown."""
        velocity, spin = self.states.velocity, self.states.spin
        if velocity is None or spin is None:
            return None
        frame = interval if forward else interval + 1
        time = (s if forward else s - 1.0) * self.step
        turn = rotation_matrix(self.states.quaternion[frame])
        center = self.states.position[frame] + turn @ self.motion.center + time * velocity[frame] + 0.5 * time**2 * self.gravity
        quaternion = _turned(self.states.quaternion[frame], time * spin[frame])
        return _Pose(center, quaternion, velocity[frame] + time * self.gravity, spin[frame])

    def pieces(self, interval: int, own: list[float], cuts: list[float]) -> list[Motion]:
        """The motion of one interval cut at the times `cuts` (0 and 1 included).

        With contacts at the times `own`: free flight until the first, free flight after the last, straight in between.
        """
        whole = self.motion.take(np.array([interval]))
        known = [self._pose(interval, t, forward=f) for t, f in ((own[0], True), (own[-1], False))] if own else [None]
        if any(p is None for p in known):
            return [whole.restrict(s, e) for s, e in itertools.pairwise(cuts)]
        result = []
        for s, e in itertools.pairwise(cuts):
            middle = 0.5 * (s + e)
            if middle < own[0] or middle > own[-1]:
                forward = middle < own[0]
                ends = [self._pose(interval, t, forward=forward) for t in (s, e)]
                result.append(_between(ends[0], ends[1], self.motion.center, (e - s) * self.step, free=True))
            else:
                inner = [self._middle(known[0], known[1], own, t) for t in (s, e)]
                result.append(_between(inner[0], inner[1], self.motion.center, (e - s) * self.step, free=False))
        return result

    def _middle(self, first: _Pose | None, last: _Pose | None, own: list[float], time: float) -> _Pose:
        assert first is not None
        assert last is not None
        share = (time - own[0]) / max(own[-1] - own[0], 1e-12)
        motion = _between(first, last, self.motion.center, 1.0, free=False)
        position, quaternion = motion.at(np.array([share]))
        center = position[0] + rotation_matrix(quaternion[0]) @ self.motion.center
        return _Pose(center, quaternion[0], first.velocity, first.spin)


class _Pose(NamedTuple):
    center: F64
    quaternion: F64
    velocity: F64
    spin: F64


def _turned(quaternion: F64, vector: F64) -> F64:
    still = np.zeros((1, 3))
    return np.asarray(Motion(np.zeros((1, 4, 3)), quaternion[None], vector[None], still[0]).at(np.ones(1))[1][0])


def _between(first: _Pose | None, last: _Pose | None, center: F64, duration: float, *, free: bool) -> Motion:
    assert first is not None
    assert last is not None
    states = []
    for p in (first, last):
        position = p.center - rotation_matrix(p.quaternion) @ center
        extra = (p.velocity[None], p.spin[None]) if free else (None, None)
        states.append(State(position[None], p.quaternion[None], *extra))
    return Motion.between(states[0], states[1], center, duration)


def reconstructed(a: Flight, times_a: list[float], b: Flight, times_b: list[float], interval: int) -> list[tuple[Motion, Motion]]:
    """Motions of two bodies in one interval, in pieces, from free flight up to and after their logged contacts."""
    # The two flights need not meet at a single contact: a short straight piece joins them, so that nothing is skipped.
    times_a, times_b = ([max(0.0, t[0] - JOIN), min(1.0, t[-1] + JOIN)] if t else [] for t in (times_a, times_b))
    cuts = sorted({0.0, 1.0, *times_a[:1], *times_a[-1:], *times_b[:1], *times_b[-1:]})
    return list(zip(a.pieces(interval, times_a, cuts), b.pieces(interval, times_b, cuts), strict=True))

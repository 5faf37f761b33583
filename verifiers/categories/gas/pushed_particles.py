"""Impulses that a gas gives to grains and flying particles that it carries, worked out anew from its cells and from where these are (R65, R66, R105).

What flies alone is taken on from each frame to the next by the law of spheres; grains, which others push too, along the way that they went.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ....physics.substances import air_viscosity
from ....worlds.arrays import F64
from .stream import Given, Stream, pull_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate

__all__ = ["on_particles"]

PARTS = 12
"""Parts of a frame."""


class _Swarm(NamedTuple):
    """Particles at a frame."""

    place: F64
    velocity: F64
    radius: F64
    mass: F64
    member: Any
    identity: Any

    def rows(self, rows: Any) -> _Swarm:
        """Some of them."""
        return _Swarm(*(a[rows] for a in self))


def on_particles(stream: Stream, candidate: Candidate, other: str) -> Given:
    """Impulses on all particles of an instance; `doubt` is of those that come or go between two frames."""
    names = tuple(candidate.spec.simulation.solvers[other].members)
    frames, h = stream.box.frames, stream.box.duration
    flies = candidate.spec.simulation.solvers[other].engine == "ballistic"
    pull = {n: pull_of(candidate, n) for n in names}
    at_once = np.zeros((frames - 1, 3))
    given, shares = np.zeros((frames - 1, 3)), {n: np.zeros((frames - 1, 3)) for n in names}
    doubt, judged, inside = np.zeros(frames - 1), np.zeros(frames - 1, dtype=bool), np.zeros(frames - 1, dtype=bool)
    before = _read(candidate, other, names, 0)
    for k in range(frames - 1):
        now = _read(candidate, other, names, k + 1)
        _, here, there = np.intersect1d(before.identity, now.identity, return_indices=True)
        moves = (before.velocity[here] != 0.0).any(axis=1) | (now.velocity[there] != 0.0).any(axis=1)
        a, b = before.rows(here[moves]), now.rows(there[moves])
        inside[k] = all(stream.within(s.place, f).all() for s, f in ((before, k), (now, k + 1)))
        judged[k] = bool(len(a.place)) and inside[k]
        for row, name in enumerate(names):
            own = a.member == row
            if own.any():
                gravity = pull[name](a.place[own], k * h)
                force = _flown if flies else _along
                shares[name][k] = force(stream, a.rows(own), b.rows(own), gravity, k).sum(axis=0)
        at_once[k] = stream.at_once(partial(_in_middle, stream, a, b, k))
        for swarm, kept, frame in ((before, here, k), (now, there, k + 1)):
            alone = swarm.rows(np.setdiff1d(np.arange(len(swarm.mass)), kept))
            if len(alone.mass) and judged[k]:
                rate, velocity = _rate(stream, alone, alone.place, alone.velocity, (frame, 0.0))
                doubt[k] += h * float((alone.mass * rate * np.linalg.norm(velocity - alone.velocity, axis=1)).sum())
        told = candidate.particle_caches[other].read(k + 1, ("field/impulse",))["field/impulse"]
        given[k] = np.asarray(told, dtype=np.float64).sum(axis=0)
        given[k] -= sum((a.mass[a.member == r] @ _extra(candidate, pull[n], a.place[a.member == r], k, h) for r, n in enumerate(names)), np.zeros(3))  # fmt: skip
        before = now
    return Given(names, given, sum(shares.values(), np.zeros((frames - 1, 3))), shares, judged, inside, doubt, at_once)


def _read(candidate: Candidate, other: str, names: tuple[str, ...], frame: int) -> _Swarm:
    channels = ("origin", *(f"particle/{n}" for n in ("position", "velocity", "id", "member", "radius")))
    data = candidate.particle_caches[other].read(frame, channels)
    radius, member = data["particle/radius"].astype(np.float64), data["particle/member"]
    density = np.array([candidate.spec.materials[candidate.spec.entities[n].material].density for n in names])
    mass = 4.0 / 3.0 * np.pi * density[member] * radius**3
    place = data["origin"] + data["particle/position"].astype(np.float64)
    return _Swarm(place, data["particle/velocity"].astype(np.float64), radius, mass, member, data["particle/id"])


def _rate(stream: Stream, swarm: _Swarm, place: F64, velocity: F64, when: tuple[int, float]) -> tuple[F64, F64]:
    """Rate at which the gas takes the velocity past spheres [1/s], by their drag coefficient over the Reynolds number; and its velocity."""
    flow, density = stream.at(place, *when)
    past = np.maximum(np.linalg.norm(flow - velocity, axis=1), 1e-12)
    number = density * past * 2.0 * swarm.radius / air_viscosity(stream.warmth(place, *when))
    coefficient = np.where(number > 1000.0, 0.44, 24.0 / np.maximum(number, 1e-12) * (1.0 + 0.15 * number**0.687))
    return 0.5 * density * coefficient * np.pi * swarm.radius**2 * past / swarm.mass, flow


def _flown(stream: Stream, a: _Swarm, b: _Swarm, gravity: F64, frame: int) -> F64:
    """Impulses on particles that fly on from a frame by the law, (n, 3)."""
    place, velocity, given = a.place.copy(), a.velocity.copy(), np.zeros_like(a.place)
    h = stream.box.duration / PARTS
    for part in range(PARTS):
        when = (frame, (part + 0.5) / PARTS)
        rate, flow = _rate(stream, a, place + 0.5 * h * velocity, velocity, when)
        # Exact for a steady rate: the speed past the flow decays to that with which gravity is borne.
        end = flow + gravity / rate[:, None]
        later = end + (velocity - end) * np.exp(-rate * h)[:, None]
        given += a.mass[:, None] * (later - velocity - h * gravity)
        place += 0.5 * h * (velocity + later)
        velocity = later
    return given


def _along(stream: Stream, a: _Swarm, b: _Swarm, gravity: F64, frame: int) -> F64:
    """Impulses on grains along the way between their places at two frames, (n, 3)."""
    given = np.zeros_like(a.place)
    for part in range(PARTS):
        share = (part + 0.5) / PARTS
        place, velocity = a.place + share * (b.place - a.place), a.velocity + share * (b.velocity - a.velocity)
        rate, flow = _rate(stream, a, place, velocity, (frame, share))
        given += (a.mass * rate)[:, None] * (flow - velocity) * (stream.box.duration / PARTS)
    return given


def _in_middle(stream: Stream, a: _Swarm, b: _Swarm, frame: int, share: float) -> F64:
    """Force on particles in the middle of their way between two frames, in the gas as it is a share of the way between them [N], (3,)."""
    place, velocity = 0.5 * (a.place + b.place), 0.5 * (a.velocity + b.velocity)
    rate, flow = _rate(stream, a, place, velocity, (frame, share))
    return np.asarray(((a.mass * rate)[:, None] * (flow - velocity)).sum(axis=0))


def _extra(candidate: Candidate, pull: Any, place: F64, frame: int, h: float) -> F64:
    """Velocity that fields without a medium gave over a frame [m/s], (n, 3)."""
    return np.asarray(h * (pull(place, frame * h) - np.array(candidate.spec.simulation.gravity)))

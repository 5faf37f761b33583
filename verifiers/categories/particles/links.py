"""Grains in causal chains: how they move as wholes, and whom they push (R96, R97). Flying particles push nobody."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...ledgers.exchanged import CHANNEL
from .frames import swarm_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate

__all__ = ["RUNNING", "grain_motion", "grain_pushes", "running"]

RUNNING = 0.01
"""[m/s] Root mean square speed from which on particles are not still. Own choice: a bed at rest creeps by a tenth of it."""


def grain_motion(candidate: Candidate, entity: str) -> tuple[F64, F64]:
    """Root mean square speed [m/s] and size of the momentum [N s] at every frame, each shape (frames,); 0 where none is there.

    Raises:
        EvidenceError: no cache holds these particles.
    """
    for solver, cache in candidate.particle_caches.items():
        if entity in cache.index.bodies:
            row = cache.index.bodies.index(entity)
            return candidate.memo(("motion", entity), partial(_motion, candidate, solver, row))
    raise EvidenceError(f"no cache holds the particles {entity!r}; list them as a member of a particle instance and probe")


def _motion(candidate: Candidate, solver: str, row: int) -> tuple[F64, F64]:
    swarm = swarm_of(candidate, solver)
    speed, momentum = np.zeros((2, candidate.frame_count))
    for k in range(swarm.frames):
        frame = swarm.read(k)
        own = frame.member == row
        if own.any():
            mass, velocity = frame.mass[own], frame.velocity[own]
            speed[k] = np.sqrt(mass @ (velocity**2).sum(axis=1) / mass.sum())
            momentum[k] = np.linalg.norm(mass @ velocity)
    return speed, momentum


def running(candidate: Candidate, entity: str) -> NDArray[np.bool_]:
    """Whether the particles are not still, shape (frames,)."""
    moving: NDArray[np.bool_] = ~(grain_motion(candidate, entity)[0] <= RUNNING)
    return moving


def grain_pushes(candidate: Candidate) -> list[list[tuple[str, str, float]]]:
    """Per frame, grains, entity and the impulse between them [N s]. Members of one instance share it by their masses."""
    found: list[list[tuple[str, str, float]]] = [[] for _ in range(candidate.frame_count)]
    for solver, cache in candidate.particle_caches.items():
        if candidate.spec.simulation.particles[solver].engine != "dem" or not cache.index.colliders:
            continue
        swarm = swarm_of(candidate, solver)
        sizes: F64 = np.linalg.norm(np.asarray(cache.series(CHANNEL), dtype=np.float64)[: swarm.frames, :, :3], axis=2)
        for frame in np.flatnonzero(sizes.any(axis=1)).tolist():
            now = swarm.read(frame)
            share = np.bincount(now.member, now.mass, minlength=len(swarm.members)) / max(float(now.mass.sum()), 1e-30)
            found[frame] += [
                (member, cache.index.colliders[row].split("/", 1)[0], float(sizes[frame, row] * part))
                for row in np.flatnonzero(sizes[frame]).tolist()
                for member, part in zip(swarm.members, share.tolist(), strict=True)
                if part > 0.0
            ]
    return found

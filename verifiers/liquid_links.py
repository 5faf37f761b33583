"""Liquids in causal chains: how they move as wholes, and whom they push (R96, R97)."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64
from ..worlds.errors import EvidenceError
from .exchanged import CHANNEL

if TYPE_CHECKING:
    from ..worlds.cache import Cache
    from ..worlds.candidate import Candidate

__all__ = ["STIRRED", "liquid_cache", "liquid_motion", "liquid_pushes", "stirred"]

STIRRED = 0.02
"""[m/s] Root mean square speed from which on a liquid is not still. Own choice: above the noise of particles at rest."""


_MOTIONS: weakref.WeakKeyDictionary[Cache, dict[tuple[str, int], tuple[F64, F64]]] = weakref.WeakKeyDictionary()


def liquid_cache(candidate: Candidate, liquid: str) -> tuple[Cache, int]:
    """Cache that holds a liquid entity, and its row in the index.

    Raises:
        EvidenceError: none does.
    """
    for cache in candidate.liquid_caches.values():
        if liquid in cache.index.bodies:
            return cache, cache.index.bodies.index(liquid)
    raise EvidenceError(f"no cache holds the liquid {liquid!r}; list it as a member of a liquid instance and bake")


def liquid_motion(candidate: Candidate, liquid: str) -> tuple[F64, F64]:
    """Root mean square speed [m/s] and size of the momentum [N s] at every frame, each shape (frames,); 0 where none is there."""
    cache, row = liquid_cache(candidate, liquid)
    known = _MOTIONS.setdefault(cache, {})
    if (liquid, candidate.frame_count) in known:
        return known[liquid, candidate.frame_count]
    density = candidate.spec.materials[candidate.spec.entities[liquid].material].density
    speed, momentum = np.zeros((2, candidate.frame_count))
    for k, found in enumerate(cache.ragged("particle/velocity", "particle/volume", "particle/fluid")[: candidate.frame_count]):
        own = found["particle/fluid"] == row
        velocity, mass = (
            found["particle/velocity"][own].astype(np.float64),
            density * found["particle/volume"][own].astype(np.float64),
        )
        if own.any():
            speed[k] = np.sqrt(mass @ np.sum(velocity**2, axis=1) / mass.sum())
            momentum[k] = np.linalg.norm(mass @ velocity)
    known[liquid, candidate.frame_count] = speed, momentum
    return speed, momentum


def stirred(candidate: Candidate, liquid: str) -> NDArray[np.bool_]:
    """Whether the liquid is not still, shape (frames,)."""
    moving: NDArray[np.bool_] = ~(liquid_motion(candidate, liquid)[0] <= STIRRED)
    return moving


def liquid_pushes(candidate: Candidate) -> list[list[tuple[str, str, float]]]:
    """Per frame, liquid, entity and the impulse between them [N s].

    Several liquids of one instance share its boundaries: each counts as giving all of it.
    """
    found: list[list[tuple[str, str, float]]] = [[] for _ in range(candidate.frame_count)]
    for cache in candidate.liquid_caches.values():
        owners = [name.split("/", 1)[0] for name in cache.index.colliders]
        if not owners:
            continue
        sizes: F64 = np.linalg.norm(np.asarray(cache.series(CHANNEL), dtype=np.float64)[: candidate.frame_count, :, :3], axis=2)
        for frame, row in np.argwhere(sizes > 0.0).tolist():
            found[frame] += [(liquid, owners[row], float(sizes[frame, row])) for liquid in cache.index.bodies]
    return found

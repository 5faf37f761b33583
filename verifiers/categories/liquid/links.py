"""Liquids in causal chains: how they move as wholes, and whom they push (R96, R97)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.categories.liquid.facts import spacing_of
from ....worlds.errors import EvidenceError
from ...ledgers.exchanged import CHANNEL
from .solids import pieces_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["STIRRED", "liquid_cache", "liquid_motion", "liquid_pushes", "stirred"]

STIRRED = 0.02
"""[m/s] Root mean square speed from which on a liquid is not still. Own choice: above the noise of particles at rest."""

REACH = 1.25
"""[spacings] Particles this near to a solid touch it: those at rest beside it stand half a spacing off, the next ones one and a half."""
SOME = 4000
"""About how many of the particles beside a part are asked."""


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
    return candidate.memo(("motion", liquid), lambda: _motion(candidate, liquid))


def _motion(candidate: Candidate, liquid: str) -> tuple[F64, F64]:
    cache, row = liquid_cache(candidate, liquid)
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
    return speed, momentum


def stirred(candidate: Candidate, liquid: str) -> NDArray[np.bool_]:
    """Whether the liquid is not still, shape (frames,)."""
    moving: NDArray[np.bool_] = ~(liquid_motion(candidate, liquid)[0] <= STIRRED)
    return moving


def liquid_pushes(candidate: Candidate) -> list[list[tuple[str, str, float]]]:
    """Per frame, liquid, entity and the impulse between them [N s].

    Several liquids of one instance share its boundaries: those that touch one share what it gave by how many of their particles do.
    """
    found: list[list[tuple[str, str, float]]] = [[] for _ in range(candidate.frame_count)]
    for solver, cache in candidate.liquid_caches.items():
        if not cache.index.colliders:
            continue
        sizes: F64 = np.linalg.norm(np.asarray(cache.series(CHANNEL), dtype=np.float64)[: candidate.frame_count, :, :3], axis=2)
        for frame in np.unique(np.argwhere(sizes > 0.0)[:, 0]).tolist():
            rows = np.flatnonzero(sizes[frame] > 0.0).tolist()
            for row, share in zip(rows, _shares(candidate, solver, cache, frame, rows), strict=True):
                owner = cache.index.colliders[row].split("/", 1)[0]
                found[frame] += [
                    (liquid, owner, float(sizes[frame, row] * part))
                    for liquid, part in zip(cache.index.bodies, share, strict=True)
                    if part > 0.0
                ]
    return found


def _shares(candidate: Candidate, solver: str, cache: Cache, frame: int, rows: list[int]) -> list[list[float]]:
    """Of each boundary's particles within reach, the share of every liquid; where none is seen there, all alike."""
    from ....geometry import distance_to_surface

    count = len(cache.index.bodies)
    if count == 1:
        return [[1.0]] * len(rows)
    held = cache.read(frame, ("origin", "particle/position", "particle/fluid"))
    position = held["particle/position"].astype(np.float64) + held["origin"]
    reach = REACH * spacing_of(candidate.spec, solver)
    shares = []
    for row in rows:
        near = np.zeros(len(position), dtype=bool)
        for piece in pieces_of(candidate):
            if f"{piece.entity}/{piece.body}" != cache.index.colliders[row]:
                continue
            low, high = piece.box(frame)
            some = np.flatnonzero(((position >= low - reach) & (position <= high + reach)).all(axis=1) & ~near)
            some = some[:: -(-len(some) // SOME) or 1]
            gap = distance_to_surface(piece.solid, piece.local(position[some], frame)).distance if len(some) else np.zeros(0)
            near[some[gap <= reach]] = True
        seen = np.bincount(held["particle/fluid"][near], minlength=count)[:count]
        shares.append((seen / seen.sum()).tolist() if seen.any() else [1.0 / count] * count)
    return shares

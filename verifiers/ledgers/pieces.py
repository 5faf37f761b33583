"""Pieces of what breaks, by the log of its bonds: as long as they hang together, they move as one body."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.bonds import WORLD
from ...worlds.errors import EvidenceError

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["whole_frames"]


def whole_frames(candidate: Candidate, entity: str) -> NDArray[np.bool_]:
    """True at the frames at which all pieces of a breakable entity are bonded to one another still, shape (F,).

    Raises:
        EvidenceError: no cache tells of its bonds.
    """
    return candidate.memo(("whole", entity), lambda: _whole_frames(candidate, entity))


def _whole_frames(candidate: Candidate, entity: str) -> NDArray[np.bool_]:
    built = candidate.entity(entity)
    bonds, count = built.bonds, len(built.bodies)
    assert bonds is not None
    cache = next((c for c in candidate.rigid_caches.values() if entity in c.index.breakables), None)
    if cache is None:
        raise EvidenceError(f"no cache tells of the bonds of {entity!r}; probe or bake it")
    others = [candidate.entity(n).bonds for n in cache.index.breakables[: cache.index.breakables.index(entity)]]
    first = sum(len(b) for b in others if b is not None)
    broken = np.asarray(cache.series("bond/broken"))[: candidate.frame_count, first : first + len(bonds)].astype(bool)
    pairs = np.where(bonds.pieces == WORLD, count, bonds.pieces)
    states, state = np.unique(broken, axis=0, return_inverse=True)
    one: NDArray[np.bool_] = np.array([_hang_together(pairs[~s], count) for s in states], dtype=bool)[state.reshape(-1)]
    return one


def _hang_together(pairs: NDArray[np.int32], count: int) -> bool:
    """True if bonds join all pieces 0..count-1; the world is piece `count`, to which none has to be bonded."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count + 1, count + 1))
    label = connected_components(graph, directed=False)[1]
    return bool((label[:count] == label[0]).all())

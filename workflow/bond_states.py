"""Bonds of a body that may break, for the state of an entity: how many are broken, and how near to breaking the others came."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..worlds.arrays import F64
    from ..worlds.candidate import Candidate

__all__ = ["bonds_at", "bonds_over"]

BROKEN, STRESS = "bond/broken", "bond/stress"
"""Channels of the cache of rigid instances."""


def bonds_at(candidate: Candidate, name: str, frame: int) -> dict[str, Any]:
    """Broken bonds at a frame, and the largest stress over strength up to it and when; nothing of what has no bonds."""
    read = _read(candidate, name, 0, frame)
    if read is None:
        return {}
    broken, stress = read
    worst = int(np.argmax(stress))
    return {"bonds": {"broken": int(broken[-1]), "largest_load": _share(stress[worst]), "at_frame": worst}}


def bonds_over(candidate: Candidate, name: str, chosen: Sequence[int]) -> dict[str, Any]:
    """The same at chosen frames: each load is the largest since the frame before, as share of the strength."""
    read = _read(candidate, name, chosen[0], chosen[-1])
    if read is None:
        return {}
    broken, stress = read
    at = [k - chosen[0] for k in chosen]
    loads = [float(stress[(at[i - 1] + 1 if i else 0) : k + 1].max()) for i, k in enumerate(at)]
    worst = int(np.argmax(stress))
    return {
        "bonds": {
            "broken": [int(broken[k]) for k in at],
            "load": [_share(v) for v in loads],
            "largest_load": _share(stress[worst]),
            "at_frame": chosen[0] + worst,
        }
    }


def _share(value: float) -> float:
    return float(f"{float(value):.4g}")


def _read(candidate: Candidate, name: str, first: int, last: int) -> tuple[F64, F64] | None:
    """Number of broken bonds and largest stress over strength per frame from `first` to `last`, shape (n,) each; None where none are kept."""
    for cache in candidate.rigid_caches.values():
        if name not in cache.index.breakables:
            continue
        before = cache.index.breakables[: cache.index.breakables.index(name)]
        counts = [len(b) for n in (*before, name) if (b := candidate.entity(n).bonds) is not None]
        start, end = sum(counts[:-1]), sum(counts)
        frames = cache.ragged(BROKEN, STRESS)[first : last + 1]
        if not counts or any(len(f[STRESS]) < end for f in frames):
            return None
        rows = [(float(np.sum(f[BROKEN][start:end])), float(np.max(f[STRESS][start:end], initial=0.0))) for f in frames]
        found = np.array(rows, dtype=np.float64).reshape(-1, 2)
        return found[:, 0], found[:, 1]
    return None

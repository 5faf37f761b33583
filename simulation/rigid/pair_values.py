"""Values of contacts by their sides: what the sides give together, or what a pair of colliders has of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["PairValues"]


class PairValues:
    """Own values of pairs of colliders.

    Args:
        colliders: collider per side of a contact (geoms, then elastic bodies), shape (sides,).
        pairs: value of each pair of colliders that has one of its own.
    """

    def __init__(self, colliders: Any, pairs: Mapping[tuple[int, int], float]) -> None:
        self._colliders = colliders
        self._count = int(colliders.max(initial=0)) + 1
        table = sorted((min(p) * self._count + max(p), value) for p, value in pairs.items())
        self._keys = np.array([k for k, _ in table], dtype=np.int64)
        self._values = np.array([value for _, value in table])

    def over(self, given: F64, sides: Any) -> F64:
        """Values of contacts between sides, shape (n, 2) -> (n,): those `given` by the sides, or a pair's own."""
        if not len(self._keys):
            return given
        of = self._colliders[sides]
        key = of.min(axis=1) * self._count + of.max(axis=1)
        place = np.minimum(np.searchsorted(self._keys, key), len(self._keys) - 1)
        return np.where(self._keys[place] == key, self._values[place], given)

"""Links of one frame along which a chain may go from entity to entity."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64

__all__ = ["Links", "both_ways"]


class Links(NamedTuple):
    """Directed links of one frame."""

    sender: NDArray[np.intp]
    receiver: NDArray[np.intp]
    begin: F64
    end: F64
    """A sender that was reached after `end` [s] passes nothing on here."""
    impulse: F64
    """[N s]; infinite through a joint."""


def both_ways(found: list[tuple[int, int, float, float, float]]) -> Links:
    """Links from (a, b, begin, end, impulse), each in both directions."""
    table = np.array(found, dtype=np.float64).reshape(-1, 5)
    a, b = table[:, 0].astype(np.intp), table[:, 1].astype(np.intp)
    begin, end, impulse = (np.tile(table[:, k], 2) for k in (2, 3, 4))
    return Links(np.concatenate([a, b]), np.concatenate([b, a]), begin, end, impulse)

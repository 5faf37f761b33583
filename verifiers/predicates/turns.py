"""Turning points of a path along one axis, for kinds of event that go to and fro."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64

__all__ = ["turning_points"]


def turning_points(path: F64, least: float) -> F64:
    """Number of turning points up to each frame, of those that are at least so far [m] from the one before."""
    found, extreme, way, count = np.zeros(len(path)), path[0], 0, 0
    for k, x in enumerate(path.tolist()):
        if way == 0:
            if abs(x - path[0]) >= least:
                way, extreme = (1 if x > path[0] else -1), x
        elif way * (x - extreme) >= 0.0:
            extreme = x
        elif way * (extreme - x) >= least:
            way, extreme, count = -way, x, count + 1
        found[k] = count
    return found

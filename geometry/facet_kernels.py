"""Bounds of how deep facets of one convex solid may lie inside another. Compiled by numba, kept on disk."""

import numpy as np
from numba import njit

__all__ = ["facet_bounds"]


@njit(cache=True, nogil=True)
def facet_bounds(slack, starts, corners):
    """Least over the planes of the greatest slack of a facet's corners, shape (poses, facets).

    Args:
        slack: of vertices below planes, shape (poses, planes, vertices).
        starts: where the corners of each facet begin in `corners`, and their number, shape (facets + 1,).
        corners: vertices of all facets, one facet after the other.
    """
    poses, planes, _ = slack.shape
    out = np.empty((poses, len(starts) - 1))
    for p in range(poses):
        for i in range(len(starts) - 1):
            least = np.inf
            for j in range(planes):
                most = -np.inf
                for c in range(starts[i], starts[i + 1]):
                    value = slack[p, j, corners[c]]
                    if value > most:
                        most = value
                        if most >= least:
                            break
                if most < least:
                    least = most
            out[p, i] = least
    return out

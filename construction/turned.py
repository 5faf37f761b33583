"""Convex pieces of solids of revolution: stacked discs and cones where the outline goes up from the axis to the axis, an exact decomposition."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

__all__ = ["stacked_pieces"]

LEVEL = 1e-9
"""[m] Levels closer than this are one."""
STRAIGHT = 1e-12
"""[m^2] Cross product of two edges of an outline that are one line."""

Outline = Sequence[tuple[float, float]]
"""(r, z) [m]"""


def stacked_pieces(profile: Outline, on_axis: Sequence[bool]) -> list[list[int]]:
    """Vertices of the outline by piece, from below, each of which revolves into a convex body; empty where the solid is no such stack.

    A piece goes on upwards as long as the outline turns towards the axis. Pieces meet in level discs, so that together they are the solid.

    Args:
        profile: counter-clockwise.
        on_axis: of each vertex, whether it lies on the axis.
    """
    chain = _outer_chain(on_axis)
    if not chain:
        return []
    points = [profile[k] for k in chain]
    if any(above[1] < below[1] - LEVEL for below, above in itertools.pairwise(points)):
        return []  # it overhangs
    pieces, start = [], 0
    for k in range(1, len(chain) - 1):
        (r0, z0), (r1, z1), (r2, z2) = points[k - 1 : k + 2]
        if (r1 - r0) * (z2 - z1) - (z1 - z0) * (r2 - r1) < -STRAIGHT:
            pieces.append(chain[start : k + 1])
            start = k
    pieces.append(chain[start:])
    return [_outside(p, profile) for p in pieces if profile[p[-1]][1] - profile[p[0]][1] > LEVEL]


def _outside(piece: list[int], profile: Outline) -> list[int]:
    """A piece without ends that lie within its level faces."""
    first, last = 0, len(piece)
    while last - first > 2 and abs(profile[piece[first + 1]][1] - profile[piece[first]][1]) <= LEVEL:
        first += 1
    while last - first > 2 and abs(profile[piece[last - 2]][1] - profile[piece[last - 1]][1]) <= LEVEL:
        last -= 1
    return piece[first:last]


def _outer_chain(on_axis: Sequence[bool]) -> list[int]:
    """Vertices from the lower end on the axis to the upper one, along the outside; empty where the solid touches the axis otherwise than along one stretch."""
    count = len(on_axis)
    starts = [k for k in range(count) if on_axis[k] and not on_axis[(k + 1) % count]]
    if len(starts) != 1 or sum(on_axis) < 2:
        return []
    chain = [starts[0]]
    while len(chain) == 1 or not on_axis[chain[-1]]:
        chain.append((chain[-1] + 1) % count)
    return chain

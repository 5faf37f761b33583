"""Solids among those that cloth meets whose vertices move by themselves: elastic bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, I32

if TYPE_CHECKING:
    from ..boundaries import BodyState, Boundary

__all__ = ["Patience", "SoftSolids"]


MISSED = 0.1
"""Own choice, of the distance of contact: farther, a surface that gives way was taken as it was for too long."""
SHORTEST = 1.0 / 32.0
"""Shortest exchange, as a share of the declared one."""


class Patience:
    """For how long surfaces that give way are taken as they were: shorter, the more the last exchange missed them.

    Args:
        longest: declared exchange [s].
        touch: distance of contact [m].
    """

    def __init__(self, longest: float, touch: float) -> None:
        self._longest, self._touch = longest, touch
        self.restart()

    def restart(self) -> None:
        """Nothing is known of the last exchange."""
        self.seconds = 0.25 * self._longest

    def learn(self, span: float, missed: float) -> None:
        """The last exchange took `span` seconds and missed by so much [m], which goes with its square."""
        factor = np.sqrt(MISSED * self._touch / max(missed, 1e-12))
        wanted = span * float(np.clip(factor, 0.5, 1.5))
        self.seconds = float(np.clip(wanted, SHORTEST * self._longest, self._longest))


class SoftSolids:
    """Their rows among the boundaries, and their vertices among those of all solids.

    Args:
        boundaries: all solids.
        row: the solid of each vertex (m,).
    """

    def __init__(self, boundaries: Sequence[Boundary], row: I32) -> None:
        self.rows = {k: np.flatnonzero(row == k) for k, b in enumerate(boundaries) if b.deforming}

    def place(self, bodies: BodyState, places: F64) -> None:
        """Write where their vertices are into those of all solids, shape (m, 3)."""
        for row, own in self.rows.items():
            places[own] = bodies.vertices[row][0]

    def missed(self, bodies: BodyState, places: F64) -> float:
        """Farthest that one of their vertices is from where it was thought to get to [m]."""
        off = (np.sqrt(((bodies.vertices[row][0] - places[own]) ** 2).sum(1).max(initial=0.0)) for row, own in self.rows.items())
        return float(max(off, default=0.0))

    def aim(self, bodies: BodyState, span: float, places: F64, speeds: F64) -> None:
        """Write the velocities with which they arrive, after `span` seconds, where their present velocities take them."""
        for row, own in self.rows.items():
            here, speed = bodies.vertices[row]
            speeds[own] = (here + span * speed - places[own]) / span

    def fastest(self, speeds: F64) -> float:
        """Fastest of their vertices [m/s], from the velocities of those of all solids."""
        return max((float(np.sqrt((speeds[own] ** 2).sum(1).max(initial=0.0))) for own in self.rows.values()), default=0.0)

    def given(self, impulses: F64) -> dict[int, F64]:
        """Per row, of impulses at the vertices of all solids, shape (m, 3) [N s]."""
        return {row: impulses[own] for row, own in self.rows.items()}

    def lightness(self, bodies: BodyState, inverse: F64) -> None:
        """Write inverse masses of those that give way into those of all solids' vertices, shape (m,) [1/kg]."""
        for row, own in self.rows.items():
            inverse[own] = bodies.vertex_lightness.get(row, 0.0)

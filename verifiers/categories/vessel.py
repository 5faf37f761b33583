"""A vessel as its walls make it: what is inside, and whether what leaves goes over the rim or lower down.

A place is inside where the walls stand in most of the level directions about it, in the vessel's own frame as it was built upright. That
holds whatever holes it has, so that a vessel that leaks is one; and its rim is where the walls end.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..ledgers.motion import require_motion
from .bounds import ENCLOSED, VESSEL_CELLS, VESSEL_WAYS
from .liquid.solids import pieces_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Vessel", "vessel_of"]

Flags = NDArray[np.bool_]


def vessel_of(candidate: Candidate, entity: str, up: F64) -> Vessel:
    """A rigid entity as a vessel, made once per candidate.

    Raises:
        EvidenceError: it is not rigid, or its walls enclose nothing.
    """
    return candidate.memo(("vessel", entity), lambda: Vessel(candidate, entity, up))


class Vessel:
    """Inside of a rigid entity, carried along with its heaviest body."""

    def __init__(self, candidate: Candidate, entity: str, up: F64) -> None:
        contract = require_motion(candidate, entity)
        self.pieces = [p for p in pieces_of(candidate) if p.entity == entity]
        if contract.physics.category != "rigid" or not self.pieces:
            raise EvidenceError(f"{entity!r} is {contract.physics.category} and no vessel; name a rigid entity with walls")
        bodies = candidate.entity(entity).bodies
        lead = max(bodies, key=lambda b: b.mass).name
        self.lead = next(p for p in self.pieces if p.body == lead)
        self.world_up = up
        own_up = self.lead.turn[0].T @ up
        flat = np.eye(3)[np.argsort(np.abs(own_up))[:2]]
        first = flat[0] - (flat[0] @ own_up) * own_up
        first /= np.linalg.norm(first)
        self.axes = np.stack([first, np.cross(own_up, first), own_up])
        """Two level directions and up, in the body's frame as rows."""
        corners = np.concatenate([self.local(p.world(p.solid.vertices, 0), 0) for p in self.pieces])
        self.lower, upper = corners.min(axis=0), corners.max(axis=0)
        self.height = float(upper[2] - self.lower[2])
        self.cell = float((upper - self.lower).max()) / VESSEL_CELLS
        self.counts = np.maximum(np.ceil((upper - self.lower) / self.cell - 1e-9).astype(int), 1)
        self.enclosed, hollow = self._enclosed()
        if not hollow.any():
            raise EvidenceError(
                f"the walls of {entity!r} enclose nothing; name an entity that is open above and walled all round"
            )
        self.capacity = float(hollow.sum()) * self.cell**3
        """Volume inside, up to the rim [m^3]."""
        levels = np.arange(self.counts[2])
        self.tops = np.where(hollow.any(axis=2), (hollow * (levels + 1)).max(axis=2), int((hollow * (levels + 1)).max()))
        self.bottom = float(np.flatnonzero(hollow.any(axis=(0, 1)))[0]) * self.cell
        self.depth = float(self.tops.max()) * self.cell - self.bottom
        """From the rim to the lowest place inside [m]."""

    def local(self, points: F64, frame: int) -> F64:
        """World points at a frame in the vessel's upright frame, shape (n, 3)."""
        return np.asarray(self.lead.local(points, frame) @ self.axes.T)

    def _enclosed(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which cells walls stand about, and which of them no wall fills, each shape `counts`."""
        index = np.stack(np.meshgrid(*(np.arange(n) for n in self.counts), indexing="ij"), axis=-1).reshape(-1, 3)
        # A little off the middles, so that no way runs along a wall.
        middles = self.lower + (index + 0.5 + np.array([1e-3, 2e-3, 1.5e-3])) * self.cell
        world = middles @ self.axes @ self.lead.turn[0].T + self.lead.position[0]
        reach = float(np.linalg.norm(self.counts)) * self.cell
        met = np.zeros(len(world))
        for angle in 2.0 * np.pi * (np.arange(VESSEL_WAYS) + 0.37) / VESSEL_WAYS:
            way = reach * (np.cos(angle) * self.axes[0] + np.sin(angle) * self.axes[1]) @ self.lead.turn[0].T
            hit = np.zeros(len(world), dtype=bool)
            for piece in self.pieces:
                rows = np.flatnonzero(~hit)
                hit[rows] = piece.between(world[rows], world[rows] + way, 0)
            met += hit
        filled = np.zeros(len(world), dtype=bool)
        for piece in self.pieces:
            filled |= piece.depth(piece.local(world, 0)) > 0.0
        around = met >= ENCLOSED * VESSEL_WAYS
        return (around | filled).reshape(self.counts), (around & ~filled).reshape(self.counts)

    def _cells(self, local: F64) -> tuple[NDArray[np.int64], Flags]:
        index = np.floor((local - self.lower) / self.cell).astype(np.int64)
        known = ((index >= 0) & (index < self.counts)).all(axis=1)
        return np.clip(index, 0, self.counts - 1), known

    def inside(self, local: F64) -> Flags:
        """Which points of the upright frame are inside, shape (n,)."""
        index, known = self._cells(local)
        return np.asarray(known & self.enclosed[tuple(index.T)])

    def below_rim(self, local: F64) -> F64:
        """Depth of points of the upright frame below the rim over them [m], shape (n,)."""
        index, _ = self._cells(local)
        rim = self.tops[index[:, 0], index[:, 1]] * self.cell + self.lower[2]
        return np.asarray(rim - local[:, 2])

    def level(self, local: F64) -> F64:
        """Heights of points over the lowest place inside, of the inside's [1], shape (n,)."""
        return np.asarray((local[:, 2] - self.lower[2] - self.bottom) / self.depth)

    def tilt(self, frame: int) -> float:
        """Angle between its own up and the world's at a frame [rad]."""
        own = self.lead.turn[frame] @ self.axes[2]
        return float(np.arctan2(np.linalg.norm(np.cross(own, self.world_up)), own @ self.world_up))

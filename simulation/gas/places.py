"""Places of pieces of surface at a time: those of their bodies, or of the triangles of their cloth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .obstacles import body_place
from .pieces import STANDS

if TYPE_CHECKING:
    from ..boundaries import BodyState
    from .pieces import Pieces

__all__ = ["Places"]


class Places:
    """Middles and normals of pieces in the world.

    Args:
        pieces: them.
    """

    def __init__(self, pieces: Pieces) -> None:
        self.pieces = pieces
        self.point, self.normal = pieces.point.copy(), pieces.normal.copy()
        """[m] and 1, shapes (n, 3)."""
        self.moving = pieces.carrier != STANDS
        self._rows = {int(row): np.flatnonzero(pieces.carrier == row) for row in np.unique(pieces.carrier[self.moving])}

    @property
    def move(self) -> bool:
        """True where any of them may move."""
        return bool(self._rows)

    def take(self, bodies: BodyState, ahead: float) -> None:
        """Go to where they are some seconds after a state, the bodies going on as they do in it."""
        for row, own in self._rows.items():
            if row in bodies.vertices:
                places, speeds = bodies.vertices[row]
                self._lay(own, places + ahead * speeds)
                continue
            place = body_place(bodies, row, ahead)
            self.point[own] = self.pieces.point[own] @ place.rotation.T + place.position
            self.normal[own] = self.pieces.normal[own] @ place.rotation.T

    def _lay(self, own: NDArray[np.intp], vertices: F64) -> None:
        """Lay pieces of cloth on its triangles."""
        corner = vertices[self.pieces.corner[own]]
        across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        self.point[own] = np.einsum("nk,nkx->nx", self.pieces.weight[own], corner)
        self.normal[own] = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)

"""Parts that bend in a batch of the path tracer: their vertices and normals at a frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...worlds.arrays import F64, I32, I64
from ...worlds.candidate import Candidate

__all__ = ["SoftPart"]


@dataclass(frozen=True)
class SoftPart:
    """The vertices of one deforming part in a batch."""

    entity: str
    part: str
    rows: slice
    """Rows of the batch."""
    source: I64
    """Visible vertex of the part behind each row."""
    group: I64
    """Vertices of one group share a normal: one place, and one normal at rest."""
    faces: I32
    """Relative to the first of `rows`."""
    loose: bool
    """It can tear: corners that stood at one place at rest share a normal only as long as they are together."""

    def placed(self, candidate: Candidate, frame: int) -> tuple[F64, F64]:
        """World positions and normals at a frame, shapes (n, 3)."""
        positions = candidate.surface(self.entity, self.part, frame)[self.source]
        a, b, c = (positions[self.faces[:, k]] for k in range(3))
        across = np.repeat(np.cross(b - a, c - a), 3, axis=0)
        group = self.group
        if self.loose:
            group = np.unique(np.column_stack([group, positions]), axis=0, return_inverse=True)[1].reshape(-1)
        corner = group[self.faces.reshape(-1)]
        sums = np.stack([np.bincount(corner, across[:, k], minlength=int(group.max()) + 1) for k in range(3)], axis=1)
        normals = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300)
        return positions, normals[group]

"""Visible surfaces of deforming parts, frame by frame, and the trees of those that are asked about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...geometry import Forest, Solid
from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh
from ...worlds.errors import EvidenceError, InputError

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["PartSurface", "Shapes"]

HELD = 2_000_000
"""Triangles of deformed surfaces that are kept."""


@dataclass(frozen=True)
class PartSurface:
    """Visible surface of one part."""

    entity: str
    part: str
    body: str
    solid: Solid
    deviation: float
    """[m] how far the collision surface may stand outside the visible one."""


class Shapes:
    """Shapes of the parts of a candidate at its frames, in the frames of their bodies."""

    def __init__(self, candidate: Candidate, parts: Sequence[PartSurface]) -> None:
        self.candidate, self.parts = candidate, parts
        self.soft = frozenset(i for i, p in enumerate(parts) if p.entity in candidate.deforming)
        """Parts that deform."""
        own: dict[int, Solid] = {id(p.solid): p.solid for i, p in enumerate(parts) if i not in self.soft}
        self._rigid = list(own.values())
        self._forest = Forest(self._rigid)
        places = {key: k for k, key in enumerate(own)}
        self._place = [places.get(id(p.solid), -1) for p in parts]
        self._kept: dict[tuple[int, int], Solid] = {}
        self._faces = 0

    def solid(self, part: int, frame: int) -> Solid:
        """Surface of a part at a frame.

        Raises:
            EvidenceError: its deformed surface cannot be inspected.
        """
        own = self.parts[part]
        if part not in self.soft:
            return own.solid
        if (part, frame) not in self._kept:
            built = next(p for p in self.candidate.entity(own.entity).parts if p.part == own.part)
            mesh = TriangleMesh(self.candidate.shape(own.entity, own.part, frame), built.render.faces)
            try:
                made = Solid.from_mesh(mesh, closed=built.closed)
            except InputError as error:
                raise EvidenceError(
                    f"surface of {own.entity}/{own.part} at frame {frame} cannot be inspected: {error}"
                ) from error
            if self._faces > HELD:
                self._kept, self._faces = {}, 0
            self._kept[part, frame] = made
            self._faces += len(made.faces)
        return self._kept[part, frame]

    def boxes(self, part: int, frames: NDArray[np.intp]) -> tuple[F64, F64, F64]:
        """Middle and half extents of a deforming part's local boxes, shape (frames, 3), and radii about the middles (frames,)."""
        own = self.parts[part]
        shapes = [self.candidate.shape(own.entity, own.part, int(k)) for k in frames]
        low, high = np.array([s.min(0) for s in shapes]), np.array([s.max(0) for s in shapes])
        half = 0.5 * (high - low)
        return 0.5 * (low + high), half, np.linalg.norm(half, axis=1)

    def forest(self, asked: Sequence[tuple[int, NDArray[np.intp]]]) -> tuple[Forest, NDArray[np.intp]]:
        """Trees of what is asked about, and for every (part, frame) in the order asked which of them it is."""
        if all(part not in self.soft for part, _ in asked):
            return self._forest, np.repeat([self._place[part] for part, _ in asked], [len(f) for _, f in asked]).astype(np.intp)
        solids, places, known = list(self._rigid), list[int](), dict[tuple[int, int], int]()
        for part, frames in asked:
            if part not in self.soft:
                places += [self._place[part]] * len(frames)
                continue
            for frame in frames.tolist():
                if (part, frame) not in known:
                    known[part, frame] = len(solids)
                    solids.append(self.solid(part, frame))
                places.append(known[part, frame])
        return Forest(solids), np.array(places, dtype=np.intp)

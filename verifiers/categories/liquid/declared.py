"""A liquid instance as it is declared: the volume that it fills at frame 0, known before anything is simulated.

What depends on it alone is judged at the static stage, and again beside the motion: both give the same answer.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid, contains
from ....worlds.arrays import F64
from ....worlds.categories.liquid.facts import spacing_of
from ....worlds.coarsening import read_overrides
from ....worlds.errors import EvidenceError
from ....worlds.extents import least_extent
from ....worlds.spec import LiquidPhysics
from .solids import deepest, pieces_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import LiquidInstance, WorldSpec

__all__ = ["Declared", "declared_extent", "production_spacing"]

MOST_CELLS = 300_000
"""Own choice: the box of a body is cut into about so many cells at most."""
PER_SPACING = 8.0
"""Own choice: cells per spacing, where that are no more."""
COARSE = 0.5
"""[spacings] Own choice: cells of at most this size tell how thick a body is."""


class Declared:
    """Members of a liquid instance, their spacing, and where they are at frame 0."""

    def __init__(self, candidate: Candidate, solver: str) -> None:
        self.candidate, self.solver = candidate, solver
        spec = candidate.spec
        self.plan: LiquidInstance = spec.simulation.liquid[solver]
        self.members = tuple(
            m for m in self.plan.members if m in spec.entities and isinstance(spec.entities[m].physics, LiquidPhysics)
        )
        self.spacing = spacing_of(spec, solver)
        """Distance of particles at rest, or size of a cell [m]."""
        self._solids = {
            m: [(Solid.from_mesh(p.render, closed=p.closed), candidate.pose(m, 0, p.body)) for p in candidate.entity(m).parts]
            for m in self.members
        }

    @property
    def box(self) -> tuple[F64, F64] | None:
        """Least and greatest corner of the volume in the world, with two spacings about it [m]; None where nothing is declared."""
        points = [pose.apply(s.vertices) for solids in self._solids.values() for s, pose in solids]
        if not points:
            return None
        every = np.concatenate(points)
        return every.min(axis=0) - 2.0 * self.spacing, every.max(axis=0) + 2.0 * self.spacing

    def at(self, points: F64) -> NDArray[np.bool_]:
        """True where a world point lies in the volume of a member at frame 0, shape (n,)."""
        found = np.zeros(len(points), dtype=bool)
        for member in self.members:
            found |= self._inside(member, points)
        return found

    def across(self, member: str) -> float | None:
        """Diameter of the widest ball in a member's volume, less the solids in it [m].

        Of one simple shape it is exact; of any other it is found on cells, at most one cell more. None where nothing closed is declared, and of
        what is so large that a cell would be more than `COARSE`: its particles tell.
        """
        known = declared_extent(self.candidate.spec, member)
        return self.candidate.memo(("across", self.solver, member), lambda: self._widest(member)) if known is None else known

    def _widest(self, member: str) -> float | None:
        from scipy.ndimage import distance_transform_edt

        closed = [(s, pose) for s, pose in self._solids[member] if s.closed]
        if not closed:
            return None
        corners = np.concatenate([pose.apply(s.vertices) for s, pose in closed])
        low, size = corners.min(axis=0), np.ptp(corners, axis=0)
        wanted = max(self.spacing / PER_SPACING, float(np.cbrt(np.prod(size) / MOST_CELLS)))
        counts = np.maximum(np.ceil(size / wanted), 1).astype(int)
        if wanted > COARSE * self.spacing:
            return None
        cell = size / counts
        points = low + (np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3) + 0.5) * cell
        inside = self._inside(member, points)
        rows = np.flatnonzero(inside)
        for found in deepest(pieces_of(self.candidate), points[rows], 0, 0.0):
            inside[rows[found.rows]] = False
        room = distance_transform_edt(np.pad(inside.reshape(tuple(counts)), 1), sampling=cell)
        return float(min(2.0 * room.max(), size.min()))

    def _inside(self, member: str, points: F64) -> NDArray[np.bool_]:
        found = np.zeros(len(points), dtype=bool)
        for solid, pose in self._solids[member]:
            rows = np.flatnonzero(~found)
            found[rows] = contains(solid, pose.inverse().apply(points[rows]))
        return found


def declared_extent(spec: WorldSpec, member: str) -> float | None:
    """Least extent of a body of one simple part [m]; None where only its built surface tells."""
    parts = spec.entities[member].parts
    return least_extent(next(iter(parts.values())).shape) if len(parts) == 1 else None


def production_spacing(candidate: Candidate, solver: str) -> float:
    """Spacing of the world itself [m]: a probe may be coarser, and vouches for the motion, not for what its spacing resolves."""
    spacing, where = spacing_of(candidate.spec, solver), candidate.folder / candidate.artifact
    if candidate.stage != "probe" or not read_overrides(where):
        return spacing
    try:
        entities = json.loads((where.parent / "candidate.json").read_text())["spec"]["entities"]
        return min(
            spacing, *(float(entities[m]["physics"]["resolution"]) for m in candidate.spec.simulation.liquid[solver].members)
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise EvidenceError(f"candidate.json of {where.parent.name!r} is damaged ({error}); call probe_sim again") from error

"""Liquids as the other verifiers ask for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.categories.liquid.surface import LiquidSurface, mesh_of
from ..judge import Push, record_of
from ..loose import Loose, Sample
from ..pushes import pressed_by, pushes_of
from .across import thin_lines
from .check import DECLARED, category_rows, declared_rows, numerical_rows
from .links import shares
from .outline import filled_cells
from .register import liquid_lines

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ...rows.questions import Question

__all__ = ["LiquidJudge"]

STIRRED = 0.02
"""[m/s] Root mean square speed from which on a liquid is not still. Own choice: above the noise of particles at rest."""
CHANNELS = ("origin", "particle/position", "particle/velocity", "particle/volume", "particle/fluid")


class LiquidJudge(Loose):
    """Liquids: particles, or markers of a grid."""

    name: ClassVar[str] = "liquid"
    bears: ClassVar[bool] = True
    declared: ClassVar[tuple[Question, ...]] = tuple(DECLARED)
    noun: ClassVar[str] = "liquid"
    goes_on: ClassVar[str] = "flows or splashes on"
    in_fields: ClassVar[tuple[str, str] | None] = (
        "field {0!r} blows on the surface of liquids: pressure on what faces it, the stress of open water along it",
        "drops are one spacing thick at least, bodies of less than twenty feel too little of it, and "
        "within two to four spacings of solids there is a lee; no ripples smaller than that",
    )
    still: ClassVar[float] = STIRRED

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return category_rows(candidate, solver)

    def declared_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance that what is declared decides."""
        return declared_rows(candidate, solver)

    def numerical_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return numerical_rows(candidate, solver)

    def sample(self, candidate: Candidate, solver: str, row: int, frame: int) -> Sample:
        """Particles of one member at a frame."""
        cache = candidate.caches[solver]
        density = candidate.spec.materials[candidate.spec.entities[cache.index.bodies[row]].material].density
        held = cache.read(frame, CHANNELS)
        own = held["particle/fluid"] == row
        position, velocity, volume = (held[f"particle/{n}"][own].astype(np.float64) for n in ("position", "velocity", "volume"))
        return Sample(position + held["origin"], velocity, density * volume)

    def pushes(self, candidate: Candidate) -> list[list[Push]]:
        """Pushes on its boundaries; liquids that share an instance share them by their particles beside each."""
        return pushes_of(
            candidate, self.caches(candidate).values(), lambda cache, frame, rows: shares(candidate, cache, frame, rows)
        )

    def pressed(self, candidate: Candidate, entity: str, other: str) -> F64:
        """Size of the impulse between a liquid and a solid over each frame [N s], shape (frames,).

        Raises:
            EvidenceError: no record tells.
        """
        _, cache, _ = self.held(candidate, entity)
        return pressed_by(candidate, cache, entity, other)

    def blown(self, candidate: Candidate, solver: str) -> F64 | None:
        """Impulse of force fields over each frame [N s], shape (frames, 3); None where none acts."""
        records = [record_of(candidate.caches[solver], f"field_impulse_{axis}", candidate.frame_count) for axis in "xyz"]
        known = [r for r in records if r is not None]
        return np.diff(np.stack(known, axis=1), axis=0, prepend=0.0) if len(known) == 3 else None

    def outline(self, candidate: Candidate, entity: str, frame: int) -> TriangleMesh:
        """Surface mesh, or where none was made the cells that its particles fill; before any simulation, its declared volume."""
        if candidate.stage == "static":
            return super().outline(candidate, entity, frame)
        _, cache, row = self.held(candidate, entity)
        surface = LiquidSurface(cache)
        if frame < surface.count():
            return TriangleMesh(*mesh_of(surface.read(frame), row))
        found = cache.read(frame, ("origin", "particle/position", "particle/fluid", "particle/volume"))
        mine = found["particle/fluid"] == row
        points = found["particle/position"][mine].astype(np.float64) + found["origin"]
        volume = found["particle/volume"][mine]
        return filled_cells(points, float(np.cbrt(np.median(volume))) * 1.5 if len(volume) else 1.0)

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return thin_lines(candidate.spec) + liquid_lines(candidate)

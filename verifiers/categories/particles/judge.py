"""Grains and flying particles as the other verifiers ask for them. Flying particles push nobody."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.errors import EvidenceError
from ....worlds.spec import DemInstance
from ..judge import Push, Touch
from ..loose import Loose, Sample
from ..pushes import pressed_by, pushes_of, touches_of
from .check import category_rows, numerical_rows
from .corrections import stock
from .diagnosis import particle_names
from .frames import swarm_of
from .register import particle_lines

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction, Row
    from ....worlds.spec import WorldSpec
    from ...predicates.outcome import Outcome

__all__ = ["ParticleJudge"]

RUNNING = 0.01
"""[m/s] Root mean square speed from which on particles are not still. Own choice: a bed at rest creeps by a tenth of it."""
CORNERS = np.concatenate([np.eye(3), -np.eye(3)])
SIDES = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]], dtype=np.int32)
"""An octahedron of radius 1."""


class ParticleJudge(Loose):
    """Grains and flying particles."""

    name: ClassVar[str] = "particles"
    meets: ClassVar[bool] = True
    grainy: ClassVar[bool] = True
    noun: ClassVar[str] = "grains"
    goes_on: ClassVar[str] = "run or fly on"
    in_fields: ClassVar[tuple[str, str] | None] = (
        "drag of field {0!r} on particles is that of single spheres",
        "those in a heap or a swarm are not sheltered by others",
    )
    still: ClassVar[float] = RUNNING

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return category_rows(candidate, solver)

    def numerical_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return numerical_rows(candidate, solver)

    def sample(self, candidate: Candidate, solver: str, row: int, frame: int) -> Sample:
        """Particles of one member at a frame."""
        found = swarm_of(candidate, solver).read(frame)
        own = found.member == row
        return Sample(found.position[own], found.velocity[own], found.mass[own])

    def _granular(self, candidate: Candidate) -> dict[str, Cache]:
        """Caches of instances whose particles touch."""
        return {n: c for n, c in self.caches(candidate).items() if isinstance(candidate.spec.simulation.solvers[n], DemInstance)}

    def pushes(self, candidate: Candidate) -> list[list[Push]]:
        """Pushes between grains and bodies; members of one instance share them by their masses."""

        def shares(cache: Cache, frame: int, rows: list[int]) -> list[dict[str, float]]:
            swarm = swarm_of(candidate, cache.index.solver)
            now = swarm.read(frame)
            part = np.bincount(now.member, now.mass, minlength=len(swarm.members)) / max(float(now.mass.sum()), 1e-30)
            return [dict(zip(swarm.members, part.tolist(), strict=True))] * len(rows)

        return pushes_of(candidate, self._granular(candidate).values(), shares)

    def touches(self, candidate: Candidate) -> Iterator[Touch]:
        """Grains and every body that they press."""
        for solver, cache in self._granular(candidate).items():
            members = frozenset(candidate.spec.simulation.solvers[solver].members)
            yield from touches_of(candidate, cache, members, cache.index.colliders)

    def pressed(self, candidate: Candidate, entity: str, other: str) -> F64:
        """Size of the impulse between grains and a solid over each frame [N s], shape (frames,).

        Raises:
            EvidenceError: they are no grains, or no record tells.
        """
        solver, cache, _ = self.held(candidate, entity)
        if solver not in self._granular(candidate):
            raise EvidenceError(
                f"{entity!r} flies in a ballistic instance, which presses nobody; make it grains of a dem instance"
            )
        return pressed_by(candidate, cache, entity, other)

    def blown(self, candidate: Candidate, solver: str) -> F64 | None:
        """Impulse of force fields over each frame [N s], shape (frames, 3)."""
        given: F64 = np.asarray(candidate.caches[solver].series("field/impulse"), dtype=np.float64)
        return np.asarray(given[: candidate.frame_count].sum(axis=1))

    def amount(self, candidate: Candidate, entity: str) -> str:
        """Number at the first and the last frame, and their diameter."""
        if candidate.stage == "static":
            return super().amount(candidate, entity)
        _, cache, row = self.held(candidate, entity)
        counts, radii = [], [np.zeros(0)]
        for frame in (0, candidate.last_frame):
            found = cache.read(frame, ("particle/member", "particle/radius"))
            radii.append(found["particle/radius"][found["particle/member"] == row].astype(np.float64))
            counts.append(len(radii[-1]))
        told = f"{counts[0]} of them" + (f", {counts[1]} at the end" if counts[1] != counts[0] else "")
        known = np.concatenate(radii)
        return told + (f", each {2.0 * float(np.median(known)):.3g} m" if len(known) else "")

    def outline(self, candidate: Candidate, entity: str, frame: int) -> TriangleMesh:
        """An octahedron around each particle; before any simulation, the declared volume."""
        if candidate.stage == "static":
            return super().outline(candidate, entity, frame)
        _, cache, row = self.held(candidate, entity)
        found = cache.read(frame, ("origin", "particle/position", "particle/member", "particle/radius"))
        mine = found["particle/member"] == row
        points = found["particle/position"][mine].astype(np.float64) + found["origin"]
        vertices = points[:, None] + CORNERS * found["particle/radius"][mine].astype(np.float64)[:, None, None]
        faces = SIDES + 6 * np.arange(len(points), dtype=np.int32)[:, None, None]
        return TriangleMesh(vertices.reshape(-1, 3), faces.reshape(-1, 3).astype(np.int32))

    def beat_corrections(
        self, candidate: Candidate, entity: str, outcome: Outcome, details: Mapping[str, object]
    ) -> list[Correction]:
        """More grains, or a narrower heap, where too few are in a region."""
        return stock(candidate, entity, outcome, details)

    def placeholders(self, spec: WorldSpec, entity: str, row: Row) -> dict[str, Any]:
        """Their one emitter, and whether they run or are jammed."""
        return particle_names(spec, entity, row)

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return particle_lines(candidate.spec)

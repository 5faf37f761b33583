"""Cloth as the other verifiers ask for it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.cloth.facts import pins_of
from ....worlds.errors import EvidenceError
from ...ledgers.exchanged import CHANNEL, partners
from ...ledgers.origins import Origin
from ..judge import Judge, Push, Rupture, Touch
from ..pushes import MIN_IMPULSE, givers_of, pushes_of, sizes_of, touches_of
from .apart import given_apart
from .check import category_rows, numerical_rows
from .diagnosis import sheet_names
from .frames import cloth_run
from .links import shares, sheet_impulse
from .register import cloth_lines
from .shape import stretch_of
from .tears import tearing_pieces

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ....worlds.spec import WorldSpec
    from ..stretch import Stretch

__all__ = ["ClothJudge"]


class ClothJudge(Judge):
    """Sheets; what they and solids gave each other over a frame, pins included, is in their own record."""

    name: ClassVar[str] = "cloth"
    meets: ClassVar[bool] = True
    flat: ClassVar[bool] = True
    noun: ClassVar[str] = "sheet"
    goes_on: ClassVar[str] = "waves on"

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return category_rows(candidate, solver)

    def numerical_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return numerical_rows(candidate, solver)

    def pushes(self, candidate: Candidate) -> list[list[Push]]:
        """Pushes of either on the other; sheets of one instance share them by their masses, as far as their boxes come near."""
        return pushes_of(
            candidate, self.caches(candidate).values(), lambda cache, frame, rows: shares(candidate, cache, frame, rows)
        )

    def givers(self, candidate: Candidate, entity: str) -> dict[Origin, F64]:
        """Impulses of solids, what holds its pins included, and of air; of one of several sheets as far as they are certainly its own."""
        for cache in self.caches(candidate).values():
            members = {n.split("/", 1)[0] for n in cache.index.bodies}
            if entity in members and len(members) > 1:
                return given_apart(candidate, cache, entity, self.momentum(candidate, entity))
            if members == {entity}:
                air = [np.asarray(cache.series(f"record/air_impulse_{axis}"), dtype=np.float64) for axis in "xyz"]
                blown = np.diff(np.stack(air, axis=1)[: candidate.frame_count], axis=0, prepend=0.0)
                return givers_of(candidate, cache, CHANNEL, blown)
        return {}

    def unfelt(self, spec: WorldSpec) -> set[tuple[str, str]]:
        """Sheets and the bodies that they do not push, because no coupling brings their push there."""
        return {
            (sheet, body)
            for solver, rigid in spec.simulation.rigid.items()
            for name, cloth in self.instances(spec).items()
            if name not in partners(spec, solver)
            for sheet in cloth.members
            for body in rigid.members
        }

    def pressed(self, candidate: Candidate, entity: str, other: str) -> F64:
        """Size of the impulse between a sheet and a solid over each frame [N s], shape (frames,)."""
        return sheet_impulse(candidate, entity, other)

    def stretch(self, candidate: Candidate, entity: str, frame: int) -> Stretch:
        """Its stretch at a frame, by place."""
        for solver in self.caches(candidate):
            run = cloth_run(candidate, solver)
            if any(piece.entity == entity for piece in run.pieces):
                return stretch_of(run, entity, frame)
        raise EvidenceError(f"no cache holds {entity!r}; list it as a member of an instance that moves it and bake")

    def ruptures(self, candidate: Candidate) -> Iterator[Rupture]:
        """Sheets that tore, with what pulled at most of the tears."""
        for solver in self.caches(candidate):
            run = cloth_run(candidate, solver)
            for piece in tearing_pieces(run):
                found = [tear for _, _, tears in piece.frames for tear in tears]
                if not found:
                    continue
                causes = [t.cause for t in found if t.cause >= 0]
                most = max(sorted(set(causes)), key=causes.count) if causes else None
                cause = None if most is None else run.cache.index.colliders[most].split("/", 1)[0]
                times = [t.time for t in found]
                length = piece.open_length(candidate.last_frame)
                yield Rupture(
                    piece.entity, min(times), max(times), cause, f"tears at {len(found)} points, open over {length:.3g} m"
                )

    def touches(self, candidate: Candidate) -> Iterator[Touch]:
        """Sheets and all solids around them; and bodies that felt a push that no other matter gave."""
        frames = candidate.frame_count
        sheets = {n: frozenset(candidate.spec.simulation.solvers[n].members) for n in self.caches(candidate)}
        for name, members in sheets.items():
            series = [candidate.caches[name].series(f"record/solid_impulse_{axis}")[:frames] for axis in "xyz"]
            gained = np.linalg.norm(np.diff(np.stack(series, axis=1), axis=0, prepend=0.0), axis=1)
            yield Touch(members, None, np.asarray(gained > MIN_IMPULSE))
            yield from self._soft(candidate, name, members)
        for solver, cache in candidate.rigid_caches.items():
            coupled = partners(candidate.spec, solver)
            matter = frozenset[str]().union(*(sheets[n] for n in coupled if n in sheets))
            if matter and cache.index.bodies:
                others = [candidate.caches[n] for n in coupled if n not in sheets and n in candidate.caches]
                yield from touches_of(candidate, cache, matter, cache.index.bodies, others)

    def _soft(self, candidate: Candidate, name: str, members: frozenset[str]) -> Iterator[Touch]:
        """Sheets against each elastic body that holds none of their pins, by the record of what they gave it."""
        cache, held = candidate.caches[name], {p.to for m in members for p in pins_of(candidate.spec.entities[m]).values()}
        owners = [b.split("/", 1)[0] for b in cache.index.colliders]
        soft = [e for e in dict.fromkeys(owners) if e in candidate.deforming and e not in held]
        sizes = sizes_of(candidate, cache, cache.index.colliders) if soft else None
        for entity in soft:
            if sizes is not None:
                yield Touch(members, entity, sizes[:, [o == entity for o in owners]].max(axis=1) > MIN_IMPULSE)

    def placeholders(self, spec: WorldSpec, entity: str, row: Row) -> dict[str, Any]:
        """The wind that blows a sheet, where the row asks for what air brings about; whether pins hold it."""
        return sheet_names(spec, entity, row)

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return cloth_lines(candidate)

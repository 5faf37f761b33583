"""Elastic bodies as the other verifiers ask for them; rigid instances move them and log their contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from ...ledgers.exchanged import partners
from ...ledgers.origins import Origin
from ..judge import Judge
from .check import category_rows
from .exchange import soft_impulses
from .register import elastic_lines

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row

__all__ = ["ElasticJudge"]


class ElasticJudge(Judge):
    """Elastic bodies."""

    name: ClassVar[str] = "elastic"
    noun: ClassVar[str] = "soft body"
    goes_on: ClassVar[str] = "wobbles on"
    in_fields: ClassVar[tuple[str, str] | None] = (
        "field {0!r} presses on the faces of elastic bodies that face it",
        "drag by the area that they show, without lift and without suction behind",
    )

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance and of its elastic members."""
        return category_rows(candidate, solver)

    def givers(self, candidate: Candidate, entity: str) -> dict[Origin, F64]:
        """Impulses of the matter of coupled instances; contacts of bodies stay in the rest."""
        for name, cache in self.caches(candidate).items():
            owners = [n.split("/", 1)[0] for n in cache.index.deformables]
            others = partners(candidate.spec, name)
            if entity in owners and others:
                given = soft_impulses(candidate, cache)[1 : candidate.frame_count, owners.index(entity), :3]
                return {Origin("matter", ", ".join(others)): given}
        return {}

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return elastic_lines(candidate)

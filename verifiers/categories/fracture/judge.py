"""Breakable bodies as the other verifiers ask for them: what is special to them among rigid bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from ..judge import Judge
from .check import category_rows
from .register import fracture_lines

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row

__all__ = ["FractureJudge"]


class FractureJudge(Judge):
    """Breakable rigid bodies: rows and lines beside those of `rigid`, which answers for their motion."""

    name: ClassVar[str] = "fracture"
    moved_as: ClassVar[str] = "rigid"

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of the breakable members of one instance."""
        return category_rows(candidate, solver)

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return fracture_lines(candidate)

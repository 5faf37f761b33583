"""Questions asked of a candidate: id, words of the requirement, unit, and where the bound comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, cast

if TYPE_CHECKING:
    from ...worlds.requirements import Check, Group

__all__ = ["GROUP_OF", "Comparison", "Question", "by_name"]

Comparison = Literal["<=", ">=", "==", "in", ""]
"""Comparison of the measured value with the bound; empty where nothing is measured."""

GROUP_OF: Mapping[Check, Group] = {
    **dict.fromkeys(("terrain", "scale", "interpenetration", "support", "navigability", "relations"), "spatial"),
    **dict.fromkeys(("category", "numerical", "contact"), "physical"),
    **dict.fromkeys(("beat", "causal", "claim", "robustness"), "temporal"),
    "shots": "observational",
    "review": "observational",
    "delivery": "delivery",
}
"""Group of the matrix to which the rows of a check belong."""


@dataclass(frozen=True)
class Question:
    """One question, asked of one subject at a time; each answer becomes one row."""

    id: str
    """`support:rope`: the check, then the name of the question where the check has several."""
    predicate: str
    """Requirement in words. {0}, {1} stand for the names of the subject; a finding may repeat it with the numbers of its case."""
    measures: str = ""
    """Meaning of `measured`; empty where the answer has no number."""
    unit: str = ""
    """SI unit of the measured value and its bound; `various` where each finding names its own."""
    comparison: Comparison = ""
    """Comparison of the measured value with the bound, unless a finding says otherwise."""
    bound: str = ""
    """Where the bound comes from: a field of the specification, a named constant, or words."""
    subject: tuple[str, ...] = ()
    """Kinds of the subject's names: `entity`, `solver`, `relation`, `beat`, `shot`."""
    order: str = ""
    """Pattern of the row id where it is not the question, then the subject: `terrain:{0}:tight`."""
    mandatory: bool = True
    """True if acceptance needs the row."""
    matrix_group: Group | None = None
    """Group of the matrix, where it is not that of the check."""

    @property
    def check(self) -> Check:
        """The check that asks: the first word of the id, but for what the story asks for."""
        first = self.id.partition(":")[0]
        return cast("Check", "beat" if first in ("requirement", "probe") else first)

    @property
    def group(self) -> Group:
        """Group of the matrix."""
        return self.matrix_group or GROUP_OF[self.check]

    def row_id(self, subject: tuple[str, ...]) -> str:
        """Id of the row that answers the question for a subject: `support:rope:lamp:0`."""
        return self.order.format(*subject) if self.order else ":".join((self.id, *subject))

    @property
    def pattern(self) -> str:
        """Pattern of the row ids: `support:rope:<entity>:<start or end>`."""
        return self.row_id(tuple(f"<{name}>" for name in self.subject))


def by_name(*questions: Question) -> Mapping[str, Question]:
    """Questions by the last word of their ids."""
    return {q.id.rpartition(":")[2]: q for q in questions}

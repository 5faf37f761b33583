"""Predicates about bodies that deform."""

from __future__ import annotations

from typing import Literal

from ...predicate_base import BAND, Band, PredicateInfo, Subject, When

__all__ = ["PREDICATES", "Deflection", "Strain"]


class Deflection(Band):
    """Farthest that a point of an elastic body is off its rest shape, where that fits best [m]."""

    kind: Literal["deflection"] = "deflection"
    entity: Subject
    when: When = "eventually"


class Strain(Band):
    """Largest principal strain in an elastic body, by amount."""

    kind: Literal["strain"] = "strain"
    entity: Subject
    when: When = "eventually"


PREDICATES = (
    PredicateInfo("deflection", "m", ("vertex/position",), BAND),
    PredicateInfo("strain", "1", ("vertex/position",), BAND),
)

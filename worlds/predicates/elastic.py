"""Predicates about bodies that deform."""

from __future__ import annotations

from typing import Literal

from .fields import Band, Subject, When

__all__ = ["Deflection", "Strain"]


class Deflection(Band):
    """Farthest that a visible point of an elastic body or cloth is from where its rest shape has it [m].

    The rest shape stands where it fits best: motion and turning of the whole do not count. `max` with `when: end` asks that it
    came back to its shape.
    """

    kind: Literal["deflection"] = "deflection"
    entity: Subject
    when: When = "eventually"


class Strain(Band):
    """Largest principal strain anywhere in an elastic body: stretch less 1, by amount, compression included."""

    kind: Literal["strain"] = "strain"
    entity: Subject
    when: When = "eventually"

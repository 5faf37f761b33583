"""Predicates of order that have to hold: which event they say comes first, and which after it."""

from __future__ import annotations

from ..vocabulary import SpecModel
from .models import After, Always, And, Before, Eventually, Until, Within

__all__ = ["Ordering", "orderings_of"]

Ordering = Before | After | Within | Until
"""A predicate of order."""


def orderings_of(predicate: SpecModel) -> list[Ordering]:
    """Predicates of order without which a predicate cannot hold; those below a `not`, an `or` or a count are none."""
    if isinstance(predicate, Before | After | Within | Until):
        return [predicate]
    if isinstance(predicate, And):
        return [found for member in predicate.of for found in orderings_of(member)]
    if isinstance(predicate, Always | Eventually):
        return orderings_of(predicate.predicate)
    return []

"""Which channels the instances of a specification write: kinds of writer, which the categories declare."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .categories.registry import CATEGORIES

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["writers_of"]


def writers_of(spec: WorldSpec, name: str) -> frozenset[str]:
    """The kinds of writer that an instance is: the category of its engine, and what its members and couplings make it besides."""
    instance = spec.simulation.solvers[name]
    engine = [c.name for c in CATEGORIES.values() if isinstance(instance, c.instances)]
    return frozenset([*engine, *(writer for c in CATEGORIES.values() for writer in c.writers(spec, name))])

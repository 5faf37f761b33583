"""Media that instances moved, by which others are dragged along: read from their caches (R66)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from .categories.registry import CATEGORIES
from .instances import carriers_of

if TYPE_CHECKING:
    from .cache import Cache
    from .fields import Carrier
    from .spec import WorldSpec

__all__ = ["media_of"]


def media_of(spec: WorldSpec, caches: Mapping[str, Cache]) -> dict[str, Carrier]:
    """The medium of every instance that carries another and has a cache, by name."""
    names = {c for name in spec.simulation.solvers for c in carriers_of(spec, name) if c in caches}
    makers = {name: CATEGORIES[spec.simulation.solvers[name].moves[0]].medium for name in sorted(names)}
    return {name: make(spec, name, caches[name]) for name, make in makers.items() if make is not None}

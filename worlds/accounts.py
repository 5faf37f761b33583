"""An account of a simulated interval: energy and momentum per entity, their sources and sinks, and what has none.

Verifiers fill it, pictures show it.
"""

from __future__ import annotations

from dataclasses import dataclass

from .arrays import F64

__all__ = ["Account", "Mark"]


@dataclass(frozen=True)
class Mark:
    """Something that happened."""

    time: float
    """[s]"""
    name: str


@dataclass(frozen=True)
class Account:
    """Ledgers of all solver instances over F frames and E entities that no path moves. Interval k leads from frame k to k + 1."""

    times: F64
    """[s], shape (F,)."""
    entities: tuple[str, ...]
    mass: F64
    """[kg], shape (E,)."""
    kinetic: F64
    """[J], shape (F, E)."""
    potential: F64
    """Potential energy in gravity, against z = 0 [J], shape (F, E)."""
    elastic: F64
    """In springs and joints [J], shape (F,)."""
    work: F64
    """Done by drivers since frame 0, as recorded, and by liquids [J], shape (F,)."""
    momentum: F64
    """[kg m/s], shape (F, E, 3)."""
    angular_momentum: F64
    """About each entity's own centre [kg m^2/s], shape (F, E, 3)."""
    sources: dict[str, F64]
    """Impulse per interval and entity by cause [N s], each shape (F - 1, E, 3)."""
    contact: F64
    """Logged normal impulses on each entity [N s], shape (F - 1, E)."""
    unexplained: F64
    """Change of velocity without a source [m/s], shape (F - 1, E); NaN where joints, paths or holds make it undecidable."""
    bound: float
    """Greatest sound value of `unexplained` [m/s]."""
    events: tuple[Mark, ...]
    """Contacts that begin, in order of time."""

"""Energies and momentum of elastic members, as their instance recorded them and as their vertices have them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..worlds.arrays import F64

if TYPE_CHECKING:
    from ..worlds.cache import Cache

__all__ = ["Energies", "elastic_energies"]


class Energies(NamedTuple):
    """[J] per frame, each shape (F,)."""

    kinetic: F64
    stored: F64
    """In height and in deformation."""


def elastic_energies(cache: Cache) -> Energies:
    """Recorded energies of the elastic members of an instance; zeros where it has none.

    Raises:
        EvidenceError: a record is missing.
    """
    if not cache.index.deformables:
        return Energies(np.zeros(cache.index.frames), np.zeros(cache.index.frames))
    kinetic, height, strain = (
        cache.series(f"record/{n}") for n in ("elastic_kinetic_energy", "elastic_potential_energy", "strain_energy")
    )
    return Energies(np.asarray(kinetic), np.asarray(height + strain))

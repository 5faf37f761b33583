"""Energies and momentum of elastic members, as their instance recorded them and as their vertices have them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ...ledgers.strains import require_deforming
from ...rows.findings import Finding
from .rows import judge_frames

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction

__all__ = ["Energies", "VertexBooks", "elastic_energies", "judge_growth", "vertex_books"]


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


class VertexBooks(NamedTuple):
    """Energies, momentum and mass of the vertices of some elastic bodies, masses lumped to them."""

    kinetic: F64
    """[J], shape (F,)."""
    height: F64
    """Energy of gravity against z = 0 [J], shape (F,)."""
    momentum: F64
    """[N s], shape (F, 3)."""
    mass: float
    """[kg]"""


def vertex_books(candidate: Candidate, entities: tuple[str, ...]) -> VertexBooks:
    """Sums over the vertices of elastic bodies, per frame.

    Raises:
        EvidenceError: no cache holds how one deforms.
    """
    count, gravity = candidate.frame_count, np.array(candidate.spec.simulation.gravity)
    kinetic, height, momentum, mass = np.zeros(count), np.zeros(count), np.zeros((count, 3)), 0.0
    for name in entities:
        soft = require_deforming(candidate, name)
        weight = soft.masses
        mass += float(weight.sum())
        for frame in range(count):
            speeds = soft.velocities(frame)
            kinetic[frame] += 0.5 * float(weight @ (speeds**2).sum(axis=1))
            height[frame] -= float(weight @ (soft.positions(frame) @ gravity))
            momentum[frame] += weight @ speeds
    return VertexBooks(kinetic, height, momentum, mass)


def judge_growth(
    candidate: Candidate,
    energy: F64,
    scale: float,
    what: str,
    *hints: Correction,
    more: str = "",
    evidence: dict[str, Any] | None = None,
) -> Finding:
    """The finding about an energy that must not grow by more than `limits.energy_growth`, counted from the lowest so far.

    Args:
        candidate: what is judged.
        energy: less all that was given from outside [J], shape (F,).
        scale: the energy in play [J].
        what: begins the sentence.
        hints: corrections of its rows.
        more: ends the sentence.
        evidence: further evidence.
    """
    bound = candidate.spec.simulation.limits.energy_growth
    growth = energy - np.minimum.accumulate(energy)
    share = float(growth.max() / scale)
    text = f"{what} rises by at most {growth.max():.3g} J, {share:.2%} of the {scale:.3g} J in play{more}"
    known = {"scale_J": scale, "start_J": float(energy[0]), "end_J": float(energy[-1]), **(evidence or {})}
    return judge_frames(growth > bound * scale, text, share, bound, *hints, evidence=known)

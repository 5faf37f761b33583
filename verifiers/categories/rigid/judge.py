"""Rigid bodies as the other verifiers ask for them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...ledgers import motion
from ...ledgers.exchanged import CHANNEL, partners
from ..judge import TOLD, Judge, Push, Tie, stored
from .check import category_rows
from .links import contact_pushes, owners, ties
from .numerical import numerical_rows
from .register import rigid_lines

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ....worlds.spec import WorldSpec

__all__ = ["RigidJudge"]


class RigidJudge(Judge):
    """Rigid bodies. Its logs of contacts tell of elastic bodies too, which move in the same instances."""

    name: ClassVar[str] = "rigid"
    in_fields: ClassVar[tuple[str, str] | None] = (
        "drag of field {0!r} on bodies acts at their centres of mass",
        "by the area of their convex hulls, without lift and without torque on what declares no lift",
    )

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return category_rows(candidate, solver)

    def numerical_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return numerical_rows(candidate, solver)

    def pushes(self, candidate: Candidate) -> list[list[Push]]:
        """Logged contacts."""
        return contact_pushes(candidate)

    def ties(self, spec: WorldSpec) -> list[Tie]:
        """By joints, springs and ropes."""
        return ties(spec)

    def mechanical_energy(self, candidate: Candidate, solver: str) -> F64 | None:
        """Energy of bodies, computed from their motion where nothing stores any in springs, less the work of drivers [J]."""
        joints = candidate.spec.simulation.joints.values()
        if any(j.kind in ("spring", "rope") or getattr(j, "stiffness", 0.0) for j in joints):
            return super().mechanical_energy(candidate, solver)
        cache, frames = candidate.caches[solver], candidate.frame_count
        energy: F64 = motion.kinetic_energy(candidate, cache)[:frames].sum(axis=1)
        gravity = np.array(candidate.spec.simulation.gravity)
        for name in dict.fromkeys(owners(cache)):
            energy = energy - motion.entity_mass(candidate, name) * (motion.centers(candidate, name)[:frames] @ gravity)
        return stored(cache, frames, energy)

    def endings(self, candidate: Candidate, solver: str, span: int, kinetic: float) -> Iterator[tuple[str, str]]:
        """Bodies that still move at the last frame, and how they go on."""
        spec, last, cache = candidate.spec, candidate.last_frame, candidate.caches[solver]
        joined = {e for j in spec.simulation.joints.values() for e in (j.parent, j.child) if e}
        touched = _touched(cache, last - span + 1, last)
        carried = _carried(candidate, solver, last - span + 1)
        energy, bodies = motion.kinetic_energy(candidate, cache)[last], owners(cache)
        for name in dict.fromkeys(bodies):
            own = float(energy[[o == name for o in bodies]].sum())
            if own <= TOLD * kinetic or own <= 0.0:
                continue
            speed = float(np.linalg.norm(motion.velocities(candidate, name)[last]))
            spins = 0.5 * motion.entity_mass(candidate, name) * speed**2 < 0.5 * own
            yield (
                name,
                "swings or turns on" if name in joined
                else "spins on" if spins
                else "slides or rolls on" if name in touched
                else "drifts or floats on" if name in carried
                else "flies on",
            )  # fmt: skip

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return rigid_lines(candidate.spec)


def _carried(candidate: Candidate, solver: str, first: int) -> set[str]:
    """Entities that liquids, grains or cloth which are coupled both ways push at a frame or later."""
    if not partners(candidate.spec, solver):
        return set()
    cache = candidate.caches[solver]
    pushed = np.any(cache.series(CHANNEL)[first : candidate.frame_count] != 0.0, axis=(0, 2))
    return {name for name, felt in zip(owners(cache), pushed, strict=True) if felt}


def _touched(cache: Cache, first: int, last: int) -> set[str]:
    """Entities in contacts of some frames."""
    log = cache.ragged("contact/pair", "contact/impulse")
    return {cache.index.colliders[int(i)] for f in range(first, last + 1) for i in np.ravel(log[f]["contact/pair"])}

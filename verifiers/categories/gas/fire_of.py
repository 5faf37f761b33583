"""The fire of an entity: of a gas, all its flames; of a solid or of cloth, those that the gas which it gives off feeds at its surface (R100)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.gas.burning import flammable_parts
from .frames import box_of
from .predicates import moved_gas

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from .frames import GasBox
    from .kindled import KindledSurfaces

__all__ = ["Fire", "SolidFire", "fire_of"]

BESIDE = 3
"""[cells] Own choice: flames so near a piece of surface that gives off gas are at it; its gas is given to a cell within two."""


@dataclass(frozen=True)
class Fire:
    """Flames of a gas."""

    box: GasBox

    def power(self, first: int, last: int) -> F64:
        """Power of all flames at frames first..last [W]."""
        return np.array([self._kept(k) for k in range(first, last + 1)])

    def hottest(self, last: int) -> str:
        """Words that tell how near to burning it came by a frame; empty of a gas."""
        return ""

    def _kept(self, index: int) -> float:
        """Power at a frame; beats and those who look for causes ask again."""
        return self.box.candidate.memo((*self._whose, index), lambda: self._power(index))

    @property
    def _whose(self) -> tuple[str, ...]:
        return ("power of flames", self.box.solver)

    def _power(self, index: int) -> float:
        frame = self.box.read(index)
        if frame.fire is None:
            return 0.0
        return self.box.volume * float(np.sum(frame.fire.released * frame.room, dtype=np.float64))


@dataclass(frozen=True)
class SolidFire(Fire):
    """Flames of a solid."""

    surfaces: KindledSurfaces
    entity: str

    @property
    def _whose(self) -> tuple[str, ...]:
        return ("power of flames", self.box.solver, self.entity)

    def hottest(self, last: int) -> str:
        """Temperature of its hottest piece of surface by a frame, beside the one at which it gives off gas."""
        mine = np.array([p.entity == self.entity for p in self.surfaces.parts])[self.surfaces.part]
        most = max(float(s.temperature[mine].max()) for s in self.surfaces.state[: last + 1])
        least = float(self.surfaces.of("ignition")[mine].min())
        return (
            f"its hottest surface reached {most:.0f} K by frame {last} and gives off gas from {least:.0f} K on: bring it nearer to the flames, "
            "let them be larger, or simulate longer"
        )

    def _power(self, index: int) -> float:
        """Heat of the gas that it gave off over the frame before, as far as flames at its surface give as much."""
        box, surfaces = self.box, self.surfaces
        if index == 0 or box.combustion is None:
            return 0.0
        mine = np.array([p.entity == self.entity for p in surfaces.parts])[surfaces.part]
        given = np.where(mine, surfaces.giving(index), 0.0)
        frame = box.read(index)
        if frame.fire is None or not given.any():
            return 0.0
        about = surfaces.beside(frame, given > 0.0, BESIDE)
        flames = box.volume * float(np.sum((frame.fire.released * frame.room)[about], dtype=np.float64))
        return min(flames, box.combustion.fuel.heat * float(given.sum()) / box.duration)


def fire_of(candidate: Candidate, entity: str) -> Fire | str:
    """Fire of a gas or of a solid that may burn, or why there is none.

    Raises:
        EvidenceError: no such entity, or its gas has no cache.
    """
    for name in candidate.spec.simulation.gas:
        if entity in flammable_parts(candidate.spec, name):
            box = box_of(candidate, name)
            if box.surfaces is not None:
                return SolidFire(box, box.surfaces, entity)
    known = candidate.spec.entities.get(entity)
    if known is not None and known.physics.category != "gas":
        return (
            f"{entity!r} cannot burn: only rigid solids in one piece do, and cloth that a coupling joins to the gas, of a flammable material, in "
            f"the box of a gas with the same fuel; see /materials/{known.material}/flammable"
        )
    found = moved_gas(candidate, entity)
    if not isinstance(found, str) and found.combustion is None:
        return f"{entity!r} has no fuel: nothing of it burns; give it one with /entities/{entity}/physics/fuel"
    return found if isinstance(found, str) else Fire(found)

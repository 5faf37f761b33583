"""Surfaces of solids that may burn, as a cache holds them (R100)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....physics.substances import air_density
from ....worlds.arrays import F64
from ....worlds.categories.gas.facts import flammable_parts
from ....worlds.errors import EvidenceError, NotFiniteError

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.categories.gas.models import Flammable

__all__ = ["KindledFrame", "KindledPart", "KindledSurfaces", "surfaces_of_box"]

WARMED = 1.0
"""[K] Own choice: less is what the sun's shade does."""
STEADY = ("burning_part", "burning_point", "burning_area")
STATE = ("burning_left", "burning_temperature", "burning_heat")


class KindledPart(NamedTuple):
    """A part that may burn, as the specification and its geometry have it."""

    entity: str
    part: str
    kind: Flammable
    area: float
    """Area of its surface [m^2]."""
    fuel: float
    """Mass that can become gas [kg]."""


@dataclass(frozen=True)
class KindledFrame:
    """State of all pieces of surface at one frame, shapes (n,)."""

    left: F64
    """Mass that can still become gas [kg/m^2]."""
    temperature: F64
    """[K]"""
    heat: F64
    """Below it above that at frame 0 [J/m^2]."""


class KindledSurfaces:
    """All pieces over the frames.

    Raises:
        EvidenceError: the cache has none, or they do not stay the same.
    """

    def __init__(self, parts: tuple[KindledPart, ...], cache: Cache, frames: int) -> None:
        self.parts, self.frames = parts, frames
        first = cache.read(0, (*STEADY, *STATE))
        self.part: NDArray[np.int64] = np.asarray(first["burning_part"], dtype=np.int64)
        """Number of the part of each piece, shape (n,)."""
        self.point: F64 = np.asarray(first["burning_point"], dtype=np.float64)
        """Middles [m], shape (n, 3)."""
        self.area: F64 = np.asarray(first["burning_area"], dtype=np.float64)
        """[m^2], shape (n,)."""
        if len(self.part) == 0 or not ((self.part >= 0) & (self.part < len(parts))).all():
            raise EvidenceError("pieces of surfaces that may burn belong to no part of the specification; bake again")
        self.state = [self._read(cache, first, k) for k in range(frames)]

    def _read(self, cache: Cache, first: dict[str, NDArray[np.float64]], index: int) -> KindledFrame:
        data = cache.read(index, (*STEADY, *STATE))
        if not all(np.array_equal(data[n], first[n]) for n in STEADY):
            raise EvidenceError(f"surfaces that may burn are others at frame {index} than at frame 0; bake again")
        state = [np.asarray(data[n], dtype=np.float64) for n in STATE]
        if not all(s.shape == self.area.shape for s in state):
            raise EvidenceError(f"surfaces that may burn have no state of each piece at frame {index}; bake again")
        if not all(np.isfinite(s).all() for s in state):
            raise NotFiniteError(f"state of surfaces that may burn is not finite at frame {index}; see numerical:finite")
        return KindledFrame(*state)

    def of(self, name: str) -> F64:
        """Burning of each piece: a field of its material, shape (n,)."""
        return np.array([getattr(p.kind, name) for p in self.parts], dtype=np.float64)[self.part]

    def lost(self, entity: str | None = None) -> F64:
        """Mass that has become gas since frame 0 [kg], of one entity or all, shape (frames,)."""
        mine = np.array([entity is None or p.entity == entity for p in self.parts])[self.part]
        held = np.array([float((s.left * self.area)[mine].sum()) for s in self.state])
        return np.asarray(held[0] - held)

    def warmed(self, now: int) -> list[str]:
        """Entities that got heat over the frame before one, a piece of which was warmed by `WARMED` since frame 0."""
        old, new = self.state[now - 1], self.state[now]
        gain = (new.heat - old.heat + self.of("gasification") * (old.left - new.left)) * self.area
        warm = new.temperature - self.state[0].temperature >= WARMED
        names = [p.entity for p in self.parts]
        total = np.bincount(self.part, gain, minlength=len(names))
        some = np.bincount(self.part, warm, minlength=len(names)) > 0
        return list(dict.fromkeys(n for n, heat, is_warm in zip(names, total, some, strict=True) if is_warm and heat > 0.0))

    def given(self) -> tuple[F64, F64]:
        """Mass [kg] and volume at the temperature of what gives it off [m^3] of all gas since frame 0, shapes (frames,)."""
        density = np.array([air_density(p.kind.ignition) for p in self.parts])[self.part]
        mass = np.array([((self.state[0].left - s.left) * self.area).sum() for s in self.state])
        volume = np.array([((self.state[0].left - s.left) * self.area / density).sum() for s in self.state])
        return mass, volume

    def giving(self, now: int) -> F64:
        """Mass that each piece gave over the frame before one [kg], shape (n,)."""
        return np.asarray((self.state[now - 1].left - self.state[now].left) * self.area)


def surfaces_of_box(candidate: Candidate, solver: str, cache: Cache, frames: int) -> KindledSurfaces | None:
    """Surfaces that may burn in the box of an instance; None where there are none."""
    parts = []
    for entity, named in flammable_parts(candidate.spec, solver).items():
        for name, kind in named.items():
            own = next(p for p in candidate.entity(entity).parts if p.part == name)
            corner = candidate.surface(entity, name, 0)[own.render.faces]
            across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
            volume = abs(float(np.einsum("ij,ij->", corner[:, 0] - corner[0, 0], across))) / 6.0
            fuel = (1.0 - kind.char) * candidate.spec.materials[own.material].density * volume
            parts.append(KindledPart(entity, name, kind, 0.5 * float(np.linalg.norm(across, axis=1).sum()), fuel))
    return KindledSurfaces(tuple(parts), cache, frames) if parts else None

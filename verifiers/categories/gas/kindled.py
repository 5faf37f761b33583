"""Surfaces of solids and cloth that may burn, as a cache holds them (R100)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....physics.substances import air_density
from ....worlds.arrays import F64
from ....worlds.categories.gas.burning import flammable_parts
from ....worlds.errors import EvidenceError, NotFiniteError
from .carried import Carried

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.categories.gas.models import Flammable
    from .cells import GasFrame, Mask

__all__ = ["KindledFrame", "KindledPart", "KindledSurfaces", "surfaces_of_box"]

TINY = 1e-300
WARMED = 1.0
"""[K] Own choice: less is what the sun's shade does."""
STEADY = ("burning_part", "burning_area")
STATE = ("burning_left", "burning_temperature", "burning_heat")
POINT = "burning_point"


class KindledPart(NamedTuple):
    """A part that may burn, as the specification and its geometry have it."""

    entity: str
    part: str
    kind: Flammable
    area: float
    """Area of its surface [m^2], of cloth at rest and of one side."""
    fuel: float
    """Mass that can become gas [kg]."""
    mass: float
    """All its mass [kg]."""
    thin: bool
    """It is cloth: of one temperature, met from both sides."""


@dataclass(frozen=True)
class KindledFrame:
    """State of all pieces of surface at one frame, shapes (n,)."""

    left: F64
    """Mass that can still become gas [kg/m^2]."""
    temperature: F64
    """[K]"""
    heat: F64
    """Below it above that at frame 0 [J/m^2]."""
    point: F64
    """Middle [m], shape (n, 3)."""


class KindledSurfaces:
    """All pieces over the frames.

    Raises:
        EvidenceError: the cache has none, or they do not stay the same.
    """

    def __init__(self, candidate: Candidate, parts: tuple[KindledPart, ...], cache: Cache, frames: int) -> None:
        self.candidate, self.parts, self.frames = candidate, parts, frames
        first = cache.read(0, (*STEADY, *STATE))
        self.part: NDArray[np.int64] = np.asarray(first["burning_part"], dtype=np.int64)
        """Number of the part of each piece, shape (n,)."""
        self.area: F64 = np.asarray(first["burning_area"], dtype=np.float64)
        """[m^2], shape (n,)."""
        if len(self.part) == 0 or not ((self.part >= 0) & (self.part < len(parts))).all():
            raise EvidenceError("pieces of surfaces that may burn belong to no part of the specification; bake again")
        self.state = [self._read(cache, first, k) for k in range(frames)]

    def _read(self, cache: Cache, first: dict[str, NDArray[np.float64]], index: int) -> KindledFrame:
        data = cache.read(index, (*STEADY, *STATE, POINT))
        if not all(np.array_equal(data[n], first[n]) for n in STEADY):
            raise EvidenceError(f"surfaces that may burn are others at frame {index} than at frame 0; bake again")
        state = [np.asarray(data[n], dtype=np.float64) for n in STATE]
        if not all(s.shape == self.area.shape for s in state):
            raise EvidenceError(f"surfaces that may burn have no state of each piece at frame {index}; bake again")
        point = np.asarray(data[POINT], dtype=np.float64)
        if point.shape != (len(self.area), 3):
            raise EvidenceError(f"surfaces that may burn have no place of each piece at frame {index}; bake again")
        if not all(np.isfinite(s).all() for s in (*state, point)):
            raise NotFiniteError(f"state of surfaces that may burn is not finite at frame {index}; see numerical:finite")
        left, temperature, heat = state
        return KindledFrame(left, temperature, heat, point)

    def of(self, name: str) -> F64:
        """Burning of each piece: a field of its material, shape (n,)."""
        return np.array([getattr(p.kind, name) for p in self.parts], dtype=np.float64)[self.part]

    @cached_property
    def thin(self) -> NDArray[np.bool_]:
        """True of pieces of cloth, shape (n,)."""
        return np.array([p.thin for p in self.parts])[self.part]

    @cached_property
    def carried(self) -> Carried:
        """Places at which pieces have to be, on their bodies and cloth."""
        names = [(p.entity, p.part) for p in self.parts]
        return Carried(self.candidate, names, self.part, [s.point for s in self.state])

    def share(self, entity: str) -> F64:
        """Share of the mass of an entity that can become gas which has, shape (frames,)."""
        fuel = sum(p.fuel for p in self.parts if p.entity == entity)
        return self.lost(entity) / max(fuel, TINY)

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

    def along(self, now: int, cell: float) -> list[F64]:
        """Places of all pieces over the frame before one, each (n, 3) [m], from that at its start to that at its end, at most a cell apart."""
        start, end = self.state[max(now - 1, 0)].point, self.state[now].point
        count = int(np.ceil(float(np.linalg.norm(end - start, axis=1).max(initial=0.0)) / cell - 1e-9))
        return [end] if count == 0 else [start + t * (end - start) for t in np.linspace(0.0, 1.0, count + 1)]

    def beside(self, frame: GasFrame, which: NDArray[np.bool_], reach: int) -> Mask:
        """Cells within so many of the places of some pieces over the frame before one, (n,) -> (nx, ny, nz)."""
        from scipy.ndimage import binary_dilation

        found = np.zeros(frame.room.shape, dtype=bool)
        if which.any():
            ways = np.concatenate([p[which] for p in self.along(frame.index, frame.cell)])
            at = np.floor((ways - frame.corner) / frame.cell).astype(np.int64)
            at = at[((at >= 0) & (at < np.array(found.shape))).all(axis=1)]
            found[tuple(at.T)] = True
        return np.asarray(binary_dilation(found, np.ones((3, 3, 3)), iterations=reach))

    def giving(self, now: int) -> F64:
        """Mass that each piece gave over the frame before one [kg], shape (n,)."""
        return np.asarray((self.state[now - 1].left - self.state[now].left) * self.area)


def surfaces_of_box(candidate: Candidate, solver: str, cache: Cache, frames: int) -> KindledSurfaces | None:
    """Surfaces that may burn in the box of an instance; None where there are none."""
    parts = [
        _part(candidate, entity, name, kind)
        for entity, named in flammable_parts(candidate.spec, solver).items()
        for name, kind in named.items()
    ]
    return KindledSurfaces(candidate, tuple(parts), cache, frames) if parts else None


def _part(candidate: Candidate, entity: str, name: str, kind: Flammable) -> KindledPart:
    """A part that may burn, with its area and mass as built."""
    own, physics = next(p for p in candidate.entity(entity).parts if p.part == name), candidate.spec.entities[entity].physics
    sheet = own.simulation if physics.category == "cloth" else None
    corner = own.render.vertices[own.render.faces] if sheet is None else sheet.vertices[sheet.faces]
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = 0.5 * float(np.linalg.norm(across, axis=1).sum())
    if physics.category == "cloth":
        mass = physics.area_density * area
    else:
        volume = abs(float(np.einsum("ij,ij->", corner[:, 0] - corner[0, 0], across))) / 6.0
        mass = candidate.spec.materials[own.material].density * volume
    return KindledPart(entity, name, kind, area, (1.0 - kind.char) * mass, mass, sheet is not None)

"""Loose matter of one entity, a liquid's particles or grains, as events that both have look at it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from .bounds import PACKING, SPREAD_CELL
from .liquid.told import liquid_or_none
from .particles.frames import swarm_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Granules", "Matter", "covered", "matter_of", "mean_depth"]


@dataclass(frozen=True)
class Granules:
    """Particles of an entity at a frame, in ascending order of their ids."""

    identity: NDArray[np.int64]
    position: F64
    """World [m], shape (n, 3)."""
    velocity: F64
    """[m/s], shape (n, 3)."""
    volume: F64
    """That each takes up, of grains with the gaps about it [m^3], shape (n,)."""


@dataclass(frozen=True)
class Matter:
    """Loose matter over the frames."""

    entity: str
    pitch: float
    """Distance of its particles [m]."""
    duration: float
    """Between frames [s]."""
    gravity: F64
    at: Callable[[int], Granules]
    """Its particles at a frame."""

    @property
    def up(self) -> F64:
        """Unit vector against gravity; +z where there is none."""
        size = float(np.linalg.norm(self.gravity))
        return -self.gravity / size if size > 1e-9 else np.array([0.0, 0.0, 1.0])


def covered(position: F64, up: F64, pitch: float) -> float:
    """Area of the squares seen from above that hold a particle [m^2].

    Args:
        position: of the particles [m], shape (n, 3).
        up: unit vector against gravity.
        pitch: distance of the particles [m].
    """
    return len(np.unique(_squares(position, up, pitch), axis=0)) * (SPREAD_CELL * pitch) ** 2


def mean_depth(position: F64, volume: F64, up: F64, pitch: float) -> float:
    """Depth of the matter at the place of the mean particle: volume over area of each square, weighted by the volumes [m]; 0 without any."""
    if not len(position):
        return 0.0
    _, square = np.unique(_squares(position, up, pitch), axis=0, return_inverse=True)
    held = np.bincount(square.ravel(), weights=volume)
    return float((held @ held) / held.sum()) / (SPREAD_CELL * pitch) ** 2


def _squares(position: F64, up: F64, pitch: float) -> F64:
    """Square that each particle is in, seen from above, shape (n, 2)."""
    flat = np.eye(3)[np.argsort(np.abs(up))[:2]]
    squares: F64 = np.floor(position @ (flat - np.outer(flat @ up, up)).T / (SPREAD_CELL * pitch))
    return squares


def matter_of(candidate: Candidate, entity: str) -> Matter | str:
    """Particles of a liquid or of grains that an engine moved, or why there are none.

    Raises:
        EvidenceError: no such entity, or it has no cache.
    """
    known = candidate.spec.entities.get(entity)
    if known is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    return _grains(candidate, entity) if known.physics.category == "particles" else _liquid(candidate, entity)


def _liquid(candidate: Candidate, entity: str) -> Matter | str:
    found = liquid_or_none(candidate, entity)
    if isinstance(found, str):
        return found
    liquid, member = found

    def at(index: int) -> Granules:
        frame = liquid.read(index)
        own = frame.fluid == member
        return Granules(frame.identity[own], frame.position[own], frame.velocity[own], frame.volume[own])

    return Matter(entity, liquid.pitch, liquid.duration, liquid.gravity, at)


def _grains(candidate: Candidate, entity: str) -> Matter | str:
    solver = next((n for n, s in candidate.spec.simulation.particles.items() if entity in s.members), None)
    if solver is None:
        return f"{entity!r} is no evidence of particles: no engine moves them; make it a member of a dem or ballistic instance"
    swarm = swarm_of(candidate, solver)
    member = swarm.members.index(entity)

    def at(index: int) -> Granules:
        frame = swarm.read(index)
        own = np.flatnonzero(frame.member == member)
        own = own[np.argsort(frame.identity[own], kind="stable")]
        volume = 4.0 / 3.0 * np.pi * frame.radius[own] ** 3 / PACKING
        return Granules(frame.identity[own].astype(np.int64), frame.position[own], frame.velocity[own], volume)

    radius = next((float(f.radius.mean()) for f in map(swarm.read, range(swarm.frames)) if f.count), swarm.radius)
    return Matter(entity, 2.0 * radius, swarm.duration, swarm.gravity, at)

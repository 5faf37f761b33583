"""Matter that is many particles: how it moves as a whole, and how its judge asks for it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.categories.loose import domain_box
from ...worlds.channels import CHANNELS
from ...worlds.errors import EvidenceError
from ...worlds.spec import ClothInstance, RigidInstance
from ..ledgers.origins import Origin
from .judge import Flags, Judge
from .pushes import givers_of

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.spec import SolverInstance

__all__ = ["Loose", "Moments", "Sample"]

REACTION = "exchange/reaction"


class Sample(NamedTuple):
    """The particles of one entity at a frame."""

    position: F64
    """World [m], shape (n, 3)."""
    velocity: F64
    """[m/s], shape (n, 3)."""
    mass: F64
    """[kg], shape (n,)."""


@dataclass(frozen=True)
class Moments:
    """Motion of an entity of many particles as a whole."""

    mass: F64
    """[kg], shape (frames,)."""
    center: F64
    """Centre of mass [m], shape (frames, 3); NaN where nothing is there."""
    momentum: F64
    """[N s], shape (frames, 3)."""
    speed: F64
    """Root mean square speed [m/s], shape (frames,); 0 where nothing is there."""


def moments(frames: int, samples: Iterable[Sample]) -> Moments:
    """Sums over the particles of every frame."""
    mass, speed = np.zeros((2, frames))
    center, momentum = np.full((frames, 3), np.nan), np.zeros((frames, 3))
    for k, (position, velocity, weight) in enumerate(samples):
        mass[k] = total = weight.sum()
        if total > 0.0:
            center[k] = weight @ position / total
            momentum[k] = weight @ velocity
            # Component by component: sums over an axis of three are slow.
            x, y, z = (velocity[:, a] for a in range(3))
            speed[k] = np.sqrt(weight @ (x * x + y * y + z * z) / total)
    return Moments(mass, center, momentum, speed)


class Loose(Judge):
    """Base of the judges of matter that is many particles."""

    noun: ClassVar[str] = "loose matter"
    still: ClassVar[float]
    """[m/s] Root mean square speed up to which it counts as still."""

    def sample(self, candidate: Candidate, solver: str, row: int, frame: int) -> Sample:
        """Particles of one member of an instance at a frame."""
        raise NotImplementedError

    def samples(self, candidate: Candidate, solver: str, row: int) -> Iterable[Sample]:
        """Particles of one member of an instance at every frame."""
        return (self.sample(candidate, solver, row, frame) for frame in range(candidate.frame_count))

    def held(self, candidate: Candidate, entity: str) -> tuple[str, Cache, int]:
        """Instance and cache that hold an entity, and its row among the members.

        Raises:
            EvidenceError: none does.
        """
        for solver, cache in self.caches(candidate).items():
            if entity in cache.index.bodies:
                return solver, cache, cache.index.bodies.index(entity)
        raise EvidenceError(f"no cache holds {entity!r} ({self.name}); list it as a member of an instance that moves it and bake")

    def moments(self, candidate: Candidate, entity: str) -> Moments:
        """Motion of the entity as a whole, worked out once per candidate.

        Raises:
            EvidenceError: no cache holds it.
        """
        solver, _, row = self.held(candidate, entity)
        return candidate.memo(("moments", entity), lambda: moments(candidate.frame_count, self.samples(candidate, solver, row)))

    def known(self, candidate: Candidate, entity: str) -> bool:
        """Always: without a cache its motion is missing evidence, not rest."""
        return True

    def centers(self, candidate: Candidate, entity: str) -> F64:
        """Centre of mass of what is there [m], shape (frames, 3); NaN where nothing is. Before any simulation, of its declared volume."""
        if candidate.stage == "static":
            return super().centers(candidate, entity)
        return self.moments(candidate, entity).center

    def mass(self, candidate: Candidate, entity: str) -> F64:
        """Mass of what is there [kg], shape (frames,)."""
        return self.moments(candidate, entity).mass

    def momentum(self, candidate: Candidate, entity: str) -> F64:
        """Momentum [N s], shape (frames, 3)."""
        return self.moments(candidate, entity).momentum

    def amount(self, candidate: Candidate, entity: str) -> str:
        """Volume at rest density at the first and, where it differs by a hundredth, at the last frame."""
        density = candidate.spec.materials[candidate.spec.entities[entity].material].density
        mass = self.mass(candidate, entity) if candidate.stage != "static" else super().mass(candidate, entity)
        first, last = (1000.0 * float(m) / density for m in mass[[0, -1]])
        return f"{first:.3g} litres" + (f", {last:.3g} at the end" if abs(last - first) > 0.01 * max(first, last) else "")

    def velocities(self, candidate: Candidate, entity: str) -> F64:
        """Velocity of the centre of mass of what is there [m/s], shape (frames, 3); NaN where nothing is."""
        found = self.moments(candidate, entity)
        return found.momentum / np.where(found.mass > 0.0, found.mass, np.nan)[:, None]

    def givers(self, candidate: Candidate, entity: str) -> dict[Origin, F64]:
        """Impulses of bodies and fields, where the instance has no other member; what several share, no record tells apart."""
        solver, cache, _ = self.held(candidate, entity)
        if len(cache.index.bodies) > 1 or self.name not in CHANNELS[REACTION].of:
            return {}
        return givers_of(candidate, cache, REACTION, self.blown(candidate, solver))

    def blown(self, candidate: Candidate, solver: str) -> F64 | None:
        """Impulse of force fields on all members over each frame [N s], shape (frames, 3); None where none acts or no record tells."""
        return None

    def moving(self, candidate: Candidate, entity: str) -> Flags:
        """True where it is not still, shape (frames,)."""
        return np.asarray(~(self.moments(candidate, entity).speed <= self.still))

    def domain(self, instance: SolverInstance) -> tuple[F64, F64] | None:
        """Least and greatest corner of the domain of an instance [m]."""
        assert not isinstance(instance, RigidInstance | ClothInstance)
        return domain_box(instance)

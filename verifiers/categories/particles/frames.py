"""Particles of an instance as its cache holds them, checked as they are read (R65)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, I32
from ....worlds.categories.loose import domain_box
from ....worlds.errors import EvidenceError, NotFiniteError
from ...rows.findings import cache_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.spec import ParticlePhysics

__all__ = ["Swarm", "SwarmFrame", "matched", "swarm_of"]

Rows: TypeAlias = NDArray[np.intp]

CHANNELS = ("origin", *(f"particle/{n}" for n in ("position", "velocity", "spin", "id", "member", "radius")))
EXCHANGE = ("exchange/impulse", "exchange/reaction", "field/impulse", "outflow/momentum")
KEPT_PARTICLES = 4_000_000
"""Particles of frames that are kept, since predicates ask again."""


@dataclass(frozen=True)
class SwarmFrame:
    """All particles of one frame."""

    index: int
    position: F64
    """World [m], shape (n, 3)."""
    velocity: F64
    spin: F64
    identity: I32
    member: I32
    radius: F64
    mass: F64
    """[kg], by radius and the material's density."""

    @property
    def count(self) -> int:
        """Number of particles."""
        return len(self.radius)


def matched(now: SwarmFrame, before: SwarmFrame) -> tuple[Rows, Rows]:
    """Rows of particles that are in both frames, in each; of an id that stands twice, the first."""
    _, here, there = np.intersect1d(now.identity, before.identity, return_indices=True)
    return here, there


class Swarm:
    """One instance over its frames."""

    def __init__(self, candidate: Candidate, solver: str, cache: Cache) -> None:
        spec = candidate.spec
        self.candidate, self.solver, self.cache = candidate, solver, cache
        self.plan = spec.simulation.particles[solver]
        self.members = tuple(self.plan.members)
        if tuple(cache.index.bodies) != self.members:
            raise EvidenceError(
                f"the cache of {solver!r} holds {list(cache.index.bodies)[:3]}, planned {list(self.members)[:3]}; bake again"
            )
        self.frames = min(cache.index.frames, candidate.frame_count)
        self.duration = 1.0 / spec.simulation.fps
        self.gravity: F64 = np.array(spec.simulation.gravity, dtype=np.float64)
        self.density: F64 = np.array([spec.materials[spec.entities[m].material].density for m in self.members])
        self.lower, self.upper = domain_box(self.plan)
        self._kept: dict[int, SwarmFrame] = {}
        self._room = KEPT_PARTICLES

    @property
    def granular(self) -> bool:
        """True if its particles touch each other."""
        return self.plan.engine == "dem"

    def physics(self, row: int) -> ParticlePhysics:
        """Physics of a member."""
        found: ParticlePhysics = self.candidate.spec.entities[self.members[row]].physics  # type: ignore[assignment]
        return found

    @cached_property
    def radius(self) -> float:
        """Mean radius of the finest member [m]."""
        return min(self.physics(k).radius for k in range(len(self.members)))

    def read(self, index: int) -> SwarmFrame:
        """One frame.

        Raises:
            EvidenceError: it is missing or damaged, or its channels do not belong together.
        """
        if index not in self._kept:
            frame = self._read(index)
            self._room -= frame.count
            if self._room < 0:
                return frame
            self._kept[index] = frame
        return self._kept[index]

    def _read(self, index: int) -> SwarmFrame:
        data = self.cache.read(index, CHANNELS)
        n = len(data["particle/id"])
        for name, width in (("position", 3), ("velocity", 3), ("spin", 3), ("member", 0), ("radius", 0)):
            found = data[f"particle/{name}"]
            if found.shape != ((n, width) if width else (n,)):
                raise EvidenceError(f"particle/{name} of frame {index} of {self.solver!r} has shape {found.shape}; bake again")
            if found.dtype.kind == "f" and not np.isfinite(found).all():
                raise NotFiniteError(f"particle/{name} is not finite at frame {index}; see numerical:finite")
        member = data["particle/member"].astype(np.int32)
        if n and not (member.min() >= 0 and member.max() < len(self.members)):
            raise EvidenceError(
                f"particle/member of frame {index} of {self.solver!r} names a member that the index has not; bake again"
            )
        radius = data["particle/radius"].astype(np.float64)
        return SwarmFrame(
            index,
            data["origin"] + data["particle/position"].astype(np.float64),
            data["particle/velocity"].astype(np.float64),
            data["particle/spin"].astype(np.float64),
            data["particle/id"].astype(np.int32),
            member,
            radius,
            4.0 / 3.0 * np.pi * self.density[member] * radius**3,
        )

    def steps(self) -> Iterator[tuple[SwarmFrame, SwarmFrame | None]]:
        """All frames in order, each with the one before."""
        before: SwarmFrame | None = None
        for index in range(self.frames):
            now = self.read(index)
            yield now, before
            before = now

    def exchange(self, index: int) -> dict[str, Any]:
        """Impulses to bodies and from fields, and momentum of the outflow, over the frame [N s], by channel."""
        data = self.cache.read(index, EXCHANGE)
        b, m = len(self.cache.index.colliders), len(self.members)
        wanted = {"exchange/impulse": (b, 6), "exchange/reaction": (b, 6), "field/impulse": (m, 3), "outflow/momentum": (3,)}
        for name, shape in wanted.items():
            if data[name].shape != shape or not np.isfinite(data[name]).all():
                raise EvidenceError(
                    f"{name} of {self.solver!r} has shape {data[name].shape} at frame {index} or is not finite; bake again"
                )
        return data

    def record(self, name: str) -> F64:
        """A record over the frames, shape (frames,)."""
        return np.asarray(self.cache.series(f"record/{name}"), dtype=np.float64)[: self.frames]


def swarm_of(candidate: Candidate, solver: str) -> Swarm:
    """The particles of an instance, made once per candidate.

    Raises:
        EvidenceError: it has no cache, or one of another specification.
    """
    return candidate.memo(("swarm", solver), lambda: Swarm(candidate, solver, cache_of(candidate, solver)))

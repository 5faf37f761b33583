"""Bodies of a rigid instance over its frames: poses, momenta, energies, summed per entity, from poses, velocities and built masses."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.errors import EvidenceError

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate

__all__ = ["BodyBooks", "Flags"]

Flags = NDArray[np.bool_]
CHANNELS = (
    *("position", "quaternion", "velocity", "angular_velocity", "asleep"),
    *("contact/pair", "contact/impulse", "contact/vector"),
    *("event/time", "event/pair", "event/point", "event/speed"),
    *(f"record/{n}" for n in ("kinetic_energy", "potential_energy", "momentum_x", "momentum_y", "momentum_z", "driver_work")),
    *(f"record/{n}" for n in ("max_speed", "max_travel_per_step", "step", "joint_error")),
)
"""Channels that the laws read; all are taken from a frame's container at once."""


class BodyBooks:
    """Motion of one instance. Axes: frames F, bodies n, moving entities E."""

    def __init__(self, candidate: Candidate, cache: Cache) -> None:
        self.candidate, self.cache = candidate, cache
        spec, index = candidate.spec, cache.index
        if index.solver not in spec.simulation.rigid:
            raise EvidenceError(f"the cache is of instance {index.solver!r}, which is not planned; bake again")
        self.frames = index.frames
        self.duration = 1.0 / spec.simulation.fps
        self.step = spec.simulation.rigid[index.solver].settings.step
        self.gravity: F64 = np.array(spec.simulation.gravity, dtype=np.float64)
        self.entities = tuple(dict.fromkeys(b.split("/", 1)[0] for b in index.bodies))
        """Moving entities in the order of the cache."""
        self.row = {name: i for i, name in enumerate(self.entities)}
        unknown = [n for n in self.entities if n not in spec.entities]
        if unknown or not self.entities:
            raise EvidenceError(
                f"cache {index.solver!r} moves {unknown[0]!r}, which is not planned" if unknown else "no body moves"
            )
        self.owner = np.array([self.row[b.split("/", 1)[0]] for b in index.bodies], dtype=np.int64)
        bodies = [candidate.body(*b.split("/", 1)) for b in index.bodies]
        self.body_mass: F64 = np.array([b.mass for b in bodies])
        self.inertia: F64 = np.array([b.inertia for b in bodies])
        self.offset: F64 = np.array([b.center for b in bodies])
        self.position, self.quaternion, self.velocity, self.spin = (
            self._channel(n, w) for n, w in (("position", 3), ("quaternion", 4), ("velocity", 3), ("angular_velocity", 3))
        )
        self.asleep: Flags = np.asarray(self.series("asleep")).astype(bool)
        self.stirred: Flags = np.asarray(self.series("asleep")) == 2
        """Asleep, but awake at some time since the frame before."""
        if self.asleep.shape != (self.frames, len(self.owner)):
            raise EvidenceError(f"channel 'asleep' has shape {self.asleep.shape}, not {(self.frames, len(self.owner))}")
        self.kinematic: Flags = np.array([spec.entities[n].motion == "kinematic" for n in self.entities])
        self.single: Flags = np.bincount(self.owner, minlength=len(self.entities)) == 1
        """Entities of one body."""
        self.first = np.array([int(np.argmax(self.owner == i)) for i in range(len(self.entities))])
        """First body of each entity."""

    def _channel(self, name: str, width: int) -> F64:
        series: F64 = np.asarray(self.series(name), dtype=np.float64)
        if series.shape != (self.frames, len(self.owner), width):
            raise EvidenceError(f"channel {name!r} has shape {series.shape}, not {(self.frames, len(self.owner), width)}")
        if not np.isfinite(series).all():
            bad = int(np.argmin(np.isfinite(series).all(axis=(1, 2))))
            raise EvidenceError(f"channel {name!r} is not finite at frame {bad}; see numerical:finite")
        return series

    @cached_property
    def _read(self) -> list[dict[str, Any]] | None:
        """All channels of every frame; None where one is missing, so that each asks for its own."""
        try:
            return self.cache.ragged(*CHANNELS)
        except EvidenceError:
            return None

    def ragged(self, *names: str) -> list[dict[str, Any]]:
        """Channels of varying length, one dict per frame."""
        return self.cache.ragged(*names) if self._read is None else self._read

    def series(self, name: str) -> Any:
        """One channel over all frames, stacked: shape (F, ...).

        Raises:
            EvidenceError: it is missing, or its shape changes.
        """
        if self._read is None:
            return self.cache.series(name)
        try:
            return np.stack([frame[name] for frame in self._read])
        except ValueError as error:
            raise EvidenceError(f"channel {name!r} changes its shape: {error}; see numerical:counts") from error

    def record(self, name: str) -> F64:
        """One record over all frames, shape (F,)."""
        return np.asarray(self.series(f"record/{name}"), dtype=np.float64)

    # ---------------------------------------------------------------- sums over bodies

    def per_entity(self, values: F64) -> F64:
        """Sum of a quantity over the bodies of each entity, shape (F, n, ...) -> (F, E, ...)."""
        result = np.zeros((len(values), len(self.entities), *values.shape[2:]))
        np.add.at(np.moveaxis(result, 1, 0), self.owner, np.moveaxis(values, 1, 0))
        return result

    @cached_property
    def mass(self) -> F64:
        """Mass of each entity [kg], shape (E,)."""
        return np.bincount(self.owner, weights=self.body_mass, minlength=len(self.entities)).astype(np.float64)

    @cached_property
    def turns(self) -> F64:
        """Orientation of every body, shape (F, n, 3, 3)."""
        return rotation_matrix(self.quaternion)

    @cached_property
    def body_centers(self) -> F64:
        """Centres of mass of the bodies [m], shape (F, n, 3)."""
        result: F64 = self.position + np.einsum("fnij,nj->fni", self.turns, self.offset)
        return result

    @cached_property
    def centers(self) -> F64:
        """Centres of mass of the entities [m], shape (F, E, 3)."""
        result: F64 = self.per_entity(self.body_centers * self.body_mass[:, None]) / self.mass[:, None]
        return result

    @cached_property
    def velocities(self) -> F64:
        """Velocities of the entities' centres of mass [m/s], shape (F, E, 3)."""
        return self.momentum / self.mass[:, None]

    @cached_property
    def momentum(self) -> F64:
        """Linear momentum [N s], shape (F, E, 3)."""
        return self.per_entity(self.velocity * self.body_mass[:, None])

    @cached_property
    def body_spin(self) -> F64:
        """Angular momentum of each body about its own centre [N m s], shape (F, n, 3)."""
        local = np.einsum("fnji,fnj->fni", self.turns, self.spin)
        result: F64 = np.einsum("fnij,njk,fnk->fni", self.turns, self.inertia, local, optimize=True)
        return result

    @cached_property
    def angular_momentum(self) -> F64:
        """Angular momentum of each entity about its own centre of mass [N m s], shape (F, E, 3)."""
        arm = self.body_centers - self.centers[:, self.owner]
        moving = self.velocity - self.velocities[:, self.owner]
        return self.per_entity(self.body_spin + np.cross(arm, moving) * self.body_mass[:, None])

    @cached_property
    def kinetic(self) -> F64:
        """Kinetic energy [J], shape (F, E)."""
        energy = 0.5 * self.body_mass * np.sum(self.velocity**2, axis=2) + 0.5 * np.sum(self.spin * self.body_spin, axis=2)
        return self.per_entity(energy)

    @cached_property
    def potential(self) -> F64:
        """Potential energy of gravity [J], shape (F, E)."""
        result: F64 = -self.mass * (self.centers @ self.gravity)
        return result

    @cached_property
    def times(self) -> F64:
        """[s], shape (F,)."""
        return np.arange(self.frames, dtype=np.float64) * self.duration

    @cached_property
    def body_reach(self) -> F64:
        """Farthest point of each body from its centre of mass [m], shape (n,)."""
        found = []
        for name in self.cache.index.bodies:
            entity, body = name.split("/", 1)
            center = self.candidate.body(entity, body).center
            far = [np.linalg.norm(p.render.vertices - center, axis=1).max() for p in self.candidate.entity(entity).parts_of(body)]
            found.append(max(far, default=0.0))
        return np.maximum(np.array(found, dtype=np.float64), 1e-9)

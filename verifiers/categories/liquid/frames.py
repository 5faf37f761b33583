"""The frames of a liquid instance as its judge reads them: particles in the world, matched from frame to frame by their ids.

Everything is read from the cache (`worlds/cache.py`) and the specification; no solver is asked. Frames are read one by one, so
that a bake of any size is judged with two of them in memory.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, pose_of, rotation_matrix
from ....worlds.categories.liquid.facts import spacing_of
from ....worlds.categories.loose import domain_box
from ....worlds.errors import EvidenceError
from ....worlds.fields import fields_of
from ....worlds.spec import InflowDriver, LiquidPhysics, OutflowDriver
from ....worlds.waves import waves_of
from ...rows.findings import cache_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.spec import LiquidInstance

__all__ = ["SIDES", "Frame", "Liquid", "Rows", "Step", "liquid_of"]

Rows = NDArray[np.intp]
SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")
"""Order of `settings.domain.sides`."""
CHANNELS = ("origin", "particle/position", "particle/velocity", "particle/id", "particle/fluid", "particle/volume")
"""Channels that every row needs."""


KEPT_BYTES = 200_000_000
"""Frames are kept in memory up to this size."""
FRAME_COST = 200
"""Bytes that a particle takes in one frame."""


@dataclass(frozen=True)
class Frame:
    """One frame; particles in ascending order of their ids, those that are not finite left out."""

    index: int
    position: F64
    """World [m], shape (n, 3)."""
    velocity: F64
    """[m/s], shape (n, 3)."""
    identity: NDArray[np.int64]
    fluid: NDArray[np.int64]
    """Index into the members, shape (n,)."""
    volume: F64
    """At rest density [m^3], shape (n,)."""
    mass: F64
    """[kg], shape (n,)."""
    density: F64
    """As recorded [kg/m^3], shape (n,); NaN where the cache has none."""
    others: Mapping[str, Any] = field(repr=False, default_factory=dict)
    """All channels as they stand in the container."""
    broken: int = 0
    """Particles with a coordinate, velocity or volume that is not finite."""
    repeated: int = 0
    """Ids that more than one particle has."""

    @property
    def count(self) -> int:
        """Particles."""
        return len(self.identity)

    @cached_property
    def squared(self) -> F64:
        """Square of the speed [m^2/s^2], shape (n,)."""
        return np.asarray(np.einsum("ij,ij->i", self.velocity, self.velocity))

    @cached_property
    def speed(self) -> F64:
        """[m/s], shape (n,)."""
        return np.sqrt(self.squared)

    @property
    def fastest(self) -> float:
        """Speed of the fastest particle [m/s]; 0 where there is none."""
        return float(np.sqrt(self.squared.max(initial=0.0)))


@dataclass(frozen=True)
class Step:
    """A frame, the one before it, and which particles are in both."""

    liquid: Liquid
    now: Frame
    before: Frame | None
    here: Rows
    """Rows of `now` that were there before."""
    there: Rows
    """Their rows of `before`."""
    new: Rows
    """Rows of `now` without a past."""
    gone: Rows
    """Rows of `before` without a future."""

    @property
    def duration(self) -> float:
        """[s]"""
        return self.liquid.duration


class Liquid:
    """One liquid instance: what was planned for it, and its frames."""

    def __init__(self, candidate: Candidate, solver: str, cache: Cache) -> None:
        self.candidate, self.solver, self.cache = candidate, solver, cache
        self._kept: dict[int, Frame] = {}
        self._room = KEPT_BYTES
        spec = candidate.spec
        self.plan: LiquidInstance = spec.simulation.liquid[solver]
        self.members = tuple(cache.index.bodies)
        alien = [m for m in self.members if m not in spec.entities or not isinstance(spec.entities[m].physics, LiquidPhysics)]
        if alien or not self.members:
            raise EvidenceError(
                f"the cache of {solver!r} holds {alien[:3] or 'no liquid'}, which is no liquid of the plan; bake again"
            )
        self.frames = min(cache.index.frames, candidate.frame_count)
        self.duration = 1.0 / spec.simulation.fps
        self.gravity: F64 = np.array(spec.simulation.gravity, dtype=np.float64)
        self.rest_density: F64 = np.array([spec.materials[spec.entities[m].material].density for m in self.members])
        """[kg/m^3], one per member."""
        self.spacing = spacing_of(spec, solver)
        """Distance of particles at rest, or size of a cell [m]."""
        self.lower, self.upper = domain_box(self.plan)
        """Corners of the domain [m]."""
        self.closed = tuple(s == "closed" for s in self.plan.settings.domain.sides)
        """Which sides hold the liquid, in the order of SIDES."""
        self.drivers = tuple(cache.index.drivers)
        self.inflows = {
            n: d for n, d in spec.simulation.drivers.items() if isinstance(d, InflowDriver) and d.entity in self.members
        }
        self.waves = waves_of(spec, solver)
        """Declared seas, by driver."""
        found = tuple(fields_of(spec, m) for m in self.members)
        self.fields = found if any(found) else ()
        """Force fields on each member, or none at all."""
        self.outflows = {
            n: d for n, d in spec.simulation.drivers.items() if isinstance(d, OutflowDriver) and d.entity in self.members
        }

    def physics(self, member: str) -> LiquidPhysics:
        """Contract of a member."""
        physics = self.candidate.spec.entities[member].physics
        assert isinstance(physics, LiquidPhysics)
        return physics

    def switches(self, index: int) -> bool:
        """True if a field begins, reaches its strength or ends within the interval that ends at a frame."""
        last, now = (index - 1) * self.duration, index * self.duration
        times = [t for f in self.fields for d in f.drivers for t in (d.start, d.start + d.rise, d.end) if t is not None]
        return any(last + 1e-9 < t < now - 1e-9 for t in times)

    def pull(self, frame: Frame, *, ending: bool = False) -> F64:
        """Acceleration of attracting fields at the particles of a frame [m/s^2], shape (n, 3).

        Args:
            frame: where the particles are.
            ending: just before the frame's time, not from it on.
        """
        time = max(frame.index * self.duration - (1e-9 if ending else 0.0), 0.0)
        found: F64 = np.zeros((frame.count, 3))
        for member, fields in enumerate(self.fields):
            rows = np.flatnonzero(frame.fluid == member)
            found[rows] = fields.acceleration(frame.position[rows], time)
        return found

    def air(self, frame: Frame) -> tuple[F64, NDArray[np.bool_]]:
        """Velocity of the medium at the particles of a frame [m/s], shape (n, 3), and where there is any, shape (n,)."""
        velocity, there = np.zeros((frame.count, 3)), np.zeros(frame.count, dtype=bool)
        for member, fields in enumerate(self.fields):
            if fields.has_medium:
                rows = np.flatnonzero(frame.fluid == member)
                medium = fields.medium(frame.position[rows], frame.index * self.duration)
                velocity[rows], there[rows] = medium.velocity, medium.density > 0
        return velocity, there

    @property
    def attracted(self) -> bool:
        """True if a field of the plan accelerates any of it."""
        return any(d.field.kind == "attraction" for f in self.fields for d in f.drivers)

    @cached_property
    def strength(self) -> float:
        """Strength of gravity [m/s^2]."""
        return float(np.linalg.norm(self.gravity))

    @cached_property
    def up(self) -> F64:
        """Unit vector against gravity, shape (3,); +z where there is none."""
        return -self.gravity / self.strength if self.strength > 1e-9 else np.array([0.0, 0.0, 1.0])

    @cached_property
    def pitch(self) -> float:
        """Distance of particles [m]: the cube root of their mean volume at frame 0 (a grid engine has several in a cell)."""
        frame = next((f for f in map(self.read, range(self.frames)) if f.count), None)
        return self.spacing if frame is None else float(np.cbrt(frame.volume.mean()))

    @cached_property
    def extent(self) -> tuple[F64, F64]:
        """Least and greatest corner of where its particles are at all frames [m]; not finite where there are none."""
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for index in range(self.frames):
            held = self.cache.read(index, ("origin", "particle/position"))
            points = held["particle/position"]
            points = points[np.isfinite(points).all(axis=1)]
            if len(points):
                low, high = (
                    np.minimum(low, points.min(axis=0) + held["origin"]),
                    np.maximum(high, points.max(axis=0) + held["origin"]),
                )
        return low, high

    def read(self, index: int) -> Frame:
        """One frame; small caches are kept, since predicates ask again.

        Raises:
            EvidenceError: it is missing or damaged, or lacks a channel that every row needs.
        """
        if index not in self._kept:
            frame = self._read(index)
            self._room -= FRAME_COST * frame.count
            if self._room < 0:
                return frame
            self._kept[index] = frame
        return self._kept[index]

    def _read(self, index: int) -> Frame:
        held = self.cache.read(index)
        missing = [n for n in CHANNELS if n not in held]
        if missing:
            raise EvidenceError(f"frame {index} of {self.solver!r} lacks {', '.join(missing)}; bake again")
        position = np.asarray(held["particle/position"], dtype=np.float64).reshape(-1, 3) + np.asarray(held["origin"])
        count = len(position)
        velocity = np.asarray(held["particle/velocity"], dtype=np.float64)
        numbers = {n: np.asarray(held[f"particle/{n}"]) for n in ("id", "fluid", "volume")}
        if velocity.shape != (count, 3) or any(len(v) != count for v in numbers.values()):
            raise EvidenceError(f"particle channels of frame {index} of {self.solver!r} have different lengths; bake again")
        fluid, volume = numbers["fluid"].astype(np.int64), numbers["volume"].astype(np.float64)
        if count and not (fluid.min() >= 0 and fluid.max() < len(self.members)):
            raise EvidenceError(
                f"particle/fluid of frame {index} of {self.solver!r} names a liquid that the index has not; bake again"
            )
        density = np.asarray(held.get("particle/density", np.full(count, np.nan)), dtype=np.float64)
        good = np.isfinite(position).all(axis=1) & np.isfinite(velocity).all(axis=1) & np.isfinite(volume)
        order = np.flatnonzero(good)[np.argsort(numbers["id"][good], kind="stable")]
        identity = numbers["id"].astype(np.int64)[order]
        first = np.concatenate([[True], np.diff(identity) > 0])[: len(identity)]
        keep = order[first]
        return Frame(
            index, position[keep], velocity[keep], identity[first], fluid[keep], volume[keep],
            volume[keep] * self.rest_density[fluid[keep]], density[keep], held, int((~good).sum()), int((~first).sum()),
        )  # fmt: skip

    def steps(self) -> Iterator[Step]:
        """All frames in order, each matched with the one before."""
        before: Frame | None = None
        for index in range(self.frames):
            now = self.read(index)
            if before is None:
                nothing = np.zeros(0, dtype=np.intp)
                yield Step(self, now, None, nothing, nothing, np.arange(now.count), nothing)
            else:
                _, here, there = np.intersect1d(now.identity, before.identity, assume_unique=True, return_indices=True)
                new, gone = _others(now.count, here), _others(before.count, there)
                yield Step(self, now, before, here, there, new, gone)
            before = now

    def record(self, name: str) -> F64:
        """One record over the frames, shape (frames,).

        Raises:
            EvidenceError: it is not recorded.
        """
        values = [self.cache.read(k, (f"record/{name}",))[f"record/{name}"] for k in range(self.frames)]
        return np.array([float(v) for v in values])

    def inflow_frame(self, name: str) -> tuple[F64, F64]:
        """Centre of an opening and its axes as columns; +z is the direction of flow."""
        pose = pose_of(self.inflows[name].pose)
        return pose.position, rotation_matrix(pose.quaternion)

    def near_inflow(self, name: str, points: F64, reach: float) -> NDArray[np.bool_]:
        """Which points lie within `reach` [m] of where an opening lets liquid in."""
        at, turn = self.inflow_frame(name)
        local = (points - at) @ turn
        half = 0.5 * np.array(self.inflows[name].size)
        return np.asarray((np.abs(local[:, :2]) <= half + reach).all(axis=1) & (np.abs(local[:, 2]) <= reach))

    def near_outflow(self, name: str, points: F64, reach: F64) -> NDArray[np.bool_]:
        """Which points lie within `reach` [m], shape (n,), of a box that takes liquid away."""
        pose = pose_of(self.outflows[name].pose)
        local = (points - pose.position) @ rotation_matrix(pose.quaternion)
        return np.asarray((np.abs(local) <= 0.5 * np.array(self.outflows[name].size) + reach[:, None]).all(axis=1))

    def near_open_side(self, points: F64, reach: F64) -> NDArray[np.bool_]:
        """Which points lie within `reach` [m], shape (n,), of an open side of the domain, or beyond it."""
        found = np.zeros(len(points), dtype=bool)
        for axis, positive in itertools.product(range(3), (False, True)):
            if not self.closed[2 * axis + positive]:
                gap = self.upper[axis] - points[:, axis] if positive else points[:, axis] - self.lower[axis]
                found |= gap <= reach
        return found

    def active(self, name: str, frame: int) -> bool:
        """True if an inflow may have let liquid in during the frame interval that ends at `frame`."""
        driver, end = self.inflows[name], frame * self.duration
        return driver.start < end and (driver.end is None or driver.end > end - self.duration)


def liquid_of(candidate: Candidate, solver: str) -> Liquid:
    """The liquid of an instance, opened once per candidate.

    Raises:
        EvidenceError: it has no cache yet, or one of another plan.
    """
    return candidate.memo(("liquid", solver), lambda: Liquid(candidate, solver, cache_of(candidate, solver)))


def _others(count: int, rows: Rows) -> Rows:
    """Row numbers below `count` that are not among `rows`, in order."""
    left = np.ones(count, dtype=bool)
    left[rows] = False
    return np.flatnonzero(left)

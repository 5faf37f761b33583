"""Force fields of a specification at points and times: velocity and kind of the medium, accelerations (R18, R63).

Everything is a function of point and time alone, so that a solver and who judges it ask the same field. The laws are in `physics`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ..physics.drag import Medium
from ..physics.flows import PlaneWaves, attraction, gust_share, gust_waves, smooth_step, turbulence, turbulence_waves, vortex
from .arrays import F64, pose_of
from .errors import EvidenceError
from .instances import carriers_of

if TYPE_CHECKING:
    from .spec import FieldDriver, WorldSpec

__all__ = [
    "Answer",
    "Carrier",
    "Dragged",
    "Fields",
    "Frames",
    "Yielding",
    "acting_on",
    "carried_by",
    "field_drivers",
    "fields_of",
    "lifted_members",
]


class Frames(Protocol):
    """Frames of a cache, as far as a medium reads them."""

    @property
    def index(self) -> Any:
        """Record of the cache that tells how many `frames` there are."""

    def read(self, frame: int, names: Iterable[str] | None = None) -> Mapping[str, Any]:
        """Channels of a frame."""


class Carrier(Protocol):
    """Medium that an instance moved, read from its cache, and what is at rest about its box."""

    ambient: tuple[float, float]
    """Density [kg/m^3] and viscosity [Pa s] of what is about its box, where no field declares a medium."""

    def at(self, points: F64, time: float) -> tuple[Medium, F64]:
        """The medium at points [m], shape (n, 3), and a time [s], and the share of it in what is there, shape (n,): 1 in its box."""


class Dragged(NamedTuple):
    """Things at n points that a medium drags during some time."""

    velocity: F64
    """[m/s], shape (n, 3)."""
    mass: F64
    """[kg], shape (n,)."""
    share: F64
    """Share of their velocity past a medium that would not give way, that drag takes in this time, shape (n,)."""
    rate: F64
    """Rate at which it takes it at first [1/s], shape (n,)."""
    seconds: float
    """Length of that time [s]."""
    reach: F64 | None = None
    """Half as wide as they are [m], shape (n,); None: points."""


class Answer(Protocol):
    """A medium that gives way to what it drags."""

    change: F64
    """By how much the velocity that each meets is another in the mean over that time [m/s], shape (n, 3)."""
    stopping: float
    """Rate at which they would stop it where they are thickest, if they stood still [1/s]."""

    def take(self, impulse: F64, *, back: bool = False) -> None:
        """Take from the medium what they got of it [N s], shape (n, 3), or give that `back`."""


@runtime_checkable
class Yielding(Protocol):
    """Medium that is simulated at the same time as what it carries, and feels it."""

    def answer(self, points: F64, time: float, dragged: Dragged) -> Answer:
        """Its way of giving way to what is at points [m], shape (n, 3), from a time [s] on."""


def field_drivers(spec: WorldSpec) -> dict[str, FieldDriver]:
    """All fields by driver id."""
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "field"}


def acting_on(spec: WorldSpec, driver: FieldDriver) -> tuple[str, ...]:
    """Entities that a field acts on: the named ones, or all that a solver moves and that feel fields."""
    named = driver.entities if driver.entities is not None else spec.entities
    return tuple(
        n for n in named if n in spec.entities and spec.entities[n].motion == "dynamic" and spec.entities[n].physics.feels_fields
    )


def carried_by(spec: WorldSpec, entity: str) -> tuple[str, ...]:
    """Instances whose medium drags an entity along, by name."""
    found = spec.entities.get(entity)
    if not spec.simulation.couplings or found is None or found.motion != "dynamic" or not found.physics.feels_fields:
        return ()
    owners = [n for n, i in spec.simulation.solvers.items() if entity in i.members]
    return tuple(sorted({c for owner in owners for c in carriers_of(spec, owner)}))


def fields_of(
    spec: WorldSpec, entity: str, without: frozenset[str] = frozenset(), media: Mapping[str, Carrier] | None = None
) -> Fields:
    """Fields that act on an entity, `without` some drivers, and the media of instances that carry it, which have to be given to be asked."""
    drivers = {k: d for k, d in field_drivers(spec).items() if k not in without and entity in acting_on(spec, d)}
    return Fields(drivers, carried_by(spec, entity), media or {})


def lifted_members(spec: WorldSpec, solver: str) -> tuple[str, ...]:
    """Members of an instance that move, declare lift and have a medium about them."""
    return tuple(
        n
        for n in spec.simulation.solvers[solver].members
        if n in spec.entities
        and spec.entities[n].physics.lifted
        and spec.entities[n].motion == "dynamic"
        and fields_of(spec, n).has_medium
    )


class Fields:
    """Fields that act together, and media of instances: within their boxes these are the only medium, beyond them the fields or still air."""

    def __init__(
        self, drivers: Mapping[str, FieldDriver], carriers: tuple[str, ...] = (), media: Mapping[str, Carrier] | None = None
    ) -> None:
        self.names = (*sorted(drivers), *carriers)
        self.drivers = [drivers[n] for n in sorted(drivers)]
        self._waves = [_waves(d) for d in self.drivers]
        self.carriers, self._media = carriers, media or {}

    def __bool__(self) -> bool:
        return bool(self.names)

    @property
    def has_medium(self) -> bool:
        """True if any of them is a medium, so that things are dragged."""
        return bool(self.carriers) or any(d.field.kind != "attraction" for d in self.drivers)

    def acts(self, start: float, end: float) -> bool:
        """True if any field acts during [start, end)."""
        return bool(self.carriers) or any(d.start < end and (d.end is None or d.end > start) for d in self.drivers)

    def carried(self, points: F64, time: float) -> NDArray[np.bool_]:
        """True where part of the medium is that of an instance, shape (n,); points [m], shape (n, 3).

        Raises:
            EvidenceError: its cache was not given.
        """
        found = np.zeros(len(points), dtype=bool)
        for name in self.carriers:
            found |= self._given(name).at(points, time)[1] > 0.0
        return found

    def _given(self, name: str) -> Carrier:
        if name not in self._media:
            raise EvidenceError(f"what {name!r} carries is told by its cache, and there is none; probe or bake first")
        return self._media[name]

    def medium(self, points: F64, time: float) -> Medium:
        """The medium at points [m], shape (n, 3), and a time [s]: velocities add up, and the densest holds; in the box of an instance its own alone.

        Raises:
            EvidenceError: the cache of such an instance was not given.
        """
        found = self._declared(points, time)
        for name in reversed(self.carriers):
            carrier = self._given(name)
            own, share = carrier.at(points, time)
            bare, rest = found.density <= 0.0, 1.0 - share
            density, viscosity = carrier.ambient
            found = Medium(
                share[:, None] * own.velocity + rest[:, None] * found.velocity,
                share * own.density + rest * np.where(bare, density, found.density),
                share * own.viscosity + rest * np.where(bare, viscosity, found.viscosity),
                np.where(bare | (share > 0.0), own.coefficient, found.coefficient),
            )
        return found

    @property
    def yields(self) -> bool:
        """True if a medium feels what it carries."""
        return any(isinstance(self._media.get(n), Yielding) for n in self.carriers)

    def answer(self, points: F64, time: float, dragged: Dragged) -> Answer | None:
        """Answer of a medium that feels what it carries to things at points [m], shape (n, 3), from a time [s] on; None where none does."""
        for name in self.carriers if len(points) else ():
            medium: object = self._media.get(name)
            if isinstance(medium, Yielding):
                return medium.answer(points, time, dragged)
        return None

    def _declared(self, points: F64, time: float) -> Medium:
        """The medium of the declared fields."""
        velocity, (density, viscosity, coefficient) = np.zeros((len(points), 3)), np.zeros((3, len(points)))
        for driver, waves in zip(self.drivers, self._waves, strict=True):
            field = driver.field
            if field.kind == "attraction" or (weight := _weight(driver, points, time)) is None:
                continue
            if field.kind != "drag":
                velocity += weight[:, None] * _velocity(driver, waves, points, time)
            denser = weight * field.density > density
            density = np.where(denser, weight * field.density, density)
            viscosity = np.where(denser, weight * field.viscosity, viscosity)
            coefficient = np.where(denser, field.coefficient, coefficient)
        return Medium(velocity, density, viscosity, coefficient)

    def acceleration(self, points: F64, time: float) -> F64:
        """Acceleration [m/s^2] at points [m], both of shape (n, 3), at a time [s]."""
        total: F64 = np.zeros((len(points), 3))
        for driver in self.drivers:
            field = driver.field
            if field.kind == "attraction" and (weight := _weight(driver, points, time)) is not None:
                total += weight[:, None] * attraction(
                    points,
                    center=np.array(field.center),
                    acceleration=field.acceleration,
                    distance=field.distance,
                    exponent=field.exponent,
                    axis=None if field.axis is None else np.array(field.axis),
                )
        return total


def _waves(driver: FieldDriver) -> PlaneWaves | None:
    """Gusts of a wind or eddies of a turbulence; None where a field has neither."""
    field = driver.field
    if field.kind == "turbulence":
        return turbulence_waves(field.speed, field.length, driver.seed)
    return gust_waves(field.gust_period, driver.seed) if field.kind == "wind" and field.gust > 0 else None


def _velocity(driver: FieldDriver, waves: PlaneWaves | None, points: F64, time: float) -> F64:
    """Velocity of a field's medium [m/s], shape (n, 3) or, where it is the same everywhere, (3,)."""
    field = driver.field
    if field.kind == "wind":
        return np.array(field.velocity) * (1.0 + field.gust * (gust_share(waves, time) if waves is not None else 0.0))
    if field.kind == "turbulence" and waves is not None:
        return turbulence(waves, points, time)
    assert field.kind == "vortex"
    center, axis = np.array(field.center), np.array(field.axis, dtype=np.float64)
    return vortex(points, center=center, axis=axis, speed=field.speed, core=field.core, updraft=field.updraft)


def _weight(driver: FieldDriver, points: F64, time: float) -> F64 | None:
    """Strength of a field at points from 0 to 1, shape (n,); None while it does not act."""
    if time < driver.start or (driver.end is not None and time >= driver.end):
        return None
    share = min(1.0, (time - driver.start) / driver.rise) if driver.rise > 0 else 1.0
    if driver.region is None:
        return np.full(len(points), share)
    if driver.region.kind == "box":
        local = pose_of(driver.region.pose).inverse().apply(points)
        inside = (0.5 * np.array(driver.region.size) - np.abs(local)).min(axis=1)
    else:
        inside = driver.region.radius - np.linalg.norm(points - np.array(driver.region.center), axis=1)
    if driver.fade <= 0:
        return np.where(inside >= 0, share, 0.0)
    return share * smooth_step(np.clip(inside / driver.fade, 0.0, 1.0))

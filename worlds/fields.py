"""Force fields at points and times: velocity and kind of the medium, accelerations (R18, R63).

Everything is a function of point and time alone, so that a solver and who judges it ask the same field. Turbulence is a sum of
plane waves whose amplitudes are at right angles to their wave vectors: it has no divergence. Amplitudes fall with the wave
number k as k^(-1/3), which gives the energy per octave of the inertial range (Kraichnan 1970, doi 10.1063/1.1692799).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .arrays import F64, I64, pose_of

if TYPE_CHECKING:
    from .spec import FieldDriver, WorldSpec
    from .spec.fields import AttractionField, TurbulenceField, VortexField, WindField

__all__ = [
    "FaceDrag",
    "Fields",
    "Medium",
    "acting_on",
    "area_vectors",
    "drag_force",
    "face_drag",
    "field_drivers",
    "fields_of",
    "projected_area",
]

MODES = 64
"""Waves that a turbulence is made of."""
OCTAVES = 3.0
"""Own choice: from the largest eddies to the smallest."""
GUSTS = 8
"""Waves that gusts are made of."""
FACINGS = 128
"""Directions into which the faces of a body are gathered when it has more of them."""
FELT = frozenset({"rigid", "particles", "cloth", "elastic", "liquid"})
"""Categories of entities that feel fields."""


@dataclass(frozen=True)
class Medium:
    """What is at n points."""

    velocity: F64
    """[m/s], shape (n, 3)."""
    density: F64
    """[kg/m^3], shape (n,); 0 where there is none."""
    viscosity: F64
    """Dynamic [Pa s], shape (n,)."""
    coefficient: F64
    """Drag coefficient of rigid bodies, shape (n,)."""


@dataclass(frozen=True)
class FaceDrag:
    """Forces of a medium on n faces."""

    force: F64
    """[N], shape (n, 3)."""
    rate: F64
    """Force over relative speed [kg/s], shape (n,)."""


@dataclass(frozen=True)
class _Waves:
    vector: F64
    amplitude: F64
    frequency: F64
    phase: F64


def field_drivers(spec: WorldSpec) -> dict[str, FieldDriver]:
    """All fields by driver id."""
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "field"}


def acting_on(spec: WorldSpec, driver: FieldDriver) -> tuple[str, ...]:
    """Entities that a field acts on: the named ones, or all that a solver moves and that feel fields."""
    named = driver.entities if driver.entities is not None else spec.entities
    return tuple(
        n
        for n in named
        if n in spec.entities and spec.entities[n].motion == "dynamic" and spec.entities[n].physics.category in FELT
    )


def fields_of(spec: WorldSpec, entity: str, without: frozenset[str] = frozenset()) -> Fields:
    """Fields that act on an entity, `without` some drivers."""
    return Fields({k: d for k, d in field_drivers(spec).items() if k not in without and entity in acting_on(spec, d)})


class Fields:
    """Fields that act together."""

    def __init__(self, drivers: Mapping[str, FieldDriver]) -> None:
        self.names = tuple(sorted(drivers))
        self.drivers = [drivers[n] for n in self.names]
        self._waves = [_waves(d.field, d.seed) if d.field.kind == "turbulence" else None for d in self.drivers]
        self._gusts = [_gusts(d.field, d.seed) if d.field.kind == "wind" and d.field.gust > 0 else None for d in self.drivers]

    def __bool__(self) -> bool:
        return bool(self.drivers)

    @property
    def has_medium(self) -> bool:
        """Whether any of them is a medium, so that things are dragged."""
        return any(d.field.kind != "attraction" for d in self.drivers)

    def acts(self, start: float, end: float) -> bool:
        """Whether any field acts during [start, end)."""
        return any(d.start < end and (d.end is None or d.end > start) for d in self.drivers)

    def medium(self, points: F64, time: float) -> Medium:
        """The medium at points [m], shape (n, 3), and a time [s]."""
        velocity, (density, viscosity, coefficient) = np.zeros((len(points), 3)), np.zeros((3, len(points)))
        for driver, waves, gusts in zip(self.drivers, self._waves, self._gusts, strict=True):
            field = driver.field
            if field.kind == "attraction" or (weight := _weight(driver, points, time)) is None:
                continue
            if field.kind == "wind":
                velocity += weight[:, None] * _wind(field, gusts, time)
            elif field.kind == "turbulence" and waves is not None:
                velocity += weight[:, None] * _turbulence(waves, points, time)
            elif field.kind == "vortex":
                velocity += weight[:, None] * _vortex(field, points)
            denser = weight * field.density > density
            density = np.where(denser, weight * field.density, density)
            viscosity = np.where(denser, weight * field.viscosity, viscosity)
            coefficient = np.where(denser, field.coefficient, coefficient)
        return Medium(velocity, density, viscosity, coefficient)

    def acceleration(self, points: F64, time: float) -> F64:
        """Acceleration [m/s^2] at points [m], both of shape (n, 3), at a time [s]."""
        total: F64 = np.zeros((len(points), 3))
        for driver in self.drivers:
            if driver.field.kind == "attraction" and (weight := _weight(driver, points, time)) is not None:
                total += weight[:, None] * _attraction(driver.field, points)
        return total


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
    part = np.clip(inside / driver.fade, 0.0, 1.0)
    result: F64 = share * part * part * (3.0 - 2.0 * part)
    return result


def _gusts(field: WindField, seed: int) -> _Waves:
    rng = np.random.default_rng([seed, 11])
    frequency = 2 * math.pi / field.gust_period * 2.0 ** rng.uniform(-1.0, 1.0, GUSTS)
    return _Waves(np.zeros((GUSTS, 3)), np.full((GUSTS, 1), 1.0 / GUSTS), frequency, rng.uniform(0, 2 * math.pi, GUSTS))


def _wind(field: WindField, gusts: _Waves | None, time: float) -> F64:
    """Velocity of the wind [m/s], shape (3,); gusts stay within the declared share."""
    swell = 0.0 if gusts is None else float((gusts.amplitude[:, 0] * np.cos(gusts.frequency * time + gusts.phase)).sum())
    return np.array(field.velocity) * (1.0 + field.gust * swell)


def _waves(field: TurbulenceField, seed: int) -> _Waves:
    rng = np.random.default_rng([seed, 7])
    number = 2 * math.pi / field.length * 2.0 ** rng.uniform(0.0, OCTAVES, MODES)
    way = rng.normal(size=(MODES, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    across = np.cross(way, rng.normal(size=(MODES, 3)))
    across /= np.linalg.norm(across, axis=1)[:, None]
    size = number ** (-1.0 / 3.0)
    size *= field.speed / math.sqrt(0.5 * float((size**2).sum()))
    # An eddy turns over in the time that its own octave's speed takes along it.
    own = field.speed * (number / number.min()) ** (-1.0 / 3.0)
    return _Waves(way * number[:, None], across * size[:, None], own * number, rng.uniform(0, 2 * math.pi, MODES))


def _turbulence(waves: _Waves, points: F64, time: float) -> F64:
    phase = points @ waves.vector.T - waves.frequency * time + waves.phase
    result: F64 = np.cos(phase) @ waves.amplitude
    return result


def _across(points: F64, center: tuple[float, float, float], axis: tuple[float, float, float]) -> tuple[F64, F64]:
    """Unit axis (3,), and points relative to it without their part along it (n, 3)."""
    unit = np.array(axis, dtype=np.float64) / math.hypot(*axis)
    arm = points - np.array(center)
    return unit, arm - (arm @ unit)[:, None] * unit


def _vortex(field: VortexField, points: F64) -> F64:
    """Of Scully (1975): speed 2 r c / (r^2 + c^2) of the greatest; the updraft falls as its square root's square."""
    unit, arm = _across(points, field.center, field.axis)
    square = (arm**2).sum(axis=1)
    share = 2.0 * field.core / (square + field.core**2)
    rise = field.updraft * (field.core**2 / (square + field.core**2)) ** 2
    result: F64 = field.speed * share[:, None] * np.cross(unit, arm) + rise[:, None] * unit
    return result


def _attraction(field: AttractionField, points: F64) -> F64:
    arm = np.array(field.center) - points if field.axis is None else -_across(points, field.center, field.axis)[1]
    share = np.linalg.norm(arm, axis=1) / field.distance
    # arm / distance is the unit direction times `share`.
    scale = field.acceleration * np.maximum(share, 1.0) ** (-field.exponent - 1.0)
    result: F64 = scale[:, None] * arm / field.distance
    return result


# ---------------------------------------------------------------- bodies


def area_vectors(vertices: F64) -> F64:
    """Outward normals times areas [m^2] of the convex hull of a body, shape (at most `FACINGS`, 3), in the frame of the vertices."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(np.asarray(vertices, dtype=np.float64))
    except (QhullError, ValueError):
        return np.zeros((1, 3))
    corner = hull.points[hull.simplices]
    areas = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    found: F64 = hull.equations[:, :3] * areas[:, None]
    if len(found) <= FACINGS:
        return found
    step = np.arange(FACINGS) + 0.5
    height, turn = 1.0 - 2.0 * step / FACINGS, step * math.pi * (1.0 + math.sqrt(5.0))
    ring = np.sqrt(1.0 - height**2)
    directions = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    merged = np.zeros((FACINGS, 3))
    np.add.at(merged, np.argmax(hull.equations[:, :3] @ directions.T, axis=1), found)
    # Faces that are joined at an angle lose area; on the whole it stays.
    kept: F64 = merged * (areas.sum() / np.linalg.norm(merged, axis=1).sum())
    return kept


def projected_area(vectors: F64, owner: I64, turns: F64, flow: F64) -> F64:
    """Area that each of n bodies shows to its flow [m^2], shape (n,).

    Args:
        vectors: normals times areas of all bodies in their frames, shape (m, 3).
        owner: body of each, shape (m,).
        turns: orientation of the bodies, shape (n, 3, 3).
        flow: velocity relative to the body, shape (n, 3); its length does not matter.
    """
    speed = np.linalg.norm(flow, axis=1)
    local = np.einsum("nji,nj->ni", turns, flow / np.maximum(speed, 1e-300)[:, None])
    seen = 0.5 * np.bincount(owner, weights=np.abs((vectors * local[owner]).sum(axis=1)), minlength=len(turns))
    return seen.astype(np.float64)


def drag_force(medium: Medium, area: F64, velocity: F64) -> F64:
    """Drag on bodies [N], shape (n, 3): half the density times coefficient, area and speed squared, along the relative flow."""
    flow = medium.velocity - velocity
    speed = np.linalg.norm(flow, axis=1)
    result: F64 = (0.5 * medium.density * medium.coefficient * area * speed)[:, None] * flow
    return result


def face_drag(fields: Fields, corners: F64, velocity: F64, time: float) -> FaceDrag:
    """Drag on the faces of a closed surface that face the flow: the law of `drag_force`, by the area that each shows.

    Args:
        fields: what acts.
        corners: of outward triangles [m], shape (n, 3, 3).
        velocity: of their centres [m/s], shape (n, 3).
        time: [s]
    """
    vector = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    medium = fields.medium(corners.mean(axis=1), time)
    flow = medium.velocity - velocity
    speed = np.linalg.norm(flow, axis=1)
    shown = np.maximum(-(vector * flow).sum(axis=1) / np.maximum(speed, 1e-300), 0.0)
    return FaceDrag(drag_force(medium, shown, velocity), 0.5 * medium.density * medium.coefficient * shown * speed)

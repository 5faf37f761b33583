"""Where hot matter touches water, and over what area, by the caches of both at a frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry.patches import patches_of
from ...physics.interfaces import facing_area, kernel, slope, wetted_share
from ...worlds.arrays import F64, RigidPose, compose, pose_of
from ...worlds.categories.gas.steam_facts import contact_reach, instance_of
from ...worlds.errors import EvidenceError

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.categories.gas.steam_facts import HotMatter
    from ...worlds.spec import SteamDriver, WorldSpec

__all__ = ["Contact", "Contacts"]

CHANNELS = ("origin", "particle/position", "particle/volume", "particle/fluid")
PATCH = 0.2
"""Edge of the pieces of a solid's surface, as a share of the reach: half a spacing."""


class Contact(NamedTuple):
    """Contact of one hot entity with water at a frame."""

    point: F64
    """[m], shape (n, 3)."""
    area: F64
    """[m^2], shape (n,)."""
    mass: float
    """Mass of the hot entity [kg]."""
    water: F64
    """Places of the water's particles [m], shape (m, 3)."""


class Contacts:
    """Contacts of hot entities, frame by frame.

    Args:
        spec: the specification.
        built: its geometry.
        caches: of the rigid instances, and of the liquids.
    """

    def __init__(self, spec: WorldSpec, built: Mapping[str, BuiltEntity], caches: Mapping[str, Cache]) -> None:
        self._spec, self._built, self._caches = spec, built, caches

    def of(self, driver: SteamDriver, hot: HotMatter, frame: int) -> Contact:
        """Contact of one entity with the water of its driver.

        Raises:
            EvidenceError: a cache is missing.
        """
        reach = contact_reach(self._spec, driver)
        place, volume = self._particles(driver.water, frame)
        if hot.liquid:
            points, own = self._particles((hot.entity,), frame)
            mass = float(own.sum()) * self._spec.materials[self._spec.entities[hot.entity].material].density
            sides = ((points, own, place, volume), (place, volume, points, own))
            area = np.concatenate([_facing(*side, reach) for side in sides])
            points = np.concatenate([points, place])
        else:
            points, own = self._surface(hot.entity, frame, place, reach)
            mass = float(sum(b.mass for b in self._built[hot.entity].bodies))
            area = _wetted(points, own, place, volume, reach)
        met = area > 0.0
        return Contact(points[met], area[met], mass, place)

    def _particles(self, names: tuple[str, ...] | list[str], frame: int) -> tuple[F64, F64]:
        """Places [m] and volumes [m^3] of the particles of liquids."""
        places, volumes = [np.zeros((0, 3))], [np.zeros(0)]
        for name in names:
            cache = self._caches.get(instance_of(self._spec, name) or "")
            if cache is None:
                raise EvidenceError(f"steam reads the particles of {name!r}, which has no cache; bake its instance first")
            held = cache.read(frame, CHANNELS)
            mine = held["particle/fluid"] == cache.index.bodies.index(name)
            places.append(held["particle/position"][mine].astype(np.float64) + held["origin"])
            volumes.append(held["particle/volume"][mine].astype(np.float64))
        return np.concatenate(places), np.concatenate(volumes)

    def _surface(self, name: str, frame: int, water: F64, reach: float) -> tuple[F64, F64]:
        """Middles [m] and areas [m^2] of pieces of a solid's surface within reach of the box of the water."""
        points, areas = [np.zeros((0, 3))], [np.zeros(0)]
        if len(water):
            low, high = water.min(axis=0) - reach, water.max(axis=0) + reach
            for part in self._built[name].parts:
                place = self._pose(name, part.body, frame)
                found = patches_of(place.apply(part.render.vertices), part.render.faces, PATCH * reach, low, high)
                points.append(found.point)
                areas.append(found.area)
        return np.concatenate(points), np.concatenate(areas)

    def _pose(self, name: str, body: str, frame: int) -> RigidPose:
        for cache in self._caches.values():
            row = cache.body_row(name, body)
            if row is not None:
                held = cache.read(frame, ("position", "quaternion"))
                return RigidPose(held["position"][row], held["quaternion"][row])
        own = next(b for b in self._built[name].bodies if b.name == body)
        return compose(pose_of(self._spec.entities[name].pose), own.pose)


def _near(points: F64, others: F64, reach: float) -> Iterator[tuple[int, list[int]]]:
    """Rows of points that have others within reach, and these."""
    from scipy.spatial import cKDTree

    if len(points) and len(others):
        yield from ((i, near) for i, near in enumerate(cKDTree(others).query_ball_point(points, reach)) if near)


def _facing(points: F64, own: F64, others: F64, sizes: F64, reach: float) -> F64:
    """Area of the interface that belongs to particles of one of two liquids [m^2], shape (n,)."""
    gradient = np.zeros((len(points), 3))
    for i, near in _near(points, others, reach):
        way = points[i] - others[near]
        far = np.sqrt((way * way).sum(axis=1))
        gradient[i] = (sizes[near] * slope(far, reach) / np.maximum(far, 1e-12)) @ way
    return facing_area(own, gradient)


def _wetted(points: F64, own: F64, water: F64, sizes: F64, reach: float) -> F64:
    """Wet area of pieces of a surface [m^2], shape (n,)."""
    colour = np.zeros(len(points))
    for i, near in _near(points, water, reach):
        way = points[i] - water[near]
        colour[i] = sizes[near] @ kernel(np.sqrt((way * way).sum(axis=1)), reach)
    return own * wetted_share(colour)

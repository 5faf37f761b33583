"""Liquids of a candidate as meshes, drops and bubbles of one frame, and what they look like.

A surface made with the bake is drawn; where there is none yet, the particles; before any simulation, the declared volume.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ....worlds.arrays import F64, I32
from ....worlds.cache import Cache
from ....worlds.candidate import Candidate
from ....worlds.categories.liquid.surface import LiquidSurface, mesh_of
from ....worlds.errors import EvidenceError
from ....worlds.spec import Appearance, Material
from ..balls import joined_balls

__all__ = ["Drawn", "Liquid", "LiquidLook", "liquids_of", "look_of"]

GREY = Appearance().color
"""Colour of a material without a declared look, linear RGB."""
WATER_AFTER_A_METRE = (0.70, 0.93, 0.975)
"""Shares of white light that one metre of clear water leaves. Source: Pope and Fry (1997), doi:10.1364/AO.36.008710, rounded."""
DROPS_PER_PARTICLE = 4
"""A particle of spray is drawn as so many drops of its volume together."""
SCATTER = 2.0
"""Largest distance of drops from their particle along each axis, in its radii."""
BUBBLE = 0.11
"""Radius of a bubble of foam in spacings."""
MOST_BALLS = 60_000
"""Most drops, bubbles or particles in one picture; more are thinned evenly."""


class Drawn(NamedTuple):
    """A liquid at one frame, in the world."""

    vertices: F64
    """(v, 3) [m]"""
    faces: I32
    temperature: F64 | None
    """At the vertices (v,) [K]; None where the liquid has none."""
    drops: F64
    """Centres (n, 3) [m]."""
    drop_radius: F64
    """(n,) [m]"""
    drop_temperature: F64 | None
    """(n,) [K]"""
    bubbles: F64
    bubble_radius: float


class LiquidLook(NamedTuple):
    """Passage of light through a liquid."""

    color: tuple[float, float, float]
    clear: bool
    """Light passes through; else only its face is seen."""
    absorption: F64
    """[1/m] per colour."""
    roughness: float
    glows: bool


def look_of(material: Material) -> LiquidLook:
    """The look of a liquid's material; water without a declared look is clear water.

    The default colour without transmission counts as none declared: specifications are kept with all defaults written out.
    """
    look = material.appearance
    given = look.color != GREY or look.transmission > 0.0
    clear = look.transmission >= 0.5 or (not given and material.substance in ("water", "other"))
    after: Any = look.color if given and look.color != (1.0, 1.0, 1.0) else WATER_AFTER_A_METRE
    absorption = -np.log(np.clip(np.asarray(after, dtype=np.float64), 0.01, 0.999))
    return LiquidLook(_plain(look, clear), clear, absorption, look.roughness, material.substance == "lava")


def _plain(look: Appearance, clear: bool) -> tuple[float, float, float]:
    """Colour for pictures that show no depth."""
    if not clear:
        return look.color
    return (0.10, 0.32, 0.42) if look.color == GREY else look.color


def _thinned(points: F64) -> F64:
    return points[:: -(-len(points) // MOST_BALLS)] if len(points) > MOST_BALLS else points


def _split(center: F64, radius: F64, identity: Any) -> tuple[F64, F64]:
    """Drops of particles of spray: four each, scattered around the particle alike in every frame, of its volume together."""
    share = np.array([0.5, 0.28, 0.15, 0.07])
    assert len(share) == DROPS_PER_PARTICLE
    key = np.asarray(identity, dtype=np.float64)[:, None, None] * 12 + np.arange(12).reshape(4, 3)
    scatter = 2 * ((key * 0.6180339887498949 + np.sin(key * 12.9898) * 43.758) % 1.0) - 1
    places = center[:, None] + SCATTER * radius[:, None, None] * scatter
    sizes = radius[:, None] * np.cbrt(share)
    return places.reshape(-1, 3), sizes.reshape(-1)


@dataclass(frozen=True)
class Liquid:
    """One liquid entity of a candidate."""

    candidate: Candidate
    entity: str
    cache: Cache | None
    """None before any simulation."""

    @cached_property
    def look(self) -> LiquidLook:
        """Look of its material."""
        return look_of(self.candidate.spec.materials[self.candidate.spec.entities[self.entity].material])

    @cached_property
    def fluid(self) -> int:
        """Its index in the channels of the cache."""
        return -1 if self.cache is None else self.cache.index.bodies.index(self.entity)

    @cached_property
    def surface(self) -> LiquidSurface | None:
        """Its surfaces; None when not all frames have one."""
        if self.cache is None:
            return None
        found = LiquidSurface(self.cache)
        return found if found.count() >= self.cache.index.frames else None

    def drawn(self, frame: int) -> Drawn:
        """The liquid at a frame.

        Raises:
            EvidenceError: its surface was altered or is of other particles.
        """
        interval = self.candidate.spec.entities[self.entity].active
        if interval is not None and not interval[0] <= frame <= interval[1]:
            return _nothing()
        if self.surface is not None:
            return self._from_surface(self.surface, frame)
        if self.cache is not None:
            return self._from_particles(self.cache, frame)
        return self._declared()

    def _from_surface(self, surface: LiquidSurface, frame: int) -> Drawn:
        found, spacing = surface.read(frame), float(surface.about()["spacing"])
        vertices, faces = mesh_of(found, self.fluid)
        own = found["spray/fluid"] == self.fluid
        radius = np.cbrt(found["spray/volume"][own].astype(np.float64) * 3 / (4 * np.pi))
        drops, sizes = _split(found["spray/position"][own].astype(np.float64), radius, found["spray/id"][own])
        step = max(1, -(-len(drops) // MOST_BALLS))
        drops, sizes = drops[::step], sizes[::step]
        heat, drop_heat = None, None
        if "surface/temperature" in found:
            drop_heat = np.repeat(found["spray/temperature"][own].astype(np.float64), DROPS_PER_PARTICLE)[::step]
            used = np.unique(found["surface/faces"][found["surface/fluid"] == self.fluid])
            heat = found["surface/temperature"][used].astype(np.float64)
        bubbles = found["foam/position"] if self.fluid == 0 and self.look.clear else np.empty((0, 3))
        return Drawn(
            vertices, faces, heat, drops + found["origin"], sizes, drop_heat,
            _thinned(bubbles.astype(np.float64) + found["origin"]), BUBBLE * spacing,
        )  # fmt: skip

    def _from_particles(self, cache: Cache, frame: int) -> Drawn:
        found = cache.read(frame, ("origin", "particle/position", "particle/fluid", "particle/volume"))
        own = found["particle/fluid"] == self.fluid
        points = _thinned(found["particle/position"][own].astype(np.float64) + found["origin"])
        if not len(points):
            return _nothing()
        spacing = float(np.cbrt(np.median(found["particle/volume"][own]))) * float(np.cbrt(own.sum() / len(points)))
        vertices, faces = joined_balls(points, np.full(len(points), 0.62 * spacing))
        return _nothing()._replace(vertices=vertices, faces=faces)

    def _declared(self) -> Drawn:
        if self.entity not in self.candidate.built:
            return _nothing()
        vertices, faces, start = [], [], 0
        for part in self.candidate.built[self.entity].parts:
            vertices.append(self.candidate.pose(self.entity, 0, part.body).apply(part.render.vertices))
            faces.append(part.render.faces + start)
            start += len(part.render.vertices)
        return _nothing()._replace(vertices=np.concatenate(vertices), faces=np.concatenate(faces).astype(np.int32))


def _nothing() -> Drawn:
    none = np.empty((0, 3))
    return Drawn(none, np.empty((0, 3), np.int32), None, none, none[:, 0], None, none, 0.0)


def liquids_of(candidate: Candidate) -> list[Liquid]:
    """Liquids of a candidate, by entity id.

    Raises:
        EvidenceError: a cache lacks its index.
    """
    place = {}
    for cache in candidate.liquid_caches.values():
        for entity in cache.index.bodies:
            place[entity] = cache
    missing = [n for n in place if n not in candidate.spec.entities]
    if missing:
        raise EvidenceError(f"the cache holds liquids {missing[:3]} that the specification does not have; bake again")
    return [Liquid(candidate, n, place.get(n)) for n in sorted(candidate.liquids) if n in place or n in candidate.built]

"""Grains and flying particles in pictures: spheres in previews, meshes of small balls for the path tracer."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ....geometry.camera import Camera
from ....geometry.idcast import IdImage
from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.candidate import Candidate
from ....worlds.spec import Appearance
from ...tracer.meshes import mesh_of, rgb
from ..balls import fine_balls, joined_balls
from ..layer import LooseLayer, TracedShapes
from .splat import splat, unseen

__all__ = ["GrainLayer", "Grains"]

FINE = 4000
"""Up to so many grains the path tracer gets balls of 80 faces each; beyond, of 20."""


class Grains(NamedTuple):
    """Particles of one entity at a frame."""

    center: F64
    """World [m], shape (n, 3)."""
    radius: F64
    """[m], shape (n,)."""


class GrainLayer(LooseLayer):
    """Particles as caches hold them; at the static stage there are none, and plans show the volume that they are declared in."""

    def __init__(self, candidate: Candidate, entities: Sequence[str]) -> None:
        super().__init__(candidate, [e for c in candidate.particle_caches.values() for e in c.index.bodies])
        self._kept: tuple[int, dict[str, Grains]] | None = None

    def at(self, frame: int) -> dict[str, Grains]:
        """Particles at a frame by entity, in the order of `entities`."""
        if self._kept is None or self._kept[0] != frame:
            self._kept = (frame, self._read(frame))
        return self._kept[1]

    def _read(self, frame: int) -> dict[str, Grains]:
        found = {}
        names = ("origin", "particle/position", "particle/radius", "particle/member")
        for cache in self.candidate.particle_caches.values():
            data = cache.read(min(frame, cache.index.frames - 1), names)
            for row, entity in enumerate(cache.index.bodies):
                own = data["particle/member"] == row
                center = data["origin"] + data["particle/position"][own].astype(np.float64)
                found[entity] = Grains(center, data["particle/radius"][own].astype(np.float64))
        return found

    def _look(self, entity: str) -> Appearance:
        return self.candidate.spec.materials[self.candidate.spec.entities[entity].material].appearance

    @cached_property
    def colors(self) -> F64:
        """Linear RGB per entity, shape (n, 3)."""
        return np.array([self._look(e).color for e in self.entities]).reshape(-1, 3)

    def cast(self, frame: int, camera: Camera, entity: str | None = None) -> IdImage:
        """The view of all grains, or of those of one entity, if nothing else were there; ids are indices into `entities`."""
        image = unseen(camera)
        for k, (name, grains) in enumerate(self.at(frame).items()):
            if entity in (None, name):
                splat(image, grains, camera, k)
        return image

    def meshes(self, entity: str, frame: int) -> list[TriangleMesh]:
        """All grains of an entity as one mesh of icosahedra."""
        if entity not in self.entities:
            return super().meshes(entity, frame)
        return [TriangleMesh(*joined_balls(*self.at(frame)[entity]))]

    def traced(self, mi: Any, frame: int) -> TracedShapes:
        """Mitsuba shapes at a frame, one per entity that has grains then."""
        shapes = {}
        for entity, grains in self.at(frame).items():
            if not len(grains.center):
                continue
            if len(grains.center) <= FINE:
                vertices, normals, faces = fine_balls(*grains)
            else:
                vertices, faces = joined_balls(*grains)
                out = vertices - np.repeat(grains.center, 12, axis=0)
                normals = out / np.linalg.norm(out, axis=1)[:, None]
            look = self._look(entity)
            bsdf = {"type": "principled", "base_color": rgb(look.color), "roughness": max(look.roughness, 0.05),
                    "metallic": look.metallic, "specular": 0.5}  # fmt: skip
            name = f"grains-{entity}"
            shapes[name] = mesh_of(mi, name, (vertices, faces), mi.load_dict(bsdf), normals=normals)
        return TracedShapes(shapes)

"""Balloons in pictures: spheres, at their declared places before any simulation."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ....geometry.camera import Camera
from ....geometry.idcast import IdImage
from ....worlds.arrays import F64, pose_of
from ....worlds.built import TriangleMesh
from ....worlds.spec import Appearance
from ...tracer.meshes import mesh_of, rgb
from ..balls import fine_balls, joined_balls
from ..layer import LooseLayer, TracedShapes
from ..particles.splat import splat, unseen

__all__ = ["BalloonLayer"]


class BalloonLayer(LooseLayer):
    """Balloons as caches hold them."""

    quantities = ("max_speed",)

    def spheres(self, entity: str, frame: int) -> tuple[F64, F64]:
        """Centres (n, 3) and radii (n,) of an entity's balloons at a frame [m]."""
        contract = self.candidate.spec.entities[entity]
        for cache in self.candidate.caches.values():
            if entity in cache.index.bodies:
                held = cache.read(min(frame, cache.index.frames - 1))
                own = held["balloon/member"] == cache.index.bodies.index(entity)
                center = held["origin"] + held["particle/position"][own].astype(np.float64)
                return center, held["balloon/radius"][own].astype(np.float64)
        parts = [p for _, p in sorted(contract.parts.items())]
        centers = np.array([pose_of(p.pose).position for p in parts])
        return pose_of(contract.pose).apply(centers), np.array([float(getattr(p.shape, "radius", 0.0)) for p in parts])

    def _look(self, entity: str) -> Appearance:
        return self.candidate.spec.materials[self.candidate.spec.entities[entity].material].appearance

    @cached_property
    def colors(self) -> F64:
        """Linear RGB per entity, shape (n, 3)."""
        return np.array([self._look(e).color for e in self.entities]).reshape(-1, 3)

    def cast(self, frame: int, camera: Camera, entity: str | None = None) -> IdImage:
        """The view of all balloons, or of those of one entity, if nothing else were there; ids are indices into `entities`."""
        image = unseen(camera)
        for k, name in enumerate(self.entities):
            if entity in (None, name):
                splat(image, self.spheres(name, frame), camera, k)
        return image

    def meshes(self, entity: str, frame: int) -> list[TriangleMesh]:
        """All balloons of an entity as one mesh of icosahedra."""
        return [TriangleMesh(*joined_balls(*self.spheres(entity, frame)))]

    def traced(self, mi: Any, frame: int) -> TracedShapes:
        """Mitsuba shapes at a frame, one per entity."""
        shapes = {}
        for entity in self.entities:
            vertices, normals, faces = fine_balls(*self.spheres(entity, frame))
            bsdf = {"type": "principled", "base_color": rgb(self._look(entity).color), "roughness": 0.3}
            name = f"balloons-{entity}"
            shapes[name] = mesh_of(mi, name, (vertices, faces), mi.load_dict(bsdf), normals=normals)
        return TracedShapes(shapes)

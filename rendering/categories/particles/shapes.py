"""Grains and flying particles in pictures: spheres cast by themselves for previews, meshes of small balls for the path tracer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ....geometry.camera import Camera
from ....geometry.idcast import IdImage
from ....worlds.arrays import F64, I32
from ....worlds.built import TriangleMesh
from ..liquid.meshes import joined_balls

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate

__all__ = ["GrainLayer", "Grains", "ball_mesh", "grain_shapes", "grains_at"]

LEAST_PIXELS = 0.6
"""Radius in pixels at which particles are drawn at least: sparks and rain are smaller than a pixel."""
MOST_PIXELS = 160
FINE = 4000
"""Up to so many grains the path tracer gets balls of 80 faces each; beyond, of 20."""


class Grains(NamedTuple):
    """Particles of one entity at a frame."""

    entity: str
    center: F64
    """World [m], shape (n, 3)."""
    radius: F64
    color: F64
    """Linear RGB, shape (3,)."""


def grains_at(candidate: Candidate, frame: int) -> list[Grains]:
    """Particles of all entities at a frame; none at the static stage."""
    found = []
    for cache in candidate.particle_caches.values():
        data = cache.read(
            min(frame, cache.index.frames - 1), ("origin", "particle/position", "particle/radius", "particle/member")
        )
        for row, entity in enumerate(cache.index.bodies):
            own = data["particle/member"] == row
            look = candidate.spec.materials[candidate.spec.entities[entity].material].appearance
            center = data["origin"] + data["particle/position"][own].astype(np.float64)
            found.append(Grains(entity, center, data["particle/radius"][own].astype(np.float64), np.array(look.color)))
    return found


class GrainLayer:
    """The particles of a candidate, cast beside its solids."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        self.entities = tuple(e for c in candidate.particle_caches.values() for e in c.index.bodies)
        looks = [candidate.spec.materials[candidate.spec.entities[e].material].appearance for e in self.entities]
        self.colors = np.array([look.color for look in looks], dtype=np.float32).reshape(-1, 3)
        self._kept: tuple[int, list[Grains]] | None = None

    def at(self, frame: int) -> list[Grains]:
        """Particles at a frame."""
        if self._kept is None or self._kept[0] != frame:
            self._kept = (frame, grains_at(self.candidate, frame))
        return self._kept[1]

    def over(self, solid: IdImage, frame: int, camera: Camera, first: int, entity: str | None = None) -> IdImage:
        """Particles in front of a cast picture; their ids count from `first`."""
        ids, depth, normals = solid.ids.copy(), solid.depth.astype(np.float32).copy(), solid.normals.copy()
        for k, grains in enumerate(self.at(frame)):
            if len(grains.center) and entity in (None, grains.entity):
                _splat(ids, depth, normals, grains, camera, first + k)
        return IdImage(ids, depth, normals)


def _splat(ids: I32, depth: Any, normals: Any, grains: Grains, camera: Camera, number: int) -> None:
    """Spheres into a picture, nearest first: every pixel of a sphere's square looks along its own ray."""
    height, width = ids.shape
    eye, directions = camera.rays()
    pixel, far = camera.project(grains.center)
    size = np.clip(grains.radius * camera.focal / np.maximum(far, 1e-9), LEAST_PIXELS, MOST_PIXELS)
    seen = (
        (far > 0) & (pixel[:, 0] > -size) & (pixel[:, 0] < width + size) & (pixel[:, 1] > -size) & (pixel[:, 1] < height + size)
    )
    center, pixel, far, size = grains.center[seen], pixel[seen], far[seen], size[seen]
    if not len(center):
        return
    radius = np.maximum(grains.radius[seen], size * far / camera.focal)
    reach = int(np.ceil(size.max())) + 1
    best = depth.reshape(-1).astype(np.float64)
    owner = np.full(best.shape, -1, dtype=np.int64)
    base = np.floor(pixel).astype(np.int64)
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            column, row = base[:, 0] + dx, base[:, 1] + dy
            near = np.flatnonzero(
                (np.hypot(dx, dy) <= size + 1.5) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
            )
            if not len(near):
                continue
            place = row[near] * width + column[near]
            ray = directions.reshape(-1, 3)[place]
            way = center[near] - eye
            along = (way * ray).sum(axis=1)
            gap = radius[near] ** 2 - ((way**2).sum(axis=1) - along**2)
            hit = gap >= 0
            t = along[hit] - np.sqrt(gap[hit])
            deep = t * -(ray[hit] @ camera.axes[2])
            at = place[hit]
            order = np.argsort(-deep, kind="stable")  # of several in one pixel the nearest is written last
            at, deep, who = at[order], deep[order], near[hit][order]
            closer = (deep > 0) & (deep < best[at])
            best[at[closer]], owner[at[closer]] = deep[closer], who[closer]
    drawn = np.flatnonzero(owner >= 0)
    if not len(drawn):
        return
    ray = directions.reshape(-1, 3)[drawn]
    t = best[drawn] / -(ray @ camera.axes[2])
    out = eye + t[:, None] * ray - center[owner[drawn]]
    ids.reshape(-1)[drawn] = number
    depth.reshape(-1)[drawn] = best[drawn].astype(depth.dtype)
    normals.reshape(-1, 3)[drawn] = (out / np.maximum(np.linalg.norm(out, axis=1), 1e-12)[:, None]).astype(normals.dtype)


def ball_mesh(grains: Grains) -> TriangleMesh:
    """All grains of an entity as one mesh of icosahedra."""
    return TriangleMesh(*joined_balls(grains.center, grains.radius))


def _fine_balls(center: F64, radius: F64) -> tuple[F64, F64, I32]:
    """Balls of 42 vertices each: positions, normals, faces."""
    corner, faces = joined_balls(np.zeros((1, 3)), np.ones(1))
    edges: dict[tuple[int, int], int] = {}
    points, finer = [*corner], []

    def middle(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in edges:
            point = points[a] + points[b]
            edges[key] = len(points)
            points.append(point / np.linalg.norm(point))
        return edges[key]

    for a, b, c in faces.tolist():
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    unit, triangles = np.array(points), np.array(finer, dtype=np.int32)
    vertices = center[:, None] + unit[None] * radius[:, None, None]
    number = triangles[None] + len(unit) * np.arange(len(center), dtype=np.int32)[:, None, None]
    return vertices.reshape(-1, 3), np.tile(unit, (len(center), 1)), number.reshape(-1, 3).astype(np.int32)


def grain_shapes(mi: Any, candidate: Candidate, frame: int) -> dict[str, Any]:
    """Shapes of all particles at a frame for Mitsuba, one per entity."""
    shapes: dict[str, Any] = {}
    for grains in grains_at(candidate, frame):
        if not len(grains.center):
            continue
        if len(grains.center) <= FINE:
            vertices, normals, faces = _fine_balls(grains.center, grains.radius)
        else:
            vertices, faces = joined_balls(grains.center, grains.radius)
            out = vertices - np.repeat(grains.center, 12, axis=0)
            normals = out / np.linalg.norm(out, axis=1)[:, None]
        look = candidate.spec.materials[candidate.spec.entities[grains.entity].material].appearance
        properties = mi.Properties()
        properties["mesh_bsdf"] = mi.load_dict(
            {"type": "principled", "base_color": {"type": "rgb", "value": list(look.color)}, "roughness": max(look.roughness, 0.05),
             "metallic": look.metallic, "specular": 0.5}
        )  # fmt: skip
        mesh = mi.Mesh(f"grains-{grains.entity}", len(vertices), len(faces), props=properties, has_vertex_normals=True)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = vertices.astype(np.float32).ravel()
        parameters["vertex_normals"] = normals.astype(np.float32).ravel()
        parameters["faces"] = faces.astype(np.uint32).ravel()
        parameters.update()
        shapes[f"grains-{grains.entity}"] = mesh
    return shapes

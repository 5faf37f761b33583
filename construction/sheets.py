"""Cloth parts (R54, R63): one surface that is drawn and simulated, seen from both sides; of one that can tear, corner by corner."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..worlds.arrays import F64, I32, RigidPose, pose_of
from ..worlds.built import BuiltBody, BuiltEntity, BuiltPart, TriangleMesh
from ..worlds.categories.cloth.facts import sheet_grid
from ..worlds.categories.cloth.tears import corners_of
from ..worlds.errors import InputError
from ..worlds.simulation_mesh import SimulationMesh
from ..worlds.spec import Entity, Part, WorldSpec
from .imports import load_surface

__all__ = ["build_cloth"]

LEAST = 1e-12
"""Least area of a triangle [m^2]."""


def build_cloth(spec: WorldSpec, name: str, entity: Entity, assets: Path, recipe: str) -> BuiltEntity:
    """Surfaces, simulation meshes and mass of a cloth entity.

    Raises:
        InputError: a part is neither sheet nor mesh, or its triangles have no area.
    """
    physics = entity.physics
    if physics.category != "cloth":
        raise InputError(f"/entities/{name}: {physics.category} is no cloth")
    parts, weights, points = [], [], []
    for key, part in sorted(entity.parts.items()):
        vertices, faces = _surface(part, assets, f"/entities/{name}/parts/{key}/shape")
        vertices = pose_of(part.pose).apply(vertices)
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        if area.min(initial=np.inf) < LEAST:
            raise InputError(f"/entities/{name}/parts/{key}/shape: triangle {int(area.argmin())} has no area; merge its vertices")
        if physics.tear is not None:
            vertices, faces = corners_of(vertices, faces)
        count = len(vertices)
        mesh = SimulationMesh(
            vertices,
            faces,
            np.empty((0, 4), dtype=np.int32),
            np.repeat(np.arange(count, dtype=np.int32)[:, None], 4, axis=1),
            np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
        )
        parts.append(
            BuiltPart(
                part=key,
                body="body",
                material=part.material or entity.material,
                render=TriangleMesh(vertices, faces),
                collision=(),
                closed=False,
                deviation=(0.0, 0.0),
                smooth=True,
                simulation=mesh,
            )
        )
        weights.append(np.bincount(faces.ravel(), np.repeat(area / 3.0, 3), minlength=count))
        points.append(vertices)
    mass, place = physics.area_density * np.concatenate(weights), np.concatenate(points)
    total = float(mass.sum())
    center = mass @ place / total
    arm = place - center
    inertia = np.eye(3) * float(mass @ (arm**2).sum(1)) - (arm * mass[:, None]).T @ arm
    pose = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    body = BuiltBody("body", pose, total, center, inertia, total / physics.area_density * physics.thickness)
    return BuiltEntity(name, (body,), tuple(parts), recipe)


def _surface(part: Part, assets: Path, where: str) -> tuple[F64, I32]:
    if part.shape.kind == "sheet":
        return sheet_grid(part.shape)
    if part.shape.kind != "mesh":
        raise InputError(f"{where}: cloth is made of sheets or meshes, not of {part.shape.kind}")
    try:
        return load_surface(part.shape, assets)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error

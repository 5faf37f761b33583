"""Specification -> built entity (R52-R54): geometry, mass properties, and the measured deviation between shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.inside import contains, distance_to_surface
from ..geometry.solids import Solid
from ..worlds.arrays import F64, I32, RigidPose, compose, pose_of, rotation_matrix
from ..worlds.built import BuiltBody, BuiltEntity, BuiltPart, Convex, TriangleMesh
from ..worlds.canonical import digest_of, source_digest
from ..worlds.errors import InputError, LimitError
from ..worlds.slices import MOTION_VERSION, geometry_slice
from ..worlds.spec import ElasticPhysics, Entity, Part, RigidPhysics, Rope, WorldSpec
from .fracture.build import Whole, build_pieces
from .imports import mesh_digest
from .kept_shapes import kept_shape
from .primitives import ShapeGeometry, build_shape
from .ropes import rope_segments
from .sheets import build_cloth
from .soft import soft_part

__all__ = ["build_entity", "entity_recipe"]

EXACT_KINDS = ("box", "wedge", "extrusion", "revolution", "hull")
"""Shapes whose collision pieces tile the visible mesh exactly."""
VOLUMES = (1e-24, 1e24)
"""Volumes of bodies [m^3]: from a cube of 10 nm to beyond the Moon. Further out, products of sizes leave double precision."""
IDENTITY = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


def entity_recipe(spec: WorldSpec, name: str, assets: Path) -> str:
    """Hash of everything a built entity derives from: its slice, mesh files, and this folder's source.

    Raises:
        InputError: a material is not declared.
    """
    entity = spec.entities[name]
    for material in {entity.material, *(p.material for p in entity.parts.values() if p.material is not None)}:
        if material not in spec.materials:
            raise InputError(f"entity {name!r} uses material {material!r} which is not declared; add /materials/{material}")
    files = {}
    for part in entity.parts.values():
        if part.shape.kind == "mesh" and part.shape.file is not None:
            files[part.shape.file] = mesh_digest(assets, part.shape.file)
    return digest_of(MOTION_VERSION, geometry_slice(spec, name), files, source_digest(Path(__file__).parent))


def _placed(mesh: TriangleMesh, pose: RigidPose) -> TriangleMesh:
    return TriangleMesh(pose.apply(mesh.vertices), mesh.faces)


def _moved(piece: Convex, pose: RigidPose) -> Convex:
    if piece.kind == "hull":
        return Convex("hull", (), IDENTITY, compose(pose, piece.pose).apply(piece.points))
    return Convex(piece.kind, piece.params, compose(pose, piece.pose), piece.points)


def _samples(vertices: F64, faces: I32) -> F64:
    """Vertices, edge midpoints and centres of triangles, shape (n, 3)."""
    corners = vertices[faces]
    return np.concatenate([vertices, corners.mean(1), *(0.5 * (corners[:, k] + corners[:, (k + 1) % 3]) for k in range(3))])


def _deviation(shape_kind: str, geometry: ShapeGeometry) -> tuple[float, float]:
    """Two-sided deviation [m] between collision pieces and visible mesh, measured at `_samples` of both."""
    from scipy.spatial import ConvexHull, cKDTree

    if shape_kind in EXACT_KINDS:
        return (0.0, 0.0)
    if shape_kind not in ("mesh", "sweep"):
        return (geometry.facet_error, 0.0)
    visible = Solid.from_mesh(geometry.render, closed=True)
    outside = 0.0
    samples = _samples(geometry.render.vertices, geometry.render.faces)
    reach, tree = np.full(len(samples), np.inf), cKDTree(samples)
    hulls = [ConvexHull(piece.points) for piece in geometry.collision]
    owns = [_samples(piece.points, h.simplices.astype(np.int32)) for piece, h in zip(geometry.collision, hulls, strict=True)]
    # No point is further from the surface than from a sample of it: those that are nearer than the furthest so far need no look.
    bounds = [tree.query(own)[0] for own in owns]
    for k in sorted(range(len(owns)), key=lambda k: -float(bounds[k].max())):
        own = owns[k][bounds[k] > outside]
        own = own[~contains(visible, own)]
        outside = max(outside, float(distance_to_surface(visible, own).distance.max(initial=0.0)))
    for hull in hulls:
        planes = hull.equations
        reach = np.minimum(reach, (samples @ planes[:, :3].T + planes[:, 3]).max(1))
    return (outside, max(0.0, float(reach.max(initial=0.0))))


def _mass_of(geometry: ShapeGeometry, density: float) -> tuple[float, F64, F64, float]:
    """Mass [kg], centre (3,), inertia about it (3, 3), volume [m^3] in the part's frame."""
    if geometry.mass is not None:
        volume, center, inertia = geometry.mass
        return density * volume, center, density * inertia, volume
    solid = Solid.from_mesh(geometry.render, closed=True)
    return density * solid.volume, solid.center, solid.inertia(density), solid.volume


def _combine(pieces: list[tuple[float, F64, F64, float]]) -> tuple[float, F64, F64, float]:
    """Parallel-axis sum of masses in one frame."""
    total = sum(p[0] for p in pieces)
    center = sum((p[0] * p[1] for p in pieces), start=np.zeros(3)) / (total or 1.0)
    inertia = np.zeros((3, 3))
    for mass, where, own, _ in pieces:
        arm = where - center
        inertia += own + mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return total, center, inertia, sum(p[3] for p in pieces)


def _body(name: str, pose: RigidPose, masses: list[tuple[float, F64, F64, float]], scale: float) -> BuiltBody:
    """A body of these parts.

    Raises:
        InputError: it has no volume or mass that can be computed with.
    """
    mass, center, inertia, volume = _combine(masses)
    sound = np.isfinite(center).all() and np.isfinite(inertia).all() and (np.diag(inertia) > 0).all()
    if not (sound and VOLUMES[0] < volume < VOLUMES[1] and 0 < mass < np.inf and 0 < mass * scale < np.inf):
        raise InputError(
            f"{name!r} has volume {volume:.3g} m^3 and mass {mass * scale:.3g} kg; a body needs a mass, and a volume from "
            f"{VOLUMES[0]:g} to {VOLUMES[1]:g} m^3. Lengths are in m: check the sizes of its parts"
        )
    return BuiltBody(name, pose, mass * scale, center, inertia * scale, volume)


def _build_part(
    spec: WorldSpec, entity: Entity, name: str, part: Part, assets: Path, body: str, where: str
) -> tuple[BuiltPart, Any]:
    try:
        kept = kept_shape(part.shape, assets)
    except InputError as error:
        raise InputError(f"{where}/parts/{name}/shape: {error}") from error
    material = part.material or entity.material
    geometry, pose, density = kept.geometry, pose_of(part.pose), spec.materials[material].density
    mass, center, inertia, volume = kept.measured(("mass", density), lambda: _mass_of(geometry, density))
    turn = rotation_matrix(pose.quaternion)
    built = BuiltPart(
        part=name,
        body=body,
        material=material,
        render=_placed(geometry.render, pose),
        collision=tuple(_moved(c, pose) for c in geometry.collision) if part.collides else (),
        closed=True,
        deviation=kept.measured("deviation", lambda: _deviation(part.shape.kind, geometry)),
        smooth=geometry.smooth,
    )
    return built, (mass, pose.apply(center[None])[0], turn @ inertia @ turn.T, volume)


def _build_rope(spec: WorldSpec, name: str, entity: Entity, rope: Rope, assets: Path) -> tuple[list[BuiltBody], list[BuiltPart]]:
    bodies, parts, scale = [], [], 1.0
    for k, (shape, pose) in enumerate(rope_segments(rope)):
        part, mass = _build_part(spec, entity, f"seg{k:03d}", Part(shape=shape), assets, f"seg{k:03d}", f"/entities/{name}")
        bodies.append(_body(part.body, pose, [mass], scale))
        parts.append(part)
    declared = entity.physics.mass if isinstance(entity.physics, RigidPhysics) else None
    if declared is not None:
        scale = declared / (sum(b.mass for b in bodies) or 1.0)
        bodies = [BuiltBody(b.name, b.pose, b.mass * scale, b.center, b.inertia * scale, b.volume) for b in bodies]
    return bodies, parts


def _whole(spec: WorldSpec, entity: Entity, name: str, part: Part, assets: Path, where: str) -> Whole:
    """A part of a breakable entity as convex tiles in the entity's frame.

    Raises:
        InputError: the part has no exact tiles.
    """
    geometry = build_shape(part.shape, assets)
    pose, material = pose_of(part.pose), part.material or entity.material
    tiles = tuple(pose.apply(_moved(c, IDENTITY).points) for c in geometry.collision if c.kind == "hull")
    if part.shape.kind not in EXACT_KINDS or part.shape.kind == "box":
        if not Solid.from_mesh(geometry.render, closed=True).convex:
            raise InputError(
                f"{where}/parts/{name}: a breakable part must be convex, an extrusion or a revolution; {part.shape.kind!r} is neither"
            )
        tiles = (pose.apply(geometry.render.vertices),)
    if not part.collides:
        raise InputError(f"{where}/parts/{name}: a part of a breakable entity must collide; its pieces do")
    return Whole(name, material, spec.materials[material].density, tiles, geometry.smooth)


def _build_breakable(spec: WorldSpec, name: str, entity: Entity, assets: Path, recipe: str) -> BuiltEntity:
    assert entity.breakable is not None
    where = f"/entities/{name}"
    wholes = [_whole(spec, entity, k, p, assets, where) for k, p in sorted(entity.parts.items())]
    made = build_pieces(name, wholes, entity.breakable)
    declared = entity.physics.mass if isinstance(entity.physics, RigidPhysics) else None
    scale = 1.0 if declared is None else declared / sum(b.mass for b in made.bodies)
    bodies = tuple(BuiltBody(b.name, b.pose, b.mass * scale, b.center, b.inertia * scale, b.volume) for b in made.bodies)
    return BuiltEntity(name, bodies, tuple(made.parts), recipe, made.bonds)


def build_entity(spec: WorldSpec, name: str, assets: Path) -> BuiltEntity:
    """Build the geometry of one entity.

    Args:
        spec: the specification.
        name: entity id.
        assets: the world's assets folder, for mesh files.

    Raises:
        InputError: a shape is no closed solid, a mesh file is missing, or a material is not declared.
    """
    entity = spec.entities[name]
    recipe = entity_recipe(spec, name, assets)
    if entity.physics.category == "cloth":
        return build_cloth(spec, name, entity, assets, recipe)
    if entity.generator is not None:
        bodies, parts = _build_rope(spec, name, entity, entity.generator, assets)
        return BuiltEntity(name, tuple(bodies), tuple(parts), recipe)
    if entity.breakable is not None:
        return _build_breakable(spec, name, entity, assets, recipe)
    # JSON objects have no order, and equal specifications must give equal geometry: sums depend on it.
    made = [_build_part(spec, entity, k, p, assets, "body", f"/entities/{name}") for k, p in sorted(entity.parts.items())]
    masses = [m for _, m in made]
    declared = entity.physics.mass if isinstance(entity.physics, RigidPhysics) else None
    scale = 1.0 if declared is None else declared / (sum(m[0] for m in masses) or 1.0)
    try:
        body = _body("body", IDENTITY, masses, scale)
    except InputError as error:
        raise InputError(f"/entities/{name}: {error}") from error
    parts = [p for p, _ in made]
    if isinstance(entity.physics, ElasticPhysics):
        if len(parts) != 1:
            raise InputError(f"/entities/{name}/parts: an elastic body has one part, not {len(parts)}; make the others entities")
        try:
            parts = [soft_part(parts[0], entity.physics)]
        except (InputError, LimitError) as error:
            raise type(error)(f"/entities/{name}: {error}") from error
    return BuiltEntity(name, (body,), tuple(parts), recipe)

"""Measured motion of bodies: centres, velocities, turning, energy. Reads caches and built geometry only.

Every function returns one value per inspected frame, first axis `frames`. An entity that the specification says
moves but that no cache holds is missing evidence, never a body at rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, RigidPose, rotation_matrix
from ...worlds.errors import EvidenceError

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Entity

__all__ = [
    "angles",
    "asleep",
    "caches_with",
    "carried",
    "centers",
    "entity_mass",
    "entity_poses",
    "fastest_points",
    "kinetic_energy",
    "require_motion",
    "scene_box",
    "spins",
    "velocities",
]

MOST_POINTS = 400_000
"""Vertices times frames up to which the fastest point is taken over all vertices; above, over their box."""


def require_motion(candidate: Candidate, entity: str) -> Entity:
    """The entity's contract, once there is evidence of its motion at the inspected frames.

    Raises:
        EvidenceError: no such entity, or it moves and no cache holds it.
    """
    contract = candidate.spec.entities.get(entity)
    if contract is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    candidate.entity(entity)
    if contract.motion != "static" and candidate.stage != "static" and not candidate.moves(entity):
        raise EvidenceError(
            f"no cache holds the motion of {entity!r} ({contract.motion}); list it as a member of a solver and bake"
        )
    return contract


def _rotations(quaternions: F64) -> F64:
    with np.errstate(invalid="ignore", over="ignore"):
        return rotation_matrix(quaternions)


def entity_mass(candidate: Candidate, entity: str) -> float:
    """Mass of all bodies [kg]."""
    return float(sum(b.mass for b in candidate.entity(entity).bodies))


def entity_poses(candidate: Candidate, entity: str) -> tuple[F64, F64]:
    """Positions [m], shape (frames, 3), and quaternions, shape (frames, 4), of the entity's first body."""
    require_motion(candidate, entity)
    return candidate.track(entity, candidate.entity(entity).bodies[0].name)


def _body_centers(candidate: Candidate, entity: str, body: str) -> F64:
    positions, quaternions = candidate.track(entity, body)
    with np.errstate(invalid="ignore", over="ignore"):
        centers: F64 = _rotations(quaternions) @ candidate.body(entity, body).center + positions
    return centers


def centers(candidate: Candidate, entity: str) -> F64:
    """Centre of mass of the whole entity in the world [m], shape (frames, 3)."""
    require_motion(candidate, entity)
    bodies = candidate.entity(entity).bodies
    total = entity_mass(candidate, entity)
    weights = [b.mass / total if total > 0 else 1 / len(bodies) for b in bodies]
    tracks = [w * _body_centers(candidate, entity, b.name) for w, b in zip(weights, bodies, strict=True)]
    result: F64 = np.sum(tracks, axis=0)
    return result


def _body_channel(candidate: Candidate, entity: str, body: str, channel: str) -> F64:
    """`velocity` or `angular_velocity` of one body, shape (frames, 3)."""
    if entity in candidate.deforming:
        soft = candidate.deforming[entity]
        return np.stack([soft.velocity(k) if channel == "velocity" else soft.spin(k) for k in range(candidate.frame_count)])
    place = candidate.cache_row(entity, body)
    if place is not None:
        cache, row = place
        series: F64 = cache.series(channel)[: candidate.frame_count, row]
        return series
    contract = candidate.spec.entities[entity]
    initial = (0.0, 0.0, 0.0)
    if contract.motion == "dynamic" and contract.physics.category == "rigid":
        initial = contract.physics.linear_velocity if channel == "velocity" else contract.physics.angular_velocity
    return np.repeat(np.array(initial, dtype=np.float64)[None], candidate.frame_count, 0)


def carried(positions: F64, quaternions: F64, local: F64) -> F64:
    """Path of a point of a body [m], shape (frames, 3), from the body's motion and the point in its frame, shape (3,)."""
    with np.errstate(invalid="ignore", over="ignore"):
        path: F64 = _rotations(quaternions) @ local + positions
    return path


def velocities(candidate: Candidate, entity: str) -> F64:
    """Velocity of the centre of mass [m/s], shape (frames, 3)."""
    require_motion(candidate, entity)
    bodies = candidate.entity(entity).bodies
    total = entity_mass(candidate, entity)
    tracks = [
        (b.mass / total if total > 0 else 1 / len(bodies)) * _body_channel(candidate, entity, b.name, "velocity") for b in bodies
    ]
    result: F64 = np.sum(tracks, axis=0)
    return result


def spins(candidate: Candidate, entity: str) -> F64:
    """Largest angular speed of its bodies [rad/s], shape (frames,)."""
    require_motion(candidate, entity)
    tracks = [_body_channel(candidate, entity, b.name, "angular_velocity") for b in candidate.entity(entity).bodies]
    result: F64 = np.max([np.linalg.norm(t, axis=1) for t in tracks], axis=0)
    return result


def fastest_points(candidate: Candidate, entity: str) -> F64:
    """Speed of the entity's fastest visible point [m/s], shape (frames,).

    The speed is convex in the point, so its maximum over a body lies at a vertex.
    """
    require_motion(candidate, entity)
    if entity in candidate.deforming:
        soft = candidate.deforming[entity]
        return np.array([np.linalg.norm(soft.velocities(k), axis=1).max() for k in range(candidate.frame_count)])
    built = candidate.entity(entity)
    speeds = []
    for body in built.bodies:
        _, quaternions = candidate.track(entity, body.name)
        rotations = _rotations(quaternions)
        linear = _body_channel(candidate, entity, body.name, "velocity")
        angular = _body_channel(candidate, entity, body.name, "angular_velocity")
        parts = built.parts_of(body.name)
        points = np.concatenate([p.render.vertices for p in parts]) if parts else body.center[None]
        arms = _corners(points, MOST_POINTS // max(1, len(linear))) - body.center
        with np.errstate(invalid="ignore", over="ignore"):
            world = np.einsum("fij,vj->fvi", rotations, arms)
            exact = np.linalg.norm(linear[:, None] + np.cross(angular[:, None], world), axis=2).max(axis=1)
            reach = np.linalg.norm(points - body.center, axis=1).max()
            bound = np.linalg.norm(linear, axis=1) + np.linalg.norm(angular, axis=1) * reach
            speeds.append(np.minimum(exact, bound))
    result: F64 = np.max(speeds, axis=0)
    return result


def _corners(vertices: F64, most: int) -> F64:
    """The vertices, or the corners of their box (which bound them) where there are more than `most`."""
    if len(vertices) <= most:
        return vertices
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def angles(candidate: Candidate, entity: str, axis: F64) -> F64:
    """Angle [rad] between the entity's own `axis` and where that axis pointed at frame 0, shape (frames,)."""
    _, quaternions = entity_poses(candidate, entity)
    with np.errstate(invalid="ignore", over="ignore"):
        turned = _rotations(quaternions) @ (axis / np.linalg.norm(axis))
        # atan2 of cross and dot keeps its precision near 0 and pi, where arccos loses half the digits.
        cross = np.linalg.norm(np.cross(turned[0], turned), axis=1)
        result: F64 = np.arctan2(cross, turned @ turned[0])
    return result


def asleep(candidate: Candidate, entity: str) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """True where all moving bodies of the entity sleep, shape (frames,); all false where no cache says so."""
    flags = np.ones(candidate.frame_count, dtype=bool)
    for body in candidate.entity(entity).bodies:
        place = candidate.cache_row(entity, body.name)
        if place is None:
            return np.zeros(candidate.frame_count, dtype=bool)
        cache, row = place
        flags &= cache.series("asleep")[: candidate.frame_count, row].astype(bool)
    return flags


def caches_with(candidate: Candidate, *entities: str) -> list[Cache]:
    """Caches whose contact channels can speak of all the entities.

    Raises:
        EvidenceError: none does.
    """
    found = [c for c in candidate.rigid_caches.values() if set(entities) <= set(c.index.colliders)]
    if not found:
        raise EvidenceError(f"no cache has {' and '.join(map(repr, entities))} among its colliders; bake with both as members")
    return found


def kinetic_energy(candidate: Candidate, cache: Cache) -> F64:
    """Kinetic energy per body, computed from velocities and mass properties [J], shape (frames, bodies)."""
    frames = cache.index.frames
    linear, angular, turns = (cache.series(n) for n in ("velocity", "angular_velocity", "quaternion"))
    result = np.zeros((frames, len(cache.index.bodies)))
    for row, name in enumerate(cache.index.bodies):
        body = candidate.body(*name.split("/", 1))
        with np.errstate(invalid="ignore", over="ignore"):
            local = np.einsum("fji,fj->fi", _rotations(turns[:, row]), angular[:, row])
            result[:, row] = 0.5 * body.mass * np.sum(linear[:, row] ** 2, axis=1)
            result[:, row] += 0.5 * np.einsum("fi,ij,fj->f", local, body.inertia, local)
    return result


def scene_box(candidate: Candidate) -> tuple[F64, F64]:
    """Lowest and highest corner of all built entities at frame 0 as specified [m], shapes (3,)."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for name in candidate.built:
        if name not in candidate.spec.entities:
            continue
        for part in candidate.entity(name).parts:
            points = _initial_pose(candidate, name, part.body).apply(part.render.vertices)
            if np.isfinite(points).all():
                low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    if not np.isfinite(low).all():
        raise EvidenceError("no entity is built; call place_object")
    return low, high


def _initial_pose(candidate: Candidate, entity: str, body: str) -> RigidPose:
    return candidate.pose(entity, 0, body)

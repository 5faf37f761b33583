"""Facts of cloth that the specification alone tells: vertices, steps, pinned vertices, distance at which layers touch (R63, R64)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import F64, I32, pose_of
from ...instances import coupled_groups

if TYPE_CHECKING:
    from ...spec import ClothPhysics, ClothPin, Entity, Sheet, WorldSpec

__all__ = [
    "THIN",
    "ClothEstimate",
    "cloth_counts",
    "cloth_estimate",
    "cloth_seconds",
    "exchange_of",
    "grids_of",
    "held_by",
    "pins_of",
    "release_time",
    "rest_way",
    "sheet_grid",
    "stiffest_step",
    "tears",
    "touching_distance",
    "vertices_by_part",
    "vertices_of",
]

THIN = 0.35
"""Own choice: layers touch at no more than this share of the shortest edge, else neighbours in a flat sheet touch."""
MARGIN = 0.15
"""Own choice: distance of contact in shortest edges where none is declared: contact stays smooth where triangles meet triangles."""
STIFFEST = 2.6
"""Highest frequency of a square grid of triangles times its edge over the speed of sound in it, measured on 30 x 30 squares."""
CORNERS = 6
"""Corners of triangles per vertex of a large sheet."""
CLOSELY = 1e-3
"""Longest time between two exchanges of impulses with bodies that the cloth pushes, and between two looks at what tears [s]."""
CACHE_BYTES_PER_VERTEX_FRAME = 36
"""Position in float64 and velocity in float32 [bytes]."""
VERTEX_STEPS = 1.5e5
"""Vertices times steps a second of a hung sheet, what it meets included: a usual rate. Own measurement."""
ON_EDGE = 1e-6
"""Share of a sheet's size within which a vertex lies on its edge."""


class ClothEstimate(NamedTuple):
    """Amounts that an instance will take."""

    vertices: float
    steps: float
    """Steps of the whole run, preroll included."""
    written: float
    """Vertices of its frames: those of sheets that can tear are corners of triangles."""


def sheet_grid(shape: Sheet) -> tuple[F64, I32]:
    """Vertices (n, 3) [m] and faces (m, 3) of a sheet, facing +z: squares as even as they go, their diagonals in turn."""
    x, y = shape.size
    columns, rows = (max(1, math.ceil(length / shape.resolution - 1e-9)) for length in (x, y))
    u, v = np.meshgrid(np.linspace(-x / 2, x / 2, columns + 1), np.linspace(-y / 2, y / 2, rows + 1))
    points = np.stack([u.ravel(), v.ravel(), np.zeros(u.size)], axis=1)
    a = np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)
    b, c = a + 1, a + columns + 1
    d = c + 1
    even = ((np.arange(rows)[:, None] + np.arange(columns)) % 2 == 0)[..., None]
    one = np.where(even, np.stack([a, b, d], -1), np.stack([a, b, c], -1))
    two = np.where(even, np.stack([a, d, c], -1), np.stack([b, d, c], -1))
    return points, np.stack([one, two], axis=2).reshape(-1, 3).astype(np.int32)


def held_by(pin: ClothPin, vertices: F64) -> I32:
    """Vertices (k,) of an entity that a pin holds, given all of them in its frame (n, 3) [m]."""
    if pin.edge is not None:
        axis, side = "xyz".index(pin.edge[1]), 1.0 if pin.edge[0] == "+" else -1.0
        along = side * vertices[:, axis]
        found = np.flatnonzero(along >= along.max() - ON_EDGE * max(float(np.ptp(vertices, axis=0).max()), 1e-9))
    else:
        distance = np.linalg.norm(vertices - np.array(pin.center), axis=1)
        nearest = vertices[distance.argmin()]
        found = np.flatnonzero(distance <= pin.radius if pin.radius > 0 else (vertices == nearest).all(axis=1))
    return np.asarray(found, dtype=np.int32)


def pins_of(entity: Entity) -> dict[str, ClothPin]:
    """Pins of a cloth entity by id."""
    return entity.physics.pins if entity.physics.category == "cloth" else {}


def tears(spec: WorldSpec, name: str) -> bool:
    """True if an entity is cloth that can tear."""
    entity = spec.entities.get(name)
    return entity is not None and entity.physics.category == "cloth" and entity.physics.tear is not None


def touching_distance(thickness: float, shortest: float, margin: float | None) -> float:
    """Distance at which two layers of a sheet touch [m]; a sheet and a solid at half of it.

    Args:
        thickness: of the sheet [m].
        shortest: edge of it [m].
        margin: what the settings declare [m].
    """
    return max(thickness, MARGIN * shortest if margin is None else margin)


def grids_of(entity: Entity) -> list[tuple[float, float]]:
    """(vertices, shortest edge [m]) of every part that the specification itself describes."""
    found: list[tuple[float, float]] = []
    for part in entity.parts.values():
        if part.shape.kind == "sheet":
            count = [max(1, math.ceil(length / part.shape.resolution - 1e-9)) for length in part.shape.size]
            found.append(
                (math.prod(n + 1 for n in count), min(length / n for length, n in zip(part.shape.size, count, strict=True)))
            )
        elif part.shape.kind == "mesh" and part.shape.vertices is not None and part.shape.faces is not None:
            corner = (np.array(part.shape.vertices) * part.shape.scale)[
                np.array(part.shape.faces).clip(0, len(part.shape.vertices) - 1)
            ]
            edges = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)
            found.append((len(part.shape.vertices), float(edges.min(initial=math.inf))))
    return found


def stiffest_step(physics: ClothPhysics, edge: float) -> float:
    """About the longest step [s] that a sheet with edges of this length [m] allows."""
    stiff = max(physics.stretch_stiffness, physics.weft_stiffness or 0.0, physics.shear_stiffness or 0.0)
    frequency = STIFFEST * math.sqrt(stiff / physics.area_density) / edge * math.sqrt(2.0)
    bend = 8.0 * math.sqrt(3.0 * physics.bend_stiffness / physics.area_density) / edge**2
    highest = math.hypot(frequency, bend)
    slow = physics.damping * highest
    return (math.sqrt(slow * slow + 4.0) - slow) / highest


def cloth_estimate(spec: WorldSpec, name: str) -> ClothEstimate:
    """Vertices and steps that an instance will take; meshes in files are counted when they are read."""
    plan, instance = spec.simulation, spec.simulation.cloth[name]
    seconds = plan.lead + (plan.frames - 1) / plan.fps
    vertices, written, step = 0.0, 0.0, instance.settings.max_step
    for member in instance.members:
        entity = spec.entities.get(member)
        if entity is None or entity.physics.category != "cloth":
            continue
        for count, edge in grids_of(entity):
            vertices += count
            written += count * (1 if entity.physics.tear is None else CORNERS)
            if edge > 0 and math.isfinite(edge):
                step = min(step, stiffest_step(entity.physics, edge))
    return ClothEstimate(vertices, seconds / step, written)


def cloth_counts(spec: WorldSpec) -> dict[str, float]:
    """Amounts that the cloth of a specification takes, by name of the cap."""
    found = [cloth_estimate(spec, name) for name in spec.simulation.cloth]
    return {
        "steps": sum(e.steps for e in found),
        "vertices": sum(e.vertices for e in found),
        "vertex_steps": sum(e.vertices * e.steps for e in found),
        "cache_bytes": sum(e.written for e in found) * spec.simulation.frames * CACHE_BYTES_PER_VERTEX_FRAME,
    }


def cloth_seconds(spec: WorldSpec) -> float | None:
    """Seconds that the cloth of a world will take by a usual rate; None without any."""
    return cloth_counts(spec)["vertex_steps"] / VERTEX_STEPS if spec.simulation.cloth else None


def exchange_of(spec: WorldSpec, name: str) -> float:
    """Time between two looks of an instance at what it meets [s]: no step is longer."""
    settings, members = spec.simulation.cloth[name].settings, spec.simulation.cloth[name].members
    closely = any(name in group for group in coupled_groups(spec)) or any(tears(spec, m) for m in members)
    return settings.exchange or min(settings.max_step, CLOSELY if closely else settings.max_step)


def release_time(spec: WorldSpec, name: str, without: frozenset[str] = frozenset()) -> float:
    """When an instance starts to move [s]: at the last release of its members; never where such a driver is taken away."""
    members, time = spec.simulation.cloth[name].members, -math.inf
    for key, driver in spec.simulation.drivers.items():
        if driver.kind == "release" and driver.entity in members:
            time = max(time, math.inf if key in without else driver.time)
    return time


def vertices_of(entity: Entity) -> F64 | None:
    """Vertices of a cloth entity in its frame (n, 3) [m]; None where a part is a file."""
    found = vertices_by_part(entity)
    return np.concatenate([found[key] for key in sorted(found)]) if found and len(found) == len(entity.parts) else None


def vertices_by_part(entity: Entity) -> dict[str, F64]:
    """Vertices of each part of a cloth entity in the entity's frame (n, 3) [m]; those that are files left out."""
    found = {}
    for key, part in entity.parts.items():
        if part.shape.kind == "sheet":
            found[key] = pose_of(part.pose).apply(sheet_grid(part.shape)[0])
        elif part.shape.kind == "mesh" and part.shape.vertices is not None:
            found[key] = pose_of(part.pose).apply(np.array(part.shape.vertices) * part.shape.scale)
    return found


def rest_way(spec: WorldSpec, name: str) -> float:
    """Farthest that a sheet at rest may move in half a second [m]: the distance at which its layers touch, of a file its thickness."""
    entity = spec.entities[name]
    margin = next((i.settings.margin for i in spec.simulation.cloth.values() if name in i.members), None)
    shortest = min((edge for _, edge in grids_of(entity)), default=0.0)
    return touching_distance(entity.physics.sheet_thickness, shortest, margin)

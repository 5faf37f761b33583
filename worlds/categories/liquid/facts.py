"""What the specification alone says about its liquids: volumes, particles, steps, and what cannot work (R57, R58).

Geometry is not built here: solids are known by their declared boxes. What only their surfaces tell (a source inside a
wall, a passage that is too narrow) is refused when the liquid is set up.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import F64, pose_of

if TYPE_CHECKING:
    from ...shapes import Shape
    from ...spec import Entity, InflowDriver, LiquidInstance, WorldSpec

__all__ = [
    "LEAST_MOUTH",
    "LEAST_SPACINGS",
    "LiquidEstimate",
    "declares_heat",
    "domain_box",
    "inflows_of",
    "initial_box",
    "least_extent",
    "liquid_estimate",
    "shape_volume",
    "spacing_of",
]

LEAST_SPACINGS = 3.0
"""Own choice: a layer of liquid or an opening thinner than so many spacings is not resolved."""
LEAST_MOUTH = {"dfsph": LEAST_SPACINGS, "flip": 2.0}
"""Own choice: narrowest inflow in spacings, by engine. A grid gives layers of markers half a cell apart."""
USUAL_TEMPERATURE = 293.15


class LiquidEstimate(NamedTuple):
    """What an instance will take."""

    particles: float
    """At most at one time."""
    steps: float
    """Of the whole run, preroll included."""
    cells: float
    """Of its grid; 0 for particles."""


def spacing_of(spec: WorldSpec, name: str) -> float:
    """Distance of particles, or size of a cell, of an instance [m]: the finest of its members."""
    found = [
        getattr(spec.entities[m].physics, "resolution", math.inf)
        for m in spec.simulation.liquid[name].members
        if m in spec.entities
    ]
    return min(found, default=math.inf)


def declares_heat(spec: WorldSpec, name: str) -> bool:
    """Whether a member of an instance says anything about its temperature."""
    physics = [spec.entities[m].physics for m in spec.simulation.liquid[name].members if m in spec.entities]
    return any(
        p.category == "liquid" and (p.conductivity > 0 or p.activation > 0 or p.temperature != USUAL_TEMPERATURE) for p in physics
    )


def domain_box(instance: LiquidInstance) -> tuple[F64, F64]:
    """Least and greatest corner of a domain [m]."""
    center, half = np.array(instance.settings.domain.center), 0.5 * np.array(instance.settings.domain.size)
    return center - half, center + half


def inflows_of(spec: WorldSpec, name: str) -> dict[str, InflowDriver]:
    """Inflows into the liquids of an instance, by driver id."""
    members = spec.simulation.liquid[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "inflow" and d.entity in members}


def _corners(shape: Shape) -> F64 | None:
    """Corners of a box around a shape in its own frame (8, 3) [m]; None for files, which are not read here."""

    if shape.kind == "box" or shape.kind == "wedge":
        low, high = -0.5 * np.array(shape.size), 0.5 * np.array(shape.size)
    elif shape.kind == "sphere":
        high = np.full(3, shape.radius)
        low = -high
    elif shape.kind == "cylinder" or shape.kind == "capsule":
        half = 0.5 * shape.height if shape.kind == "cylinder" else 0.5 * shape.length + shape.radius
        high = np.array([shape.radius, shape.radius, half])
        low = -high
    elif shape.kind == "extrusion":
        plan = np.array(shape.polygon)
        low, high = np.array([*plan.min(0), -0.5 * shape.height]), np.array([*plan.max(0), 0.5 * shape.height])
    elif shape.kind == "revolution":
        profile = np.array(shape.profile)
        reach = profile[:, 0].max()
        low, high = np.array([-reach, -reach, profile[:, 1].min()]), np.array([reach, reach, profile[:, 1].max()])
    elif shape.kind == "mesh" and shape.vertices is not None:
        points = np.array(shape.vertices) * shape.scale
        low, high = points.min(0), points.max(0)
    else:
        return None
    return np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def initial_box(entity: Entity) -> tuple[F64, F64] | None:
    """Box around an entity's parts in the world [m]; None where a part is a file or generated."""
    found = []
    for part in entity.parts.values():
        corners = _corners(part.shape)
        if corners is None:
            return None
        found.append(pose_of(entity.pose).apply(pose_of(part.pose).apply(corners)))
    return (np.concatenate(found).min(0), np.concatenate(found).max(0)) if found else None


def least_extent(shape: Shape) -> float | None:
    """Least extent of a simple shape along its own axes [m]; None for what may be thinner than its box: files, meshes, wedges, plans."""
    corners = _corners(shape) if shape.kind in ("box", "sphere", "cylinder", "capsule") else None
    return None if corners is None else float(np.ptp(corners, axis=0).min())


def shape_volume(shape: Shape) -> float | None:
    """Volume of a shape [m^3], smooth ones without facets; None for files."""

    if shape.kind == "box":
        return math.prod(shape.size)
    if shape.kind == "wedge":
        return 0.5 * math.prod(shape.size)
    if shape.kind == "sphere":
        return 4 / 3 * math.pi * shape.radius**3
    if shape.kind == "cylinder":
        return math.pi * shape.radius**2 * shape.height
    if shape.kind == "capsule":
        return math.pi * shape.radius**2 * (shape.length + 4 / 3 * shape.radius)
    if shape.kind == "extrusion":
        x, y = np.array(shape.polygon).T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2 * shape.height
    if shape.kind == "revolution":
        r, z = np.array(shape.profile).T
        next_r, next_z = np.roll(r, -1), np.roll(z, -1)
        return abs(float(((r + next_r) * (r * next_z - next_r * z)).sum())) * math.pi / 3  # Pappus, by triangles from the origin
    if shape.kind == "mesh" and shape.vertices is not None:
        corner = (np.array(shape.vertices) * shape.scale)[np.array(shape.faces)]
        return abs(float(np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum())) / 6
    return None


def _volume(entity: Entity) -> float:
    """Initial volume [m^3]; a file's is taken as that of the entity's declared box."""
    volumes = [shape_volume(p.shape) for p in entity.parts.values()]
    known = [v for v in volumes if v is not None]
    return sum(known) if len(known) == len(volumes) else math.prod(entity.dimensions.size)


def _fastest(entity: Entity) -> float:
    """Largest speed of a liquid at frame 0 [m/s]."""
    physics = entity.physics
    currents = physics.currents.values() if physics.category == "liquid" else ()
    return max([math.hypot(*getattr(physics, "linear_velocity", (0, 0, 0))), *(v for c in currents for v in c.speeds)])


def liquid_estimate(spec: WorldSpec, name: str) -> LiquidEstimate:
    """Particles and steps that an instance will take, from its volume, inflows, domain and the fall through it."""
    plan, instance = spec.simulation, spec.simulation.liquid[name]
    spacing = spacing_of(spec, name)
    if not math.isfinite(spacing):
        return LiquidEstimate(0.0, 0.0, 0.0)
    seconds = plan.preroll + (plan.frames - 1) / plan.fps
    members = [spec.entities[m] for m in instance.members if m in spec.entities]
    volume = sum(_volume(m) for m in members)
    fastest = max((_fastest(m) for m in members), default=0.0)
    for inflow in inflows_of(spec, name).values():
        volume += inflow.area * inflow.flow_speed * max(0.0, min(inflow.end or seconds, seconds) - inflow.start)
        fastest = max(fastest, inflow.flow_speed)
    low, high = domain_box(instance)
    box = float(np.prod(high - low))
    fall = float(np.abs(high - low) @ np.abs(plan.gravity))
    speed = math.sqrt(fastest**2 + fall)  # half of the speed after a fall through the whole domain, squared: a usual mean
    settings = instance.settings
    step = min(settings.max_step, settings.cfl * spacing / max(speed, 1e-9))
    per_spacing = getattr(settings, "particles_per_cell", 1)
    cells = box / spacing**3 if instance.engine == "flip" else 0.0
    return LiquidEstimate(min(volume, box) / spacing**3 * per_spacing, seconds / step, cells)

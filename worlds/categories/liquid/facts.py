"""Facts of liquids that the specification alone tells: volumes, particles, steps (R57, R58).

Geometry is not built here: solids are known by their declared boxes. What only their surfaces tell (a source inside a
wall, a passage that is too narrow) is refused when the liquid is set up.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...extents import initial_volume
from ..loose import LooseEstimate, domain_box

if TYPE_CHECKING:
    from ...spec import Entity, InflowDriver, OutflowDriver, WorldSpec

__all__ = [
    "LEAST_MOUTH",
    "LEAST_SPACINGS",
    "LEAST_WALL",
    "WALL_SLACK",
    "declares_heat",
    "fastest",
    "gauge_of",
    "inflows_of",
    "liquid_estimate",
    "liquid_seconds",
    "spacing_of",
]

LEAST_SPACINGS = 3.0
"""Own choice: a layer of liquid or an opening thinner than so many spacings is not resolved."""
LEAST_MOUTH = {"dfsph": LEAST_SPACINGS, "flip": 2.0}
"""Own choice: narrowest inflow in spacings, by engine. A grid gives layers of markers half a cell apart."""
LEAST_WALL = {"dfsph": 0.5, "flip": 1.0}
"""Own choice: thickness of fixed walls in spacings, by engine. Particles are held by a layer of boundary particles on each side; a
grid sees a wall only where it covers a cell."""
WALL_SLACK = 0.01
"""Share by which a wall may be thinner than that: facets of round walls, and rounding."""
PARTICLE_STEPS = {"dfsph": 1.5e5, "flip": 1.0e6}
"""Per second on two cores of the development machine, by engine; told as an estimate before anything was measured."""
STEP_SECONDS = {"dfsph": 0.009, "flip": 0.035}
"""Time that a step takes besides, however few its particles [s]: measured as processor time of 150 to 5,300 particles, and of 8,400 to 32,000."""
USUAL_TEMPERATURE = 293.15


def spacing_of(spec: WorldSpec, name: str) -> float:
    """Distance of particles, or size of a cell, of an instance [m]: the finest of its members."""
    found = [
        getattr(spec.entities[m].physics, "resolution", math.inf)
        for m in spec.simulation.liquid[name].members
        if m in spec.entities
    ]
    return min(found, default=math.inf)


def declares_heat(spec: WorldSpec, name: str) -> bool:
    """True if a member of an instance says anything about its temperature."""
    physics = [spec.entities[m].physics for m in spec.simulation.liquid[name].members if m in spec.entities]
    return any(
        p.category == "liquid" and (p.conductivity > 0 or p.activation > 0 or p.temperature != USUAL_TEMPERATURE) for p in physics
    )


def inflows_of(spec: WorldSpec, name: str) -> dict[str, InflowDriver]:
    """Inflows into the liquids of an instance, by driver id."""
    members = spec.simulation.liquid[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "inflow" and d.entity in members}


def gauge_of(driver: InflowDriver | OutflowDriver) -> tuple[float, float]:
    """Where the surface is read that a driver holds: x, y [m]."""
    return driver.gauge if driver.gauge is not None else (driver.pose.position[0], driver.pose.position[1])


def fastest(entity: Entity) -> float:
    """Largest speed of a liquid at frame 0 [m/s]."""
    physics = entity.physics
    currents = physics.currents.values() if physics.category == "liquid" else ()
    return max([math.hypot(*getattr(physics, "linear_velocity", (0, 0, 0))), *(v for c in currents for v in c.speeds)])


def liquid_estimate(spec: WorldSpec, name: str) -> LooseEstimate:
    """Particles and steps that an instance will take, from its volume, inflows, domain and the fall through it."""
    plan, instance = spec.simulation, spec.simulation.liquid[name]
    spacing = spacing_of(spec, name)
    if not math.isfinite(spacing):
        return LooseEstimate(0.0, 0.0, 0.0)
    seconds = plan.lead + (plan.frames - 1) / plan.fps
    members = [spec.entities[m] for m in instance.members if m in spec.entities]
    volume = sum(initial_volume(m) for m in members)
    swiftest = max((fastest(m) for m in members), default=0.0)
    for inflow in inflows_of(spec, name).values():
        volume += inflow.area * inflow.flow_speed * max(0.0, min(inflow.end or seconds, seconds) - inflow.start)
        swiftest = max(swiftest, inflow.flow_speed)
    low, high = domain_box(instance)
    box = float(np.prod(high - low))
    fall = float(np.abs(high - low) @ np.abs(plan.gravity))
    speed = math.sqrt(swiftest**2 + fall)  # half of the speed after a fall through the whole domain, squared: a usual mean
    settings = instance.settings
    step = min(settings.max_step, settings.cfl * spacing / max(speed, 1e-9))
    per_spacing = getattr(settings, "particles_per_cell", 1)
    cells = box / spacing**3 if instance.engine == "flip" else 0.0
    return LooseEstimate(min(volume, box) / spacing**3 * per_spacing, seconds / step, cells)


def liquid_seconds(spec: WorldSpec) -> float | None:
    """Seconds that the liquids of a world will take, from particles, steps and a usual rate; None without any."""
    found = {n: liquid_estimate(spec, n) for n in spec.simulation.liquid}
    if not found:
        return None
    engines = {n: spec.simulation.liquid[n].engine for n in found}
    return sum(e.steps * (e.particles / PARTICLE_STEPS[engines[n]] + STEP_SECONDS[engines[n]]) for n, e in found.items())

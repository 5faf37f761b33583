"""Facts that the specification alone gives about particles: domains, numbers, steps (R65)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....physics.grains import rayleigh_time
from ...extents import initial_volume
from ..loose import LooseEstimate
from ..resting import LOOSE_SHARE
from .models import ParticlePhysics

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["ROLLED", "grain_step", "particle_estimate", "particle_seconds", "rest_way", "softest_under"]

PARTICLE_STEPS = {"dem": 1.7e6, "ballistic": 1.0e6}
"""Particles times steps a second by engine, once they run: usual rates. Own measurement."""


ROLLED = 100.0
"""Young's modulus of grains over weight / radius^2 with which what rolls on them presses them into each other by at most a tenth of the radius.

Own measurement, steel balls of 2, 4 and 8 grain radii on beds of 6: 85, 20 and 50 are enough; chains of a few grains carry most of the weight. That
100 is enough for 2 and 4, and a twelfth of it too little for 2, is held by `tests/physics/test_soft_grains.py`.
"""


def softest_under(weight: float, radius: float) -> float:
    """Least Young's modulus [Pa] of grains of a radius [m] over which a weight [N] rolls; see `ROLLED`."""
    return ROLLED * weight / radius**2


def grain_step(physics: ParticlePhysics, density: float, share: float) -> float:
    """Step of grains by the time in which a Rayleigh wave crosses the smallest of them [s]."""
    smallest = physics.radius * (1.0 - physics.radius_spread)
    return share * rayleigh_time(smallest, density, physics.young_modulus, physics.poisson_ratio)


def particle_estimate(spec: WorldSpec, name: str) -> LooseEstimate:
    """Particles and steps that an instance will take."""
    plan, instance = spec.simulation, spec.simulation.particles[name]
    seconds = plan.lead + (plan.frames - 1) / plan.fps
    count, step = 0.0, math.inf
    for member in instance.members:
        entity = spec.entities.get(member)
        if entity is None or entity.physics.category != "particles":
            continue
        physics = entity.physics
        if instance.engine == "dem":
            one = 4.0 / 3.0 * math.pi * physics.radius**3 * (1.0 + physics.radius_spread**2)
            count += physics.packing * initial_volume(entity) / one
            density = spec.materials[entity.material].density if entity.material in spec.materials else 1000.0
            step = min(step, grain_step(physics, density, instance.settings.step_share))
            continue
        step = instance.settings.max_step
        count += physics.count
        lasting = physics.life * (1.0 + physics.life_spread) if physics.life is not None else math.inf
        for driver in plan.drivers.values():
            if driver.kind == "emitter" and driver.entity == member:
                lasts = max(0.0, min(driver.end or seconds, seconds) - driver.start)
                count += driver.rate * min(lasts, lasting)
    return LooseEstimate(count, seconds / step if math.isfinite(step) else 0.0)


def particle_seconds(spec: WorldSpec) -> float | None:
    """Seconds that the particles of a world will take, from numbers, steps and a usual rate; None without any."""
    found = {n: particle_estimate(spec, n) for n in spec.simulation.particles}
    rates = {n: PARTICLE_STEPS[spec.simulation.particles[n].engine] for n in found}
    return sum(e.particles * e.steps / rates[n] for n, e in found.items()) if found else None


def rest_way(spec: WorldSpec, name: str) -> float:
    """Farthest that grains at rest may move in half a second [m]; 0 for particles that fly alone."""
    physics = spec.entities[name].physics
    if isinstance(physics, ParticlePhysics) and physics.law == "granular":
        return LOOSE_SHARE * physics.radius
    return 0.0

"""Rows of the audit about particles: law and engine, domain, emitters, numbers (R65)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import F64, pose_of
from ...extents import box_size, initial_box, initial_volume, told_mass
from ...problems import Problem, removed, replaced
from ..loose import domain_box
from .facts import softest_under
from .models import ParticlePhysics

if TYPE_CHECKING:
    from ...spec import ParticleInstance, WorldSpec

__all__ = ["particle_problems", "particle_warnings"]

LAWS = {"dem": "granular", "ballistic": "ballistic"}
"""Law that each engine carries out."""
ROUND = frozenset({"sphere", "cylinder", "capsule", "revolution"})
"""Shapes that roll."""
LEAST_RADII = 2.0
"""Own choice: a volume thinner than so many radii holds no grain."""
LEAST_SHARE = 1.0 / 3.0
"""Own choice: of the grains that packing and volume declare, so many find room: middles lie a radius within the sides."""


def particle_problems(spec: WorldSpec) -> list[Problem]:
    """Problems of particles, their instances, drivers and couplings."""
    found: list[Problem] = []
    for name, instance in spec.simulation.particles.items():
        found += _instance(spec, name, instance)
    for name, entity in spec.entities.items():
        if entity.physics.category != "particles":
            continue
        place = f"/entities/{name}"
        if entity.motion != "dynamic":
            text = f"particles {name!r} are {entity.motion}; particles are dynamic"
            found.append(Problem(f"{place}/motion", text, replaced(f"{place}/motion", "dynamic")))
        if entity.generator is not None:
            found.append(
                Problem(f"{place}/generator", f"particles {name!r} have a generator; give them parts that hold their volume")
            )
    return [*found, *_drivers(spec), *_couplings(spec)]


def _instance(spec: WorldSpec, name: str, instance: ParticleInstance) -> Iterator[Problem]:
    place = f"/simulation/solvers/{name}/settings"
    low, high = domain_box(instance)
    for member in instance.members:
        entity = spec.entities.get(member)
        if entity is None or entity.physics.category != "particles":
            continue
        physics, wanted = entity.physics, LAWS[instance.engine]
        if physics.law != wanted:
            other = next(e for e, law in LAWS.items() if law == physics.law)
            text = f"engine {instance.engine!r} moves {wanted} particles; {member!r} are {physics.law}: use engine {other!r} or law {wanted!r}"
            yield Problem(
                f"/entities/{member}/physics/law",
                text,
                replaced(f"/entities/{member}/physics/law", wanted),
            )
        box = initial_box(entity)
        if box is None:
            continue
        if instance.engine == "dem" and float((box[1] - box[0]).min()) < LEAST_RADII * physics.radius * (
            1 + physics.radius_spread
        ):
            thin = float((box[1] - box[0]).min())
            text = f"the volume of {member!r} is {thin:.3g} m thin and holds no grain of {physics.radius:g} m radius; make it larger or the grains smaller"
            yield Problem(f"/entities/{member}/physics/radius", text)
        outside = np.maximum(low - box[0], box[1] - high).max()
        if outside > 1e-9 and (instance.engine == "dem" or physics.count > 0):
            text = f"the volume of {member!r} reaches {outside:.3g} m beyond the domain of {name!r}; widen the domain"
            yield Problem(f"{place}/domain", text)


def particle_warnings(spec: WorldSpec) -> Iterator[Problem]:
    """Volumes of grains so coarse that few of the declared grains, or none, find room in them; grains too soft for what may roll over them."""
    for name, instance in spec.simulation.particles.items():
        for member in instance.members if instance.engine == "dem" else ():
            entity = spec.entities.get(member)
            if entity is None or entity.physics.category != "particles":
                continue
            yield from _too_soft(spec, member, name)
            physics, sizes = entity.physics, [np.array(b) for p in entity.parts.values() if (b := box_size(p.shape)) is not None]
            if not sizes or len(sizes) < len(entity.parts):
                continue
            size = max(sizes, key=lambda s: _room(s, physics.radius))
            share = _room(size, physics.radius)
            if share >= LEAST_SHARE or size.min() < LEAST_RADII * physics.radius * (1 + physics.radius_spread):
                continue  # too thin for one: that is refused
            one = 4.0 / 3.0 * np.pi * physics.radius**3 * (1.0 + physics.radius_spread**2)
            declared = physics.packing * initial_volume(entity) / one
            low, high = 0.0, physics.radius
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if _room(size, middle) >= LEAST_SHARE else (low, middle)
            yield Problem(
                f"/entities/{member}/physics/radius",
                f"the volume of {member!r} declares about {declared:.3g} grains of {physics.radius:g} m radius and has room for about "
                f"{share * declared:.2g}, a share of {share:.2g}, at least {LEAST_SHARE:.2g} is wanted (with less than one, probing is refused): its "
                f"largest part is {' x '.join(f'{v:.3g}' for v in size)} m. Take a radius of at most {0.99 * low:.3g} m, or larger parts",
            )


def _too_soft(spec: WorldSpec, member: str, solver: str) -> Iterator[Problem]:
    """Round bodies too heavy for the grains that they may roll over."""
    physics, gravity = spec.entities[member].physics, float(np.linalg.norm(spec.simulation.gravity))
    assert isinstance(physics, ParticlePhysics)
    partners = {
        c.source if c.target == solver else c.target
        for c in spec.simulation.couplings.values()
        if c.direction == "two_way" and solver in (c.source, c.target)
    }
    bodies = [
        n for s in partners if s in spec.simulation.solvers for n in spec.simulation.solvers[s].members if n in spec.entities
    ]
    for name in bodies:
        wheels = sum(p.shape.kind in ROUND for p in spec.entities[name].parts.values() if p.collides)
        weight = told_mass(spec, name) * gravity / max(wheels, 1)
        least = float(f"{softest_under(weight, physics.radius):.2g}")  # as it is told, so that who takes it is not warned again
        if wheels and least > physics.young_modulus:
            yield Problem(
                f"/entities/{member}/physics/young_modulus",
                f"{name!r} presses with up to {weight:.3g} N on grains of {member!r} where it rolls over them: of {physics.radius:g} m radius they need a "
                f"young_modulus of about {least:.2g} Pa for that, and have {physics.young_modulus:.2g}. Take it stiffer, the grains larger or the body "
                "lighter; what never touches them needs nothing",
            )


def _room(size: F64, radius: float) -> float:
    """Share of a box in which middles of grains of this radius [m] can lie."""
    return float(np.prod(np.maximum(1.0 - 2.0 * radius / size, 0.0)))


def _drivers(spec: WorldSpec) -> Iterator[Problem]:
    for name, driver in spec.simulation.drivers.items():
        entity = spec.entities.get(getattr(driver, "entity", "") or "")
        if entity is None:
            continue
        particles, place = entity.physics.category == "particles", f"/simulation/drivers/{name}"
        if driver.kind == "emitter":
            if entity.physics.category != "particles" or entity.physics.law != "ballistic":
                yield Problem(f"{place}/entity", f"emitter {name!r} lets out {driver.entity!r}, which are no ballistic particles")
                continue
            owner = next((i for i in spec.simulation.particles.values() if driver.entity in i.members), None)
            if owner is not None:
                low, high = domain_box(owner)
                at = pose_of(driver.pose).position
                if (at < low).any() or (at > high).any():
                    yield Problem(
                        f"{place}/pose", f"emitter {name!r} lies outside the domain of its particles; move it or widen the domain"
                    )
        elif particles:
            text = (
                f"driver {driver.kind!r} cannot act on particles; use a field, an emitter, or a kinematic solid that moves them"
            )
            yield Problem(place, text)


def _couplings(spec: WorldSpec) -> Iterator[Problem]:
    plan = spec.simulation
    for name, coupling in plan.couplings.items():
        flying = [
            s for s in (coupling.source, coupling.target) if s in plan.particles and plan.particles[s].engine == "ballistic"
        ]
        carried = coupling.source in plan.solvers and plan.solvers[coupling.source].carries
        if flying and coupling.direction == "two_way" and not carried:
            place = f"/simulation/couplings/{name}"
            text = f"coupling {name!r}: ballistic particles of {flying[0]!r} push nothing; make it one_way from the rigid instance, or leave it out"
            yield Problem(place, text, removed(place))

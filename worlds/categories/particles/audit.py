"""Rows of the audit about particles: law and engine, domain, emitters, numbers (R65)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import pose_of
from ...extents import initial_box
from ...problems import Problem, removed, replaced
from ..loose import domain_box

if TYPE_CHECKING:
    from ...spec import ParticleInstance, WorldSpec

__all__ = ["particle_problems"]

LAWS = {"dem": "granular", "ballistic": "ballistic"}
"""Law that each engine carries out."""
LEAST_RADII = 2.0
"""Own choice: a volume thinner than so many radii holds no grain."""


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
        if flying and coupling.direction == "two_way":
            place = f"/simulation/couplings/{name}"
            text = f"coupling {name!r}: ballistic particles of {flying[0]!r} push nothing; make it one_way from the rigid instance, or leave it out"
            yield Problem(place, text, removed(place))

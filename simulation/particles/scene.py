"""Specification and built entities -> what an engine of grains or of flying particles is given (R65)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64, I32, pose_of
from ...worlds.categories.loose import domain_box
from ...worlds.errors import InputError
from ...worlds.instances import soft_met
from ..boundaries import Surround, surround_of
from .packing import fill_box
from .setup import GrainSetup, Kind, wall_law
from .solids import Placed

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.spec import ParticlePhysics, WorldSpec

__all__ = ["MARGIN", "GrainScene", "build_grains", "reach_of", "surround_for"]

MARGIN = 4.0
"""Solids up to so many radii outside a domain count as reaching into it."""
MOST_BLOCKED = 0.5
"""Own choice: matter of which solids would take more than half is misplaced."""


class GrainScene(NamedTuple):
    """A set-up engine of grains and the names behind its rows."""

    setup: GrainSetup
    surround: Surround


def surround_for(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str) -> Surround:
    """Bodies that reach into an instance's domain."""
    return surround_of(spec, built, domain_box(spec.simulation.particles[name]), reach_of(spec, name), soft=soft_met(spec, name))


def reach_of(spec: WorldSpec, name: str) -> float:
    """Distance from an instance's domain up to which solids count [m]."""
    return MARGIN * max((p.radius * (1 + p.radius_spread) for p in _physics(spec, name)), default=0.0)


def _physics(spec: WorldSpec, name: str) -> list[ParticlePhysics]:
    members = spec.simulation.particles[name].members
    return [p for m in members if (p := spec.entities[m].physics).category == "particles"]


def build_grains(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str) -> GrainScene:
    """Grains at the start of the preroll, at rest, and their walls.

    Raises:
        InputError: a volume holds no grain, or lies in solids.
    """
    instance, plan = spec.simulation.particles[name], spec.simulation
    low, high = domain_box(instance)
    surround = surround_for(spec, built, name)
    surfaces = [*surround.parts, *((row, surround.boundaries[row].mesh) for row in surround.soft)]
    solids = [
        Placed(Solid.from_mesh(mesh, closed=row not in surround.soft or surround.boundaries[row].closed), surround.start[row])
        for row, mesh in surfaces
    ]
    position, radius, kind = _fill(spec, built, name, [s for s in solids if s.solid.closed])
    kinds = tuple(_kind(spec, m) for m in instance.members)
    walls = {
        (b, k): wall_law(one, *_surface(spec, boundary.name.split("/", 1)[0], instance.members[k], boundary.friction))
        for b, boundary in enumerate(surround.boundaries)
        for k, one in enumerate(kinds)
    }
    # Vertices take no couples: on surfaces that deform, nothing resists rolling.
    walls |= {key: replace(pair, rolling=0.0) for key, pair in walls.items() if key[0] in surround.soft}
    setup = GrainSetup(
        lower=low,
        upper=high,
        kinds=kinds,
        position=position,
        velocity=np.zeros_like(position),
        radius=radius,
        kind=kind,
        gravity=np.array(plan.gravity, dtype=np.float64),
        boundaries=surround.boundaries,
        centers=tuple(b.center for b in surround.bodies),
        walls=walls,
        step_share=getattr(instance.settings, "step_share", 0.15),
        device=instance.settings.device,
    )
    return GrainScene(setup, surround)


def _kind(spec: WorldSpec, member: str) -> Kind:
    entity = spec.entities[member]
    physics: ParticlePhysics = entity.physics  # type: ignore[assignment]
    material = spec.materials[entity.material]
    return Kind(
        name=member,
        density=material.density,
        young=physics.young_modulus,
        poisson=physics.poisson_ratio,
        restitution=material.restitution,
        friction=material.friction,
        rolling=physics.rolling,
        cohesion=physics.cohesion,
    )


def _surface(spec: WorldSpec, body: str, member: str, rough: float) -> tuple[float, float]:
    """Friction and restitution of a body's surface against grains: the larger and the smaller, or those of the pair."""
    grains = spec.materials[spec.entities[member].material]
    entity = spec.entities[body]
    materials = [spec.materials[p.material or entity.material] for p in entity.parts.values()] or [
        spec.materials[entity.material]
    ]
    friction = max(rough, grains.friction)
    restitution = min(grains.restitution, *(m.restitution for m in materials))
    for pair in spec.simulation.contacts.values():
        if {pair.a, pair.b} == {body, member}:
            friction = friction if pair.friction is None else pair.friction
            restitution = restitution if pair.restitution is None else pair.restitution
    return friction, restitution


def _fill(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, solids: list[Placed]) -> tuple[F64, F64, I32]:
    """Grains of all members: those of a random packing that lie wholly in the volume and outside all else."""
    positions, radii, kinds = [], [], []
    taken = list(solids)
    for number, member in enumerate(spec.simulation.particles[name].members):
        entity = spec.entities[member]
        physics: ParticlePhysics = entity.physics  # type: ignore[assignment]
        pose = pose_of(entity.pose)
        inside = free = 0
        for part in built[member].parts:
            own = Placed(Solid.from_mesh(part.render, closed=True), pose)
            low, high = own.box
            points, sizes = fill_box(
                low, high, physics.radius, share=physics.packing, spread=physics.radius_spread, seed=spec.simulation.seed
            )
            within = own.depth(points, 2.0 * physics.radius * (1 + physics.radius_spread)) >= sizes
            points, sizes = points[within], sizes[within]
            inside += len(points)
            for solid in taken:
                apart = -solid.depth(points, 2.0 * physics.radius * (1 + physics.radius_spread)) >= sizes
                points, sizes = points[apart], sizes[apart]
            free += len(points)
            taken.append(own)
            positions.append(points)
            radii.append(sizes)
            kinds.append(np.full(len(points), number, dtype=np.int32))
        if not free or free < MOST_BLOCKED * inside:
            where = (
                "is too small for one grain" if not inside else f"lies in solids or in other grains by {1 - free / inside:.0%}"
            )
            raise InputError(
                f"the volume of {member!r} {where}, at most {MOST_BLOCKED:.0%} may; move it with /entities/{member}/pose, "
                f"make its parts larger, or lower /entities/{member}/physics/radius"
            )
    return np.concatenate(positions), np.concatenate(radii), np.concatenate(kinds)

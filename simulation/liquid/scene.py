"""Specification and built entities -> what a liquid engine is given (R57, R58)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64, I32, pose_of, rotation_matrix
from ...worlds.built import BuiltEntity
from ...worlds.categories.liquid.facts import gauge_of, spacing_of
from ...worlds.categories.liquid.recipe import DOMAIN_MARGIN
from ...worlds.categories.loose import domain_box
from ...worlds.errors import InputError
from ...worlds.fields import Fields, fields_of
from ...worlds.instances import soft_met
from ...worlds.waves import sea_of, waves_of
from ..boundaries import Surround, surround_of
from .currents import start_velocity
from .engine import SIDES, Fluid, Inflow, LiquidSetup, Outflow, Stage, WaveZones
from .filling import PlacedSolid, fill
from .marker_filling import fill_markers
from .resolved import require_resolved

if TYPE_CHECKING:
    from ...worlds.spec import InflowDriver, LiquidInstance, LiquidPhysics, OutflowDriver, WorldSpec

__all__ = ["MARGIN", "LiquidScene", "build_scene"]

MARGIN = DOMAIN_MARGIN
MOST_BLOCKED = 0.5
"""Own choice: a liquid that lies in solids by more than half is misplaced."""


@dataclass(frozen=True)
class LiquidScene:
    """A set-up liquid and the names behind its rows."""

    setup: LiquidSetup
    surround: Surround
    """Its boundaries are the setup's."""


def build_scene(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, *, without: frozenset[str] = frozenset()
) -> LiquidScene:
    """Initial particles, boundaries and openings of a liquid instance; `without` some of its inflows, outflows or waves.

    Raises:
        InputError: something is not resolved, a source lies in a solid, or a liquid lies in solids.
    """
    instance, plan = spec.simulation.liquid[name], spec.simulation
    spacing = spacing_of(spec, name)
    low, high = domain_box(instance)
    friction = float(getattr(instance.settings, "wall_friction", 0.0))
    surround = surround_of(spec, built, (low, high), MARGIN * spacing, friction=friction, soft=soft_met(spec, name))
    closed_soft = [(row, surround.boundaries[row].mesh) for row in surround.soft if surround.boundaries[row].closed]
    solids = [
        PlacedSolid(surround.boundaries[row].name, Solid.from_mesh(mesh, closed=True), surround.start[row])
        for row, mesh in (*surround.parts, *closed_soft)
    ]
    position, velocity, fluid, volume = _particles(spec, built, instance, solids, spacing)
    setup = LiquidSetup(
        spacing=spacing,
        lower=low,
        upper=high,
        sides=instance.settings.domain.sides,
        fluids=tuple(_fluid(spec, m) for m in instance.members),
        gravity=np.array(plan.gravity, dtype=np.float64),
        position=position,
        velocity=velocity,
        fluid=fluid,
        volume=volume,
        boundaries=surround.boundaries,
        inflows=tuple(i for i in _inflows(spec, instance) if i.name not in without),
        outflows=tuple(_outflows(spec, instance, without)),
        waves=tuple(w for w in _waves(spec, name, spacing) if w.name not in without),
        fields=_fields(spec, instance, without),
        preroll=plan.preroll,
        scattered=instance.engine == "flip",
        device=instance.settings.device,
        seed=plan.seed,
    )
    assert len(setup.sides) == len(SIDES)
    require_resolved(setup, solids, {b.name: b.motion for b in surround.boundaries}, instance.engine)
    return LiquidScene(setup, surround)


def _fluid(spec: WorldSpec, member: str) -> Fluid:
    entity = spec.entities[member]
    physics: LiquidPhysics = entity.physics  # type: ignore[assignment]
    return Fluid(
        name=member,
        density=spec.materials[entity.material].density,
        viscosity=physics.viscosity,
        surface_tension=physics.surface_tension,
        temperature=physics.temperature,
        conductivity=physics.conductivity,
        heat_capacity=physics.heat_capacity,
        activation=physics.activation,
    )


def _fields(spec: WorldSpec, instance: LiquidInstance, without: frozenset[str]) -> tuple[Fields, ...]:
    found = tuple(fields_of(spec, member, without) for member in instance.members)
    return found if any(found) else ()


# ---------------------------------------------------------------- particles


def _particles(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], instance: LiquidInstance, solids: list[PlacedSolid], spacing: float
) -> tuple[F64, F64, I32, F64]:
    position: list[F64] = []
    velocity: list[F64] = []
    volume: list[F64] = []
    fluid: list[I32] = []
    taken = [s for s in solids if s.solid.closed]
    seed = spec.simulation.seed
    for number, member in enumerate(instance.members):
        contract = spec.entities[member]
        pose = pose_of(contract.pose)
        blocked = whole = 0.0
        for part in built[member].parts:
            own = PlacedSolid(f"{member}/{part.part}", Solid.from_mesh(part.render, closed=True), pose)
            if instance.engine == "flip":
                # As fine as they will be: split cells of shallow water would be crowded.
                parts = round(instance.settings.particles_per_cell ** (1 / 3))
                filling = fill_markers(own, taken, spacing / parts, seed)
            else:
                filling = fill(own, taken, spacing)
            whole, blocked = whole + abs(own.solid.volume), blocked + filling.blocked * abs(own.solid.volume)
            taken = [*taken, own]
            position.append(filling.position)
            volume.append(np.full(len(filling.position), filling.volume))
        if blocked > MOST_BLOCKED * whole:
            raise InputError(
                f"{blocked / whole:.0%} of the liquid {member!r} lies in solids or in other liquid, at most {MOST_BLOCKED:.0%} may; "
                f"move it with /entities/{member}/pose, or give parts that fill the free space"
            )
        count = sum(len(p) for p in position) - sum(len(f) for f in fluid)
        fluid.append(np.full(count, number, dtype=np.int32))
        assert contract.physics.category == "liquid"
        everything = np.concatenate(position)
        velocity.append(start_velocity(contract.physics, pose, everything[len(everything) - count :]))
    return np.concatenate(position), np.concatenate(velocity), np.concatenate(fluid), np.concatenate(volume)


# ---------------------------------------------------------------- openings


def _inflows(spec: WorldSpec, instance: LiquidInstance) -> Iterator[Inflow]:
    """Times are those of the engine, whose clock starts with the preroll."""
    for key, driver in spec.simulation.drivers.items():
        if driver.kind == "inflow" and driver.entity in instance.members:
            pose = pose_of(driver.pose)
            yield Inflow(
                name=key,
                fluid=instance.members.index(driver.entity),
                center=pose.position,
                rotation=rotation_matrix(pose.quaternion),
                half_size=(0.5 * driver.size[0], 0.5 * driver.size[1]),
                round=driver.round,
                speed=driver.flow_speed,
                start=driver.start + spec.simulation.preroll,
                end=math.inf if driver.end is None else driver.end + spec.simulation.preroll,
                stage=_stage(driver),
            )


def _stage(driver: InflowDriver | OutflowDriver) -> Stage | None:
    return None if driver.level is None else Stage(*gauge_of(driver), driver.level)


def _outflows(spec: WorldSpec, instance: LiquidInstance, without: frozenset[str]) -> Iterator[Outflow]:
    """Every outflow; one that is taken away keeps its place among the ways out, and holds nothing."""
    for key, driver in spec.simulation.drivers.items():
        if driver.kind == "outflow" and driver.entity in instance.members:
            pose = pose_of(driver.pose)
            half = (-1.0, -1.0, -1.0) if key in without else (0.5 * driver.size[0], 0.5 * driver.size[1], 0.5 * driver.size[2])
            yield Outflow(key, pose.position, rotation_matrix(pose.quaternion), half, None if key in without else _stage(driver))


def _waves(spec: WorldSpec, name: str, spacing: float) -> Iterator[WaveZones]:
    plan = spec.simulation
    for key, driver in waves_of(spec, name).items():
        sea = sea_of(driver, float(np.linalg.norm(plan.gravity)), spacing)
        generate, absorb = (tuple(side in sides for side in SIDES[:4]) for sides in (driver.generate, driver.absorb))
        yield WaveZones(key, replace(sea, start=sea.start + plan.preroll), driver.zone, generate, absorb)  # type: ignore[arg-type]

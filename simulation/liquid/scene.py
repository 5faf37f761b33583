"""Specification and built entities -> what a liquid engine is given (R57, R58)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from ...geometry.heightfields import ground_solid
from ...geometry.solids import Solid
from ...worlds.arrays import F64, I32, RigidPose, compose, pose_of, rotation_matrix
from ...worlds.built import BuiltBody, BuiltEntity, BuiltPart, TriangleMesh
from ...worlds.errors import InputError
from ...worlds.liquids import domain_box, spacing_of
from ...worlds.provenance import DOMAIN_MARGIN
from ...worlds.waves import sea_of, waves_of
from .currents import start_velocity
from .engine import SIDES, Boundary, Fluid, Inflow, LiquidSetup, Outflow, WaveZones
from .filling import PlacedSolid, fill
from .resolved import require_resolved

if TYPE_CHECKING:
    from ...worlds.spec import Entity, LiquidInstance, LiquidPhysics, WorldSpec

__all__ = ["LiquidScene", "build_scene", "meets_domain"]

MARGIN = DOMAIN_MARGIN
MOST_BLOCKED = 0.5
"""Own choice: a liquid that lies in solids by more than half is misplaced."""


@dataclass(frozen=True)
class LiquidScene:
    """A set-up liquid and the names behind its rows."""

    setup: LiquidSetup
    bodies: tuple[BuiltBody, ...]
    """Mass properties per boundary."""
    start: tuple[RigidPose, ...]
    """Pose of each boundary's body at frame 0."""


def build_scene(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, *, without: frozenset[str] = frozenset()
) -> LiquidScene:
    """Initial particles, boundaries and openings of a liquid instance; `without` some of its inflows or waves.

    Raises:
        InputError: something is not resolved, a source lies in a solid, or a liquid lies in solids.
    """
    instance, plan = spec.simulation.liquid[name], spec.simulation
    spacing = spacing_of(spec, name)
    low, high = domain_box(instance)
    boundaries, bodies, start, solids = _boundaries(spec, built, instance, spacing)
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
        boundaries=boundaries,
        inflows=tuple(i for i in _inflows(spec, instance) if i.name not in without),
        outflows=tuple(_outflows(spec, instance)),
        waves=tuple(w for w in _waves(spec, name, spacing) if w.name not in without),
        device=instance.settings.device,
        seed=plan.seed,
    )
    assert len(setup.sides) == len(SIDES)
    require_resolved(setup, solids, {b.name: b.motion for b in boundaries}, instance.engine)
    return LiquidScene(setup, bodies, start)


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


# ---------------------------------------------------------------- boundaries


def meets_domain(entity: Entity, built: BuiltEntity, box: tuple[F64, F64], margin: float) -> bool:
    """Whether a solid at its place at frame 0 reaches into a domain; what moves may always come there."""
    if entity.motion != "static":
        return True
    base = pose_of(entity.pose)
    for part in built.parts:
        pose = compose(base, next(b.pose for b in built.bodies if b.name == part.body))
        points = pose.apply(part.render.vertices)
        if (points.max(axis=0) >= box[0] - margin).all() and (points.min(axis=0) <= box[1] + margin).all():
            return True
    return False


def _boundaries(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], instance: LiquidInstance, spacing: float
) -> tuple[tuple[Boundary, ...], tuple[BuiltBody, ...], tuple[RigidPose, ...], list[PlacedSolid]]:
    box, margin = domain_box(instance), MARGIN * spacing
    friction = float(getattr(instance.settings, "wall_friction", 0.0))
    made: list[tuple[Boundary, BuiltBody, RigidPose]] = []
    solids: list[PlacedSolid] = []
    for entity in sorted(n for n, e in spec.entities.items() if e.physics.category == "rigid"):
        contract = spec.entities[entity]
        if not meets_domain(contract, built[entity], box, margin):
            continue
        for body in built[entity].bodies:
            pose = compose(pose_of(contract.pose), body.pose)
            parts = [p for p in built[entity].parts_of(body.name) if p.collision]
            near = [_near(p, pose, box, margin) for p in parts] if contract.motion == "static" else [p.render for p in parts]
            meshes = [m for m in near if m is not None]
            if not meshes:
                continue
            motion: Literal["static", "kinematic", "dynamic"] = contract.motion
            closed = all(p.closed for p in parts)
            boundary = Boundary(f"{entity}/{body.name}", _joined(meshes), motion, closed, friction)
            made.append((boundary, body, pose))
            solids += [PlacedSolid(boundary.name, Solid.from_mesh(m, closed=True), pose) for m in meshes]
    return tuple(m[0] for m in made), tuple(m[1] for m in made), tuple(m[2] for m in made), solids


def _joined(meshes: list[TriangleMesh]) -> TriangleMesh:
    offsets = np.cumsum([0, *(len(m.vertices) for m in meshes)])
    faces = [m.faces + offset for m, offset in zip(meshes, offsets, strict=False)]
    return TriangleMesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces).astype(np.int32))


def _near(part: BuiltPart, pose: RigidPose, box: tuple[F64, F64], margin: float) -> TriangleMesh | None:
    """The part of a static surface that a domain can feel: None beyond it; of a height field, the ground around it."""
    points = pose.apply(part.render.vertices)
    if (points.max(axis=0) < box[0] - margin).any() or (points.min(axis=0) > box[1] + margin).any():
        return None
    piece = part.collision[0]
    if piece.kind != "heightfield" or len(part.collision) != 1:
        return part.render
    rows, cols = piece.points.shape
    half_x, half_y, base = piece.params
    corners = np.array(
        [[x, y, z] for x in (box[0][0], box[1][0]) for y in (box[0][1], box[1][1]) for z in (box[0][2], box[1][2])]
    )
    local = compose(pose, piece.pose).inverse().apply(corners)
    pad = margin * math.sqrt(2.0)
    columns = _span(local[:, 0], half_x, cols, pad)
    lines = _span(local[:, 1], half_y, rows, pad)
    x, y = np.linspace(-half_x, half_x, cols)[columns], np.linspace(-half_y, half_y, rows)[lines]
    heights = piece.points[lines, columns]
    ground = ground_solid(heights, (float(np.ptp(x)), float(np.ptp(y))), base)
    shifted = ground.vertices + np.array([x.mean(), y.mean(), 0.0])
    return TriangleMesh(piece.pose.apply(shifted), ground.faces)


def _span(values: F64, half: float, count: int, pad: float) -> slice:
    """Samples of an axis of a height field that cover values, at least two."""
    scale = (count - 1) / (2 * half)
    first = int(np.clip(math.floor((float(values.min()) - pad + half) * scale), 0, count - 2))
    last = int(np.clip(math.ceil((float(values.max()) + pad + half) * scale), first + 1, count - 1))
    return slice(first, last + 1)


# ---------------------------------------------------------------- particles


def _particles(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], instance: LiquidInstance, solids: list[PlacedSolid], spacing: float
) -> tuple[F64, F64, I32, F64]:
    position: list[F64] = []
    velocity: list[F64] = []
    volume: list[F64] = []
    fluid: list[I32] = []
    taken = [s for s in solids if s.solid.closed]
    # Markers of a grid as fine as they will be: split cells of shallow water would be crowded.
    parts = round(getattr(instance.settings, "particles_per_cell", 1) ** (1 / 3))
    for number, member in enumerate(instance.members):
        contract = spec.entities[member]
        pose = pose_of(contract.pose)
        blocked = whole = 0.0
        for part in built[member].parts:
            own = PlacedSolid(f"{member}/{part.part}", Solid.from_mesh(part.render, closed=True), pose)
            filling = fill(own, taken, spacing / parts)
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
            )


def _outflows(spec: WorldSpec, instance: LiquidInstance) -> Iterator[Outflow]:
    for key, driver in spec.simulation.drivers.items():
        if driver.kind == "outflow" and driver.entity in instance.members:
            pose = pose_of(driver.pose)
            half = (0.5 * driver.size[0], 0.5 * driver.size[1], 0.5 * driver.size[2])
            yield Outflow(key, pose.position, rotation_matrix(pose.quaternion), half)


def _waves(spec: WorldSpec, name: str, spacing: float) -> Iterator[WaveZones]:
    plan = spec.simulation
    for key, driver in waves_of(spec, name).items():
        sea = sea_of(driver, float(np.linalg.norm(plan.gravity)), spacing)
        generate, absorb = (tuple(side in sides for side in SIDES[:4]) for sides in (driver.generate, driver.absorb))
        yield WaveZones(key, replace(sea, start=sea.start + plan.preroll), driver.zone, generate, absorb)  # type: ignore[arg-type]

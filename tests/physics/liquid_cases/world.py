"""Tools that the cases share: boxes of liquid, tanks of boxes, bodies moved by the impulses that the engine reports, and figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
import trimesh
from numpy.typing import NDArray
from worldagent.geometry.solids import Solid
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.liquid.dfsph.engine import Dfsph
from worldagent.simulation.liquid.dfsph.settings import DfsphSettings
from worldagent.simulation.liquid.engine import Engine, Fluid, LiquidReport, LiquidSetup
from worldagent.simulation.liquid.filling import PlacedSolid, fill
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.flip.settings import FlipSettings
from worldagent.worlds.arrays import F64, RigidPose
from worldagent.worlds.built import TriangleMesh

__all__ = [
    "CLOSED",
    "OPEN",
    "WATER",
    "Body",
    "EngineName",
    "Figure",
    "G",
    "advance",
    "below",
    "box_mesh",
    "lattice",
    "level",
    "liquid",
    "make",
    "momentum",
    "near",
    "sphere_mesh",
    "still",
    "tank_walls",
    "water_around",
]  # fmt: skip

G = 9.81
WATER = Fluid("water", 1000.0, 1e-3)
CLOSED, OPEN = ("closed",) * 6, ("open",) * 6
WALL = 0.1
"""Thickness of a tank's walls [m]."""
EngineName = Literal["dfsph", "flip"]


@dataclass(frozen=True)
class Figure:
    """One measured number and the bounds that it must keep."""

    name: str
    measured: float
    low: float
    high: float
    unit: str = ""

    @property
    def passes(self) -> bool:
        """True if it lies within the bounds."""
        return bool(self.low <= self.measured <= self.high)

    @property
    def gate(self) -> str:
        """The bounds as text."""
        return f"<= {self.high:g}" if np.isneginf(self.low) else f"[{self.low:g}, {self.high:g}]"


def below(name: str, measured: float, high: float, unit: str = "") -> Figure:
    """A figure with an upper bound."""
    return Figure(name, float(measured), -np.inf, high, unit)


def near(name: str, measured: float, exact: float, share: float, unit: str = "") -> Figure:
    """A figure that must be within a share of a value."""
    low, high = sorted((exact * (1 - share), exact * (1 + share)))
    return Figure(name, float(measured), low, high, unit)


def make(engine: EngineName, setup: LiquidSetup, **settings: Any) -> Engine:
    """An engine as a user gets it, but for the settings named."""
    return Flip(setup, FlipSettings(**settings)) if engine == "flip" else Dfsph(setup, DfsphSettings(**settings))


def lattice(low: Sequence[float], high: Sequence[float], spacing: float) -> F64:
    """Cell centres of a box (n, 3)."""
    axes = [np.arange(round((b - a) / spacing)) * spacing + a + spacing / 2 for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def liquid(
    spacing: float,
    position: F64,
    upper: Sequence[float],
    *,
    lower: Sequence[float] = (0.0, 0.0, 0.0),
    volume: float | None = None,
    gravity: Sequence[float] = (0.0, 0.0, -G),
    fluid: Fluid = WATER,
    sides: Any = CLOSED,
    **more: Any,
) -> LiquidSetup:
    """Particles in a domain; each of one cell's volume unless said."""
    n = len(position)
    given: dict[str, Any] = {"velocity": np.zeros((n, 3)), **more}
    return LiquidSetup(
        spacing=spacing,
        lower=np.array(lower, dtype=float),
        upper=np.array(upper, dtype=float),
        sides=sides,
        fluids=(fluid,),
        gravity=np.array(gravity, dtype=float),
        position=np.asarray(position, dtype=float),
        fluid=np.zeros(n, dtype=np.int32),
        volume=np.full(n, spacing**3 if volume is None else volume),
        **given,
    )


def _mesh(made: Any) -> TriangleMesh:
    return TriangleMesh(np.array(made.vertices, dtype=float), np.array(made.faces, dtype=np.int32))


def box_mesh(size: Sequence[float], at: Sequence[float] = (0.0, 0.0, 0.0)) -> TriangleMesh:
    """A box around a place."""
    made = trimesh.creation.box(tuple(size))
    made.apply_translation(tuple(at))
    return _mesh(made)


def sphere_mesh(radius: float) -> TriangleMesh:
    """A sphere around the origin, of exactly its volume."""
    made = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    made.apply_scale((4 / 3 * np.pi * radius**3 / made.volume) ** (1 / 3))
    return _mesh(made)


def tank_walls(size: Sequence[float], *, friction: float = 0.0) -> tuple[Boundary, ...]:
    """Floor and four walls, as boxes, around an inner room [0, size]; walls reach down to the floor's underside."""
    x, y, z = size
    parts = {
        "floor": ((x, y, WALL), (x / 2, y / 2, -WALL / 2)),
        "west": ((WALL, y + 2 * WALL, z + WALL), (-WALL / 2, y / 2, (z - WALL) / 2)),
        "east": ((WALL, y + 2 * WALL, z + WALL), (x + WALL / 2, y / 2, (z - WALL) / 2)),
        "south": ((x, WALL, z + WALL), (x / 2, -WALL / 2, (z - WALL) / 2)),
        "north": ((x, WALL, z + WALL), (x / 2, y + WALL / 2, (z - WALL) / 2)),
    }
    return tuple(Boundary(name, box_mesh(*part), "static", friction=friction) for name, part in parts.items())


@dataclass
class Body:
    """A rigid body that moves by reported impulses and gravity; without mass it stays as it is."""

    boundary: Boundary
    position: F64
    mass: float = 0.0
    inertia: F64 = field(default_factory=lambda: np.eye(3))
    """About its centre, in its frame [kg m^2]."""
    velocity: F64 = field(default_factory=lambda: np.zeros(3))
    spin: F64 = field(default_factory=lambda: np.zeros(3))
    rotation: F64 = field(default_factory=lambda: np.eye(3))
    gravity: F64 = field(default_factory=lambda: np.array([0.0, 0.0, -G]))
    held: bool = False

    @property
    def free(self) -> bool:
        """True if it moves with what pushes it."""
        return self.mass > 0.0 and not self.held

    def push(self, impulse: F64, dt: float) -> None:
        """Take an impulse and gravity over a step, then move."""
        if self.free:
            world = self.rotation @ self.inertia @ self.rotation.T
            momentum = world @ self.spin + impulse[3:]
            self.velocity = self.velocity + impulse[:3] / self.mass + dt * self.gravity
            self.spin = np.linalg.solve(world, momentum)
        self.position = self.position + dt * self.velocity
        angle = float(np.linalg.norm(self.spin)) * dt
        if angle > 0.0:
            axis = self.spin / np.linalg.norm(self.spin)
            turn = trimesh.transformations.rotation_matrix(angle, axis)[:3, :3]
            self.rotation = turn @ self.rotation
            if self.free:  # angular momentum stays while the body turns
                self.spin = np.linalg.solve(self.rotation @ self.inertia @ self.rotation.T, momentum)


def still(bodies: Sequence[Body | Boundary]) -> BodyState:
    """State of bodies; boundaries alone stand at the origin."""
    made = [b if isinstance(b, Body) else Body(b, np.zeros(3)) for b in bodies]
    n = len(made)

    def rows(values: list[Any], shape: tuple[int, ...]) -> F64:
        return np.array(values, dtype=float).reshape((n, *shape))

    inverse = [np.linalg.inv(b.rotation @ b.inertia @ b.rotation.T) if b.free else np.zeros((3, 3)) for b in made]
    place = rows([b.position for b in made], (3,))
    return BodyState(
        place,
        rows([b.rotation for b in made], (3, 3)),
        place.copy(),
        rows([b.velocity for b in made], (3,)),
        rows([b.spin for b in made], (3,)),
        rows([1 / b.mass if b.free else 0.0 for b in made], ()),
        rows(inverse, (3, 3)),
        rows([b.gravity if b.free else np.zeros(3) for b in made], (3,)),
    )


def advance(
    engine: Engine,
    seconds: float,
    bodies: Sequence[Body | Boundary] = (),
    watch: Callable[[float, LiquidReport], None] | None = None,
    *,
    longest: float = np.inf,
) -> list[LiquidReport]:
    """Steps until a time has passed; bodies move with what they are given. `watch` gets the time passed and the report."""
    reports: list[LiquidReport] = []
    passed = 0.0
    while passed < seconds * (1 - 1e-9):
        report = engine.step(float(min(seconds - passed, longest)), still(bodies))
        passed += report.dt
        for body, impulse in zip(bodies, report.impulse, strict=True):
            if isinstance(body, Body):
                body.push(impulse, report.dt)
        reports.append(report)
        if watch is not None:
            watch(passed, report)
    return reports


def level(engine: Engine) -> float:
    """Height of still liquid in an upright tank on z = 0 [m]: twice its centre of mass; waves raise it in second order."""
    p = engine.particles()
    return float(2.0 * (p.volume * p.position[:, 2]).sum() / p.volume.sum())


def momentum(engine: Engine, bodies: Sequence[Body]) -> tuple[F64, F64]:
    """Linear and angular momentum, about the origin, of water and bodies."""
    p = engine.particles()
    mass = (p.volume * WATER.density)[:, None]
    linear, angular = (mass * p.velocity).sum(axis=0), np.cross(p.position, mass * p.velocity).sum(axis=0)
    for b in bodies:
        linear = linear + b.mass * b.velocity
        angular = angular + b.mass * np.cross(b.position, b.velocity) + b.rotation @ b.inertia @ b.rotation.T @ b.spin
    return linear, angular


def water_around(
    spacing: float, size: Sequence[float], bodies: Sequence[tuple[TriangleMesh, F64]]
) -> tuple[F64, NDArray[np.float64]]:
    """Particles that fill [0, size] around solids as the product fills volumes, and the volume of each."""
    none = np.array([1.0, 0.0, 0.0, 0.0])
    own = PlacedSolid("water", Solid.from_mesh(box_mesh(size, np.array(size) / 2), closed=True), RigidPose(np.zeros(3), none))
    solids = [PlacedSolid(str(k), Solid.from_mesh(m, closed=True), RigidPose(at, none)) for k, (m, at) in enumerate(bodies)]
    made = fill(own, solids, spacing)
    return made.position, np.full(len(made.position), made.volume)


def placed(setup: LiquidSetup, shift: Sequence[float]) -> LiquidSetup:
    """The same liquid elsewhere in its domain."""
    return replace(setup, position=setup.position + np.array(shift))

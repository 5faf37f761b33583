"""Bodies in water: how deep they float, what they feel when held, how they start, and the momentum of both sides."""

from __future__ import annotations

import numpy as np
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.engine import LiquidReport, LiquidSetup
from worldagent.worlds.arrays import F64
from worldagent.worlds.built import TriangleMesh

from .world import (
    CLOSED,
    OPEN,
    Body,
    EngineName,
    Figure,
    G,
    advance,
    below,
    box_mesh,
    lattice,
    liquid,
    make,
    momentum,
    near,
    sphere_mesh,
    water_around,
)  # fmt: skip

__all__ = ["draft", "held", "ledgers", "neutral", "released"]


def _inertia(mass: float, size: tuple[float, float, float]) -> F64:
    x, y, z = (s * s for s in size)
    return np.diag(mass / 12 * np.array([y + z, x + z, x + y]))


def _pool(spacing: float, size: tuple[float, float, float], boundary: Boundary, at: F64, height: float) -> LiquidSetup:
    position, volume = water_around(spacing, size, [(boundary.mesh, at)])
    setup = liquid(spacing, position, (size[0], size[1], height), sides=CLOSED, boundaries=(boundary,))
    return LiquidSetup(**{**vars(setup), "volume": volume})


def draft(engine: EngineName, cells: int, ratio: float = 0.5) -> list[Figure]:
    """A flat box of 0.4 x 0.4 x 0.2 m in a pool of 0.8 x 0.8 m, 4 s, mean of the last 1.5; `cells` over 0.2 m."""
    size, side, depth = (0.4, 0.4, 0.2), 0.8, 0.4
    spacing = size[2] / cells
    at = np.array([side / 2, side / 2, depth + (0.5 - ratio) * size[2] + 0.01])
    mass = ratio * 1000.0 * float(np.prod(size))
    boundary = Boundary("box", box_mesh(size), "dynamic")
    body = Body(boundary, at, mass, _inertia(mass, size))
    running = make(engine, _pool(spacing, (side, side, depth), boundary, at, 2 * depth))
    course: list[tuple[float, float, float]] = []

    def look(time: float, report: LiquidReport) -> None:
        course.append((time, report.dt, body.position[2]))

    advance(running, 4.0, [body], look, longest=1 / 48)
    late = np.array([c for c in course if c[0] > 2.5])
    height = float((late[:, 1] * late[:, 2]).sum() / late[:, 1].sum())
    volume = running.particles().volume.sum()
    surface = volume / side**2 + ratio * float(np.prod(size)) / side**2
    found = surface - (height - size[2] / 2)
    return [
        Figure(f"{ratio:g}: draft / height", found / size[2], ratio - 0.02, ratio + 0.02),
        below(f"{ratio:g}: draft, error in spacings", abs(found - ratio * size[2]) / spacing, 0.5),
        below(f"{ratio:g}: tilt", np.degrees(np.arccos(np.clip(body.rotation[2, 2], -1, 1))), 5.0, "deg"),
    ]


def neutral(engine: EngineName, cells: int) -> list[Figure]:
    """A cube of 0.2 m of water's density in 0.6 m of water, let go at once, half a second; `cells` over 0.2 m."""
    size, side = (0.2, 0.2, 0.2), 0.6
    at = np.array([0.3, 0.3, 0.3])
    mass = 1000.0 * float(np.prod(size))
    boundary = Boundary("box", box_mesh(size), "dynamic")
    body = Body(boundary, at, mass, _inertia(mass, size))
    running = make(engine, _pool(size[0] / cells, (side, side, side), boundary, at, 1.3 * side))
    advance(running, 0.5, [body], longest=1 / 48)
    return [below("mean acceleration / g", 2 * float(np.linalg.norm(body.position - at)) / 0.5**2 / G, 0.02)]


def held(engine: EngineName, cells: int, shape: str = "box") -> list[Figure]:
    """A body 0.2 m across held in 0.6 m of water, mean force of 0.5 s after 0.5 s; `cells` across it."""
    across, side = 0.2, 0.6
    mesh: TriangleMesh = box_mesh((across,) * 3) if shape == "box" else sphere_mesh(across / 2)
    volume = across**3 if shape == "box" else np.pi / 6 * across**3
    at = np.array([0.3, 0.3, 0.3])
    boundary = Boundary(shape, mesh, "dynamic")
    body = Body(boundary, at, held=True)
    running = make(engine, _pool(across / cells, (side, side, side), boundary, at, 1.3 * side))
    advance(running, 0.5, [body])
    reports = advance(running, 0.5, [body])
    force = sum(r.impulse[0] for r in reports) / sum(r.dt for r in reports)
    felt = sum(r.reaction[0] for r in reports) / sum(r.dt for r in reports)
    weight = 1000.0 * G * volume
    return [
        near(f"{shape}: force / weight of the water displaced", force[2] / weight, 1.0, 0.02),
        below(f"{shape}: force across / that weight", float(np.linalg.norm(force[:2])) / weight, 0.02),
        below(f"{shape}: ledgers, difference / that weight", float(np.abs(force + felt).max()) / weight, 1e-4),
    ]


def released(engine: EngineName, cells: int) -> list[Figure]:
    """A sphere of 0.24 m, half as dense as water, let go after 0.2 s in a tank six of it wide; `cells` across it."""
    across = 0.24
    side = 6 * across
    at = np.array([side / 2, side / 2, 0.4 * side])
    volume = np.pi / 6 * across**3
    mass = 500.0 * volume
    boundary = Boundary("ball", sphere_mesh(across / 2), "dynamic")
    body = Body(boundary, at, mass, np.eye(3) * 0.1 * mass * across**2, held=True)
    running = make(engine, _pool(across / cells, (side, side, side), boundary, at, 1.2 * side))
    advance(running, 0.2, [body])
    body.held = False
    course: list[tuple[float, float]] = []

    def look(time: float, _: LiquidReport) -> None:
        course.append((time, body.velocity[2]))

    advance(running, 0.1, [body], look, longest=0.005)
    t, v = np.array(course).T
    found = float((t * v).sum() / (t * t).sum())
    return [near("acceleration", found, G * 500.0 / (500.0 + 0.5 * 1000.0), 0.10, "m/s^2")]


def ledgers(engine: EngineName, cells: int) -> list[Figure]:
    """A free box runs into a lump of water far from everything, without gravity, 0.3 s; `cells` over 0.4 m."""
    side, size = 0.4, (0.2, 0.2, 0.2)
    spacing = side / cells
    water = lattice((0, 0, 0), (side,) * 3, spacing) + 0.6
    speed = np.tile([0.2, 0.0, 0.1], (len(water), 1)) + np.cross(np.array([0.3, 0.5, 0.8]), water - 0.8)
    mass = 400.0 * float(np.prod(size))
    boundary = Boundary("box", box_mesh(size), "dynamic")
    body = Body(
        boundary, np.array([0.46, 0.75, 0.85]), mass, _inertia(mass, size),
        velocity=np.array([1.0, 0.1, -0.05]), spin=np.array([0.0, 1.0, 0.5]), gravity=np.zeros(3),
    )  # fmt: skip
    setup = liquid(spacing, water, (2.0, 1.6, 1.6), sides=OPEN, gravity=(0.0, 0.0, 0.0), boundaries=(boundary,), velocity=speed)
    running = make(engine, setup)
    before = momentum(running, [body])
    p = running.particles()
    scale = 1000.0 * float((p.volume * np.linalg.norm(p.velocity, axis=1)).sum()) + mass
    reports = advance(running, 0.3, [body], longest=1 / 100)
    after = momentum(running, [body])
    given = sum(np.abs(r.impulse).sum() for r in reports)
    apart = sum(np.abs(r.impulse + r.reaction).sum() for r in reports)
    return [
        below("momentum, change / sum of |m v|", np.abs(after[0] - before[0]).max() / scale, 1e-5),
        below("angular momentum, change / sum of |m v| x 1 m", np.abs(after[1] - before[1]).max() / scale, 1e-4),
        below("impulse against reaction", apart / given, 1e-4),
        Figure("impulse given to the box", given, 1e-3 * mass, np.inf, "N s"),
    ]

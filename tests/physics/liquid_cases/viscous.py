"""Viscous flow between plates that hold the liquid fast: Couette and Poiseuille, from water to honey."""

from __future__ import annotations

import numpy as np
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.engine import Fluid
from worldagent.worlds.arrays import F64

from .world import Body, EngineName, Figure, advance, below, box_mesh, lattice, liquid, make

__all__ = ["couette", "poiseuille"]

LENGTH, ACROSS = 4, 4
"""Length of the slab in gaps along the flow, and cells across it. Its ends are free: it moves by less than half a gap."""
GATE = 0.12
"""Own choice: no gate is published. Viscosity of 30 neighbours depends by some 10 % on how they lie."""
TERMS = np.arange(1, 60)
GAPS = {"water": (1e-3, 0.002), "oil": (0.1, 0.02), "honey": (10.0, 0.1)}
"""Viscosity [Pa s] and gap [m]: a time in which the flow develops is then some tenths of a second to some seconds."""


def _stirred(position: F64, spacing: float) -> F64:
    """Off their lattice, whose rows would slide along each other: by up to a third of a spacing."""
    return position + spacing / 3 * np.random.default_rng(0).uniform(-1.0, 1.0, position.shape)


def _between(engine: EngineName, cells: int, liquid_name: str, speed: float, push: float, seconds: float) -> tuple[F64, F64]:
    """Height over the gap and velocity of the particles in the middle third of a slab between plates."""
    viscosity, gap = GAPS[liquid_name]
    s = gap / cells
    length, width = LENGTH * gap, ACROSS * s
    size = (3 * length, width + 8 * s, 6 * s)
    floor = Boundary("below", box_mesh(size, (0.5 * length, 0.5 * width, -3 * s)), "static", friction=1.0)
    ceiling = Boundary("above", box_mesh(size), "kinematic", friction=1.0)
    above = np.array([0.5 * length, 0.5 * width, gap + 3 * s])
    bodies = [Body(floor, np.zeros(3)), Body(ceiling, above, velocity=np.array([speed, 0.0, 0.0]))]
    fluid = Fluid(liquid_name, 1000.0, viscosity)
    setup = liquid(
        s,
        _stirred(lattice((0, 0, 0), (length, width, gap), s), s),
        (2 * length, width, gap + 8 * s),
        lower=(-length, 0.0, -8 * s),
        sides=("open", "open", "closed", "closed", "open", "open"),
        gravity=(push, 0.0, 0.0),
        fluid=fluid,
        boundaries=tuple(b.boundary for b in bodies),
    )
    exact = {"viscosity_error": 1e-3} if engine == "dfsph" else {}
    running = make(engine, setup, **exact)
    advance(running, seconds, bodies)
    p = running.particles()
    x = p.position[:, 0] - p.position[:, 0].mean()
    kept = np.abs(x) < length / 6
    return p.position[kept, 2] / gap, p.velocity[kept, 0]


def couette(engine: EngineName, cells: int, liquid_name: str = "oil") -> list[Figure]:
    """Upper plate pulled, at 0.5 gap^2 density / viscosity; L2 error of the velocity, `cells` over the gap."""
    viscosity, gap = GAPS[liquid_name]
    time = 0.5 * 1000.0 * gap**2 / viscosity
    speed = 0.4 * gap / time
    z, v = _between(engine, cells, liquid_name, speed, 0.0, time)
    n = TERMS[:, None]
    exact = z + (2 / (np.pi * n) * (-1.0) ** n * np.exp(-((np.pi * n) ** 2) * 0.5) * np.sin(np.pi * n * z)).sum(axis=0)
    return [below(f"{liquid_name}: velocity, L2 error", np.sqrt(((v / speed - exact) ** 2).sum() / (exact**2).sum()), GATE)]


def poiseuille(engine: EngineName, cells: int, liquid_name: str = "oil") -> list[Figure]:
    """Pushed by a body force, at 0.5 gap^2 density / viscosity; L2 error of the velocity, `cells` over the gap."""
    viscosity, gap = GAPS[liquid_name]
    time = 0.5 * 1000.0 * gap**2 / viscosity
    most = 0.4 * gap / time
    push = 8 * most * viscosity / (1000.0 * gap**2)
    z, v = _between(engine, cells, liquid_name, 0.0, push, time)
    n = 2 * TERMS[:, None] - 1
    slow = (32 / (np.pi * n) ** 3 * np.exp(-((np.pi * n) ** 2) * 0.5) * np.sin(np.pi * n * z)).sum(axis=0)
    exact = 4 * z * (1 - z) - slow
    return [below(f"{liquid_name}: velocity, L2 error", np.sqrt(((v / most - exact) ** 2).sum() / (exact**2).sum()), GATE)]

"""Short scenes of grains for tests of the engine: two that meet, one on a plane, many on a floor."""

from __future__ import annotations

from typing import Any

import numpy as np
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.particles.engine import Grains
from worldagent.simulation.particles.setup import GrainSetup, Kind
from worldagent.worlds.built import TriangleMesh

G = 9.81


def kind(**changes: Any) -> Kind:
    """Glass-like grains, soft enough for long steps."""
    found = {
        "name": "g", "density": 2500.0, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.5, "rolling": 0.0,
        "cohesion": 0.0,
    }  # fmt: skip
    return Kind(**{**found, **changes})


def slab(low: Any, high: Any, motion: str = "static", friction: float = 0.0) -> Boundary:
    """A box with outward faces."""
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    return Boundary("wall/body", TriangleMesh(corners, faces), motion, True, friction)  # type: ignore[arg-type]


def grains(
    position: Any,
    radius: Any,
    *,
    velocity: Any = None,
    gravity: Any = (0, 0, 0),
    walls: tuple[Boundary, ...] = (),
    **changes: Any,
) -> Grains:
    """An engine; `changes` are of the kind of all grains, or of the setup."""
    own = {
        k: changes.pop(k)
        for k in list(changes)
        if k in ("restitution", "friction", "rolling", "cohesion", "young", "density", "poisson")
    }
    place = np.asarray(position, dtype=float)
    n = len(place)
    setup = GrainSetup(
        lower=changes.pop("lower", np.full(3, -2.0)), upper=changes.pop("upper", np.full(3, 2.0)), kinds=changes.pop("kinds", (kind(**own),)),
        position=place, velocity=np.zeros((n, 3)) if velocity is None else np.asarray(velocity, dtype=float),
        radius=np.broadcast_to(np.asarray(radius, dtype=float), (n,)).copy(), kind=changes.pop("kind", np.zeros(n, dtype=np.int32)),
        gravity=np.asarray(gravity, dtype=float), boundaries=walls, centers=tuple(np.zeros(3) for _ in walls), **changes,
    )  # fmt: skip
    return Grains(setup)


def still(count: int, **changes: Any) -> BodyState:
    """Bodies at rest at the origin; `changes` replace columns."""
    zero = np.zeros((count, 3))
    columns = {
        "position": zero, "rotation": np.tile(np.eye(3), (count, 1, 1)), "center": zero.copy(), "velocity": zero.copy(),
        "angular_velocity": zero.copy(), "inverse_mass": np.zeros(count), "inverse_inertia": np.zeros((count, 3, 3)),
        "acceleration": zero.copy(),
    }  # fmt: skip
    return BodyState(**{**columns, **changes})

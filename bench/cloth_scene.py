"""The sheet of the cloth benchmarks: a square metre hung by its upper edge, or thrown down on its edge onto a floor."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..simulation.boundaries import BodyState, Boundary
from ..simulation.cloth.engine import Cloth
from ..simulation.cloth.mesh import Fabric, sheet_of
from ..simulation.cloth.setup import ClothSetup, Hold
from ..worlds.arrays import F64, I32
from ..worlds.built import TriangleMesh
from ..worlds.categories.cloth.facts import sheet_grid
from ..worlds.spec import Sheet

__all__ = ["BEND", "DENSITY", "GRAVITY", "STIFFNESS", "grid", "hung", "law", "nothing", "thrown"]

DENSITY, STIFFNESS, BEND, GRAVITY = 0.2, 1000.0, 1e-5, 9.81
"""[kg/m^2], [N/m], [N m], [m/s^2]"""


def law(length: float) -> float:
    """Stretch of a hanging sheet at its lower end [m]."""
    return DENSITY * GRAVITY * length**2 / (2 * STIFFNESS)


def grid(columns: int, rows: int, edge: float) -> tuple[F64, I32]:
    """Vertices in the xz plane, the upper edge at z = 0, and faces."""
    points, faces = sheet_grid(Sheet(size=((columns - 1) * edge, (rows - 1) * edge), resolution=edge))
    return np.stack([points[:, 0], 0.0 * points[:, 0], points[:, 1] - 0.5 * (rows - 1) * edge], axis=1), faces


def nothing(boundaries: tuple[Boundary, ...] = ()) -> BodyState:
    """All bodies at rest at the origin."""
    n = len(boundaries)
    zero = [np.zeros((n, 3)) for _ in range(5)]
    return BodyState(zero[0], np.tile(np.eye(3), (n, 1, 1)), zero[1], zero[2], zero[3], np.zeros(n), np.zeros((n, 3, 3)), zero[4])


def _cloth(points: F64, faces: I32, edge: float, damping: float, **more: Any) -> Cloth:
    sheet = sheet_of(points, faces, Fabric(DENSITY, (STIFFNESS, STIFFNESS), 0.1 * STIFFNESS, BEND, damping, 1e-3))
    solids = len(more.get("boundaries", ()))
    return Cloth(
        ClothSetup(
            sheets=(sheet,),
            shell=(0.5 * max(1e-3, 0.15 * edge),),
            drag=((1.2, 0.03),),
            friction=(0.4,) * (1 + solids),
            gravity=np.array([0.0, 0.0, -GRAVITY]),
            **more,
        )
    )


def hung(columns: int, rows: int, edge: float, *, damping: float = 0.0, step: float = 1 / 240, device: str = "cpu") -> Cloth:
    """A sheet held by its upper edge, in implicit steps of `step` [s]."""
    points, faces = grid(columns, rows, edge)
    top = np.flatnonzero(points[:, 2] > -1e-9).astype(np.int32)
    return _cloth(points, faces, edge, damping, holds=(Hold(top, -1, points[top]),), max_step=step, exchange=step, device=device)


def thrown(side: int, *, device: str = "cpu") -> Cloth:
    """A square metre that falls on its edge and crumples: side x side vertices."""
    edge = 1.0 / (side - 1)
    points, faces = grid(side, side, edge)
    points[:, 1] = 0.03 * np.sin(9 * points[:, 2]) + 0.02 * np.sin(7 * points[:, 0])
    points[:, 2] += 1.05
    corner = np.array([[x, y, z] for x in (-2, 2) for y in (-2, 2) for z in (-0.2, 0.0)], dtype=np.float64)
    turned = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
    floor = Boundary("floor/body", TriangleMesh(corner, np.array(turned, dtype=np.int32)), "static")
    speed = np.tile([0.0, 0.0, -math.sqrt(2.0)], (len(points), 1))
    return _cloth(points, faces, edge, 0.0, boundaries=(floor,), velocity=speed, device=device)

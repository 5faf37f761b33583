"""Sheets of plain arrays for the physics of cloth."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.cloth.engine import Cloth
from worldagent.simulation.cloth.mesh import Fabric, Sheet, sheet_of
from worldagent.simulation.cloth.setup import ClothSetup, Hold
from worldagent.worlds.arrays import F64, I32
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.categories.cloth.facts import sheet_grid
from worldagent.worlds.spec import Sheet as SheetShape

__all__ = ["DENSITY", "STIFFNESS", "box", "cloth", "fabric", "hold", "run", "sheet", "standing"]

DENSITY, STIFFNESS = 0.2, 1000.0
"""[kg/m^2], [N/m]"""


def fabric(**changes: Any) -> Fabric:
    """Cotton, more or less."""
    return replace(Fabric(DENSITY, (STIFFNESS, STIFFNESS), 100.0, 2e-5, 0.0, 1e-3), **changes)


def sheet(size: tuple[float, float], edge: float, made_of: Fabric, at: F64 | None = None) -> Sheet:
    """A rectangle in the xy plane, or with its vertices at `at` and the same rest state."""
    points, faces = sheet_grid(SheetShape(size=size, resolution=edge))
    found = sheet_of(points, faces, made_of)
    return found if at is None else replace(found, position=np.asarray(at, dtype=np.float64))


def hold(rows: Any, where: F64, boundary: int = -1) -> Hold:
    """Vertices that stay, or go with a body."""
    which: I32 = np.asarray(rows, dtype=np.int32)
    return Hold(which, boundary, np.asarray(where, dtype=np.float64)[which])


def box(size: tuple[float, float, float], center: tuple[float, float, float], motion: Any = "static") -> Boundary:
    """A solid box."""
    corner = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * size + center
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
    return Boundary("box/body", TriangleMesh(corner, np.array(faces, dtype=np.int32)), motion)


def cloth(*sheets: Sheet, **setup: Any) -> Cloth:
    """A running cloth, without air unless `drag` is given."""
    count = len(sheets)
    boundaries = setup.get("boundaries", ())
    made = {
        "shell": tuple(0.5 * max(1e-3, 0.15 * float(s.edge_length.min())) for s in sheets),
        "drag": ((0.0, 0.0),) * count,
        "friction": (0.4,) * (1 + len(boundaries)),
        "gravity": np.array([0.0, 0.0, -9.81]),
        **setup,
    }
    return Cloth(ClothSetup(sheets=sheets, **made))


def standing(boundaries: tuple[Boundary, ...] = ()) -> BodyState:
    """All bodies at rest at the origin."""
    count, zero = len(boundaries), np.zeros((len(boundaries), 3))
    turn = np.tile(np.eye(3), (count, 1, 1))
    return BodyState(zero, turn, zero.copy(), zero.copy(), zero.copy(), np.zeros(count), np.zeros((count, 3, 3)), zero.copy())


def run(running: Cloth, seconds: float, time: float = 0.0) -> list[Any]:
    """Its reports over a time."""
    bodies, end, found = standing(running.setup.boundaries), time + seconds, []
    while time < end - 1e-9:
        found.append(running.step(end - time, bodies, time))
        time += found[-1].dt
    return found

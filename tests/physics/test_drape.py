"""Cusick's drape test: a disc of cloth of 30 cm over a disc of 18 cm."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import Delaunay
from worldagent.simulation.cloth.mesh import Sheet, sheet_of
from worldagent.tests.physics.cloth_sheets import cloth, fabric, hold, run
from worldagent.verifiers.categories.cloth.predicates import shadow
from worldagent.worlds.arrays import F64, I32

CLOTH, DISC = 0.15, 0.09
"""Radii [m]."""
COTTON = fabric(area_density=0.15, stretch=(1000.0, 1000.0), shear=100.0, bend=1e-5, damping=5e-5)
SECONDS = 1.2
"""In thick air, so that it comes to rest."""
REPEAT = 0.05
"""Own choice: spread of a drape coefficient over time, half of that over meshes and orientations."""


def _disc(rings: int, turn: float) -> tuple[F64, I32]:
    """A disc of even triangles: 6 k vertices on ring k; its lattice turned against the warp by an angle [rad]."""
    points = [np.zeros((1, 2))]
    for k in range(1, rings + 1):
        angle = 2 * math.pi * np.arange(6 * k) / (6 * k) + turn
        points.append(CLOTH * k / rings * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    flat = np.concatenate(points)
    faces = Delaunay(flat).simplices.astype(np.int32)
    a, b, c = (flat[faces[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    faces[area < 0] = faces[area < 0][:, ::-1]
    return np.column_stack([flat, np.zeros(len(flat))]), faces[np.abs(area) > 1e-3 * (CLOTH / rings) ** 2]


def _coefficient(rings: int, turn: float, bend: float) -> float:
    """Drape coefficient of the disc once it hangs; what lies on the stand is held there, as its counterpart plate does."""
    points, faces = _disc(rings, turn)
    sheet: Sheet = sheet_of(points, faces, replace(COTTON, bend=bend))
    held = np.flatnonzero(np.linalg.norm(points[:, :2], axis=1) <= DISC + 1e-9)
    running = cloth(sheet, holds=(hold(held, points),), drag=((60.0, 10.0),), self_collision=False)
    run(running, SECONDS)
    flat, disc, found = math.pi * CLOTH**2, math.pi * DISC**2, []
    for k in range(4):
        run(running, 0.1, SECONDS + 0.1 * k)
        found.append((shadow(running.vertices()[0], faces) - disc) / (flat - disc))
    assert np.ptp(found) < REPEAT
    return float(np.mean(found))


@pytest.mark.slow
def test_the_drape_coefficient_repeats_over_meshes_and_orientations() -> None:
    """Gate: 5 points. Both meshes have a ring on the rim of the stand."""
    found = [_coefficient(rings, turn, 4e-5) for rings, turn in ((10, 0.0), (10, 0.1), (15, 0.0))]
    assert max(found) - min(found) < 2 * REPEAT
    assert 0.7 < np.mean(found) < 0.95


@pytest.mark.slow
def test_what_is_stiffer_drapes_less() -> None:
    """Limits: a sheet as stiff as a board stays flat; the order of the others is that of their stiffness."""
    limp, middling, board = (_coefficient(10, 0.1, bend) for bend in (1e-5, 4e-5, 5e-3))
    assert limp < middling - 0.05
    assert board > 0.98

"""Pieces of surfaces: their area, size and place."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry.patches import patches_of

VERTICES = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
LOW, HIGH = np.full(3, -9.0), np.full(3, 9.0)


@pytest.mark.parametrize("size", [5.0, 0.5, 0.13, 0.03])
def test_pieces_cover_the_surface_once(size: float) -> None:
    found = patches_of(VERTICES, FACES, size, LOW, HIGH)
    assert float(found.area.sum()) == pytest.approx(1.0)
    assert found.area @ found.point == pytest.approx([0.5, 0.5, 0.0])
    assert float(found.area @ found.point[:, 0] ** 2) == pytest.approx(1.0 / 3.0, abs=0.2 * size)
    assert found.area.max() <= 0.5 * size**2 + 1e-12 or size > 1.0


def test_pieces_beyond_the_box_are_left_out() -> None:
    found = patches_of(VERTICES, FACES, 0.05, np.array([0.0, 0.0, -1.0]), np.array([0.5, 1.0, 1.0]))
    assert float(found.area.sum()) == pytest.approx(0.5, abs=0.03)
    assert (found.point[:, 0] <= 0.5).all()


def test_a_surface_away_from_the_box_has_none() -> None:
    assert len(patches_of(VERTICES, FACES, 0.05, np.full(3, 2.0), np.full(3, 3.0)).area) == 0

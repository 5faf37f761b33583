"""Courses that wind: as long as declared, within their floor, and the river takes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.terrain.landscape import Landscape, build_landscape
from worldagent.construction.terrain.meanders import winding
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec.terrain import Terrain

LINE = np.array([[-290.0, 10.0], [0.0, -20.0], [290.0, 15.0]])


def _length(points: np.ndarray) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


@pytest.mark.parametrize("sinuosity", [1.1, 1.3, 1.6, 2.0, 2.5])
def test_a_course_is_as_much_longer_as_declared_and_stays_on_its_floor(sinuosity: float) -> None:
    course = winding(LINE, sinuosity=sinuosity, half_floor=30, cell=2)
    assert course[0] == pytest.approx(LINE[0])
    assert course[-1] == pytest.approx(LINE[-1])
    assert _length(course) / _length(LINE) == pytest.approx(sinuosity, rel=0.03)
    straight = np.interp(course[:, 0], LINE[:, 0], LINE[:, 1])
    assert 10 < np.abs(course[:, 1] - straight).max() < 30


def test_bends_that_the_grid_cannot_hold_are_refused() -> None:
    with pytest.raises(InputError, match="widen /floor or /width, or lower /cell"):
        winding(LINE, sinuosity=1.3, half_floor=6, cell=4)


def _land(**valley: Any) -> Landscape:
    layer = {"kind": "valley", "line": LINE.tolist(), "width": 200, "depth": 20, "fall": 6, "floor": 0.35, **valley}
    return build_landscape(
        Terrain.model_validate(
            {
                "extent": [600, 240],
                "cell": 3,
                "datum": 30,
                "layers": {"valley": layer, "rough": {"kind": "noise", "amplitude": 0.2, "wavelength": 60, "order": 2}},
                "hydrology": {"inflows": {"source": {"position": [-288, 10], "discharge": 0.5}}, "required": ["river"]},
            }
        ),
        Path(),
    )


def _river(land: Landscape) -> np.ndarray:
    """Course of the largest river [m], its stairs smoothed."""
    from scipy.ndimage import gaussian_filter1d

    cells = max(land.water.rivers, key=lambda r: len(r.cells)).cells
    rows, cols = np.divmod(np.asarray(cells), land.grid.cols)
    points = np.stack(
        [(cols - 0.5 * (land.grid.cols - 1)) * land.grid.cell, (rows - 0.5 * (land.grid.rows - 1)) * land.grid.cell], 1
    )
    return np.asarray(gaussian_filter1d(points, 2.0, axis=0, mode="nearest"))


def test_a_river_follows_the_winding_course_of_its_valley() -> None:
    straight, bent = _river(_land()), _river(_land(sinuosity=1.5))
    ratio = [_length(r) / float(np.hypot(*(r[-1] - r[0]))) for r in (straight, bent)]
    assert ratio[0] < 1.15
    assert ratio[1] == pytest.approx(1.5, rel=0.12)
    course = winding(LINE, sinuosity=1.5, half_floor=35, cell=3)
    away = np.hypot(*(bent[:, None] - course[None]).transpose(2, 0, 1)).min(axis=1)
    assert np.percentile(away, 90) < 2 * 3

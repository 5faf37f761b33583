"""Water of a landscape as a liquid's volume: it lies between level and ground, ends at the shore, and rivers enter across their section."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.rivers import river_courses, river_gates
from worldagent.construction.terrain.waters import WaterBody, water_body
from worldagent.geometry.inside import contains
from worldagent.geometry.solids import Solid
from worldagent.worlds.errors import InputError
from worldagent.worlds.landscape import SavedLandscape

CELL, ROWS, COLS = 2.0, 40, 60
FALL = 0.01
HALF = 5.0
"""Half width of the channel at its top [m]."""
DEEP = 2.0


class Land(SavedLandscape):
    """A channel along x that falls evenly, its water up to half a metre below the banks."""

    def __init__(self, *, wet: bool = True) -> None:
        super().__init__(path=None)  # type: ignore[arg-type]
        grid = Grid(ROWS, COLS, CELL)
        x, y = grid.points()
        height = -FALL * x - DEEP * np.clip(1 - np.abs(y) / HALF, 0, None)
        level = -FALL * x - 0.5
        under = (level > height) & wet
        cells = [grid.cols * (ROWS // 2) + c for c in range(COLS)]
        reach = {"cells": cells, "discharge": [3.0, 5.0], "width": [8.0, 8.0]}
        about = {"rows": ROWS, "cols": COLS, "cell": CELL, "reaches": [reach] if wet else []}
        vars(self).update(about=about, _fields={"water_level": np.where(under, level, np.nan), "height": height, "wet": under})

    def field(self, name: str) -> np.ndarray:
        return np.asarray(vars(self)["_fields"][name], dtype=np.float64)

    raw = field


def cut(land: Land, half_x: float = 40.0, half_y: float = 20.0) -> WaterBody:
    x, y = np.linspace(-half_x, half_x, 161), np.linspace(-half_y, half_y, 161)
    ground = -FALL * x[None] - DEEP * np.clip(1 - np.abs(y[:, None]) / HALF, 0, None)
    return water_body(land, x, y, ground)


def test_the_volume_is_that_between_level_and_ground() -> None:
    """Law: a triangular section of depth 1.5 m and half width 3.75 m over 80 m."""
    body = cut(Land())
    solid = Solid.from_mesh(body.mesh, closed=True)
    assert solid.is_watertight
    assert body.volume == pytest.approx(1.5 * 3.75 * 80, rel=0.01)
    assert solid.volume == pytest.approx(body.volume, rel=1e-9)
    assert contains(solid, np.array([[0.0, 0.0, -1.0], [30.0, 2.0, -0.95]])).all()
    assert not contains(solid, np.array([[0.0, 0.0, -0.4], [0.0, 0.0, -2.1], [0.0, 4.5, -0.6]])).any()


def test_a_dry_landscape_holds_no_liquid() -> None:
    with pytest.raises(InputError, match="holds no water"):
        cut(Land(wet=False))


def test_a_river_enters_and_leaves_across_its_section_with_the_discharge_of_its_level() -> None:
    body = cut(Land())
    entry, exit_ = river_gates(Land(), body, inset=1.0)
    assert (entry.enters, exit_.enters) == (True, False)
    assert entry.direction == pytest.approx((1.0, 0.0))
    assert -40 < entry.center[0] < -35
    assert 35 < exit_.center[0] < 40
    assert entry.discharge == pytest.approx(5 * (3.0 + 2.0 * 11 / 59), abs=0.5), "bankfull, five times the mean"
    width, height = entry.size
    low = entry.center[2] - height / 2
    depth_at_its_side = -FALL * entry.center[0] - DEEP * (1 - (abs(entry.center[1]) + width / 2) / HALF)
    assert low > depth_at_its_side - 1e-9, "its corners are off the banks"
    assert entry.center[2] + height / 2 < -FALL * entry.center[0] - 0.5
    assert exit_.size == pytest.approx((7.5, 1.5), rel=0.03), "all of the water"


def test_a_river_runs_with_discharge_over_area() -> None:
    """Law: area of the triangular section 1.5 m x 3.75 m; the discharge grows along the reach. No faster than its waves."""
    land = Land()
    land.about["reaches"][0]["discharge"] = [0.6, 1.0]
    (course,) = river_courses(land, cut(land))
    x = course.points[:, 0]
    assert (np.diff(x) > 0).all()
    assert x[0] < -37
    assert x[-1] > 37
    flow = 5 * (0.6 + 0.4 * ((x + 59) / 118))
    assert course.speeds == pytest.approx(flow / (1.5 * 3.75), rel=0.02)
    assert course.points[:, 2] == pytest.approx(-FALL * x - 0.5, abs=0.02)
    assert course.width == pytest.approx(2 * (3.75 + 1.0), rel=0.03), "the course of cells lies a metre beside the channel"
    (flood,) = river_courses(Land(), cut(Land()))
    assert flood.speeds == pytest.approx(np.sqrt(9.81 * 0.75), rel=0.02)

"""Routes over open land: slope, water, plants and buildings, each just within and just beyond what the carrier takes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._lands import NAME, axes, declared, keep
from worldagent.testing.worlds.small_worlds import box, make_candidate, world
from worldagent.verifiers.routes.navigability import check
from worldagent.worlds.arrays import F64
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import BoxRegion, Connects, Entity

SIDE, CELL = 61, 2.0


def _row(
    folder: Path,
    height: F64,
    *,
    water: F64 | None = None,
    plants: Sequence[tuple[float, float, float, str]] = (),
    entities: Mapping[str, Entity] | None = None,
    far: float = 40.0,
    **relation: Any,
) -> Row:
    rows, cols = height.shape
    terrain = declared(rows, cols, CELL)
    keep(folder, terrain, height, water=water, plants=plants)
    x, y = axes(rows, cols, CELL)

    def around(px: float) -> BoxRegion:
        z = float(height[np.hypot(x - px, y) <= 4.0].mean())
        return BoxRegion(min=(px - 3, -3, z - 3), max=(px + 3, 3, z + 3))

    spec = world(
        {"marker": box(1, 1, 1, at=(0, 0, 200)), **(entities or {})},
        regions={"a": around(-far), "b": around(far)},
        relations={"way": Connects(a="a", b="b", **relation)},
        terrains={NAME: terrain},
    )
    (row,) = check(make_candidate(folder, spec))
    return row


def _grid(side: int = SIDE) -> tuple[F64, F64]:
    return axes(side, side, CELL)


def test_an_even_slope_within_the_limit_is_a_route_of_that_slope(tmp_path: Path) -> None:
    x, y = _grid()
    row = _row(tmp_path, 0.3 * x + 0.4 * y, max_slope=0.47)
    assert row.status == "pass"
    assert row.measured == pytest.approx(math.atan(0.5), abs=1e-9)
    assert row.evidence["route_length_m"] >= 74.0


def test_a_ridge_that_is_too_steep_everywhere_fails_with_its_slope_and_place(tmp_path: Path) -> None:
    x, y = _grid()
    row = _row(tmp_path, np.interp(np.abs(x), [0, 10], [8.0, 0.0]) + 0.0 * y)
    assert row.status == "fail"
    assert row.evidence["reason"] == "too steep"
    assert row.measured == pytest.approx(math.atan(0.8), abs=1e-9)
    assert abs(row.evidence["steepest_place"][0]) <= 10.0


def test_the_way_goes_round_by_a_gentle_pass(tmp_path: Path) -> None:
    x, y = _grid()
    height = np.interp(np.abs(x), [0, 10], [8.0, 0.0]) * np.clip(np.abs(y - 40.0) / 8.0 - 0.5, 0.0, 1.0)
    row = _row(tmp_path, height)
    assert row.status == "pass"
    assert row.evidence["route_length_m"] > 100.0


@pytest.mark.parametrize(("depth", "status"), [(0.49, "pass"), (0.52, "fail")])
def test_water_deeper_than_is_waded_bars_the_way(tmp_path: Path, depth: float, status: str) -> None:
    x, y = _grid()
    row = _row(tmp_path, 0.0 * y, water=np.where(np.abs(x) < 5, depth, np.nan))
    assert row.status == status
    if status == "fail":
        assert row.evidence["reason"] == "too deep"
        assert row.measured == pytest.approx(depth, abs=1e-6)


def test_a_bridge_leads_over_deep_water(tmp_path: Path) -> None:
    x, y = _grid(20)
    water = np.where(np.abs(x) < 2, 0.9, np.nan)
    bridge = box(6.6, 1.6, 0.2, at=(0, 0, 1.0))
    ramps = {f"ramp{s}": box(8.1, 1.6, 0.2, at=(s * 7.3, 0, 0.47), euler=(0, s * 0.1312, 0)) for s in (-1, 1)}
    height = 0.0 * y
    assert _row(tmp_path, height, water=water, far=15.0).evidence["reason"] == "too deep"
    assert _row(tmp_path, height, water=water, entities={"deck": bridge, **ramps}, far=15.0).status == "pass"


def _palisade(gap: float) -> list[tuple[float, float, float, str]]:
    """Columns of 0.6 m radius from edge to edge."""
    step = 1.2 + gap
    return [(0.3, y, 10.0, "column") for y in np.arange(-59.0, 59.0, step)]


def test_trunks_bar_the_way_where_they_leave_less_than_the_width(tmp_path: Path) -> None:
    _, y = _grid()
    assert _row(tmp_path, 0.0 * y, plants=_palisade(2.4), width=0.8).status == "pass"
    row = _row(tmp_path, 0.0 * y, plants=_palisade(0.7), width=0.8)
    assert row.status == "fail"
    assert row.evidence["reason"] in ("overgrown", "too narrow", "blocked")


def test_a_wall_across_the_land_is_named(tmp_path: Path) -> None:
    _, y = _grid(12)
    row = _row(tmp_path, 0.0 * y, entities={"wall": box(0.5, 130, 3, at=(0, 0, 1.4))}, far=8.0)
    assert row.status == "fail"
    assert row.entities == ("wall",)


def test_a_hole_in_the_land_from_side_to_side_is_a_gap(tmp_path: Path) -> None:
    x, y = _grid()
    row = _row(tmp_path, np.where(np.abs(x) < 3, np.nan, 0.0 * y))
    assert row.status == "fail"
    assert row.evidence["reason"] == "gap"


def test_a_landscape_that_is_not_built_is_no_evidence(tmp_path: Path) -> None:
    spec = world(
        {"marker": box(1, 1, 1)},
        regions={"a": BoxRegion(min=(0, 0, 0), max=(1, 1, 1)), "b": BoxRegion(min=(3, 0, 0), max=(4, 1, 1))},
        relations={"way": Connects(a="a", b="b")},
        terrains={NAME: declared(9, 9, 1.0)},
    )
    (row,) = check(make_candidate(tmp_path, spec))
    assert row.status == "unverified"

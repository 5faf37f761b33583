"""Static things on landscapes: those that stand pass, those that float, hang, overhang or are buried fail with the place."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._lands import NAME, axes, declared, keep
from worldagent.testing.worlds.small_worlds import ball, box, make_candidate, world
from worldagent.verifiers.support.check import check
from worldagent.worlds.arrays import F64
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, Cylinder, Entity, Part

SIDE, CELL = 41, 2.0


def _grid() -> tuple[F64, F64]:
    return axes(SIDE, SIDE, CELL)


def _rows(folder: Path, height: F64, entities: Mapping[str, Entity]) -> dict[str, Row]:
    terrain = declared(SIDE, SIDE, CELL)
    keep(folder, terrain, height)
    spec = world(entities, terrains={NAME: terrain})
    return {r.id: r for r in check(make_candidate(folder, spec))}


def _house(folder: Path, height: F64, at: Any, **more: Any) -> Row:
    return _rows(folder, height, {"house": box(8, 6, 5, at=at, **more)})["support:ground:house"]


def _posts(tops: float) -> list[Part]:
    """A slab on four posts that reach down to a slope of 0.1 along x."""
    parts = [Part(shape=Box(size=(6, 6, 0.3)), pose={"position": (0, 0, tops)})]
    for x in (-2.5, 2.5):
        for y in (-2.5, 2.5):
            foot = 0.1 * x - 0.02
            tall = tops - foot
            parts.append(Part(shape=Cylinder(radius=0.15, height=tall), pose={"position": (x, y, foot + tall / 2)}))
    return parts


@pytest.mark.parametrize(("z", "status"), [(2.5, "pass"), (2.1, "pass"), (2.52, "fail"), (1.9, "fail")])
def test_a_house_on_level_ground_stands_within_its_foundation(tmp_path: Path, z: float, status: str) -> None:
    row = _house(tmp_path, 0.0 * _grid()[0], (0.3, 0.7, z))
    assert row.status == status
    if status == "fail":
        assert row.entities == ("house",)
        assert row.measured == pytest.approx(abs(2.5 - z), abs=1e-9)


def test_the_ground_between_lattice_points_counts(tmp_path: Path) -> None:
    x, y = _grid()
    bump = np.where((np.abs(x) < 1) & (np.abs(y) < 1), 0.8, 0.0)
    row = _house(tmp_path, bump, (0.0, 0.0, 2.51))
    assert row.status == "fail"
    assert "buried" in row.evidence["explanation"]
    assert row.evidence["place"][:2] == pytest.approx([0, 0], abs=0.3)


def test_a_house_half_in_the_slope_and_half_over_it_fails(tmp_path: Path) -> None:
    x, _ = _grid()
    row = _house(tmp_path, 0.1 * x, (0, 0, 2.5))
    assert row.status == "fail"
    assert "hangs" in row.evidence["explanation"]
    assert row.measured == pytest.approx(0.4, abs=0.02)
    assert row.evidence["place"][0] == pytest.approx(-4.0, abs=0.2)


def test_a_house_on_posts_of_different_length_stands_on_a_slope(tmp_path: Path) -> None:
    x, _ = _grid()
    rows = _rows(tmp_path, 0.1 * x, {"hut": Entity.model_validate({**_posts_entity(1.5), "pose": {"position": (0, 0, 0)}})})
    assert rows["support:ground:hut"].status == "pass"


def _posts_entity(tops: float) -> dict[str, Any]:
    return {
        "role": "hut on posts",
        "motion": "static",
        "material": "wood",
        "dimensions": {"size": (6, 6, tops + 0.42)},
        "parts": {f"p{k}": p.model_dump() for k, p in enumerate(_posts(tops))},
    }


def test_a_house_that_reaches_over_a_cliff_overhangs(tmp_path: Path) -> None:
    x, _ = _grid()
    row = _house(tmp_path, np.where(x < -3, 0.0, -20.0), (0, 0, 2.5))
    assert row.status == "fail"


def test_what_stands_on_something_that_stands_passes(tmp_path: Path) -> None:
    height = 0.0 * _grid()[0]
    rows = _rows(tmp_path, height, {"base": box(4, 4, 1, at=(0, 0, 0.5)), "statue": box(1, 1, 2, at=(0, 0, 2.0))})
    assert rows["support:ground:base"].status == "pass"
    assert "support:ground:statue" not in rows


def test_two_that_touch_only_each_other_float(tmp_path: Path) -> None:
    height = 0.0 * _grid()[0]
    rows = _rows(tmp_path, height, {"base": box(4, 4, 1, at=(0, 0, 1.5)), "statue": box(1, 1, 2, at=(0, 0, 3.0))})
    assert rows["support:ground:base"].status == "fail"
    assert "floats 1 m" in rows["support:ground:base"].evidence["explanation"]
    assert rows["support:ground:base"].corrections[0].patch[0]["value"]["position"][2] == pytest.approx(0.5, abs=1e-3)


def test_worlds_without_landscapes_have_no_such_row(tmp_path: Path) -> None:
    rows = check(make_candidate(tmp_path, world({"lamp": box(1, 1, 1, at=(0, 0, 5))})))
    assert not [r for r in rows if r.id.startswith("support:ground")]


def test_what_hovers_on_purpose_is_kinematic(tmp_path: Path) -> None:
    rows = _rows(tmp_path, 0.0 * _grid()[0], {"drone": box(1, 1, 1, at=(0, 0, 5), motion="kinematic")})
    assert not [r for r in rows if r.startswith("support:ground")]


@pytest.mark.parametrize("slope", [0.0, 0.3, 0.6])
def test_a_boulder_that_touches_a_slope_is_not_asked_to_lie_flat(slope: float, tmp_path: Path) -> None:
    x, _ = _grid()
    rows = _rows(tmp_path, slope * x, {"boulder": ball(1.0, at=(0, 0, np.hypot(1.0, slope) - 0.001))})
    assert rows["support:ground:boulder"].status == "pass"

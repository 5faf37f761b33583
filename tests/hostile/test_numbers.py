"""Specifications that validate and are absurd: refused in words, or built to rows that fail; no crash and no hang."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.build import build_entity
from worldagent.construction.crowding import check_crowding, crowded_pairs
from worldagent.tests.hostile.specs import rewritten
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.errors import InputError, LimitError
from worldagent.worlds.limits import check_limits
from worldagent.worlds.patch import parse_spec

SHAPE = "/entities/b1/parts/body/shape"
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]


def corners(size: float) -> list[list[float]]:
    return [[0, 0, 0], [size, 0, 0], [0, size, 0], [0, 0, size]]


SHAPES: dict[str, dict[str, Any]] = {
    "a sphere of no radius": {"kind": "sphere", "radius": 5e-324},
    "a sphere of a picometre": {"kind": "sphere", "radius": 1e-12},
    "a sphere of a million kilometres": {"kind": "sphere", "radius": 1e9},
    "a box of no volume": {"kind": "box", "size": [1e-160] * 3},
    "a sheet": {"kind": "box", "size": [1e9, 1e9, 5e-324]},
    "a wedge like a hair": {"kind": "wedge", "size": [1e9, 1e-9, 1e-9]},
    "a polygon on a line": {"kind": "extrusion", "polygon": [[0, 0], [1, 0], [2, 0]], "height": 1},
    "a polygon like a hair": {"kind": "extrusion", "polygon": [[0, 0], [1e-9, 0], [1e-9, 1e9], [0, 1e9]], "height": 1e-9},
    "a profile on the axis": {"kind": "revolution", "profile": [[0, 0], [0, 1], [0, 2]], "segments": 128},
    "a profile of no size": {"kind": "revolution", "profile": [[0, 0], [1e-160, 0], [0, 1e-160]]},
    "a mesh of no size": {"kind": "mesh", "vertices": corners(1e-7), "faces": TETRAHEDRON, "scale": 1e-9},
    "a mesh of all sizes": {"kind": "mesh", "vertices": corners(1e9), "faces": TETRAHEDRON, "scale": 1e9},
    "a mesh without faces": {"kind": "mesh", "vertices": [], "faces": []},
    "a mesh of a point": {"kind": "mesh", "vertices": [[0, 0, 0]], "faces": [[0, 0, 0]]},
}


@pytest.mark.parametrize("name", SHAPES)
def test_an_absurd_shape_is_refused_in_words(name: str, tmp_path: Path) -> None:
    spec = parse_spec({"prompt": PROMPT, **rewritten(small_spec(), SHAPE, SHAPES[name])})
    with pytest.raises(InputError, match=r"\S"):
        build_entity(spec, "b1", tmp_path)


@pytest.mark.parametrize(
    ("pointer", "value"),
    [
        ("/simulation/frames", 10**6),
        ("/simulation/fps", 10**6),
        ("/simulation/fps", 0),
        ("/materials/steel/density", 1e300),
        ("/materials/steel/density", 0),
        ("/entities/ball/physics/linear_velocity/0", 1e10),
        ("/simulation/gravity/2", -1e300),
        ("/simulation/solvers/rigid/settings/step", 0),
    ],
)
def test_an_absurd_number_is_no_specification(pointer: str, value: Any) -> None:
    spec = small_spec()
    spec["simulation"]["solvers"]["rigid"].setdefault("settings", {}).setdefault("step", 5e-4)
    spec["simulation"].setdefault("fps", 24)
    spec["simulation"].setdefault("gravity", [0, 0, -9.81])
    with pytest.raises(InputError):
        parse_spec({"prompt": PROMPT, **rewritten(spec, pointer, value)})


def test_the_longest_run_of_the_finest_step_is_over_the_limit() -> None:
    spec = small_spec()
    spec["simulation"] |= {"frames": 19_900, "fps": 1, "preroll": 60}
    spec["simulation"]["solvers"]["rigid"]["settings"] = {"step": 2e-5}
    with pytest.raises(LimitError, match="solver steps"):
        check_limits(parse_spec({"prompt": PROMPT, **spec}))


def crowd(count: int, step: float) -> dict[str, Any]:
    spec = small_spec()
    for k in range(count):
        block = copy.deepcopy(spec["entities"]["b1"])
        block["pose"]["position"][0] += step * k
        spec["entities"][f"x{k}"] = block
        spec["simulation"]["solvers"]["rigid"]["members"].append(f"x{k}")
    return spec


def test_a_thousand_bodies_in_one_place_are_refused_before_their_pairs_are_measured(tmp_path: Path) -> None:
    spec = parse_spec({"prompt": PROMPT, **crowd(1000, 0.0)})
    built = {name: build_entity(spec, name, tmp_path) for name in spec.entities}
    with pytest.raises(LimitError, match=r"crowded_pairs.*501,\d{3} pairs.*places of their own"):
        check_crowding(spec, built)


def test_a_thousand_bodies_in_a_row_are_no_crowd(tmp_path: Path) -> None:
    spec = parse_spec({"prompt": PROMPT, **crowd(1000, 0.05)})
    built = {name: build_entity(spec, name, tmp_path) for name in spec.entities}
    assert crowded_pairs(spec, built) < 10
    check_crowding(spec, built)

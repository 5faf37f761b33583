"""Lofts, letters and booleans: volumes, exact pieces, membership against the shapes' own formulas, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from pydantic import TypeAdapter, ValidationError
from worldagent.construction.composed import MOST_PIECES
from worldagent.construction.primitives import ShapeGeometry, build_shape
from worldagent.geometry.booleans import union_volume
from worldagent.geometry.inside import contains
from worldagent.geometry.solids import Solid
from worldagent.tests.stories.yard import PROMPT, yard_spec
from worldagent.verifiers.scene.extents import specified_extent
from worldagent.worlds.arrays import F64
from worldagent.worlds.errors import InputError
from worldagent.worlds.extents import box_size
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.scaled import scaled_entity
from worldagent.worlds.shapes import LETTERS
from worldagent.worlds.spec import Part, Shape

SHAPE: TypeAdapter[Any] = TypeAdapter(Shape)
BOX = {"kind": "box", "size": [0.4, 0.2, 0.02]}
DRILL = {"kind": "cylinder", "radius": 0.01, "height": 0.05}
L_PLAN = [[0, 0], [1, 0], [1, 0.3], [0.3, 0.3], [0.3, 1], [0, 1]]
SIDES = 32
CIRCLE_32 = SIDES / 2 * math.sin(2 * math.pi / SIDES)
"""Area of a polygon of 32 sides in the unit circle."""


def boolean(operation: str, *members: dict[str, Any]) -> dict[str, Any]:
    return {"kind": "boolean", "operation": operation, "of": list(members)}


PLATE = boolean(
    "difference",
    {"shape": BOX},
    {"shape": DRILL, "pose": {"position": [-0.15, 0, 0]}, "repeat": {"count": 5, "move": [0.075, 0, 0]}},
)
MORTISE = boolean(
    "difference", {"shape": {"kind": "box", "size": [0.06, 0.06, 0.7]}}, {"shape": {"kind": "box", "size": [0.02, 0.1, 0.05]}}
)
DOME = boolean(
    "intersection",
    {"shape": {"kind": "capsule", "radius": 0.2, "length": 0.2}},
    {"shape": {"kind": "box", "size": [1, 1, 1]}, "pose": {"position": [0, 0, 0.5]}},
)
CROSS = boolean(
    "union",
    {"shape": {"kind": "box", "size": [0.3, 0.1, 0.1]}, "repeat": {"count": 2, "turn": math.pi / 2}},
)
PAIR = boolean("union", {"shape": {"kind": "wedge", "size": [0.2, 0.1, 0.1]}, "pose": {"position": [0.3, 0, 0]}, "mirror": "x"})
FRUSTUM = {
    "kind": "loft",
    "sections": [
        {"polygon": [[-1, -1], [1, -1], [1, 1], [-1, 1]]},
        {"polygon": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], "pose": {"position": [0, 0, 3]}},
    ],
}
ANGLE = {"kind": "loft", "sections": [{"polygon": L_PLAN}, {"polygon": L_PLAN, "pose": {"position": [0.2, 0, 0.5]}}]}
SIGN = {"kind": "text", "text": "Exit 24", "height": 0.1, "depth": 0.01}


def built(document: dict[str, Any]) -> ShapeGeometry:
    return build_shape(SHAPE.validate_python(document), Path())


@pytest.mark.parametrize(
    ("document", "volume"),
    [
        (PLATE, 0.4 * 0.2 * 0.02 - 5 * CIRCLE_32 * 0.01**2 * 0.02),
        (MORTISE, 0.06 * 0.06 * 0.7 - 0.02 * 0.06 * 0.05),
        (CROSS, 2 * 0.003 - 0.001),
        (PAIR, 0.2 * 0.1 * 0.1),
        (FRUSTUM, 3 / 3 * (4 + 1 + 2)),
        (ANGLE, 0.51 * 0.5),
    ],
)
def test_volumes_are_those_of_the_formula(document: dict[str, Any], volume: float) -> None:
    solid = trimesh.Trimesh(built(document).render.vertices, built(document).render.faces)
    assert solid.volume == pytest.approx(volume, rel=1e-9)


@pytest.mark.parametrize("document", [PLATE, MORTISE, DOME, CROSS, PAIR, FRUSTUM, ANGLE, SIGN])
def test_pieces_fill_what_is_drawn(document: dict[str, Any]) -> None:
    shape = built(document)
    drawn = trimesh.Trimesh(shape.render.vertices, shape.render.faces, process=False)
    assert drawn.is_watertight
    assert drawn.is_winding_consistent
    assert union_volume([p.points for p in shape.collision]) == pytest.approx(drawn.volume, rel=1e-9)


def test_a_dome_of_a_capsule_is_one_piece() -> None:
    shape = built(DOME)
    drawn = trimesh.Trimesh(shape.render.vertices, shape.render.faces, process=False)
    exact = math.pi * 0.2**2 * 0.1 + 2 / 3 * math.pi * 0.2**3
    assert len(shape.collision) == 1
    assert 0.97 * exact < drawn.volume < exact


def _inside_sphere(points: F64, radius: float) -> Any:
    return np.linalg.norm(points, axis=1) < radius


@pytest.mark.parametrize("seed", range(6))
def test_a_random_difference_holds_the_points_that_the_formula_holds(seed: int) -> None:
    """A box less two turned boxes and a sphere: points are inside where they are in the box and in none of the tools."""
    random = np.random.default_rng(seed)
    size, tools = random.uniform(0.5, 1.0, 3), []
    for _ in range(2):
        axis, angle = random.normal(size=3), random.uniform(0, math.pi)
        axis /= np.linalg.norm(axis)
        quaternion = [math.cos(angle / 2), *(math.sin(angle / 2) * axis)]
        tools.append((random.uniform(0.2, 0.6, 3), quaternion, random.uniform(-0.4, 0.4, 3)))
    radius, centre = random.uniform(0.1, 0.3), random.uniform(-0.3, 0.3, 3)
    members = [
        {"shape": {"kind": "box", "size": t[0].tolist()}, "pose": {"quaternion": t[1], "position": t[2].tolist()}} for t in tools
    ]
    ball = {"shape": {"kind": "sphere", "radius": radius}, "pose": {"position": centre.tolist()}}
    shape = built(boolean("difference", {"shape": {"kind": "box", "size": size.tolist()}}, *members, ball))
    points = random.uniform(-0.5, 0.5, (4000, 3)) * size
    wanted = ~_inside_sphere(points - centre, radius)
    for extent, (w, x, y, z), place in tools:
        turn = trimesh.transformations.quaternion_matrix([w, x, y, z])[:3, :3]
        wanted &= (np.abs((points - place) @ turn) > extent / 2).any(1)
    # The faceted ball is smaller than the sphere by up to 3 % of its radius: points between the two are not judged.
    clear = wanted | ~_inside_sphere(points - centre, radius) | _inside_sphere(points - centre, 0.96 * radius)
    solid = Solid.from_mesh(shape.render, closed=True)
    assert (contains(solid, points)[clear] == wanted[clear]).all()
    drawn = trimesh.Trimesh(shape.render.vertices, shape.render.faces, process=False)
    assert union_volume([p.points for p in shape.collision]) == pytest.approx(drawn.volume, rel=1e-6)


@pytest.mark.parametrize("letter", sorted(set(LETTERS) - {" "}))
def test_every_letter_is_drawn_and_stands_at_its_height(letter: str) -> None:
    shape = built({"kind": "text", "text": letter, "height": 0.6, "depth": 0.05, "stroke": 0.1})
    low, high = shape.render.vertices.min(0), shape.render.vertices.max(0)
    assert high[2] - low[2] == pytest.approx(0.05)
    assert abs(low[0] + high[0]) <= 0.06 + 1e-9  # centred, but for what a stroke does on one side
    if letter.isascii() and letter.isalpha() and letter != "Q":
        assert high[1] - low[1] == pytest.approx(0.66, rel=0.02)


def test_letters_read_from_left_to_right() -> None:
    whole = built({"kind": "text", "text": "IL", "height": 0.6, "depth": 0.05})
    upper = whole.render.vertices[whole.render.vertices[:, 1] > 0.2]
    lower = whole.render.vertices[whole.render.vertices[:, 1] < -0.2]
    assert lower[:, 0].max() > upper[:, 0].max() + 0.1  # the foot of the L reaches right


@pytest.mark.parametrize(
    ("document", "told"),
    [
        (boolean("difference", {"shape": {"kind": "box", "size": [0.1] * 3}}, {"shape": {"kind": "box", "size": [1] * 3}}), "is empty"),
        (boolean("union", {"shape": DRILL, "repeat": {"count": 2}}, {"shape": {"kind": "text", "text": "W" * 32, "height": 1, "depth": 1}, "repeat": {"count": 64, "move": [0, 3, 0]}}), "at most 512"),
        ({"kind": "loft", "sections": [{"polygon": L_PLAN}, {"polygon": [[0, 0], [1, 0], [1, 1], [0.7, 1], [0.7, 0.3], [0, 0.3]], "pose": {"position": [0, 0, 1]}}]}, "bends in"),
        ({"kind": "loft", "sections": [{"polygon": [[0, 0], [1, 0], [0, 1]]}, {"polygon": [[0, 0], [2, 0], [0, 2]]}]}, "lie in one plane"),
    ],
)  # fmt: skip
def test_what_makes_no_solid_is_refused_with_the_next_step(document: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        built(document)


@pytest.mark.parametrize(
    ("document", "told"),
    [
        ({"kind": "text", "text": "Ω", "height": 0.1, "depth": 0.01}, "no letter for 'Ω'"),
        ({"kind": "text", "text": "  ", "height": 0.1, "depth": 0.01}, "blanks alone"),
        (boolean("difference", {"shape": BOX}), "at least 2 members"),
        (boolean("union", {"shape": BOX}), "has copies"),
        ({"kind": "loft", "sections": [{"polygon": L_PLAN}, {"polygon": [[0, 0], [1, 0], [0, 1]]}]}, "equally many corners"),
        (boolean("union", {"shape": PAIR}, {"shape": BOX}), "boolean"),
    ],
)
def test_what_means_nothing_is_refused_by_the_specification(document: dict[str, Any], told: str) -> None:
    with pytest.raises(ValidationError, match=told):
        SHAPE.validate_python(document)


def test_a_plate_with_many_holes_keeps_within_the_pieces() -> None:
    assert len(built(PLATE).collision) < MOST_PIECES / 2


@pytest.mark.parametrize("document", [PLATE, MORTISE, DOME, CROSS, PAIR, FRUSTUM, ANGLE])
def test_the_declared_box_holds_the_solid(document: dict[str, Any]) -> None:
    shape = SHAPE.validate_python(document)
    size = box_size(shape)
    assert size is not None
    solid = np.ptp(built(document).render.vertices, axis=0)
    assert (solid <= size + 1e-9).all()
    extent = specified_extent(Part(shape=shape))
    assert extent is None or extent.size == pytest.approx(solid)


def test_scaling_reaches_members_sections_and_their_places() -> None:
    for document in (PLATE, ANGLE, SIGN, PAIR):
        spec = {**yard_spec(), "prompt": PROMPT}
        spec["entities"]["stone"]["parts"] = {"body": {"shape": document}}
        larger = scaled_entity(parse_spec(spec), "stone", 2.0)["parts"]["body"]["shape"]
        one, two = built(document).render, built(larger).render
        assert np.ptp(two.vertices, axis=0) == pytest.approx(2 * np.ptp(one.vertices, axis=0), rel=1e-6)
        assert trimesh.Trimesh(two.vertices, two.faces).volume == pytest.approx(
            8 * trimesh.Trimesh(one.vertices, one.faces).volume, rel=1e-6
        )

"""Forms and colours in words, against shapes of known form and size, turned as one likes."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from matplotlib._color_data import XKCD_COLORS
from worldagent.verifiers.account.colours import NAMES, colour_word
from worldagent.verifiers.account.forms import form_of, joined_form
from worldagent.verifiers.account.wording import letters, number, towards
from worldagent.worlds.arrays import rotation_matrix
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.spec import Appearance

TURN = rotation_matrix(np.array([0.8, 0.36, 0.48, 0.0]))
RING = [(0.04, 0.0), (0.05, 0.0), (0.05, 0.1), (0.04, 0.1), (0.04, 0.0)]


def turned(made: trimesh.Trimesh) -> TriangleMesh:
    return TriangleMesh(np.array(made.vertices) @ TURN.T + [1.0, -2.0, 0.5], np.array(made.faces, dtype=np.int32))


def wedge() -> trimesh.Trimesh:
    corners = [[0, 0, 0], [0.4, 0, 0], [0, 0, 0.2], [0, 0.1, 0], [0.4, 0.1, 0], [0, 0.1, 0.2]]
    faces = [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [0, 2, 5], [0, 5, 3], [1, 4, 5], [1, 5, 2]]
    return trimesh.Trimesh(np.array(corners, dtype=float), faces, process=False)


def sheet() -> trimesh.Trimesh:
    corners = [[0, 0, 0], [0.5, 0, 0], [0.5, 0.25, 0], [0, 0.25, 0]]
    return trimesh.Trimesh(np.array(corners, dtype=float), [[0, 1, 2], [0, 2, 3]], process=False)


@pytest.mark.parametrize(
    ("made", "word", "sizes"),
    [
        (trimesh.creation.box(extents=[0.1, 0.4, 0.2]), "box", (0.4, 0.2, 0.1)),
        (trimesh.creation.box(extents=[0.2, 0.2, 0.2]), "box", (0.2, 0.2, 0.2)),
        (trimesh.creation.icosphere(subdivisions=3, radius=0.15), "ball", (0.3,)),
        (trimesh.creation.cylinder(radius=0.05, height=0.3, sections=32), "cylinder", (0.1, 0.3)),
        (trimesh.creation.cylinder(radius=0.2, height=0.01, sections=32), "cylinder", (0.4, 0.01)),
        (trimesh.creation.cylinder(radius=0.1, height=0.2, sections=32), "cylinder", (0.2, 0.2)),
        (trimesh.creation.capsule(radius=0.02, height=0.2, count=[16, 16]), "rod with round ends", (0.04, 0.24)),
        (trimesh.creation.revolve(np.array(RING), sections=32), "hollow round body", (0.1, 0.1)),
        (trimesh.creation.cone(radius=0.1, height=0.3, sections=32), "round body", (0.2, 0.3)),
        (wedge(), "wedge", (0.4, 0.2, 0.1)),
        (sheet(), "sheet", (0.5, 0.25)),
        (trimesh.convex.convex_hull(np.random.default_rng(3).normal(size=(30, 3))), "body", None),
    ],
)
def test_a_mesh_has_its_word_and_its_sizes_however_it_is_turned(
    made: trimesh.Trimesh, word: str, sizes: tuple[float, ...] | None
) -> None:
    found = form_of(turned(made))
    assert found.word == word
    if sizes is not None:
        assert found.sizes == pytest.approx(sizes, rel=0.03)


def test_pieces_have_the_form_that_they_make_together() -> None:
    half = np.array(trimesh.creation.box(extents=[0.2, 0.1, 0.1]).vertices)
    found = joined_form(np.concatenate([half - np.array([0.1, 0, 0]), half + np.array([0.1, 0, 0])]))
    assert found.word == "box"
    assert found.sizes == pytest.approx((0.4, 0.1, 0.1))


def test_what_is_no_number_or_has_no_surface_is_a_body_without_size() -> None:
    corners = np.full((3, 3), np.nan)
    assert form_of(TriangleMesh(corners, np.array([[0, 1, 2]], dtype=np.int32))) == ("body", ())
    assert form_of(TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]], dtype=np.int32))) == ("body", ())


def test_the_names_of_colours_are_those_of_the_survey() -> None:
    assert {f"xkcd:{name}": f"#{value:06x}" for name, value in NAMES.items()}.items() <= XKCD_COLORS.items()


@pytest.mark.parametrize(
    ("color", "more", "word"),
    [
        ((0.8, 0.02, 0.02), {}, "red"),
        ((0.04, 0.04, 0.04), {}, "dark grey"),
        ((0.0, 0.0, 0.0), {}, "black"),
        ((0.95, 0.95, 0.95), {}, "white"),
        ((0.55, 0.35, 0.2), {}, "light brown"),
        ((0.02, 0.05, 0.6), {}, "blue"),
        ((0.9, 0.9, 0.9), {"transmission": 0.9}, "clear white"),
        ((0.3, 0.3, 0.3), {"metallic": 1.0}, "metallic grey"),
    ],
)
def test_a_look_has_the_name_of_the_nearest_colour(color: tuple[float, float, float], more: dict[str, float], word: str) -> None:
    assert colour_word(Appearance(color=color, **more)) == word


def test_numbers_letters_and_directions_are_said_alike_everywhere() -> None:
    assert [number(v) for v in (0.0, -1e-9, 0.123456, 12.0)] == ["0", "0", "0.123", "12"]
    assert [letters(k) for k in (0, 25, 26, 51, 52)] == ["A", "Z", "AA", "AZ", "BA"]
    assert towards(np.array([1.0, 0.1, 0.0])) == "+x"
    assert towards(np.array([0.0, -1.0, -1.0])) == "-y and down"
    assert towards(np.zeros(3)) == "nowhere"

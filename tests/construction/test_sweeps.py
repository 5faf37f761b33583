"""Profiles along paths and hulls of points: volumes, pieces, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from worldagent.construction import sweeps
from worldagent.construction.assets.profiles import circle, rectangle
from worldagent.construction.build import _deviation
from worldagent.construction.primitives import build_shape
from worldagent.geometry.booleans import union_volume
from worldagent.geometry.solids import Solid
from worldagent.verifiers.scene.extents import specified_extent
from worldagent.worlds.errors import InputError
from worldagent.worlds.extents import box_size, shape_volume
from worldagent.worlds.spec import Hull, Part, Sweep

SQUARE = rectangle(0.2, 0.1)
RING = [(math.cos(a), math.sin(a), 0.0) for a in np.linspace(0, 2 * math.pi, 48, endpoint=False)]


def _pieces(shape: Hull | Sweep) -> float:
    return sum(float(ConvexHull(p.points).volume) for p in build_shape(shape, Path()).collision)


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (Sweep(path=[(0, 0, 0), (0, 0, 3)], profile=SQUARE), 0.06),
        # A mitred corner: each leg counts to the corner of its middle line.
        (Sweep(path=[(0, 0, 0), (1, 0, 0), (1, 2, 0)], profile=SQUARE), 0.06),
        (Sweep(path=[(0, 0, 0), (1, 0, 0), (1, 0, 2)], profile=SQUARE), 0.06),
        # A frustum of a pyramid.
        (Sweep(path=[(0, 0, 0), (0, 0, 3)], profile=SQUARE, scales=[1.0, 0.5]), 0.02 * (1 + 0.5 + 0.25)),
        # Pappus: area times the way of its centre, of a ring of 48 chords.
        (Sweep(path=RING, profile=circle(0.05, 16), closed=True), math.pi * 0.05**2 * 48 * 2 * math.sin(math.pi / 48)),
        (Hull(points=[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.1, 0.1, 0.1)]), 1 / 6),
    ],
)
def test_volume_is_that_of_the_formula_and_pieces_fill_the_mesh(shape: Hull | Sweep, volume: float) -> None:
    made = build_shape(shape, Path())
    solid = Solid.from_mesh(made.render, closed=True)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(volume, rel=1e-9)
    assert shape_volume(shape) == pytest.approx(volume, rel=1e-9)
    assert _pieces(shape) == pytest.approx(volume, rel=1e-9)
    assert _deviation(shape.kind, made) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_a_profile_that_is_not_convex_is_cut_into_convex_pieces() -> None:
    channel = [
        (-0.05, -0.05),
        (0.05, -0.05),
        (0.05, 0.05),
        (0.03, 0.05),
        (0.03, -0.03),
        (-0.03, -0.03),
        (-0.03, 0.05),
        (-0.05, 0.05),
    ]
    shape = Sweep(path=[(0, 0, 0), (1, 0, 0), (1.5, 0.5, 0)], profile=channel)
    solid = Solid.from_mesh(build_shape(shape, Path()).render, closed=True)
    assert solid.is_watertight
    assert _pieces(shape) == pytest.approx(solid.volume, rel=1e-9)


def test_what_tapers_in_a_bend_tells_how_far_its_pieces_are_off() -> None:
    shape = Sweep(path=[(0, 0, 0), (0, 0, 0.5), (0.2, 0, 0.7)], profile=circle(0.02, 12), scales=[1.0, 0.7, 0.4])
    out, inside = _deviation("sweep", build_shape(shape, Path()))
    assert 0 < out < 1e-4
    assert inside < 1e-4


@pytest.mark.parametrize(
    "shape",
    [Sweep(path=[(0, 0, 0), (1, 0, 0), (1, 2, 0)], profile=SQUARE), Hull(points=[(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)])],
)
def test_boxes_of_the_judge_and_of_the_builder_are_those_of_the_mesh(shape: Hull | Sweep) -> None:
    vertices = build_shape(shape, Path()).render.vertices
    extent = specified_extent(Part(shape=shape))
    assert extent is not None
    np.testing.assert_allclose(extent.size, np.ptp(vertices, axis=0), atol=1e-12)
    size = box_size(shape)
    assert size is not None
    np.testing.assert_allclose(size, np.ptp(vertices, axis=0), atol=1e-12)


def test_the_profile_stands_upright_with_u_to_the_right() -> None:
    shape = Sweep(path=[(0, 0, 0), (1, 0, 0)], profile=[(0, 0), (0.3, 0), (0, 0.1)])
    vertices = build_shape(shape, Path()).render.vertices
    # Seen along +x with z up, right is -y.
    assert vertices[:, 1].min() == pytest.approx(-0.3)
    assert vertices[:, 2].max() == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        (Sweep(path=[(0, 0, 0), (1, 0, 0), (0, 0, 1e-4)], profile=SQUARE), "folds back"),
        (Sweep(path=[(0, 0, 0), (0, 0, 0), (1, 0, 0)], profile=SQUARE), "are the same"),
        (Sweep(path=[(0, 0, 0), (0.05, 0, 0), (0.05, 0.05, 0), (0, 0.05, 0)], profile=SQUARE), "too short for its bends"),
        (
            Sweep(path=[(0, 0, 0), (1, 0, 0), (1, 1, 0), (0.5, 1, 0), (0.5, -1, 0)], profile=rectangle(0.05, 0.05)),
            "passes through itself",
        ),
        (
            Sweep(path=[(0, 0, 0), (1, 0, 0), (1, 1, 0.7), (0, 0.5, -0.3)], profile=rectangle(0.05, 0.05), closed=True),
            "must be plane",
        ),
        (Hull(points=[(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]), "in one plane"),
    ],
)
def test_paths_and_hulls_that_make_no_solid_are_refused_with_the_reason(shape: Hull | Sweep, said: str) -> None:
    with pytest.raises(InputError, match=said):
        build_shape(shape, Path())


SPRING = [(math.cos(a), math.sin(a), 0.04 * a) for a in np.linspace(0, 4 * math.pi, 60)]


@pytest.mark.parametrize(
    ("shape", "asked"),
    [
        (Sweep(path=RING, profile=circle(0.05, 16), closed=True), 0),
        (Sweep(path=[(0, 0, 0), (1, 0, 0), (1, 2, 0), (1, 2, 1)], profile=SQUARE, scales=[1.0, 0.5, 1.0, 0.7]), 0),
        # Turns that lie over each other are between the same planes.
        (Sweep(path=SPRING, profile=circle(0.05, 8)), 1),
    ],
)
def test_segments_with_a_ring_between_them_are_apart_without_a_union(
    shape: Sweep, asked: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Law: what lies on either side of a plane has no volume in common; the union says the same."""
    told: list[float] = []
    monkeypatch.setattr(sweeps, "union_volume", lambda pieces: told.append(union_volume(pieces)) or told[-1])
    pieces = build_shape(shape, Path()).collision
    assert len(told) == asked
    alone = sum(float(ConvexHull(p.points).volume) for p in pieces)
    assert union_volume([p.points for p in pieces]) == pytest.approx(alone, rel=1e-9)

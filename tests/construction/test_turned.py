"""Collision pieces of turned solids: few, convex, and together the solid."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from worldagent.construction.assets.registry import make
from worldagent.construction.primitives import build_shape
from worldagent.construction.turned import stacked_pieces
from worldagent.geometry import Solid
from worldagent.geometry.inside import contains
from worldagent.worlds.spec import Revolution

SEGMENTS = 32
BALUSTER = [
    (0, 0),
    (0.1, 0),
    (0.1, 0.05),
    (0.03, 0.15),
    (0.06, 0.3),
    (0.03, 0.45),
    (0.03, 0.6),
    (0.12, 0.6),
    (0.12, 0.62),
    (0, 0.62),
]
"""A foot, a waist, a bulge, a neck and a plate: solid, and not convex."""
STEPS = [(0, 0), (0.2, 0), (0.2, 0.1), (0.1, 0.1), (0.1, 0.2), (0.15, 0.2), (0.15, 0.3), (0, 0.35)]


def turned(profile: list[tuple[float, float]]) -> Revolution:
    return Revolution(profile=profile, segments=SEGMENTS)


@pytest.mark.parametrize(("profile", "count"), [(BALUSTER, 4), (STEPS, 3), ([(0, 0), (0.1, 0), (0.1, 0.2), (0, 0.2)], 1)])
def test_a_solid_of_revolution_is_a_stack_of_convex_pieces(profile: list[tuple[float, float]], count: int) -> None:
    made = build_shape(turned(profile), Path())
    assert len(made.collision) == count
    solid = Solid.from_mesh(made.render, closed=True)
    volume = sum(float(ConvexHull(c.points).volume) for c in made.collision)
    assert volume == pytest.approx(abs(solid.volume), rel=1e-9)
    rng = np.random.default_rng(1)
    points = rng.uniform(solid.lower, solid.upper, (2000, 3))
    inside = np.zeros(len(points), dtype=bool)
    for piece in made.collision:
        planes = ConvexHull(piece.points).equations
        inside |= (points @ planes[:, :3].T + planes[:, 3] <= 1e-12).all(axis=1)
    assert np.array_equal(inside, contains(solid, points))


@pytest.mark.parametrize(
    "profile",
    [
        [(0.1, 0), (0.2, 0), (0.2, 0.3), (0.1, 0.3)],  # a ring
        [(0, 0), (0.2, 0), (0.2, 0.3), (0.18, 0.3), (0.18, 0.02), (0, 0.02)],  # a glass
        [(0, 0), (0.1, 0), (0.1, 0.2), (0.3, 0.1), (0.3, 0.3), (0, 0.3)],  # it overhangs
    ],
)
def test_what_is_no_stack_keeps_its_wedges(profile: list[tuple[float, float]]) -> None:
    assert stacked_pieces(profile, [r == 0 for r, _ in profile]) == []
    made = build_shape(turned(profile), Path())
    volume = sum(float(ConvexHull(c.points).volume) for c in made.collision)
    assert volume == pytest.approx(abs(Solid.from_mesh(made.render, closed=True).volume), rel=1e-9)
    assert len(made.collision) >= SEGMENTS


def test_turned_things_of_the_library_collide_by_few_pieces() -> None:
    """A round table's column was 193 pieces, a lamp's bulb 21."""
    for name, most in (("round_table", 40), ("table_lamp", 80), ("floor_lamp", 80)):
        made = make(name, {}, 1)
        pieces = [len(build_shape(p.shape, Path()).collision) for p in made.main.parts.values()]
        assert math.fsum(pieces) <= most, name

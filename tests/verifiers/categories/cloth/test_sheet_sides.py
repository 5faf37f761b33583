"""Which side of a sheet particles are on: straight through, slowly, fast, around the rim, and there and back."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.verifiers.categories.cloth.sides import SheetSides
from worldagent.worlds.arrays import F64

RADIUS = 0.1
AT = (0.43, 0.38)


def grid(count: int = 5) -> tuple[F64, np.ndarray]:
    """A unit square in the plane z = 0."""
    line = np.linspace(0.0, 1.0, count)
    vertices = np.array([[x, y, 0.0] for x in line for y in line])
    corner = np.array([[count * i + j for j in range(count - 1)] for i in range(count - 1)]).reshape(-1)
    a, b, c, d = corner, corner + count, corner + count + 1, corner + 1
    return vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)


def passed(*ways: list[tuple[float, float, float]], lifts: list[float] | None = None) -> list[int]:
    """For every particle the first frame at which it has passed, -1 where it never does."""
    vertices, faces = grid()
    sides, found, place = SheetSides(faces), np.full(len(ways), -1), np.array(ways)
    sheets = [vertices + np.array([0.0, 0.0, lift]) for lift in lifts or [0.0] * place.shape[1]]
    for k in range(1, place.shape[1]):
        sheet = sheets[k - 1], sheets[k]
        rows, _ = sides.see(np.arange(len(ways)), sheet, (place[:, k - 1], place[:, k]), np.full(len(ways), RADIUS))
        found[rows[found[rows] < 0]] = k
    return [int(k) for k in found]


def falls(*heights: float) -> list[tuple[float, float, float]]:
    return [(*AT, h) for h in heights]


@pytest.mark.parametrize("heights", [(0.08, -0.08), (0.9, -0.9), (0.03, 0.025, -0.025), (20.0, -30.0), (-0.3, 0.2)])
def test_what_ends_on_the_other_side_has_passed_however_fast_it_is(heights: tuple[float, ...]) -> None:
    assert passed(falls(*heights)) == [len(heights) - 1]


def test_what_takes_many_frames_has_passed_when_it_is_away_again() -> None:
    assert passed(falls(0.05, 0.012, 0.004, -0.003, -0.01, -0.018, -0.025)) == [6]


def test_what_comes_back_or_stays_has_not_passed() -> None:
    assert passed(falls(0.05, -0.01, 0.05), falls(0.05, 0.01, 0.05), falls(0.3, 0.1, 0.1)) == [-1, -1, -1]


def test_what_goes_around_the_rim_or_beside_it_has_not_passed() -> None:
    around = [(0.9, 0.5, 0.15), (1.2, 0.5, 0.0), (0.9, 0.5, -0.15)]
    beside = [(1.05, 0.5, 0.1), (1.05, 0.5, -0.1), (1.05, 0.5, -0.3)]
    assert passed(around, beside) == [-1, -1]


def test_a_sheet_that_is_drawn_through_particles_is_told_and_one_that_carries_them_is_not() -> None:
    assert passed(falls(0.1, 0.1), lifts=[0.0, 0.5]) == [1]
    assert passed(falls(0.1, 0.6), lifts=[0.0, 0.5]) == [-1]


def test_particles_slide_over_a_fold_without_passing_it() -> None:
    """Over the ridge of a roof, on which each plane goes through the other side's space."""
    vertices, faces = grid()
    roof = vertices - np.array([0.0, 0.0, 1.0]) * np.abs(vertices[:, :1] - 0.5) * 1.5
    outward = np.array([1.5, 0.0, 1.0]) / np.hypot(1.5, 1.0)
    left, right = np.array([0.4, 0.45, -0.15]) + outward * [-0.06, 0, 0.06], np.array([0.6, 0.45, -0.15]) + outward * 0.06
    sides = SheetSides(faces)
    rows, _ = sides.see(np.zeros(1, dtype=int), (roof, roof), (left[None], right[None]), np.array([RADIUS]))
    assert len(rows) == 0

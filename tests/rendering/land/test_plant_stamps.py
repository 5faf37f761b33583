"""Silhouettes of plants in previews: what tells a conifer from a broad tree, and which plant covers which."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering.land.plant_stamps import FINE, PITCHES, Stamp, Stand, _steps, draw_plants, stamp_of

SHAPES = ("broad", "bush", "column", "cone", "palm", "rock", "tuft")


def _width(stamp: Stamp, low: float, high: float, tall: int, *, bark: bool = False) -> int:
    """Most pixels side by side between two shares of the height."""
    up = -stamp.down
    own = (up >= low * tall) & (up < high * tall) & (stamp.bark == bark)
    return max((int((own & (stamp.down == row)).sum()) for row in np.unique(stamp.down[own])), default=0)


def test_a_conifer_tapers_to_its_tip_and_a_broad_tree_stands_on_a_trunk() -> None:
    cone, broad = (stamp_of(shape, 60, 0, 0) for shape in ("cone", "broad"))
    assert _width(cone, 0.15, 0.3, 60) > 1.5 * _width(cone, 0.5, 0.6, 60) > 2 * _width(cone, 0.85, 0.95, 60) > 0
    assert _width(broad, 0.55, 0.8, 60) > 25
    assert _width(broad, 0.0, 0.2, 60) == 0
    assert 1 <= _width(broad, 0.0, 0.2, 60, bark=True) <= 5
    assert _width(cone, 0.0, 0.09, 60, bark=True) >= 1


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("tall", [1, 2, 5, FINE, 40])
@pytest.mark.parametrize("pitch", [0, PITCHES - 1])
def test_a_stamp_stands_on_its_foot_and_is_about_as_high_as_the_plant(shape: str, tall: int, pitch: int) -> None:
    stamp = stamp_of(shape, tall, pitch, 0)
    assert len(stamp.right) >= 1
    assert len(set(zip(stamp.right.tolist(), stamp.down.tolist(), strict=True))) == len(stamp.right)
    assert np.ptp(stamp.down) <= 1.6 * tall + 2
    assert ((stamp.light >= 0.35) & (stamp.light <= 1.5)).all()
    if pitch == 0 and tall == 40 and shape not in ("rock", "bush"):
        assert 0.7 * tall < -stamp.down.min() < 1.2 * tall


def test_crowns_are_round_from_above() -> None:
    for shape in ("broad", "cone"):
        stamp = stamp_of(shape, 60, PITCHES - 1, 0)
        leaf = ~stamp.bark
        assert np.ptp(stamp.right[leaf]) == pytest.approx(np.ptp(stamp.down[leaf]), rel=0.35)


def test_heights_of_stamps_are_exact_when_small_and_near_when_large() -> None:
    assert _steps(np.array([0.2, 1.0, 5.4, 11.6])).tolist() == [1, 1, 5, 12]
    tall = np.geomspace(13, 480, 200)
    assert np.abs(_steps(tall) / tall - 1).max() < 0.06


def _stand(*feet: tuple[float, float, float], color: tuple[tuple[float, float, float], ...]) -> Stand:
    return Stand(np.array(feet), np.full(len(feet), 10.0), ("broad",), np.zeros(len(feet), dtype=np.int64), np.array(color))


def test_near_plants_cover_far_ones_and_what_is_nearer_covers_plants() -> None:
    camera = Camera(np.array([0.0, -40, 5]), np.array([0.0, 0, 5]), 40, 80, 60)
    picture, depth = np.zeros((60, 80, 3)), np.full((60, 80), np.inf)
    red, blue = (1.0, 0, 0), (0, 0, 1.0)
    draw_plants(picture, depth, _stand((0, 0, 0), (0, 30, 0), color=(red, blue)), camera, 1.0)
    middle = picture[24:28, 38:42].reshape(-1, 3)
    assert (middle[:, 0] > 0.3).all()
    assert (middle[:, 2] == 0).all(), "the red one stands in front"
    hidden = np.zeros((60, 80, 3))
    draw_plants(hidden, np.full((60, 80), 20.0), _stand((0, 0, 0), color=(red,)), camera, 1.0)
    assert not hidden.any(), "something 20 m away hides all"
    behind = np.zeros((60, 80, 3))
    draw_plants(behind, depth, _stand((0, -80, 0), (500, 0, 0), color=(red, red)), camera, 1.0)
    assert not behind.any(), "behind the eye, and beside the picture"

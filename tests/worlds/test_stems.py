"""Trunks and boulders of a landscape: where they stand, how thick they are, and the solids in their place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from worldagent.rendering.land.plants import form_of
from worldagent.testing.defects._lands import NAME, axes, declared, keep
from worldagent.worlds.landscape import SavedLandscape, landscape_path
from worldagent.worlds.stems import FORMS, Stems, pieces_of, stems_of

PLANTS = [
    (0.0, 0.0, 20.0, "broad"),
    (6.0, 2.0, 10.0, "cone"),
    (-6.0, 4.0, 2.0, "rock"),
    (3.0, -5.0, 1.5, "bush"),
    (8.0, 8.0, 0.1, "rock"),
]


@pytest.fixture
def stems(tmp_path: Path) -> Stems:
    terrain = declared(21, 21, 1.0)
    x, _ = axes(21, 21, 1.0)
    keep(tmp_path, terrain, 0.5 * x, plants=PLANTS)
    return stems_of(SavedLandscape(next((tmp_path / "terrain").iterdir())))


def test_trees_and_boulders_are_solid_and_shrubs_and_pebbles_are_not(stems: Stems) -> None:
    assert sorted(stems.plant.tolist()) == [0, 1, 2]
    assert stems.rock.tolist() == [False, False, True]
    assert stems.radius == pytest.approx([0.56, 0.2, 1.5])
    assert stems.foot[:, 2] == pytest.approx(0.5 * stems.foot[:, 0])


def test_a_rectangle_gives_what_reaches_into_it(stems: Stems) -> None:
    assert stems.inside(np.array([0.5, -1.0]), np.array([3.0, 1.0])).plant.tolist() == [0]
    assert stems.inside(np.array([0.6, -1.0]), np.array([3.0, 1.0])).plant.tolist() == []


def test_a_landscape_without_plants_has_none(tmp_path: Path) -> None:
    from worldagent.worlds.landscape import save_landscape

    path = landscape_path(tmp_path, NAME, "0" * 16)
    save_landscape(path, {"height": np.zeros((3, 3))}, {"rows": 3, "cols": 3, "cell": 1.0})
    assert len(stems_of(SavedLandscape(path)).radius) == 0


def test_pieces_stand_where_the_stems_are(stems: Stems) -> None:
    trunk, _, rock = pieces_of(stems, sink=0.3)
    assert trunk.kind == "cylinder"
    assert trunk.params == pytest.approx((0.56, 0.5 * (8.0 + 0.3)))
    assert trunk.pose.position[2] - trunk.params[1] == pytest.approx(-0.3)
    assert trunk.pose.position[2] + trunk.params[1] == pytest.approx(8.0)
    placed = rock.pose.apply(rock.points)
    assert len(ConvexHull(placed).vertices) == len(rock.points)
    assert placed[:, 2].max() == pytest.approx(-3.0 + 1.9)
    assert np.ptp(placed[:, 0]) == pytest.approx(3.0)


@pytest.mark.parametrize("shape", ["broad", "cone", "palm", "column"])
def test_a_trunk_is_as_thick_as_it_is_drawn(shape: str) -> None:
    form = form_of(shape, detail=1, seed=0)
    foot = form.vertices[np.abs(form.vertices[:, 2]) < 0.01]
    drawn = float(np.hypot(*foot[:, :2].T).max())
    assert 0.5 * FORMS[shape].radius <= drawn or shape == "palm"
    assert drawn <= FORMS[shape].radius * 1.05

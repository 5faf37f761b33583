"""Corners of a sheet that can tear are joined where they lie at one place, and some meshes cannot tear."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.worlds.categories.cloth.facts import sheet_grid
from worldagent.worlds.categories.cloth.tears import corners_of, following, seams_of, welded
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Sheet


def test_a_whole_sheet_has_its_vertices_and_every_inner_side_a_mate() -> None:
    points, faces = sheet_grid(Sheet(size=(0.4, 0.3), resolution=0.1))
    corners, own = corners_of(points, faces)
    seams = seams_of(corners)
    assert own.shape == faces.shape
    label = welded(seams, np.zeros(len(corners), dtype=bool))
    assert int(label.max()) + 1 == len(points)
    assert np.array_equal(label, seams.kin)
    inner = np.flatnonzero(seams.mate >= 0).astype(np.int32)
    assert np.array_equal(seams.mate[seams.mate[inner]], inner)
    assert np.array_equal(seams.kin[seams.mate[inner]], seams.kin[following(inner)])
    rim = len(corners) - len(inner)
    assert rim == 2 * (4 + 3)


def test_sides_open_from_rim_to_rim_part_a_sheet_and_one_alone_does_not() -> None:
    """A point alone holds nothing: an open edge parts its end at the rim; two at an inner vertex part that."""
    points, faces = sheet_grid(Sheet(size=(0.4, 0.2), resolution=0.1))
    seams = seams_of(corners_of(points, faces)[0])
    rest = points[faces].reshape(-1, 3)
    side = np.arange(len(rest), dtype=np.int32)
    across = (np.abs(rest[:, 0]) < 1e-9) & (np.abs(rest[following(side), 0]) < 1e-9) & (seams.mate >= 0)
    for count, more in ((2, 1), (4, 3)):
        opened = np.zeros(len(rest), dtype=bool)
        opened[np.flatnonzero(across)[np.argsort(rest[across, 1] + rest[following(side)[across], 1], kind="stable")[:count]]] = (
            True
        )
        assert int(welded(seams, opened).max()) + 1 == len(points) + more


@pytest.mark.parametrize(
    ("faces", "said"),
    [
        ([[0, 1, 2], [0, 1, 3], [1, 0, 4]], "three triangles, or triangles that face different ways"),
        ([[0, 1, 2], [0, 1, 3]], "face different ways"),
        ([[0, 1, 2], [0, 3, 4]], "meet in a point alone"),
    ],
)
def test_meshes_that_cannot_tear_are_told(faces: list[list[int]], said: str) -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [-1, -1, 1]], dtype=np.float64)
    with pytest.raises(InputError, match=said):
        seams_of(points[np.array(faces)].reshape(-1, 3))

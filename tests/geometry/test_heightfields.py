"""Height fields as closed solids: watertight, of the right volume, and known as what cannot cross itself."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from worldagent.geometry import Solid, ground_solid, is_height_field, self_crossings
from worldagent.worlds.arrays import F64
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.errors import InputError

SIZE = (12.0, 7.0)


def _hills(rows: int, cols: int, seed: int = 0) -> F64:
    return np.random.default_rng(seed).uniform(-2.0, 3.0, (rows, cols))


def _solid(mesh: TriangleMesh) -> Solid:
    return Solid.from_mesh(mesh, closed=True)


def _integral(heights: F64, size: tuple[float, float], floor: float) -> float:
    """Volume under the two triangles of each cell: half a cell times the mean of three corners."""
    half = 0.5 * size[0] * size[1] / ((heights.shape[0] - 1) * (heights.shape[1] - 1))
    a, b, d, e = heights[:-1, :-1], heights[:-1, 1:], heights[1:, :-1], heights[1:, 1:]
    return float((half * ((a + b + e) + (a + e + d)) / 3.0 - 2.0 * half * floor).sum())


@pytest.mark.parametrize("shape", [(2, 2), (2, 9), (9, 2), (3, 3), (17, 30)])
def test_the_ground_is_watertight_and_holds_the_integral_of_its_heights(shape: tuple[int, int]) -> None:
    heights = _hills(*shape)
    mesh = ground_solid(heights, SIZE, 0.7)
    judged = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert judged.is_watertight
    assert judged.is_winding_consistent
    assert judged.euler_number == 2
    assert judged.volume == pytest.approx(_integral(heights, SIZE, heights.min() - 0.7), rel=1e-12)
    assert np.allclose(judged.extents, [*SIZE, np.ptp(heights) + 0.7])
    assert np.array_equal(mesh.vertices[: heights.size, 2], heights.ravel())


def test_a_ground_of_a_quarter_million_cells_is_known_as_a_height_field() -> None:
    assert is_height_field(_solid(ground_solid(_hills(513, 513), SIZE, 0.1)))


def test_the_proof_agrees_with_the_search_for_crossings() -> None:
    solid = _solid(ground_solid(_hills(12, 14), SIZE, 0.5))
    assert is_height_field(solid)
    assert len(self_crossings(solid, noise=1e-9).pairs) == 0


def _changed(mesh: TriangleMesh, vertex: int, to: tuple[float, float, float]) -> TriangleMesh:
    vertices = mesh.vertices.copy()
    vertices[vertex] = to
    return TriangleMesh(vertices, mesh.faces)


def _broken() -> dict[str, TriangleMesh]:
    mesh = ground_solid(_hills(8, 8), SIZE, 0.5)
    middle, corner = 3 * 8 + 3, 0
    deep = float(mesh.vertices[:, 2].min())
    return {
        "a fold": _changed(mesh, middle, (5.9, 3.4, 1.0)),
        "a spike through the base": _changed(mesh, middle, (*mesh.vertices[middle, :2], deep - 1.0)),
        "a corner drawn out": _changed(mesh, corner, (-8.0, -3.5, 1.0)),
        "a hole": TriangleMesh(mesh.vertices, np.delete(mesh.faces, 40, axis=0)),
        "inside out": TriangleMesh(mesh.vertices, mesh.faces[:, ::-1]),
        "a base that is not level": _changed(mesh, len(mesh.vertices) - 1, (*mesh.vertices[-1, :2], deep - 0.1)),
        "a base pulled aside": _changed(mesh, len(mesh.vertices) - 1, (9.0, 0.0, deep)),
    }


@pytest.mark.parametrize("kind", _broken())
def test_what_could_cross_itself_is_not_taken_for_a_height_field(kind: str) -> None:
    assert not is_height_field(_solid(_broken()[kind]))


def test_a_ball_and_two_stacked_boxes_are_no_height_field() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    boxes = trimesh.util.concatenate(
        [trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1)).apply_translation((0, 0, 2))]
    )
    for made in (ball, boxes):
        assert not is_height_field(_solid(TriangleMesh(np.array(made.vertices), np.array(made.faces, dtype=np.int32))))


@pytest.mark.parametrize(
    ("heights", "size", "base", "told"),
    [
        (np.zeros((1, 5)), SIZE, 1.0, "at least 2 x 2"),
        (np.zeros((3, 3)), (0.0, 1.0), 1.0, "must be > 0"),
        (np.zeros((3, 3)), SIZE, 0.0, "must be > 0"),
        (np.array([[0.0, 1.0], [np.nan, 2.0]]), SIZE, 1.0, "row 1, column 0"),
    ],
)
def test_bad_heights_are_refused_by_name(heights: F64, size: tuple[float, float], base: float, told: str) -> None:
    with pytest.raises(InputError, match=told):
        ground_solid(heights, size, base)

"""Unions of convex solids are told from surfaces of which one lobe is turned inside out."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry import Solid, is_convex_union
from worldagent.worlds.built import TriangleMesh

CORNERS = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
                  (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])  # fmt: skip


def _cubes(*shifts: float, turned: bool = False, dent: float = 0.0) -> Solid:
    corners = [CORNERS + np.array([s, 0.3 * s, 0.1 * s]) for s in shifts]
    corners[-1][7] -= dent
    faces = [FACES + 8 * k for k in range(len(shifts))]
    if turned:
        faces[-1] = faces[-1][:, ::-1]
    return Solid.from_mesh(TriangleMesh(np.concatenate(corners), np.concatenate(faces).astype(np.int32)), closed=True)


@pytest.mark.parametrize("shift", [3.0, 0.5])
def test_convex_pieces_are_one_however_they_overlap(shift: float) -> None:
    assert is_convex_union(_cubes(0.0, shift))


def test_one_piece_dents_and_lobes_inside_out_are_none() -> None:
    assert not is_convex_union(_cubes(0.0)), "one piece is simply convex"
    assert not is_convex_union(_cubes(0.0, 0.5, dent=0.6))
    assert not is_convex_union(_cubes(0.0, 3.0, 0.5, turned=True))

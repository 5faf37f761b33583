"""The fastest point of solids that cloth meets: the very number, and no work for those at rest."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.cloth.pace import fastest_point
from worldagent.tests.physics.test_flip import box_mesh

SIZE = (0.4, 0.2, 0.6)


class _Turns:
    """Rotations of bodies that note for which of them they are asked."""

    def __init__(self, count: int) -> None:
        self.asked: list[int] = []
        self._turns = np.tile(np.eye(3), (count, 1, 1))

    def __getitem__(self, row: int) -> Any:
        self.asked.append(int(row))
        return self._turns[row]


def _bodies(velocity: Any, spin: Any) -> Any:
    zero = np.zeros((len(velocity), 3))
    return SimpleNamespace(
        position=zero, center=zero, velocity=np.array(velocity), angular_velocity=np.array(spin), rotation=_Turns(len(velocity))
    )


def _solids(motions: list[str]) -> tuple[list[Boundary], Any, Any]:
    mesh = box_mesh(SIZE)
    made = [Boundary(f"b{k}/body", mesh, cast("Any", m)) for k, m in enumerate(motions)]
    rows = np.repeat(np.arange(len(made)), len(mesh.vertices))
    return made, np.concatenate([mesh.vertices] * len(made)), rows


def test_pieces_that_rest_are_not_looked_at() -> None:
    made, place, row = _solids(["static", "dynamic", "dynamic", "dynamic"])
    bodies = _bodies([[9, 0, 0], [0, 0, 0], [3, 4, 0], [0, 0, 0]], [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 2]])
    assert fastest_point(made, place, row, bodies) == 5.0
    assert bodies.rotation.asked == [2, 3]


def test_a_spinning_body_is_as_fast_as_its_farthest_corner() -> None:
    made, place, row = _solids(["dynamic", "kinematic"])
    bodies = _bodies([[0, 0, 0], [0, 1, 0]], [[0, 0, 10], [0, 0, 0]])
    assert fastest_point(made, place, row, bodies) == pytest.approx(10 * np.linalg.norm(SIZE) / 2, rel=1e-12)


def test_nothing_that_moves_has_no_speed() -> None:
    made, place, row = _solids(["static"])
    assert fastest_point(made, place, row, _bodies([[1, 0, 0]], [[0, 0, 1]])) == 0.0

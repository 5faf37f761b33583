"""On uneven ground the speed that a ball keeps of a hit is not told from the turn of facets under it; on even ground it is judged as ever."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import ball, box, entity, make_candidate, world
from worldagent.verifiers.categories.rigid.bounces import _even
from worldagent.verifiers.land.uneven import even_ground
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import HeightField

BEND = 0.05
"""Rise over run of the eastern half [m/m]."""


@pytest.fixture(scope="module")
def candidate(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    folder: Path = tmp_path_factory.mktemp("w")
    x = np.linspace(-4, 4, 9)
    heights = np.tile(BEND * np.maximum(x, 0), (9, 1)).tolist()
    land = entity(HeightField(size=(8.0, 8.0), heights=heights), size=(8, 8, 1), at=(10, 0, 0))
    return make_candidate(folder, world({"land": land, "slab": box(2, 2, 1, at=(0, 0, -0.5)), "ball": ball(0.1, at=(0, 0, 1))}))


@pytest.mark.parametrize(
    ("entity_id", "point", "way", "even"),
    [
        ("slab", (0, 0, 0), (3, 0, 0), True),
        ("land", (7.2, 0.3, 0), (0.5, 0, 0), True),
        ("land", (12.2, 0.3, 0.1), (0.5, 0.3, 0), True),
        ("land", (9.7, 0.3, 0), (0.6, 0, 0), False),
        ("land", (10.3, 0.3, 0), (-0.6, 0.1, 0), False),
    ],
)
def test_ground_is_even_where_its_facets_do_not_turn_along_the_way(
    candidate: Candidate, entity_id: str, point: tuple[float, ...], way: tuple[float, ...], even: bool
) -> None:
    assert even_ground(candidate, entity_id, np.array(point), np.array(way), most=0.5 * BEND) is even
    assert even_ground(candidate, entity_id, np.array(point), np.array(way), most=1.1 * BEND)


@pytest.mark.parametrize(
    ("other", "speed", "rest", "told"),
    [
        ("slab", 12.0, 0.02, True),
        ("land", 0.5, 0.02, True),
        ("land", 12.0, 0.0, False),
        ("land", 3.0, 0.3, False),
    ],
)
def test_a_hit_on_facets_is_told_only_where_neither_a_step_nor_the_way_turns_the_normal(
    candidate: Candidate, other: str, speed: float, rest: float, told: bool
) -> None:
    """A grazing hit at 12 m/s: in a step of 1 ms the ball of 10 cm goes on by 12 mm, which turns the normal by 0.12."""
    spec = candidate.spec
    assert spec.entities[other].motion == "static"
    books = SimpleNamespace(candidate=candidate, step=1e-3)
    point = np.array([9.3, 0.3, 0.0]) if other == "land" else np.zeros(3)
    velocity, up = np.array([speed, 0.0, -1.0]), np.array([0.0, 0.0, 1.0])
    assert _even(books, "ball", other, point, velocity, up, rest, 1.0) is told  # type: ignore[arg-type]

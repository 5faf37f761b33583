"""Answers that are worked out for all pairs of a large world at once are those of each pair alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import entity, make_candidate, pose, world
from worldagent.verifiers.scene import surfaces as surfaces_module
from worldagent.verifiers.scene.surfaces import Surfaces
from worldagent.verifiers.support import joined, one_piece
from worldagent.worlds.spec import Box, Entity, Part

from .test_shifted import channel, scene


def test_gaps_measured_together_are_those_of_each_pair_to_the_last_bit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Law: the same queries, whatever else is asked about; rows tell the points."""
    alone = scene(tmp_path, 3)
    expected = {pair: alone.gap(*pair, 0) for pair in alone.first}
    assert not alone._measured
    monkeypatch.setattr(surfaces_module, "MANY_PARTS", 1)
    together = Surfaces(alone.candidate)
    assert together.first.keys() == alone.first.keys()
    for pair, gap in expected.items():
        found = together.gap(*pair, 0)
        assert (found.distance, found.part_a, found.part_b) == (gap.distance, gap.part_a, gap.part_b)
        np.testing.assert_array_equal([found.point_a, found.point_b], [gap.point_a, gap.point_b])
    assert together._measured  # the channel is not convex


def _frame() -> Entity:
    """Four bars that touch in a ring, and one beside them that touches none."""
    flat, tall = Box(size=(1.0, 0.1, 0.1)), Box(size=(0.1, 0.1, 0.8))
    bars = [(flat, (0, 0, 0.05)), (flat, (0, 0, 0.95)), (tall, (-0.45, 0, 0.5)), (tall, (0.45, 0, 0.5)), (tall, (2, 0, 0.5))]
    return entity(*(Part(shape=shape, pose=pose(at)) for shape, at in bars), motion="dynamic")


def test_parts_that_hang_together_are_not_compared_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Own choice: the pieces of a thing are the same; what costs a search is asked of parts of different pieces alone."""
    surfaces = Surfaces(make_candidate(tmp_path, world({"frame": _frame()})))
    asked: list[tuple[int, int]] = []
    compare = one_piece._apart
    monkeypatch.setattr(one_piece, "_apart", lambda s, i, j, gap: asked.append((i, j)) or compare(s, i, j, gap))
    parts = surfaces.parts_of["frame"]
    touching = list(one_piece.own_touches(surfaces, parts))
    assert len(touching) == 4
    surfaces.candidate._memory.clear()
    asked.clear()
    pieces = one_piece._pieces(surfaces, parts)
    assert [len(p) for p in pieces] == [4, 1]
    assert len(asked) == 3


def test_a_hinge_is_served_at_the_same_place_by_compiled_distances(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Law: the same distances to the last bit, so that the same halves are searched and the same place is found."""
    things = {"door": entity(channel(), motion="dynamic"), "post": entity(Part(shape=Box(size=(0.1, 0.1, 2.0))), motion="static")}
    things["post"] = things["post"].model_copy(update={"pose": pose((0.6, 0.1, 0.3))})
    surfaces = Surfaces(make_candidate(tmp_path, world(things)))
    rng, places = np.random.default_rng(2), []
    for many in (10**9, 1):
        monkeypatch.setattr(joined, "MANY_PARTS", many)
        rng = np.random.default_rng(2)
        anchors, axes = rng.uniform(-1.0, 1.0, (12, 3)), rng.normal(size=(12, 3))
        places.append(
            [joined.on_axis(surfaces, ("door", "post"), at, axis, 0.02) for at, axis in zip(anchors, axes, strict=True)]
        )
    np.testing.assert_array_equal(places[0], places[1])

"""Contacts by compiled loops: those of numpy, point by point."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import entity, ground, make_candidate, pose, world
from worldagent.verifiers.scene.surfaces import Surfaces
from worldagent.verifiers.support import touching
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import Box, Cylinder, Part, Wedge


def pile(tmp_path: Path, seed: int) -> Candidate:
    """Things of every kind that stand on each other, turned: faces, edges and corners that touch."""
    rng = np.random.default_rng(seed)
    things, height = {"ground": ground()}, 0.0
    for k in range(8):
        size = tuple(rng.uniform(0.1, 0.4, 3))
        shape = (Box(size=size), Cylinder(radius=0.1, height=size[2]), Wedge(size=size))[k % 3]
        turn = float(rng.uniform(0.0, 3.0))
        made = entity(Part(shape=shape, pose=pose((0.0, 0.0, 0.5 * size[2]))), motion="dynamic")
        spot = (*rng.uniform(-0.05, 0.05, 2), height + float(rng.choice([0.0, 2e-4])))
        things[f"thing{k}"] = made.model_copy(update={"pose": pose(spot, euler=(0.0, 0.0, turn))})
        height += size[2]
    return make_candidate(tmp_path, world(things))


@pytest.mark.parametrize("seed", range(4))
def test_compiled_contacts_are_those_of_numpy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Law: the same points with the same normals, in the same order."""
    candidate = pile(tmp_path, seed)
    slow, fast = Surfaces(candidate), Surfaces(candidate)
    expected = {pair: touching.contacts_of(slow, *pair, 0) for pair in slow.first}
    monkeypatch.setattr(touching, "MANY_PARTS", 1)
    assert max(len(c.points) for c in expected.values()) > 3
    for pair, wanted in expected.items():
        found = touching.contacts_of(fast, *pair, 0)
        assert found.points.shape == wanted.points.shape
        assert np.abs(found.points - wanted.points).max(initial=0.0) < 1e-12
        assert np.abs(found.normals - wanted.normals).max(initial=0.0) < 1e-12
        assert np.array_equal(found.friction, wanted.friction)


def test_a_corner_on_an_edge_is_pushed_across_both(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Limit case: two crossed prisms touch with their edges alone; the normal is the cross product of those."""
    monkeypatch.setattr(touching, "MANY_PARTS", 1)
    half = 0.1 * np.sqrt(2.0)
    bar = entity(Part(shape=Box(size=(1.0, 0.2, 0.2))), motion="dynamic")
    low = bar.model_copy(update={"pose": pose((0.0, 0.0, half), euler=(np.pi / 4, 0.0, 0.0))})
    other = entity(Part(shape=Box(size=(0.2, 1.0, 0.2))), motion="dynamic")
    high = other.model_copy(update={"pose": pose((0.0, 0.0, 3.0 * half), euler=(0.0, np.pi / 4, 0.0))})
    surfaces = Surfaces(make_candidate(tmp_path, world({"low": low, "high": high})))
    found = touching.contacts_of(surfaces, "high", "low", 0)
    assert len(found.points) == 1
    assert found.points[0] == pytest.approx([0.0, 0.0, 2.0 * half], abs=1e-9)
    assert found.normals[0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)

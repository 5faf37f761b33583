"""Bounds after a small move settle what a measurement would, and nothing else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import entity, ground, make_candidate, pose, world
from worldagent.verifiers.scene import surfaces as surfaces_module
from worldagent.verifiers.scene.shifted import Shifted
from worldagent.verifiers.scene.surfaces import Surfaces
from worldagent.worlds.spec import Box, Mesh, Part

RIM = ((-0.3, 0.0), (0.3, 0.0), (0.3, 0.4), (0.2, 0.4), (0.2, 0.1), (-0.2, 0.1), (-0.2, 0.4), (-0.3, 0.4))
CAP = ((0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (0, 5, 6), (0, 6, 7))


def channel() -> Part:
    """An upright channel, open along y."""
    around = [(k, (k + 1) % 8) for k in range(8)]
    sides = [face for k, n in around for face in ((k, n, n + 8), (k, n + 8, k + 8))]
    faces = [*((c, b, a) for a, b, c in CAP), *((a + 8, b + 8, c + 8) for a, b, c in CAP), *sides]
    vertices = [(x, y, z) for z in (0.0, 0.8) for x, y in RIM]
    return Part(shape=Mesh(vertices=tuple(vertices), faces=tuple(faces)), pose=pose((0, 0, 0.001)))


def scene(tmp_path: Path, seed: int) -> Surfaces:
    """Boxes within a channel, on it, beside it and on the ground, at gaps about the contact tolerance."""
    rng = np.random.default_rng(seed)
    things = {"ground": ground(), "channel": entity(channel(), motion="static")}
    for k in range(12):
        made = entity(Part(shape=Box(size=tuple(rng.uniform(0.05, 0.15, 3)))), motion="dynamic")
        at = rng.uniform((-0.4, -0.1, 0.0), (0.4, 0.5, 0.9))
        things[f"b{k}"] = made.model_copy(update={"pose": pose(tuple(map(float, at)))})
    surfaces = Surfaces(make_candidate(tmp_path, world(things)))
    assert surfaces.first
    return surfaces


@pytest.mark.parametrize("seed", range(6))
def test_every_pair_that_bounds_settle_is_on_the_side_that_is_measured(tmp_path: Path, seed: int) -> None:
    """Law: a bound beyond what is compared says as much as the clearance."""
    surfaces, rng = scene(tmp_path, seed), np.random.default_rng(seed)
    settled = 0
    for a, b in [*surfaces.first, *(p[::-1] for p in surfaces.first)]:
        surfaces.gap(b, a, 0)
        for _ in range(4):
            offset = rng.normal(size=3) * 0.003
            bound = surfaces.gap(b, a, 0).distance + float(rng.uniform(-0.003, 0.003))
            found = surfaces._settled({(a, b): surfaces._near_parts(a, b)}, {(a, b): np.array([bound])}, offset)
            moved = surfaces.gap(b, a, 0, offset=offset).distance
            for value in found.known.values():
                settled += 1
                assert (value >= bound) == (moved >= bound)
    assert settled > 0


@pytest.mark.parametrize("seed", range(4))
def test_who_carries_whom_is_the_same_without_bounds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Law: bounds spare measurements and change no verdict."""
    knowing = scene(tmp_path, seed)
    for pair in knowing.first:
        knowing.gap(*pair, 0)
    asked = [way for a, b in knowing.first for way in ((a, b), (b, a))]
    answers = {way: bool(knowing.carries(*way, until=1)[0]) for way in asked}
    monkeypatch.setattr(surfaces_module, "shifted", lambda _, start, parts, bound, offset: Shifted({}, dict(parts)))
    measuring = Surfaces(knowing.candidate)
    assert measuring.first.keys() == knowing.first.keys()
    assert {way: bool(measuring.carries(*way, until=1)[0]) for way in asked} == answers

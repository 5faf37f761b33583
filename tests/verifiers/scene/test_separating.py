"""Moves that are suggested for an overlap: no longer than overlap and skins ask, into no other overlap, and of the whole thing."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.testing.defects._rooms import GAP, Room
from worldagent.testing.worlds.small_worlds import box, entity, ground, make_candidate, pose, world
from worldagent.verifiers.scene import interpenetration
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.requirements import Correction, Row
from worldagent.worlds.spec import Box, Cylinder, Part, WorldSpec

SKIN = 5e-4
ROOM = 2 * SKIN + 2e-4
"""Two skins, and the room that a suggestion leaves for rounding [m]."""


def judged(folder: Path, spec: WorldSpec) -> dict[str, Row]:
    folder.mkdir(exist_ok=True)
    built = {name: build_entity(spec, name, folder) for name in spec.entities}
    return {r.id: r for r in interpenetration.check(Candidate(folder, spec, built, "static"))}


def moves(row: Row) -> list[Correction]:
    return [c for c in row.corrections if c.group == "placement"]


def way(spec: WorldSpec, correction: Correction, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    after = apply_patch(spec, correction.patch)
    return np.array(after.entities[name].pose.position) - np.array(spec.entities[name].pose.position)


def tin(at: tuple[float, float, float]) -> Any:
    return entity(Cylinder(radius=0.05, height=0.12), motion="dynamic", at=at)


OVERLAPS = {
    "in the wall behind it, on a shelf": ((0.0, 0.052, 0.5611), "wall", 0.002),
    "in the shelf under it": ((0.0, 0.0, 0.557), "shelf", 0.003),
    "in the shelf, and touching the wall": ((0.0, 0.05, 0.557), "shelf", 0.003),
    "in the wall by a hair": ((0.0, 0.0501, 0.5611), "wall", 1e-4),
}


def pantry(at: tuple[float, float, float]) -> WorldSpec:
    """A wall whose face is y = 0.1 m, a shelf whose top is z = 0.5 m, and a tin."""
    things = {
        "floor": ground(),
        "wall": box(3.0, 0.1, 2.4, at=(0, 0.15, 1.2)),
        "shelf": box(1.0, 0.3, 0.03, at=(0, -0.05, 0.485)),
        "tin": tin(at),
    }
    return world(things)


@pytest.mark.parametrize("case", OVERLAPS)
def test_the_first_move_is_the_overlap_and_both_skins_and_the_others_are_not_far(tmp_path: Path, case: str) -> None:
    (x, y, z), other, depth = OVERLAPS[case]
    spec = pantry((x, y, z))
    row = judged(tmp_path / "a", spec)[f"interpenetration:{other}:tin"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(-depth, abs=2e-5)
    found = moves(row)
    first = way(spec, found[0], "tin")
    assert depth < np.linalg.norm(first) <= depth + ROOM + 1e-9
    for correction in found:
        assert np.linalg.norm(way(spec, correction, "tin")) <= 8.0 * (depth + ROOM)
        after = judged(tmp_path / "b", apply_patch(spec, correction.patch))
        assert [i for i, r in after.items() if r.status == "fail"] == []


def test_a_ring_that_is_sunk_by_more_than_its_wall_is_lifted_by_all_of_it(tmp_path: Path) -> None:
    """A hollow tub of boards 3 mm thick stands 20 mm deep in the floor: the depth of a board is not the way out."""
    boards = [Part(shape=Box(size=(0.003, 0.2, 0.2)), pose=pose((s * 0.1, 0, 0))) for s in (-1, 1)]
    boards += [Part(shape=Box(size=(0.19, 0.003, 0.2)), pose=pose((0, s * 0.095, 0))) for s in (-1, 1)]
    spec = world({"floor": ground(), "tub": entity(*boards, motion="dynamic", at=(0, 0, 0.08))})
    row = judged(tmp_path / "a", spec)["interpenetration:floor:tub"]
    first = way(spec, moves(row)[0], "tub")
    assert first[2] == pytest.approx(0.02, abs=ROOM)
    assert judged(tmp_path / "b", apply_patch(spec, moves(row)[0].patch))["interpenetration:scene"].status == "pass"


def doorway(*, gap: float) -> WorldSpec:
    """A frame in an opening of a wall that leaves it a gap on each side [m], whose cap reaches 12 mm into the wall behind."""
    parts = [
        Part(shape=Box(size=(0.04, 0.12, 2.0)), pose=pose((s * 0.48, 0, 1.0))) for s in (-1, 1)
    ] + [Part(shape=Box(size=(0.04, 0.024, 0.1)), pose=pose((0.52, 0.072, 1.9)))]  # fmt: skip
    wall = [
        Part(shape=Box(size=(1.0, 0.12, 2.4)), pose=pose((s * (1.0 + gap), 0, 1.2))) for s in (-1, 1)
    ] + [Part(shape=Box(size=(0.1, 1.0, 2.4)), pose=pose((0.578, 0.56, 1.2)))]  # fmt: skip
    return world({"floor": ground(), "wall": entity(*wall), "frame": entity(*parts, at=(0, 0, 1e-4))})


def test_what_stands_in_an_opening_is_told_that_the_opening_goes_along(tmp_path: Path) -> None:
    row = judged(tmp_path, doorway(gap=5e-5))["interpenetration:wall:frame"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(-0.012, abs=1e-4)
    first = moves(row)[0]
    assert "stands in its least way out" in first.cause
    assert "by 12.1 mm" in first.action
    assert first.patch == ()
    assert "/entities/wall/parts/p0" in first.pointers


def test_the_whole_of_a_generated_thing_moves_with_its_hinges(tmp_path: Path) -> None:
    found = Room(np.random.default_rng(0), 0.0, np.zeros(3))
    found.blocks("floor", "floor", {"slab": ((-4.0, -4.0, -0.2), (4.0, 4.0, 0.0))}, material="concrete_c30")
    found.put("wardrobe", "wardrobe", (0.0, 0.0, GAP))
    back = 0.5 * found.documents["wardrobe"]["dimensions"]["size"][1] - 0.003
    found.blocks("wall", "wall", {"slab": ((-3.0, back, 0.0), (3.0, back + 0.2, 2.6))}, material="concrete_c30")
    candidate = found.world(tmp_path / "a").candidate
    rows = {r.id: r for r in interpenetration.check(candidate)}
    (row,) = [
        r for i, r in rows.items() if r.status == "fail" and not i.endswith(":scene") and {"wall", "wardrobe"} <= set(r.entities)
    ]
    first = moves(row)[0]
    after = apply_patch(candidate.spec, first.patch)
    shift = way(candidate.spec, first, "wardrobe")
    bodies = candidate.spec.entities["wardrobe"].asset
    assert bodies is not None
    assert bodies.bodies
    for name in bodies.bodies:
        assert way(candidate.spec, first, name) == pytest.approx(shift, abs=1e-8)
    for key, joint in candidate.spec.simulation.joints.items():
        moved = np.array(after.simulation.joints[key].anchor) - np.array(joint.anchor)  # type: ignore[union-attr]
        assert moved == pytest.approx(shift, abs=1e-8)
    assert "All of it goes along" in first.action
    assert [i for i, r in judged(tmp_path / "b", after).items() if r.status == "fail"] == []


def test_a_pair_of_static_things_needs_no_skins(tmp_path: Path) -> None:
    things = {"floor": ground(), "block": box(0.2, 0.2, 0.2, at=(0, 0, 0.098), euler=(0, 0, math.pi / 7))}
    spec = world(things)
    row = {r.id: r for r in interpenetration.check(make_candidate(tmp_path, spec))}["interpenetration:floor:block"]
    assert way(spec, moves(row)[0], "block") == pytest.approx([0, 0, 0.00215], abs=1e-5)

"""Lumps of one mesh hang together, as parts do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import entity, ground, make_candidate, mesh_of, world
from worldagent.verifiers.support import check as support
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, Mesh, Part, Pose

SIDE = 0.2


def mesh(*places: tuple[float, float, float], void: bool = False) -> Mesh:
    """Cubes of 0.2 m at some places, as one mesh; `void` turns the second, of 0.16 m, inside out."""
    points: list[Any] = []
    faces: list[Any] = []
    for k, place in enumerate(places):
        made = mesh_of(Box(size=(SIDE if k == 0 or not void else 0.16,) * 3))
        faces += ((made.faces[:, ::-1] if void and k == 1 else made.faces) + len(points)).tolist()
        points += (made.vertices + place).tolist()
    return Mesh(vertices=[tuple(v) for v in points], faces=[tuple(f) for f in faces])


def lumps_row(folder: Path, *shapes: Any, motion: str = "dynamic", **things: Any) -> Row | None:
    thing = entity(*shapes, motion=motion, at=(0, 0, SIDE / 2))
    rows = support.check(make_candidate(folder, world({"floor": ground(), "thing": thing, **things})))
    return next((r for r in rows if r.id == "support:lumps:thing"), None)


@pytest.mark.parametrize("motion", ["dynamic", "static"])
@pytest.mark.parametrize(("gap", "status"), [(0.0005, "pass"), (0.003, "pass"), (0.05, "fail"), (1.0, "fail")])
def test_a_lump_in_the_air_is_no_part_of_the_mesh(tmp_path: Path, motion: str, gap: float, status: str) -> None:
    row = lumps_row(tmp_path, mesh((0, 0, 0), (0, 0, SIDE + gap)), motion=motion)
    assert row is not None
    assert row.status == status
    if status == "fail":
        assert (row.measured, row.bound) == (1.0, 0.0)


def test_a_part_between_lumps_joins_them_and_one_that_hangs_with_the_loose_lump_does_not(tmp_path: Path) -> None:
    apart = mesh((0, 0, 0), (0, 0, 2 * SIDE))
    between = Part(shape=Box(size=(0.05, 0.05, SIDE)), pose=Pose(position=(0, 0, SIDE)))
    above = Part(shape=Box(size=(0.05, 0.05, SIDE)), pose=Pose(position=(0, 0, 3 * SIDE)))
    for motion in ("dynamic", "static"):
        rows = [lumps_row(tmp_path / f"{motion}{k}", Part(shape=apart), p, motion=motion) for k, p in enumerate((between, above))]
        assert [r.status for r in rows if r is not None] == ["pass", "fail"]


def test_lumps_of_what_never_moves_may_each_stand_on_the_floor(tmp_path: Path) -> None:
    row = lumps_row(tmp_path, mesh((0, 0, 0), (1, 0, 0)), motion="static")
    assert row is not None
    assert row.status == "pass"
    free = lumps_row(tmp_path / "free", mesh((0, 0, 0), (1, 0, 0)))
    assert free is not None
    assert free.status == "fail"


def test_a_void_belongs_to_the_lump_around_it_and_what_rattles_in_it_is_loose(tmp_path: Path) -> None:
    hollow = lumps_row(tmp_path, mesh((0, 0, 0), (0, 0, 0), void=True))
    assert hollow is not None
    assert hollow.status == "pass"
    small = mesh_of(Box(size=(0.05,) * 3))
    shell = mesh((0, 0, 0), (0, 0, 0), void=True)
    assert shell.vertices is not None
    assert shell.faces is not None
    points = [*shell.vertices, *(tuple(v) for v in small.vertices.tolist())]
    faces = [*shell.faces, *(tuple(f) for f in (small.faces + len(shell.vertices)).tolist())]
    rattle = lumps_row(tmp_path / "rattle", Mesh(vertices=points, faces=faces))
    assert rattle is not None
    assert rattle.status == "fail"


def test_a_mesh_of_one_lump_has_no_row(tmp_path: Path) -> None:
    assert lumps_row(tmp_path, mesh((0, 0, 0))) is None

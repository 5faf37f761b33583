"""Parts that lie inside others weigh little, or the entity's role says so: a block of wood moves as one (R154)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import entity, make_candidate, mesh_of, world
from worldagent.verifiers.scene.hidden import hidden_lines
from worldagent.verifiers.scene.scale import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Appearance, Box, Material, Mesh, Part, Pose, RigidPhysics

SIDE = 0.1
MATERIALS = {
    "wood": Material(density=600, substance="wood"),
    "lead": Material(density=11300),
    "glass": Material(density=2500, substance="glass", appearance=Appearance(transmission=0.9)),
}


def candidate(
    folder: Path,
    core: float,
    *,
    at: float = 0.0,
    role: str = "block",
    outer: str = "wood",
    inner: str = "lead",
    mass: float | None = None,
) -> Candidate:
    """A cube of 0.1 m with a cube of edge `core` [m] whose middle is `at` [m] along x."""
    parts = {
        "body": Part(shape=Box(size=(SIDE,) * 3)),
        "core": Part(shape=Box(size=(core,) * 3), material=inner, pose=Pose(position=(at, 0, 0))),
    }
    body = entity(Box(size=(SIDE,) * 3), motion="dynamic").model_copy(
        update={"parts": parts, "material": outer, "role": role, "physics": RigidPhysics(mass=mass)}
    )
    return make_candidate(folder, world({"b": body}, materials=MATERIALS))


def row(made: Candidate, question: str = "scale:hidden") -> Row | None:
    return next((r for r in check(made) if r.id == f"{question}:b"), None)


def test_a_hidden_core_is_measured_by_its_mass_and_refused(tmp_path: Path) -> None:
    found = row(candidate(tmp_path, 0.08))
    assert found is not None
    assert (found.status, found.mandatory) == ("fail", True)
    assert found.measured == pytest.approx(0.8**3 * 11300 / 600)
    assert "'core' of 'lead', 5.786 kg" in found.evidence["explanation"]
    assert found.corrections[0].patch == ({"op": "remove", "path": "/entities/b/parts/core"},)


@pytest.mark.parametrize(
    ("core", "at", "outer", "inner", "status"),
    [
        (0.01, 0.0, "wood", "lead", "pass"),  # a nail
        (0.09, 0.0, "wood", "wood", "fail"),  # wood twice in one place weighs twice
        (0.08, 0.0101, "wood", "lead", "fail"),  # a face that stands out by a tenth of a millimetre
        (0.08, 0.04, "wood", "lead", None),  # it can be seen
        (0.08, 0.0, "glass", "lead", None),  # and here through the glass
        (0.08, 0.2, "wood", "lead", None),
    ],
)
def test_what_can_be_seen_may_weigh_what_it_likes(
    tmp_path: Path, core: float, at: float, outer: str, inner: str, status: str | None
) -> None:
    found = row(candidate(tmp_path, core, at=at, outer=outer, inner=inner))
    assert (None if found is None else found.status) == status


def test_a_role_that_says_weighted_is_believed_and_the_register_prints_it(tmp_path: Path) -> None:
    made = candidate(tmp_path, 0.08, role="weighted block")
    found = row(made)
    assert found is not None
    assert found.status == "pass"
    assert hidden_lines(made) == [
        {"what": "part b/core lies hidden inside others", "effect": "it weighs 5.786 kg and is never seen"}
    ]


def test_a_hidden_part_raises_no_declared_mass(tmp_path: Path) -> None:
    """The most that the block may weigh is that of its wood."""
    found = row(candidate(tmp_path, 0.02, inner="wood", mass=1.2), "scale:mass")
    assert found is not None
    assert found.status == "pass"
    heavy = row(candidate(tmp_path / "b", 0.08, mass=4.0), "scale:mass")
    assert heavy is not None
    assert heavy.status == "fail"
    assert heavy.comparison == "<="


def boxed(folder: Path, *, gap: float, content: str, edge: float = 0.1) -> Candidate:
    """A box of boards, 0.3 m, whose lid leaves `gap` [m] open along one side, with a lump of edge `edge` [m] on its floor."""
    side, thick = 0.3, 0.02
    inner = side - 2 * thick
    boards = {
        "floor": ((side, side, thick), (0, 0, (thick - side) / 2)),
        "lid": ((side - gap, side, thick), (-gap / 2, 0, (side - thick) / 2)),
        "left": ((thick, side, inner), ((thick - side) / 2, 0, 0)),
        "right": ((thick, side, inner), ((side - thick) / 2, 0, 0)),
        "front": ((inner, thick, inner), (0, (thick - side) / 2, 0)),
        "back": ((inner, thick, inner), (0, (side - thick) / 2, 0)),
    }
    parts = {n: Part(shape=Box(size=size), pose=Pose(position=at)) for n, (size, at) in boards.items()}
    parts["content"] = Part(shape=Box(size=(edge,) * 3), material=content, pose=Pose(position=(0, 0, (edge - inner) / 2)))
    body = entity(Box(size=(side,) * 3), motion="dynamic").model_copy(update={"parts": parts, "material": "wood"})
    return make_candidate(folder, world({"b": body}, materials=MATERIALS))


@pytest.mark.parametrize(
    ("gap", "content", "edge", "status"),
    [
        (0.0, "lead", 0.1, "fail"),
        (0.002, "lead", 0.1, "fail"),  # a joint between boards
        (0.0, "lead", 0.032, "pass"),  # a hinge
        (0.15, "lead", 0.1, None),  # it can be seen
        (0.0, "wood", 0.1, None),  # no heavier than a block of wood
    ],
)
def test_what_a_box_shuts_in_is_never_seen(tmp_path: Path, gap: float, content: str, edge: float, status: str | None) -> None:
    found = row(boxed(tmp_path, gap=gap, content=content, edge=edge))
    assert (None if found is None else found.status) == status
    if status == "fail" and found is not None:
        assert found.measured == pytest.approx(edge**3 * 11300 / found.evidence["seen_kg"])
        assert set(found.evidence["hidden"]) == {"content"}


def meshed(folder: Path, *, void: bool, copies: int = 1, mass: float | None = None) -> Candidate:
    """A block of one mesh of 0.1 m with lumps, or a void, of 0.08 m and less inside."""
    shells = [mesh_of(Box(size=(SIDE,) * 3)), *(mesh_of(Box(size=(0.08 - 0.01 * k,) * 3)) for k in range(copies))]
    points: list[Any] = []
    faces: list[Any] = []
    for k, shell in enumerate(shells):
        faces += ((shell.faces[:, ::-1] if void and k else shell.faces) + len(points)).tolist()
        points += shell.vertices.tolist()
    shape = Mesh(vertices=[tuple(v) for v in points], faces=[tuple(f) for f in faces])
    body = entity(shape, motion="dynamic").model_copy(update={"material": "wood", "physics": RigidPhysics(mass=mass)})
    return make_candidate(folder, world({"b": body}, materials=MATERIALS))


def test_lumps_inside_a_mesh_count_once_and_a_void_is_none(tmp_path: Path) -> None:
    found = row(meshed(tmp_path / "a", void=False, copies=2))
    assert found is not None
    assert found.status == "fail"
    assert found.measured == pytest.approx(0.8**3 + 0.7**3)
    (edit,) = found.corrections[0].patch
    assert edit["path"] == "/entities/b/parts/p0/shape/faces"
    assert len(edit["value"]) == 12, "the faces of the outer box, and of no inner one"
    assert row(meshed(tmp_path / "b", void=True)) is None


def test_a_lump_inside_a_mesh_raises_no_declared_mass(tmp_path: Path) -> None:
    one = row(meshed(tmp_path / "a", void=False, mass=1.5), "scale:mass")
    plain = row(candidate(tmp_path / "b", 0.01, inner="wood", mass=1.5), "scale:mass")
    assert one is not None
    assert plain is not None
    assert (one.status, plain.status) == ("fail", "fail")
    assert one.bound == pytest.approx(plain.bound)

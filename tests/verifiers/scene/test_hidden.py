"""Parts that lie inside others weigh little, or the entity's role says so: a block of wood moves as one (R154)."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.testing.worlds.small_worlds import entity, make_candidate, world
from worldagent.verifiers.scene.hidden import hidden_lines
from worldagent.verifiers.scene.scale import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Appearance, Box, Material, Part, Pose, RigidPhysics

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

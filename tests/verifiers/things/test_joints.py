"""Things that open can be moved with the world as it stands: swept poses against boxes, posts, light things and things that go along."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.assets.registry import GENERATORS
from worldagent.testing.defects._rooms import GAP, room
from worldagent.testing.worlds.small_worlds import box, ground, make_candidate, world
from worldagent.verifiers.things import joints
from worldagent.verifiers.things.kinds import OPENINGS
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.predicates import Contact
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, Entity, Fastened, HingeJoint, SlideJoint, Supports, WeldJoint
from worldagent.worlds.vocabulary import SpecModel

TRAVEL, SIDE = 0.4, 0.3
"""[m] Of the drawer, and its edge."""


def _drawer(tmp_path: Path, others: Mapping[str, Entity], role: str = "drawer", **more: Any) -> Row | None:
    """The row of a drawer of 0.3 m at x = 0 that slides along x by 0.4 m, in an open case behind it."""
    drawer = box(SIDE, SIDE, SIDE, motion="dynamic", at=(0, 0, 0.5)).model_copy(update={"role": role})
    case = box(0.1, SIDE, 1.0, at=(-SIDE / 2 - 0.06, 0, 0.5))
    slide = SlideJoint(parent="case", child="drawer", anchor=(0, 0, 0.5), axis=(1, 0, 0), range=(0.0, TRAVEL))
    tied = {"slide": slide, **more.pop("joints", {})}
    spec = world({"floor": ground(), "case": case, "drawer": drawer, **others}, joints=tied, **more)
    rows = joints.check(make_candidate(tmp_path, spec))
    return rows[0] if rows else None


def _block(gap: float, **more: Any) -> Entity:
    """A block whose near face is `gap` before the drawer."""
    return box(0.2, 0.2, 1.0, at=(SIDE / 2 + gap + 0.1, 0, 0.5), **more)


@pytest.mark.parametrize(
    ("gap", "status"), [(0.7 * TRAVEL + 0.004, "pass"), (0.7 * TRAVEL - 0.004, "fail"), (TRAVEL + 0.01, "pass")]
)
def test_a_drawer_needs_seven_tenths_of_its_travel(tmp_path: Path, gap: float, status: str) -> None:
    row = _drawer(tmp_path, {"block": _block(gap)})
    assert row is not None
    assert (row.status, row.bound) == (status, 0.7)
    assert row.measured == pytest.approx(min(gap, TRAVEL) / TRAVEL, abs=0.005)


def test_what_stands_in_the_way_is_named_and_its_move_mends_it(tmp_path: Path) -> None:
    row = _drawer(tmp_path, {"block": _block(0.1)})
    assert row is not None
    assert row.first_failing_entity == "drawer"
    assert row.entities == ("drawer", "block")
    assert row.evidence["obstacle"] == "block"
    suggested = row.corrections[0]
    assert suggested.edit_class == "scene"
    at = next(o["value"]["position"] for o in suggested.patch if o["path"] == "/entities/block/pose")
    moved = box(0.2, 0.2, 1.0, at=at)
    again = _drawer(tmp_path, {"block": moved})
    assert again is not None
    assert again.status == "pass"


def test_a_drawer_that_is_shut_in_from_the_start_moves_nowhere(tmp_path: Path) -> None:
    row = _drawer(tmp_path, {"block": _block(-0.05)})
    assert row is not None
    assert (row.status, row.measured) == ("fail", 0.0)


@pytest.mark.parametrize("role", ["drawer", "upper drawer of the desk", "the left drawers, oak"])
def test_what_a_body_is_called_decides_that_it_opens(tmp_path: Path, role: str) -> None:
    assert _drawer(tmp_path, {}, role) is not None


@pytest.mark.parametrize("role", ["piston", "block that rolls through the gate", "knob of a drawer"])
def test_other_bodies_on_joints_are_not_asked(tmp_path: Path, role: str) -> None:
    assert _drawer(tmp_path, {}, role) is None


def test_a_joint_without_a_range_is_not_asked(tmp_path: Path) -> None:
    wheel = box(SIDE, SIDE, SIDE, motion="dynamic", at=(0, 0, 0.5)).model_copy(update={"role": "door"})
    hinge = HingeJoint(child="wheel", anchor=(0, 0, 0.5), axis=(0, 0, 1))
    assert joints.check(make_candidate(tmp_path, world({"wheel": wheel}, joints={"h": hinge}))) == []


@pytest.mark.parametrize(("mass", "status"), [(4.0, "pass"), (5.0, "fail")])
def test_light_free_things_are_pushed_away(tmp_path: Path, mass: float, status: str) -> None:
    side = (mass / 600.0) ** (1 / 3)
    light = box(side, side, side, motion="dynamic", at=(SIDE / 2 + 0.05 + side / 2, 0, 0.5))
    row = _drawer(tmp_path, {"crate": light})
    assert row is not None
    assert row.status == status


def test_a_light_thing_that_is_fixed_is_not_pushed_away(tmp_path: Path) -> None:
    light = box(0.1, 0.1, 0.1, motion="dynamic", at=(SIDE / 2 + 0.15, 0, 0.5))
    row = _drawer(tmp_path, {"crate": light}, joints={"weld": WeldJoint(child="crate", anchor=(SIDE / 2 + 0.15, 0, 0.45))})
    assert row is not None
    assert row.status == "fail"


def test_what_stands_on_a_drawer_goes_along_and_may_hit(tmp_path: Path) -> None:
    high = box(0.2, 0.2, 0.6, motion="dynamic", at=(0, 0, 0.5 + SIDE / 2 + 0.3))
    shelf = box(0.2, 0.4, 0.05, at=(0.3, 0, 1.0))
    relation = {"stands": Supports(a="drawer", b="load")}
    row = _drawer(tmp_path, {"load": high}, relations=relation)
    assert row is not None
    assert row.status == "pass"
    row = _drawer(tmp_path, {"load": high, "shelf": shelf}, relations=relation)
    assert row is not None
    assert row.status == "fail"
    assert row.evidence["obstacle"] == "shelf"


def test_what_the_story_has_it_meet_is_no_obstacle(tmp_path: Path) -> None:
    beat = Beat(text="", owner="rigid", subject="drawer", frames=(1, 20), predicate=Contact(a="drawer", b="block"))
    row = _drawer(tmp_path, {"block": _block(0.1)}, beats={"meets": beat})
    assert row is not None
    assert row.status == "pass"


def test_a_drawer_that_is_welded_shut_is_meant_to_be(tmp_path: Path) -> None:
    weld = WeldJoint(parent="case", child="drawer", anchor=(-SIDE / 2, 0, 0.5))
    row = _drawer(tmp_path, {"block": _block(0.1)}, joints={"weld": weld})
    assert row is not None
    assert row.status == "not_applicable"
    assert "welded" in row.evidence["explanation"]


def test_the_mount_of_what_opens_is_no_obstacle_but_the_rest_of_it_is(tmp_path: Path) -> None:
    """The case touches the drawer where it hangs; a far part of the same entity is in the way."""
    from worldagent.testing.worlds.small_worlds import entity, pose
    from worldagent.worlds.spec import Box, Part

    drawer = box(SIDE, SIDE, SIDE, motion="dynamic", at=(0, 0, 0.5)).model_copy(update={"role": "drawer"})
    back = Part(shape=Box(size=(0.1, SIDE, 1.0)), pose=pose((-SIDE / 2 - 0.05, 0, 0.5)))
    stop = Part(shape=Box(size=(0.1, SIDE, 1.0)), pose=pose((SIDE / 2 + 0.15, 0, 0.5)))
    slide = SlideJoint(parent="case", child="drawer", anchor=(0, 0, 0.5), axis=(1, 0, 0), range=(0.0, TRAVEL))
    fixed: dict[str, SpecModel] = {"held": Fastened(a="case", b="drawer", max_depth=0.001, reason="screwed to its runners")}
    for parts, status in (((back,), "pass"), ((back, stop), "fail")):
        spec = world({"case": entity(*parts), "drawer": drawer}, joints={"slide": slide}, relations=fixed)
        (row,) = joints.check(make_candidate(tmp_path, spec))
        assert row.status == status


@pytest.mark.parametrize(("degrees", "status"), [(62.0, "pass"), (58.0, "fail")])
def test_a_door_needs_sixty_degrees(tmp_path: Path, degrees: float, status: str) -> None:
    """The free angle is measured where the post touches the leaf, at any place and heading of the room."""
    for seed in range(3):
        found = room(np.random.default_rng(seed))
        found.post(math.radians(degrees))
        (row,) = joints.check(found.world(tmp_path).candidate)
        assert row.status == status
        assert row.evidence["free"][1] == pytest.approx(math.radians(degrees), abs=math.radians(0.3))


def test_a_thin_rod_across_the_way_is_found(tmp_path: Path) -> None:
    """4 mm thick, between two coarse poses."""
    row = _drawer(tmp_path, {"rod": box(0.004, 0.5, 0.004, at=(SIDE / 2 + 0.153, 0, 0.52))})
    assert row is not None
    assert row.status == "fail"
    assert row.measured == pytest.approx(0.151 / TRAVEL, abs=0.005)


def test_a_moved_entity_gives_the_row_another_recipe(tmp_path: Path) -> None:
    one, two = (_drawer(tmp_path, {"block": _block(gap)}) for gap in (0.9, 0.95))
    assert one is not None
    assert two is not None
    assert one.recipe != two.recipe


@pytest.mark.parametrize("name", OPENINGS.generators)
def test_things_that_open_do_so_on_a_bare_floor(tmp_path: Path, name: str) -> None:
    found = room(np.random.default_rng(0))
    found.put("thing", name, (1.3, 0.0, GAP if GENERATORS[name].stands else 1.0))
    rows = joints.check(found.world(tmp_path).candidate)
    assert [(r.id, r.evidence) for r in rows if r.status != "pass"] == []
    if name not in ("lantern", "chest"):  # small: taken up to open them
        assert [r for r in rows if r.subject[0].startswith("thing")]


def test_a_patch_of_a_piece_of_furniture_takes_its_drawers_and_what_stands_on_it_along(tmp_path: Path) -> None:
    found = room(np.random.default_rng(3))
    found.put("chest", "chest_of_drawers", (1.4, 0.9, GAP))
    found.put("cupboard", "cupboard", (1.4, 0.2, GAP), facing=math.pi / 2)
    found.put("mug", "mug", (1.4, 0.2, 1.2 + 2 * GAP))
    found.relations["stands"] = {"kind": "supports", "a": "cupboard", "b": "mug"}
    candidate = found.world(tmp_path).candidate
    row = next(r for r in joints.check(candidate) if r.status == "fail")
    suggested = row.corrections[0]
    assert suggested.patch
    places = {str(o["path"]) for o in suggested.patch}
    assert {"/entities/cupboard/pose", "/entities/mug/pose"} <= places or "/entities/chest/pose" in places
    assert any(p.startswith("/simulation/joints/") for p in places)
    apply_patch(candidate.spec, suggested.patch)

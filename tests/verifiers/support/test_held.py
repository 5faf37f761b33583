"""Everything is held by something: static things, joints and ropes, and free bodies until something moves them (R92, R154)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonpatch
import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, build_all, entity, ground, make_candidate, pose, world
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.support import check as support
from worldagent.verifiers.support.anchored import anchor_lines
from worldagent.verifiers.support.lowest import ground_lines
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.predicates import Displacement, StaysIn
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import (
    BallJoint,
    Beat,
    Box,
    BoxRegion,
    Fastened,
    HingeJoint,
    Part,
    PathDriver,
    PathKey,
    Rope,
    SlideJoint,
    Sphere,
    SpringJoint,
    Supports,
    WeldJoint,
    WorldSpec,
)

FRAMES = 24
TIME = np.arange(FRAMES) / 24


def rows_of(tmp_path: Path, things: dict[str, Any], tracks: Any = None, **more: Any) -> dict[str, Row]:
    spec = world(things, frames=FRAMES, **more)
    return {r.id: r for r in support.check(make_candidate(tmp_path, spec, tracks=tracks))}


def mended(spec: WorldSpec, row: Row) -> WorldSpec:
    return WorldSpec.model_validate(jsonpatch.apply_patch(spec.model_dump(mode="json"), row.corrections[0].patch))


# ---------------------------------------------------------------- static things


@pytest.mark.parametrize(("gap", "status"), [(0.0, "pass"), (0.00199, "pass"), (0.0021, "fail"), (0.5, "fail")])
def test_a_static_thing_in_mid_air_fails_and_the_patch_puts_it_down(tmp_path: Path, gap: float, status: str) -> None:
    spec = world({"floor": ground(), "bust": box(0.2, 0.2, 0.4, at=(0, 0, 0.2 + gap))})
    row = {r.id: r for r in support.check(make_candidate(tmp_path, spec))}["support:derived:bust"]
    assert row.status == status
    if status == "fail":
        assert row.measured == pytest.approx(gap, abs=1e-4)
        assert (round(row.bound or 0.0, 5), row.unit, row.entities, row.first_failing_frame) == (0.002, "m", ("bust", "floor"), 0)
        assert [c.group for c in row.corrections] == ["placement", "shape", "placement"]
        again = support.check(make_candidate(tmp_path / "again", mended(spec, row)))
        assert {r.status for r in again} == {"pass"}


def test_a_shelf_holds_at_its_wall_and_a_beam_between_its_posts(tmp_path: Path) -> None:
    posts = {f"post{k}": box(0.2, 0.2, 2, at=(x, 2, 1)) for k, x in enumerate((-1, 1))}
    things = {
        "floor": ground(),
        "wall": box(0.2, 4, 3, at=(-2, 0, 1.5)),
        "shelf": box(0.3, 1, 0.05, at=(-1.75, 0, 1.2)),
        "vase": box(0.1, 0.1, 0.3, at=(-1.75, 0, 1.375)),
        "beam": box(1.8, 0.1, 0.1, at=(0, 2, 1.7)),
        **posts,
    }
    rows = rows_of(tmp_path, things)
    assert {r.status for r in rows.values()} == {"pass"}
    assert rows["support:derived:vase"].evidence["chain"] == ["vase", "shelf", "wall", "floor"]
    assert rows["support:derived:beam"].evidence["chain"][0] == "beam"
    assert "support:derived:floor" not in rows


@pytest.mark.parametrize(
    ("size", "gap", "status"), [(0.1, 0.0009, "pass"), (0.02, 0.0003, "pass"), (0.02, 0.0004, "fail"), (8.0, 0.0021, "fail")]
)
def test_a_seam_is_small_against_what_it_joins(tmp_path: Path, size: float, gap: float, status: str) -> None:
    """One in a hundred of the diagonal, at most two millimetres."""
    things = {
        "floor": ground(),
        "wall": box(1, 9, 9, at=(-1, 0, 4.5)),
        "shelf": box(size, size, size, at=(-0.5 + size / 2 + gap, 0, 4.5)),
    }
    assert rows_of(tmp_path, things)["support:derived:shelf"].status == status


def test_the_seams_of_a_chain_are_no_wider_together_than_a_contact(tmp_path: Path) -> None:
    """A row of beads beside a pole, 0.8 mm from each other: 3 mm are used up at the fourth."""
    beads = {f"bead{k}": box(0.1, 0.1, 0.1, at=(0.1008 * (k + 1), 0, 0.9)) for k in range(6)}
    rows = rows_of(tmp_path, {"floor": ground(), "pole": box(0.1, 0.1, 1, at=(0, 0, 0.5)), **beads})
    assert [rows[f"support:derived:bead{k}"].status for k in range(6)] == ["pass"] * 3 + ["fail"] * 3
    row = rows["support:derived:bead3"]
    assert (row.measured, row.bound) == (pytest.approx(0.0032, abs=1e-5), 0.003)
    assert "over gaps of 3.2 mm together" in row.evidence["explanation"]


def test_what_stands_on_what_floats_floats_too_and_the_nearest_hold_is_named(tmp_path: Path) -> None:
    things = {
        "floor": ground(),
        "wall": box(0.2, 4, 3, at=(-2, 0, 1.5)),
        "shelf": box(0.3, 1, 0.05, at=(-1.73, 0, 1.2)),
        "vase": box(0.1, 0.1, 0.3, at=(-1.73, 0, 1.375)),
    }
    rows = rows_of(tmp_path, things)
    shelf, vase = rows["support:derived:shelf"], rows["support:derived:vase"]
    assert (shelf.status, vase.status) == ("fail", "fail")
    assert shelf.measured == pytest.approx(0.02, abs=1e-4)
    assert shelf.evidence["nearest_held"] == "wall"
    assert shelf.corrections[0].patch[0]["value"]["position"][0] == pytest.approx(-1.75, abs=2e-4)
    assert "touches 'shelf', which nothing holds up either" in vase.evidence["explanation"]


def test_every_piece_of_an_entity_is_held(tmp_path: Path) -> None:
    def lamp(gap: float) -> Any:
        foot = Part(shape=Box(size=(0.2, 0.2, 1.0)), pose=pose((0, 0, 0.5)))
        return entity(foot, Part(shape=Sphere(radius=0.1), pose=pose((0, 0, 1.1 + gap))))

    assert rows_of(tmp_path / "a", {"floor": ground(), "lamp": lamp(0.0)})["support:derived:lamp"].status == "pass"
    row = rows_of(tmp_path / "b", {"floor": ground(), "lamp": lamp(0.3)})["support:derived:lamp"]
    assert (row.status, row.evidence["parts"]) == ("fail", ["p1"])
    assert row.measured == pytest.approx(0.3, abs=1e-3)
    assert row.corrections[0].pointers == ("/entities/lamp/parts/p1/pose",)
    # The floor below it is the ground; a part of the ground that hangs over it is not.
    over = entity(Part(shape=Box(size=(4, 4, 0.2))), Part(shape=Box(size=(1, 1, 0.2)), pose=pose((0, 0, 2))))
    assert rows_of(tmp_path / "c", {"floor": over})["support:derived:floor"].status == "fail"


def test_what_is_not_built_is_not_held(tmp_path: Path) -> None:
    spec = world({"floor": ground(), "bust": box(0.2, 0.2, 0.4, at=(0, 0, 0.2))})
    candidate = make_candidate(tmp_path, spec)
    object.__setattr__(candidate, "built", {n: b for n, b in build_all(spec).items() if n != "bust"})
    rows = {r.id: r.status for r in support.check(candidate)}
    assert rows["support:derived:bust"] == rows["support:scene"] == "unverified"


def test_free_bodies_hold_no_static_thing(tmp_path: Path) -> None:
    things = {"floor": ground(), "crate": box(1, 1, 1, motion="dynamic", at=(0, 0, 0.5)), "roof": box(2, 2, 0.1, at=(0, 0, 1.05))}
    assert rows_of(tmp_path, things)["support:derived:roof"].status == "fail"


def test_what_a_path_moves_is_held_by_it_and_what_a_path_keeps_in_place_is_not(tmp_path: Path) -> None:
    def driver(x: float) -> PathDriver:
        keys = {"a": PathKey(time=0, pose=pose((0, 0, 1))), "b": PathKey(time=1, pose=pose((x, 0, 1)))}
        return PathDriver(entity="drone", keys=keys)

    things = {"floor": ground(), "drone": box(0.2, 0.2, 0.2, motion="kinematic", at=(0, 0, 1))}
    assert "support:derived:drone" not in rows_of(tmp_path / "a", things, drivers={"d": driver(1.0)})
    assert rows_of(tmp_path / "b", things, drivers={"d": driver(0.0)})["support:derived:drone"].status == "fail"


def test_afloat_frees_and_is_printed(tmp_path: Path) -> None:
    reason = "a magic orb hovers over the altar"
    things = {"floor": ground(), "orb": box(0.2, 0.2, 0.2, at=(0, 0, 1), afloat=reason)}
    candidate = make_candidate(tmp_path, world(things))
    rows = {r.id: r for r in support.check(candidate)}
    assert rows["support:derived:orb"].status == "pass"
    assert reason in rows["support:derived:orb"].evidence["explanation"]
    assert f"'orb' floats in the air: {reason}" in [line["what"] for line in approximations(candidate)]


@pytest.mark.parametrize("reason", ["magic", "because......", "          no"])
def test_afloat_needs_a_reason_of_words(reason: str) -> None:
    with pytest.raises(ValueError, match="afloat"):
        box(0.2, 0.2, 0.2, afloat=reason)


def test_afloat_of_a_free_body_leaves_its_fall_to_physics(tmp_path: Path) -> None:
    things = {"floor": ground(), "orb": ball(0.1, motion="dynamic", at=(0, 0, 3), afloat="a magic orb hovers here")}
    path = np.column_stack([0 * TIME, 0 * TIME, 3 - 4.905 * TIME**2])
    rows = rows_of(tmp_path, things, {"orb": (path, IDENTITY)})
    assert rows["support:derived:orb"].status == "pass"
    assert (rows["support:stays:orb"].status, rows["support:stays:orb"].first_failing_frame) == ("fail", 1)


def test_a_picture_that_touches_its_wall_may_be_said_to_hang_there(tmp_path: Path) -> None:
    things = {"floor": ground(), "wall": box(0.2, 4, 3, at=(0, 0, 1.5)), "picture": box(0.02, 0.5, 0.4, at=(0.1105, 0, 1.6))}
    for stage in ("static", "full"):
        rows = rows_of(
            tmp_path / stage, things, None if stage == "static" else {}, relations={"hangs": Supports(a="wall", b="picture")}
        )
        assert {r.status for r in rows.values()} == {"pass"}
        assert rows["support:hangs:picture"].measured == pytest.approx(0.0005, abs=1e-9)


def test_of_what_is_held_nobody_says_that_it_is_not(tmp_path: Path) -> None:
    things = {
        "floor": ground(),
        "wall": box(0.2, 4, 3, at=(0, 0, 1.5)),
        "picture": box(0.02, 0.5, 0.4, motion="dynamic", at=(0.1105, 0, 1.6)),
    }
    row = rows_of(tmp_path, things)["support:derived:picture"]
    text = row.evidence["explanation"]
    assert row.status == "fail"
    assert "not held up" not in text
    assert "floats 1400 mm above 'floor'" in text
    assert "it touches 'wall' beside or above it, where neither friction nor a joint holds it" in text


def test_a_still_thing_on_a_body_that_may_move_is_told_so_and_let_go_with_it(tmp_path: Path) -> None:
    """A cap on a block that slides: it lies on it, and is not held by it."""
    block = box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.051))
    things = {"floor": ground(), "block": block, "cap": box(0.1, 0.1, 0.02, at=(0, 0, 0.1115))}
    spec = world(things, frames=FRAMES)
    rows = {r.id: r for r in support.check(make_candidate(tmp_path, spec))}
    row = rows["support:derived:cap"]
    assert row.status == "fail"
    assert "'cap' touches 'block', which may move" in row.evidence["explanation"]
    assert row.measured == pytest.approx(0.1015, abs=1e-3), "what is measured stays the fall to what holds"
    assert "may" in row.corrections[0].cause
    assert row.corrections[0].pointers == ("/entities/cap/motion",)
    loose = {
        r.id: r
        for r in support.check(
            make_candidate(
                tmp_path / "l", world({**things, "cap": box(0.1, 0.1, 0.02, motion="dynamic", at=(0, 0, 0.1115))}, frames=FRAMES)
            )
        )
    }
    assert loose["support:derived:cap"].status == "pass", loose["support:derived:cap"].evidence
    beside = {"floor": ground(), "block": block, "cap": box(0.1, 0.1, 0.02, at=(0.5, 0, 0.1115))}
    far = rows_of(tmp_path / "f", beside)["support:derived:cap"]
    assert far.evidence["explanation"].startswith("'cap' floats 101.5 mm above 'floor'")


# ---------------------------------------------------------------- joints, ropes, fastened things


def _hung(gap: float, **more: Any) -> dict[str, Any]:
    beam = entity(Box(size=(1, 0.1, 0.1)), Part(shape=Box(size=(0.1, 0.1, 3)), pose=pose((0.45, 0, -1.55))), at=(0, 0, 3.05))
    return {"floor": ground(), "beam": beam, "lamp": ball(0.1, motion="dynamic", at=(0, 0, 2.9 - gap), **more)}


JOINTS = {
    "weld": WeldJoint(parent="beam", child="lamp", anchor=(0, 0, 3)),
    "ball": BallJoint(parent="beam", child="lamp", anchor=(0, 0, 3)),
    "hinge": HingeJoint(parent="beam", child="lamp", anchor=(0, 0, 3), axis=(0, 1, 0)),
    "spring": SpringJoint(parent="beam", child="lamp", parent_point=(0, 0, 3), child_point=(0, 0, 3), stiffness=100.0),
    "world": BallJoint(child="lamp", anchor=(0, 0, 3)),
}


@pytest.mark.parametrize("kind", JOINTS)
@pytest.mark.parametrize(("gap", "status"), [(0.0, "pass"), (0.0034, "pass"), (0.0036, "fail"), (0.3, "fail")])
def test_a_joint_holds_only_what_it_reaches(tmp_path: Path, kind: str, gap: float, status: str) -> None:
    spec = world(_hung(gap), joints={"j": JOINTS[kind]})
    row = {r.id: r for r in support.check(make_candidate(tmp_path, spec))}["support:joint:j"]
    assert row.status == status
    if status == "fail":
        # The sphere's facets lie up to 0.2 mm within its radius.
        assert row.measured == pytest.approx(gap, abs=3e-4)
        assert row.bound == pytest.approx(0.0035)
        assert row.entities[0] == "lamp"
        again = {r.id: r for r in support.check(make_candidate(tmp_path / "again", mended(spec, row)))}
        assert again["support:joint:j"].status == "pass"
        assert any(p.pointer.startswith("/simulation/joints/j") for p in _told(spec)) == (gap > 0.1 and kind != "weld")


def _told(spec: WorldSpec) -> list[Any]:
    from worldagent.worlds.audits.reach import reach_problems

    problems = reach_problems(spec)
    rows = {r.id: r.status for r in audit(spec).rows}
    assert rows["audit:reach"] == ("fail" if problems else "pass")
    return problems


def test_a_hinge_is_reached_anywhere_on_its_axis(tmp_path: Path) -> None:
    things = {
        "floor": ground(),
        "jamb": box(0.1, 0.1, 2, at=(0, 0, 1)),
        "leaf": box(0.8, 0.04, 1.8, motion="dynamic", at=(0.455, 0, 1)),
    }
    for at, status in (((0.052, 0, -0.5), "pass"), ((0.052, 0.1, 1.0), "fail")):
        joints = {"h": HingeJoint(parent="jamb", child="leaf", anchor=at, axis=(0, 0, 1))}
        assert rows_of(tmp_path / status, things, joints=joints)["support:joint:h"].status == status


@pytest.mark.parametrize(("gap", "status"), [(0.004, "pass"), (0.0069, "pass"), (0.0072, "fail")])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_hinge_acts_in_the_gap_that_its_axis_crosses(tmp_path: Path, gap: float, status: str, side: int) -> None:
    """Both are reached from the middle of the gap where that is no more than 3.5 mm from either, however narrow that stretch of the axis."""
    wheel = box(0.1, 0.4, 0.4, motion="dynamic", at=(side * (0.55 + gap), 0, 0.5))
    things = {"floor": ground(), "beam": box(1.0, 0.1, 0.1, at=(0, 0, 0.5)), "wheel": wheel}
    joints = {"h": HingeJoint(parent="beam", child="wheel", anchor=(side * (0.55 + gap), 0, 0.5), axis=(1, 0, 0))}
    assert rows_of(tmp_path, things, joints=joints)["support:joint:h"].status == status


@pytest.mark.parametrize(("short", "status"), [(0.0, "pass"), (0.01, "pass"), (0.02, "fail"), (0.3, "fail")])
def test_a_rope_ends_at_what_it_is_attached_to(tmp_path: Path, short: float, status: str) -> None:
    """The rope is 20 mm thick: its round end reaches 10 mm beyond its last point, and 3.5 mm may be open."""
    rope = Rope(points=[(0, 0, 3 - short), (0, 0, 2)], radius=0.01, segments=5, attach_start="beam", attach_end="lamp")
    things = {**_hung(0.9), "rope": entity(rope=rope, motion="dynamic")}
    spec = world(things)
    rows = {r.id: r for r in support.check(make_candidate(tmp_path, spec))}
    row = rows["support:rope:rope:start"]
    assert row.status == status
    assert rows["support:rope:rope:end"].status == "pass"
    if status == "fail":
        assert row.measured == pytest.approx(short, abs=1e-9)
        assert row.entities[0] == "beam"
        assert row.corrections[0].patch[0]["value"][2] == pytest.approx(3.0, abs=1e-6)
        assert bool(_told(spec)) == (short > 0.1)


@pytest.mark.parametrize(("gap", "status"), [(-0.001, "pass"), (0.0029, "pass"), (0.0031, "fail"), (0.3, "fail")])
def test_fastened_things_touch(tmp_path: Path, gap: float, status: str) -> None:
    things = {"floor": ground(), "a": box(0.2, 0.2, 0.2, at=(0, 0, 0.1)), "b": box(0.1, 0.1, 0.2, at=(0.15 + gap, 0, 0.1))}
    glue = {"glue": Fastened(a="a", b="b", max_depth=0.002, reason="b is screwed to a")}
    spec = world(things, relations=glue)
    row = {r.id: r for r in support.check(make_candidate(tmp_path, spec))}["support:fastened:glue"]
    assert row.status == status
    if status == "fail":
        assert row.measured == pytest.approx(gap, abs=1e-6)
        again = {r.id: r for r in support.check(make_candidate(tmp_path / "again", mended(spec, row)))}
        assert again["support:fastened:glue"].status == "pass"


# ---------------------------------------------------------------- joints to a fixed point of space


POINTS: dict[str, Any] = {
    "weld": WeldJoint(child="lamp", anchor=(0, 0, 2.9)),
    "ball": BallJoint(child="lamp", anchor=(0, 0, 3)),
    "hinge": HingeJoint(child="lamp", anchor=(0, 0.05, 3), axis=(0, 1, 0)),
    "slide": SlideJoint(child="lamp", anchor=(0, 0, 2.9), axis=(0, 0, 1), friction=100.0),
    "spring": SpringJoint(child="lamp", parent_point=(0, 0, 3), child_point=(0, 0, 2.8), stiffness=100.0),
}
FIELDS = {"spring": "parent_point"}
REASON = "a lamp that a spell keeps where it is"


@pytest.mark.parametrize("kind", POINTS)
def test_a_point_of_space_holds_nothing_but_what_says_that_it_floats(tmp_path: Path, kind: str) -> None:
    row_id, things, joints = f"support:anchor:j:{FIELDS.get(kind, 'anchor')}", _hung(0.0), {"j": POINTS[kind]}
    spec = world(things, joints=joints)
    rows = {r.id: r for r in support.check(make_candidate(tmp_path / "beam", spec))}
    assert (rows[row_id].status, _told(spec)) == ("pass", [])
    del things["beam"]
    spec = world(things, joints=joints)
    row = {r.id: r for r in support.check(make_candidate(tmp_path / "none", spec))}[row_id]
    assert (row.status, row.first_failing_entity, row.evidence["nearest"]) == ("fail", "lamp", "floor")
    assert row.measured == pytest.approx(3.0 if kind in ("ball", "hinge", "spring") else 2.9)
    assert (row.bound, row.unit) == (pytest.approx(0.0035), "m")
    assert [c.group for c in row.corrections] == ["shape", "joints", "placement"]
    assert [p.pointer for p in _told(spec)] == [f"/simulation/joints/j/{FIELDS.get(kind, 'anchor')}"]
    spec = world(_hung(0.0, afloat=REASON) | {"beam": box(0.1, 0.1, 3, at=(2, 0, 1.5))}, joints=joints)
    row = {r.id: r for r in support.check(make_candidate(tmp_path / "said", spec))}[row_id]
    assert (row.status, _told(spec)) == ("pass", [])
    assert REASON in row.evidence["explanation"]


def test_a_hinge_to_the_world_holds_nothing_that_its_post_does_not_reach(tmp_path: Path) -> None:
    """An anchor in the post and a body farther along the axis, with nothing between, are two places: one of them has to have both."""
    for gap, status in ((0.0005, "pass"), (0.25, "fail")):
        things = {
            "floor": ground(),
            "post": box(0.06, 0.06, 0.3, at=(0, 0, 0.15)),
            "lump": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.35 + gap)),
        }
        joints = {"h": HingeJoint(child="lump", anchor=(0, 0, 0.1), axis=(0, 0, 1))}
        row = rows_of(tmp_path / status, things, joints=joints)["support:anchor:h:anchor"]
        assert row.status == status
        assert set(row.entities) == {"lump", "post"}


def test_what_reaches_lowest_counts_as_the_ground_and_says_so(tmp_path: Path) -> None:
    things = {"shelf": box(1.2, 0.3, 0.02, at=(0, 0, 1)), "vase": box(0.1, 0.1, 0.2, motion="dynamic", at=(0, 0, 1.111))}
    (line,) = ground_lines(make_candidate(tmp_path, world(things)))
    assert line["what"] == "'shelf' reaches lowest and counts as the ground"


def test_a_hinge_to_the_world_is_held_anywhere_on_its_axis(tmp_path: Path) -> None:
    things = {
        "floor": ground(),
        "jamb": box(0.1, 0.1, 2, at=(0, 0, 1)),
        "leaf": box(0.8, 0.04, 1.8, motion="dynamic", at=(0.455, 0, 1)),
    }
    for at, status in (((0.052, 0, -0.5), "pass"), ((0.3, 0, 1.0), "fail")):
        joints = {"h": HingeJoint(child="leaf", anchor=at, axis=(0, 0, 1))}
        assert rows_of(tmp_path / status, things, joints=joints)["support:anchor:h:anchor"].status == status


@pytest.mark.parametrize("side", ["start", "end"])
def test_a_rope_ends_at_something(tmp_path: Path, side: str) -> None:
    points = [(0, 0, 3), (0, 0, 2)] if side == "start" else [(0, 0, 2), (0, 0, 3)]
    line = entity(rope=Rope(points=points, radius=0.01, segments=5, **{f"attach_{side}": "world"}), motion="dynamic")
    things = {"floor": ground(), "rope": line}
    spec = world(things)
    row = {r.id: r for r in support.check(make_candidate(tmp_path / "a", spec))}[f"support:anchor:rope:{side}"]
    assert (row.status, row.measured) == ("fail", pytest.approx(3.0))
    assert [p.pointer for p in _told(spec)] == [f"/entities/rope/generator/points/{0 if side == 'start' else 1}"]
    spec = world({**_hung(0.0), "rope": line})
    assert rows_of(tmp_path / "b", {**_hung(0.0), "rope": line})[f"support:anchor:rope:{side}"].status == "pass"
    assert _told(spec) == []


def test_an_anchor_in_the_air_is_printed(tmp_path: Path) -> None:
    joints = {"pin": BallJoint(child="lamp", anchor=(0, 0, 3))}
    things = _hung(0.0, afloat=REASON)
    assert anchor_lines(make_candidate(tmp_path / "a", world(things, joints=joints))) == []
    del things["beam"]
    told = [found["what"] for found in approximations(make_candidate(tmp_path / "b", world(things, joints=joints)))]
    assert "ball 'pin' holds 'lamp' at a fixed point of space that nothing drawn holds" in told
    assert f"'lamp' floats in the air: {REASON}" in told


# ---------------------------------------------------------------- free bodies until something moves them


def _stack() -> dict[str, Any]:
    return {f"b{k}": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1 + 0.2 * k)) for k in range(3)}


def _slides(begin: int, z: float, step: float = 0.02) -> tuple[Any, Any]:
    away = step * np.maximum(0, np.arange(FRAMES) - begin)
    return np.column_stack([away, 0 * away, 0 * away + z]), IDENTITY


def test_a_stack_whose_supports_were_left_out_may_not_fall_unnoticed(tmp_path: Path) -> None:
    things = {"floor": ground(), **_stack()}
    assert {r.status for r in rows_of(tmp_path / "a", things, {}).values()} == {"pass"}
    row = rows_of(tmp_path / "b", things, {"b2": _slides(6, 0.5)})["support:stays:b2"]
    assert (row.status, row.first_failing_frame, row.bound) == ("fail", 7, 0.005)
    assert row.measured == pytest.approx(0.02)
    assert [c.group for c in row.corrections] == ["placement", "interval", "story", "drivers"]


def test_supports_over_a_few_frames_do_not_hide_a_later_fall(tmp_path: Path) -> None:
    relation = {"on": Supports(a="b1", b="b2", frames=(0, 3))}
    rows = rows_of(tmp_path, {"floor": ground(), **_stack()}, {"b2": _slides(6, 0.5)}, relations=relation)
    assert rows["support:on:b2"].status == "pass"
    assert rows["support:stays:b2"].status == "fail"


def _beat(subject: str, first: int) -> dict[str, Beat]:
    move = Displacement(entity=subject, min=0.1)
    return {"goes": Beat(text="it goes", owner="rigid", subject=subject, frames=(first, FRAMES - 1), predicate=move)}


def test_what_a_beat_moves_carries_along_what_it_touches(tmp_path: Path) -> None:
    """The middle box is pulled out, as its beat says: the one on it may fall from then on, not before."""
    things = {"floor": ground(), **_stack()}
    tracks = {"b1": _slides(8, 0.3), "b2": _slides(9, 0.5)}
    rows = rows_of(tmp_path / "a", things, tracks, beats=_beat("b1", 8))
    assert rows["support:scene"].status == "pass"
    assert "support:stays:b1" not in rows
    early = {"b1": _slides(8, 0.3), "b2": _slides(4, 0.5)}
    assert rows_of(tmp_path / "b", things, early, beats=_beat("b1", 8))["support:stays:b2"].first_failing_frame == 5


def test_what_only_stands_on_the_same_floor_moves_nothing(tmp_path: Path) -> None:
    far = {"pushed": box(0.2, 0.2, 0.2, motion="dynamic", at=(2, 0, 0.1))}
    tracks = {"pushed": (_slides(2, 0.1)[0] + np.array([2, 0, 0]), IDENTITY), "b2": _slides(6, 0.5)}
    rows = rows_of(tmp_path, {"floor": ground(), **_stack(), **far}, tracks, beats=_beat("pushed", 2))
    assert rows["support:stays:b2"].status == "fail"


def test_welded_blocks_that_hang_on_nothing_are_held_by_nothing(tmp_path: Path) -> None:
    joints = {"w": WeldJoint(parent="b1", child="b2", anchor=(0, 0, 0.4))}
    tracks = {"b1": _slides(6, 0.3), "b2": _slides(6, 0.5)}
    rows = rows_of(tmp_path, {"floor": ground(), **_stack()}, tracks, joints=joints)
    assert rows["support:stays:b1"].status == rows["support:stays:b2"].status == "fail"


# ---------------------------------------------------------------- until when a support holds


def test_a_support_ends_with_the_beat_that_moves_what_it_hangs_on() -> None:
    """A lamp on a rope on an arm that is jointed to a mast that stands on a cart, which the beat moves."""
    rope = Rope(points=[(0, 0, 0), (0, 0, -1)], radius=0.01, segments=4, attach_start="arm", attach_end="lamp")
    free = {n: box(0.1, 0.1, 0.1, motion="dynamic") for n in ("cart", "mast", "arm", "lamp", "other")}
    things = {"floor": ground(), **free, "rope": entity(rope=rope, motion="dynamic")}
    joints = {"j": HingeJoint(parent="mast", child="arm", anchor=(0, 0, 0), axis=(0, 0, 1))}
    relations = {"r": Supports(a="cart", b="mast")}
    spec = world(things, joints=joints, relations=relations, beats=_beat("cart", 10), frames=FRAMES)

    def until(a: str, b: str) -> int:
        return support.support_interval(spec, Supports(a=a, b=b))[1]

    assert [until("floor", n) for n in ("cart", "mast", "arm", "rope", "lamp")] == [9] * 5
    assert until("floor", "other") == FRAMES - 1
    # What opens does not carry away what it hangs on.
    opened = world(things, joints=joints, relations=relations, beats=_beat("arm", 10), frames=FRAMES)
    assert support.support_interval(opened, Supports(a="cart", b="mast"))[1] == FRAMES - 1
    assert support.support_interval(opened, Supports(a="rope", b="lamp"))[1] == 9


def test_a_path_goes_on_holding_what_it_holds_and_a_beat_that_says_stay_moves_nothing() -> None:
    things = {"floor": ground(), "lift": box(1, 1, 0.1, motion="kinematic"), "crate": box(0.1, 0.1, 0.1, motion="dynamic")}
    relation = Supports(a="lift", b="crate")
    spec = world(things, relations={"r": relation}, beats=_beat("lift", 10), frames=FRAMES)
    assert support.support_interval(spec, relation) == (0, FRAMES - 1)
    stays = {"s": Beat(text="x", owner="rigid", subject="crate", frames=(2, 9), predicate=StaysIn(entity="crate", region="r"))}
    region = {"r": BoxRegion(min=(-1, -1, -1), max=(1, 1, 1))}
    spec = world(things, relations={"r": relation}, beats=stays, regions=region, frames=FRAMES)
    assert support.support_interval(spec, relation) == (0, FRAMES - 1)

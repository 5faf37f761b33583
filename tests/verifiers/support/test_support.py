"""Support: contact, chain, creep, balance, and the rows that no edit removes (R92, R93, R154)."""

from __future__ import annotations

import math

import jsonpatch
import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, build_all, entity, ground, make_candidate, pose, world
from worldagent.verifiers.support import check as support
from worldagent.worlds.predicates import Count, Displacement, Speed, StaysIn, Topples
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import (
    BallJoint,
    Beat,
    Box,
    BoxRegion,
    DetachDriver,
    ForceDriver,
    Part,
    ReleaseDriver,
    RigidPhysics,
    Rope,
    SpringJoint,
    Supports,
    WeldJoint,
    WorldSpec,
)

FRAMES = 24


def rows_of(tmp_path, entities, tracks=None, **more) -> dict[str, Row]:
    spec = world(entities, frames=FRAMES, **more)
    return {r.id: r for r in support.check(make_candidate(tmp_path, spec, tracks=tracks))}


def crate(z=0.1, x=0.0, **more):
    return box(0.2, 0.2, 0.2, motion="dynamic", at=(x, 0, z), **more)


def on(a="floor", b="crate", **more):
    return {"on": Supports(a=a, b=b, **more)}


@pytest.mark.parametrize("gap", [0.0, 0.0003, 0.0029])
def test_a_crate_on_the_floor_is_supported(tmp_path, gap):
    rows = rows_of(tmp_path, {"floor": ground(), "crate": crate(0.1 + gap)}, relations=on())
    assert {r.status for r in rows.values()} == {"pass"}
    row = rows["support:on:crate"]
    assert row.measured == pytest.approx(gap, abs=1e-12)
    assert row.bound == 0.003
    assert row.evidence["chain"] == ["crate", "floor"]
    assert "support:derived:crate" not in rows


@pytest.mark.parametrize("gap", [0.0031, 0.05, 1.0])
def test_a_floating_crate_fails_and_the_patch_puts_it_down(tmp_path, gap):
    spec = world({"floor": ground(), "crate": crate(0.1 + gap)}, relations=on())
    row = {r.id: r for r in support.check(make_candidate(tmp_path, spec))}["support:on:crate"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(gap)
    assert (row.first_failing_entity, row.first_failing_frame) == ("crate", 0)
    data = jsonpatch.apply_patch(spec.model_dump(mode="json"), list(row.corrections[0].patch))
    mended = WorldSpec.model_validate(data)
    assert mended.entities["crate"].pose.position[2] == pytest.approx(0.1001, abs=2e-5)
    assert {r.status for r in support.check(make_candidate(tmp_path, mended))} == {"pass"}


def test_overlap_is_no_support(tmp_path):
    row = rows_of(tmp_path, {"floor": ground(), "crate": crate(0.099)}, relations=on())["support:on:crate"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(-0.001)


def test_a_wall_beside_a_crate_does_not_carry_it(tmp_path):
    things = {"floor": ground(), "wall": box(0.1, 1, 1, at=(-0.15, 0, 0.5)), "crate": crate(0.1)}
    row = rows_of(tmp_path, things, relations=on("wall"))["support:on:crate"]
    assert row.status == "fail"
    assert "beneath" in row.evidence["explanation"]
    things["crate"] = crate(0.7)
    assert rows_of(tmp_path, things)["support:derived:crate"].status == "fail"


def test_a_crate_under_its_carrier_is_not_carried(tmp_path):
    things = {"floor": ground(), "shelf": box(1, 1, 0.02, at=(0, 0, 0.7101)), "crate": crate(0.6)}
    row = rows_of(tmp_path, things, relations=on("shelf"))["support:on:crate"]
    assert row.status == "fail"
    assert "chain" not in row.evidence or row.evidence["chain"] == []


def test_leaning_bodies_are_supported(tmp_path):
    tilt = math.radians(20)
    length, thick = 1.0, 0.02
    plank = box(
        thick,
        0.1,
        length,
        motion="dynamic",
        at=(
            -(length / 2) * math.sin(tilt) - thick / 2 * math.cos(tilt),
            0,
            (length / 2) * math.cos(tilt) + thick / 2 * math.sin(tilt),
        ),
        euler=(0, tilt, 0),
    )
    things = {"floor": ground(), "wall": box(0.1, 1, 3, at=(0.05 + 1e-9, 0, 1.5)), "plank": plank}
    rows = rows_of(tmp_path, things, relations=on("floor", "plank"))
    assert rows["support:on:plank"].status == "pass"
    assert rows["support:balance:plank"].status == "pass"
    del things["wall"]
    rows = rows_of(tmp_path, things, relations=on("floor", "plank"))
    assert rows["support:balance:plank"].status == "fail"
    assert rows["support:balance:plank"].measured == pytest.approx(0.5 * math.sin(tilt) - 0.01 * math.cos(tilt), abs=0.01)


def test_a_chain_leads_through_a_stack_and_breaks_with_it(tmp_path):
    things = {"floor": ground(), "a": crate(0.1), "b": crate(0.3001), "c": crate(0.5002)}
    relations = {"ab": Supports(a="a", b="b"), "bc": Supports(a="b", b="c"), "fa": Supports(a="floor", b="a")}
    rows = rows_of(tmp_path, things, relations=relations)
    assert {r.status for r in rows.values()} == {"pass"}
    assert rows["support:bc:c"].evidence["chain"] == ["c", "b", "a", "floor"]
    things["a"] = crate(0.1, x=1.0)
    rows = rows_of(tmp_path, things, relations=relations)
    assert rows["support:ab:b"].status == "fail"
    broken = rows["support:bc:c"]
    assert broken.status == "fail"
    assert "no chain" in broken.evidence["explanation"]


def test_support_is_judged_over_its_interval_only(tmp_path):
    x = np.zeros(FRAMES)
    x[12:] = np.linspace(0.01, 2, FRAMES - 12)
    tracks = {"crate": (np.column_stack([x, 0 * x, 0 * x + 0.1]), IDENTITY)}
    things = {"floor": ground(1.2), "crate": crate(0.1)}
    row = rows_of(tmp_path, things, tracks, relations=on())["support:on:crate"]
    assert (row.status, row.first_failing_frame) == ("fail", 12)
    assert row.frames == (0, FRAMES - 1)
    row = rows_of(tmp_path, things, tracks, relations=on(frames=(0, 11)))["support:on:crate"]
    assert row.status == "pass"
    beat = {
        "go": Beat(text="it goes", owner="rigid", subject="crate", frames=(12, 20), predicate=Displacement(entity="crate", min=1))
    }
    row = rows_of(tmp_path, things, tracks, relations=on(), beats=beat)["support:on:crate"]
    assert (row.status, row.frames) == ("pass", (0, 11))


@pytest.mark.parametrize(("creep", "status"), [(0.0049, "pass"), (0.0051, "fail")])
def test_creep_beyond_the_limit_fails(tmp_path, creep, status):
    x = np.linspace(0, creep, FRAMES)
    tracks = {"crate": (np.column_stack([x, 0 * x, 0 * x + 0.1]), IDENTITY)}
    row = rows_of(tmp_path, {"floor": ground(), "crate": crate(0.1)}, tracks, relations=on())["support:on:crate"]
    assert row.status == status
    if status == "fail":
        assert row.measured == pytest.approx(creep)
        assert row.first_failing_frame == FRAMES - 1
        assert row.corrections[0].group == "material"


def test_what_begins_with_a_speed_is_not_told_to_rub_more(tmp_path):
    """A ball that was placed on a landing and then given a velocity was told to raise its friction."""
    moves = {"crate": (np.column_stack([np.linspace(0, 0.3, FRAMES), np.zeros(FRAMES), np.full(FRAMES, 0.1)]), IDENTITY)}
    thrown = crate(physics=RigidPhysics(linear_velocity=(1.2, 0, 0)))
    row = rows_of(tmp_path, {"floor": ground(), "crate": thrown}, relations=on(), tracks=moves)["support:on:crate"]
    assert row.status == "fail"
    assert "begins with 1.2 m/s" in row.corrections[0].cause
    assert "/entities/crate/physics/linear_velocity" in row.corrections[0].pointers
    ended = rows_of(tmp_path / "ended", {"floor": ground(), "crate": thrown}, relations=on(frames=(0, 0)), tracks=moves)
    assert ended["support:on:crate"].status == "pass", "what it advises helps"


def test_creep_is_measured_against_the_carrier(tmp_path):
    x = np.linspace(0, 1, FRAMES)
    tracks = {
        "cart": (np.column_stack([x, 0 * x, 0 * x + 0.05]), IDENTITY),
        "crate": (np.column_stack([x, 0 * x, 0 * x + 0.2001]), IDENTITY),
    }
    things = {"floor": ground(), "cart": box(0.4, 0.4, 0.1, motion="kinematic", at=(0, 0, 0.05)), "crate": crate(0.2001)}
    assert rows_of(tmp_path, things, tracks, relations=on("cart"))["support:on:crate"].status == "pass"


def test_one_lifted_frame_fails(tmp_path):
    z = np.full(FRAMES, 0.1)
    z[9] = 0.1035
    tracks = {"crate": (np.column_stack([0 * z, 0 * z, z]), IDENTITY)}
    row = rows_of(tmp_path, {"floor": ground(), "crate": crate(0.1)}, tracks, relations=on())["support:on:crate"]
    assert (row.status, row.first_failing_frame) == ("fail", 9)
    assert row.measured == pytest.approx(0.0035)


@pytest.mark.parametrize(("reach", "status"), [(0.0, "pass"), (0.0995, "pass"), (0.103, "fail"), (0.15, "fail")])
def test_overhang_beyond_the_edge_fails(tmp_path, reach, status):
    things = {"floor": ground(), "table": box(1, 1, 0.7, at=(0, 0, 0.35)), "crate": crate(0.8, x=0.4 + reach)}
    rows = rows_of(tmp_path, things, relations=on("table"))
    row = rows["support:balance:crate"]
    assert rows["support:on:crate"].status == "pass"
    assert row.status == status
    assert row.measured == pytest.approx(reach - 0.1, abs=1e-9)
    if status == "fail":
        assert row.corrections[0].patch[0]["value"]["position"][0] < 0.4 + reach - 0.002


def test_a_ball_and_a_table_stand_balanced(tmp_path):
    legs = [Part(shape=Box(size=(0.05, 0.05, 0.7)), pose=pose((x, y, 0.35))) for x in (-0.4, 0.4) for y in (-0.2, 0.2)]
    table = entity(Part(shape=Box(size=(1, 0.6, 0.04)), pose=pose((0, 0, 0.72))), *legs, motion="dynamic")
    things = {"floor": ground(), "crate": table, "ball": ball(0.1, motion="dynamic", at=(2, 0, 0.1))}
    rows = rows_of(tmp_path, things, relations={**on(), "b": Supports(a="floor", b="ball")})
    assert {r.status for r in rows.values()} == {"pass"}
    assert rows["support:balance:crate"].measured == pytest.approx(-0.225)


def test_free_bodies_get_a_row_without_any_relation(tmp_path):
    things = {"floor": ground(), "crate": crate(0.1), "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.6))}
    rows = rows_of(tmp_path, things)
    assert rows["support:derived:crate"].status == "pass"
    row = rows["support:derived:ball"]
    assert row.status == rows["support:scene"].status == "fail"
    assert row.measured == pytest.approx(0.5, abs=1e-3)
    assert row.evidence["beneath"] == "floor"
    assert row.corrections[1].patch[0]["value"]["position"][2] == pytest.approx(0.1001, abs=1e-3)
    assert row.corrections[0].group == "drivers"


HOLDS = {
    "release": {"drivers": {"d": ReleaseDriver(entity="ball", time=0.5)}},
    "joint": {"joints": {"j": BallJoint(child="ball", anchor=(1, 0, 2))}},
    "spring": {"joints": {"j": SpringJoint(child="ball", parent_point=(1, 0, 2), child_point=(1, 0, 0.7), stiffness=100)}},
    "thrust": {"drivers": {"d": ForceDriver(entity="ball", force=(0, 0, 24.5), end=1)}},
    "weightless": {"gravity": (0, 0, 0)},
}


MOVES = {"moves": Beat(text="it moves", owner="rigid", subject="ball", frames=(1, 9), predicate=Speed(entity="ball", min=0.1))}


@pytest.mark.parametrize("name", HOLDS)
def test_a_declared_hold_explains_a_body_in_the_air(tmp_path, name):
    things = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.6))}
    assert rows_of(tmp_path, things, beats=MOVES, **HOLDS[name])["support:derived:ball"].status == "pass"


@pytest.mark.parametrize(("speed", "status"), [(3.0, "pass"), (0.05, "fail")])
def test_only_a_real_launch_explains_a_body_in_the_air(tmp_path, speed, status):
    things = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.6), velocity=(speed, 0, 0))}
    assert rows_of(tmp_path, things, beats=MOVES)["support:derived:ball"].status == status


def test_what_no_beat_tells_of_is_neither_let_go_nor_launched(tmp_path):
    """A ball that hangs over the floor until the film has ended: a driver holds it, and the story knows nothing of that."""
    things = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.6))}
    row = rows_of(tmp_path, things, **HOLDS["release"])["support:derived:ball"]
    assert row.status == "fail"
    assert "driver 'd' lets it go at 0.5 s, and no beat tells of it" in row.evidence["explanation"]
    things["ball"] = ball(0.1, motion="dynamic", at=(1, 0, 0.6), velocity=(3, 0, 0))
    row = rows_of(tmp_path, things)["support:derived:ball"]
    assert row.status == "fail"
    assert "it starts with a velocity, and no beat tells of it" in row.evidence["explanation"]


def test_what_is_held_untold_holds_nothing_either(tmp_path):
    things = {"floor": ground(), "lower": crate(1.0), "crate": crate(1.2001)}
    hold = {"d": ReleaseDriver(entity="lower", time=0.5)}
    rows = rows_of(tmp_path, things, drivers=hold)
    assert rows["support:derived:lower"].status == rows["support:derived:crate"].status == "fail"
    falls = Beat(text="it falls", owner="rigid", subject="lower", frames=(12, 15), predicate=Speed(entity="lower", min=0.1))
    rows = rows_of(tmp_path, things, drivers=hold, beats={"falls": falls})
    assert rows["support:derived:lower"].status == rows["support:derived:crate"].status == "pass"


def test_no_drag_holds_a_body_up(tmp_path):
    """Launched with 0.11 m/s in a drag of 1e6 N s/m a steel ball hangs still."""
    things = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.6), velocity=(0.11, 0, 0))}
    physics = things["ball"].physics.model_copy(update={"linear_damping": 1e6})
    things["ball"] = things["ball"].model_copy(update={"physics": physics})
    row = rows_of(tmp_path, things, beats=MOVES)["support:derived:ball"]
    assert row.status == "fail"
    assert "a drag of 1e+06 N s/m holds it up" in row.evidence["explanation"]


def test_a_slight_drag_is_not_blamed_for_a_throw_that_is_too_slow(tmp_path):
    things = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.6), velocity=(0.05, 0, 0))}
    physics = things["ball"].physics.model_copy(update={"linear_damping": 0.01})
    things["ball"] = things["ball"].model_copy(update={"physics": physics})
    row = rows_of(tmp_path, things, beats=MOVES)["support:derived:ball"]
    assert row.status == "fail"
    assert "drag" not in row.evidence["explanation"]


@pytest.mark.parametrize(("gap", "status"), [(0.0, "pass"), (0.26, "fail")])
def test_parts_of_what_moves_hang_together(tmp_path, gap, status):
    """Two plates of a table with nothing between them."""
    plates = [Part(shape=Box(size=(0.4, 0.4, 0.04)), pose=pose((0, 0, z))) for z in (0.02, 0.06 + gap)]
    things = {"floor": ground(), "table": entity(*plates, motion="dynamic", at=(0, 0, 1e-4))}
    row = rows_of(tmp_path, things)["support:piece:table"]
    assert row.status == status
    if status == "fail":
        assert (row.measured, row.unit) == (2.0, "pieces")
        assert row.corrections[0].pointers[0] in ("/entities/table/parts/p0/pose", "/entities/table/parts/p1/pose")


def test_a_feeble_force_does_not(tmp_path):
    things = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.6))}
    force = {"drivers": {"d": ForceDriver(entity="ball", force=(0, 0, 10.0), end=1)}}
    assert rows_of(tmp_path, things, **force)["support:derived:ball"].status == "fail"


def test_two_floating_bodies_cannot_hold_each_other(tmp_path):
    things = {"floor": ground(), "a": crate(1.0), "b": crate(1.2)}
    rows = rows_of(tmp_path, things)
    assert rows["support:derived:a"].status == rows["support:derived:b"].status == "fail"
    welded = {"j": WeldJoint(parent="a", child="b", anchor=(0, 0, 1.1))}
    rows = rows_of(tmp_path, things, joints=welded)
    assert rows["support:derived:a"].status == rows["support:derived:b"].status == "fail"


def test_a_pendulum_hangs_on_its_rope(tmp_path):
    rope = Rope(points=[(0, 0, 1), (0, 0, 0.5)], radius=0.01, segments=5, attach_start="beam", attach_end="bob")
    things = {
        "beam": box(1, 0.1, 0.1, at=(0, 0, 1.05)),
        "rope": entity(rope=rope, motion="dynamic"),
        "bob": ball(0.1, motion="dynamic", at=(0, 0, 0.39)),
    }
    rows = rows_of(tmp_path, things)
    assert rows["support:derived:bob"].status == rows["support:derived:rope"].status == "pass"
    assert rows["support:derived:bob"].evidence["chain"] == ["bob", "rope", "beam"]


def test_a_joint_counts_as_a_link_until_it_is_detached(tmp_path):
    things = {"beam": box(1, 0.1, 0.1, at=(0, 0, 1.05)), "crate": crate(0.5)}
    weld = {"w": WeldJoint(parent="beam", child="crate", anchor=(0, 0, 0.8))}
    rows = rows_of(tmp_path, things, {}, relations=on("beam"), joints=weld)
    assert rows["support:on:crate"].status == "pass"
    assert "support:balance:crate" not in rows
    cut = {"c": DetachDriver(joint="w", time=0.5)}
    row = rows_of(tmp_path, things, {}, relations=on("beam"), joints=weld, drivers=cut)["support:on:crate"]
    assert (row.status, row.first_failing_frame) == ("fail", 13)


def test_the_default_interval_ends_before_a_beat_moves_the_body(tmp_path):
    things = {"floor": ground(), "crate": crate(0.1), "d": crate(0.1, x=1)}
    relation = Supports(a="floor", b="d")

    def interval(predicate):
        beat = Beat(text="x", owner="rigid", subject="crate", frames=(10, 20), predicate=predicate)
        return support.support_interval(world(things, beats={"b": beat}, frames=FRAMES), relation)

    assert interval(Count(entities=["crate", "d"], predicate=Topples(entity="each"), min=2)) == (0, 9)
    assert interval(Topples(entity="crate")) == (0, FRAMES - 1)
    assert interval(StaysIn(entity="d", region="r")) == (0, FRAMES - 1)


def test_intervals_beyond_the_stage_have_no_row_until_the_bake(tmp_path):
    things = {"floor": ground(), "crate": crate(0.1)}
    late = on(frames=(12, 20))
    assert "support:on:crate" not in rows_of(tmp_path, things, relations=late)
    assert rows_of(tmp_path, things, relations=late)["support:derived:crate"].status == "pass"
    assert rows_of(tmp_path, things, {}, relations=late)["support:on:crate"].status == "pass"


def test_no_free_body_is_not_applicable(tmp_path):
    rows = rows_of(tmp_path, {"floor": ground()}, regions={"r": BoxRegion(min=(0, 0, 0), max=(1, 1, 1))})
    assert [r.status for r in rows.values()] == ["not_applicable"]


def test_missing_geometry_and_broken_poses_never_pass(tmp_path):
    things = {"floor": ground(), "crate": crate(0.1)}
    spec = world(things, relations=on(), frames=FRAMES)
    candidate = make_candidate(tmp_path, spec)
    built = build_all(spec)
    del built["floor"]
    object.__setattr__(candidate, "built", built)
    rows = {r.id: r for r in support.check(candidate)}
    assert rows["support:on:crate"].status == rows["support:scene"].status == "unverified"
    z = np.full(FRAMES, 0.1)
    z[5:] = np.nan
    row = rows_of(tmp_path, things, {"crate": (np.column_stack([0 * z, 0 * z, z]), IDENTITY)}, relations=on())["support:on:crate"]
    assert (row.status, row.first_failing_frame) == ("fail", 5)


def test_broken_support_at_the_last_frame_only_is_found(tmp_path):
    z = np.full(FRAMES, 0.1)
    z[-1] = 0.2
    row = rows_of(
        tmp_path,
        {"floor": ground(), "crate": crate(0.1)},
        {"crate": (np.column_stack([0 * z, 0 * z, z]), IDENTITY)},
        relations=on(),
    )["support:on:crate"]
    assert (row.status, row.first_failing_frame) == ("fail", FRAMES - 1)


def test_a_drawer_in_a_tight_chest_is_carried(tmp_path):
    chest = entity(
        Part(shape=Box(size=(0.4, 0.4, 0.02)), pose=pose((0, 0, 0.01))),
        Part(shape=Box(size=(0.4, 0.4, 0.02)), pose=pose((0, 0, 0.132))),
    )
    things = {"floor": ground(), "chest": chest, "drawer": box(0.3, 0.3, 0.1, motion="dynamic", at=(0, 0, 0.0705))}
    assert rows_of(tmp_path, things, relations=on("chest", "drawer"))["support:on:drawer"].status == "pass"


@pytest.mark.parametrize(("gap", "first"), [(0.05, "placement"), (0.6, "drivers")])
def test_what_hangs_higher_than_it_is_large_is_held_before_it_is_placed(tmp_path, gap, first):
    things = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1 + gap))}
    row = rows_of(tmp_path, things)["support:derived:ball"]
    assert row.status == "fail"
    assert row.corrections[0].group == first
    assert {c.group for c in row.corrections} == {"placement", "drivers"}

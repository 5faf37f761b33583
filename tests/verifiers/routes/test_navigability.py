"""Navigability: traversable routes over visible surfaces, with width, headroom, slope and step (R94, R95)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import ball, box, entity, make_candidate, pose, world
from worldagent.verifiers.routes import bounds, navigability
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, BoxRegion, Connects, CylinderRegion, Extrusion, Part, Wedge

NOISE = bounds.RASTER_NOISE


def slab(x0, x1, y0, y1, top=0.0, thick=0.2, **more):
    return box(x1 - x0, y1 - y0, thick, at=((x0 + x1) / 2, (y0 + y1) / 2, top - thick / 2), **more)


def block(x0, x1, y0, y1, z0, z1, **more):
    middle = ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
    return Part(shape=Box(size=(x1 - x0, y1 - y0, z1 - z0)), pose=pose(middle), **more)


def wall_with_door(width=1.0, height=2.1, *, at=0.0, thick=0.1, middle=0.0, tall=2.6):
    """A wall in the plane x = at over y = -2..2 with a door."""
    left, right = middle - width / 2, middle + width / 2
    parts = [
        block(at, at + thick, -2, left, 0, tall),
        block(at, at + thick, right, 2, 0, tall),
        block(at, at + thick, left, right, height, tall),
    ]
    return entity(*parts)


ROOM = {"floor": slab(-3, 3, -2, 2)}
REGIONS = {"a": BoxRegion(min=(-2.8, -1, 0), max=(-1.8, 1, 1)), "b": BoxRegion(min=(1.8, -1, 0), max=(2.8, 1, 1))}


def row_of(tmp_path, entities, *, regions=REGIONS, relation=None, tracks=None, frames=4, **connect) -> Row:
    connects = relation or Connects(a="a", b="b", **connect)
    spec = world(entities, regions=regions, relations={"way": connects}, frames=frames)
    rows = navigability.check(make_candidate(tmp_path, spec, tracks=tracks))
    assert [r.id for r in rows] == ["navigability:way"]
    return rows[0]


def test_an_open_floor_is_a_route(tmp_path):
    row = row_of(tmp_path, ROOM)
    assert row.status == "pass"
    assert row.measured == pytest.approx(1.6)  # clearances are measured up to twice the width
    route = np.array(row.evidence["route"])
    assert route[0][0] <= -1.8
    assert route[-1][0] >= 1.8
    assert row.evidence["route_length_m"] == pytest.approx(3.6, abs=0.15)


@pytest.mark.parametrize("width", [0.8, 0.81, 0.837, 1.0, 1.2])
@pytest.mark.parametrize("middle", [0.0, 0.333])
def test_the_width_of_a_door_is_measured(tmp_path, width, middle):
    row = row_of(tmp_path, {**ROOM, "wall": wall_with_door(width, middle=middle)})
    assert row.status == "pass"
    assert row.measured == pytest.approx(width, abs=0.003)
    assert abs(row.evidence["narrowest_place"][0] - 0.05) < 0.1
    assert row.evidence["narrowest_place"][1] == pytest.approx(middle, abs=0.02)


@pytest.mark.parametrize("width", [0.3, 0.6, 0.79])
def test_a_narrow_door_fails_with_its_width_and_names_the_wall(tmp_path, width):
    row = row_of(tmp_path, {**ROOM, "wall": wall_with_door(width)})
    assert row.status == "fail"
    assert row.evidence["reason"] == "too narrow"
    assert row.measured == pytest.approx(width, abs=0.003)
    assert row.bound == pytest.approx(0.8 - NOISE)
    assert row.first_failing_entity == "wall"
    assert row.corrections[0].edit_class == "scene"


def test_thin_walls_are_not_missed(tmp_path):
    pane = entity(block(0.012, 0.015, -2, -0.3, 0, 2.6), block(0.012, 0.015, 0.3, 2, 0, 2.6))
    row = row_of(tmp_path, {**ROOM, "pane": pane})
    assert row.status == "fail"
    assert row.measured == pytest.approx(0.6, abs=0.003)


def test_a_door_turned_against_the_grid_is_measured(tmp_path):
    turn = math.radians(27)
    wall = wall_with_door(0.9).model_copy(update={"pose": pose((0, 0, 0), euler=(0, 0, turn))})
    row = row_of(
        tmp_path,
        {"floor": slab(-3, 3, -1.7, 1.7), "wall": wall},
        regions={"a": BoxRegion(min=(-2.8, -1, 0), max=(-2.0, 1, 1)), "b": BoxRegion(min=(2.0, -1, 0), max=(2.8, 1, 1))},
    )
    assert row.status == "pass"
    assert row.measured == pytest.approx(0.9, abs=0.006)


def test_a_crate_in_the_doorway_blocks_it_and_is_named(tmp_path):
    things = {**ROOM, "wall": wall_with_door(1.0), "crate": box(0.9, 0.96, 1.0, at=(0, 0, 0.5001))}
    row = row_of(tmp_path, things)
    assert row.status == "fail"
    assert row.evidence["reason"] == "blocked"
    assert row.entities == ("crate",)
    assert row.measured == 0.0
    del things["crate"]
    assert row_of(tmp_path, things).status == "pass"


def test_a_chair_beside_the_doorway_narrows_it(tmp_path):
    things = {**ROOM, "wall": wall_with_door(1.0), "chair": box(0.5, 0.5, 0.9, at=(-0.3, 0.45, 0.4502))}
    row = row_of(tmp_path, things)
    assert row.status == "fail"
    assert row.measured == pytest.approx(0.7, abs=0.01)
    assert set(row.entities) == {"wall", "chair"}


def test_a_dynamic_body_in_the_way_counts_at_the_checked_frames(tmp_path):
    things = {**ROOM, "wall": wall_with_door(1.0), "crate": box(0.9, 0.96, 1.0, motion="dynamic", at=(-2.9, 1.5, 0.5001))}
    x = np.array([-2.9, -2.0, -1.0, 0.0])
    y = np.array([1.5, 1.0, 0.5, 0.0])
    tracks = {"crate": (np.column_stack([x, y, 0 * x + 0.5001]), (1, 0, 0, 0))}
    regions = {"a": BoxRegion(min=(-1.4, -1.9, 0), max=(-0.7, -1, 1)), "b": REGIONS["b"]}
    assert row_of(tmp_path, things, tracks=tracks, regions=regions).status == "pass"
    later = Connects(a="a", b="b", frames=(0, 3))
    row = row_of(tmp_path, things, tracks=tracks, regions=regions, relation=later)
    assert (row.status, row.first_failing_frame, row.first_failing_entity) == (
        "fail",
        2,
        "crate",
    )  # already then the crate leaves 0.55 m before the wall
    early = row_of(tmp_path, things, regions=regions, relation=later)
    assert early.status == "pass"


@pytest.mark.parametrize(("height", "status"), [(2.0, "pass"), (2.001, "pass"), (1.98, "fail"), (1.5, "fail"), (0.9, "fail")])
def test_a_low_lintel_fails_with_its_height(tmp_path, height, status):
    row = row_of(tmp_path, {**ROOM, "wall": wall_with_door(1.0, height)})
    assert row.status == status
    if status == "fail":
        assert row.evidence["reason"] == "too low"
        assert row.measured == pytest.approx(height, abs=1e-6)
        assert (row.bound, row.first_failing_entity) == (2.0, "wall")


def test_a_beam_across_the_room_is_too_low(tmp_path):
    row = row_of(tmp_path, {**ROOM, "beam": box(0.2, 4, 0.2, at=(0, 0, 1.6))})
    assert row.evidence["reason"] == "too low"
    assert row.measured == pytest.approx(1.5, abs=1e-6)
    assert row.first_failing_entity == "beam"


def ramp(angle, rise=0.8, wide=1.6):
    run = rise / math.tan(angle)
    return {
        "floor": slab(-4, 0, -2, 2),
        "ramp": entity(Wedge(size=(run, wide, rise)), at=(run / 2, 0, rise / 2), euler=(0, 0, math.pi)),
        "deck": slab(run, run + 3, -2, 2, top=rise, thick=0.1),
    }, {"a": BoxRegion(min=(-2, -1, 0), max=(-1, 1, 1)), "b": BoxRegion(min=(run + 1, -1, rise), max=(run + 2, 1, rise + 1))}


@pytest.mark.parametrize(("angle", "status"), [(0.3, "pass"), (0.595, "pass"), (0.61, "fail"), (0.9, "fail")])
def test_a_steep_ramp_fails_with_its_slope(tmp_path, angle, status):
    things, regions = ramp(angle)
    row = row_of(tmp_path, things, regions=regions)
    assert row.status == status
    if status == "pass":
        assert row.measured == pytest.approx(1.6, abs=0.02)
    else:
        assert row.evidence["reason"] == "too steep"
        assert row.measured == pytest.approx(angle, abs=1e-3)
        assert row.first_failing_entity == "ramp"


def test_a_narrow_ramp_without_rails_is_too_narrow(tmp_path):
    things, regions = ramp(0.3, wide=0.7)
    row = row_of(tmp_path, things, regions=regions)
    assert row.evidence["reason"] == "too narrow"
    assert row.measured == pytest.approx(0.7, abs=0.02)


def stairs(riser, going=0.28, count=5, wide=1.2):
    parts = [block(k * going, (k + 1) * going, -wide / 2, wide / 2, 0, (k + 1) * riser) for k in range(count)]
    end, top = count * going, count * riser
    return {
        "floor": slab(-4, 6, -2, 2),
        "stairs": entity(*parts),
        "deck": slab(end, end + 3, -1.9, 1.9, top=top, thick=0.05),
    }, {"a": BoxRegion(min=(-2, -1, 0), max=(-1, 1, 0.5)), "b": BoxRegion(min=(end + 1, -1, top), max=(end + 2, 1, top + 0.5))}


@pytest.mark.parametrize(("riser", "status"), [(0.17, "pass"), (0.2, "pass"), (0.205, "fail"), (0.3, "fail")])
def test_stairs_pass_until_a_riser_is_too_high(tmp_path, riser, status):
    things, regions = stairs(riser)
    row = row_of(tmp_path, things, regions=regions)
    assert row.status == status
    if status == "pass":
        assert row.measured == pytest.approx(1.2, abs=0.01)
        assert np.array(row.evidence["route"])[-1][2] == pytest.approx(5 * riser)
    else:
        assert row.evidence["reason"] == "step too high"
        assert row.measured == pytest.approx(riser, abs=1e-6)
        assert row.first_failing_entity == "stairs"


def test_malformed_stairs_with_tiny_treads_are_too_steep(tmp_path):
    things, regions = stairs(0.18, going=0.08, count=8)
    row = row_of(tmp_path, things, regions=regions)
    assert row.status == "fail"
    assert row.evidence["reason"] == "too steep"
    assert row.first_failing_entity in {"stairs", "deck", "floor"}


def test_an_oversized_threshold_fails(tmp_path):
    things = {**ROOM, "wall": wall_with_door(1.0, 2.4), "sill": box(0.1, 1.0, 0.25, at=(0.05, 0, 0.125))}
    row = row_of(tmp_path, things)
    assert row.evidence["reason"] == "step too high"
    assert row.measured == pytest.approx(0.25)
    assert row.first_failing_entity == "sill"
    things["sill"] = box(0.1, 1.0, 0.18, at=(0.05, 0, 0.09))
    assert row_of(tmp_path, things).status == "pass"


@pytest.mark.parametrize(("gap", "status"), [(0.003, "pass"), (0.04, "pass"), (0.3, "fail"), (1.0, "fail")])
def test_a_gap_in_the_floor_fails_and_a_crack_does_not(tmp_path, gap, status):
    row = row_of(tmp_path, {"left": slab(-3, 0, -2, 2), "right": slab(gap, 3, -2, 2)})
    assert row.status == status
    if status == "fail":
        assert row.evidence["reason"] == "gap"
        assert row.measured == pytest.approx(gap, abs=0.1)


def test_a_pit_narrows_the_way(tmp_path):
    pit = {
        "west": slab(-3, -0.5, -2, 2),
        "east": slab(0.5, 3, -2, 2),
        "bridge": slab(-0.5, 0.5, -0.35, 0.35),
    }
    row = row_of(tmp_path, pit)
    assert row.evidence["reason"] == "too narrow"
    assert row.measured == pytest.approx(0.7, abs=0.01)
    pit["bridge"] = slab(-0.5, 0.5, -0.41, 0.41)
    assert row_of(tmp_path, pit).status == "pass"


def test_two_storeys_share_a_column(tmp_path):
    things, regions = stairs(0.18, count=12)
    things["floor"] = slab(-4, 8, -2, 2)
    below = {"a": regions["a"], "b": BoxRegion(min=(4.5, -1, 0), max=(5.5, 1, 0.5))}
    over = row_of(tmp_path, things, regions=regions)
    assert over.status == "pass"
    under = row_of(tmp_path, things, regions=below)
    assert under.status == "pass"
    assert max(p[2] for p in under.evidence["route"]) < 0.3
    assert max(p[2] for p in over.evidence["route"]) == pytest.approx(12 * 0.18)


def test_a_walker_does_not_pass_under_a_table_nor_over_it(tmp_path):
    table = entity(block(-0.5, 0.5, -2, 2, 0.7, 0.75), block(-0.5, -0.45, -2, -1.95, 0, 0.7), block(0.45, 0.5, 1.95, 2, 0, 0.7))
    row = row_of(tmp_path, {**ROOM, "table": table})
    assert row.status == "fail"
    assert row.first_failing_entity == "table"
    low = row_of(tmp_path, {**ROOM, "table": table}, carrier="object", width=0.2, headroom=0.5, max_step=0.02)
    assert low.status == "pass"


def test_the_inside_of_a_thick_wall_is_no_way(tmp_path):
    things = {**ROOM, "wall": box(0.5, 4, 3, at=(0, 0, 1.5))}
    inside = {"a": BoxRegion(min=(-0.2, -1.5, 0), max=(0.2, -1, 1)), "b": BoxRegion(min=(-0.2, 1, 0), max=(0.2, 1.5, 1))}
    row = row_of(tmp_path, things, regions=inside)
    assert row.status == "fail"
    assert row.evidence["reason"] == "no floor"
    row = row_of(tmp_path, things)
    assert row.evidence["reason"] == "blocked"
    assert row.first_failing_entity == "wall"


def test_waypoints_are_passed(tmp_path):
    row = row_of(tmp_path, ROOM, waypoints=[(0.0, 1.5)])
    assert row.status == "pass"
    assert np.array(row.evidence["route"])[:, 1].max() > 1.0
    things = {
        **ROOM,
        "pen": entity(block(-0.6, 0.6, 0.8, 0.9, 0, 1), block(-0.6, -0.5, 0.9, 2, 0, 1), block(0.5, 0.6, 0.9, 2, 0, 1)),
    }
    assert row_of(tmp_path, things).status == "pass"
    assert row_of(tmp_path, things, waypoints=[(0.0, 1.5)]).status == "fail"


def test_a_ball_rolls_down_a_chute(tmp_path):
    chute = {
        "bed": box(2, 0.3, 0.02, at=(0, 0, 0.5), euler=(0, 0.2, 0)),
        "left": box(2, 0.01, 0.1, at=(0, 0.145, 0.55), euler=(0, 0.2, 0)),
        "right": box(2, 0.01, 0.1, at=(0, -0.145, 0.55), euler=(0, 0.2, 0)),
    }
    regions = {
        "a": CylinderRegion(center=(-0.8, 0, 0.7), radius=0.05, height=0.2),
        "b": CylinderRegion(center=(0.8, 0, 0.4), radius=0.05, height=0.2),
    }
    row = row_of(tmp_path, chute, regions=regions, carrier="object", width=0.1, headroom=0.1, max_slope=0.5, max_step=0.005)
    assert row.status == "pass"
    chute["stop"] = box(0.02, 0.26, 0.1, at=(0.3, 0, 0.5))
    row = row_of(tmp_path, chute, regions=regions, carrier="object", width=0.1, headroom=0.1, max_slope=0.5, max_step=0.005)
    assert (row.status, row.first_failing_entity) == ("fail", "stop")


def test_regions_without_floor_fail_and_regions_can_ride_on_entities(tmp_path):
    far = {"a": REGIONS["a"], "b": BoxRegion(min=(1.8, -1, 3), max=(2.8, 1, 4))}
    row = row_of(tmp_path, ROOM, regions=far)
    assert (row.status, row.evidence["reason"]) == ("fail", "no floor")
    mat = {**ROOM, "mat": box(0.8, 0.8, 0.01, at=(2, 0, 0.0051))}
    on = {"a": REGIONS["a"], "b": BoxRegion(min=(-0.3, -0.3, 0), max=(0.3, 0.3, 0.5), relative_to="mat")}
    row = row_of(tmp_path, mat, regions=on)
    assert row.status == "pass"
    assert row.evidence["route"][-1][0] == pytest.approx(1.72, abs=0.05)


def test_no_connection_is_not_applicable(tmp_path):
    rows = navigability.check(make_candidate(tmp_path, world(ROOM)))
    assert [(r.id, r.status) for r in rows] == [("navigability:scene", "not_applicable")]


def leaf_at(turns):
    """Motion of a leaf hung at (0, -0.5, 0), turned about z."""
    half = 0.5 * np.asarray(turns, dtype=float)
    zero = np.zeros(len(half))
    return np.tile([0.0, -0.5, 0.0], (len(half), 1)), np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)


@pytest.mark.parametrize(("angle", "clear"), [(0.0, 0.0), (0.6, math.sin(0.6)), (1.2, math.sin(1.2)), (1.6, 1.0)])
def test_a_door_is_judged_as_far_as_it_is_open_at_the_demanded_frames(tmp_path, angle, clear):
    leaf = entity(block(0, 0.04, 0, 1.0, 0.005, 2.0), motion="dynamic", at=(0, -0.5, 0))
    things = {**ROOM, "wall": wall_with_door(1.0, at=-0.05, thick=0.05), "door": leaf}
    tracks = {"door": leaf_at([0.0, -angle / 2, -angle, -angle])}
    asked = Connects(a="a", b="b", frames=(2, 3))
    row = row_of(tmp_path, things, tracks=tracks, relation=asked)
    assert row.status == ("pass" if clear >= 0.8 else "fail")
    assert row.measured == pytest.approx(clear, abs=0.003)
    if clear < 0.8:
        assert "door" in row.entities
    assert navigability.check(make_candidate(tmp_path, world(things, regions=REGIONS, relations={"way": asked}))) == []


def test_a_door_that_is_shut_for_one_frame_between_fails_there(tmp_path):
    leaf = entity(block(0, 0.04, 0, 1.0, 0.005, 2.0), motion="dynamic", at=(0, -0.5, 0))
    things = {**ROOM, "wall": wall_with_door(1.0, at=-0.05, thick=0.05), "door": leaf}
    tracks = {"door": leaf_at([-1.6] * 5 + [-0.2] + [-1.6] * 4)}
    row = row_of(tmp_path, things, tracks=tracks, frames=10, relation=Connects(a="a", b="b", frames=(0, 9)))
    assert (row.status, row.first_failing_frame) == ("fail", 5)


def test_what_travels_is_not_in_its_own_way(tmp_path):
    chute = {
        "bed": slab(-1, 1, -0.15, 0.15),
        "left": box(2, 0.01, 0.1, at=(0, 0.145, 0.05)),
        "right": box(2, 0.01, 0.1, at=(0, -0.145, 0.05)),
        "ball": ball(0.05, motion="dynamic", at=(-0.95, 0, 0.05)),
    }
    ends = {n: CylinderRegion(center=(x, 0, 0.1), radius=0.08, height=0.2) for n, x in (("a", -0.75), ("b", 0.75))}
    tracks = {"ball": (np.column_stack([np.linspace(-0.95, 0.95, 8), np.zeros(8), np.full(8, 0.05)]), (1, 0, 0, 0))}
    asked = Connects(a="a", b="b", carrier="object", width=0.14, headroom=0.14, max_step=0.01, frames=(0, 7))
    assert row_of(tmp_path, chute, regions=ends, tracks=tracks, frames=8, relation=asked).status == "pass"
    stuck = {"ball": (np.tile([0.0, 0.0, 0.05], (8, 1)), (1, 0, 0, 0))}
    row = row_of(tmp_path, chute, regions=ends, tracks=stuck, frames=8, relation=asked)
    assert row.status == "fail"
    assert "ball" in row.entities


def test_floor_that_is_only_drawn_carries_nobody(tmp_path):
    pit = {"west": slab(-3, -0.5, -2, 2), "east": slab(0.5, 3, -2, 2)}
    drawn = entity(block(-0.6, 0.6, -2, 2, -0.05, 0.001, collides=False))
    row = row_of(tmp_path, {**pit, "bridge": drawn})
    assert (row.status, row.evidence["reason"]) == ("fail", "gap")
    rug = entity(block(-0.6, 0.6, -1, 1, 0.0001, 0.01, collides=False))
    assert row_of(tmp_path, {**ROOM, "rug": rug}).status == "pass"


@pytest.mark.parametrize(("gap", "status"), [(0.046, "pass"), (0.051, "fail"), (0.068, "fail")])
@pytest.mark.parametrize("angle", [0.0, math.pi / 4, 0.4])
def test_cracks_have_one_bound_at_every_angle_to_the_grid(tmp_path, gap, status, angle):
    turned = {"euler": (0, 0, angle)}
    things = {
        "west": entity(block(-3, 0, -1.2, 1.2, -0.2, 0), **turned),
        "east": entity(block(gap, 3, -1.2, 1.2, -0.2, 0), **turned),
    }
    regions = {n: BoxRegion(min=(x, -0.8, 0), max=(x + 1, 0.8, 1), relative_to="west") for n, x in (("a", -2.6), ("b", 1.6))}
    assert row_of(tmp_path, things, regions=regions).status == status


def test_a_step_in_the_bend_of_two_slopes_is_measured(tmp_path):
    for kerb, status in ((0.0, "pass"), (0.015, "pass"), (0.03, "fail")):
        profile = [(0.0, -0.1), (1.0, -0.1), (1.0, 0.5 + kerb), (0.0, kerb)]
        ramp = Part(shape=Extrusion(polygon=profile, height=2.4), pose=pose((0, 0, 0), euler=(math.pi / 2, 0, 0)))
        things = {"floor": slab(-3, 0, -1.2, 1.2), "ramp": entity(ramp), "deck": slab(1, 4, -1.2, 1.2, top=0.5 + kerb)}
        regions = {"a": REGIONS["a"], "b": BoxRegion(min=(2, -1, 0.5), max=(3, 1, 1))}
        asked = {"carrier": "object", "width": 0.8, "headroom": 1.0, "max_slope": 0.5, "max_step": 0.02}
        assert row_of(tmp_path, things, regions=regions, **asked).status == status


def test_a_thin_sill_is_measured_and_named(tmp_path):
    row = row_of(tmp_path, {**ROOM, "blade": box(0.002, 4, 0.21, at=(0.013, 0, 0.105))})
    assert (row.status, row.evidence["reason"], row.entities) == ("fail", "step too high", ("blade",))
    assert row.measured == pytest.approx(0.21)


def test_a_region_that_reaches_through_a_wall_starts_on_its_own_side(tmp_path):
    through = {"a": BoxRegion(min=(-2.8, -1, 0), max=(0.9, 1, 1)), "b": REGIONS["b"]}
    row = row_of(tmp_path, {**ROOM, "wall": box(0.1, 4, 2.6, at=(0, 0, 1.3))}, regions=through)
    assert (row.status, row.first_failing_entity) == ("fail", "wall")


def test_the_profile_of_the_route_is_reported(tmp_path):
    things, regions = stairs(0.17)
    row = row_of(tmp_path, {**things, "beam": box(0.1, 4, 0.1, at=(-0.6, 0, 2.3))}, regions=regions)
    assert row.status == "pass"
    assert row.evidence["headroom_m"] == pytest.approx(2.25)
    assert row.evidence["lowest_place"][0] == pytest.approx(-0.6, abs=0.1)
    assert row.evidence["highest_step_m"] == pytest.approx(0.17)
    assert row.evidence["steepest_rad"] == 0.0


def test_too_large_an_area_is_unverified_with_the_reason(tmp_path):
    things = {"floor": slab(-2000, 2000, -2000, 2000)}
    regions = {"a": BoxRegion(min=(-1900, 0, 0), max=(-1899, 1, 1)), "b": BoxRegion(min=(1899, 0, 0), max=(1900, 1, 1))}
    row = row_of(tmp_path, things, regions=regions)
    assert row.status == "unverified"
    assert "too coarse" in row.evidence["explanation"]


def test_small_things_on_the_floor_are_stepped_over(tmp_path):
    row = row_of(
        tmp_path,
        {
            **ROOM,
            "wall": wall_with_door(0.85),
            "pebble": ball(0.03, at=(0.05, 0.1, 0.03)),
            "rug": slab(-1, 1, -0.4, 0.4, top=0.01, thick=0.0099),
        },
    )
    assert row.status == "pass"
    assert row.measured == pytest.approx(0.85, abs=0.003)


def test_a_long_way_round_is_found(tmp_path):
    things = {"floor": slab(-3, 3, -2, 14), "wall": box(0.1, 14, 2.5, at=(0, 5, 1.25))}
    row = row_of(tmp_path, things)
    assert row.status == "pass"
    assert row.evidence["route_length_m"] > 20.0
    assert not row.evidence["search_clipped"]


# ---------------------------------------------------------------- who walks


@pytest.mark.parametrize(
    ("easier", "measured", "bound", "comparison"),
    [
        ({"width": 0.1}, 0.1, 0.51, ">="),
        ({"headroom": 1.2}, 1.2, 1.88, ">="),
        ({"max_step": 5.0}, 5.0, 0.22, "<="),
        ({"max_slope": 1.2}, 1.2, 0.6, "<="),
    ],
)
def test_a_walker_is_no_smaller_than_a_person(tmp_path, easier, measured, bound, comparison):
    """Choice: measures of the 95th percentile of men; a way that anyone could take does not help."""
    row = row_of(tmp_path, ROOM, **easier)
    assert (row.status, row.measured, row.bound, row.comparison) == ("fail", measured, bound, comparison)
    assert row.evidence["reason"] == "no person"
    (hint,) = row.corrections
    mended = {p["path"].rpartition("/")[2]: p["value"] for p in hint.patch}
    assert row_of(tmp_path / "mended", ROOM, **{**easier, **mended}).status == "pass"


def test_a_walker_0_1_m_wide_with_steps_of_5_m_is_named_as_what_it_is(tmp_path):
    walker = {"width": 0.1, "headroom": 1.8, "max_step": 5.0}
    row = row_of(tmp_path / "a", ROOM, **walker)
    assert row.status == "fail"
    assert "a carrier of 0.1 m x 1.8 m with steps of 5 m, not a person" in row.evidence["explanation"]
    assert "a carrier of 0.1 m x 1.8 m with steps of 5 m, not a person gets from a to b" in row.predicate
    allowed = row_of(tmp_path / "b", ROOM, carrier="object", **walker)
    assert allowed.status == "pass"
    assert "not a person" in allowed.predicate
    assert "not a person" not in row_of(tmp_path / "c", ROOM, carrier="object", width=0.6, headroom=2.0).predicate

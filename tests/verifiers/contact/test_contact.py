"""Contact: visible surfaces over all written frames, and bodies that skip through between frames (R108, R109)."""

from __future__ import annotations

import time

import numpy as np
import pytest
from worldagent.testing.defects._motion import Track, candidate_of, pieces, turn_of
from worldagent.testing.worlds.small_worlds import IDENTITY, Touch, ball, box, entity, ground, make_candidate, world
from worldagent.verifiers.contact import check as contact
from worldagent.worlds.arrays import rotation_matrix
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, Fastened, HingeJoint, Part, PathDriver, PathKey, Pose, Rope

FRAMES = 24


def rows_of(tmp_path, entities, tracks, *, frames=FRAMES, touches=(), channels=None, without=(), **more) -> dict[str, Row]:
    spec = world(entities, frames=frames, **more)
    candidate = make_candidate(tmp_path, spec, tracks=tracks, touches=touches, channels=channels, without=without)
    return {r.id: r for r in contact.check(candidate)}


def failing(rows: dict[str, Row]) -> set[str]:
    return {i for i, r in rows.items() if r.status != "pass"}


def spin(angle, axis=(0, 1, 0)):
    angle = np.asarray(angle, dtype=float)
    return np.concatenate([np.cos(angle / 2)[:, None], np.sin(angle / 2)[:, None] * np.array(axis, dtype=float)], axis=1)


def fall(z):
    return np.column_stack([np.zeros(len(z)), np.zeros(len(z)), z])


SCENE = {"floor": ground(), "b": ball(0.1, motion="dynamic", at=(0, 0, 0.5))}


def test_a_ball_that_comes_to_rest_exactly_on_the_floor_passes(tmp_path):
    z = np.maximum(0.1, 0.5 - 0.5 * 9.81 * (np.arange(FRAMES) / 24) ** 2)
    rows = rows_of(tmp_path, SCENE, {"b": (fall(z), IDENTITY)})
    assert failing(rows) == set()
    assert rows["contact:floor:b"].measured == pytest.approx(0.0, abs=2e-3)
    assert rows["contact:scene"].evidence["frames"] == FRAMES


@pytest.mark.parametrize("depth", [1e-6, 1e-3, 0.05])
def test_one_overlapping_frame_fails_with_its_depth(tmp_path, depth):
    things = {"floor": ground(), "b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))}
    z = np.full(FRAMES, 0.1)
    z[13] -= depth
    rows = rows_of(tmp_path, things, {"b": (fall(z), IDENTITY)}, touches=[Touch(13, "floor", "b", min_gap=-2 * depth)])
    row = rows["contact:floor:b"]
    assert row.status == rows["contact:scene"].status == "fail"
    assert row.measured == pytest.approx(-depth, rel=1e-6)
    assert (row.first_failing_entity, row.first_failing_frame) == ("b", 13)
    assert rows["contact:scene"].first_failing_frame == 13
    assert row.evidence["frames_overlapping"] == 1
    assert row.evidence["peak_inside_frames_m"] == pytest.approx(-2 * depth)
    assert {c.edit_class for c in row.corrections} == {"solver"}
    skins = [c for c in row.corrections if c.group == "contact"]
    # A wider skin is only offered while two skins stay within the contact tolerance of 3 mm.
    assert bool(skins) == (depth < 1e-4)
    for skin in skins:
        assert f"{depth * 1e3:.4g} mm" in skin.action
        assert skin.patch[0]["value"] == pytest.approx(5e-4 + 1.5 * depth, abs=1.1e-5)


def test_sinking_for_frames_is_called_tunnelling(tmp_path):
    z = np.full(FRAMES, 0.1)
    z[10:] = -0.05
    rows = rows_of(
        tmp_path, {"floor": ground(), "b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))}, {"b": (fall(z), IDENTITY)}
    )
    row = rows["contact:floor:b"]
    assert row.evidence["tunnelling"]
    assert row.corrections[0].group == "step"
    assert {"op": "add", "path": "/simulation/solvers/rigid/settings/speculative", "value": True} in row.corrections[0].patch


def test_moving_pairs_are_inspected(tmp_path):
    things = {
        "floor": ground(),
        "a": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.05)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(1, 0, 0.05)),
    }
    x = np.linspace(1, 0.101, FRAMES)
    rows = rows_of(tmp_path, things, {"b": (np.column_stack([x, 0 * x, 0 * x + 0.05]), IDENTITY)})
    assert failing(rows) == set()
    x = np.linspace(1, 0.095, FRAMES)
    rows = rows_of(tmp_path, things, {"b": (np.column_stack([x, 0 * x, 0 * x + 0.05]), IDENTITY)})
    assert failing(rows) == {"contact:scene", "contact:a:b"}
    assert rows["contact:a:b"].measured == pytest.approx(-0.005)
    assert rows["contact:a:b"].first_failing_frame == FRAMES - 1


def test_a_corner_that_turns_into_the_floor_fails_at_the_right_frame(tmp_path):
    angle = np.linspace(0, np.pi / 2, FRAMES)
    height = 0.1 * (np.cos(angle) + np.sin(angle))
    things = {"floor": ground(), "b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))}
    assert failing(rows_of(tmp_path, things, {"b": (fall(height + 1e-9), spin(angle))})) == set()
    rows = rows_of(tmp_path, things, {"b": (fall(0 * height + 0.1), spin(angle))})
    assert rows["contact:floor:b"].first_failing_frame == 1
    assert rows["contact:floor:b"].measured == pytest.approx(0.1 - height.max(), rel=1e-6)


def test_declared_overlap_and_joints(tmp_path):
    things = {
        "post": box(0.1, 0.1, 1, at=(0, 0, 0.5)),
        "arm": box(0.4, 0.05, 0.05, motion="dynamic", at=(0.2, 0, 0.5)),
    }
    hinge = {"h": HingeJoint(parent="post", child="arm", anchor=(0, 0, 0.5), axis=(0, 1, 0))}
    row = rows_of(tmp_path, things, {}, joints=hinge)["contact:post:arm"]
    assert row.status == "fail"
    assert row.corrections[0].group == "joints"
    fastened = {"f": Fastened(a="post", b="arm", max_depth=0.051, reason="the arm turns inside the post")}
    row = rows_of(tmp_path, things, {}, joints=hinge, relations=fastened)["contact:post:arm"]
    assert row.status == "pass"
    assert row.bound == pytest.approx(-0.051)


def test_a_part_that_does_not_collide_is_named(tmp_path):
    things = {
        "floor": ground(),
        "b": entity(Part(shape=Box(size=(0.2, 0.2, 0.2)), collides=False), motion="dynamic", at=(0, 0, 0.1)),
    }
    z = np.full(FRAMES, 0.1)
    z[5:] = 0.05
    correction = rows_of(tmp_path, things, {"b": (fall(z), IDENTITY)})["contact:floor:b"].corrections[0]
    assert (correction.edit_class, correction.group) == ("scene", "shape")
    assert correction.patch == ({"op": "add", "path": "/entities/b/parts/p0/collides", "value": True},)


def test_an_authored_path_through_a_wall_fails(tmp_path):
    things = {"wall": box(0.1, 1, 1), "cart": box(0.2, 0.2, 0.2, motion="kinematic", at=(-1, 0, 0))}
    keys = {"a": PathKey(time=0, pose=Pose(position=(-1, 0, 0))), "b": PathKey(time=1, pose=Pose(position=(1, 0, 0)))}
    x = np.linspace(-1, 1, FRAMES)
    track = {"cart": (np.column_stack([x, 0 * x, 0 * x]), IDENTITY)}
    row = rows_of(tmp_path, things, track, drivers={"go": PathDriver(entity="cart", keys=keys)})["contact:wall:cart"]
    assert row.status == "fail"
    assert row.corrections[0].group == "drivers"
    assert row.first_failing_frame == int(np.flatnonzero(x > -0.15)[0])


def test_a_fast_ball_that_skips_a_thin_plate_fails(tmp_path):
    things = {"plate": box(2, 2, 0.01), "b": ball(0.02, motion="dynamic", at=(0, 0, 1))}
    z = 1.0 - 0.3 * np.arange(FRAMES)
    rows = rows_of(tmp_path, things, {"b": (fall(z), IDENTITY)})
    assert failing(rows) == {"contact:scene", "contact:through:b:plate"}
    row = rows["contact:through:b:plate"]
    assert row.first_failing_frame == 4
    x, y, z = row.evidence["point"]
    assert np.hypot(x, y) <= 0.02
    assert abs(z) <= 0.005 + 1e-9
    assert row.measured > row.bound == pytest.approx(0.0025)
    assert row.evidence["felt"] is False
    assert row.corrections[0].group == "step"


def test_fast_bounces_and_jumps_over_an_edge_are_no_passages(tmp_path):
    things = {"plate": box(2, 2, 0.01), "b": ball(0.02, motion="dynamic", at=(0, 0, 0.4))}
    z = np.abs(0.4 - 0.3 * np.arange(FRAMES) - 0.025) + 0.025
    velocity = np.zeros((FRAMES, 1, 3))
    velocity[:, 0, 2] = np.where(0.4 - 0.3 * np.arange(FRAMES) > 0.025, -7.2, 7.2)
    rows = rows_of(tmp_path, things, {"b": (fall(z), IDENTITY)}, channels={"velocity": velocity})
    assert failing(rows) == set()
    hill = {"hill": box(0.05, 2, 0.5), "b": ball(0.02, motion="dynamic", at=(-0.2, 0, 0.2))}
    time_ = np.arange(FRAMES) / 24
    x, z = -0.2 + 9.6 * time_, 0.2 + 5.5 * time_ - 60 * time_**2
    track = np.column_stack([x, 0 * x, z])
    velocity[:, 0] = np.column_stack([0 * x + 9.6, 0 * x, 5.5 - 120 * time_])
    rows = rows_of(tmp_path, hill, {"b": (track, IDENTITY)}, channels={"velocity": velocity})
    assert rows["contact:scene"].evidence["fast_moves"] > 0
    assert "contact:through:b:hill" not in rows


def test_broken_poses_never_pass(tmp_path):
    z = np.full(FRAMES, 0.5)
    z[7:] = np.nan
    rows = rows_of(tmp_path, SCENE, {"b": (fall(z), IDENTITY)})
    scene = rows["contact:scene"]
    assert scene.status == "fail"
    assert (scene.first_failing_entity, scene.first_failing_frame) == ("b", 7)
    rows = rows_of(tmp_path, SCENE, {"b": (fall(np.full(FRAMES, 0.5)), (0.5, 0, 0, 0))})
    assert rows["contact:scene"].status == "fail"


def test_missing_channels_and_short_caches_are_unverified(tmp_path):
    tracks = {"b": (fall(np.full(FRAMES, 0.5)), IDENTITY)}
    assert rows_of(tmp_path, SCENE, tracks, without=["quaternion"])["contact:scene"].status == "unverified"
    spec = world(SCENE, frames=FRAMES)
    candidate = make_candidate(tmp_path / "a", spec, tracks=tracks)
    candidate.caches["rigid"].path(11).unlink()
    assert contact.check(candidate)[0].status == "unverified"
    short = make_candidate(tmp_path / "b", spec, tracks=tracks)
    object.__setattr__(short, "spec", world(SCENE, frames=FRAMES + 1))
    assert contact.check(short)[0].status == "unverified"
    assert contact.check(make_candidate(tmp_path / "c", spec))[0].status == "unverified"


def test_a_moving_entity_without_cache_is_unverified(tmp_path):
    spec = world(SCENE, frames=FRAMES)
    candidate = make_candidate(tmp_path, spec, tracks={"b": (fall(np.full(FRAMES, 0.5)), IDENTITY)})
    more = {**SCENE, "c": ball(0.1, motion="dynamic", at=(2, 0, 0.5))}
    wider = world(more, frames=FRAMES)
    object.__setattr__(candidate, "spec", wider)
    object.__setattr__(candidate, "built", make_candidate(tmp_path / "x", wider).built)
    assert contact.check(candidate)[0].status == "unverified"


def test_the_missing_contact_log_does_not_decide(tmp_path):
    rows = rows_of(tmp_path, SCENE, {"b": (fall(np.full(FRAMES, 0.1)), IDENTITY)}, without=["contact/min_gap"])
    assert rows["contact:floor:b"].status == "pass"
    assert "peak_inside_frames_m" not in rows["contact:floor:b"].evidence


def test_two_hundred_dominoes_are_verified_in_seconds(tmp_path):
    frames, count, depth = 240, 200, 0.0
    things = {"g": box(20, 2, 0.2, at=(5, 0, -0.1))}
    tracks = {}
    for i in range(count):
        angle = np.clip((np.arange(frames) - i) / 10, 0, 1) * 0.38
        c, s = np.cos(angle), np.sin(angle)
        x, z = 0.03 * i + 0.005 - 0.005 * c + 0.024 * s, 0.024 * c + 0.005 * s + 0.0002 - depth
        things[f"d{i}"] = box(0.01, 0.024, 0.048, motion="dynamic", at=(0.03 * i, 0, 0.0242))
        tracks[f"d{i}"] = (np.column_stack([x, 0 * x, z]), spin(angle))
    candidate = make_candidate(tmp_path, world(things, frames=frames), tracks=tracks)
    begin = time.process_time()
    rows = contact.check(candidate)
    assert time.process_time() - begin < 10.0
    assert len(rows) > count
    assert {r.status for r in rows} == {"pass"}


def bar(width=0.01):
    return {"post": box(0.02, 0.02, 0.5, at=(0.5, 0, 0)), "blade": box(2.0, width, 0.05, motion="dynamic")}


def spinning(turn, start):
    """A blade about z that turns by `turn` [rad] per frame; its spin is logged, whole turns included."""
    angle = start + turn * np.arange(FRAMES)
    rate = np.zeros((FRAMES, 1, 3))
    rate[:, 0, 2] = turn * 24
    return {"tracks": {"blade": (np.zeros((FRAMES, 3)), spin(angle, (0, 0, 1)))}, "channels": {"angular_velocity": rate}}


def test_a_blade_that_turns_through_a_post_between_frames_fails(tmp_path):
    rows = rows_of(tmp_path, bar(), **spinning(0.5, 0.25), gravity=(0, 0, 0))
    assert "contact:through:blade:post" in failing(rows)


def test_whole_turns_between_frames_are_known_from_the_spin(tmp_path):
    start = np.pi / 2
    rows = rows_of(tmp_path / "a", bar(), **spinning(2 * np.pi, start), gravity=(0, 0, 0))
    assert rows["contact:through:blade:post"].first_failing_frame == 1
    rows = rows_of(tmp_path / "b", bar(), **spinning(0.0, start), gravity=(0, 0, 0))
    assert failing(rows) == set()


def test_two_dynamic_bodies_that_swap_places_fail_and_those_that_rebound_do_not(tmp_path):
    things = {n: ball(0.05, motion="dynamic") for n in ("a", "b")}
    x = 0.2 * (np.arange(FRAMES) - 11.5)
    through = {n: (np.column_stack([s * x, 0 * x, 0 * x]), IDENTITY) for n, s in (("a", 1), ("b", -1))}
    velocity = np.zeros((FRAMES, 2, 3))
    velocity[:, 0, 0], velocity[:, 1, 0] = 4.8, -4.8
    rows = rows_of(tmp_path / "a", things, through, channels={"velocity": velocity}, gravity=(0, 0, 0))
    assert rows["contact:through:a:b"].first_failing_frame == 12
    away = np.abs(x) - 0.05
    back = {n: (np.column_stack([-s * (away + 0.1), 0 * x, 0 * x]), IDENTITY) for n, s in (("a", 1), ("b", -1))}
    velocity[12:] *= -1
    rows = rows_of(tmp_path / "b", things, back, channels={"velocity": velocity}, gravity=(0, 0, 0))
    assert failing(rows) == set()


def test_bodies_of_one_entity_are_compared_but_not_neighbours_of_a_rope(tmp_path):
    rope = Rope(points=[(0, 0, 0), (1, 0, 0)], radius=0.02, segments=8)
    things = {"floor": ground(), "rope": entity(rope=rope, motion="dynamic", at=(0, 0, 1))}
    assert failing(rows_of(tmp_path / "a", things, {})) == set()
    where = np.tile([15 / 16, 0.0, 1.0], (FRAMES, 1))
    where[7] = [3 / 16, 0, 1.03]
    track = {"rope/s7": (where, spin(np.full(FRAMES, np.pi / 2)))}
    row = rows_of(tmp_path / "b", things, track)["contact:rope:rope"]
    assert (row.status, row.first_failing_frame) == ("fail", 7)
    assert row.measured == pytest.approx(-0.01, rel=0.15)


# ---------------------------------------------------------------- pieces that move as one


def thrown_pieces(folder, seed, *, through=None, whole_turn=None) -> dict[str, Row]:
    """Rows of two flush pieces that are thrown with a spin, strike something half-way, and turn the other way from then on.

    Args:
        folder: of the candidate.
        seed: of sizes, spins and speeds.
        through: frame from which the second piece is on the far side of the first.
        whole_turn: frame up to which the second piece turned once more about its far end, through the first.
    """
    rng = np.random.default_rng(seed)
    size = rng.uniform(0.05, 0.15, size=3)
    thing = entity(
        *(Part(shape=Box(size=tuple(size)), pose=Pose(position=(k * size[0], 0, 0))) for k in (0, 1)),
        motion="dynamic",
        at=(0, 0, 2),
    )
    spec = world({"ground": ground(), "thing": thing}, frames=FRAMES, gravity=(0, 0, 0))
    rate = np.where(np.arange(FRAMES) < FRAMES // 2, 1.0, -0.6) * float(rng.uniform(8.0, 20.0))
    drift = np.where(np.arange(FRAMES)[:, None] < FRAMES // 2, 1.0, -0.5) * rng.uniform(-2.0, 2.0, size=3)
    angle, center = np.cumsum(rate) / 24, np.array([0, 0, 5.0]) + np.cumsum(drift, axis=0) / 24
    axis = np.array([0.0, 0.6, 0.8])
    quaternion, spins = turn_of(axis, angle), rate[:, None] * axis
    paths = {}
    for k in (0, 1):
        place = np.zeros((FRAMES, 3))
        place[:, 0] = (k - 0.5) * size[0]
        if k and through is not None:
            place[through:, 0] = -1.5 * size[0]
        arm = np.einsum("nij,nj->ni", rotation_matrix(quaternion), place)
        spin = spins.copy()
        if k and whole_turn is not None:
            spin[whole_turn - 1 : whole_turn + 1] += 2 * np.pi * 24 * axis
        paths[f"thing/p{k}"] = Track(center + arm, quaternion, drift + np.cross(spins, arm), spin)
    candidate = candidate_of(folder, spec, paths, built={"thing": pieces("thing", thing, spec)})
    return {r.id: r for r in contact.check(candidate)}


@pytest.mark.parametrize("seed", range(4))
def test_pieces_that_fly_spin_and_bounce_as_one_need_no_search(tmp_path, seed):
    rows = thrown_pieces(tmp_path, seed)
    assert failing(rows) == set()
    assert rows["contact:scene"].evidence["fast_moves"] == 0


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("frame", [3, FRAMES // 2 - 2, FRAMES - 1])
def test_a_piece_that_came_loose_and_went_through_its_neighbour_is_found(tmp_path, seed, frame):
    rows = thrown_pieces(tmp_path, seed, through=frame)
    assert rows["contact:scene"].status == "fail"
    assert rows["contact:scene"].first_failing_frame == frame
    assert failing(rows) == {"contact:scene", "contact:through:thing:thing"}


def test_a_piece_that_turns_once_more_than_its_neighbour_did_not_move_with_it(tmp_path):
    """Law: at both ends of the interval it stands as before; its recorded spin tells the whole turn between."""
    rows = thrown_pieces(tmp_path, 0, whole_turn=5)
    assert rows["contact:scene"].status == "fail"
    assert rows["contact:scene"].first_failing_frame == 5

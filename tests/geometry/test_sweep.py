"""Swept clearance between two known states: formulas, dense sampling, and what a path between two frames can hide."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from worldagent.geometry import (
    Motion,
    Solid,
    State,
    clearance_series,
    cut_thickness,
    lowest_clearance,
    lowest_clearances,
    wall_thickness,
)
from worldagent.geometry.clearance import Care, measure, relative_poses
from worldagent.geometry.motions import relative_travel
from worldagent.geometry.sweep import Sweep
from worldagent.worlds.arrays import rotation_matrix
from worldagent.worlds.errors import EvidenceError

from .meshes import ball, box, hull, ring, solid_of

UPRIGHT = np.array([[1.0, 0.0, 0.0, 0.0]])


def still(n=1, at=(0, 0, 0)):
    state = State(np.tile(np.array(at, dtype=float), (n, 1)), np.tile(UPRIGHT, (n, 1)))
    return Motion.between(state, state, np.zeros(3), 1.0)


def straight(start, end, *, v0=None, v1=None, duration=1.0):
    known = v0 is not None
    first = State(np.array([start], dtype=float), UPRIGHT, np.array([v0], dtype=float) if known else None)
    last = State(np.array([end], dtype=float), UPRIGHT, np.array([v1], dtype=float) if known else None)
    return Motion.between(first, last, np.zeros(3), duration)


def about_z(angle):
    return np.array([[math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)]])


def random_motion(rng, spread, n=1):
    quaternion = rng.normal(size=(2, n, 4))
    quaternion /= np.linalg.norm(quaternion, axis=-1, keepdims=True)
    position, velocity, spin = rng.normal(size=(2, n, 3)) * spread, rng.normal(size=(2, n, 3)) * 2, rng.normal(size=(2, n, 3)) * 4
    first = State(position[0], quaternion[0], velocity[0], spin[0])
    return Motion.between(first, State(position[1], quaternion[1], velocity[1], spin[1]), rng.normal(size=3) * 0.1, 1.0)


def test_a_way_without_end_is_refused_in_words():
    """Choice: a spin of 1e9 rad/s between two frames would ask for as many places."""
    spin = np.array([[0.0, 0.0, 1e9]])
    state = State(np.zeros((1, 3)), UPRIGHT, np.zeros((1, 3)), spin)
    motion = Motion.between(state, state, np.zeros(3), 1.0)
    one, two = solid_of(box(1, 1, 1)), solid_of(box(1, 1, 1))
    with pytest.raises(EvidenceError, match=r"two surfaces move by up to .* lower their speed or spin"):
        lowest_clearance(Sweep(one, motion, two, still(at=(2.0, 0, 0)), below=0.0, precision=1e-5))


def test_a_cubic_through_both_velocities_is_the_parabola_of_a_throw():
    g, v0, h = np.array([0, 0, -9.81]), np.array([1.0, 2.0, 3.0]), 0.5
    end = v0 * h + 0.5 * g * h * h
    motion = straight((0, 0, 0), end, v0=v0, v1=v0 + g * h, duration=h)
    for s in (0.2, 0.5, 0.9):
        expected = v0 * s * h + 0.5 * g * (s * h) ** 2
        assert motion.centers(np.array([s]))[0] == pytest.approx(expected, abs=1e-14)
    part = motion.restrict(0.3, 0.8)
    assert part.centers(np.array([0.5])) == pytest.approx(motion.centers(np.array([0.55])), abs=1e-14)


@pytest.mark.parametrize("turns", [-2.3, -0.7, 0.4, 1.0, 1.6, 3.0])
def test_the_known_spin_counts_whole_turns(turns):
    spin = np.array([[0, 0, 2 * math.pi * turns]])
    first = State(np.zeros((1, 3)), UPRIGHT, np.zeros((1, 3)), spin)
    last = State(np.zeros((1, 3)), about_z(2 * math.pi * turns), np.zeros((1, 3)), spin)
    motion = Motion.between(first, last, np.zeros(3), 1.0)
    assert motion.turn[0] == pytest.approx(spin[0], abs=1e-9)
    _, quarter = motion.at(np.array([0.25]))
    assert rotation_matrix(quarter) == pytest.approx(rotation_matrix(about_z(math.pi / 2 * turns)), abs=1e-9)


def ridden(carrier, rng):
    """Motion of another body that keeps its pose to `carrier`'s over the whole interval, up to the cubic between its ends."""
    offset, inner = rng.normal(size=3) * 0.5, rng.normal(size=3) * 0.1
    ends = []
    for s in (0.0, 1.0):
        position, quaternion = carrier.at(np.array([s]))
        center = carrier.centers(np.array([s]))
        turn = rotation_matrix(quaternion)
        place = position + turn @ offset
        rate = 3.0 * (
            carrier.control[:, 1] - carrier.control[:, 0] if s == 0.0 else carrier.control[:, 3] - carrier.control[:, 2]
        )
        velocity = rate + np.cross(carrier.turn, place + turn @ inner - center)
        ends.append(State(place, quaternion, velocity, carrier.turn))
    return Motion.between(ends[0], ends[1], inner, 1.0)


@pytest.mark.parametrize("together", [False, True])
def test_no_two_points_come_nearer_or_go_farther_than_the_travel_bound(together):
    """Law: along the line through both a distance changes as fast as the one body moves past the other at either end of it."""
    rng = np.random.default_rng(5)
    for _ in range(100):
        a = random_motion(rng, 0.5)
        b = ridden(a, rng) if together else random_motion(rng, 0.5)
        s, e = np.sort(rng.uniform(size=2))
        bound = relative_travel(a, 0.3, b, 0.2, np.array([s]), np.array([e]))[0]
        local_a, local_b = rng.normal(size=3), rng.normal(size=3)
        local_a *= 0.3 / np.linalg.norm(local_a)
        local_b *= 0.2 / np.linalg.norm(local_b)
        distances = []
        for t in np.linspace(s, e, 200):
            (pa, qa), (pb, qb) = a.at(np.array([t])), b.at(np.array([t]))
            x = rotation_matrix(qa[0]) @ (local_a + a.center) + pa[0]
            y = rotation_matrix(qb[0]) @ (local_b + b.center) + pb[0]
            distances.append(np.linalg.norm(x - y))
        assert np.abs(np.diff(distances)).sum() <= bound * (1 + 1e-9)


def test_no_clearance_or_depth_changes_by_more_than_the_travel_bound():
    rng, deepest = np.random.default_rng(11), 0.0
    shapes = [hull(rng), ring(), ball(0.3), box(1.0, 0.02, 0.3)]
    for i, j in ((0, 3), (3, 3), (2, 3), (1, 3), (0, 1)):
        a, b = shapes[i], shapes[j]
        one, two = random_motion(rng, 0.3), random_motion(rng, 0.3)
        radii = [np.linalg.norm(x.vertices - m.center, axis=1).max() for x, m in ((a, one), (b, two))]
        s = np.linspace(0, 1, 41)
        rows = np.zeros(len(s), dtype=int)
        series = clearance_series(a, one.take(rows).at(s), b, two.take(rows).at(s), skip_above=np.inf)
        bound = relative_travel(one.take(rows[:-1]), radii[0], two.take(rows[:-1]), radii[1], s[:-1], s[1:])
        error = 0.01 * np.maximum(0.0, -np.minimum(series[:-1], series[1:])) + 1e-9
        assert (np.abs(np.diff(series)) <= bound + 2 * error).all()
        deepest = min(deepest, series.min())
    assert deepest < -0.05


def test_bodies_that_turn_together_hardly_move_against_each_other():
    """Choice: a disc that turns by 0.1 rad a frame with a body 0.2 m off its axis, which the bound of two lone bodies puts at 0.06 m."""
    spin = np.array([[0, 0, 0.1]])
    ends = [State(np.zeros((1, 3)), about_z(x), np.zeros((1, 3)), spin) for x in (0.0, 0.1)]
    disc = Motion.between(ends[0], ends[1], np.zeros(3), 1.0)
    places = [np.array([[0.2 * math.cos(x), 0.2 * math.sin(x), 0.0]]) for x in (0.0, 0.1)]
    first, last = (State(p, e.quaternion, np.cross(spin, p), spin) for p, e in zip(places, ends, strict=True))
    rider = Motion.between(first, last, np.zeros(3), 1.0)
    assert relative_travel(disc, 0.3, rider, 0.3, np.zeros(1), np.ones(1))[0] < 1e-5
    assert relative_travel(disc, 0.3, still(at=(0.2, 0, 0)), 0.3, np.zeros(1), np.ones(1))[0] >= 0.1 * 0.2


def test_a_ball_through_a_plate_is_found_with_its_time_and_depth():
    sphere, plate = ball(0.02, 3), box(1, 1, 0.01)
    found = lowest_clearance(Sweep(sphere, straight((0, 0, 0.3), (0, 0, -0.5)), plate, still(), precision=1e-5))
    # Deepest while the middle of the ball lies within the plate.
    assert abs(0.3 - 0.8 * found.time[0]) <= 0.005 + 3e-4
    assert found.value[0] == pytest.approx(-0.02, abs=3e-4)


def test_bodies_that_pass_each_other_stay_apart():
    one, two = straight((-1, 0.201, 0), (1, 0.201, 0)), straight((1, 0, 0), (-1, 0, 0))
    apart = lowest_clearance(Sweep(ball(0.1), one, ball(0.1), still(), precision=1e-5), skip_above=np.inf)
    assert 0.0 < apart.value[0] < 0.01
    near = straight((-1, 0.05, 0), (1, 0.05, 0))
    assert lowest_clearance(Sweep(ball(0.1), near, ball(0.1), two, precision=1e-5)).value[0] < -0.05


@pytest.mark.parametrize("angle", [0.9, 2.5, 2 * math.pi, 5.0])
def test_a_turning_blade_strikes_a_post_at_the_angle_of_geometry(angle):
    """A bar of half length 1 and half width 0.01 turns about z; the post's near corner stands at 0.5 rad."""
    blade, post = box(2, 0.02, 0.1), box(0.02, 0.02, 1)
    spin = np.array([[0, 0, angle]])
    first = State(np.zeros((1, 3)), UPRIGHT, np.zeros((1, 3)), spin)
    motion = Motion.between(first, State(np.zeros((1, 3)), about_z(angle), np.zeros((1, 3)), spin), np.zeros(3), 1.0)
    place = (0.8 * math.cos(0.5), 0.8 * math.sin(0.5), 0)
    found = lowest_clearance(Sweep(blade, motion, post, still(at=place), precision=1e-5))
    corners = np.array([(place[0] + x, place[1] + y) for x in (-0.01, 0.01) for y in (-0.01, 0.01)])
    radius, polar = np.hypot(*corners.T), np.arctan2(corners[:, 1], corners[:, 0])
    first, last = (polar - np.arcsin(0.01 / radius)).min(), (polar + np.arcsin(0.01 / radius)).max()
    assert first <= (found.time[0] * angle) % math.pi <= last  # both halves of the bar come past
    assert found.value[0] == pytest.approx(-0.01, abs=2e-3)


def test_the_lowest_clearance_is_that_of_dense_sampling():
    rng = np.random.default_rng(3)
    shapes = [hull(rng), ring(), ball(0.3), box(1.0, 0.02, 0.3)]
    for i, j, fine, count in ((0, 3, 5e-3, 100), (3, 3, 5e-3, 100), (2, 3, 5e-3, 100), (1, 3, 0.1, 12)):
        a, b = shapes[i], shapes[j]
        one, two = random_motion(rng, 0.8), random_motion(rng, 0.8)
        low = lowest_clearance(Sweep(a, one, b, two, precision=fine), skip_above=np.inf)
        s = np.linspace(0, 1, count)
        rows = np.zeros(count, dtype=int)
        dense = clearance_series(a, one.take(rows).at(s), b, two.take(rows).at(s), skip_above=np.inf)
        assert low.value[0] <= dense.min() + fine + 0.011 * max(0.0, -dense.min())
        assert low.value[0] >= dense.min() - relative_travel(one, 1.0, two, 1.0, np.zeros(1), np.ones(1))[0] / (2 * count - 2)


def test_only_what_is_lower_than_wanted_is_searched():
    a, b = ball(0.1), ball(0.1)
    motion = straight((-1, 0.19, 0), (1, 0.19, 0))
    low = lowest_clearance(Sweep(a, motion, b, still(), below=-0.05, precision=1e-4))
    assert low.value[0] > -0.05
    assert lowest_clearance(Sweep(a, motion, b, still(), below=0.0, precision=1e-4)).value[0] < 0.0


def test_an_open_sheet_is_swept_too():
    sheet = solid_of(trimesh.Trimesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]), closed=False)
    found = lowest_clearance(Sweep(box(0.1, 0.1, 0.1), straight((0.3, 0, 1), (0.3, 0, -1)), sheet, still(), precision=1e-4))
    assert found.value[0] == pytest.approx(-0.05, abs=1e-3)


def test_walls_of_shells_are_thin_and_of_solids_thick():
    assert wall_thickness(box(1, 2, 0.01)) == pytest.approx(0.01)
    assert wall_thickness(ball(0.1, 3)) == pytest.approx(0.2, rel=0.02)
    assert wall_thickness(ring(0.5, 0.52, 0.3)) == pytest.approx(0.02, rel=0.1)
    sheet = solid_of(trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), closed=False)
    assert wall_thickness(sheet) == math.inf
    inverted = trimesh.creation.annulus(0.5, 0.52, 0.3, sections=10)
    inverted.invert()
    assert wall_thickness(solid_of(inverted)) == pytest.approx(0.02, rel=0.1)


def _prism(corners: list[tuple[float, float]]) -> Solid:
    """A convex plan (x, z) from y = 0 to 1."""
    points = np.array([(x, y, z) for y in (0.0, 1.0) for x, z in corners])
    return solid_of(trimesh.convex.convex_hull(points))


def test_an_oblique_cut_makes_no_wall_thinner_and_a_sliver_is_thin() -> None:
    """A plate of 10 mm, cut at 11 degrees to its surface, and split into two sheets on one side of the cut."""
    left = _prism([(0.0, 0.0), (0.50, 0.0), (0.45, 0.01), (0.0, 0.01)])
    under = _prism([(0.50, 0.0), (1.0, 0.0), (1.0, 0.009), (0.455, 0.009)])
    above = _prism([(0.455, 0.009), (1.0, 0.009), (1.0, 0.01), (0.45, 0.01)])
    assert cut_thickness([left, under, above]) == pytest.approx([0.01, 0.009, 0.001], rel=0.05)
    assert cut_thickness([left]) == pytest.approx([0.01], rel=0.05)


def test_what_is_shallower_than_of_interest_is_no_deeper_than_said_and_bodies_in_one_place_stay_deep():
    """Rings that overlap a little, a lot, in full and not at all, asked with and without a depth of no interest."""
    one = solid_of(ring())
    places = [(0.0, 0.0, z) for z in np.linspace(0.0, 1.0, 41)]
    poses = (np.array(places), np.tile(UPRIGHT, (len(places), 1)))
    exact = measure(one, one, relative_poses(poses, still(len(places)).at(np.zeros(len(places)))))
    idle = 0.5 * float(-exact[1:].min())
    told = measure(one, one, relative_poses(poses, still(len(places)).at(np.zeros(len(places)))), care=Care(idle=idle))
    deep, apart = exact < -idle * (1.0 + 0.01), exact > 0.0
    assert min(np.count_nonzero(rows) for rows in (deep, apart, ~deep & ~apart)) > 0
    assert told[deep] == pytest.approx(exact[deep], rel=0.01)
    assert told[apart] == pytest.approx(exact[apart])
    assert (told[~deep & ~apart] <= exact[~deep & ~apart] + 1e-9).all()
    assert (told[~deep & ~apart] >= -idle * (1.0 + 0.01)).all()


def test_a_search_finds_the_same_ways_through_whatever_shallow_depths_it_leaves_out():
    """Many random flights of two rings: which get deeper than a bound is what single searches with exact depths say."""
    rng, a, b = np.random.default_rng(11), solid_of(ring()), solid_of(ring())
    sweeps = [
        Sweep(a, random_motion(rng, 0.4), b, random_motion(rng, 0.4), below=-0.02, precision=1e-3, first_found=True)
        for _ in range(30)
    ]
    found = [float(low.value[0]) < -0.02 for low in lowest_clearances(sweeps)]
    alone = [float(lowest_clearance(sweep).value[0]) < -0.02 for sweep in sweeps]
    assert 0 < sum(alone) < len(alone)
    assert found == alone

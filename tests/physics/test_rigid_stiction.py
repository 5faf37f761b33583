"""Static friction against Coulomb's law: what rests holds with one coefficient, what slides rubs with the other."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.rigid.stiction import SLIPS
from worldagent.tests.physics.rigid_world import G, Run, box, world
from worldagent.worlds.spec import Material, WorldSpec
from worldagent.worlds.spec.simulation import ContactPair

REST, MOTION = 0.6, 0.4
CREEP = 1e-4
"""[m/s] Largest speed of what sticks: a tenth of a millimetre a second is not seen. Measured 1e-6 to 1e-5."""
ACCELERATION = 0.02
"""Gate of the table of friction cases, relative."""
MATERIAL = {"m": {"density": 1000.0, "friction": MOTION, "static_friction": REST}}


def _slope(slope: float, *, push: float = 0.0, seconds: float = 1.0, **more: Any) -> Run:
    """A box on a slab tilted by atan(slope) about y, let go with a speed down the slope."""
    angle = math.atan(slope)
    normal, down = np.array([math.sin(angle), 0, math.cos(angle)]), np.array([math.cos(angle), 0, -math.sin(angle)])
    slab = box(30, 4, 1, at=-0.5 * normal, euler=(0, angle, 0), motion="static")
    crate = box(0.2, 0.2, 0.1, at=0.05 * normal, euler=(0, angle, 0), v=push * down)
    return Run(world({"slab": slab, "crate": crate}, seconds=seconds, fps=48, **{"materials": MATERIAL, **more}))


def _speeds(run: Run) -> Any:
    return np.linalg.norm(run.of("crate", "velocity"), axis=1)


@pytest.mark.parametrize("slope", [0.45, 0.57])
def test_between_the_two_angles_a_box_at_rest_holds(slope: float) -> None:
    assert _speeds(_slope(slope, seconds=3.0))[4:].max() < CREEP


@pytest.mark.parametrize("slope", [0.45, 0.57])
def test_between_the_two_angles_a_box_that_is_pushed_slides_on_by_the_coefficient_of_motion(slope: float) -> None:
    """a = g (sin - mu cos) with the kinetic coefficient."""
    angle = math.atan(slope)
    run = _slope(slope, push=0.3)
    late = run.time > 0.25
    measured = np.polyfit(run.time[late], _speeds(run)[late], 1)[0]
    assert measured == pytest.approx(G * (math.sin(angle) - MOTION * math.cos(angle)), rel=ACCELERATION, abs=0.01)


def test_above_the_angle_of_rest_a_box_starts_by_itself() -> None:
    angle = math.atan(0.66)
    run = _slope(0.66)
    late = run.time > 0.25
    measured = np.polyfit(run.time[late], _speeds(run)[late], 1)[0]
    assert measured == pytest.approx(G * (math.sin(angle) - MOTION * math.cos(angle)), rel=ACCELERATION)


def test_below_the_angle_of_motion_a_pushed_box_stops_and_stays() -> None:
    angle = math.atan(0.3)
    run = _slope(0.3, push=1.0, seconds=2.5)
    deceleration = G * (MOTION * math.cos(angle) - math.sin(angle))
    way = np.linalg.norm(run.of("crate")[-1] - run.of("crate")[0])
    assert way == pytest.approx(1.0 / (2 * deceleration), rel=0.02)
    assert _speeds(run)[-1] < CREEP


def test_a_growing_pull_breaks_a_crate_loose_at_the_static_limit() -> None:
    """The pull grows to twice the static limit; the crate starts where it meets mu_s m g, and from then on gains (F - mu_k m g) / m."""
    seconds, mass, parts = 4.0, 10.0, 80
    most = 2 * REST * mass * G
    ground, crate = box(20, 4, 1, at=(0, 0, -0.5), motion="static"), box(0.3, 0.3, 0.3, at=(0, 0, 0.15), mass=mass)
    pull = {
        f"pull_{k}": {
            "kind": "force",
            "entity": "crate",
            "force": (most * (k + 0.5) / parts, 0, 0),
            "start": seconds * k / parts,
            "end": seconds * (k + 1) / parts,
        }
        for k in range(parts)
    }
    run = Run(world({"ground": ground, "crate": crate}, seconds=seconds, fps=40, materials=MATERIAL, drivers=pull))
    speed = _speeds(run)
    start = run.time[np.flatnonzero(speed > 10 * SLIPS)[0]]
    assert (
        -0.1 < most * start / seconds - REST * mass * G < 1.5 * most / parts
    )  # within one part of the pull, and a frame to be seen
    middle = len(run.time) * 3 // 4
    since, until = run.time[middle], run.time[-1]
    gained = 0.5 * most / seconds / mass * (until**2 - since**2) - MOTION * G * (until - since)
    assert speed[-1] - speed[middle] == pytest.approx(gained, rel=0.01)


def test_a_pair_has_its_own_static_friction() -> None:
    contacts = {"c": {"a": "slab", "b": "crate", "friction": 0.3, "static_friction": 0.5}}
    materials = {"m": {"density": 1000.0, "friction": 0.4}}
    assert _speeds(_slope(0.45, contacts=contacts, materials=materials))[4:].max() < CREEP
    assert _speeds(_slope(0.55, contacts=contacts, materials=materials))[-1] > 1.0


def test_without_static_friction_nothing_changes() -> None:
    plain = _slope(0.45, materials={"m": {"density": 1000.0, "friction": MOTION}})
    same = _slope(0.45, materials={"m": {"density": 1000.0, "friction": MOTION, "static_friction": MOTION}})
    assert np.array_equal(plain.of("crate"), same.of("crate"))
    assert _speeds(plain)[-1] > 0.3


def test_a_box_that_sticks_and_slips_gains_no_energy() -> None:
    """Height lost is all that speed can come from."""
    run = _slope(0.66, seconds=1.0)
    place, speed = run.of("crate"), _speeds(run)
    assert np.all(0.5 * speed**2 <= G * (place[0, 2] - place[:, 2]) + 1e-3)


@pytest.mark.parametrize(("friction", "rest"), [(0.4, 0.3), (0.4, 0.81), (0.0, 0.1)])
def test_static_friction_below_that_of_motion_or_beyond_twice_of_it_is_refused(friction: float, rest: float) -> None:
    with pytest.raises(ValueError, match=rf"static_friction {rest:g} must be {friction:g} \(friction\) to {2 * friction:g}"):
        Material(density=1000.0, friction=friction, static_friction=rest)
    with pytest.raises(ValueError, match="needs friction"):
        ContactPair(a="a", b="b", static_friction=rest)


def test_worlds_without_it_are_written_as_before() -> None:
    spec: WorldSpec = world({"crate": box(1, 1, 1)}, contacts={"c": {"a": "crate", "b": "crate", "friction": 0.3}})
    text = spec.model_dump_json()
    assert "static_friction" not in text

"""Rigid bodies that declare lift: glides, flights against equations of their own, balances measured from the motion, stability (R18, R66)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import G, Run, ball, box, entity, world
from worldagent.worlds.arrays import F64
from worldagent.worlds.errors import InputError

AIR, PLATE = 1.204, 1.15
STILL = {"air": {"kind": "field", "field": {"kind": "drag", "coefficient": PLATE}}}


def blown(speed: float) -> dict[str, Any]:
    return {"wind": {"kind": "field", "field": {"kind": "wind", "velocity": (speed, 0, 0), "coefficient": PLATE}}}


def lifted(thing: dict[str, Any], *, lift: bool = True) -> dict[str, Any]:
    thing["physics"]["lift"] = lift
    return thing


def card(*size: float, **more: Any) -> dict[str, Any]:
    return lifted(box(*(size or (0.2, 0.2, 0.001)), **more))


def energy(run: Run, wind: float = 0.0, mass: float = 0.01) -> F64:
    """Kinetic energy of the body `b`, a box of 0.2 x 0.2 x 0.001, as seen by the air [J]."""
    velocity, q = run.of("b", "velocity") - [wind, 0, 0], run.of("b", "quaternion")
    from worldagent.worlds.arrays import rotation_matrix

    spin = np.einsum("nji,nj->ni", rotation_matrix(q), run.of("b", "angular_velocity"))
    inertia = mass / 12.0 * np.array([0.2**2 + 1e-6, 0.2**2 + 1e-6, 2 * 0.2**2])
    return np.asarray(0.5 * mass * (velocity**2).sum(axis=1) + 0.5 * (spin**2) @ inertia)


def glider(**more: Any) -> dict[str, Any]:
    """A card of 4 g whose nose of 2 g puts its centre of mass 3 cm ahead of its middle."""
    made = lifted(entity(**more))
    made["parts"] = {
        "wing": {"shape": {"kind": "box", "size": (0.2, 0.2, 0.002)}, "material": "foam"},
        "nose": {"shape": {"kind": "box", "size": (0.02, 0.2, 0.002)}, "material": "lead", "pose": {"position": (0.09, 0, 0)}},
    }
    return made


def test_a_card_with_a_nose_glides_where_its_centre_of_pressure_is() -> None:
    """Closed form: the centre of pressure stands under the centre of mass at 0.3 - 0.22 a / 38 = 0.15, a = 25.9 degrees; a push along the normal bears it,
    so that it lies level and sinks at that angle, with m g = 1/2 rho V^2 C h(a) A. Let go so it stays so."""
    trim = (0.3 - 0.15) / 0.22 * 38.0
    bears = 0.5 * AIR * PLATE * (1.7 / 1.15) * trim / 40.0 * 0.04
    speed, angle = np.sqrt(0.006 * G / bears), np.radians(trim)
    things = {"b": glider(at=(0, 0, 5), v=(speed * np.cos(angle), 0, -speed * np.sin(angle)))}
    run = Run(world(things, seconds=3.0, drivers=STILL, materials={"foam": {"density": 50.0}, "lead": {"density": 250.0}}))
    velocity = run.of("b", "velocity")
    assert np.linalg.norm(velocity.mean(axis=0)) == pytest.approx(speed, rel=0.02)
    assert np.degrees(np.arctan2(-velocity[:, 2], velocity[:, 0])) == pytest.approx(trim, abs=2.0)
    assert np.abs(np.degrees(2.0 * run.of("b", "quaternion")[:, 2])).max() < 2.0
    assert np.abs(run.of("b")[:, 1]).max() < 1e-9


def test_a_card_without_a_nose_comes_to_lie_across_its_fall_at_its_terminal_speed() -> None:
    """Closed form: V^2 = 2 m g / (rho C A); within 7 degrees of across nothing turns it, so that it may drift by as much."""
    run = Run(world({"b": card(at=(0, 0, 9), euler=(0.1, 0.4, 0), mass=0.01)}, seconds=4.0, drivers=STILL))
    terminal = np.sqrt(2.0 * 0.01 * G / (AIR * PLATE * 0.04))
    velocity = run.of("b", "velocity")[-1]
    assert velocity[2] == pytest.approx(-terminal, rel=0.01)
    assert np.linalg.norm(velocity[:2]) < terminal * np.tan(np.radians(7.5))


def flown(state: F64, wind: float, seconds: float, mass: float) -> F64:
    """Flight in the plane of x and z of a card of 0.2 x 0.2 x 0.0001, by equations written out anew: x, z, vx, vz, pitch, spin."""
    from scipy.integrate import solve_ivp

    side, thick = 0.2, 1e-4
    inertia, thin = mass / 12.0 * (side**2 + thick**2), 1.0 - thick / side

    def slopes(_: float, s: F64) -> list[float]:
        u, w = wind - s[2], -s[3]
        speed, c, n = np.hypot(u, w), np.cos(s[4]), np.sin(s[4])
        # Axes of the card: along (c, -n), up (n, c); the flow in them.
        along, up = u * c - w * n, u * n + w * c
        a = np.degrees(np.arcsin(min(abs(up) / speed, 1.0)))
        h = np.interp(a, [0, 40, 45], [0, 1.7 / 1.15, 1.0])
        edge = np.interp(90.0 - a, [0, 40, 45], [0, 1.7 / 1.15, 1.0])
        normal, tangent = h * side**2 * np.sign(up), edge * side * thick * np.sign(along)
        ahead = 0.3 - 0.22 * a / 38 if a < 38 else max(0.08 * np.cos(np.radians(2 * (min(a, 83.0) - 38))), 0.0)
        shown = side**2 * abs(up) / speed + side * thick * abs(along) / speed
        q = 0.5 * AIR * PLATE * speed**2
        fx = thin * (normal * n + tangent * c) + (1 - thin) * shown * u / speed
        fz = thin * (normal * c - tangent * n) + (1 - thin) * shown * w / speed
        moment = thin * normal * ahead * side * np.sign(along)
        strips = 0.5 * AIR * PLATE * thin * side**4 / 12 * (2 * speed + 0.375 * side * abs(s[5]))
        return [s[2], s[3], q * fx / mass, q * fz / mass, s[5], (q * moment - strips * s[5]) / inertia]

    return np.asarray(solve_ivp(slopes, (0.0, seconds), state, rtol=1e-9, atol=1e-10).y[:, -1])


@pytest.mark.parametrize(("pitch", "spin"), [(-0.3, 0.0), (0.9, 0.0), (-1.2, 25.0)])
def test_a_card_in_a_wind_flies_as_equations_of_its_own_say(pitch: float, spin: float) -> None:
    """A second route: plane flight by an adaptive scheme, written out for the box; 4 g in 8 m/s for half a second, gate 2 % of the way."""
    things = {"b": card(0.2, 0.2, 1e-4, at=(0, 0, 3), euler=(0, pitch, 0), w=(0, spin, 0), mass=0.004)}
    run = Run(world(things, seconds=0.5, drivers=blown(8.0), gravity=(0, 0, 0), settings={"step": 2e-4}))
    wanted = flown(np.array([0, 3.0, 0, 0, pitch, spin]), 8.0, 0.5, 0.004)
    way = float(np.linalg.norm(wanted[:2] - [0, 3.0]))
    assert way > 0.5
    assert run.of("b")[-1][[0, 2]] == pytest.approx(wanted[:2], abs=0.02 * way)
    assert run.of("b", "velocity")[-1][[0, 2]] == pytest.approx(wanted[2:4], abs=0.02 * 8.0)


def test_the_way_converges_with_the_step() -> None:
    """First order: half the step, half the distance to the finest."""
    ways = []
    for step in (2e-3, 1e-3, 5e-4, 6.25e-5):
        things = {"b": card(at=(0, 0, 3), euler=(0.1, -0.4, 0), mass=0.004)}
        ways.append(Run(world(things, seconds=0.4, drivers=blown(8.0), settings={"step": step})).of("b")[-1])
    coarse, middle, fine = (float(np.linalg.norm(w - ways[-1])) for w in ways[:-1])
    assert fine < 0.01 * float(np.linalg.norm(ways[-1] - [0, 0, 3]))
    assert middle < 0.65 * coarse
    assert fine < 0.65 * middle


@pytest.mark.parametrize("step", [5e-3, 5e-4])
@pytest.mark.parametrize("spin", [(0, 0, 0), (3, 40, 10)])
def test_energy_seen_by_the_air_only_falls(step: float, spin: tuple[float, float, float]) -> None:
    """A paper card of 4 g in a storm of 30 m/s: with the longest step too."""
    things = {"b": card(at=(0, 0, 3), euler=(0.2, -0.3, 0), w=spin, mass=0.004)}
    run = Run(world(things, seconds=1.0, drivers=blown(30.0), gravity=(0, 0, 0), settings={"step": step}))
    seen = energy(run, 30.0, 0.004)
    assert np.isfinite(seen).all()
    assert (np.diff(seen) < 1e-9 * seen[0]).all()
    assert seen[-1] < 0.05 * seen[0]


def test_a_roof_tile_in_a_storm_flies_and_stays_sound() -> None:
    """1 kg at 30 m/s: lifted against its weight at first, never faster than the storm past the air."""
    things = {"b": card(0.3, 0.25, 0.012, at=(0, 0, 5), euler=(0, -0.3, 0), mass=1.0)}
    run = Run(world(things, seconds=1.0, drivers=blown(30.0)))
    past = np.linalg.norm(run.of("b", "velocity") - [30.0, 0, 0], axis=1)
    assert past.max() < 30.0 + G * 1.0
    assert np.abs(run.of("b", "angular_velocity")).max() < 60.0
    given = run.of("b", "field/impulse")[1:]
    assert np.abs(given[:, 2]).max() > 0.5 * G / 24.0


def test_what_media_gave_is_the_change_of_momentum_and_of_angular_momentum() -> None:
    """Balances measured from the motion: impulses against velocities less weight, twists against I w of a card that turns about one axis."""
    things = {"b": card(at=(0, 0, 9), euler=(0, 0.5, 0), mass=0.01)}
    run = Run(world(things, seconds=1.0, drivers=blown(5.0)))
    change = 0.01 * np.diff(run.of("b", "velocity"), axis=0) + [0, 0, 0.01 * G / 24.0]
    assert run.of("b", "field/impulse")[1:] == pytest.approx(change, abs=1e-9)
    inertia = 0.01 / 12.0 * (0.2**2 + 1e-6)
    turned = inertia * np.diff(run.of("b", "angular_velocity"), axis=0)
    assert np.abs(turned[:, 1]).max() > 1e-5
    assert run.of("b", "field/twist")[1:] == pytest.approx(turned, abs=1e-9)


@pytest.mark.parametrize("thing", ["cube", "ball"])
def test_a_body_as_thick_as_wide_flies_as_without_lift(thing: str) -> None:
    more: dict[str, Any] = {"at": (0, 0, 3), "mass": 0.05, "w": (3, 7, 2), "v": (1, 2, 0)}
    ways = []
    for lift in (True, False):
        made = box(0.1, 0.1, 0.1, **more) if thing == "cube" else ball(0.05, **more)
        ways.append(Run(world({"b": lifted(made, lift=lift)}, seconds=0.5, drivers=blown(12.0))).of("b"))
    assert ways[0] == pytest.approx(ways[1], abs=1e-9 if thing == "cube" else 2e-3)


def test_worlds_without_lift_have_no_record_of_twists() -> None:
    run = Run(world({"b": lifted(box(0.2, 0.2, 0.001, mass=0.01), lift=False)}, seconds=0.1, drivers=blown(5.0)))
    assert "field/twist" not in run.frames[-1]


def test_a_held_card_gets_no_twist() -> None:
    drivers = {**blown(5.0), "hold": {"kind": "release", "entity": "b", "time": 0.5}}
    run = Run(world({"b": card(at=(0, 0, 3), euler=(0, -0.4, 0), mass=0.01)}, seconds=1.0, drivers=drivers))
    assert (run.series("field/twist")[:13] == 0).all()
    assert (np.abs(run.series("field/twist")[13:16, 0, 1]) > 0).all()


def test_parts_that_enclose_nothing_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.simulation.rigid.lifting.hull_of", lambda *_: None)
    with pytest.raises(InputError, match="set physics/lift to false"):
        Run(world({"b": card(mass=0.01)}, seconds=0.1, drivers=blown(5.0)))

"""Fields measured from the motion alone: a second route beside the laws that engines and judge share (R18, R63).

A wrong law in `physics` would deceive both, since the recorded impulses would be those that the judge computes. Here they are what a
balance of momentum leaves when gravity is taken off, and the laws are written out anew for cases with a closed form. What else is
measured without the shared laws: boxes, balls, attraction in `test_rigid_fields.py`, blocks in `test_elastic_fields.py`, rain in
`tests/simulation/test_flight.py`, liquids in `tests/simulation/liquid/test_blowing.py`, the length of waves in `test_liquid_waves.py`.
"""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.particles.flight import SolverFlight
from worldagent.testing.worlds.small_grains import SPARK_PROMPT, spark_spec
from worldagent.testing.worlds.small_worlds import build_all
from worldagent.tests.physics.cloth_sheets import DENSITY, cloth, fabric, run, sheet
from worldagent.tests.physics.rigid_world import G, Run, ball, box, world
from worldagent.worlds.spec import WorldSpec

AIR, THICK = 1.204, 1.81e-5
FLOWS = {
    "eddies": {"kind": "field", "field": {"kind": "turbulence", "speed": 6.0, "length": 2.0}, "seed": 3},
    "whirl": {"kind": "field", "field": {"kind": "vortex", "center": (0.5, 0, 0), "speed": 9.0, "core": 0.4, "updraft": 4.0}},
    "pull": {"kind": "field", "field": {"kind": "attraction", "center": (0, 3, 0), "acceleration": 7.0, "distance": 1.0}},
    "gusts": {"kind": "field", "field": {"kind": "wind", "velocity": (5, 2, 0), "gust": 0.5}, "start": 0.3, "rise": 0.2},
}


def test_what_fields_gave_to_bodies_is_what_gravity_leaves_of_their_change_of_momentum() -> None:
    """Law: a free body's momentum changes by its weight and by what fields gave, in every frame and direction."""
    things = {
        "ball": ball(0.1, at=(0, 0, 8), v=(1, 2, 0), mass=0.05),
        "box": box(0.3, 0.2, 0.1, at=(2, 0, 8), w=(3, 7, 2), mass=0.2),
    }
    made = Run(world(things, seconds=0.8, drivers=FLOWS))
    for name, mass in (("ball", 0.05), ("box", 0.2)):
        change = mass * np.diff(made.of(name, "velocity"), axis=0)
        weight = np.array([0.0, 0.0, -mass * G / 24.0])
        given = made.of(name, "field/impulse")[1:]
        assert np.linalg.norm(given, axis=1).min() > 0.01 * mass
        assert given == pytest.approx(change - weight, abs=1e-6 * mass)


def test_a_sheet_that_lies_flat_in_the_air_falls_at_its_terminal_speed() -> None:
    """Closed form: v = V tanh(g t / V), V^2 = 2 m g / (rho C) per area, with C across the sheet; gate 1 %."""
    across = 1.2
    made = cloth(sheet((0.4, 0.4), 0.1, fabric()), drag=((across, 0.1),))
    before = float((made.masses.numpy() @ made.v.numpy()[: made.n])[2])
    reports = run(made, 0.6)
    mass = DENSITY * 0.16
    terminal = np.sqrt(2.0 * DENSITY * G / (AIR * across))
    speed = -made.v.numpy()[: made.n, 2]
    assert speed == pytest.approx(terminal * np.tanh(G * 0.6 / terminal), rel=0.01)
    air = sum(r.air[2] for r in reports)
    momentum = float((made.masses.numpy() @ made.v.numpy()[: made.n])[2])
    assert air == pytest.approx(momentum - before + mass * G * 0.6, rel=1e-6)


def test_a_wind_along_a_sheet_takes_it_along_by_its_skin_drag() -> None:
    """Closed form: v = W - W / (1 + W k t), k = rho C / 2 m per area, with C along the sheet."""
    along, wind = 0.3, 12.0

    def blows(points: np.ndarray, time: float) -> np.ndarray:
        del time
        return np.tile([wind, 0.0, 0.0, AIR], (len(points), 1))

    made = cloth(sheet((0.4, 0.4), 0.1, fabric()), drag=((1.2, along),), air=blows, gravity=np.zeros(3))
    run(made, 0.5)
    rate = 0.5 * AIR * along / DENSITY
    assert made.v.numpy()[: made.n, 0] == pytest.approx(wind - wind / (1.0 + wind * rate * 0.5), rel=0.01)


def _dust(radius: float, wind: tuple[float, float, float], seconds: float) -> np.ndarray:
    """Velocity [m/s] of a grain of 1000 kg/m^3 that starts at rest in a wind without gravity, after a time in frames of 1 / 24 s."""
    document = spark_spec(frames=round(24 * seconds) + 2)
    document["materials"]["iron"] = {"density": 1000.0, "friction": 0.4, "restitution": 0.4}
    document["entities"]["sparks"]["physics"] |= {"radius": radius, "radius_spread": 0.0, "life": None, "count": 20}
    document["simulation"]["gravity"] = [0, 0, 0]
    document["simulation"]["solvers"]["flight"]["settings"]["domain"] = {"center": [0, 0, 1.5], "size": [40.0, 4.0, 4.0]}
    document["simulation"]["drivers"] = {"breeze": {"kind": "field", "field": {"kind": "wind", "velocity": wind}}}
    spec = WorldSpec.model_validate({"prompt": SPARK_PROMPT, **document})
    flying = SolverFlight(spec, build_all(spec), "flight")
    flying.prepare()
    for frame in range(1, round(24 * seconds) + 1):
        flying.advance(frame)
    found: np.ndarray = flying.columns()["velocity"]
    assert len(found) == 20
    return found


def test_fine_dust_follows_a_slow_wind_in_the_time_of_stokes() -> None:
    """Closed form: v = W (1 - exp(-t / T)), T = 2 r^2 rho / 9 mu; the Reynolds number stays below 0.22, its correction below 6 %."""
    radius, wind, time = 8e-5, 0.02, 1 / 24
    settled = 2.0 * radius**2 * 1000.0 / (9.0 * THICK)
    found = _dust(radius, (wind, 0, 0), time)
    assert found[:, 0] == pytest.approx(wind * (1.0 - np.exp(-time / settled)), rel=0.05)


def test_coarse_grains_in_a_gale_gain_speed_by_newtons_law() -> None:
    """Closed form: v = W - W / (1 + W k t), k = 3 rho 0.44 / (8 r rho_grain), at Reynolds numbers above 10000."""
    radius, wind, time = 5e-3, 40.0, 0.5
    rate = 3.0 * AIR * 0.44 / (8.0 * radius * 1000.0)
    found = _dust(radius, (wind, 0, 0), time)
    assert found[:, 0] == pytest.approx(wind - wind / (1.0 + wind * rate * time), rel=0.02)

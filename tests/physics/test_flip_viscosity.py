"""Thick liquids on the grid engine: exact profiles between plates, drag in the ledger, temperature."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.liquid.engine import Fluid, LiquidSetup
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.flip.settings import FlipSettings
from worldagent.tests.simulation.liquid.flip_setup import advance, block, no_bodies, tank
from worldagent.worlds.arrays import F64
from worldagent.worlds.built import TriangleMesh

from .test_flip import G, box_mesh, one_body

GAP, LONG = 0.1, 0.4
"""Distance of the plates and length of the liquid between them [m]."""
THICK = 100.0
"""Dynamic viscosity [Pa s]: a profile between the plates is there after GAP^2 density / viscosity = 0.1 s / pi^2."""


def plates(cells: int, *, gravity: float, friction: float = 1.0, viscosity: float = THICK) -> LiquidSetup:
    """Upright liquid between two plates, open above and below, two cells from front to back between smooth sides."""
    cell = GAP / cells
    wide, strong = 2 * cell, 3 * cell
    mesh = box_mesh((strong, wide, LONG + 0.4))
    walls = tuple(
        Boundary(name, TriangleMesh(mesh.vertices + np.array([x, wide / 2, LONG / 2]), mesh.faces), motion, friction=friction)
        for name, x, motion in (("left", 0.1 - strong / 2, "static"), ("right", 0.1 + GAP + strong / 2, "kinematic"))
    )
    water = block((0.1, 0, 0), (0.1 + GAP, wide, LONG), cell)
    sides = ("open", "open", "closed", "closed", "open", "open")
    setup = tank((0.2 + GAP, wide, LONG), water, cell, boundaries=walls, sides=sides, gravity=np.array([0.0, 0.0, -gravity]))
    return LiquidSetup(**{**vars(setup), "fluids": (Fluid("oil", 1000.0, viscosity),)})


def profile(cells: int, engine: Flip, gravity: float, speed: float) -> tuple[F64, F64]:
    """Mean speeds along the plates by distance from the left one, and the exact ones for the drive that the pressure leaves.

    The liquid is four gaps long: tongues at its ends pull or push a little, which its pressure shows.
    """
    found = engine.particles()
    inner = (found.position[:, 2] > 0.15) & (found.position[:, 2] < 0.25)
    x, height = found.position[inner, 0] - 0.1, found.position[inner, 2]
    drive = 1000 * gravity + np.polyfit(height, found.pressure[inner], 1)[0]
    exact = speed * x / GAP - drive / (2 * THICK) * x * (GAP - x)
    place = np.clip((x / GAP * cells).astype(int), 0, cells - 1)
    return tuple(np.array([v[place == n].mean() for n in range(cells)]) for v in (found.velocity[inner, 2], exact))  # type: ignore[return-value]


def error_of(cells: int, transfer: str, gravity: float, speed: float) -> float:
    """Mean error of the profile after 0.08 s, of its largest speed."""
    engine = Flip(plates(cells, gravity=gravity), FlipSettings(transfer=transfer, max_step=0.0025))  # type: ignore[arg-type]
    bodies = no_bodies(2)
    bodies.velocity[1] = (0.0, 0.0, speed)
    reports = advance(engine, 0.08, bodies)
    assert sum(r.capped for r in reports) == 0
    measured, exact = profile(cells, engine, gravity, speed)
    return float(np.abs(measured - exact).mean() / np.abs(exact).max())


@pytest.mark.parametrize("transfer", ["flip", "apic"])
def test_oil_between_plates_falls_in_poiseuilles_parabola(transfer: str) -> None:
    """4 and 8 cells between the plates; 16 cells: 1 to 2 %, of which the step of 2.5 ms is the greater part."""
    coarse, fine = (error_of(cells, transfer, G, 0.0) for cells in (4, 8))
    assert fine <= 0.05
    assert fine <= 0.6 * coarse


@pytest.mark.parametrize("transfer", ["flip", "apic"])
def test_oil_beside_a_moving_plate_has_couettes_straight_profile(transfer: str) -> None:
    coarse, fine = (error_of(cells, transfer, 0.0, 0.5) for cells in (4, 8))
    assert coarse <= 0.03
    assert fine <= 0.6 * coarse


def test_smooth_plates_do_not_hold_oil() -> None:
    """Without friction it falls freely: g t after 0.05 s."""
    engine = Flip(plates(4, gravity=G, friction=0.0))
    advance(engine, 0.05, no_bodies(2))
    assert engine.particles().velocity[:, 2].mean() == pytest.approx(-G * 0.05, rel=0.02)


def test_hotter_lava_runs_faster() -> None:
    """Arrhenius: at 1300 instead of 1400 K an activation of 20,000 K makes it 3 times as thick, and the fall 3 times as slow.

    Per drive that its pressure leaves: tongues at the ends pull.
    """
    speeds = []
    for temperature in (1400.0, 1300.0):
        setup = plates(4, gravity=G)
        thick = THICK * np.exp(20_000 * (1 / temperature - 1 / 1400.0))
        lava = Fluid("lava", 1000.0, THICK, temperature=1400.0, activation=20_000.0)
        engine = Flip(LiquidSetup(**{**vars(setup), "fluids": (lava,)}), FlipSettings(transfer="apic", max_step=0.0025))
        engine.markers.temperature[:] = temperature
        advance(engine, 0.1, no_bodies(2))
        found = engine.particles()
        inner = (found.position[:, 2] > 0.15) & (found.position[:, 2] < 0.25)
        drive = 1000 * G + np.polyfit(found.position[inner, 2], found.pressure[inner], 1)[0]
        speeds.append(found.velocity[inner, 2].mean() * thick / drive)
    assert speeds[1] == pytest.approx(speeds[0], rel=0.05)


def test_honey_holds_a_light_box_that_it_drags() -> None:
    """A box of 50 kg/m^3 in the middle of falling honey moves with it, in steps that an explicit drag would blow up."""
    side, cell = 0.1, 0.025
    at = np.array([0.2, 0.2, 0.2])
    body = Boundary("box", box_mesh((side, side, side)), "dynamic", friction=1.0)
    honey = block((0.05, 0.05, 0.05), (0.35, 0.35, 0.35), cell / 2)
    honey = honey[(np.abs(honey - at) > side / 2).any(axis=1)]
    velocity = np.tile([0.5, 0.0, 0.0], (len(honey), 1))
    setup = tank((0.6, 0.4, 0.4), honey, cell / 2, velocity=velocity, boundaries=(body,), gravity=np.zeros(3))
    engine = Flip(LiquidSetup(**{**vars(setup), "spacing": cell, "fluids": (Fluid("honey", 1400.0, 100.0),)}))
    mass = 50.0 * side**3
    liquid = 1400.0 * engine.particles().volume.sum()
    speed, turn = np.zeros(3), np.zeros(3)
    for _ in range(10):
        state: BodyState = one_body(at, mass=mass, size=(side,) * 3, velocity=speed, spin=turn)
        state.acceleration[:] = 0.0
        report = engine.step(0.01, state)
        assert report.reaction[0, :3] == pytest.approx(-report.impulse[0, :3], abs=1e-3 * liquid * 0.5)
        speed = speed + report.impulse[0, :3] / mass
        turn = turn + state.inverse_inertia[0] @ report.impulse[0, 3:]
        at = at + report.dt * speed
    assert speed[0] == pytest.approx(0.5 * liquid / (liquid + mass), rel=0.03)
    assert np.abs(speed[1:]).max() < 0.01
    moved = 1400.0 * (engine.particles().volume[:, None] * engine.particles().velocity).sum(axis=0) + mass * speed
    assert moved[0] == pytest.approx(0.5 * liquid, rel=0.02)

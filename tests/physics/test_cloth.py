"""Cloth: the declared stiffness is what it stretches by, hanging, in a catenary, bent; nothing is lost, nothing crosses."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from worldagent.bench.cloth_scene import nothing, thrown
from worldagent.geometry import pierced
from worldagent.simulation.cloth.batches import Batches
from worldagent.simulation.cloth.energy import bending_energy, membrane_energy
from worldagent.simulation.cloth.engine import Cloth
from worldagent.simulation.cloth.mesh import sheet_of
from worldagent.tests.physics.cloth_sheets import DENSITY, STIFFNESS, box, cloth, fabric, hold, run, sheet, standing
from worldagent.worlds.arrays import F64
from worldagent.worlds.categories.cloth.facts import sheet_grid
from worldagent.worlds.spec import Sheet as SheetShape

G = 9.81


def _hanging(edge: float, stiffness: float = STIFFNESS, damping: float = 1e-3) -> tuple[float, float]:
    """Stretch of a hanging sheet of 1 m at its lower end, and the share of its weight that its pins bear."""
    flat = sheet((0.2, 1.0), edge, fabric(stretch=(stiffness, stiffness), damping=1e-3))
    upright = flat.position[:, [0, 2, 1]] + np.array([0.0, 0.0, 0.5])
    hung = sheet((0.2, 1.0), edge, fabric(stretch=(stiffness, stiffness), damping=damping), upright)
    top = np.flatnonzero(upright[:, 2] > 1.0 - 1e-9)
    running = cloth(hung, holds=(hold(top, upright),), self_collision=False)
    reports = run(running, 1.0)
    x, _ = running.vertices()
    low = np.flatnonzero(upright[:, 2] < 1e-9)
    borne = sum(r.held[2] for r in reports[-100:]) / sum(r.dt for r in reports[-100:]) / (hung.mass.sum() * G)
    return float(-x[low, 2].mean()), float(borne)


@pytest.mark.parametrize("edge", [0.1, 0.05])
def test_a_hanging_sheet_stretches_by_its_own_weight_over_its_stiffness(edge: float) -> None:
    """Law: rho g L^2 / (2 E) per thickness; gate 5 %, total 2 %. Two resolutions; the pins bear the weight."""
    stretch, borne = _hanging(edge)
    law = DENSITY * G / (2 * STIFFNESS)
    assert stretch == pytest.approx(law, rel=0.05)
    assert stretch < 0.02
    assert borne == pytest.approx(1.0, rel=0.01)


def test_a_softer_sheet_stretches_in_proportion() -> None:
    """Law, at a stretch of one percent."""
    stretch, _ = _hanging(0.1, 100.0, 1e-2)
    assert stretch == pytest.approx(DENSITY * G / 200.0, rel=0.05)


def test_a_strip_between_two_pins_hangs_in_a_catenary() -> None:
    """Law: y = c cosh(x / c) with the strip's length; gates: sag 2 %, length 1 %."""
    span, length, edge = 0.8, 1.0, 0.04
    made_of = fabric(stretch=(5000.0, 5000.0), bend=1e-7, damping=1e-5)
    flat = sheet((length, 4 * edge), edge, made_of)
    # An arc of the strip's length over the span.
    angle = brentq(lambda a: math.sin(a) / a - span / length, 1e-3, math.pi)
    radius, along = length / (2 * angle), flat.position[:, 0]
    arc = np.stack(
        [radius * np.sin(along / radius), flat.position[:, 1], radius * (math.cos(angle) - np.cos(along / radius))], axis=1
    )
    ends = np.flatnonzero(np.abs(along) > 0.5 * length - 1e-9)
    running = cloth(
        sheet((length, 4 * edge), edge, made_of, arc), holds=(hold(ends, arc),), drag=((80.0, 0.0),), self_collision=False
    )
    run(running, 3.5)
    x, v = running.vertices()
    assert np.abs(v).max() < 0.05
    middle = x[np.abs(flat.position[:, 1]) < 1e-9]
    middle = middle[np.argsort(flat.position[np.abs(flat.position[:, 1]) < 1e-9, 0])]
    found = np.linalg.norm(np.diff(middle, axis=0), axis=1).sum()
    c = brentq(lambda c: 2 * c * math.sinh(span / (2 * c)) - length, 0.05, 10.0)
    assert found == pytest.approx(length, rel=0.01)
    assert -middle[:, 2].min() == pytest.approx(c * (math.cosh(span / (2 * c)) - 1), rel=0.02)


def _sunk(angle: float) -> float:
    """Sag of a wide clamped plate, cut at an angle from a lattice, under its weight, over the law's (L = B = q = 1)."""
    edge = 0.05
    points, faces = sheet_grid(SheetShape(size=(4.0, 4.0), resolution=edge))
    along = points @ np.array([math.cos(angle), math.sin(angle), 0.0])
    across = points @ np.array([-math.sin(angle), math.cos(angle), 0.0])
    inside = (along > -2.2 * edge) & (along <= 1.0 + 1e-9) & (np.abs(across) <= 0.6)
    faces = faces[inside[faces].all(axis=1)]
    used, own = np.unique(faces, return_inverse=True)
    plate = sheet_of(points[used], own.reshape(-1, 3).astype(np.int32), fabric(area_density=1.0, bend=1.0))
    along, across, count = along[used], across[used], len(used)
    weight, places = plate.hinge_weight, plate.hinges
    stiffness = plate.hinge_law[:, 0, None, None] * weight[:, :, None] * weight[:, None, :]
    rows, columns = np.repeat(places, 4, axis=1).ravel(), np.tile(places, (1, 4)).ravel()
    matrix = coo_matrix((stiffness.ravel(), (rows, columns)), shape=(count, count)).tocsc()
    free, sunk = np.flatnonzero(along > 1e-9), np.zeros(count)
    sunk[free] = spsolve(matrix[free][:, free], plate.mass[free])
    near = (np.abs(along - 0.9) < 1.5 * edge) & (np.abs(across) < 0.3)
    u = along[near]
    return float((sunk[near] / (u**2 * (6 - 4 * u + u**2) / 24)).mean())


def test_a_plate_bends_as_its_stiffness_says() -> None:
    """Law: a clamped plate sinks by q u^2 (6 L^2 - 4 L u + u^2) / (24 B). Known gap: a lattice of squares is softer along them."""
    found = [_sunk(math.radians(angle)) for angle in (0.0, 22.5, 45.0)]
    assert np.mean(found) == pytest.approx(1.0, rel=0.1)
    assert found == pytest.approx([1.0] * 3, rel=0.35)


def _shaken(damping: float) -> tuple[F64, F64, F64]:
    """Momentum and angular momentum (n, 3) and energies (n,) of a free sheet that swings."""
    flat = sheet((0.4, 0.4), 0.05, fabric(bend=1e-4, damping=damping))
    start = flat.position + np.array([0, 0, 1.0]) * 0.05 * np.sin(8 * flat.position[:, :1])
    speed = 0.5 * np.sin(6 * flat.position[:, [1, 0, 1]] + np.array([0.3, 1.1, 0.0])) + np.array([0.2, 0.0, 0.1])
    thrown = sheet((0.4, 0.4), 0.05, fabric(bend=1e-4, damping=damping), start)
    running = cloth(thrown, gravity=np.zeros(3), velocity=speed, self_collision=False, max_step=1e-5)
    linear, angular, energies = [], [], []
    for _ in range(40):
        run(running, 0.001)
        x, v = running.vertices()
        linear.append(flat.mass @ v)
        angular.append((flat.mass[:, None] * np.cross(x, v)).sum(0))
        energies.append(0.5 * flat.mass @ (v**2).sum(1) + membrane_energy(thrown, x) + bending_energy(thrown, x))
    return np.array(linear), np.array(angular), np.array(energies)


def test_a_free_sheet_keeps_its_momentum_and_energy() -> None:
    """Laws: momentum and angular momentum to rounding, energy within 1 % at a thirtieth of the stable step; damping only takes energy."""
    linear, angular, energies = _shaken(0.0)
    assert np.abs(linear - linear[0]).max() < 1e-12
    assert np.abs(angular - angular[0]).max() < 1e-5 * np.abs(angular).max() + 1e-12
    assert energies == pytest.approx(energies[0], rel=0.01)
    linear, angular, damped = _shaken(2e-4)
    assert np.abs(linear - linear[0]).max() < 1e-12
    assert (np.diff(damped) < 1e-3 * damped[0]).all()
    assert damped[-1] < 0.6 * energies[-1]


def test_a_falling_sheet_crumples_without_a_crossing() -> None:
    """No edge goes through a triangle, at 30 moments of a sheet that falls on its edge; none goes into the floor; momentum adds up."""
    size, edge = 0.6, 0.03
    flat = sheet((size, size), edge, fabric())
    u, w = flat.position[:, 0], flat.position[:, 1] + 0.5 * size
    upright = np.stack([u, 0.03 * np.sin(12 * w) + 0.02 * np.sin(9 * u), w + 0.02], axis=1)
    speed = np.tile([0.0, 0.0, -2.0], (len(u), 1))
    floor = box((4, 4, 0.2), (0, 0, -0.1))
    running = cloth(sheet((size, size), edge, fabric(), upright), boundaries=(floor,), velocity=speed, drag=((1.2, 0.05),))
    start, given = flat.mass @ speed, np.zeros(3)
    for k in range(30):
        for report in run(running, 0.02, 0.02 * k):
            given += (
                report.air[:3]
                + report.cut[:3]
                - report.impulse[:, :3].sum(0)
                + flat.mass.sum() * np.array([0, 0, -G]) * report.dt
            )
        x, v = running.vertices()
        assert len(pierced(x, flat.edges, flat.faces)) == 0
        assert x[:, 2].min() > 0.0
    assert x[:, 2].max() < 0.7 * size
    assert flat.mass @ v == pytest.approx(start + given, abs=1e-9)


@pytest.mark.slow
def test_a_thrown_sheet_gains_no_energy_in_its_folds() -> None:
    """Law: 40 x 40 vertices without damping only lose energy, frame by frame, and nearly all of it as they come to lie."""
    running = thrown(40)
    bodies, own, time, energies = nothing(running.setup.boundaries), running.setup.sheets[0], 0.0, []
    for k in range(18):
        while time < (k + 1) / 24 - 1e-9:
            time += running.step((k + 1) / 24 - time, bodies, time).dt
        x, v = running.vertices()
        kinetic = 0.5 * running.mass @ (v**2).sum(1)
        energies.append(kinetic + G * running.mass @ x[:, 2] + membrane_energy(own, x) + bending_energy(own, x))
        assert len(pierced(x, own.edges, own.faces)) == 0
    assert (np.diff(energies) < 1e-3 * energies[0]).all()
    assert energies[-1] < 0.1 * energies[0]


def test_friction_holds_a_sheet_on_a_slope_or_lets_it_slide() -> None:
    """Law: gravity along the slope against Coulomb friction; a slides at g (sin - mu cos), gate 5 %."""
    angle, floor = math.radians(20), box((4, 4, 0.2), (0, 0, -0.1))
    tilted = G * np.array([math.sin(angle), 0.0, -math.cos(angle)])
    for friction in (0.5, 0.2):
        flat = sheet((0.2, 0.2), 0.05, fabric())
        laid = sheet((0.2, 0.2), 0.05, fabric(), flat.position + np.array([0, 0, 0.004]))
        running = cloth(laid, boundaries=(floor,), gravity=tilted, friction=(0.4, friction))
        run(running, 0.2)
        before = running.vertices()[1][:, 0].mean()
        run(running, 0.2, 0.2)
        rate = (running.vertices()[1][:, 0].mean() - before) / 0.2
        law = max(0.0, G * (math.sin(angle) - friction * math.cos(angle)))
        assert rate == pytest.approx(law, rel=0.05, abs=0.01)


def test_a_cloth_hung_on_a_body_goes_where_it_goes_and_pulls_it() -> None:
    """Held vertices are where the body takes them; what it feels is the weight and the mass that it must bring along."""
    holder = box((0.1, 0.1, 0.1), (0, 0, 1), "kinematic")
    flat = sheet((0.2, 0.2), 0.05, fabric())
    rows = np.flatnonzero(np.abs(flat.position[:, 1]) > 0.099)
    running = cloth(flat, boundaries=(holder,), holds=(hold(rows, flat.position, 0),))
    bodies, impulse = standing((holder,)), np.zeros(3)
    bodies.velocity[0] = [0.3, 0.0, 0.0]
    for k in range(20):
        report = running.step(0.001, bodies, 0.001 * k)
        impulse += report.impulse[0, :3]
        bodies.position[0] += 0.001 * bodies.velocity[0]
        bodies.center[0] = bodies.position[0]
    x, v = running.vertices()
    assert np.abs(x[rows] - flat.position[rows] - [0.006, 0, 0]).max() < 1e-12
    given = -impulse + flat.mass.sum() * 0.02 * np.array([0, 0, -G])
    assert flat.mass @ v == pytest.approx(given, abs=1e-12)


def test_equal_runs_give_equal_bytes_and_go_on_from_a_checkpoint() -> None:
    """Choice: the same device gives the same bytes, from the start or from a checkpoint that the other run took as well."""

    def made() -> Cloth:
        flat = sheet((0.3, 0.3), 0.03, fabric())
        tilted = np.stack([flat.position[:, 0], flat.position[:, 1] * 0.3, flat.position[:, 1] + 0.17], axis=1)
        return cloth(sheet((0.3, 0.3), 0.03, fabric(), tilted), boundaries=(box((2, 2, 0.2), (0, 0, -0.1)),), drag=((1.2, 0.05),))

    one, two = made(), made()
    for running in (one, two):
        run(running, 0.15)
        running.restore(running.checkpoint())
        run(running, 0.1, 0.15)
    assert one.checkpoint() == two.checkpoint()
    other = made()
    run(other, 0.15)
    state = other.checkpoint()
    fresh = made()
    fresh.restore(state)
    run(fresh, 0.1, 0.15)
    assert fresh.checkpoint() == one.checkpoint()


def test_lists_of_pairs_decide_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Choice: a sheet that falls on its edge is where it is, to the byte, whatever the margins of the lists; steps in batches, as a GPU takes
    them, with too little room for contacts at first, lead there but for rounding, and with other margins to the same bytes."""

    def fallen(*, batches: bool = False) -> Cloth:
        running = thrown(16)
        running._strides = running.grips = None
        if batches:
            running.folds, running.batches = None, Batches(running, running.contacts)
            running.batches._own.widen(0)
        run(running, 0.2)
        return running

    usual = fallen()
    x, _ = usual.vertices()
    assert x[:, 2].max() < 0.97
    monkeypatch.setattr("worldagent.simulation.cloth.folds.AHEAD", 3)
    monkeypatch.setattr("worldagent.simulation.cloth.folds.STRAY", 0.3)
    assert fallen().checkpoint() == usual.checkpoint()
    monkeypatch.setattr("worldagent.simulation.cloth.batches.LEAST", 1)
    batched = fallen(batches=True)
    assert batched.batches is not None
    assert min(batched.batches._own.room, *batched.batches._rooms) > 1
    assert np.abs(batched.vertices()[0] - x).max() < 1e-9
    monkeypatch.setattr("worldagent.simulation.cloth.batches.FAR", (0.8, 0.8, 1.0))
    assert fallen(batches=True).checkpoint() == batched.checkpoint()

"""Long implicit steps of cloth: the motion of short explicit ones, momentum to rounding, little energy lost, none where things meet."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.cloth.energy import bending_energy, membrane_energy
from worldagent.simulation.cloth.factor import Preconditioner
from worldagent.simulation.cloth.grips import Grips
from worldagent.simulation.cloth.solve_kernels import precondition
from worldagent.tests.physics.cloth_sheets import STIFFNESS, box, cloth, fabric, hold, run, sheet
from worldagent.worlds.arrays import F64

G = 9.81
EDGE = 0.02


def _swing(integrator: str, seconds: float, **setup: Any) -> tuple[Any, list[Any]]:
    """A sheet of 0.4 m on its upper edge, pushed as it hangs; it moves for so long."""
    flat = sheet((0.4, 0.4), EDGE, fabric())
    upright = flat.position[:, [0, 2, 1]]
    top = np.flatnonzero(upright[:, 2] > 0.2 - 1e-9)
    speed = np.zeros_like(upright)
    speed[:, 1] = 2.0 * (0.2 - upright[:, 2]) + 0.2 * np.sin(9 * upright[:, 0])
    made = sheet((0.4, 0.4), EDGE, fabric(), upright)
    running = cloth(made, holds=(hold(top, upright),), velocity=speed, integrator=integrator, **setup)
    return running, run(running, seconds)


def _energy(running: Any) -> float:
    x, v = running.vertices()
    own = running.setup.sheets[0]
    return float(
        0.5 * running.mass @ (v**2).sum(1) + G * running.mass @ x[:, 2] + membrane_energy(own, x) + bending_energy(own, x)
    )


@pytest.mark.slow
def test_long_steps_move_a_sheet_as_short_ones_do() -> None:
    """Choice: within 2 % of the way after a quarter of a second, with a fifteenth of the steps; under 3 % of the swing's energy is lost."""
    start = _swing("implicit", 0.0)[0]
    (long, reports), (short, many) = (_swing(kind, 0.2) for kind in ("implicit", "explicit"))
    assert len(reports) == 48
    assert sum(r.steps for r in reports) == 48
    assert sum(r.steps for r in many) > 720
    first, one, other = (r.vertices()[0] for r in (start, long, short))
    way = np.linalg.norm(other - first, axis=1).max()
    assert way > 0.1
    assert np.linalg.norm(one - other, axis=1).max() < 0.02 * way
    kinetic = 0.5 * start.mass @ (start.vertices()[1] ** 2).sum(1)
    lost = _energy(start) - _energy(long)
    assert -1e-3 * kinetic < lost < 0.03 * kinetic


def test_what_holds_a_sheet_bears_what_its_momentum_lacks() -> None:
    """Law: momentum is that of gravity, of the air and of what holds it, to rounding."""
    wind = np.array([3.0, 2.0, 0.0, 1.2])
    running, reports = _swing("implicit", 0.1, drag=((1.2, 0.05),), air=lambda p, t: np.tile(wind, (len(p), 1)))
    assert all(r.steps == 1 for r in reports)
    start = _swing("implicit", 0.0)[0]
    given = sum(r.air[:3] + r.held[:3] + running.mass.sum() * np.array([0, 0, -G]) * r.dt for r in reports)
    assert running.mass @ running.vertices()[1] == pytest.approx(start.mass @ start.vertices()[1] + given, abs=1e-12)
    assert abs(sum(r.air[1] for r in reports)) > 1e-3


def test_a_free_sheet_keeps_momentum_and_angular_momentum_over_long_steps() -> None:
    """Laws: momentum to rounding; angular momentum within 1 % as it turns by a radian and swings, though systems are solved in part."""
    flat = sheet((0.4, 0.4), EDGE, fabric(bend=1e-4))
    x = flat.position + np.array([0, 0, 1.0]) * 0.02 * np.sin(8 * flat.position[:, :1])
    speed = np.cross([1.0, 0.5, 4.0], x) + np.array([0.2, 0.0, 0.1])
    running = cloth(sheet((0.4, 0.4), EDGE, fabric(bend=1e-4), x), gravity=np.zeros(3), velocity=speed, self_collision=False)
    before = [running.mass @ speed, (running.mass[:, None] * np.cross(x, speed)).sum(0)]
    reports = run(running, 0.25)
    assert all(r.steps == 1 for r in reports)
    x, v = running.vertices()
    assert running.mass @ v == pytest.approx(before[0], abs=1e-13)
    turned = (running.mass[:, None] * np.cross(x, v)).sum(0)
    assert np.linalg.norm(turned - before[1]) < 0.01 * np.linalg.norm(before[1])


def test_steps_are_short_where_a_sheet_lands_and_long_where_it_lies() -> None:
    """Choice: long steps while it falls, short ones as it lands, long ones again where it lies; momentum adds up over all."""
    flat = sheet((0.3, 0.3), 0.015, fabric())
    fallen = sheet((0.3, 0.3), 0.015, fabric(), flat.position + np.array([0, 0, 0.05]))
    running = cloth(fallen, boundaries=(box((2, 2, 0.2), (0, 0, -0.1)),))
    reports = run(running, 0.2)
    steps = [r.steps for r in reports]
    landing = next(k for k, count in enumerate(steps) if count > 1)
    # 0.05 m takes a tenth of a second.
    assert 20 <= landing <= 25
    assert steps[landing] > 5
    assert max(steps[-8:]) <= 2
    x, v = running.vertices()
    assert 0 < x[:, 2].min() <= x[:, 2].max() < 1.2 * running.contacts.touch[0]
    given = sum(r.cut[:3] - r.impulse[:, :3].sum(0) + running.mass.sum() * np.array([0, 0, -G]) * r.dt for r in reports)
    assert running.mass @ v == pytest.approx(given, abs=1e-12)
    assert reports[-1].impulse[0, 2] == pytest.approx(-running.mass.sum() * G * reports[-1].dt, rel=0.1)


@pytest.mark.parametrize("friction", [0.3, 0.5])
def test_friction_holds_over_long_steps_what_it_bears(friction: float) -> None:
    """Law, of a fine sheet on a slope of 20 degrees in steps of 1/240 s: at 0.5 it stays, at 0.3 it slides at g (sin - mu cos), within 5 %."""
    angle = math.radians(20)
    tilted = G * np.array([math.sin(angle), 0.0, -math.cos(angle)])
    flat = sheet((0.2, 0.2), EDGE, fabric())
    laid = sheet((0.2, 0.2), EDGE, fabric(), flat.position + np.array([0, 0, 0.0016]))
    running = cloth(laid, boundaries=(box((4, 4, 0.2), (0, 0, -0.1)),), gravity=tilted, friction=(0.4, friction))
    run(running, 0.1)
    before = running.vertices()[1][:, 0].mean()
    reports = run(running, 0.15, 0.1)
    assert sum(r.steps for r in reports) < 0.15 * 600
    rate = (running.vertices()[1][:, 0].mean() - before) / 0.15
    assert rate == pytest.approx(max(0.0, G * (math.sin(angle) - friction * math.cos(angle))), rel=0.05, abs=0.01)


def test_long_steps_give_equal_bytes_and_go_on_from_a_checkpoint() -> None:
    two, _ = _swing("implicit", 0.05)
    state = two.checkpoint()
    fresh, _ = _swing("implicit", 0.0)
    fresh.restore(state)
    for running in (two, fresh):
        run(running, 0.05, 0.05)
    assert two.checkpoint() == fresh.checkpoint()


@pytest.mark.parametrize("step", [1e-5, 1e-3, 4e-3])
@pytest.mark.parametrize("bend", [1e-5, 1e-2])
def test_the_factor_solves_the_sheet_at_rest(step: float, bend: float) -> None:
    """Law: along warp, weft and across, L D L^T is the mass and the squared step's stiffness (without neighbours where both are small)."""
    made = sheet((0.3, 0.2), 0.02, fabric(bend=bend, stretch=(STIFFNESS, 300.0)))
    free = np.arange(3, len(made.mass), dtype=np.int32)
    whole = Preconditioner((made,), free)
    place, factor = whole.factor(step)
    rng = np.random.default_rng(1)
    wanted: F64 = np.zeros((len(made.mass), 3))
    wanted[free] = rng.standard_normal((len(free), 3))
    found = np.zeros_like(wanted)
    frames = np.tile(np.eye(3), (len(wanted), 1, 1))
    precondition(place, frames, *factor, wanted, np.empty((len(free), 3), np.float32), found)
    assert (found[:3] == 0).all()
    for axis, matrix in enumerate(whole.matrices(step)):
        assert matrix @ found[free][:, axis] == pytest.approx(wanted[free][:, axis], abs=1e-4)


def test_a_heap_goes_on_from_a_checkpoint_amid_folds_and_steps_with_contacts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Choice: the same bytes of state and reports as the run through, which went on from the same checkpoints, from one taken while the sheet
    crumples in explicit steps and from ones between steps with contacts."""
    taken = [0]
    step = Grips._step

    def counted(self: Grips, h: float, time: float, solid_speed: float, air: F64) -> bool:
        found = step(self, h, time, solid_speed, air)
        taken[0] += found
        return found

    monkeypatch.setattr(Grips, "_step", counted)
    flat = sheet((0.2, 0.2), 0.0125, fabric()).position
    wave = 0.01 * np.sin(40 * flat[:, 1]) + 0.1 * flat[:, 1]
    upright = sheet((0.2, 0.2), 0.0125, fabric(), np.stack([flat[:, 0], wave, flat[:, 1] + 0.102], axis=1))

    def made() -> Any:
        return cloth(upright, boundaries=(box((2, 2, 0.2), (0, 0, -0.1)),), drag=((1.2, 0.05),))

    def frame(running: Any, number: int) -> list[Any]:
        reports = run(running, 1 / 24, number / 24)
        running.restore(running.checkpoint())
        return reports

    def bytes_of(running: Any, reports: list[Any]) -> list[bytes]:
        told = [getattr(r, name).tobytes() for r in reports for name in ("impulse", "contact", "air", "cut")]
        return [running.checkpoint(), *told, *(repr((r.dt, r.steps, r.fastest, r.work)).encode() for r in reports)]

    through, states, frames, grips = made(), [], [], []
    for k in range(9):
        before = taken[0]
        states.append(through.checkpoint())
        reports = frame(through, k)
        frames.append(bytes_of(through, reports))
        grips.append(taken[0] - before)
        if k in (3, 4):
            assert grips[k] == 0
            assert max(r.contacts for r in reports) > 1000
    assert min(grips[6:]) > 5
    for start in (4, 7, 8):
        resumed = made()
        resumed.restore(states[start])
        for k in range(start, 9):
            assert bytes_of(resumed, frame(resumed, k)) == frames[k], (start, k)

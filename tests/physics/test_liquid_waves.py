"""Declared waves on both engines: dispersion, height, reflection, books (R57, R58, R99).

Flumes two spacings wide: a zone of one wavelength that makes waves of 1 s on 0.5 m of water (k d = 2.1), sea, and a zone that takes
them in. The surface is split into a wave each way at the declared frequency; the wavenumber is fitted, not assumed.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from worldagent.tests.simulation.liquid.wave_flume import FPS, Surface, Waves, engine_of, fitted, flume, watch

PERIOD, DEPTH, G = 1.0, 0.5, 9.81
LENGTH = 1.513
"""[m] Length of such waves: d / L0 = 0.3202 gives d / L = 0.3305. Engine and judge share their dispersion relation, so it is not asked
here."""
ENERGY = 0.15
"""Own choice: energy of the water over the work of the zones; a grid's settling at the start is in it."""


@cache
def run(kind: str, spacing: float, height: float, seconds: float = 8.0) -> tuple[Surface, Waves, Waves]:
    """Surface of a run; its waves over the sea between the zones, and just where they leave their zone."""
    setup = flume(spacing, between=1.0, period=PERIOD, depth=DEPTH, height=height)
    surface = watch(engine_of(kind, setup), seconds, setup.waves[0].sea)
    sea = setup.waves[0].sea
    spans = ((LENGTH, 2.0 * LENGTH), (0.9 * LENGTH, 1.4 * LENGTH))
    first, second = (fitted(surface, float(sea.omega[0]), float(sea.number[0]), span, 2.0 * PERIOD) for span in spans)
    return surface, first, second


def test_waves_on_a_grid_have_the_length_and_height_of_their_period_and_leave_at_the_end() -> None:
    """Law: omega^2 = g k tanh(k d), gate 5 %. Height where they leave the zone 15 %, reflection 10 % (own gates).

    Measured at 24 cells a wave and a steepness of 0.053: length 1.003, height 0.90, reflection 0.012.
    """
    _, sea, near = run("flip", 0.0625, 0.08)
    assert sea.length == pytest.approx(LENGTH, rel=0.05)
    assert 2.0 * near.forward == pytest.approx(0.08, rel=0.15)
    assert sea.backward < 0.10 * sea.forward


def test_the_zones_work_is_what_the_water_gained() -> None:
    """Law: nothing else moves water in a closed flume, so that it never gains more than was given; gate: its energy at rest."""
    surface, _, _ = run("flip", 0.0625, 0.08)
    work = surface.driven[:, 3]
    still = surface.time < PERIOD / 4
    settled = float(np.abs(surface.energy[still]).max())
    assert work[-1] > 1.0
    assert (surface.energy - work).max() < settled + ENERGY * work[-1]


def test_a_flume_without_an_absorbing_zone_throws_waves_back() -> None:
    """Limit case: the same measure finds the standing wave in front of a wall, so that it can tell that there is none."""
    setup = flume(0.0625, between=0.0, period=PERIOD, depth=DEPTH, height=0.06, absorb=[])
    sea = setup.waves[0].sea
    surface = watch(engine_of("flip", setup), 7.0, sea)
    found = fitted(surface, float(sea.omega[0]), float(sea.number[0]), (1.2 * LENGTH, 2.0 * LENGTH), PERIOD)
    assert found.backward > 0.5 * found.forward


@pytest.mark.slow
@pytest.mark.parametrize("height", [0.06, 0.1])
def test_finer_cells_keep_length_height_and_silence(height: float) -> None:
    """The same on 36 cells a wave; second order in steepness makes waves of 0.1 m 2 % longer (Stokes)."""
    _, sea, near = run("flip", LENGTH / 36, height)
    stokes = 1.0 + 0.5 * (math.pi * height / LENGTH) ** 2
    assert sea.length == pytest.approx(LENGTH * stokes, rel=0.05)
    assert 2.0 * near.forward == pytest.approx(height, rel=0.15)
    assert sea.backward < 0.10 * sea.forward


@pytest.mark.slow
@pytest.mark.parametrize("spacing", [0.05, 0.04])
def test_waves_of_particles_leave_their_zone_as_high_as_declared_and_end(spacing: float) -> None:
    """Gates as above for height and reflection. Measured at 30 and 38 spacings a wave: height 0.95 and 0.88, reflection 0.029 and 0.012."""
    _, sea, near = run("dfsph", spacing, 0.12, 7.0)
    assert 2.0 * near.forward == pytest.approx(0.12, rel=0.15)
    assert sea.backward < 0.10 * sea.forward


SHORT = pytest.mark.xfail(strict=True, reason="measured 0.936 of the length that the period asks for")


@pytest.mark.slow
@pytest.mark.parametrize("spacing", [0.05, pytest.param(0.04, marks=SHORT)])
def test_waves_of_particles_have_the_length_of_their_period(spacing: float) -> None:
    """Law and gate as above.

    Known gap: particles make waves too short, 0.952 and 0.936 of it at 30 and 38 spacings a wave. Finer particles and lower waves are no
    better, and the return current is slower than on the grid; why is not known.
    """
    _, sea, _ = run("dfsph", spacing, 0.12, 7.0)
    assert sea.length == pytest.approx(LENGTH, rel=0.05)


@pytest.mark.slow
def test_a_spectrum_makes_the_surface_that_was_declared() -> None:
    """The series where waves leave the zone follows that of the declared sea: linear theory, no fit."""
    setup = flume(0.0625, between=0.5, period=1.3, depth=DEPTH, height=0.12, spectrum="jonswap", components=24, seed=3)
    sea = setup.waves[0].sea
    surface = watch(engine_of("flip", setup), 16.0, sea)
    column = int(np.argmin(np.abs(surface.x - setup.waves[0].width)))
    late = surface.time > 7.0
    measured = surface.eta[late, column] - surface.eta[late, column].mean()
    wanted = sea.elevation(np.tile([surface.x[column], 0.0], (int(late.sum()), 1)), surface.time[late])
    assert float(np.corrcoef(measured, wanted)[0, 1]) > 0.85
    assert float(measured.std()) == pytest.approx(float(wanted.std()), rel=0.15)
    assert int(late.sum()) == FPS * 9

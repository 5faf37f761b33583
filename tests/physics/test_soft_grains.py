"""Grains that are as stiff as the rule asks bear what rolls over them; softer ones are pressed into each other (24.6, Hertz)."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.bench.skill_particles import floor, still
from worldagent.simulation.particles.engine import Grains
from worldagent.simulation.particles.packing import fill_box
from worldagent.simulation.particles.setup import GrainSetup, Kind
from worldagent.testing.worlds.small_grains import sand_spec
from worldagent.verifiers.categories.particles.bounds import OVERLAP
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.particles.facts import softest_under
from worldagent.worlds.patch import parse_spec

RADIUS, DEPTH, STEEL, G = 0.008, 6.0, 7800.0, 9.81
"""Radius of the grains [m], depth of the bed in radii, density of the ball [kg/m^3], gravity."""


def pressed(size: float, young: float, seed: int) -> float:
    """Largest overlap of grains, in radii, under a ball of `size` radii that rolls over a bed for 0.35 s after it has settled in."""
    reach = max(12.0, 3.0 * size) * RADIUS
    bed, radii = fill_box(
        np.array([-reach, -reach, RADIUS]), np.array([reach, reach, DEPTH * RADIUS]), RADIUS, share=0.58, spread=0.1, seed=seed
    )
    ball = np.array([[-0.5 * reach, 0.0, (DEPTH + 1.0 + size) * RADIUS]])
    kinds = tuple(Kind(n, d, young, 0.25, 0.3, 0.5, 0.1, 0.0) for n, d in (("bed", 2600.0), ("ball", STEEL)))
    setup = GrainSetup(
        lower=np.full(3, -4 * reach), upper=np.full(3, 4 * reach), kinds=kinds, position=np.concatenate([bed, ball]),
        velocity=np.concatenate([np.zeros_like(bed), [[0.3, 0.0, 0.0]]]), radius=np.append(radii, size * RADIUS),
        kind=np.append(np.zeros(len(radii)), 1).astype(np.int32), gravity=np.array([0.0, 0.0, -G]),
        boundaries=(floor(4 * reach, reach),), centers=(np.zeros(3),),
    )  # fmt: skip
    grains, worst = Grains(setup), 0.0
    for k in range(30):
        grains.step(0.5 / 30, still(1))
        c = grains.columns()
        own = c["kind"] == 0
        if k >= 9:
            worst = max(worst, overlap(c["position"][own], c["radius"][own]))
    return worst


def overlap(place: np.ndarray, radius: np.ndarray) -> float:
    apart = np.linalg.norm(place[:, None] - place, axis=2) + np.diag(np.full(len(place), np.inf))
    return float(((radius[:, None] + radius - apart) / np.minimum(radius[:, None], radius)).max())


@pytest.mark.parametrize("size", [2.0, 4.0])
def test_what_rolls_over_grains_as_stiff_as_the_rule_presses_them_by_a_tenth_of_the_radius_at_most(size: float) -> None:
    assert 0.2 * OVERLAP < pressed(size, softest_under(weight_of(size), RADIUS), seed=0) <= OVERLAP


def test_grains_far_softer_than_the_rule_are_pressed_deeper() -> None:
    assert pressed(2.0, softest_under(weight_of(2.0), RADIUS) / 12.0, seed=0) > OVERLAP


def weight_of(size: float) -> float:
    """Weight of a steel ball of so many grain radii [N]."""
    return 4.0 / 3.0 * np.pi * (size * RADIUS) ** 3 * STEEL * G


def warned(young: float) -> list[str]:
    spec = parse_spec({**sand_spec(radius=RADIUS, young=young), "prompt": "A ball falls into sand."})
    return [w for w in audit(spec).warnings if "young_modulus" in w]


def test_the_audit_tells_of_grains_too_soft_for_a_ball() -> None:
    """The ball of 25 mm radius weighs 5.0 N: 100 x 5.0 N / (8 mm)^2 = 7.8e6 Pa."""
    (told,) = warned(6e6)
    assert "'ball' presses with up to 5.01 N" in told
    assert "young_modulus of about 7.8e+06 Pa" in told
    assert warned(8e6) == []
    assert warned(7.8e6) == []


def test_a_warning_that_stood_before_an_edit_is_counted_and_not_told_again() -> None:
    before = parse_spec({**sand_spec(radius=RADIUS, young=6e6), "prompt": "A ball falls into sand."})
    report = audit(before.model_copy(update={"title": "Sand"}))
    place = "/entities/sand/physics/young_modulus"
    assert any(w.startswith(f"{place}: ") for w in report.told_after(None))
    softer = parse_spec({**sand_spec(radius=RADIUS, young=5e6), "prompt": "A ball falls into sand."})
    assert any(w.startswith(f"{place}: ") for w in report.told_after(softer))
    again = report.told_after(before)
    assert not any(w.startswith(place) for w in again)
    assert any("stand as the revision before had them" in w and place in w for w in again)

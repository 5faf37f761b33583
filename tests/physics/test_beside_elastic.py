"""Rigid bodies move the same with and without an elastic body in their instance: bounces, slides, rolling, stacks, hits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.testing.defects._films import Film, copied, film_of
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.verifiers.categories.check import check as check_category
from worldagent.worlds.spec import ElasticPhysics, Entity, Material, RigidSettings

G, FPS, STEP, SKIN = 9.81, 24, 5e-4, 5e-4
BOUNCE, RUBS = 0.7, 0.3


def _things() -> dict[str, Entity]:
    return {
        "floor": ground(),
        "ball": ball(0.05, motion="dynamic", at=(0, 0, 0.5)),
        "sled": box(0.2, 0.2, 0.1, motion="dynamic", at=(0, 1, 0.051), velocity=(1.5, 0, 0)),
        "roller": ball(0.05, motion="dynamic", at=(0, 2, 0.051), velocity=(1.0, 0, 0)),
        "striker": ball(0.05, motion="dynamic", at=(-0.3, 3, 0.051), velocity=(1.0, 0, 0)),
        "struck": ball(0.05, motion="dynamic", at=(0, 3, 0.051)),
        **{f"block{k}": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, -1, 0.051 + 0.101 * k)) for k in range(3)},
    }


def _film(*, pad: bool) -> Film:
    things = _things()
    if pad:
        soft = ElasticPhysics(young_modulus=1e5, poisson_ratio=0.4, damping=0.002, resolution=0.1)
        things["pad"] = box(0.2, 0.2, 0.1, motion="dynamic", at=(0, -3, 0.0515), physics=soft)
    materials = {"wood": Material(density=700.0, friction=RUBS, restitution=BOUNCE)}
    spec = world(things, frames=24, fps=FPS, materials=materials, settings=RigidSettings(step=STEP, skin=SKIN, sleep=False))
    return film_of(spec, {n: build_entity(spec, n, Path()) for n in things})


@pytest.fixture(scope="module")
def beside() -> Film:
    return _film(pad=True)


@pytest.fixture(scope="module")
def alone() -> Film:
    return _film(pad=False)


def _of(film: Film, name: str, channel: str = "velocity") -> Any:
    return film.series(channel, name)


def test_a_ball_bounces_by_its_restitution(beside: Film) -> None:
    """Newton's law of impact: of the energy above the floor e^2 is left after a bounce, within 3 %; it did not bounce at all once."""
    z, v = _of(beside, "ball", "position")[:, 2], _of(beside, "ball")[:, 2]
    energy = G * (z - 0.05 - 2 * SKIN) + 0.5 * v**2
    turned = int(np.flatnonzero(v > 0.5)[0])
    assert energy[turned] / energy[turned - 2] == pytest.approx(BOUNCE**2, rel=0.03)


def test_a_sled_is_slowed_by_coulomb_and_does_not_hop(beside: Film) -> None:
    """Coulomb's law: dv/dt = mu g within 1 % while it slides, and its height stays within a tenth of the skins."""
    v, z = _of(beside, "sled")[:, 0], _of(beside, "sled", "position")[:, 2]
    sliding = slice(2, 10)
    assert v[9] > 0.2
    slowed = -np.polyfit(np.arange(24)[sliding] / FPS, v[sliding], 1)[0]
    assert slowed == pytest.approx(RUBS * G, rel=0.01)
    assert np.ptp(z[sliding]) < 0.1 * SKIN


def test_rolling_starts_at_five_sevenths(beside: Film) -> None:
    """Balance of momentum: a ball set sliding rolls without slip at 5/7 of its speed, within 1 %."""
    assert _of(beside, "roller")[-1, 0] == pytest.approx(5 / 7, rel=0.01)


def test_a_hit_hands_on_momentum_and_spin(beside: Film, alone: Film) -> None:
    """A ball that rolls hits one that lies: impact with friction between the two and with the floor, speeds after it within 3 %."""
    for name in ("striker", "struck"):
        assert _of(beside, name)[-1, 0] == pytest.approx(float(_of(alone, name)[-1, 0]), rel=0.03)


def test_a_stack_stands(beside: Film) -> None:
    for k in range(3):
        place = _of(beside, f"block{k}", "position")
        assert np.abs(place[12:] - place[12]).max() < 5e-5
        assert np.linalg.norm(_of(beside, f"block{k}")[12:], axis=1).max() < 5e-3


@pytest.mark.parametrize("name", ["ball", "sled", "roller", "striker", "struck"])
def test_motions_are_those_without_the_pad(name: str, beside: Film, alone: Film) -> None:
    """The same law by two routes of the engine: places differ by less than 1 cm over a second, of ways of up to 1 m."""
    assert np.abs(_of(beside, name, "position") - _of(alone, name, "position")).max() < 0.01


def test_its_impacts_are_judged_one_by_one(beside: Film, tmp_path: Path) -> None:
    """The judge finds the bounces of the ball and the hit in the log of impacts, and finds them right; a false bounce is found."""
    film = copied(beside)
    row = next(r for r in check_category(film.candidate(tmp_path / "real")) if r.id == "category:rigid:rebounds:rigid")
    assert row.status == "pass"
    assert row.evidence["impacts"] >= 2
    film.frames = [{**f, "impact/vector": f["impact/vector"] * 1.3} for f in film.frames]
    edited = {r.id: r for r in check_category(film.candidate(tmp_path / "edited")) if r.id.startswith("category:rigid:")}
    assert "fail" in {r.status for r in edited.values()}

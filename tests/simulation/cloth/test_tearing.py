"""Sheets that tear: at their strength and not below it, where they are weakest, with nothing lost, and the same again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.cloth.solver import SolverCloth
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_cloth import PULLED_PROMPT, pulled_spec
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec

FRAMES, STRENGTH, STIFFNESS = 10, 20.0, 1000.0
BREAKS = STRENGTH / STIFFNESS
"""Stretch at which the strip bears its strength."""


def _pulled(folder: Path, share: float, **changes: Any) -> Candidate:
    """A strip that is drawn out, slowly against the sound in it, to a share of the stretch at which it breaks."""
    spec = pulled_spec(stretch=share * BREAKS, strength=STRENGTH, frames=FRAMES, **changes)
    return simulate(folder, parse_spec({**spec, "prompt": PULLED_PROMPT}))


def _tears(candidate: Candidate) -> list[dict[str, Any]]:
    cache = candidate.cloth_caches["cloth"]
    return [cache.read(k) for k in range(FRAMES)]


@pytest.fixture(scope="module")
def notched(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A strip with a notch in the middle of its upper side, drawn out to 0.9 of what it would bear without."""
    return _pulled(tmp_path_factory.mktemp("notched"), 0.9, notch=True)


def test_a_strip_holds_below_its_strength_and_tears_above(tmp_path: Path) -> None:
    """Law: without Poisson's effect the tension of a strip is stiffness times stretch, everywhere."""
    held = _tears(_pulled(tmp_path / "held", 0.95))
    assert sum(len(f["tear/time"]) for f in held) == 0
    torn = _tears(_pulled(tmp_path / "torn", 1.1))
    first = next(k for k, f in enumerate(torn) if len(f["tear/time"]))
    assert torn[first]["tear/tension"][0] == pytest.approx(STRENGTH, rel=0.05)
    stretch = 1.1 * BREAKS * torn[first]["tear/time"][0] / (0.8 * (FRAMES - 1) / 24)
    assert stretch == pytest.approx(BREAKS, rel=0.1)
    assert torn[-1]["record/torn_length"] >= 0.25


def test_a_notched_strip_tears_from_its_notch(notched: Candidate) -> None:
    frames = _tears(notched)
    points = np.concatenate([f["tear/point"] for f in frames])
    assert len(points) > 2
    assert np.abs(points[0, 0]) < 0.08
    assert points[0, 1] == pytest.approx(0.075, abs=0.03)
    assert np.abs(points[:, 0]).max() < 0.15
    assert points[:, 1].min() < -0.05
    assert frames[-1]["record/torn_length"] > 0.19


def test_nothing_is_lost_where_it_tears(notched: Candidate) -> None:
    """Mass, and momentum against what was given; corners part only where sides are open."""
    frames = _tears(notched)
    masses = [float(f["record/mass"]) for f in frames]
    assert np.ptp(masses) < 1e-15
    for f in frames:
        for axis in "xyz":
            told = sum(float(f[f"record/{by}_impulse_{axis}"]) for by in ("air", "hold", "solid", "cut"))
            assert float(f[f"record/momentum_{axis}"]) == pytest.approx(told, abs=1e-9)


def test_a_torn_run_repeats_and_goes_on_from_its_checkpoint(notched: Candidate) -> None:
    """Choice: the same bytes again; from a checkpoint before and one after the tear."""

    def fresh(resumed: bool) -> SolverCloth:
        made = SolverCloth(notched.spec, notched.built, "cloth", caches=notched.rigid_caches)
        made.prepare(resumed=resumed)
        return made

    one, states = fresh(False), {}
    for k in range(1, FRAMES):
        one.advance(k)
        if k in (2, FRAMES - 2):
            states[k] = one.checkpoint()
    assert float(one.frame_data()["record/torn_length"]) > 0
    for name, values in _tears(notched)[-1].items():
        assert np.array_equal(values, one.frame_data()[name]), name
    for k, state in states.items():
        other = fresh(True)
        other.restore(state, k)
        for frame in range(k + 1, FRAMES):
            other.advance(frame)
            if frame in states:
                assert other.checkpoint() == states[frame]
        assert other.checkpoint() == one.checkpoint()
        for name, values in one.frame_data().items():
            assert np.array_equal(values, other.frame_data()[name]), name

"""Impulses of fields on elastic bodies that the judge takes from the frames: what swings within one, and what is missing or doubled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.physics.drag import Medium, face_drag
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.by_category import SMALL_WORLDS
from worldagent.verifiers.categories.elastic import fields
from worldagent.verifiers.categories.elastic.bounds import FIELD
from worldagent.worlds.arrays import F64
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.deforming import Deforming

FRAMES = 8


@pytest.fixture(scope="module")
def landing(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A jelly that falls in still air, lands in the second frame and swings."""
    spec = SMALL_WORLDS["elastic"].make()
    spec = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"frames": FRAMES})})
    folder = tmp_path_factory.mktemp("world")
    built = {name: build_entity(spec, name, Path()) for name in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=FRAMES)
    return Candidate(folder, spec, built, "full", caches, "run", cache_digest(caches))


def judged(candidate: Candidate, monkeypatch: pytest.MonkeyPatch, factor: F64) -> tuple[str, float, int | None]:
    """Status, measured share and frame where the recorded impulses are `factor` times what they are, shape (frames,)."""
    cache = candidate.rigid_caches["rigid"]
    given = factor[:, None, None] * fields.field_impulses(candidate, cache)
    monkeypatch.setattr(fields, "field_impulses", lambda *_: given)
    found = fields.fields(candidate, "rigid", cache)
    assert found.measured is not None
    return found.status, found.measured, found.frame


def test_a_landing_within_a_frame_is_no_fault_of_the_drag(landing: Candidate, monkeypatch: pytest.MonkeyPatch) -> None:
    status, share, _ = judged(landing, monkeypatch, np.ones(FRAMES))
    assert status == "pass"
    assert share < 0.5 * FIELD


@pytest.mark.parametrize("factor", [0.0, 0.7, 1.4, 2.0, -1.0])
def test_drag_that_is_missing_doubled_or_off_by_a_third_is_found(
    landing: Candidate, monkeypatch: pytest.MonkeyPatch, factor: float
) -> None:
    status, _, frame = judged(landing, monkeypatch, np.full(FRAMES, factor))
    assert (status, frame is not None) == ("fail", True)


@pytest.mark.parametrize("factor", [0.0, 2.0])
def test_drag_that_is_missing_or_doubled_in_the_frame_of_the_landing_alone_is_found(
    landing: Candidate, monkeypatch: pytest.MonkeyPatch, factor: float
) -> None:
    wrong = np.ones(FRAMES)
    wrong[2] = factor
    assert judged(landing, monkeypatch, wrong)[::2] == ("fail", 2)


def test_the_path_between_frames_has_the_way_and_the_velocities_of_both(landing: Candidate) -> None:
    """Law: along a cubic path the halfway state is exact, so that x = t^3 is at 1/8 and as fast as 3/4 at t = 1/2."""

    class Cubic(Deforming):
        def positions(self, frame: int, part: str | None = None) -> F64:
            return np.full((1, 3), float(frame) ** 3)

        def velocities(self, frame: int, part: str | None = None) -> F64:
            return np.full((1, 3), 3.0 * float(frame) ** 2)

    _, halfway, _ = fields._states(Cubic.__new__(Cubic), 1, 1.0)
    assert halfway.places == pytest.approx(0.125)
    assert halfway.speeds == pytest.approx(0.75)


def test_quadratic_drag_of_an_even_acceleration_is_integrated_exactly_by_three_states() -> None:
    """Law: the integral of (a t)^2 over a frame is a^2 h^3 / 3; the mean of both ends would give half as much again."""
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    air = Medium(np.zeros((1, 3)), np.full(1, 1.2), np.zeros(1), np.ones(1))
    start, middle, end = (face_drag(air, corners, np.array([[0.0, 0, v]])).force[0, 2] for v in (0.0, 1.0, 2.0))
    assert (start + 4 * middle + end) / 6 == pytest.approx(end / 3)

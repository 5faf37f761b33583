"""What holds of the judge of every category, on a small world that is simulated for a few frames."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.schedule import run_frames
from worldagent.tests.simulation.engine_worlds import built_world
from worldagent.verifiers.catalogue import QUESTIONS
from worldagent.verifiers.categories.judge import Judge
from worldagent.verifiers.categories.registry import JUDGES, judge_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.registry import CATEGORIES
from worldagent.worlds.requirements import Row

WORLDS = {
    "rigid": ("rigid", "ball"),
    "fracture": ("fracture", "wall"),
    "elastic": ("jelly on cloth", "jelly"),
    "cloth": ("jelly on cloth", "cloth"),
    "liquid": ("liquid", "water"),
    "particles": ("particles", "sand"),
}
"""Small world with the category, and an entity of it."""
LEDGERS = {
    "rigid": "category:rigid:momentum",
    "elastic": "category:elastic:records",
    "cloth": "category:cloth:momentum",
    "liquid": "category:liquid:momentum",
    "particles": "category:particles:momentum",
}
"""Question about the momentum of an instance; what breaks has that of the rigid instance that moves it."""


@pytest.fixture(scope="module", params=JUDGES)
def judged(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Judge, Candidate, str]:
    """A judge, a simulated world, and an entity of its category."""
    name, entity = WORLDS[request.param]
    spec, built = built_world(name)
    folder = tmp_path_factory.mktemp("run")
    caches = run_frames(spec, built, folder, frames=spec.simulation.frames)
    return JUDGES[request.param], Candidate(folder, spec, built, "full", caches), entity


def _rows(judge: Judge, candidate: Candidate) -> list[Row]:
    return [
        row
        for solver in judge.instances(candidate.spec)
        for rows in (judge.category_rows(candidate, solver), judge.numerical_rows(candidate, solver))
        for row in rows
    ]


def test_every_category_that_is_judged_has_a_world_here_and_an_entry_in_worlds() -> None:
    assert set(WORLDS) == set(JUDGES)
    assert set(JUDGES) <= set(CATEGORIES)


def test_rows_answer_questions_of_the_catalogue_about_an_instance_or_an_entity_of_it(
    judged: tuple[Judge, Candidate, str],
) -> None:
    judge, candidate, _ = judged
    rows = _rows(judge, candidate)
    assert f"category:{judge.name}" in {r.question.rpartition(":")[0] for r in rows}
    instances = judge.instances(candidate.spec)
    subjects = {"solver": set(instances), "entity": {m for i in instances.values() for m in i.members}}
    for row in rows:
        question = QUESTIONS[row.question]
        assert row.id == question.row_id(row.subject)
        assert all(name in subjects[kind] for kind, name in zip(question.subject, row.subject, strict=True))
    assert len({r.id for r in rows}) == len(rows)


def test_nothing_fails_in_a_sound_world_and_the_momentum_has_its_sources(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, _ = judged
    rows = _rows(judge, candidate)
    assert [(r.id, r.evidence["explanation"]) for r in rows if r.status == "fail"] == []
    closed = [r for r in rows if r.question == LEDGERS.get(judge.name)]
    assert bool(closed) == (judge.name in LEDGERS)
    for row in closed:
        assert row.status == "pass", row.evidence["explanation"]
        assert row.measured is not None
        assert row.bound is not None
        assert row.measured <= row.bound


def test_centre_mass_and_momentum_of_an_entity_are_finite_and_belong_together(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, entity = judged
    owner, count = judge_of(candidate.spec, entity), candidate.frame_count
    assert owner.name == (judge.moved_as or judge.name)
    mass, velocity = owner.mass(candidate, entity), owner.velocities(candidate, entity)
    centers, fastest = owner.centers(candidate, entity), owner.fastest(candidate, entity)
    assert (mass.shape, centers.shape, velocity.shape) == ((count,), (count, 3), (count, 3))
    assert np.isfinite(centers).all()
    assert (mass > 0).all()
    assert np.allclose(owner.momentum(candidate, entity), mass[:, None] * velocity)
    assert (np.linalg.norm(velocity, axis=1) <= fastest * (1 + 1e-3) + 1e-6).all(), (
        "its centre is not faster than its fastest point"
    )
    assert owner.moving(candidate, entity).shape == (count,)


def test_pushes_lie_within_their_frame_between_two_entities_that_are_there(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, _ = judged
    frames = judge.pushes(candidate)
    assert len(frames) == candidate.frame_count
    pushes = [(k / candidate.spec.simulation.fps, p) for k, found in enumerate(frames) for p in found]
    assert bool(pushes) == (not judge.moved_as and judge.name != "elastic"), (
        "those of the others are of `rigid`, in logs of contacts"
    )
    for time, push in pushes:
        assert {push.a, push.b} <= set(candidate.spec.entities)
        assert push.a != push.b
        assert push.begin <= push.end <= time + 1e-9
        assert push.begin >= time - 1.0 / candidate.spec.simulation.fps - 1e-9
        assert np.isfinite(push.impulse)
        assert push.impulse >= 0


def test_an_outline_surrounds_the_centre(judged: tuple[Judge, Candidate, str]) -> None:
    _, candidate, entity = judged
    owner = judge_of(candidate.spec, entity)
    for frame in (0, candidate.last_frame):
        outline, center = owner.outline(candidate, entity, frame), owner.centers(candidate, entity)[frame]
        assert len(outline.faces) > 0
        assert outline.faces.max() < len(outline.vertices)
        low, high = outline.vertices.min(axis=0), outline.vertices.max(axis=0)
        assert ((low - 1e-3 <= center) & (center <= high + 1e-3)).all()


def test_the_register_has_lines_that_say_what_is_simplified_and_what_follows(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, _ = judged
    lines = list(judge.lines(candidate))
    assert lines
    for line in lines:
        assert set(line) == {"what", "effect"}
        assert all(line.values())

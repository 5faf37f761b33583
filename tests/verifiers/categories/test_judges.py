"""Every judge answers about the small world of its category: rows, ledgers, motion, pushes, outline, lines of the register."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.by_category import SMALL_WORLDS
from worldagent.verifiers.catalogue import QUESTIONS
from worldagent.verifiers.categories.check import check, check_numerical
from worldagent.verifiers.categories.judge import Judge
from worldagent.verifiers.categories.registry import JUDGES, judge_of
from worldagent.verifiers.ledgers.origins import Origin
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.register.assemble import approximations
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.registry import CATEGORIES
from worldagent.worlds.predicates import BodyEvent, PairEvent, TouchEvent
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import MOVED

PUSHING = {"rigid", "liquid", "cloth", "particles"}
"""Judges that tell of pushes: those of bodies that bend or break stand in the logs of the rigid instance."""
TOLD_APART = {"rigid": 1e-9, "liquid": 1e-5, "cloth": 1e-6, "particles": 1e-5}
"""Categories whose records tell who gave what, and the share of what was given that none tells of in their small worlds."""
BOOKS = ("ledger", "momentum", "energy", "mass", "balance", "impulse")
"""Words in the ids of rows that balance what is conserved."""


@pytest.fixture(scope="module", params=JUDGES)
def judged(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Judge, Candidate, str]:
    """A judge, a simulated world, and an entity of its category."""
    world = SMALL_WORLDS[request.param]
    spec, folder = world.make(), tmp_path_factory.mktemp("world")
    built = {name: build_entity(spec, name, Path()) for name in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return JUDGES[request.param], Candidate(folder, spec, built, "full", caches, "run", cache_digest(caches)), world.entity


def _rows(judge: Judge, candidate: Candidate) -> list[Row]:
    return [
        row
        for solver in judge.instances(candidate.spec)
        for rows in (judge.category_rows(candidate, solver), judge.numerical_rows(candidate, solver))
        for row in rows
    ]


def test_every_category_that_an_engine_moves_has_a_judge_and_a_small_world() -> None:
    contracts = {name for name, category in CATEGORIES.items() if category.physics is None}
    assert set(JUDGES) == set(SMALL_WORLDS) == set(MOVED) | contracts


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


def test_nothing_fails_in_a_sound_world_and_its_ledgers_close(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, _ = judged
    checked = [*check(candidate), *check_numerical(candidate)]
    assert {r.id for r in _rows(judge, candidate)} <= {r.id for r in checked}
    assert {r.id for r in checked if r.status == "fail"} == set()
    books = [r for r in checked if any(word in r.id for word in BOOKS)]
    assert books
    assert [r.id for r in books if r.status not in ("pass", "not_applicable")] == []


def test_centre_mass_and_momentum_of_an_entity_are_finite_and_belong_together(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, entity = judged
    owner, count = judge_of(candidate.spec, entity), candidate.frame_count
    assert owner.name == (judge.moved_as or judge.name)
    mass, velocity = owner.mass(candidate, entity), owner.velocities(candidate, entity)
    centers, fastest = owner.centers(candidate, entity), owner.fastest(candidate, entity)
    assert (mass.shape, centers.shape, velocity.shape) == ((count,), (count, 3), (count, 3))
    assert np.isfinite(centers).all()
    assert (mass[1:] > 0).all(), "what is let out begins with nothing"
    assert np.allclose(owner.momentum(candidate, entity), mass[:, None] * velocity)
    assert (np.linalg.norm(velocity, axis=1) <= fastest * (1 + 1e-3) + 1e-6).all(), (
        "its centre is not faster than its fastest point"
    )
    assert owner.moving(candidate, entity).shape == (count,)


def test_impulses_by_origin_add_up_to_the_change_of_momentum(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, entity = judged
    owner = judge_of(candidate.spec, entity)
    given, momentum = owner.origins(candidate, entity), owner.momentum(candidate, entity)
    heavy = any(candidate.spec.simulation.gravity)
    assert {o.kind for o in given} >= ({"gravity", "unlisted"} if heavy else {"unlisted"})
    total = np.sum([one.impulse for one in given.values()], axis=0)
    moving = np.flatnonzero(np.abs(total).any(axis=1))
    assert len(moving) > 0
    assert total[moving] == pytest.approx(np.diff(momentum, axis=0)[moving], abs=1e-9 * max(1.0, np.abs(momentum).max()))
    pull = given.get(Origin("gravity", ""), given[Origin("unlisted", "")]).impulse
    if heavy:
        mass = owner.mass(candidate, entity)
        weight = float(0.5 * (mass[1:] + mass[:-1]).max() * 9.81 / candidate.spec.simulation.fps)
        assert np.linalg.norm(pull, axis=1).max() == pytest.approx(weight, rel=0.05)
    passed = sum(float(np.abs(one.impulse).sum()) for origin, one in given.items() if origin.kind != "unlisted")
    if judge.name in TOLD_APART:
        assert any(o.kind == "contact" for o in given)
        assert np.abs(given[Origin("unlisted", "")].impulse).sum() < TOLD_APART[judge.name] * passed


def test_pushes_lie_within_their_frame_between_two_entities_that_are_there(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, _ = judged
    frames = judge.pushes(candidate)
    assert len(frames) == candidate.frame_count
    pushes = [(k / candidate.spec.simulation.fps, p) for k, found in enumerate(frames) for p in found]
    assert bool(pushes) == (judge.name in PUSHING)
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
        if frame == 0 and owner.mass(candidate, entity)[0] == 0.0:
            assert len(outline.faces) == 0, "what is let out is not seen before it comes"
            continue
        assert len(outline.faces) > 0
        assert outline.faces.max() < len(outline.vertices)
        low, high = outline.vertices.min(axis=0), outline.vertices.max(axis=0)
        assert ((low - 1e-3 <= center) & (center <= high + 1e-3)).all()


def test_the_register_has_lines_that_say_what_is_simplified_and_what_follows(judged: tuple[Judge, Candidate, str]) -> None:
    judge, candidate, _ = judged
    lines, told = list(judge.lines(candidate)), approximations(candidate)
    assert lines
    assert [line for line in lines if line not in told or not (line["what"] and line["effect"])] == []


def test_every_kind_of_event_is_asked_of_every_entity_and_of_none_that_never_moves_is_it_true(
    judged: tuple[Judge, Candidate, str],
) -> None:
    """A question that cannot be judged is `unverified`; nothing raises, and no static thing does anything."""
    _, candidate, about = judged
    spec, last = candidate.spec, candidate.last_frame
    asked = []
    for name in spec.entities:
        others = [about if name != about else next(n for n in spec.entities if n != about)]
        models: list[BodyEvent | TouchEvent | PairEvent] = [BodyEvent(kind=k, entity=name) for k in _kinds(BodyEvent)]
        models += [TouchEvent(kind=k, entity=name) for k in _kinds(TouchEvent)]
        models += [PairEvent(kind=k, entity=name, other=o) for k in _kinds(PairEvent) for o in others]
        asked += [(spec.entities[name].motion, m, evaluate(candidate, m, (0, last))) for m in models]
    assert {o.status for _, _, o in asked} <= {"pass", "fail", "unverified"}
    assert [(m, o.explanation) for motion, m, o in asked if motion == "static" and o.status == "pass"] == []


def _kinds(model: type[BodyEvent | TouchEvent | PairEvent]) -> tuple[Any, ...]:
    return get_args(model.model_fields["kind"].annotation)

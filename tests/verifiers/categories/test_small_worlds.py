"""Every judge answers about the small world of its category: its rows, its ledger, its lines of the register, its motion and its outline."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.by_category import SMALL_WORLDS
from worldagent.verifiers.categories.check import check, check_numerical
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.verifiers.register.assemble import approximations
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.registry import CATEGORIES
from worldagent.worlds.spec import MOVED


@pytest.fixture(scope="module", params=JUDGES)
def judged(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Candidate]:
    """Name of a category, and its small world as simulated."""
    folder, spec = tmp_path_factory.mktemp("world"), SMALL_WORLDS[request.param].make()
    built = {name: build_entity(spec, name, Path()) for name in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return request.param, Candidate(folder, spec, built, "full", caches, "run", cache_digest(caches))


def test_every_category_that_an_engine_moves_has_a_judge_and_a_small_world() -> None:
    contracts = {name for name, category in CATEGORIES.items() if category.physics is None}
    assert set(JUDGES) == set(SMALL_WORLDS) == set(MOVED) | contracts


def test_its_rows_stand_in_the_checks_and_its_ledger_closes(judged: tuple[str, Candidate]) -> None:
    name, candidate = judged
    judge = JUDGES[name]
    rows = [*check(candidate), *check_numerical(candidate)]
    assert judge.instances(candidate.spec)
    assert {r.id for s in judge.instances(candidate.spec) for r in judge.category_rows(candidate, s)} <= {r.id for r in rows}
    books = [r for r in rows if any(word in r.id for word in ("ledger", "momentum", "energy", "mass", "balance", "impulse"))]
    assert books
    assert [r.id for r in books if r.status not in ("pass", "not_applicable")] == []


def test_its_entity_moves_as_a_whole_and_has_an_outline(judged: tuple[str, Candidate]) -> None:
    name, candidate = judged
    entity, frames = SMALL_WORLDS[name].entity, candidate.frame_count
    judge = JUDGES[candidate.spec.entities[entity].physics.category]
    assert judge.centers(candidate, entity).shape == judge.momentum(candidate, entity).shape == (frames, 3)
    assert np.isfinite(judge.centers(candidate, entity)).all()
    assert (judge.mass(candidate, entity) > 0).all()
    assert judge.moving(candidate, entity).shape == (frames,)
    outline = judge.outline(candidate, entity, frames - 1)
    assert len(outline.faces) >= 4
    assert np.isfinite(outline.vertices).all()


def test_it_says_what_it_simplifies(judged: tuple[str, Candidate]) -> None:
    name, candidate = judged
    lines = approximations(candidate)
    own = list(JUDGES[name].lines(candidate))
    assert own
    assert [line for line in own if line not in lines] == []
    assert [line for line in lines if not (line["what"] and line["effect"])] == []

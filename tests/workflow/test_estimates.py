"""Time that a probe is told to take beforehand: the rates of what moves, its runs without causes, and the pace of the probes before it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import pytest
from worldagent.execution import JobStore
from worldagent.server.skill_files import SKILLS
from worldagent.workflow.estimates import (
    LAST_PROBES,
    START_S,
    Usual,
    film_estimate,
    pace_seen,
    probe_took,
    still_estimate,
    still_took,
    usual_seconds,
)
from worldagent.worlds.categories.elastic.facts import cell_count
from worldagent.worlds.categories.registry import CATEGORIES
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

WORLDS = ("cloth/flag", "elastic-bodies/jelly", "fracture/breach", "gas/bowl", "particles/collapse", "coupled-systems/crate")


def _spec(name: str, **changed: Any) -> WorldSpec:
    document = json.loads((SKILLS / f"{name}.json").read_text())
    return parse_spec({**document, **changed})


@pytest.mark.parametrize("name", WORLDS)
def test_what_moves_in_a_recorded_world_has_a_rate(name: str) -> None:
    spec = _spec(name)
    found = usual_seconds(spec, spec.simulation.frames)
    assert 0.1 < found.simulation < 200
    assert found.whole == pytest.approx(START_S + found.simulation + found.checks + found.reruns, abs=0.06)


def test_every_category_but_fracture_which_rigid_bodies_carry_has_a_rate() -> None:
    rated = {n for n, c in CATEGORIES.items() if any(c.seconds(_spec(w)) for w in WORLDS)}
    assert rated == set(CATEGORIES) - {"fracture"}


def test_fewer_frames_take_less_and_runs_without_causes_take_time_of_their_own() -> None:
    spec = _spec("fracture/breach")
    whole, half = usual_seconds(spec, spec.simulation.frames), usual_seconds(spec, spec.simulation.frames // 2)
    assert half.simulation < 0.6 * whole.simulation
    assert whole.reruns > 0
    assert "runs without causes" in whole.told
    alone = spec.model_copy(update={"story": spec.story.model_copy(update={"beats": {}, "robustness": {}})})
    assert usual_seconds(alone, spec.simulation.frames).reruns == 0


def test_cells_of_an_elastic_body_follow_its_size_and_resolution() -> None:
    jelly = next(e for e in _spec("elastic-bodies/jelly").entities.values() if e.physics.category == "elastic")
    fine = jelly.model_copy(update={"physics": jelly.physics.model_copy(update={"resolution": 0.5 * min(jelly.dimensions.size)})})
    finer = jelly.model_copy(
        update={"physics": jelly.physics.model_copy(update={"resolution": 0.25 * min(jelly.dimensions.size)})}
    )
    assert cell_count(finer) == pytest.approx(8 * cell_count(fine), rel=0.3)


def test_bodies_of_many_pieces_take_longer_and_are_named() -> None:
    spec = _spec("rigid-bodies/scree")
    name, entity = next((n, e) for n, e in spec.entities.items() if e.motion == "dynamic")
    part = next(iter(entity.parts.values()))
    heavy = entity.model_copy(update={"parts": {f"p{k}": part for k in range(400)}})
    crowded = spec.model_copy(update={"entities": {**spec.entities, name: heavy}})
    plain, found = (usual_seconds(s, s.simulation.frames) for s in (spec, crowded))
    assert found.simulation > 3 * plain.simulation
    assert f"most collision pieces: {name} 400" in found.told
    assert "pieces" not in plain.told


@dataclass
class _Job:
    payload: dict[str, Any]
    finished: float
    kind: str = "probe"
    state: str = "done"
    started: float = 100.0
    result: dict[str, Any] | None = None


@dataclass
class _Jobs:
    jobs: list[_Job]

    def list(self, *, limit: int) -> list[_Job]:
        return self.jobs[:limit]


def _pace(*jobs: _Job) -> float:
    return pace_seen(cast("JobStore", _Jobs(list(jobs))))


def test_the_pace_is_that_of_the_last_probes_that_passed() -> None:
    passed = {"passed": True}
    assert _pace() == 1.0
    assert _pace(_Job({"usual_s": 10.0}, 130.0, result=passed)) == 3.0
    others = (
        _Job({"usual_s": 10.0}, 900.0, state="cancelled", result=passed),
        _Job({"usual_s": 10.0}, 900.0, result={"passed": False}),  # stopped at its first failure, perhaps
        _Job({}, 900.0, result=passed),
        _Job({"usual_s": 10.0}, 900.0, kind="bake", result=passed),
    )
    assert _pace(*others) == 1.0
    assert (
        _pace(
            *others,
            *(_Job({"usual_s": 10.0}, 120.0, result=passed) for _ in range(LAST_PROBES)),
            *[_Job({"usual_s": 1.0}, 900.0, result=passed)] * 9,
        )
        == 2.0
    )


def test_the_pace_of_a_world_is_that_of_its_last_simulation(tmp_path: Path) -> None:
    """Also of one that failed or was stopped: an agent of a trial was told 164 s of a probe that took 530 s, and of the next again."""
    folder, none = WorldFolder(tmp_path), cast("JobStore", _Jobs([_Job({"usual_s": 10.0}, 130.0, result={"passed": True})]))
    assert pace_seen(none, folder) == 3.0
    still_took(folder, 12.0, 100)
    probe_took(folder, 90.0, 20.0)
    assert pace_seen(none, folder) == 4.5
    assert still_estimate(folder, 100) == pytest.approx(12.0)
    usual = Usual(simulation=40.0, checks=9.0, reruns=110.0).at(pace_seen(none, folder))
    assert usual.whole == pytest.approx(START_S + 4.5 * 159.0)
    assert "simulation 180 s, 495 s runs without causes, checks 40 s" in usual.told


def test_a_film_is_estimated_by_the_last_film_and_before_it_by_the_fastest_still(tmp_path: Path) -> None:
    folder, asked = WorldFolder(tmp_path), {"frames": 100, "width": 640, "height": 360, "samples": 8}
    paths = 640 * 360 * 8
    none = cast("JobStore", _Jobs([]))
    assert film_estimate(none, **asked, folder=folder) is None
    still_took(folder, 12.0, paths)
    still_took(folder, 30.0, paths)  # the first of a session, which compiles
    assert film_estimate(none, **asked, folder=folder) == pytest.approx(1200.0)
    assert film_estimate(none, **{**asked, "width": 320, "height": 180}, folder=folder) == pytest.approx(300.0)
    film = _Job({}, 400.0, kind="final", result={"seconds_per_frame": 4.0, "width": 640, "height": 360, "samples": 8})
    assert film_estimate(cast("JobStore", _Jobs([film])), **asked, folder=folder) == pytest.approx(400.0)
    (folder.pictures / "pace.json").write_text("{")
    assert film_estimate(none, **asked, folder=folder) is None

"""Sketches: some frames, coarse and quick. They test a hypothesis, tell what they left coarser, and open no gate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.construction import build_entity
from worldagent.simulation.schedule import run_groups
from worldagent.testing.worlds.small_cloth import FLAG_PROMPT, flag_spec
from worldagent.tests.stories.conftest import Agent
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.session import Session
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec

QUICK = {"linear_velocity": [1.0, 0, 0], "angular_velocity": [0, 50, 0]}
"""The ball of the small world as it should be."""
CURE = [{"op": "replace", "path": f"/entities/ball/physics/{name}", "value": value} for name, value in QUICK.items()]


@pytest.fixture
def slow(agent: Agent, monkeypatch: pytest.MonkeyPatch) -> Agent:
    """A client whose world `w` has a ball that is too slow; nothing is simulated yet."""
    run_jobs_inline(monkeypatch)
    spec = small_spec()
    spec["entities"]["ball"]["physics"] |= {"linear_velocity": [0.3, 0, 0], "angular_velocity": [0, 15, 0]}
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    return agent


def test_a_sketch_tests_a_hypothesis_and_opens_no_gate(slow: Agent) -> None:
    found = slow.call("probe_sim", world="w", sketch={"until": "strike", "steps": 2})
    assert found["frames_sketched"] == 11
    assert found["left_coarser"] == {"/simulation/solvers/rigid/settings/step": 0.001}
    assert [r["id"] for r in found["open_rows"]] == ["beat:strike"]
    assert found["beats_true_from"]["strike"] is None
    ledger = Session.at(WorldFolder.at(slow.workspace / "w")).ledger
    assert not [r.id for r in ledger.rows() if r.id == "beat:strike"]
    assert ledger.freezes() == []
    assert "passing probe" in slow.refused("bake_sim", world="w")

    assert "a sketch of frames 0..10" in slow.refused("edit_spec", world="w", patch=CURE)
    assert "weakening_reason" in slow.refused(
        "edit_spec", world="w", patch=[{"op": "replace", "path": "/story/beats/strike/predicate/min_impulse", "value": 0.001}]
    )
    slow.call("edit_spec", world="w", patch=CURE, hypothesis="the ball is too slow to come there in time")
    again = slow.call("probe_sim", world="w", sketch={"until": "fall"})
    assert (again["left_coarser"], again["counts"]["fail"]) == ({}, 0)
    assert again["beats_true_from"]["fall"] is not None
    assert again["next"] == "probe_sim(world='w')"


def test_the_frames_of_a_sketch_can_be_read_and_drawn_and_are_not_judged(slow: Agent) -> None:
    slow.call("probe_sim", world="w", sketch={"until": 12, "steps": 2})
    seen = slow.call("inspect_world", world="w", part="state", entities=["ball"], frames=[0, 10])
    assert seen["source"].endswith("/sketch")
    places = seen["entities"]["ball"]["position"]
    assert places[10][0] > places[0][0] + 0.05
    assert not slow.result("render_shot", world="w", kind="preview", frame=10).is_error
    assert "out of range" in slow.refused("render_shot", world="w", kind="preview", frame=13)
    assert "no probe" in slow.refused("run_checks", world="w", scope="probe")
    slow.call("edit_spec", world="w", patch=CURE, hypothesis="the ball is too slow to come there in time")
    assert slow.call("inspect_world", world="w", part="state", entities=["ball"])["source"] == "world.json", "other settings"


def test_a_sketch_is_the_test_of_the_change_that_a_failed_probe_asked_for(slow: Agent) -> None:
    assert not slow.call("probe_sim", world="w")["passed"]
    slow.call("edit_spec", world="w", patch=CURE[:1], hypothesis="it need not spin, only be quick")
    ledger = Session.at(WorldFolder.at(slow.workspace / "w")).ledger
    assert "not tested yet" in slow.refused("edit_spec", world="w", patch=CURE[1:], hypothesis="it should spin as well")
    slow.call("probe_sim", world="w", sketch={"until": 12})
    assert ledger.open_iterations() == []
    (tested,) = ledger.iterations()
    assert tested["probe"].startswith("sketch")
    rows = {r.id: r for r in ledger.rows()}
    assert rows["beat:strike"].status == "unverified", "what the probe found stays, stale, until a probe says otherwise"
    slow.call("edit_spec", world="w", patch=CURE[1:], hypothesis="it should spin as well")


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"until": "strik"}, "did you mean 'strike'"),
        ({"until": 36}, "1 to 35"),
        ({"until": 0}, "1 to 35"),
        ({"until": 5, "only": ["rigd"]}, "the world has ['rigid']"),
        ({"until": 5, "steps": 5}, "less than or equal to 4"),
        ({"until": 5, "speed": 2}, "speed"),
    ],
)
def test_a_sketch_of_what_is_not_there_is_refused_with_what_is(slow: Agent, asked: dict[str, Any], told: str) -> None:
    assert told in slow.refused("probe_sim", world="w", sketch=asked)


def test_only_the_chosen_instances_run_and_those_that_they_read(tmp_path: Path) -> None:
    spec = parse_spec({**flag_spec(frames=4, resolution=0.2), "prompt": FLAG_PROMPT})
    built = {name: build_entity(spec, name, tmp_path) for name in spec.entities}
    (cloth,) = spec.simulation.cloth

    def run(*only: str) -> set[str]:
        return set(run_groups(spec, built, tmp_path / only[0], frames=2, tell=lambda *_: None, only=frozenset(only)))

    assert run("rigid") == {"rigid"}
    assert run(cloth) == {"rigid", cloth}


def test_the_frames_of_a_sketch_can_be_looked_at(slow: Agent) -> None:
    """Own choice: what was sketched is motion of the present settings, and the only one until a probe; an edit of physics leaves none."""
    assert "no sketch" in slow.refused("render_shot", world="w", stage="sketch", frame=5)
    slow.call("probe_sim", world="w", sketch={"until": "strike", "steps": 2})
    camera = {"position": [0.6, -0.6, 0.4], "target": [0, 0, 0.1]}
    drawn = slow.call("render_shot", world="w", frame=8, camera=camera, width=96, height=64)
    assert "from the sketch candidate" in drawn["summary"]
    assert drawn["source"].endswith("/sketch")
    state = slow.call("inspect_world", world="w", part="state", entities=["ball"], frames=[0, 10])
    assert state["stage"] == "sketch"
    beyond = slow.call("inspect_world", world="w", part="state", entities=["ball"], frames=[0, 20])
    assert beyond["warnings"] == ["the sketch run has frames 0..10: told is up to there"]
    assert beyond["entities"] == state["entities"]
    assert "allowed 0..10 in the sketch run" in slow.refused("inspect_world", world="w", part="state", frames=[11, 11])

    slow.call("edit_spec", world="w", patch=CURE, hypothesis="the ball is too slow to come there in time")
    assert "no sketch" in slow.refused("render_shot", world="w", stage="sketch", frame=5)
    assert not slow.call("probe_sim", world="w").get("state")
    assert (
        "from the probe candidate" in slow.call("render_shot", world="w", frame=8, camera=camera, width=96, height=64)["summary"]
    )

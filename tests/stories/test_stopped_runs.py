"""Probes that end early: by a row that fails for good, by their caller, by their engine. Their frames stay evidence, and no gate takes them for a pass."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction import build_world
from worldagent.execution import Cancelled, run_inline
from worldagent.simulation.runs import Run
from worldagent.tests.stories.conftest import Agent
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow import probes
from worldagent.workflow.live_judge import judge_begun
from worldagent.workflow.session import Session
from worldagent.worlds.begun import open_begun
from worldagent.worlds.errors import EngineError, EvidenceError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row

SLOW = {"linear_velocity": [0.3, 0, 0], "angular_velocity": [0, 15, 0]}
"""The ball of the small world comes too late: `strike` fails at frame 10 and `fall` at frame 24, of 36."""


class Beside:
    """A live judge in this process, which looks at every seventh frame."""

    def __init__(self, root: Path) -> None:
        self._root, self._freeze, self._seen, self._told = root, "", -1, set[str]()

    def watch(self, freeze: str) -> None:
        self._freeze = freeze

    def news(self) -> list[Row]:
        try:
            begun = open_begun(WorldFolder.at(self._root), self._freeze, "probe")
        except EvidenceError:
            return []
        last, rows = begun.candidate.last_frame, list[Row]()
        if last != self._seen and last % 7 == 0:
            judge_begun(begun.candidate, begun.unmoved, rows.extend)
        self._seen = last
        fresh = [r for r in rows if r.id not in self._told]
        self._told |= {r.id for r in fresh}
        return fresh

    def close(self) -> None:
        self._freeze = ""


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch) -> None:
    """Probes in this process are judged while they run, and stop at the first failure however little is left."""
    monkeypatch.setattr(probes, "LiveJudge", Beside)
    monkeypatch.setattr(probes, "WORTH_STOPPING_S", 0.0)
    run_jobs_inline(monkeypatch)


@pytest.fixture
def slow(agent: Agent) -> Agent:
    """A client whose world `w` has the ball that is too slow; built, not probed."""
    spec = small_spec()
    spec["entities"]["ball"]["physics"] |= SLOW
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    agent.call("place_object", world="w")
    return agent


def _statuses(agent: Agent) -> dict[str, str]:
    ledger = Session.at(WorldFolder.at(agent.workspace / "w")).ledger
    return {r.id: r.status for r in ledger.rows()}


def _frames(agent: Agent) -> Callable[[], dict[str, bytes]]:
    return lambda: {p.name: p.read_bytes() for p in (agent.workspace / "w").glob("candidates/*/probe/rigid/frame_*.npz")}


def test_a_row_that_fails_ends_the_run_and_the_same_call_goes_on_from_there(slow: Agent, judged: None) -> None:
    stopped = slow.call("probe_sim", world="w")
    assert (stopped["passed"], stopped["stopped_by"], stopped["of_frames"]) == (False, ["beat:strike"], 36)
    assert 10 <= stopped["stopped_at"] < 24
    rows = _statuses(slow)
    assert (rows["beat:strike"], rows["beat:fall"]) == ("fail", "unverified")
    assert "frame" in stopped["summary"]
    assert "stop_at='never'" in stopped["next"]
    early = _frames(slow)()

    whole = slow.call("probe_sim", world="w", stop_at="never")
    assert (whole["passed"], whole["frames_probed"]) == (False, 36)
    assert "stopped_at" not in whole
    assert _statuses(slow)["beat:fall"] == "fail"
    later = _frames(slow)()
    assert {n: later[n] for n in early} == early
    assert len(later) == 36


def test_the_frames_of_a_stopped_run_are_read_drawn_and_judged(slow: Agent, judged: None) -> None:
    last = slow.call("probe_sim", world="w")["stopped_at"]
    seen = slow.call("inspect_world", world="w", part="state", entities=["ball"], frames=[0, last])
    assert len(seen["entities"]["ball"]["position"]) == last + 1
    assert f"frames 0..{last} of 0..35" in seen["run"]
    beyond = slow.call("inspect_world", world="w", part="state", entities=["ball"], frames=[0, 35])
    assert beyond["warnings"] == [f"the probe run has frames 0..{last}: told is up to there"]
    assert f"0..{last}" in slow.refused("inspect_world", world="w", part="state", frames=[35, 35])
    assert not slow.result("render_shot", world="w", kind="preview", frame=last).is_error
    checked = slow.call("run_checks", world="w", scope="probe")
    assert checked["counts"]["fail"] > 0
    assert checked["next"].startswith(("edit_spec", "probe_sim"))


def test_a_prefix_in_which_only_its_engine_failed_passes_no_gate(
    agent: Agent, judged: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=small_spec())
    agent.call("place_object", world="w")
    whole = Run.advance

    def broken(self: Run, frame: int, **more: Any) -> None:
        if frame == 30:  # every beat has come true, nothing has failed
            raise EngineError("the engine gave up")
        whole(self, frame, **more)

    monkeypatch.setattr(Run, "advance", broken)
    told = agent.result("probe_sim", world="w").content[0].text
    assert "the engine gave up" in told
    assert "Frames 0..29 are whole" in told
    checked = agent.call("run_checks", world="w", scope="probe")
    assert [r["id"] for r in checked["open_rows"] if r["status"] == "fail"] == ["numerical:frames:rigid"]  # the engine's end
    assert "frames 30..35" in agent.refused("bake_sim", world="w")
    monkeypatch.undo()
    run_jobs_inline(monkeypatch)
    assert agent.call("probe_sim", world="w")["passed"]
    assert agent.call("bake_sim", world="w")["passed"]


def test_a_cancelled_run_leaves_its_failures_on_record_and_has_tested_the_change(slow: Agent, judged: None) -> None:
    assert not slow.call("probe_sim", world="w")["passed"]
    slow.edit(("/entities/ball/physics/linear_velocity", [0.31, 0, 0]), hypothesis="the ball was a little too slow")
    slow.call("place_object", world="w")
    session = Session.at(WorldFolder.at(slow.workspace / "w"))
    assert [i["revision"] for i in session.ledger.open_iterations()] == [2]
    heard: list[str] = []

    def cancelled() -> bool:
        return any("fails already: beat:strike" in text for text in heard)

    with pytest.raises(Cancelled):
        run_inline(
            "worldagent.workflow.jobs:probe",
            {"folder": str(slow.workspace / "w"), "stop_at": "never"},
            on_progress=lambda told: heard.append(told.message),
            cancel_asked=cancelled,
        )
    assert _statuses(slow)["beat:strike"] == "fail"
    assert session.ledger.open_iterations() == []
    (attempt,) = session.ledger.iterations()
    assert json.dumps(attempt["failing_after"]) == '["beat:strike"]'
    text = slow.refused("edit_spec", world="w", patch=[
        {"op": "replace", "path": "/entities/ball/physics/linear_velocity", "value": [1.0, 0, 0]}
    ])  # fmt: skip
    assert "hypothesis" in text


def test_a_run_is_read_up_to_its_last_whole_frame_and_an_instance_that_has_none_leaves_its_members_undecided(
    slow: Agent, judged: None
) -> None:
    slow.call("probe_sim", world="w")
    folder = WorldFolder.at(slow.workspace / "w")
    session = Session.at(folder)
    freeze, document = session.freeze(), session.spec.model_dump(mode="json")
    document["simulation"]["solvers"]["later"] = {"engine": "mujoco", "members": ["b2"]}
    document["simulation"]["solvers"]["rigid"]["members"].remove("b2")
    begun = open_begun(folder, freeze, "probe", (parse_spec(document), build_world(folder, session.spec)[0]))
    assert begun.unmoved == {"b2"}
    told: list[Row] = []
    judge_begun(begun.candidate, frozenset({"b1"}), told.extend)
    assert told
    assert not [r.id for r in told if "b1" in r.entities]

    digests = folder.candidate(freeze) / "probe/rigid/digests.txt"
    lines = digests.read_text().split()
    digests.write_text("\n".join([*lines[:5], lines[5][:20]]))
    assert open_begun(folder, freeze, "probe").candidate.last_frame == 4
    digests.write_text("")
    with pytest.raises(EvidenceError, match="has written no frame yet"):
        open_begun(folder, freeze, "probe")


@pytest.mark.slow
def test_a_probe_of_a_real_server_stops_when_its_judge_on_the_other_core_says_so(agent: Agent) -> None:
    spec = small_spec()
    spec["entities"]["ball"]["physics"] |= SLOW
    spec["simulation"]["frames"] = 2400
    spec["shots"]["only"]["frames"] = [0, 2399]
    spec["simulation"]["solvers"]["rigid"]["settings"]["step"] = 0.0001
    lasts = {"kind": "rests_on", "entity": "b1", "on": "shelf"}
    still = {
        "text": "it stays",
        "owner": "rigid",
        "subject": "b1",
        "frames": [2300, 2380],
        "predicate": lasts,
        "mandatory": False,
    }
    spec["story"]["beats"]["still"] = still
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    found = agent.call("probe_sim", world="w")
    assert "beat:strike" in found["stopped_by"]
    assert found["stopped_at"] < 0.5 * found["of_frames"]

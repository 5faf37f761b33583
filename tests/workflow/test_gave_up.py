"""An engine that gives up leaves a failing row that an edit can name: frame, place and bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.simulation.rigid.solver import SolverRigid
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.tools.inspect_world import inspect_world
from worldagent.tools.place_object import place_object
from worldagent.tools.probe_sim import probe_sim
from worldagent.workflow.arguments import Repair
from worldagent.workflow.context import ToolContext
from worldagent.worlds.errors import EngineError
from worldagent.worlds.groups import group_of

ROW = "numerical:frames:rigid"


def break_at(monkeypatch: pytest.MonkeyPatch, frame: int, *, body: str | None = "ball") -> None:
    """Let the engine give up on the way to a frame, with a body that ran away."""
    plain = SolverRigid._run

    def fails(self: Any, start: float, *given: Any) -> Any:
        if self.frame + 1 < frame:
            return plain(self, start, *given)
        if body is not None:
            self.data.qvel[int(self.model.body(body).dofadr[0])] = 3e5
        raise self._mj.FatalError("mj_stackAlloc: out of memory")

    monkeypatch.setattr(SolverRigid, "_run", fails)


def row_of(context: ToolContext) -> dict[str, Any]:
    found: dict[str, Any] = inspect_world(context, world="w", part="row", row=ROW).data["row"]
    return found


@pytest.fixture
def ready(context: ToolContext, monkeypatch: pytest.MonkeyPatch) -> ToolContext:
    run_jobs_inline(monkeypatch)
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    assert place_object(context, world="w").data["static_passed"]
    return context


def test_the_row_names_frame_place_and_bodies_and_an_edit_may_answer_it(
    ready: ToolContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as broken:
        break_at(broken, 4)
        with pytest.raises(EngineError, match=f"ran away before frame 4.*{ROW}"):
            probe_sim(ready, world="w", wait_s=200.0)
    row = row_of(ready)
    assert (row["status"], row["first_failing_entity"], row["first_failing_frame"]) == ("fail", "ball", 4)
    assert row["evidence"]["bodies"][0] == "ball"
    assert len(row["evidence"]["place"]) == 3
    assert np.isfinite(row["evidence"]["place"]).all()
    slower = "/entities/ball/physics/linear_velocity"
    patch = [{"op": "replace", "path": slower, "value": [0.99, 0, 0]}]
    repairs = [Repair(row=ROW, group=group_of(slower).name, expect="lower", hypothesis="a slower ball does not run away")]
    told = edit_spec(ready, world="w", patch=patch, repairs=repairs)
    assert told.data["revision"] == 2
    place_object(ready, world="w")
    probe_sim(ready, world="w", wait_s=200.0)
    assert row_of(ready)["status"] == "pass"


def test_one_of_which_nobody_knows_the_body_is_about_all_that_move(ready: ToolContext, monkeypatch: pytest.MonkeyPatch) -> None:
    break_at(monkeypatch, 3, body=None)
    with pytest.raises(EngineError, match="gave up at frame 3"):
        probe_sim(ready, world="w", wait_s=200.0)
    row = row_of(ready)
    assert (row["status"], row["first_failing_frame"]) == ("fail", 3)
    assert set(row["entities"]) >= {"ball", "b1", "b2", "b3"}


def test_one_that_wrote_no_frame_leaves_the_row_all_the_same(ready: ToolContext, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(self: Any) -> None:
        raise EngineError("no start", where={"solver": "rigid", "frame": 0, "entities": ["b1"]})

    monkeypatch.setattr(SolverRigid, "_finish_frame", lambda self, *given: fails(self))
    with pytest.raises(EngineError, match=f"wrote no frame; row {ROW} fails"):
        probe_sim(ready, world="w", wait_s=200.0)
    assert (row_of(ready)["status"], row_of(ready)["first_failing_entity"]) == ("fail", "b1")

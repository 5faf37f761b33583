"""Progress of a job: frames and judgement both count, and the same motion is judged again without a simulation."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from worldagent.execution import Progress, run_inline
from worldagent.simulation.runs import Run
from worldagent.verifiers.acceptance import judge
from worldagent.workflow.estimates import bake_estimate
from worldagent.workflow.session import Session
from worldagent.worlds.folder import WorldFolder

JOBS = "worldagent.workflow.jobs:"


def run(kind: str, folder: Path, **more: Any) -> tuple[dict[str, Any], list[Progress]]:
    told: list[Progress] = []
    return run_inline(JOBS + kind, {"folder": str(folder), **more}, on_progress=told.append), told


def share(told: list[Progress], start: str) -> list[float]:
    return [p.done / p.total for p in told if p.total and p.message.startswith(start)]


@pytest.mark.slow
def test_judging_counts_and_the_same_motion_is_judged_again_without_simulating(
    copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (candidate,) = (copy / "candidates").iterdir()
    for part in ("probe", "variants", "bake"):
        shutil.rmtree(candidate / part)
    result, told = run("probe", copy)
    assert result["passed"]
    frames, causes = share(told, "rigid: frame"), share(told, "checking causal: ")
    assert 0.1 < frames[-1] <= min(causes)
    assert frames[-1] < 0.8
    assert len(causes) > 30
    assert all(p.ends is not None and p.done <= p.ends <= 1.0 for p in told if not p.message.startswith("opening"))
    assert {round(p.ends or 0.0, 9) for p in told if "rigid: frame" in p.message[:12]} == {round(frames[-1], 9)}
    assert max(p.ends or 0.0 for p in told if p.message.startswith("checking causal: ")) == pytest.approx(1.0)

    advanced: list[int] = []
    monkeypatch.setattr(Run, "advance", lambda self, frame: advanced.append(frame))
    again, told = run("check", copy, scope="probe")
    assert again["counts"] == result["counts"]
    assert advanced == []
    assert len(share(told, "checking causal: ")) == 2  # one for each cause; no frame
    monkeypatch.undo()

    session = Session.at(WorldFolder.at(copy))
    freeze = _freeze(session)
    detail = freeze["detail"]
    judged, simulated = (detail[k] / detail["frames"] for k in ("judged_s", "simulated_s"))
    assert bake_estimate(session, freeze) == pytest.approx(judged * 36 + simulated * (36 - detail["frames"]), abs=0.06)
    coarser = {**freeze, "detail": {**detail, "coarser": 1.5, "overrides": {"/simulation/frames": 30}}}
    assert bake_estimate(session, coarser) == pytest.approx((judged + 1.5**4 * simulated) * 36, abs=0.06)
    taken, told = run("bake", copy)
    assert taken["passed"]
    assert taken["taken"] == [f"frames 0..{detail['frames'] - 1} of rigid taken from {candidate.name}/probe"]
    assert share(told, "rigid: frame") == []
    for part in ("probe", "bake"):
        shutil.rmtree(candidate / part)
    baked, told = run("bake", copy)
    assert baked["passed"]
    assert baked["cache_digest"] == taken["cache_digest"]
    assert "taken" not in baked
    assert share(told, "rigid: frame")[-1] <= min(share(told, "checking "))

    heard: list[Progress] = []
    record = judge(copy, seed=1, progress=lambda *report: heard.append(Progress(*report)))
    assert record["verdict"] == "accepted"
    causes, replayed = share(heard, "checking causal: "), share(heard, "replaying rigid")
    assert len(causes) > 30  # acceptance takes nothing from what was kept
    assert max(causes) < min(replayed)
    assert replayed[-1] == pytest.approx(1.0)


def _freeze(session: Session) -> dict[str, Any]:
    from worldagent.construction import build_world
    from worldagent.simulation.freeze import freeze_hash

    found = session.ledger.freeze(freeze_hash(session.spec, build_world(session.folder, session.spec)[0]))
    assert found is not None
    return found

"""A wall clock that jumps: jobs live on, leases hold, the order of the ledger stays, and no time that is shown is negative."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.servers import Remote, baked, shimmed, stdio, without_bake

DAY_S = 86_400
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pytest.mark.parametrize("jump", [-30 * DAY_S, 30 * DAY_S])
def test_a_bake_lives_through_a_jump_of_the_clock(jump: int, accepted_folder: Path, tmp_path: Path) -> None:
    workspace, clock = without_bake(accepted_folder, tmp_path / "ws"), tmp_path / "clock"
    with Remote(workspace, stdio(workspace, env=shimmed(WORLDAGENT_TEST_CLOCK=clock))) as agent:
        job = agent.call("bake_sim", world="w", wait_s=0)["job_id"]
        baked(workspace, 3)
        clock.write_text(str(jump))
        for _ in range(3):
            seen = agent.call("job", action="wait", job_id=job, wait_s=0.5)
            assert seen["state"] in ("running", "done")
            assert seen["seconds"] >= 0
            assert seen.get("left_s", 0) >= 0
        if seen["state"] == "running":
            cancelled = agent.call("job", action="cancel", job_id=job)
            assert cancelled["state"] == "cancelled"
            assert cancelled["seconds"] >= 0


def test_revisions_and_verdicts_keep_their_order_whatever_the_clock_says(accepted: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    import time

    true_time = time.time
    for k, jump in enumerate((0, -400 * DAY_S, 400 * DAY_S, -DAY_S)):
        monkeypatch.setattr(time, "time", lambda jump=jump: true_time() + jump)
        assert accepted.edit(("/title", f"Title {k}"))["revision"] == k + 2
    found = accepted.call("inspect_world", world="w", part="revisions")["revisions"]
    numbers = [r.get("n", r.get("revision")) for r in found]
    assert numbers == sorted(numbers, reverse=True)
    assert accepted.call("inspect_world", world="w", part="spec", pointer="/title")["value"] == "Title 3"
    assert accepted.call("inspect_world", world="w")["last_verdict"]["revision"] == 1

"""Benchmark `eval-smoke`: a scripted run, the same replayed, and random calls, each through the whole harness."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

from .commands import run_task
from .results import SampleResult, samples_of

__all__ = ["run"]


def run() -> dict[str, Any]:
    """Figures: samples in all, how many of the random ones were accepted, and whether the replay gave the same verdicts.

    `replay_equal` is 1 where every call and every row of the matrix came out the same, bit for bit, and so did the verdict.
    """
    with tempfile.TemporaryDirectory(prefix="worldagent-eval-") as folder:
        root = Path(folder)
        played = _run("scripted", root / "scripted")
        recording = str(Path(played[0].workspace).parents[1])
        again = _run("replay", root / "replay", {"recording": recording})
        drawn = _run("random", root / "random")
    equal = [
        not b.differences and (a.outcome, a.rows, a.open_rows) == (b.outcome, b.rows, b.open_rows)
        for a, b in zip(played, again, strict=True)
    ]
    results = [*played, *again, *drawn]
    return {
        "samples": len(results),
        "scripted_accepted": sum(r.outcome == "accepted" for r in played),
        "random_accepted": sum(r.outcome == "accepted" for r in drawn),
        "replay_equal": int(all(equal) and all(r.outcome != "error" for r in again)),
        "isolated": int(not any(r.isolation for r in results)),
        "calls": sum(r.calls for r in results),
        "seconds": round(sum(r.seconds for r in results), 1),
    }


def _run(agent: str, root: Path, arguments: dict[str, Any] | None = None) -> list[SampleResult]:
    results = samples_of(run_task("smoke", agent, root=root, agent_args=arguments, retry_on_error=0))
    for result in results:
        print(f"{agent}: {result.id} {result.outcome} in {result.seconds:.0f} s; {result.reason}", file=sys.stderr, flush=True)
    return results

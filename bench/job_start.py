"""Benchmark `job-start`: from submitting a job to its first line of work, cold and warm, and to its end.

The entry imports what a probe imports before its first frame (simulation, checks, pictures) and tells the time. A cold
job starts Python and imports; a warm one is forked by a process of the workspace that has imported the same.
"""

from __future__ import annotations

import importlib
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from ..execution import JobContext, JobStore, Terms, result_of
from ..workflow.jobs import WARM

__all__ = ["WARM", "first_line", "run"]

ROUNDS = 9
ENTRY = "worldagent.bench.job_start:first_line"
LOADING_S = 120.0


def first_line(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Entry: import, and say when that was done."""
    for name in WARM:
        importlib.import_module(name)
    return {"at": time.monotonic()}


def _start(store: JobStore, *, warm: bool) -> tuple[float, float, float]:
    began = time.monotonic()
    job = store.submit("start", None, {}, entry=ENTRY, terms=Terms(warm=warm))
    while not job.ended:
        job = store.wait(job.id, 5.0)
    return result_of(job)["at"] - began, time.monotonic() - began, job.cpu_s or 0.0


def _warm_up(store: JobStore) -> float | None:
    """Seconds until a warm process waits for jobs; None where the system has none."""
    os.environ["WORLDAGENT_WARM"] = "1"
    began = time.monotonic()
    if not store.warm_up(ENTRY.partition(":")[0]):
        return None
    socket = store.workspace / ".worldagent" / "warm.sock"
    while not socket.exists():
        if time.monotonic() - began > LOADING_S:
            return None
        time.sleep(0.01)
    return time.monotonic() - began


def run() -> dict[str, Any]:
    """Medians of alternated starts; the first of each only fills the file cache."""
    cold: list[tuple[float, float, float]] = []
    warm: list[tuple[float, float, float]] = []
    with tempfile.TemporaryDirectory() as workspace:
        store = JobStore(Path(workspace))
        loading = _warm_up(store)
        for number in range(ROUNDS + 1):
            one = _start(store, warm=False)
            other = _start(store, warm=True) if loading is not None else None
            print(
                f"start {number}: cold {one[0]:.3f} s, warm {'none' if other is None else f'{other[0]:.3f} s'}", file=sys.stderr
            )
            if number:
                cold.append(one)
                warm += [other] if other is not None else []
    figures: dict[str, Any] = {"starts": ROUNDS, "loading_s": None if loading is None else round(loading, 3)}
    for name, times in (("cold", cold), ("warm", warm)):
        for k, what in enumerate(("first_line_s", "end_s", "cpu_s")):
            figures[f"{name}_{what}"] = round(statistics.median(t[k] for t in times), 4) if times else None
    return figures

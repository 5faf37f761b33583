import os
import time
from pathlib import Path

import pytest
from worldagent.execution import JobStore

HERE = Path(__file__).parent
LONG_S = 300.0
"""Longest wait for what comes in any case [s]: it ends a test that hangs, and checks nothing."""


@pytest.fixture(autouse=True)
def _entries(monkeypatch):
    monkeypatch.setenv("WORLDAGENT_TEST_ENTRIES", "execution_entries,engine_entries")
    path = os.environ.get("PYTHONPATH")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(HERE), *([path] if path else [])]))
    monkeypatch.syspath_prepend(str(HERE))


@pytest.fixture
def store(tmp_path):
    store = JobStore(tmp_path, slots=2)
    yield store
    unended = [job for state in ("queued", "running") for job in store.list(state=state)]
    for job in unended:
        store.request_cancel(job.id)
    for job in unended:
        assert store.wait(job.id, LONG_S).ended


@pytest.fixture
def in_time():
    """Hold a promise of time: one of three tries keeps it, since a machine that is overloaded for a moment is no defect."""

    def check(attempt, seconds):
        took = []
        for k in range(3):
            took.append(attempt(k))
            if took[-1] < seconds:
                return
        raise AssertionError(f"took {took} s, promised {seconds} s")

    return check


@pytest.fixture
def until():
    """Poll `condition` until it gives something true, and return that."""

    def wait(condition, timeout_s=LONG_S):
        deadline = time.monotonic() + timeout_s
        while not (value := condition()):
            assert time.monotonic() < deadline, "the condition never came true"
            time.sleep(0.01)
        return value

    return wait

import os
import time
from pathlib import Path

import pytest
from worldagent.execution import JobStore

HERE = Path(__file__).parent


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
        assert store.wait(job.id, 10).ended


@pytest.fixture
def until():
    """Poll `condition` until it gives something true, and return that."""

    def wait(condition, timeout_s=15):
        deadline = time.monotonic() + timeout_s
        while not (value := condition()):
            assert time.monotonic() < deadline, "the condition never came true"
            time.sleep(0.01)
        return value

    return wait

import os
from pathlib import Path

import pytest
from worldagent.execution import JobStore
from worldagent.tools import TOOLS
from worldagent.workflow.context import ToolContext

ENTRIES = Path(__file__).parent.parent / "execution"


@pytest.fixture
def told():
    """Progress that tools told their client: (done, total, message)."""
    return []


@pytest.fixture
def context(tmp_path, monkeypatch, told):
    """Surroundings of a call, in a workspace whose jobs may run the entries of tests/execution."""
    path = os.environ.get("PYTHONPATH")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ENTRIES), *([path] if path else [])]))
    monkeypatch.setenv("WORLDAGENT_TEST_ENTRIES", "execution_entries")
    return ToolContext(
        workspace=tmp_path,
        jobs=JobStore(tmp_path, slots=1),
        progress=lambda *report: told.append(report),
        cancelled=lambda: False,
        replies={kind: reply for tool in TOOLS for kind, reply in tool.jobs.items()},
    )

"""Worlds whose ledgers are written by hand, so that the page can be shown every state in no time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from worldagent.execution import JobStore
from worldagent.tests.page.browser import Served, Tab, chromium
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.workflow.context import ToolContext
from worldagent.worlds.folder import WorldFolder, write_atomically
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.requirements import Correction, Row


class Made:
    """A workspace and what is put into it."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.jobs = JobStore(root)
        self.context = ToolContext(root, self.jobs, lambda done, total, message: None, lambda: False)

    def world(self, name: str, **changes: Any) -> WorldFolder:
        """A world that is specified and audited."""
        edit_spec(self.context, world=name, prompt=PROMPT, spec=small_spec(**changes))
        return WorldFolder.of(self.root, name)

    def edit(self, name: str, *operations: tuple[str, Any], **more: Any) -> None:
        """A further revision."""
        edit_spec(
            self.context, world=name, patch=[{"op": "add", "path": path, "value": value} for path, value in operations], **more
        )

    def job(self, world: str | None = None, kind: str = "bake") -> str:
        """Id of a job that waits for `advance`."""
        payload = {"file": str(self.root / "steps")}
        return self.jobs.submit(kind, world, payload, entry="worldagent.tests.page.entries:steady").id

    def advance(self, done: float) -> None:
        """Let the jobs be so far, of 10; at 10 they end."""
        write_atomically(self.root / "steps", str(done).encode())

    def rows(self, name: str, *rows: Row, stage: str = "full") -> None:
        """Verdicts of the present revision."""
        ledger = Ledger(WorldFolder.of(self.root, name).ledger_path)
        ledger.put_rows(rows, revision=ledger.revision(), stage=stage)


def row(name: str, status: str = "pass", **more: Any) -> Row:
    """A row with everything that a person may ask about."""
    given: dict[str, Any] = {
        "id": name,
        "check": "interpenetration",
        "group": "spatial",
        "predicate": "clearance >= 0",
        "status": status,
        "artifact": "candidates/x/bake",
        "frames": (0, 35),
        "measured": -0.0021 if status == "fail" else 0.004,
        "bound": 0.0,
        "comparison": ">=",
        "unit": "m",
        "entities": ("b1", "b2"),
        "evidence": {"explanation": f"why {name} came out so"},
    }
    if status == "fail":
        given |= {
            "first_failing_entity": "b1",
            "first_failing_frame": 12,
            "corrections": (Correction(cause="too deep", edit_class="scene", group="pose", action=f"raise {name} by 2 mm"),),
        }
    return Row.model_validate(given | more)


@pytest.fixture
def made(tmp_path: Path) -> Iterator[Made]:
    workspace = Made(tmp_path)
    yield workspace
    for job in workspace.jobs.list(state=("queued", "running")):
        workspace.jobs.request_cancel(job.id)
        assert workspace.jobs.wait(job.id, 60).ended


@pytest.fixture
def served(made: Made) -> Iterator[Served]:
    """The server of the workspace, running."""
    server = Served(made.root)
    server.start()
    yield server
    server.stop()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture
def tab(browser: Any, served: Served) -> Iterator[Tab]:
    """A tab on the server, in which nothing may have gone wrong at the end."""
    found = Tab(browser, served.url)
    yield found
    found.close()
    assert found.troubles == []

"""Clients of a real server in memory, and worlds that several stories start from."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import pytest
from anyio.from_thread import start_blocking_portal
from mcp import Client
from worldagent.server.app import create_server
from worldagent.tests.stories.small_run import PROMPT, small_spec

WAIT_S = 240.0
LONG_TOOLS = frozenset({"probe_sim", "bake_sim", "run_checks", "render_shot"})


class Agent:
    """An MCP client of its own server over one workspace, as a script calls it."""

    def __init__(self, workspace: Path) -> None:
        self.workspace = workspace
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        portal = self._stack.enter_context(start_blocking_portal("asyncio"))
        self._client: Client = self._stack.enter_context(portal.wrap_async_context_manager(Client(create_server(self.workspace))))
        self._portal = portal
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def result(self, tool: str, **arguments: Any) -> Any:
        """The raw answer."""
        if tool in LONG_TOOLS and "wait_s" not in arguments:
            arguments["wait_s"] = WAIT_S
        return self._portal.call(self._client.call_tool, tool, arguments)

    def call(self, tool: str, **arguments: Any) -> dict[str, Any]:
        """Data of a call that must succeed."""
        answer = self.result(tool, **arguments)
        assert not answer.is_error, answer.content[0].text
        return json.loads(answer.content[0].text)

    def read(self, uri: str) -> Any:
        """The one content of a resource."""
        (content,) = self._portal.call(self._client.read_resource, uri).contents
        return content

    def pages(self, key: str, **arguments: Any) -> list[Any]:
        """All items of a part of the world `w`, page after page."""
        found, offset = [], 0
        while True:
            page = self.call("inspect_world", world="w", offset=offset, **arguments)
            assert page[key]
            found += page[key]
            assert page["total"] >= len(found)
            if "next_offset" not in page:
                assert page["total"] == len(found)
                return found
            offset = page["next_offset"]
            assert offset == len(found)
            assert f"offset={offset}" in page["next"]

    def refused(self, tool: str, **arguments: Any) -> str:
        """Text of a call that must not succeed, and that changes nothing."""
        before = self.state(arguments.get("world"))
        answer = self.result(tool, **arguments)
        assert answer.is_error, answer.content[0].text
        text = answer.content[0].text
        assert not text.startswith("internal error"), text
        assert self.state(arguments.get("world")) == before
        return text

    def state(self, world: Any) -> Any:
        """Revision and matrix of a world, read from its ledger file."""
        from worldagent.worlds.ledger import Ledger

        path = self.workspace / str(world) / "ledger.sqlite"
        if not isinstance(world, str) or not path.is_file():
            return None
        ledger = Ledger(path)
        return ledger.revision(), {r.id: (r.status, r.measured) for r in ledger.rows() if r.check != "audit"}

    def edit(self, *operations: tuple[str, Any], world: str = "w", **more: Any) -> dict[str, Any]:
        """Set values at pointers."""
        return self.call("edit_spec", world=world, patch=patch_of(*operations), **more)


def patch_of(*operations: tuple[str, Any]) -> list[dict[str, Any]]:
    """Operations that set values: members of objects are added or replaced, items of lists replaced."""
    return [
        {"op": "replace" if pointer.rpartition("/")[2].isdigit() else "add", "path": pointer, "value": value}
        for pointer, value in operations
    ]


@pytest.fixture(scope="session")
def patch() -> Callable[..., list[dict[str, Any]]]:
    return patch_of


@pytest.fixture(scope="session")
def agent_of() -> Callable[[Path], Agent]:
    return Agent


@pytest.fixture
def agent(tmp_path: Path) -> Iterator[Agent]:
    """A client of an empty workspace."""
    with Agent(tmp_path) as made:
        yield made


@dataclass(frozen=True)
class Loop:
    """One run from prompt to acceptance: where, and every answer."""

    workspace: Path
    answers: dict[str, Any]


@pytest.fixture(scope="session")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Loop:
    """The small world `w` from its prompt to acceptance."""
    workspace = tmp_path_factory.mktemp("accepted")
    answers = {}
    with Agent(workspace) as agent:
        for name, tool, more in (
            ("create", "edit_spec", {"prompt": PROMPT, "spec": small_spec()}),
            ("place", "place_object", {}),
            ("probe", "probe_sim", {}),
            ("bake", "bake_sim", {}),
            ("accept", "run_checks", {"scope": "acceptance"}),
            ("jobs", "job", {"action": "list"}),
        ):
            answers[name] = agent.result(tool, world="w", **more)
            assert not answers[name].is_error, answers[name].content[0].text
    return Loop(workspace, answers)


@pytest.fixture(scope="session")
def accepted_folder(loop: Loop) -> Path:
    """Folder of the small world `w`, accepted. Copy it before you change it."""
    assert json.loads(loop.answers["accept"].content[0].text)["verdict"] == "accepted"
    return loop.workspace / "w"


@pytest.fixture
def accepted(accepted_folder: Path, tmp_path: Path) -> Iterator[Agent]:
    """A client whose workspace holds a copy of the accepted world `w`."""
    shutil.copytree(accepted_folder, tmp_path / "w")
    with Agent(tmp_path) as agent:
        yield agent


@pytest.fixture
def copy(accepted_folder: Path, tmp_path: Path) -> Path:
    """A copy of the accepted world's folder."""
    return shutil.copytree(accepted_folder, tmp_path / "w")


@pytest.fixture(scope="session")
def failed_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the small world with a ball so slow that the probe fails."""
    workspace = tmp_path_factory.mktemp("failed")
    spec = small_spec()
    spec["entities"]["ball"]["physics"] |= {"linear_velocity": [0.3, 0, 0], "angular_velocity": [0, 15, 0]}
    with Agent(workspace) as agent:
        agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
        assert not agent.call("probe_sim", world="w")["passed"]
    return workspace / "w"


@pytest.fixture
def failed(failed_folder: Path, tmp_path: Path) -> Iterator[Agent]:
    """A client whose workspace holds a copy of the world whose probe failed."""
    shutil.copytree(failed_folder, tmp_path / "w")
    with Agent(tmp_path) as agent:
        yield agent

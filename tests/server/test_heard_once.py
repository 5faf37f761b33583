"""Standing warnings through a real client: told once where a server has one client, as over stdio; every time where it may have several."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mcp import Client
from worldagent.server.app import create_server
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow import early_words
from worldagent.workflow.heard import AT_START

LINE = f"{AT_START}: claim:place:on: 'on': 'ball' is not on 'shelf'; mend it now, unless it comes to be so later"


@pytest.mark.anyio
@pytest.mark.parametrize("alone", [True, False])
async def test_a_session_is_told_a_standing_warning_once(
    tmp_path: Path, era: str, monkeypatch: pytest.MonkeyPatch, alone: bool
) -> None:
    monkeypatch.setattr(early_words, "unmet_at_start", lambda session: [LINE])
    server = create_server(tmp_path)
    if alone:
        server.serve_one()
    placed: list[list[str]] = []

    async def place(client: Any) -> None:
        reply = await client.call_tool("place_object", {"world": "w"})
        placed.append(reply.structured_content["warnings"])

    async with Client(server, mode=era) as client:
        await client.call_tool("edit_spec", {"world": "w", "prompt": PROMPT, "spec": small_spec()})
        await place(client)
        await place(client)
    assert placed[0] == [LINE]
    assert placed[1] == (["1 warning stands as told before: claim:place:on"] if alone else [LINE])

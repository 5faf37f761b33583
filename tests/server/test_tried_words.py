"""Words that callers try lead to what they look for; a defect says what was stored all the same."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, get_args

import pytest
from mcp import Client
from worldagent.server.app import create_server
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools import TOOLS, ToolBinding, ToolContext, ToolReply
from worldagent.tools.inspect_world import Part
from worldagent.workflow.creation import create
from worldagent.workflow.session import Session
from worldagent.workflow.tried_words import CHECK_SCOPES, INSPECT_PARTS, RENDER_KINDS
from worldagent.worlds.patch import apply_patch

PARTS = get_args(Part)


def _text(result: Any) -> str:
    return str(result.content[0].text)


@pytest.mark.anyio
@pytest.mark.parametrize(
    ("tried", "said"),
    [
        ("entity", "part='spec' with pointer='/entities/<id>'"),
        ("Entities", "part='state' with entities"),
        ("poses", "part='state'"),
        ("contacts", "part='events'"),
        ("failing", "part='matrix'"),
        ("beats", "pointer='/story'"),
        ("jobs", "tool job"),
    ],
)
async def test_a_part_that_is_none_leads_to_what_was_looked_for(tmp_path: Path, tried: str, said: str) -> None:
    async with Client(create_server(tmp_path)) as client:
        result = await client.call_tool("inspect_world", {"part": tried, "world": "w"})
    assert result.is_error
    assert said in _text(result)
    assert "did you mean" not in _text(result)


@pytest.mark.anyio
async def test_a_slip_of_the_pen_still_names_the_nearest(tmp_path: Path) -> None:
    async with Client(create_server(tmp_path)) as client:
        result = await client.call_tool("inspect_world", {"part": "overveiw"})
    assert "did you mean 'overview'" in _text(result)


@pytest.mark.parametrize(
    ("words", "tool", "argument"), [(INSPECT_PARTS, "inspect_world", "part"), (RENDER_KINDS, "render_shot", "kind"), (CHECK_SCOPES, "run_checks", "scope")]
)  # fmt: skip
def test_words_are_no_values_and_lead_to_values_that_are(words: dict[str, str], tool: str, argument: str) -> None:
    binding = next(t for t in TOOLS if t.name == tool)
    assert binding.words[argument] is words
    from worldagent.server.arguments import Arguments

    schema = str(Arguments(binding).schema["properties"][argument])
    assert words
    for word, lead in words.items():
        assert f"'{word}'" not in schema, "it is a value itself"
        for value in re.findall(rf"{argument}='(\w+)'", lead):
            assert f"'{value}'" in schema
        assert f"{argument}='" in lead or "tool " in lead


def broken_edit(context: ToolContext, world: str, store: bool) -> ToolReply:
    """Store an edit, or none, and then meet a defect."""
    session = Session.open(context.workspace, world)
    if store:
        patch = [{"op": "replace", "path": "/title", "value": "Another"}]
        session.commit(apply_patch(session.spec, patch), patch=patch)
    raise KeyError("a defect")


@pytest.mark.anyio
@pytest.mark.parametrize("store", [True, False])
async def test_a_defect_tells_what_was_stored(tmp_path: Path, store: bool) -> None:
    create(tmp_path, "w", PROMPT, small_spec())
    tools = (ToolBinding(broken_edit, "Edit", read_only=False),)
    async with Client(create_server(tmp_path, tools=tools)) as client:
        told = _text(await client.call_tool("broken_edit", {"world": "w", "store": store}))
        other = _text(await client.call_tool("broken_edit", {"world": "nobody", "store": store}))
    assert told.startswith("internal error")
    assert "Nothing was accepted" not in told
    if store:
        assert "Its edit is stored, as revision 2 of 'w' (/title)" in told
        assert "do not send the edit again" in told
    else:
        assert "No edit of 'w' was stored: it is still at revision 1" in told
    assert not other.startswith("internal error") or "no world 'nobody'" in other

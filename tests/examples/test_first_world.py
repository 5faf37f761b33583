"""The first accepted world, through the SDK's client and through a stand-in for Codex."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import anyio
import pytest
from worldagent.examples.first_world import first_world, main, two_blocks
from worldagent.examples.real_clients import ClaudeClient, CodexClient
from worldagent.worlds.errors import EngineError

CODEX = """#!{python}
import json, sys
for line in sys.stdin:
    ask = json.loads(line)
    if ask["method"] == "initialize":
        print(json.dumps({{"method": "configWarning", "params": {{}}}}), flush=True)
        print(json.dumps({{"id": ask["id"], "result": {{}}}}), flush=True)
    elif ask["method"] == "thread/start":
        print(json.dumps({{"id": ask["id"], "result": {{"thread": {{"id": "t1"}}}}}}), flush=True)
    elif ask["method"] == "mcpServer/tool/call":
        p = ask["params"]
        assert (p["threadId"], p["server"]) == ("t1", "worldagent")
        if p["tool"] == "bake_sim":
            answer = {{"content": [{{"type": "text", "text": "refused: no probe"}}], "isError": True}}
        else:
            answer = {{"content": [{{"type": "text", "text": json.dumps({{"tool": p["tool"]}})}}], "isError": False}}
        print(json.dumps({{"id": ask["id"], "result": answer}}), flush=True)
"""
CLAUDE = """#!{python}
import json, os, urllib.request
def ask(messages):
    body = json.dumps({{"model": "m", "tools": [{{}}], "messages": messages}}).encode()
    with urllib.request.urlopen(os.environ["ANTHROPIC_BASE_URL"] + "/v1/messages?beta=true", data=body) as answer:
        events = [json.loads(line[6:]) for line in answer.read().decode().splitlines() if line.startswith("data: ")]
    block = next(e["content_block"] for e in events if e["type"] == "content_block_start")
    if block["type"] == "tool_use":
        block["input"] = json.loads(next(e["delta"]["partial_json"] for e in events if e["type"] == "content_block_delta"))
    return block
messages = [{{"role": "user", "content": "go"}}]
ask(messages)
while (block := ask(messages))["type"] == "tool_use":
    texts = ["[Resource from worldagent]", json.dumps({{"tool": block["name"], "world": block["input"]["world"]}})]
    content = [{{"type": "text", "text": t}} for t in texts] + [{{"type": "image"}}]
    result = {{"type": "tool_result", "tool_use_id": block["id"], "content": content, "is_error": False}}
    messages += [{{"role": "assistant", "content": [block]}}, {{"role": "user", "content": [result]}}]
"""


def test_claude_code_is_given_the_calls_of_the_script_and_brings_the_results(tmp_path: Path) -> None:
    program = tmp_path / "claude"
    program.write_text(CLAUDE.format(python=sys.executable))
    program.chmod(0o755)
    client = ClaudeClient(str(program))
    try:
        for world in ("a", "b"):
            assert anyio.run(client.call, "edit_spec", {"world": world}) == (
                {"tool": "mcp__worldagent__edit_spec", "world": world},
                1,
            )
    finally:
        client.close()


@pytest.fixture
def codex(tmp_path: Path) -> Any:
    program = tmp_path / "codex"
    program.write_text(CODEX.format(python=sys.executable))
    program.chmod(0o755)
    client = CodexClient(str(program))
    yield client
    client.close()


def test_a_refused_call_through_codex_stops_with_the_reason(codex: CodexClient) -> None:
    data, pictures = anyio.run(codex.call, "edit_spec", {"world": "w"})
    assert (data, pictures) == ({"tool": "edit_spec"}, 0)
    with pytest.raises(EngineError, match="bake_sim: refused: no probe"):
        anyio.run(first_world, codex, "w")


def test_the_example_of_the_skill_has_a_prompt_and_a_specification() -> None:
    spec = two_blocks()
    assert spec.pop("prompt").endswith(".")
    assert {"claims", "story", "entities", "simulation"} <= set(spec)


@pytest.mark.slow
def test_the_first_world_is_accepted_and_shown(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["--workspace", str(tmp_path)]) == 0
    found = json.loads(capfd.readouterr().out.splitlines()[-1])
    assert found["accepted"]
    assert found["pictures"] == 1
    assert [s["tool"] for s in found["steps"]] == [
        "edit_spec",
        "place_object",
        "probe_sim",
        "bake_sim",
        "run_checks",
        "render_shot",
    ]

"""1,000 malformed messages on each transport in each era: answered as JSON-RPC has it, and the server lives on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.hostile.messages import Case, malformed
from worldagent.tests.hostile.wire import ERAS, INITIALIZE, LEGACY, MESSAGE_BYTES, MODERN, Stdio, memory, request

SEED = 20261121
GROWTH = 64_000_000
"""Memory that a server may gain over 1,000 malformed messages [bytes]: a few of the largest messages at a time."""


def owed(case: Case) -> bool:
    """Whether an answer is due."""
    return bool(case.codes or case.tool_error or case.result)


def check(case: Case, found: list[dict[str, Any]]) -> None:
    """Whether the answers are what the case is owed."""
    shown = (case.name, case.line[:200], found)
    if not owed(case):
        assert not found, shown
        return
    assert len(found) == 1, shown
    [answer] = found
    assert answer["id"] == case.id, shown
    if "error" in answer:
        assert answer["error"]["code"] in case.codes, shown
        assert answer["error"]["message"], shown
        return
    assert case.result or case.tool_error, shown
    if case.tool_error:
        assert answer["result"]["isError"], shown
        text = answer["result"]["content"][0]["text"]
        assert not text.startswith("internal error"), shown
        assert len(text) < 10_000


@pytest.mark.parametrize("era", ERAS)
def test_stdio_survives_a_thousand_malformed_messages(tmp_path: Path, era: str) -> None:
    cases = malformed(era, SEED)
    assert len(cases) == 1000
    with Stdio(tmp_path, era) as server:
        assert "result" in server.open()
        server.until_good()
        before = memory(server.child.pid)
        for case in cases:
            server.write(case.line)
            found = server.until_good()
            if not found and owed(case):
                found = [server.answer()]
            check(case, found)
        assert memory(server.child.pid) - before < GROWTH
    assert server.child.returncode == 0
    assert "Traceback" not in "".join(server.log)

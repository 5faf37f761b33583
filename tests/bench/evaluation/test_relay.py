"""The process between an agent and its server: it passes on, writes down, and ends what hangs, floods or overspends."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp import Client, StdioServerParameters
from worldagent.bench.evaluation.records import Record
from worldagent.bench.evaluation.relay import MOST_BYTES, MOST_UNASKED, relay_command
from worldagent.bench.evaluation.serving import server_environment
from worldagent.tests.bench.evaluation.conftest import FAKE


def played(folder: Path, asked: list[dict[str, Any]], *, mode: str = "", **limits: Any) -> tuple[list[str], Record]:
    """Texts of the answers to calls through a relay, up to the first that the connection does not survive; and the record."""
    words = relay_command(
        folder, [sys.executable, str(FAKE), mode], **{"calls": 50, "call_timeout_s": 30, "start_s": 30, **limits}
    )
    parameters = StdioServerParameters(command=words[0], args=words[1:], env=server_environment())
    texts: list[str] = []

    async def talk() -> None:
        async with Client(parameters, mode="legacy") as client:
            for arguments in asked:
                answer = await client.call_tool("inspect_world", {"world": "w", **arguments})
                texts.append(next(b.text for b in answer.content if b.type == "text"))

    try:
        with anyio.from_thread.start_blocking_portal() as portal:
            portal.call(talk)
    except BaseException as error:
        texts.append(f"lost: {type(error).__name__}")
    return texts, Record(folder)


def test_a_call_passes_unchanged_and_stands_in_the_transcript(tmp_path: Path) -> None:
    texts, record = played(tmp_path, [{"do": "answer"}, {"do": "refuse"}])
    assert texts[1] == "refused: as asked"
    first, second = record.calls()
    assert (first.n, first.tool, first.error, first.ended, first.data["summary"]) == (
        1,
        "inspect_world",
        False,
        "answered",
        "did answer",
    )
    assert (second.n, second.error, second.data, second.arguments) == (
        2,
        True,
        "refused: as asked",
        {"world": "w", "do": "refuse"},
    )
    assert record.ending() is None


def test_a_hanging_call_gets_an_error_and_the_third_in_a_row_ends_the_server(tmp_path: Path) -> None:
    texts, record = played(tmp_path, [{"do": "hang"}, {}, {}, {}], call_timeout_s=0.4)
    assert texts[0] == "no answer in 0.4 s; the server may still be at work"
    assert [c.ended for c in record.calls()][:3] == ["silent"] * 3  # a fourth may be on its way
    ending = record.ending()
    assert (ending.kind, ending.type) == ("lost", "silent")
    assert "3 calls in a row had no answer within 0.4 s" in ending.reason


def test_a_server_that_dies_is_lost_with_its_code_and_its_last_words(tmp_path: Path) -> None:
    texts, record = played(tmp_path, [{}, {"do": "crash"}])
    assert texts[0].startswith('{"summary"')
    ending = record.ending()
    assert (ending.kind, ending.type, ending.reason) == (
        "lost",
        "died",
        "the server ended with code 7 while its client was there",
    )
    assert [c.ended for c in record.calls()] == ["answered", "lost"]
    assert (tmp_path / "server.stderr").read_text() == "the fake server falls over\n"


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        ({"do": "flood_bytes", "count": MOST_BYTES + 10}, f"more than {MOST_BYTES} bytes"),
        ({"do": "flood_messages", "count": MOST_UNASKED + 10}, f"{MOST_UNASKED} messages in a row"),
    ],
)
def test_a_flooding_server_is_ended(call: dict[str, Any], reason: str, tmp_path: Path) -> None:
    _, record = played(tmp_path, [call])
    assert record.ending().type == "flood"
    assert reason in record.ending().reason


def test_calls_past_the_budget_never_reach_the_server(tmp_path: Path) -> None:
    texts, record = played(tmp_path, [{}, {}, {"do": "crash"}], calls=2)
    assert texts[2] == "the budget of 2 calls is used up"
    assert (record.ending().kind, record.ending().type, record.ending().value) == ("limit", "calls", 3)
    assert [c.ended for c in record.calls()] == ["answered", "answered", "refused"]


def test_a_second_connection_goes_on_counting(tmp_path: Path) -> None:
    played(tmp_path, [{}, {}], calls=3)
    texts, record = played(tmp_path, [{}, {}], calls=3)
    assert texts[1] == "the budget of 3 calls is used up"
    assert [c.n for c in record.calls()] == [1, 2, 3, 4]


@pytest.mark.parametrize(("mode", "type_"), [("dead", "died"), ("mute", "start")])
def test_a_server_that_never_answers_is_lost_at_its_start(mode: str, type_: str, tmp_path: Path) -> None:
    _, record = played(tmp_path, [{}], mode=mode, start_s=1.0)
    assert (record.ending().kind, record.ending().type) == ("lost", type_)


def test_what_is_read_of_a_transcript_is_not_read_again(tmp_path: Path) -> None:
    record = Record(tmp_path)
    line = '{"n": 1, "tool": "job", "arguments": {}, "at": 0, "seconds": 0, "ended": "answered", "error": false}\n'
    record.calls_file.write_text(line + line[:20])
    assert len(record.calls()) == 1
    record.calls_file.write_text(line + line)
    assert len(record.calls()) == 2

"""A world that begins as a copy of another one."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.tools.place_object import place_object
from worldagent.workflow.context import ToolContext
from worldagent.workflow.session import Session
from worldagent.worlds.errors import InputError, RefusedError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.requirements import Row

HIGHER = [{"op": "replace", "path": "/title", "value": "again"}]


@pytest.fixture
def made(context: ToolContext) -> ToolContext:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    place_object(context, world="w")
    return context


def spec_of(context: ToolContext, world: str) -> dict[str, Any]:
    return Session.open(context.workspace, world).spec.model_dump(mode="json", exclude_none=True)


def test_a_copy_is_the_other_world_with_its_assets_and_a_history_of_its_own(made: ToolContext) -> None:
    (WorldFolder.of(made.workspace, "w").assets / "meshes").mkdir(parents=True)
    (WorldFolder.of(made.workspace, "w").assets / "meshes" / "a.obj").write_text("v 0 0 0\n")
    reply = edit_spec(made, world="again", copy_of="w", patch=HIGHER)
    assert (reply.data["revision"], reply.data["copied"]) == (1, "revision 1 of w")
    assert spec_of(made, "again") == {**spec_of(made, "w"), "title": "again"}
    assert (WorldFolder.of(made.workspace, "again").assets / "meshes" / "a.obj").read_text() == "v 0 0 0\n"
    assert place_object(made, world="again").data["static_passed"]
    edit_spec(made, world="again", patch=[{"op": "replace", "path": "/title", "value": "third"}])
    assert spec_of(made, "w")["title"] != "third"


def test_what_failed_in_the_other_world_stands_in_the_copy(made: ToolContext) -> None:
    ledger = Ledger(WorldFolder.of(made.workspace, "w").ledger_path)
    row = Row(id="beat:fall", check="beat", group="temporal", predicate="p", status="fail", artifact="x")
    ledger.put_rows([row], revision=ledger.revision(), stage="probe")
    (line,) = edit_spec(made, world="again", copy_of="w").data["weakenings_recorded"]
    assert line == "started anew beside world w, in which rows failed for this prompt"


def test_a_copy_that_asks_for_less_than_a_failed_world_says_so(made: ToolContext) -> None:
    (beat, *_) = spec_of(made, "w")["story"]["beats"]
    easier = [{"op": "add", "path": f"/story/beats/{beat}/mandatory", "value": False}]
    assert "weakenings_recorded" not in edit_spec(made, world="early", copy_of="w", patch=easier).data
    ledger = Ledger(WorldFolder.of(made.workspace, "w").ledger_path)
    ledger.add_look("sketch of it", "sketch", 1, 40)
    told = edit_spec(made, world="late", copy_of="w", patch=easier).data["weakenings_recorded"]
    assert told == [
        "started anew beside world w, in which frames were seen without a verdict for this prompt",
        f"copied from w with /story/beats/{beat} made optional",
    ]


def test_claims_come_along_only_with_their_prompt(made: ToolContext) -> None:
    assert spec_of(made, "w")["claims"]
    edit_spec(made, world="same", copy_of="w")
    assert spec_of(made, "same")["claims"] == spec_of(made, "w")["claims"]
    reply = edit_spec(made, world="other", copy_of="w", prompt="A drum rolls down a hill.")
    assert reply.data["left_out"] == "claims, which quote the other prompt"
    assert not spec_of(made, "other").get("claims")
    assert spec_of(made, "other")["prompt"] == "A drum rolls down a hill."


def test_a_copy_of_nothing_or_over_something_is_refused(made: ToolContext) -> None:
    with pytest.raises(InputError, match="there is no world 'v'"):
        edit_spec(made, world="again", copy_of="v")
    with pytest.raises(RefusedError, match="exists already"):
        edit_spec(made, world="w", copy_of="w")
    with pytest.raises(InputError, match="give one of them"):
        edit_spec(made, world="again", copy_of="w", spec=small_spec())
    assert not (made.workspace / "again").exists()

"""Sessions of several clients on one world: each step of one is whole for the others, whenever they look."""

from __future__ import annotations

import contextlib
import sqlite3
from pathlib import Path
from threading import Thread, current_thread
from typing import Any

import pytest
import worldagent.worlds.ledger_file as ledger_file
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.tools.run_checks import run_checks
from worldagent.workflow import creation
from worldagent.workflow.session import Session
from worldagent.worlds.errors import EngineError, RefusedError, WorldAgentError
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row

LATER = [{"op": "replace", "path": "/title", "value": "Later"}]
WAIT_S = 1.0
"""Time that another client is given to go wrong; one that is right waits until this one is done [s]."""


@pytest.fixture
def world(context: Any) -> Any:
    """Surroundings of calls on the small world `w`, at revision 1."""
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    return context


class Other(Thread):
    """Another client that makes one call while this one stands still."""

    def __init__(self, work: Any) -> None:
        super().__init__(daemon=True)
        self._work, self.found, self.error = work, None, ""

    def run(self) -> None:
        try:
            self.found = self._work()
        except WorldAgentError as error:
            self.error = str(error)


def _meanwhile(monkeypatch: pytest.MonkeyPatch, other: Other, *, after: bool) -> None:
    """Have another client call before, or after, this one writes `world.json`."""
    write = Session.write_spec

    def paused(self: Session) -> None:
        if current_thread() is other:
            return write(self)
        if after:
            write(self)
        other.start()
        other.join(WAIT_S)
        return None if after else write(self)

    monkeypatch.setattr(Session, "write_spec", paused)


@pytest.mark.parametrize("after", [False, True])
def test_a_world_that_is_opened_amid_an_edit_is_not_edited_by_hand(
    world: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: bool
) -> None:
    other = Other(lambda: Session.open(tmp_path, "w"))
    _meanwhile(monkeypatch, other, after=after)
    edit_spec(world, world="w", patch=LATER)
    other.join(20)
    assert other.found is not None, other.error
    # One that looks late sees the whole edit, too.
    assert (other.found.revision, other.found.spec.title) in ((1, "Three blocks"), (2, "Later"))[after:]


def test_of_two_clients_that_create_a_world_at_once_the_later_one_is_told_so(
    context: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = Other(lambda: edit_spec(context, world="w", prompt=PROMPT, spec=small_spec()))
    _meanwhile(monkeypatch, other, after=False)
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    other.join(20)
    assert "created by another client meanwhile" in other.error or "exists already" in other.error  # the latter, if it came late


def test_a_restored_world_is_never_one_that_another_client_changed_meanwhile(
    world: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parse = parse_spec

    def parse_while_another_edits(document: Any) -> Any:
        monkeypatch.undo()
        edit_spec(world, world="w", patch=LATER)
        return parse(document)

    monkeypatch.setattr(creation, "parse_spec", parse_while_another_edits)
    with pytest.raises(RefusedError, match="another client changed"):
        edit_spec(world, world="w", on_hand_edit="restore")
    assert Session.open(tmp_path, "w").spec.title == "Later"


def test_an_edit_that_the_ledger_does_not_take_leaves_the_world_as_it_was(
    world: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = (tmp_path / "w" / "world.json").read_bytes()
    monkeypatch.setattr(ledger_file, "_BUSY_S", 0.05)
    with contextlib.closing(sqlite3.connect(tmp_path / "w" / "ledger.sqlite", isolation_level=None)) as reader:
        reader.execute("BEGIN")
        reader.execute("SELECT * FROM revisions").fetchone()  # whoever reads holds up what is to be committed
        with pytest.raises(EngineError, match="in use by another process"):
            edit_spec(world, world="w", patch=LATER)
    assert (tmp_path / "w" / "world.json").read_bytes() == before
    assert not list((tmp_path / "w").glob(".*"))
    assert Session.open(tmp_path, "w").revision == 1


def _row(name: str, check: Any, status: Any = "pass") -> Row:
    return Row(id=name, check=check, group="temporal", predicate="p", status=status, artifact="x")


def test_a_verdict_on_what_an_edit_changed_meanwhile_is_stale_and_replaces_no_later_one(world: Any, tmp_path: Path) -> None:
    judging = Session.open(tmp_path, "w")  # a probe that runs for minutes
    edit_spec(world, world="w", patch=[{"op": "replace", "path": "/story/beats/roll/text", "value": "it rolls on"}])
    later = Session.open(tmp_path, "w")
    later.record([_row("beat:later", "beat", "fail")], stage="probe")
    judging.record(
        [_row("beat:roll", "beat"), _row("beat:later", "beat"), _row("numerical:rigid", "numerical")],
        stage="probe",
        checks=("beat", "numerical"),
    )
    found = {r.id: r for r in later.ledger.rows() if r.check != "audit"}
    assert {name: r.status for name, r in found.items()} == {
        "beat:roll": "unverified",
        "beat:later": "fail",
        "numerical:rigid": "pass",
    }
    assert found["beat:roll"].evidence["stale"] == "story changed in revision 2"


def test_an_audit_of_an_earlier_revision_replaces_no_later_one(world: Any, tmp_path: Path) -> None:
    earlier = Session.open(tmp_path, "w")
    edit_spec(world, world="w", patch=[{"op": "remove", "path": "/claims/three"}])
    later = {r.id: r.status for r in earlier.ledger.rows() if r.check == "audit"}
    assert "fail" in later.values() or "unverified" in later.values()
    assert earlier.audit().passed
    assert {r.id: r.status for r in earlier.ledger.rows() if r.check == "audit"} == later


def test_a_verdict_over_motion_that_comes_amid_static_checks_stays(
    world: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Static checks of one client, while the probe of another ends: what was judged at frame 0 replaces no failure in motion."""
    session = Session.open(tmp_path, "w")
    session.check_static()
    judged = next(r for r in session.ledger.rows() if r.check == "support" and r.status == "pass")
    failure = judged.model_copy(update={"status": "fail"})
    other = Other(lambda: Session.open(tmp_path, "w").ledger.put_rows([failure], revision=1, stage="probe"))
    record = Session.record

    def recorded_after_a_probe(self: Session, *arguments: Any, **more: Any) -> Any:
        if other.ident is None:
            other.start()
            other.join(WAIT_S)
        return record(self, *arguments, **more)

    monkeypatch.setattr(Session, "record", recorded_after_a_probe)
    session.check_static()
    other.join(20)
    assert not other.error
    found = next(r for r in session.ledger.rows() if r.id == judged.id)
    assert (found.status, session.ledger.stages()[judged.id]) == ("fail", "probe")


def test_an_edit_says_where_warnings_about_the_words_of_the_prompt_stand(world: Any) -> None:
    """`row` is a noun that no claim takes up; claimed, nothing is left to warn of."""
    told = edit_spec(world, world="w", patch=[{"op": "replace", "path": "/title", "value": "Another title"}]).data
    assert told["prompt_judged"]["warnings"]
    assert any("prompt_judged.warnings" in w for w in told["warnings"])
    row = {"quote": "row", "type": "place", "by": ["/graph/relations/hits"]}
    clean = edit_spec(world, world="w", patch=[{"op": "add", "path": "/claims/row", "value": row}]).data
    assert "warnings" not in clean["prompt_judged"]
    assert not any("prompt_judged" in w for w in clean["warnings"])


def test_an_edit_tells_what_its_acceptance_will_ask_for(world: Any) -> None:
    without = [{"op": "replace", "path": f"/story/beats/{n}/causes", "value": []} for n in ("strike", "fall")]
    told = edit_spec(world, world="w", patch=without).data["warnings"]
    assert any("no beat names causes" in w for w in told), told
    assert any("no beat names causes" in w for w in run_checks(world, world="w", scope="audit").data["warnings"])

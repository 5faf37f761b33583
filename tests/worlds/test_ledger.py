"""The ledger: revisions by compare-and-swap, a matrix with its history, iterations, verdicts; append-only."""

from __future__ import annotations

import contextlib
import sqlite3
from pathlib import Path
from threading import Thread, current_thread
from typing import Any

import pytest
import worldagent.worlds.ledger as ledger_module
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.ledger_file import matrix_texts
from worldagent.worlds.requirements import Row


@pytest.fixture
def ledger(tmp_path: Path) -> Ledger:
    return Ledger(tmp_path / "ledger.sqlite")


def row(row_id: str, status: str = "pass", **more: Any) -> Row:
    return Row(
        id=row_id,
        check=more.pop("check", "beat"),
        group="temporal",
        predicate="p",
        status=status,
        artifact=more.pop("artifact", "x"),
        **more,
    )  # type: ignore[arg-type]


def test_a_text_whose_type_was_damaged_is_damage_of_the_ledger(ledger: Ledger) -> None:
    """A flipped bit of a record's header makes bytes of a text."""
    ledger.put_rows([row("a:b")], revision=1, stage="static")
    with contextlib.closing(sqlite3.connect(ledger.path)) as db, db:
        db.execute("UPDATE matrix SET row=CAST(row AS BLOB)")
    for read in (ledger.rows, ledger.stages):
        with pytest.raises(EvidenceError, match=r"ledger.sqlite .* is damaged"):
            read()


def test_revisions_are_numbered_and_only_the_expected_one_follows(ledger: Ledger) -> None:
    assert ledger.revision() == 0
    assert ledger.add_revision("{}", "d1", expected=0) == 1
    assert ledger.add_revision("{}", "d2", expected=0) is None
    assert ledger.add_revision('{"a":1}', "d2", expected=1, hypothesis="h", groups={"b", "a"}, weakenings=["w"], reason="r") == 2
    assert ledger.revision_spec(2) == ('{"a":1}', "d2")
    assert ledger.revision_spec(3) is None
    newest, oldest = ledger.revisions()
    assert (newest["n"], newest["groups"], newest["weakenings"], newest["reason"]) == (2, ["a", "b"], ["w"], "r")
    assert oldest["n"] == 1
    assert ledger.weakenings() == [{"revision": 2, "weakenings": ["w"], "reason": "r"}]


def test_of_many_writers_each_revision_has_one(ledger: Ledger) -> None:
    won: list[int] = []

    def work() -> None:
        own = Ledger(ledger.path)
        for _ in range(10):
            number = own.add_revision("{}", "d", expected=own.revision())
            if number is not None:
                won.append(number)

    threads = [Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(won) == list(range(1, ledger.revision() + 1))


@pytest.mark.parametrize("read", ["rows", "stages"])
def test_what_is_written_between_a_record_and_its_seal_is_no_damage(ledger: Ledger, monkeypatch: Any, read: str) -> None:
    ledger.put_rows([row("a")], revision=1, stage="probe")
    writer = Thread(target=lambda: Ledger(ledger.path).put_rows([row("a", "fail"), row("b")], revision=2, stage="full"))
    texts_of = matrix_texts

    def read_while_another_writes(db: sqlite3.Connection) -> tuple[str, ...]:
        texts = texts_of(db)
        if current_thread() is not writer:
            writer.start()
            writer.join(0.5)  # it waits for the reader
        return texts

    monkeypatch.setattr(ledger_module, "matrix_texts", read_while_another_writes)
    found = getattr(ledger, read)()
    writer.join()
    monkeypatch.undo()
    assert len(found) == 1
    assert [(r.id, r.status) for r in ledger.rows()] == [("a", "fail"), ("b", "pass")]


def test_a_test_of_an_earlier_revision_leaves_later_changes_and_rows_alone(ledger: Ledger) -> None:
    """A probe may run while the world is edited and judged on."""
    ledger.add_iteration(1, "too fast", "velocities", [row("a", "fail")])
    ledger.add_iteration(2, "too heavy", "density", [row("a", "fail")])
    ledger.put_rows([row("a"), row("new")], revision=2, stage="static")
    ledger.close_iterations("probe of 1", [], revision=1)
    ledger.put_rows([row("a")], revision=1, stage="probe", checks=["beat"])
    assert [i["revision"] for i in ledger.open_iterations()] == [2]
    assert {r.id for r in ledger.rows()} == {"a", "new"}


def test_what_is_done_together_is_seen_and_counts_as_one(ledger: Ledger) -> None:
    undone: list[str] = []

    def fail() -> None:
        with ledger.together(lambda: undone.append("elsewhere")):
            assert ledger.add_revision("{}", "d", expected=0) == 1
            ledger.put_rows([row("a")], revision=ledger.revision(), stage="static")
            assert [r.id for r in ledger.rows()] == ["a"]
            assert Ledger(ledger.path).revision() == 0
            raise ValueError("in between")

    with pytest.raises(ValueError, match="in between"):
        fail()
    assert (ledger.revision(), ledger.rows(), undone) == (0, [], ["elsewhere"])
    with ledger.together():
        ledger.add_revision("{}", "d", expected=0)
    assert Ledger(ledger.path).revision() == 1


def test_rows_report_changes_and_keep_their_history(ledger: Ledger) -> None:
    first = row("a", "fail", measured=1.0, bound=0.5, first_failing_entity="b", first_failing_frame=3)
    assert ledger.put_rows([first, row("b")], revision=1, stage="probe") == [first, row("b")]
    assert ledger.put_rows([first, row("b")], revision=1, stage="probe") == []
    passed = row("a", measured=0.4, bound=0.5)
    assert ledger.put_rows([passed], revision=2, stage="full") == [passed]
    assert [(h["status"], h["stage"], h["measured"], h["entity"]) for h in ledger.history("a")] == [
        ("pass", "full", 0.4, None),
        ("fail", "probe", 1.0, "b"),
    ]
    assert ledger.stages() == {"a": "full", "b": "probe"}
    assert ledger.ever_failed()


def test_failing_rows_come_first(ledger: Ledger) -> None:
    ledger.put_rows([row("a"), row("b", "fail"), row("c", "unverified"), row("d", "not_applicable")], revision=1, stage="probe")
    assert [r.id for r in ledger.rows()] == ["b", "c", "a", "d"]


def test_rows_of_a_complete_check_that_are_gone_are_removed(ledger: Ledger) -> None:
    ledger.put_rows([row("a"), row("b"), row("c", check="scale")], revision=1, stage="probe")
    ledger.put_rows([row("a")], revision=2, stage="probe", checks=["beat"])
    assert [r.id for r in ledger.rows()] == ["a", "c"]


def test_a_pass_without_an_artifact_is_unverified(ledger: Ledger) -> None:
    ledger.put_rows([row("a", artifact="")], revision=1, stage="probe")
    assert ledger.rows()[0].status == "unverified"


def test_stale_rows_remember_what_they_were_once(ledger: Ledger) -> None:
    ledger.put_rows([row("a", "fail", measured=2.0), row("b")], revision=1, stage="probe")
    assert ledger.mark_stale({"a": "motion changed", "ghost": "x"}, 2) == 1
    assert ledger.mark_stale({"a": "again"}, 3) == 0
    stale = next(r for r in ledger.rows() if r.id == "a")
    assert stale.status == "unverified"
    assert stale.evidence == {"stale": "motion changed", "was": "fail", "was_measured": 2.0}
    assert ledger.history("a")[0]["stage"] == "stale"
    assert ledger.stages()["a"] == "probe"


def test_what_failed_in_motion_is_told_apart_from_what_failed_at_frame_0(ledger: Ledger) -> None:
    ledger.put_rows([row("support:a", "fail")], revision=1, stage="static")
    assert (ledger.ever_failed(), ledger.ever_failed(moving=True)) == (True, False)
    ledger.put_rows([row("beat:b", "fail")], revision=1, stage="probe")
    ledger.put_rows([row("beat:b")], revision=2, stage="probe")
    assert ledger.ever_failed(moving=True)


def test_a_failing_audit_is_no_evidence_against_the_world(ledger: Ledger) -> None:
    ledger.put_rows([row("audit:x", "fail", check="audit")], revision=1, stage="audit")
    assert not ledger.ever_failed()


def test_iterations_stay_open_until_tested(ledger: Ledger) -> None:
    ledger.add_iteration(2, "because", "step", [row("a", "fail")])
    (opened,) = ledger.open_iterations()
    assert (opened["revision"], opened["grp"]) == (2, "step")
    ledger.close_iterations("f1", ["b"], revision=9)
    assert ledger.open_iterations() == []
    (closed,) = ledger.iterations()
    assert (closed["failing_before"], closed["probe"], closed["failing_after"]) == (["a"], "f1", ["b"])
    ledger.close_iterations("f2", [], revision=9)
    assert ledger.iterations()[0]["probe"] == "f1"


def test_freezes_bakes_and_acceptances(ledger: Ledger) -> None:
    assert ledger.freeze("f") is ledger.bake("f") is ledger.acceptance() is None
    ledger.put_freeze("f", 1, passed=False, detail={"failing": ["a"]})
    ledger.put_freeze("f", 2, passed=True, detail={})
    found = ledger.freeze("f")
    assert found is not None
    assert (found["passed"], found["revision"]) == (True, 2)
    ledger.put_bake("f", 2, "digest", {"frames": 3})
    ledger.add_acceptance("f", 2, "s1", "incomplete", {"rows": []})
    ledger.add_acceptance("f", 2, "s2", "accepted", {"rows": [1]})
    ledger.add_acceptance("f", 3, "s1", "accepted", {"rows": [2]})
    latest = ledger.acceptance()
    assert latest is not None
    assert latest["revision"] == 3
    about = ledger.acceptance("s2")
    assert about is not None
    assert about["record"] == {"rows": [1]}
    assert ledger.acceptance("s3") is None


def test_a_failed_write_leaves_nothing(ledger: Ledger) -> None:
    ledger.add_revision("{}", "d", expected=0)
    with pytest.raises(TypeError):
        ledger.put_freeze("f", 1, passed=True, detail={"x": object()})
    assert ledger.revision() == 1
    assert not list(ledger.path.parent.glob("*-wal"))


def test_a_ledger_of_an_older_world_opens_and_goes_on(tmp_path: Path) -> None:
    """Iterations had no changes and no measurements before."""
    import sqlite3

    path = tmp_path / "old.sqlite"
    with sqlite3.connect(path) as db:
        db.execute(
            "CREATE TABLE iterations (n INTEGER PRIMARY KEY AUTOINCREMENT, revision INTEGER NOT NULL, hypothesis TEXT NOT NULL, "
            "grp TEXT NOT NULL, failing_before TEXT NOT NULL, probe TEXT, failing_after TEXT, at REAL NOT NULL)"
        )
        db.execute("INSERT INTO iterations VALUES (1, 2, 'because', 'step', '[\"a\"]', 'f1', '[\"a\"]', 0.0)")
    ledger = Ledger(path)
    (old,) = ledger.attempts()["a"]
    assert (old.revision, old.group, old.before, old.after, old.changes) == (2, "step", None, None, ())
    ledger.add_iteration(3, "because", "contact", [row("a", "fail", measured=2.0)], [("/x", 1, 2)])
    ledger.close_iterations("f2", ["a"], [row("a", "fail", measured=1.0)], revision=9)
    new, kept = ledger.attempts()["a"]
    assert (new.before and new.before.measured, new.after and new.after.measured) == (2.0, 1.0)
    assert kept == old

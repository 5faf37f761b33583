"""The ledger of a world: revisions, matrix, iterations, freezes, bakes, acceptances (SQLite, rollback journal)."""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Iterable, Mapping
from typing import Any

from .ablation import marked
from .baked import refuted_texts
from .ledger_file import check_seal, matrix_texts, put_seal
from .looks import LookLedger, settle_looks
from .requirements import Attempt, Outcome, Row, fail_closed, outcome_of
from .reviews import ReviewLedger

__all__ = ["Ledger"]

_LATER_COLUMNS = {"iterations": ("changes", "before", "after", "expect")}
"""Columns that ledgers of older worlds lack; they are added at the first write that needs them."""


class Ledger(ReviewLedger, LookLedger):
    """Outcomes of one world. Append-only but for the matrix, whose changes are kept in `history`."""

    # ---------------------------------------------------------------- revisions

    def add_revision(
        self,
        spec_json: str,
        digest: str,
        *,
        expected: int,
        patch: Any = (),
        hypothesis: str = "",
        groups: Iterable[str] = (),
        weakenings: Iterable[str] = (),
        reason: str = "",
    ) -> int | None:
        """Append a revision if the latest one is `expected`; returns its number, or None when another came first."""
        with self._write() as db:
            latest = db.execute("SELECT COALESCE(MAX(n), 0) FROM revisions").fetchone()[0]
            if latest != expected:
                return None
            told = (
                json.dumps(list(patch)),
                hypothesis,
                json.dumps(sorted(groups)),
                json.dumps(list(weakenings)),
                reason,
            )
            made = (latest + 1, time.time(), digest, spec_json, *told)
            db.execute("INSERT INTO revisions VALUES (?,?,?,?,?,?,?,?,?)", made)
            put_seal(db, f"edit:{latest + 1}", *told)
            put_seal(db, f"revision:{latest + 1}", digest, spec_json)
            return int(latest) + 1

    def add_early(self, number: int, lines: Iterable[str]) -> None:
        """Keep what a revision made easier before there was evidence that could count against it: no weakenings."""
        text = json.dumps(list(lines))
        with self._write() as db:
            db.execute("INSERT INTO early VALUES (?,?)", (number, text))
            put_seal(db, f"early:{number}", text)

    def revision(self) -> int:
        """Number of the latest revision; 0 before the first."""
        with self._open() as db:
            return int(db.execute("SELECT COALESCE(MAX(n), 0) FROM revisions").fetchone()[0])

    def revision_spec(self, n: int) -> tuple[str, str] | None:
        """(spec JSON, digest) of a revision."""
        with self._open() as db:
            row = db.execute("SELECT spec, digest FROM revisions WHERE n=?", (n,)).fetchone()
            if row is None:
                return None
            check_seal(db, f"revision:{n}", row["digest"], row["spec"])
            return row["spec"], row["digest"]

    def revisions(self, limit: int = 50, offset: int = 0) -> list[dict[str, Any]]:
        """Revisions, newest first, without their specs."""
        with self._open() as db:
            rows = db.execute(
                """
                SELECT n, created, digest, patch, hypothesis, groups, weakenings, reason, COALESCE(lines, '[]') AS early
                FROM revisions LEFT JOIN early USING (n) ORDER BY n DESC LIMIT ? OFFSET ?""",
                (limit, offset),
            ).fetchall()
            _check_edits(db, rows)
            parsed = ("patch", "groups", "weakenings", "early")
            return [{k: json.loads(r[k]) if k in parsed else r[k] for k in r.keys()} for r in rows]  # noqa: SIM118

    def failed_revisions(self) -> list[int]:
        """Revisions at which a row failed that another judges than the audit, oldest first."""
        with self._open() as db:
            rows = db.execute("SELECT DISTINCT revision FROM history WHERE status='fail' AND stage!='audit' ORDER BY revision")
            return [int(r["revision"]) for r in rows.fetchall()]

    def weakenings(self) -> list[dict[str, Any]]:
        """All weakening edits with their reasons, oldest first (R157)."""
        found = reversed(self.revisions(limit=self.revision()))
        return [{"revision": r["n"], "weakenings": r["weakenings"], "reason": r["reason"]} for r in found if r["weakenings"]]

    def judged_since(self) -> dict[str, int | None]:
        """First revision at which a row other than of the audit was judged, and at which a row about motion failed; None: at none."""
        first = "SELECT MIN(revision) AS n FROM history WHERE stage != 'audit'"
        with self._open() as db:
            judged, failed = (
                db.execute(q).fetchone()["n"] for q in (first, f"{first} AND status = 'fail' AND stage != 'static'")
            )
        return {"judged_since": judged, "motion_failed_since": failed}

    # ---------------------------------------------------------------- matrix

    def put_rows(
        self, rows: Iterable[Row], *, revision: int, stage: str, checks: Iterable[str] = (), keep: Iterable[str] = ()
    ) -> list[Row]:
        """Write rows; returns those whose status or measurement changed.

        Args:
            rows: verdicts of one run.
            revision: of the specification they were derived from.
            stage: `audit`, `static`, `probe`, `full` or `acceptance`.
            checks: checks that were run completely: their rows of any stage and no later revision that are not among `rows` go.
            keep: ids of older rows that stay all the same, because this run could not judge them.
        """
        changed: list[Row] = []
        now = time.time()
        closed = [marked(fail_closed(r)) for r in rows]
        kept = {r.id for r in closed} | set(keep)
        with self._write() as db:
            for check in checks:
                for old in db.execute("SELECT id, row FROM matrix WHERE revision <= ?", (revision,)).fetchall():
                    if old["id"] not in kept and json.loads(old["row"])["check"] == check:
                        db.execute("DELETE FROM matrix WHERE id=?", (old["id"],))
            for row in closed:
                before = db.execute("SELECT status, row FROM matrix WHERE id=?", (row.id,)).fetchone()
                text = row.model_dump_json()
                if before is None or before["status"] != row.status or json.loads(before["row"]).get("measured") != row.measured:
                    changed.append(row)
                    db.execute(
                        "INSERT INTO history (id, revision, stage, status, measured, bound, entity, frame, at) VALUES (?,?,?,?,?,?,?,?,?)",
                        (
                            row.id,
                            revision,
                            stage,
                            row.status,
                            row.measured,
                            row.bound,
                            row.first_failing_entity,
                            row.first_failing_frame,
                            now,
                        ),
                    )
                db.execute("INSERT OR REPLACE INTO matrix VALUES (?,?,?,?,?,?)", (row.id, revision, stage, row.status, text, now))
            if stage != "audit" and any(row.status == "fail" for row in closed):
                db.execute("INSERT OR REPLACE INTO meta VALUES ('ever_failed', '1')")
                if stage != "static":
                    db.execute("INSERT OR REPLACE INTO meta VALUES ('ever_failed_moving', '1')")
            put_seal(db, "matrix", *matrix_texts(db))
        return changed

    def mark_stale(self, stale: Mapping[str, str], revision: int) -> int:
        """Turn rows into `unverified` because what they judged changed; id -> reason. Returns how many."""
        count = 0
        with self._write() as db:
            for row_id, reason in stale.items():
                found = db.execute("SELECT row FROM matrix WHERE id=?", (row_id,)).fetchone()
                if found is None:
                    continue
                row = Row.model_validate_json(found["row"])
                if row.status == "unverified" and row.evidence.get("stale"):
                    continue
                evidence = {"stale": reason, "was": row.status, "was_measured": row.measured}
                text = row.model_copy(update={"status": "unverified", "evidence": evidence}).model_dump_json()
                db.execute("UPDATE matrix SET status='unverified', row=?, updated=? WHERE id=?", (text, time.time(), row_id))
                db.execute(
                    "INSERT INTO history (id, revision, stage, status, at) VALUES (?,?,?,?,?)",
                    (row_id, revision, "stale", "unverified", time.time()),
                )
                count += 1
            if count:
                put_seal(db, "matrix", *matrix_texts(db))
        return count

    def judged_at(self) -> dict[str, int]:
        """Revision that each row of the matrix was judged at."""
        with self._open() as db:
            return {r["id"]: r["revision"] for r in db.execute("SELECT id, revision FROM matrix")}

    def rows(self) -> list[Row]:
        """The matrix: failing rows first, then unverified, then the rest, each by id."""
        with self._open() as db:
            check_seal(db, "matrix", *(texts := matrix_texts(db)))
            found = [Row.model_validate_json(text) for text in texts[2::3]]
        rank = {"fail": 0, "unverified": 1, "pass": 2, "not_applicable": 3}
        return sorted(found, key=lambda r: (rank[r.status], not r.mandatory, r.id))

    def stages(self) -> dict[str, str]:
        """Stage each row of the matrix was judged at."""
        with self._open() as db:
            check_seal(db, "matrix", *(texts := matrix_texts(db)))
            return dict(zip(texts[::3], texts[1::3], strict=True))

    def ever_failed(self, *, moving: bool = False) -> bool:
        """True if any row other than of the audit ever failed; with `moving`, other than of the audit and the static checks."""
        with self._open() as db:
            failure = """
                SELECT 1 FROM meta WHERE key=?
                UNION ALL SELECT 1 FROM history WHERE status='fail' AND stage != 'audit' AND stage != ? LIMIT 1"""
            asked = ("ever_failed_moving", "static") if moving else ("ever_failed", "audit")
            return db.execute(failure, asked).fetchone() is not None

    def ever_judged(self) -> bool:
        """True if any row other than of the audit was ever judged."""
        with self._open() as db:
            return db.execute("SELECT 1 FROM history WHERE stage != 'audit' LIMIT 1").fetchone() is not None

    def history(self, row_id: str, limit: int = 20) -> list[dict[str, Any]]:
        """Past verdicts of one row, newest first."""
        with self._open() as db:
            rows = db.execute("SELECT * FROM history WHERE id=? ORDER BY seq DESC LIMIT ?", (row_id, limit)).fetchall()
        return [dict(r) for r in rows]

    # ---------------------------------------------------------------- iterations, freezes, bakes, acceptances

    def add_iteration(
        self,
        revision: int,
        hypothesis: str,
        group: str,
        failing: Iterable[Row],
        changes: Iterable[tuple[str, Any, Any]] = (),
        *,
        expect: str = "",
    ) -> None:
        """Record an attempt at repair, before its test.

        Args:
            revision: that makes the change.
            hypothesis: of the edit.
            group: causal parameter group that it changes.
            failing: rows that fail before it, with what they measured.
            changes: (JSON pointer, old value, new value).
            expect: `higher` or `lower`: where the measured value of its one row should go; empty where nobody said.
        """
        rows = list(failing)
        before = {r.id: outcome_of(r).model_dump(mode="json") for r in rows}
        what = (revision, hypothesis, group, json.dumps([r.id for r in rows]))
        with self._write() as db:
            _add_columns(db, "iterations")
            db.execute(
                "INSERT INTO iterations (revision, hypothesis, grp, failing_before, at, changes, before, expect) VALUES (?,?,?,?,?,?,?,?)",
                (*what, time.time(), json.dumps([list(c) for c in changes]), json.dumps(before), expect),
            )

    def close_iterations(self, probe: str, failing: Iterable[str], rows: Iterable[Row] = (), *, revision: int) -> None:
        """Record the outcome of the test of open iterations, or that they were undone: what fails now, what `rows` measured.

        Rows that are still `unverified` were not judged by the test and are left out. `revision` is the one that was tested:
        a change that was made while the test ran stays open.
        """
        after = {r.id: outcome_of(r).model_dump(mode="json") for r in rows if r.status != "unverified"}
        with self._write() as db:
            _add_columns(db, "iterations")
            untested = "SELECT n, failing_before FROM iterations WHERE probe IS NULL AND revision <= ?"
            for found in db.execute(untested, (revision,)).fetchall():
                kept = {k: after[k] for k in json.loads(found["failing_before"]) if k in after}
                db.execute(
                    "UPDATE iterations SET probe=?, failing_after=?, after=? WHERE n=?",
                    (probe, json.dumps(list(failing)), json.dumps(kept), found["n"]),
                )

    def open_iterations(self) -> list[dict[str, Any]]:
        """Iterations whose change no probe has tested yet."""
        with self._open() as db:
            return [dict(r) for r in db.execute("SELECT * FROM iterations WHERE probe IS NULL ORDER BY n").fetchall()]

    def iterations(self, limit: int = 50) -> list[dict[str, Any]]:
        """Iterations, newest first, with what the rows that failed measured before and after."""
        with self._open() as db:
            rows = db.execute("SELECT * FROM iterations ORDER BY n DESC LIMIT ?", (limit,)).fetchall()
            parsed = ("failing_before", "failing_after", "changes", "before", "after")
            return [{**dict(r), **{k: json.loads((k in r.keys() and r[k]) or "null") for k in parsed}} for r in rows]  # noqa: SIM118

    def attempts(self, limit: int = 50) -> dict[str, list[Attempt]]:
        """Past attempts at repair per row that failed then, newest first."""
        found: dict[str, list[Attempt]] = {}
        for i in self.iterations(limit):
            before, after = i["before"] or {}, i["after"] or {}
            for row_id in i["failing_before"]:
                attempt = Attempt(
                    revision=i["revision"],
                    group=i["grp"],
                    hypothesis=i["hypothesis"],
                    changes=tuple((p, old, new) for p, old, new in i["changes"] or ()),
                    test=i["probe"],
                    before=Outcome(**before[row_id]) if row_id in before else None,
                    after=Outcome(**after[row_id]) if row_id in after else None,
                )
                found.setdefault(row_id, []).append(attempt)
        return found

    def put_freeze(self, freeze: str, revision: int, *, passed: bool, detail: Mapping[str, Any]) -> None:
        """Record a probe's outcome for these settings; only a passed one is a freeze."""
        text = json.dumps(detail, sort_keys=True)
        with self._write() as db:
            db.execute("INSERT OR REPLACE INTO freezes VALUES (?,?,?,?,?)", (freeze, revision, int(passed), text, time.time()))
            put_seal(db, f"freeze:{freeze}", str(int(passed)), text)
            settle_looks(db, freeze, baked=False)

    def freeze(self, freeze: str) -> dict[str, Any] | None:
        """The probe's record for these settings."""
        with self._open() as db:
            row = db.execute("SELECT * FROM freezes WHERE freeze=?", (freeze,)).fetchone()
            if row is None:
                return None
            check_seal(db, f"freeze:{freeze}", str(row["passed"]), row["detail"])
            return {**dict(row), "detail": json.loads(row["detail"]), "passed": bool(row["passed"])}

    def freezes(self, limit: int = 50) -> list[dict[str, Any]]:
        """Outcomes of probes, newest first."""
        with self._open() as db:
            rows = db.execute("SELECT * FROM freezes ORDER BY at DESC LIMIT ?", (limit,)).fetchall()
        return [{**dict(r), "detail": json.loads(r["detail"]), "passed": bool(r["passed"])} for r in rows]

    def put_bake(self, freeze: str, revision: int, digest: str, detail: Mapping[str, Any]) -> None:
        """Record a complete bake, which settles what replays said about an earlier one of the same settings."""
        text = json.dumps(detail, sort_keys=True)
        with self._write() as db:
            db.execute("INSERT OR REPLACE INTO bakes VALUES (?,?,?,?,?)", (freeze, revision, digest, text, time.time()))
            put_seal(db, f"bake:{freeze}", digest, text)
            db.execute("UPDATE refuted SET settled=1 WHERE freeze=?", (freeze,))
            put_seal(db, f"refuted:{freeze}", *refuted_texts(db, freeze))
            settle_looks(db, freeze, baked=True)

    def add_refuted(self, freeze: str, digest: str, intervals: Iterable[Mapping[str, Any]]) -> None:
        """Record that intervals of a bake, simulated again, did not give its bytes; it stays so until the next bake.

        Args:
            freeze: of the bake.
            digest: of the caches that were replayed.
            intervals: what `replay` says of each that differs.
        """
        with self._write() as db:
            for interval in intervals:
                values = (freeze, digest, json.dumps(dict(interval), sort_keys=True), time.time())
                db.execute("INSERT INTO refuted (freeze, digest, detail, at, settled) VALUES (?,?,?,?,0)", values)
            put_seal(db, f"refuted:{freeze}", *refuted_texts(db, freeze))

    def refuted(self, freeze: str) -> list[dict[str, Any]]:
        """Intervals of a freeze's newest bake that a replay did not give again, oldest first, with the caches' digest."""
        with self._open() as db:
            check_seal(db, f"refuted:{freeze}", *(texts := refuted_texts(db, freeze)))
        return [{"digest": d, **json.loads(t)} for d, t in zip(texts[::2], texts[1::2], strict=True)]

    def bake(self, freeze: str) -> dict[str, Any] | None:
        """The record of a complete bake."""
        with self._open() as db:
            row = db.execute("SELECT * FROM bakes WHERE freeze=?", (freeze,)).fetchone()
            if row is None:
                return None
            check_seal(db, f"bake:{freeze}", row["digest"], row["detail"])
            return {**dict(row), "detail": json.loads(row["detail"])}

    def add_acceptance(self, freeze: str, revision: int, subject: str, verdict: str, record: Mapping[str, Any]) -> None:
        """Record the verdict of a fresh process about one candidate; `subject` hashes all it depends on."""
        text = json.dumps(record, sort_keys=True)
        with self._write() as db:
            number = db.execute(
                "INSERT INTO acceptances (freeze, revision, subject, verdict, record, at) VALUES (?,?,?,?,?,?)",
                (freeze, revision, subject, verdict, text, time.time()),
            ).lastrowid
            put_seal(db, f"acceptance:{number}", freeze, subject, verdict, text)

    def acceptance(self, subject: str | None = None) -> dict[str, Any] | None:
        """The latest verdict, or the latest about `subject`."""
        where, values = ("", ()) if subject is None else (" WHERE subject=?", (subject,))
        with self._open() as db:
            row = db.execute(f"SELECT * FROM acceptances{where} ORDER BY n DESC LIMIT 1", values).fetchone()  # noqa: S608 - fixed text
            if row is None:
                return None
            check_seal(db, f"acceptance:{row['n']}", row["freeze"], row["subject"], row["verdict"], row["record"])
            return {**dict(row), "record": json.loads(row["record"])}


def _add_columns(db: sqlite3.Connection, table: str) -> None:
    """Give a table of an older ledger the columns it lacks."""
    known = {r["name"] for r in db.execute(f"PRAGMA table_info({table})").fetchall()}
    for column in _LATER_COLUMNS[table]:
        if column not in known:
            db.execute(f"ALTER TABLE {table} ADD COLUMN {column} TEXT")


def _check_edits(db: sqlite3.Connection, rows: Iterable[sqlite3.Row]) -> None:
    """Compare what revisions say of their edits with their seals."""
    for row in rows:
        check_seal(db, f"edit:{row['n']}", *(row[k] for k in ("patch", "hypothesis", "groups", "weakenings", "reason")))
        if row["early"] != "[]":
            check_seal(db, f"early:{row['n']}", row["early"])

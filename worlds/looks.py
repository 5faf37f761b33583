"""Motions that were looked at, or that ran, before a check judged them: they count as evidence like rows (R113, R157)."""

from __future__ import annotations

import sqlite3
import time
from typing import Any

from .ledger_file import LedgerFile

__all__ = ["RAN", "LookLedger", "settle_looks"]

RAN = ":ran"
"""End of the stage of a motion that ran, whoever looked at it: a run that is ended before its verdict leaves it on record."""
_TESTED, _JUDGED = 1, 2
"""States of a motion without a verdict: another was judged since; it was judged itself."""


class LookLedger(LedgerFile):
    """Motions without a verdict, as a ledger keeps them."""

    def add_look(self, freeze: str, stage: str, revision: int, last: int) -> None:
        """Record that frames 0 to `last` of a motion without a verdict were shown.

        Args:
            freeze: of the motion.
            stage: `probe` or `full`; `sketch`, where rows of one failed, or it was looked at before they were told; with `RAN` at its end
                where nobody looked, and the run has frames that no check has judged yet.
            revision: present one.
            last: last frame that was shown, or that is there.
        """
        with self._write() as db:
            db.execute(
                "INSERT INTO looks VALUES (?,?,?,?,?,0) ON CONFLICT (freeze, stage) DO UPDATE SET settled=0, last=MAX(last, excluded.last)",
                (freeze, stage, revision, last, time.time()),
            )

    def settle_look(self, freeze: str, stage: str) -> None:
        """Record that a motion which ran is judged."""
        with self._write() as db:
            db.execute("UPDATE looks SET settled=? WHERE freeze=? AND stage=?", (_JUDGED, freeze, stage))

    def looks(self, *, untested: bool = False) -> list[dict[str, Any]]:
        """Motions that were looked at, or that ran, and were never judged, oldest first.

        With `untested`, those that were looked at and since which no probe was judged.
        """
        with self._open() as db:
            found = db.execute("SELECT * FROM looks WHERE settled<? ORDER BY at", (_TESTED if untested else _JUDGED,)).fetchall()
            return [dict(r) for r in found if not (untested and str(r["stage"]).endswith(RAN))]


def settle_looks(db: sqlite3.Connection, freeze: str, *, baked: bool) -> None:
    """Within the transaction that records a verdict: settle what it judged, the bake of a freeze or its probe and sketches.

    A probe of another freeze is the test of what was changed since frames were looked at.
    """
    if not baked:
        db.execute("UPDATE looks SET settled=? WHERE settled<?", (_TESTED, _TESTED))
    same = "LIKE" if baked else "NOT LIKE"
    db.execute(f"UPDATE looks SET settled=? WHERE freeze=? AND stage {same} 'full%'", (_JUDGED, freeze))  # noqa: S608 - fixed text

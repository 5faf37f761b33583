"""A world at a glance, as Markdown."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING

from ..worlds.folder import WorldFolder

if TYPE_CHECKING:
    from ..worlds.ledger import Ledger
    from ..worlds.requirements import Row

__all__ = ["world_report"]

_SHOWN_ROWS = 40


def world_report(folder: WorldFolder, ledger: Ledger | None) -> str:
    """Prompt, counts of verdicts, rows that do not pass, weakenings and the latest acceptance."""
    spec = folder.read_json(folder.spec_path)
    lines = [f"# {spec.get('title', folder.id)}", "", f"World `{folder.id}`. Prompt:", "", _quoted(str(spec.get("prompt", "")))]
    if ledger is None:
        return "\n".join([*lines, "", "No ledger: nothing has been checked."])
    rows = ledger.rows()
    counts = Counter(row.status for row in rows)
    lines += [
        "",
        f"Revision {ledger.revision()}. Rows: " + (", ".join(f"{n} {word}" for word, n in sorted(counts.items())) or "none"),
    ]
    open_rows = [row for row in rows if row.status in ("fail", "unverified")]
    if open_rows:
        lines += ["", "## Rows that do not pass", ""]
        lines += [_row(row) for row in open_rows[:_SHOWN_ROWS]]
        if len(open_rows) > _SHOWN_ROWS:
            lines.append(f"- ... and {len(open_rows) - _SHOWN_ROWS} more in worldagent://worlds/{folder.id}/matrix")
    weakenings = ledger.weakenings()
    if weakenings:
        lines += ["", "## Bounds that were weakened", ""]
        lines += [
            f"- revision {w['revision']}: {json.dumps(w['weakenings'])}; reason: {w['reason'] or 'none given'}"
            for w in weakenings
        ]
    accepted = ledger.acceptance()
    lines += ["", "## Acceptance", ""]
    if accepted is None:
        lines.append("Never judged as a whole.")
    else:
        lines.append(
            f"Latest verdict: {accepted['verdict']}, revision {accepted['revision']}, candidate {accepted['freeze'][:16]}."
        )
        if accepted["revision"] != ledger.revision():
            lines.append("It is about an older revision and says nothing about the current one.")
    return "\n".join(lines)


def _quoted(text: str) -> str:
    return "\n".join(f"> {line}" for line in text.splitlines() or [""])


def _row(row: Row) -> str:
    unit = "" if row.unit in ("", "1") else f" {row.unit}"
    measured = "not measured" if row.measured is None else f"{row.measured:.6g}{unit}"
    bound = "" if row.bound is None else f", required {row.comparison} {row.bound:.6g}{unit}"
    where = f", first at {row.first_failing_entity}" if row.first_failing_entity else ""
    when = f" frame {row.first_failing_frame}" if row.first_failing_frame is not None else ""
    action = f". Next: {row.corrections[0].action}" if row.corrections else ""
    return f"- **{row.status}** `{row.id}`: {row.predicate}: {measured}{bound}{where}{when}{action}"

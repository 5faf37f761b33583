"""A world at a glance, as Markdown."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING

from ..worlds.folder import WorldFolder
from ..worlds.quoting import markdown_inline
from ..worlds.verdicts import asked_words, unusual_told, verdict_words

if TYPE_CHECKING:
    from ..worlds.ledger import Ledger
    from ..worlds.requirements import Row

__all__ = ["world_report"]

_SHOWN_ROWS = 40
PROMPT_CHARACTERS = 20_000


def world_report(folder: WorldFolder, ledger: Ledger | None) -> str:
    """Prompt, counts of verdicts, rows that do not pass, weakenings and the latest acceptance."""
    spec = folder.read_json(folder.spec_path)
    lines = [
        f"# {markdown_inline(spec.get('title', folder.id))}",
        "",
        f"World `{folder.id}`. Prompt:",
        "",
        _quoted(str(spec.get("prompt", ""))),
    ]
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
            f"- revision {w['revision']}: {markdown_inline(json.dumps(w['weakenings']))}; "
            f"reason: {markdown_inline(w['reason'] or 'none given')}"
            for w in weakenings
        ]
    from ..workflow.standing import is_about_present

    accepted = ledger.acceptance()
    lines += ["", "## Acceptance", ""]
    if accepted is None:
        lines.append("Never judged as a whole.")
    else:
        lines.append(
            f"Latest verdict: {markdown_inline(verdict_words(accepted['record']))}; revision {accepted['revision']}, candidate {markdown_inline(accepted['freeze'][:16])}."
        )
        lines += [f"- unusual: {markdown_inline(line)}" for line in unusual_told(accepted["record"]).get("unusual", [])]
        if not is_about_present(ledger, accepted):
            lines.append("It is about an older revision and says nothing about the current one.")
    return "\n".join(lines)


def _quoted(text: str) -> str:
    cut, left = text[:PROMPT_CHARACTERS], len(text) - PROMPT_CHARACTERS
    lines = [f"> {markdown_inline(line, most=PROMPT_CHARACTERS)}" for line in cut.splitlines() or [""]]
    return "\n".join(lines + ([f"> ... ({left} more characters)"] if left > 0 else []))


def _row(row: Row) -> str:
    unit = "" if row.unit in ("", "1") else f" {markdown_inline(row.unit)}"
    measured = "not measured" if row.measured is None else f"{row.measured:.6g}{unit}"
    bound = "" if row.bound is None else f", required {asked_words(row.comparison, row.bound, '')}{unit}"
    where = f", first at {markdown_inline(row.first_failing_entity)}" if row.first_failing_entity else ""
    when = f" frame {row.first_failing_frame}" if row.first_failing_frame is not None else ""
    action = f". Next: {markdown_inline(row.corrections[0].action)}" if row.corrections else ""
    return (
        f"- **{row.status}** {markdown_inline(row.id)}: {markdown_inline(row.predicate)}: {measured}{bound}{where}{when}{action}"
    )

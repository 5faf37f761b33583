"""Requirement rows for the model: in full, concise, or one line each, worst and most upstream first."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, get_args

from ..worlds.requirements import Check, Row

__all__ = [
    "Detail",
    "Listed",
    "brief",
    "concise",
    "counts",
    "line",
    "news",
    "open_rows",
    "ranked",
    "shaped",
    "summary",
    "why_line",
]

Detail = Literal["concise", "full"]
Listed = dict[str, Any]

MAX_BRIEF_ROWS = 12
MAX_NAMED_ROWS = 60
EVIDENCE_CHARACTERS = 1500
TEXT_CHARACTERS = 400
MAX_TRIED = 3
ROWS_CHARACTERS = {"concise": 5500, "full": 15000}
"""Characters that the rows of one reply may take; further rows come as single lines."""
LINES_CHARACTERS = 2600
WHY_CHARACTERS = 120
"""Length to which the reason of a row in a line is cut."""
_LATE: dict[str, int] = {"causal": 1, "robustness": 2, "shots": 3, "delivery": 4}
_UPSTREAM: dict[str, tuple[int, int]] = {name: (_LATE.get(name, 0), k) for k, name in enumerate(get_args(Check))}
"""Checks in causal order: a beat that never came explains a broken cause."""
_SUMS = (":scene", "probe:phases")
"""Rows that follow from others end so."""


def brief(row: Row, *, corrections: int = 2) -> Listed:
    """A row in full: no empty fields, the best corrections only."""
    data = row.model_dump(mode="json", exclude={"recipe", "corrections", "evidence"}, exclude_none=True)
    data = {k: v for k, v in data.items() if v not in ("", [], {})}
    if row.status != "pass":
        data["corrections"] = [
            {k: v for k, v in c.model_dump(mode="json").items() if v not in ("", [], None)} for c in row.corrections[:corrections]
        ]
        measured = {k: v for k, v in row.evidence.items() if k not in ("diagnosis", "edit_classes")}
        text = json.dumps(measured, default=str)
        told: Listed = {k: measured[k][:n] for k, n in (("explanation", TEXT_CHARACTERS), ("problems", 4)) if k in measured}
        cut = {**told, "cut": text[:EVIDENCE_CHARACTERS] + "... (all: inspect_world part='row')"}
        data["evidence"] = measured if len(text) < EVIDENCE_CHARACTERS else cut
        if "diagnosis" in row.evidence:
            data["diagnosis"] = row.evidence["diagnosis"]
    return data


def concise(row: Mapping[str, Any], world: str = "") -> Listed:
    """The part of a full row that decides the next step: what was measured, why it fails, what to do, where to look."""
    told = line(row) | {"predicate": _cut(row.get("predicate", ""))}
    if row.get("frames"):
        told["frames"] = row["frames"]
    why = _why(row)
    if why:
        told["why"] = _cut(why)
    corrections = [_correction(c) for c in row.get("corrections", ())]
    if corrections:
        told["corrections"] = corrections
    tried = row.get("diagnosis", {}).get("tried")
    if tried:
        told["tried"] = tried[:MAX_TRIED]
    looks = [_look(p, world) for p in row.get("diagnosis", {}).get("cheapest_probe", ())[:1]]
    if looks and (row["status"] == "fail" or not corrections):
        told["look"] = looks[0]
    return told


def line(row: Mapping[str, Any]) -> Listed:
    """A row in a line: which, and by how much it misses."""
    told: Listed = {"id": row["id"], "check": row["check"], "status": row["status"]}
    if not row.get("mandatory", True):
        told["mandatory"] = False
    if row.get("measured") is not None:
        told["measured"] = _short(row["measured"])
    if row.get("bound") is not None:
        unit = row.get("unit", "")
        told["needs"] = f"{row.get('comparison', '')} {_short(row['bound']):g} {'' if unit == '1' else unit}".strip()
    for key, name in (("first_failing_entity", "entity"), ("first_failing_frame", "frame")):
        if row.get(key) is not None:
            told[name] = row[key]
    return told


def why_line(row: Mapping[str, Any]) -> Listed:
    """A row in a line, with the beginning of its reason where it does not pass: whoever mends it need not ask for each."""
    told, why = line(row), _why(row) if row["status"] in ("fail", "unverified") else ""
    if why:
        told["why"] = why if len(why) <= WHY_CHARACTERS else f"{why[:WHY_CHARACTERS]}..."
    return told


def _short(value: float) -> float:
    return float(f"{value:.6g}")


def _cut(text: str) -> str:
    return text if len(text) <= TEXT_CHARACTERS else f"{text[:TEXT_CHARACTERS]}... (more: inspect_world part='row')"


def _why(row: Mapping[str, Any]) -> str:
    evidence = row.get("evidence")
    if not isinstance(evidence, Mapping):
        return str(evidence or "")
    if evidence.get("explanation"):
        return str(evidence["explanation"])
    stale = evidence.get("stale")
    return "; ".join(str(p) for p in evidence.get("problems", ())[:4]) or (f"stale: {stale}" if stale else "")


def _correction(correction: Mapping[str, Any]) -> Listed:
    """Cause, group and action, with the patch, or else the places to look at."""
    kept = {k: correction[k] for k in ("cause", "edit_class", "group", "action", "patch", "tried") if k in correction}
    if kept.get("cause") == kept.get("action"):
        kept.pop("cause", None)
    if "patch" not in kept and "pointers" in correction:
        kept["pointers"] = correction["pointers"]
    if "skill" in correction:
        kept["skill"] = correction["skill"]
    return kept


def _look(probe: Mapping[str, Any], world: str) -> str:
    """The cheapest measurement that tells the causes apart, as a call."""
    given = ({"world": world} if world else {}) | dict(probe.get("arguments", {}))
    arguments = ", ".join(f"{k}={v!r}" for k, v in given.items())
    return f"{probe['tool']}({arguments}): {probe.get('look_at', '')}"


def counts(rows: Iterable[Row]) -> dict[str, int]:
    """Rows per status, mandatory ones that do not pass apart."""
    found = {"pass": 0, "fail": 0, "unverified": 0, "not_applicable": 0, "mandatory_open": 0}
    for row in rows:
        found[row.status] += 1
        found["mandatory_open"] += row.mandatory and row.status in ("fail", "unverified")
    return found


def ranked(rows: Iterable[Row], *, only: Sequence[str] = ("fail", "unverified", "pass", "not_applicable")) -> list[Row]:
    """Rows of these statuses in their order, mandatory ones first, then upstream checks, early frames, summaries last."""
    rank = {status: k for k, status in enumerate(only)}

    def key(row: Row) -> tuple[Any, ...]:
        start = row.frames[0] if row.frames is not None else 0
        return (rank[row.status], not row.mandatory, _UPSTREAM[row.check], row.id.endswith(_SUMS), start, row.id)

    return sorted((r for r in rows if r.status in rank), key=key)


def open_rows(rows: Iterable[Row], *, static: bool = False) -> list[Row]:
    """Rows that do not pass, ranked; with `static` those of shots count only where they fail."""
    return [r for r in ranked(rows, only=("fail", "unverified")) if not (static and r.check == "shots" and r.status != "fail")]


def summary(rows: Sequence[Row], *, static: bool = False) -> Listed:
    """Counts, and the rows that do not pass, worst first; with `static`, what only motion can tell is just counted."""
    left = open_rows(rows, static=static)
    data: Listed = {"counts": counts(rows), "open_rows": [brief(r) for r in left[:MAX_BRIEF_ROWS]]}
    if len(left) > MAX_BRIEF_ROWS:
        data["more_open_rows"] = [r.id for r in left[MAX_BRIEF_ROWS : MAX_BRIEF_ROWS + MAX_NAMED_ROWS]]
        data["open_total"] = len(left)
    if static:
        data["waiting_for_motion"] = sum(r.status == "unverified" and r.check == "shots" for r in rows)
    return data


def news(rows: Sequence[Row], before: Mapping[str, Row], *, static: bool = False) -> Listed:
    """As `summary`, with those open rows only that are not what they were before; the others by their ids."""
    same = {r.id for r in rows if r.id in before and _told(r) == _told(before[r.id])}
    left = [r.id for r in open_rows(rows, static=static) if r.id in same]
    data = summary([r for r in rows if r.id not in same], static=static) | {"counts": counts(rows)}
    if static:
        data["waiting_for_motion"] = sum(r.status == "unverified" and r.check == "shots" for r in rows)
    return {**data, **({"open_as_before": left[:MAX_BRIEF_ROWS]} if left else {})}


def _told(row: Row) -> tuple[Any, ...]:
    """The part of a row that its reader has to know anew when it changes."""
    return row.status, row.measured, row.first_failing_entity, row.evidence.get("problems")


def shaped(
    rows: Sequence[Mapping[str, Any]], detail: Detail = "concise", *, world: str = "", room: int | None = None
) -> list[Listed]:
    """Rows in full as a reply shows them: the first ones as asked, later ones in a line where the room is used up."""
    told: list[Listed] = []
    left = ROWS_CHARACTERS[detail] if room is None else room
    lines = LINES_CHARACTERS
    for row in rows:
        item = concise(row, world) if detail == "concise" else dict(row)
        size = len(json.dumps(item, default=str))
        if not told or size <= left:
            told.append(item)
            left -= size
            continue
        left = 0
        item = why_line(row)
        lines -= len(json.dumps(item))
        if lines < 0:
            break
        told.append(item)
    return told

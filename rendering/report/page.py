"""The matrix report: one HTML page about one verdict, with its pictures inside (no script, no network).

Every word on it may come from an agent or a stranger: all text is escaped, characters that reorder or hide text are
spelled out, and the page's own policy forbids scripts and foreign content.
"""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...worlds.quoting import visible
from ...worlds.spec import WorldSpec
from .style import STYLE

__all__ = ["ReportPictures", "matrix_page"]

GROUPS = ("spatial", "physical", "temporal", "observational", "delivery")
ORDER = ("fail", "unverified", "pass", "not_applicable")
MAX_GROUP_ROWS = 1500
"""Rows of one group on the page, worst first; the rest is counted."""
MAX_EVIDENCE = 4000
"""Characters of evidence per row on the page; all of it is in the bundle."""
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


@dataclass(frozen=True)
class ReportPictures:
    """Encoded pictures (PNG or JPEG) of a candidate."""

    sheet: bytes | None = None
    """Contact sheet over all frames."""
    ledger: bytes | None = None
    """Plots of energy, momentum, gaps and contacts."""
    rows: Mapping[str, tuple[str, bytes]] = field(default_factory=dict)
    """Per row id: caption, and the picture of its first failing frame."""


def _e(value: Any) -> str:
    """Text as HTML, with nothing in it that acts or hides."""
    return html.escape(visible(str(value)), quote=True)


def _tag(name: str, inner: str, **attributes: str) -> str:
    """An element around HTML that is escaped already."""
    given = "".join(f' {k.rstrip("_")}="{_e(v)}"' for k, v in attributes.items())
    return f"<{name}{given}>{inner}</{name}>"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of escaped cells; the head is plain text."""
    body = "".join(_tag("tr", "".join(cells)) for cells in rows)
    titles = "".join(_tag("th", _e(h), scope="col") for h in head)
    return _tag("div", _tag("table", _tag("thead", _tag("tr", titles)) + _tag("tbody", body)), class_="scroll")


def _td(inner: str, kind: str = "") -> str:
    return _tag("td", inner, class_=kind) if kind else _tag("td", inner)


def _figure(data: bytes | None, caption: str, alternative: str) -> str:
    if data is None:
        return ""
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    source = f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
    return _tag("figure", f'<img alt="{_e(alternative)}" src="{source}">' + _tag("figcaption", _e(caption)))


def _status(word: Any) -> str:
    return _tag("strong", _e(str(word).replace("_", " ")), class_=str(word) if word in ORDER else "")


def _number(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (int, float)) else "-"


def _measured(row: Mapping[str, Any]) -> str:
    unit = "" if row.get("unit") in ("", "1", None) else f" {row['unit']}"
    bound = "" if row.get("bound") is None else f", required {row.get('comparison', '')} {_number(row['bound'])}{unit}"
    shown = "not measured" if row.get("measured") is None else f"{_number(row['measured'])}{unit}"
    return _e(shown + bound)


def _first(row: Mapping[str, Any]) -> str:
    where = row.get("first_failing_entity")
    frame = row.get("first_failing_frame")
    return _e(" ".join(p for p in (where or "", "" if frame is None else f"frame {frame}") if p) or "-")


def _actions(row: Mapping[str, Any]) -> str:
    """List of corrections of a row that does not pass, as HTML."""
    lines = [
        _tag(
            "li",
            f"{_e(c.get('cause', ''))}: {_e(c.get('action', ''))} " + _tag("span", _e(f"({c.get('group', '')})"), class_="dim"),
        )
        for c in row.get("corrections") or ()
    ]
    return _tag("ol", "".join(lines)) if lines else ""


def _evidence(row: Mapping[str, Any]) -> str:
    """The explanation in words; the numbers behind it folded."""
    found = dict(row.get("evidence") or {})
    words = found.pop("explanation", None)
    said = _tag("div", _e(words), class_="dim") if isinstance(words, str) else ""
    if not found:
        return said
    text = json.dumps(found, sort_keys=True, ensure_ascii=False, default=str)
    left = len(text) - MAX_EVIDENCE
    cut = _e(text[:MAX_EVIDENCE]) + (_e(f" ... {left} more characters in the bundle") if left > 0 else "")
    return said + _tag("details", _tag("summary", "evidence") + _tag("pre", cut))


def _sorted(rows: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    rank = {word: k for k, word in enumerate(ORDER)}
    return sorted(rows, key=lambda r: (rank.get(r["status"], 0), not r["mandatory"], r["id"]))


def _is_open(row: Mapping[str, Any]) -> bool:
    return row["status"] in ("fail", "unverified")


def _group(name: str, rows: Sequence[Mapping[str, Any]]) -> str:
    shown = [
        (
            _td(_status(r["status"]) + ("" if r["mandatory"] else _tag("div", "optional", class_="dim")), "n"),
            _td(_tag("div", _e(r["id"]), class_="id") + _e(r["predicate"]) + (_actions(r) if _is_open(r) else "") + _evidence(r)),
            _td(_measured(r)),
            _td(_e("-" if r.get("frames") is None else f"{r['frames'][0]} to {r['frames'][1]}"), "n"),
            _td(_first(r)),
        )
        for r in _sorted(rows)[:MAX_GROUP_ROWS]
    ]
    left = len(rows) - len(shown)
    note = _tag("p", _e(f"{left} further rows, none worse than these, are in the bundle."), class_="dim") if left > 0 else ""
    counts = ", ".join(
        f"{sum(r['status'] == s for r in rows)} {s.replace('_', ' ')}" for s in ORDER if any(r["status"] == s for r in rows)
    )
    head = ("status", "requirement, evidence", "measured", "frames", "first failing")
    return _tag("h3", _e(f"{name}: {counts}")) + _table(head, shown) + note


def _clauses(record: Mapping[str, Any], spec: WorldSpec) -> str:
    rows = record["rows"]

    def judged(pointer: str) -> str:
        name = pointer.rpartition("/")[2]
        concerned = [r for r in rows if name in (r.get("subject") or ()) or name in (r.get("entities") or ())]
        words = {s: sum(r["status"] == s for r in concerned) for s in ORDER}
        found = " ".join(_tag("span", _e(f"{n} {s.replace('_', ' ')}"), class_=s) for s, n in words.items() if n)
        return _tag("li", _tag("code", _e(pointer)) + " " + (found or _tag("span", "no row names it", class_="dim")))

    lines = []
    for key, clause in record["clauses"].items():
        mapped = spec.clauses.get(key)
        unmet = clause.get("unmet")
        met = "" if mapped is None else _tag("ul", "".join(judged(p) for p in mapped.met_by))
        notes = "".join(
            _tag("div", _e(f"{k.replace('_', ' ')}: {v}")) for k, v in clause.items() if k not in ("text", "unmet") and v
        )
        state = (
            _tag("strong", "unmet", class_="fail") + f": {_e(unmet)}"
            if unmet
            else met or _tag("span", "not mapped", class_="unverified")
        )
        lines.append((_td(_e(key), "id"), _td(_e(clause["text"])), _td(state + notes)))
    return _table(("clause", "words of the prompt", "met by"), lines)


def _timeline(record: Mapping[str, Any], spec: WorldSpec) -> str:
    last = max(spec.simulation.frames - 1, 1)
    by_id = {r["id"]: r for r in record["rows"]}
    events = (record.get("events") or {}).get("beats") or {}

    def line(name: str) -> Sequence[str]:
        beat = spec.story.beats[name]
        row = by_id.get(f"beat:{name}")
        status = row["status"] if row else "unverified"
        left, width = 100 * beat.frames[0] / last, 100 * max(beat.frames[1] - beat.frames[0], 0.5) / last
        true = events.get(name)
        mark = "" if true is None else f'<i style="left:{100 * true / last:.2f}%"></i>'
        bar = _tag(
            "div", f'<span style="left:{left:.2f}%;width:{min(width, 100 - left):.2f}%"></span>{mark}', class_=f"bar {status}"
        )
        causes = "".join(_tag("div", _e(f"after {c}")) for c in beat.causes) or "-"
        when = f"frames {beat.frames[0]} to {beat.frames[1]}" + (
            "" if true is None else f", true at {true} ({true / spec.simulation.fps:.2f} s)"
        )
        return (
            _td(_status(status)),
            _td(_tag("div", _e(name), class_="id") + _e(beat.text)),
            _td(causes),
            _td(bar + _tag("div", _e(when), class_="dim")),
        )

    order = sorted(spec.story.beats, key=lambda n: spec.story.beats[n].frames)
    return _table(("status", "beat", "cause", f"when, of frames 0 to {last}"), (line(n) for n in order))


def _open_rows(record: Mapping[str, Any], pictures: ReportPictures) -> str:
    found = [r for r in _sorted(record["rows"]) if _is_open(r) and r["mandatory"]]
    cards = []
    for row in found[:60]:
        caption, data = pictures.rows.get(row["id"], ("", None))
        words = f"{_status(row['status'])} {_tag('span', _e(row['id']), class_='id')}: {_e(row['predicate'])}"
        facts = _tag("div", f"{_measured(row)}; first at {_first(row)}")
        cards.append(
            _tag(
                "div",
                words + facts + _actions(row) + _figure(data, caption, f"{row['id']} at its first failing frame"),
                class_=f"card {row['status']}",
            )
        )
    left = len(found) - len(cards)
    return "".join(cards) + (_tag("p", _e(f"and {left} more, below"), class_="dim") if left > 0 else "")


def _weakenings(record: Mapping[str, Any]) -> str:
    found = record.get("weakenings") or []
    if not found:
        return _tag("p", "None: no edit made the specification easier to satisfy.")
    lines = [
        (
            _td(_e(w["revision"]), "n"),
            _td("".join(_tag("div", _e(x)) for x in w["weakenings"])),
            _td(_e(w["reason"] or "none given (before any failure)")),
        )
        for w in found
    ]
    return _table(("revision", "what became easier", "reason given by the agent"), lines)


def _made_with(record: Mapping[str, Any]) -> str:
    facts = {
        **(record.get("environment") or {}),
        **(record.get("versions") or {}),
        "freeze": record.get("freeze"),
        "specification (SHA-256 of RFC 8785)": record.get("spec_digest"),
        "prompt (SHA-256)": record.get("prompt_digest"),
        "caches (SHA-256)": record.get("cache_digest"),
        "verifiers (SHA-256)": record.get("verifier_source"),
        "replayed intervals chosen by seed": record.get("seed"),
    }
    return _table(("", ""), ((_td(_e(k)), _td(_tag("code", _e(v)))) for k, v in facts.items() if v not in (None, "")))


def _section(title: str, inner: str) -> str:
    return _tag("section", _tag("h2", _e(title)) + inner) if inner else ""


def matrix_page(
    record: Mapping[str, Any], spec: WorldSpec, *, pictures: ReportPictures | None = None, problems: Sequence[str] = ()
) -> str:
    """The page.

    Args:
        record: of a judgement (`verifiers.acceptance.judge`), with `weakenings` where a ledger tells them.
        spec: the judged specification.
        pictures: of the candidate.
        problems: further reasons against the verdict, in words.
    """
    shown = pictures or ReportPictures()
    rows = record["rows"]
    verdict = str(record["verdict"])
    counts = ", ".join(f"{sum(r['status'] == s for r in rows)} {s.replace('_', ' ')}" for s in ORDER)
    open_count = sum(r["mandatory"] and _is_open(r) for r in rows)
    head = (
        _tag("h1", _e(spec.title))
        + _tag(
            "p",
            _tag(
                "span",
                _e(verdict),
                class_=f"verdict {verdict}" if verdict in ("accepted", "incomplete", "refused") else "verdict",
            ),
        )
        + _tag("p", _e(f"{len(rows)} requirements: {counts}; {open_count} mandatory ones open."))
        + (_tag("p", _e(record["reason"]), class_="unverified") if record.get("reason") else "")
        + (_tag("ul", "".join(_tag("li", _e(p), class_="fail") for p in problems)) if problems else "")
    )
    groups = [(g, [r for r in rows if r["group"] == g]) for g in GROUPS]
    register = "".join(_tag("li", f"{_e(a['what'])}: {_e(a['effect'])}") for a in record["approximations"])
    how = _tag("p", "A verdict is worth what can be checked. On any machine, with an installation of your own:") + _tag(
        "pre", "worldagent verify BUNDLE.zip\nworldagent verify FOLDER --replay --intervals all\nworldagent recompute FOLDER"
    )
    sections = (
        _section("Prompt", _tag("blockquote", _e(spec.prompt)) + _clauses(record, spec)),
        _section("The sequence", _figure(shown.sheet, "Contact sheet over all frames", "contact sheet")),
        _section("Beats", _timeline(record, spec) if spec.story.beats else ""),
        _section("What does not pass", _open_rows(record, shown)),
        _section("Requirements", "".join(_group(g, found) for g, found in groups if found)),
        _section("Ledgers", _figure(shown.ledger, "Energy, momentum, gaps and contacts; beats are shaded", "plots over time")),
        _section("Weakenings", _weakenings(record)),
        _section("Approximations", _tag("ul", register) if register else _tag("p", "None registered.")),
        _section("Made with", _made_with(record)),
        _section("How to check it", how),
    )
    meta = f'<meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="{POLICY}"><meta name="viewport" content="width=device-width,initial-scale=1"><meta name="color-scheme" content="light dark">'
    title = _tag("title", _e(f"{spec.title}: {verdict}"))
    body = _tag("body", _tag("header", head) + _tag("main", "".join(sections)))
    return f'<!DOCTYPE html>\n<html lang="en"><head>{meta}{title}<style>{STYLE}</style></head>{body}</html>\n'

"""The matrix report: one HTML page about one verdict, with its pictures inside (no script, no network).

Every word on it may come from an agent or a stranger: all text is escaped, characters that reorder or hide text are
spelled out, and the page's own policy forbids scripts and foreign content.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ...worlds.judged_spans import judged_spans
from ...worlds.spec import WorldSpec
from ...worlds.verdicts import unusual_told, verdict_words
from .encoded import ReportPictures
from .markup import cell, escaped, figure, table, tag
from .prompt import prompt_section, span_styles
from .style import STYLE

__all__ = ["ReportPictures", "matrix_page"]

GROUPS = ("spatial", "physical", "temporal", "observational", "delivery")
ORDER = ("fail", "unverified", "pass", "not_applicable")
MAX_GROUP_ROWS = 1500
"""Rows of one group on the page, worst first; the rest is counted."""
MAX_EVIDENCE = 4000
"""Characters of evidence per row on the page; all of it is in the bundle."""
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


def _status(word: Any) -> str:
    return tag("strong", escaped(str(word).replace("_", " ")), class_=str(word) if word in ORDER else "")


def _number(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (int, float)) else "-"


def _measured(row: Mapping[str, Any]) -> str:
    unit = "" if row.get("unit") in ("", "1", None) else f" {row['unit']}"
    bound = "" if row.get("bound") is None else f", required {row.get('comparison', '')} {_number(row['bound'])}{unit}"
    shown = "not measured" if row.get("measured") is None else f"{_number(row['measured'])}{unit}"
    return escaped(shown + bound)


def _first(row: Mapping[str, Any]) -> str:
    where = row.get("first_failing_entity")
    frame = row.get("first_failing_frame")
    return escaped(" ".join(p for p in (where or "", "" if frame is None else f"frame {frame}") if p) or "-")


def _actions(row: Mapping[str, Any]) -> str:
    """List of corrections of a row that does not pass, as HTML."""
    lines = [
        tag(
            "li",
            f"{escaped(c.get('cause', ''))}: {escaped(c.get('action', ''))} "
            + tag("span", escaped(f"({c.get('group', '')})"), class_="dim"),
        )
        for c in row.get("corrections") or ()
    ]
    return tag("ol", "".join(lines)) if lines else ""


def _evidence(row: Mapping[str, Any]) -> str:
    """The explanation in words; the numbers behind it folded."""
    found = dict(row.get("evidence") or {})
    words = found.pop("explanation", None)
    said = tag("div", escaped(words), class_="dim") if isinstance(words, str) else ""
    if not found:
        return said
    text = json.dumps(found, sort_keys=True, ensure_ascii=False, default=str)
    left = len(text) - MAX_EVIDENCE
    cut = escaped(text[:MAX_EVIDENCE]) + (escaped(f" ... {left} more characters in the bundle") if left > 0 else "")
    return said + tag("details", tag("summary", "evidence") + tag("pre", cut))


def _sorted(rows: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    rank = {word: k for k, word in enumerate(ORDER)}
    return sorted(rows, key=lambda r: (rank.get(r["status"], 0), not r["mandatory"], r["id"]))


def _is_open(row: Mapping[str, Any]) -> bool:
    return row["status"] in ("fail", "unverified")


def _group(name: str, rows: Sequence[Mapping[str, Any]]) -> str:
    shown = [
        (
            cell(_status(r["status"]) + ("" if r["mandatory"] else tag("div", "optional", class_="dim")), "n"),
            cell(
                tag("div", escaped(r["id"]), class_="id")
                + escaped(r["predicate"])
                + (_actions(r) if _is_open(r) else "")
                + _evidence(r)
            ),
            cell(_measured(r)),
            cell(escaped("-" if r.get("frames") is None else f"{r['frames'][0]} to {r['frames'][1]}"), "n"),
            cell(_first(r)),
        )
        for r in _sorted(rows)[:MAX_GROUP_ROWS]
    ]
    left = len(rows) - len(shown)
    note = tag("p", escaped(f"{left} further rows, none worse than these, are in the bundle."), class_="dim") if left > 0 else ""
    counts = ", ".join(
        f"{sum(r['status'] == s for r in rows)} {s.replace('_', ' ')}" for s in ORDER if any(r["status"] == s for r in rows)
    )
    head = ("status", "requirement, evidence", "measured", "frames", "first failing")
    return tag("h3", escaped(f"{name}: {counts}")) + table(head, shown) + note


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
        bar = tag(
            "div", f'<span style="left:{left:.2f}%;width:{min(width, 100 - left):.2f}%"></span>{mark}', class_=f"bar {status}"
        )
        causes = "".join(tag("div", escaped(f"after {c}")) for c in beat.causes) or "-"
        when = f"frames {beat.frames[0]} to {beat.frames[1]}" + (
            "" if true is None else f", true at {true} ({true / spec.simulation.fps:.2f} s)"
        )
        return (
            cell(_status(status)),
            cell(tag("div", escaped(name), class_="id") + escaped(beat.text)),
            cell(causes),
            cell(bar + tag("div", escaped(when), class_="dim")),
        )

    order = sorted(spec.story.beats, key=lambda n: spec.story.beats[n].frames)
    return table(("status", "beat", "cause", f"when, of frames 0 to {last}"), (line(n) for n in order))


def _open_rows(record: Mapping[str, Any], pictures: ReportPictures) -> str:
    found = [r for r in _sorted(record["rows"]) if _is_open(r) and r["mandatory"]]
    cards = []
    for row in found[:60]:
        caption, data = pictures.rows.get(row["id"], ("", None))
        words = f"{_status(row['status'])} {tag('span', escaped(row['id']), class_='id')}: {escaped(row['predicate'])}"
        facts = tag("div", f"{_measured(row)}; first at {_first(row)}")
        cards.append(
            tag(
                "div",
                words + facts + _actions(row) + figure(data, caption, f"{row['id']} at its first failing frame"),
                class_=f"card {row['status']}",
            )
        )
    left = len(found) - len(cards)
    return "".join(cards) + (tag("p", escaped(f"and {left} more, below"), class_="dim") if left > 0 else "")


def _weakenings(record: Mapping[str, Any]) -> str:
    found, beside = record.get("weakenings") or [], _beside(record)
    if not found:
        return tag("p", "None: no edit made the specification easier to satisfy.") + beside
    lines = [
        (
            cell(escaped(w["revision"]), "n"),
            cell("".join(tag("div", escaped(x)) for x in w["weakenings"])),
            cell(escaped(w["reason"] or "none given (before any failure)")),
        )
        for w in found
    ]
    return table(("revision", "what became easier", "reason given by the agent"), lines) + beside


def _beside(record: Mapping[str, Any]) -> str:
    """Where the world asks less than failed ones of its prompt, as its maker's server compared them."""
    found = [tag("li", escaped(line)) for line in record.get("easier_beside") or ()]
    return tag("h3", "Beside failed worlds of this prompt, by claim") + tag("ul", "".join(found)) if found else ""


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
    return table(
        ("what", "value"), ((cell(escaped(k)), cell(tag("code", escaped(v)))) for k, v in facts.items() if v not in (None, ""))
    )


def _section(title: str, inner: str) -> str:
    return tag("section", tag("h2", escaped(title)) + inner) if inner else ""


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
    verdict, says = str(record["verdict"]), verdict_words(record)
    spans = judged_spans(record.get("prompt") or {}, rows)
    odd = unusual_told(record).get("unusual", [])
    counts = ", ".join(f"{sum(r['status'] == s for r in rows)} {s.replace('_', ' ')}" for s in ORDER)
    open_count = sum(r["mandatory"] and _is_open(r) for r in rows)
    head = (
        tag("h1", escaped(spec.title))
        + tag(
            "p",
            tag(
                "span",
                escaped(says),
                class_=f"verdict {verdict}" if verdict in ("accepted", "incomplete", "refused") else "verdict",
            ),
        )
        + tag("p", escaped(f"{len(rows)} requirements: {counts}; {open_count} mandatory ones open."))
        + (tag("p", escaped(record["reason"]), class_="unverified") if record.get("reason") else "")
        + (tag("ul", "".join(tag("li", escaped(p), class_="fail") for p in problems)) if problems else "")
        + (_section("Unusual", tag("ul", "".join(tag("li", escaped(line)) for line in odd))) if odd else "")
    )
    groups = [(g, [r for r in rows if r["group"] == g]) for g in GROUPS]
    register = "".join(tag("li", f"{escaped(a['what'])}: {escaped(a['effect'])}") for a in record["approximations"])
    how = tag("p", "A verdict is worth what can be checked. On any machine, with an installation of your own:") + tag(
        "pre", "worldagent verify BUNDLE.zip\nworldagent verify FOLDER --replay --intervals all\nworldagent recompute FOLDER"
    )
    sections = (
        _section("Prompt", prompt_section(record, spec, spans, shown)),
        _section("The sequence", figure(shown.sheet, "Contact sheet over all frames", "contact sheet")),
        _section("Beats", _timeline(record, spec) if spec.story.beats else ""),
        _section("What does not pass", _open_rows(record, shown)),
        _section("Requirements", "".join(_group(g, found) for g, found in groups if found)),
        _section("Ledgers", figure(shown.ledger, "Energy, momentum, gaps and contacts; beats are shaded", "plots over time")),
        _section("Weakenings", _weakenings(record)),
        _section("Approximations", tag("ul", register) if register else tag("p", "None registered.")),
        _section("Made with", _made_with(record)),
        _section("How to check it", how),
    )
    meta = f'<meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="{POLICY}"><meta name="viewport" content="width=device-width,initial-scale=1"><meta name="color-scheme" content="light dark">'
    title = tag("title", escaped(f"{spec.title}: {says}"))
    body = tag("body", tag("header", head) + tag("main", "".join(sections)))
    return f'<!DOCTYPE html>\n<html lang="en"><head>{meta}{title}<style>{STYLE}{span_styles(spans, shown)}</style></head>{body}</html>\n'

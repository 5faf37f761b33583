"""The prompt on the report: each span coloured by what it is taken to mean, what was measured for it, and a picture of it.

Without a script: pointing at a span, or moving to it by keyboard, shows its note and its picture beside the text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...worlds.judged_spans import SPAN_SIGNS, STATE_WORDS, JudgedSpan, first_shown, row_numbers, span_words
from ...worlds.spec import WorldSpec
from ...worlds.verdicts import reader_words
from .encoded import ReportPictures
from .markup import escaped, figure, tag

__all__ = ["prompt_section", "span_styles"]

_STATUSES = ("fail", "unverified", "pass", "not_applicable")
MAX_NOTE_ROWS = 40
"""Rows in the note of a span, what fails first; those of more than a beat or two are counted, and stand among the requirements."""


def prompt_section(record: Mapping[str, Any], spec: WorldSpec, spans: Sequence[JudgedSpan], pictures: ReportPictures) -> str:
    """The prompt with its spans; in worlds of version 1 its text alone.

    Args:
        record: of the judgement.
        spec: what was judged.
        spans: of the record's prompt, with their rows.
        pictures: of the candidate.
    """
    told = record.get("prompt")
    if not isinstance(told, Mapping):
        whole = tag("blockquote", escaped(spec.prompt), dir="auto")
        return (
            whole
            + tag("p", "A world of version 1: no words of this prompt are marked, and nothing judges them.")
            + _given_up(record)
        )
    first = first_shown(spans)
    text = tag("blockquote", "".join(_span(k, s) for k, s in enumerate(spans)), dir="auto")
    beside = "".join(_picture(k, p, pictures, spans, first) for k, p in enumerate(pictures.shown))
    beside += "".join(_note(k, s, first) for k, s in enumerate(spans) if s.claim is not None)
    aside = tag(
        "aside",
        beside or tag("p", "No claim says what words of the prompt mean.", class_="dim"),
        aria_label="One span of the prompt",
    )
    return tag("div", tag("div", text + _legend(spans) + _facts(told, spans)) + aside, class_="read")


def _span(index: int, span: JudgedSpan) -> str:
    if span.claim is None:
        return tag("span", escaped(span.text), class_="filler")
    return tag(
        "mark",
        escaped(span.text),
        id=f"c{index}",
        class_=f"s-{span.state}" if span.waived else f"{_kind(span)} s-{span.state}",
        tabindex="0",
        title=span_words(span),
        aria_describedby=f"n{index}",
        data_sign=f"{'waived' if span.waived else span.type} {SPAN_SIGNS[span.state]}",
    )


def _kind(span: JudgedSpan) -> str:
    """Class of its type; the words of a stranger make none."""
    return f"t-{span.type}" if span.type.isascii() and span.type.isalpha() else "t-other"


def _note(index: int, span: JudgedSpan, first: int | None) -> str:
    state = tag("span", escaped(f"{SPAN_SIGNS[span.state]} {STATE_WORDS[span.state]}"), class_=span.state)
    head = tag("strong", tag("bdi", escaped(span.text))) + escaped(": " if span.waived else f": {span.type}, ") + state
    lines = [_row(r) for r in span.rows[:MAX_NOTE_ROWS]]
    left = len(span.rows) - len(lines)
    lines += [tag("li", escaped(f"and {left} more rows"), class_="dim")] if left > 0 else []
    said = tag("p", head) + (tag("p", escaped(span.waived)) if span.waived else "")
    said += tag("ul", "".join(lines)) if lines else ""
    said += tag("p", "judged by " + ", ".join(tag("code", escaped(p)) for p in span.by), class_="dim") if span.by else ""
    return tag("div", said, id=f"n{index}", class_="note first" if index == first else "note")


def _row(row: Mapping[str, Any]) -> str:
    status = str(row["status"])
    word = tag("strong", escaped(status.replace("_", " ")), class_=status if status in _STATUSES else "")
    numbers = row_numbers(row)
    return tag(
        "li",
        f"{word} {escaped(row['says'])}"
        + (tag("div", escaped(numbers), class_="n") if numbers else "")
        + tag("div", escaped(row["id"]), class_="id dim"),
    )


def _picture(
    number: int, picture: tuple[str, bytes], pictures: ReportPictures, spans: Sequence[JudgedSpan], first: int | None
) -> str:
    opened = first is not None and pictures.claims.get(spans[first].claim or "") == number
    caption, data = picture
    return tag("div", figure(data, caption, caption), id=f"p{number}", class_="shown first" if opened else "shown")


def span_styles(spans: Sequence[JudgedSpan], pictures: ReportPictures) -> str:
    """Rules that show the note and the picture of the span that is pointed at, else of the one that has the focus."""
    found = []
    for k, span in enumerate(spans):
        if span.claim is None:
            continue
        shown = [f"#n{k}"] + ([f"#p{pictures.claims[span.claim]}"] if span.claim in pictures.claims else [])
        at = (f".read:has(#c{k}:hover)", f".read:has(#c{k}:focus):not(:has(mark:hover))")
        found.append(",".join(f"{a} {s}" for a in at for s in shown) + "{display:block}")
    return "\n".join(found)


def _legend(spans: Sequence[JudgedSpan]) -> str:
    claimed = [s for s in spans if s.claim is not None]
    types = {s.type: s for s in claimed if not s.waived}
    lines = [tag("li", tag("mark", escaped(t), class_=_kind(s))) for t, s in types.items()]
    for state in STATE_WORDS:
        if any(s.state == state for s in spans if s.text.strip()):
            sample = (
                tag("span", escaped("words"), class_="filler") if state == "filler" else tag("mark", "words", class_=f"s-{state}")
            )
            lines.append(tag("li", f"{sample} {escaped(SPAN_SIGNS[state])} {escaped(STATE_WORDS[state])}"))
    return tag("ul", "".join(lines), class_="legend", aria_label="Legend")


def _facts(told: Mapping[str, Any], spans: Sequence[JudgedSpan]) -> str:
    shares = ", ".join(f"{float(told.get(k, 0)):.0%} {k}" for k in ("claimed", "filler", "waived"))
    found = tag(
        "p", escaped(f"Of the letters of the prompt: {shares}. Compared with what is to be seen by {reader_words(told)}.")
    )
    waived = [tag("li", tag("bdi", escaped(s.text)) + escaped(f": {s.waived}")) for s in spans if s.waived]
    warnings = [tag("li", escaped(w)) for w in told.get("warnings") or ()]
    lists = (("Waived", waived), ("Warnings", warnings))
    return found + "".join(tag("h3", title) + tag("ul", "".join(lines)) for title, lines in lists if lines)


# ---------------------------------------------------------------- version 1


def _given_up(record: Mapping[str, Any]) -> str:
    """Clauses that were said to be met by nothing, or to tell of no event, with the reasons."""
    told = {c["text"]: c.get("unmet") or c.get("static_because") for c in record["clauses"].values()}
    lines = [tag("li", tag("bdi", escaped(text)) + escaped(f": {why}")) for text, why in told.items() if why]
    return tag("h3", "Given up") + tag("ul", "".join(lines)) if lines else ""

"""Spans of the prompt with the rows that judge them: the same for report and page (R2, R155)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

from .prompts.descriptions import meanings
from .prompts.numbers import number_in, quantity_in
from .verdicts import asked_words

__all__ = [
    "CLAIM_CHECKS",
    "SPAN_SIGNS",
    "SPAN_STATES",
    "STATE_WORDS",
    "JudgedSpan",
    "SpanState",
    "first_shown",
    "judged_spans",
    "row_numbers",
    "row_words",
    "span_words",
]

SpanState = Literal["fail", "unverified", "pass", "reading", "waived", "filler"]
"""`reading`: printed as the agent's reading of these words, measured by no row."""
SPAN_STATES: tuple[SpanState, ...] = get_args(SpanState)
_WORST: tuple[SpanState, ...] = ("fail", "unverified", "pass")
_MEASURED = ("thing", "event", "order", "negation")
"""Types that need a row: without one they are unverified."""
_AUDIT = "audit:claims"
_KEPT = ("id", "status", "measured", "bound", "comparison", "unit")
_OF_A_BEAT = ("beat", "beat:driven", "beat:vacuous", "beat:branches", "shots:cover", "shots:visible", "shots:seen")
_OF_A_REQUIREMENT = ("requirement", "requirement:branches")
"""Questions that are asked of each beat, or requirement, by its id."""
_OF_AN_EFFECT = ("causal", "robustness")
"""Checks whose rows name a beat behind its cause, or behind what is varied."""
CLAIM_CHECKS = ("claim", "review", "beat", "causal", "robustness", "shots", "relations", "navigability", "audit")
"""Checks whose rows judge claims."""
SPAN_SIGNS: Mapping[SpanState, str] = {"fail": "✕", "unverified": "?", "pass": "✓", "reading": "○", "waived": "–", "filler": ""}
"""Signs beside the words: colour is never the only one."""
STATE_WORDS: Mapping[SpanState, str] = {
    "fail": "fails",
    "unverified": "unverified",
    "pass": "passes",
    "reading": "the agent's reading, measured by no row",
    "waived": "waived",
    "filler": "filler, not judged",
}


@dataclass(frozen=True)
class JudgedSpan:
    """A part of the prompt, what it is said to mean, and what became of it."""

    text: str
    state: SpanState
    claim: str | None = None
    """None for filler."""
    type: str = ""
    by: tuple[str, ...] = ()
    waived: str = ""
    """Why nothing judges it."""
    rows: tuple[Mapping[str, Any], ...] = ()
    """Rows that judge it: id, status, measured, bound, comparison, unit, and `says`, a sentence."""

    def named(self, group: str) -> tuple[str, ...]:
        """Ids below a group, as `/story/beats`, that it is judged by."""
        return _members(self.by, group)


def judged_spans(prompt: Mapping[str, Any], rows: Iterable[Mapping[str, Any]]) -> tuple[JudgedSpan, ...]:
    """All spans of a prompt in order, with their rows.

    Args:
        prompt: member `prompt` of an acceptance record, see `prompt_record`.
        rows: of the record or the matrix, as JSON.
    """
    judged = _Rows(rows, prompt.get("language"))
    return tuple(judged.span(span) for span in prompt.get("spans", ()))


class _Rows:
    """Rows by id, and what they say of claims."""

    def __init__(self, rows: Iterable[Mapping[str, Any]], language: str | None) -> None:
        self.language = language
        kept = [r for r in rows if r.get("check") in CLAIM_CHECKS]
        self.by_id = {str(r["id"]): r for r in kept}
        self.claims: dict[str, list[Mapping[str, Any]]] = {}
        self.effects: dict[str, list[Mapping[str, Any]]] = {}
        self.graph: dict[str, list[Mapping[str, Any]]] = {}
        for row in kept:
            subjects = [str(s) for s in row.get("subject") or ()]
            if row["check"] in ("claim", "review") and subjects:
                self.claims.setdefault(subjects[0], []).append(row)
            elif row["check"] in _OF_AN_EFFECT and len(subjects) > 1:
                self.effects.setdefault(subjects[1], []).append(row)
            elif row["check"] in ("relations", "navigability"):
                for name in subjects:
                    self.graph.setdefault(name, []).append(row)

    def span(self, span: Mapping[str, Any]) -> JudgedSpan:
        """A span of the record with its rows."""
        text, claim, kind = str(span["text"]), span.get("claim"), str(span.get("type", ""))
        if claim is None:
            return JudgedSpan(text, "filler")
        by = tuple(map(str, span.get("by") or ()))
        waived = str(span.get("waived") or "")
        found = () if waived else tuple(sorted(self._of_claim(str(claim), kind, text, by), key=_rank))
        state: SpanState = "waived" if waived else _state(kind, found)
        return JudgedSpan(text, state, str(claim), kind, by, waived, found)

    def _of_claim(self, claim: str, kind: str, text: str, by: Sequence[str]) -> list[Mapping[str, Any]]:
        found = [_told(r) for r in self.claims.get(claim, ())]
        beats = _members(by, "/story/beats")
        named = [f"{question}:{b}" for b in beats for question in _OF_A_BEAT]
        named += [f"{question}:{r}" for r in _members(by, "/story/requirements") for question in _OF_A_REQUIREMENT]
        found += [_told(self.by_id[i]) for i in named if i in self.by_id]
        found += [_told(row) for b in beats for row in self.effects.get(b, ())]
        places = (*_members(by, "/graph/relations"), *_members(by, "/graph/regions"))
        found += [_told(r) for name in places for r in self.graph.get(name, ())]
        return found + self._audited(claim, kind, text)

    def _audited(self, claim: str, kind: str, text: str) -> list[Mapping[str, Any]]:
        """Findings of the audit about a claim: its faults, or the comparison of its number or material with what it names."""
        row = self.by_id.get(_AUDIT)
        if row is None:
            return []
        faults = [str(p) for p in (row.get("evidence") or {}).get("problems", ())]
        own = [p.partition(": ")[2] for p in faults if p.startswith(f"/claims/{claim}/")]
        if own:
            return [{"id": _AUDIT, "status": "fail", "says": "; ".join(own)}]
        if not _compared(kind, text, self.language):
            return []
        # The row names some of its faults only: where it fails, silence about a claim proves nothing.
        status = row["status"] if row["status"] in ("pass", "unverified") else "unverified"
        return [{"id": _AUDIT, "status": status, "says": f"the audit compares {text!r} with what the claim names"}]


def _compared(kind: str, text: str, language: str | None) -> bool:
    """True if the audit understands the words of a claim of this type."""
    if kind == "count":
        return number_in(text) is not None
    if kind == "quantity":
        return quantity_in(text) is not None
    return kind == "property" and bool(meanings(text, language, "material"))


def _members(by: Iterable[str], group: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(p.removeprefix(f"{group}/").split("/")[0] for p in by if p.startswith(f"{group}/")))


def _told(row: Mapping[str, Any]) -> Mapping[str, Any]:
    evidence = row.get("evidence") or {}
    stale = evidence.get("stale")
    says = f"stale: {stale}" if stale else str(evidence.get("explanation") or row.get("predicate", ""))
    optional = {"mandatory": False} if row.get("mandatory") is False else {}
    return {**{k: row.get(k) for k in _KEPT if row.get(k) not in (None, "")}, **optional, "says": says}


def _rank(row: Mapping[str, Any]) -> int:
    """Place of a row among those of its claim: what fails or is not known stands first."""
    return _WORST.index(row["status"]) if row.get("status") in _WORST else len(_WORST)


def _state(kind: str, rows: Sequence[Mapping[str, Any]]) -> SpanState:
    words = {r.get("status") for r in rows if r.get("mandatory", True)}
    worst = next((s for s in _WORST if s in words), None)
    if worst is not None:
        return worst
    return "unverified" if kind in _MEASURED and not rows else "reading"


# ---------------------------------------------------------------- in words


def row_numbers(row: Mapping[str, Any]) -> str:
    """Measured value and bound of a row with their unit; empty where it measured nothing."""
    if not isinstance(row.get("measured"), int | float):
        return ""
    unit = "" if row.get("unit") in ("", "1", None) else f" {row['unit']}"
    bound = row.get("bound")
    asked = ""
    if isinstance(bound, int | float):
        asked = f", required {asked_words(str(row.get('comparison', '')), bound, str(row.get('unit') or ''))}"
    return f"measured {row['measured']:.6g}{unit}{asked}"


def row_words(row: Mapping[str, Any]) -> str:
    """A row of a span in one sentence."""
    numbers = row_numbers(row)
    return f"{str(row['status']).replace('_', ' ')}: {row['says']}" + (f" ({numbers})" if numbers else "")


def span_words(span: JudgedSpan) -> str:
    """All that is known of a span, for who points at it or hears it."""
    if span.claim is None:
        return STATE_WORDS["filler"]
    if span.waived:
        return f"waived: {span.waived}"
    told = (
        "; ".join(map(row_words, span.rows))
        if len(span.rows) > 1
        else "".join(row_words(r).partition(": ")[2] for r in span.rows)
    )
    return f"{span.type}, {STATE_WORDS[span.state]}" + (f". {told}" if told else "")


def first_shown(spans: Sequence[JudgedSpan]) -> int | None:
    """Index of the span to show before anybody chose one: the worst, an event before others; None without claims."""
    rank = {state: k for k, state in enumerate(SPAN_STATES)}
    claimed = [k for k, s in enumerate(spans) if s.claim is not None]
    return min(claimed, key=lambda k: (rank[spans[k].state], spans[k].type != "event", k), default=None)

"""Spans of a prompt get their state from rows alone: what no row measures is never a pass."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.dishonest.cases import without_marks
from worldagent.tests.worlds.audits.test_claims import world
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.claims import prompt_record, reading_of
from worldagent.worlds.judged_spans import JudgedSpan, first_shown, judged_spans, row_numbers, span_words
from worldagent.worlds.verdicts import asked_words, prompt_told


def record(**spans: dict[str, Any]) -> dict[str, Any]:
    return {"language": "en", "spans": [{"text": name, "claim": name, "by": [], **more} for name, more in spans.items()]}


def row(row_id: str, status: str, *subject: str, says: str = "so it came out", **more: Any) -> dict[str, Any]:
    return {
        "id": row_id,
        "check": row_id.split(":", 1)[0],
        "subject": subject,
        "status": status,
        "evidence": {"explanation": says},
        **more,
    }


def state(kind: str, *rows: dict[str, Any], by: str = "/story/beats/b") -> str:
    (span,) = judged_spans(record(it={"type": kind, "by": [by]}), rows)
    return span.state


@pytest.mark.parametrize("kind", ["thing", "event", "order", "negation"])
def test_a_claim_that_needs_a_row_is_unverified_without_one(kind: str) -> None:
    assert state(kind) == "unverified"


@pytest.mark.parametrize("kind", ["look", "place", "time", "weather", "route", "property"])
def test_what_no_row_measures_is_called_the_agents_reading(kind: str) -> None:
    assert state(kind, by="/look/sky") == "reading"


@pytest.mark.parametrize(("own", "beat", "whole"), [("pass", "pass", "pass"), ("pass", "fail", "fail"), ("pass", "unverified", "unverified"), ("fail", "unverified", "fail")])  # fmt: skip
def test_the_worst_row_decides(own: str, beat: str, whole: str) -> None:
    assert state("event", row("claim:event:it", own, "it"), row("beat:b", beat, "b")) == whole


def test_rows_of_other_claims_and_beats_do_not_count() -> None:
    assert state("event", row("claim:event:other", "pass", "other"), row("beat:c", "pass", "c")) == "unverified"


def test_a_row_that_found_nothing_of_its_kind_is_no_pass() -> None:
    assert state("thing", row("claim:thing:it", "not_applicable", "it"), by="/terrains/land") == "reading"


def test_a_row_that_is_stale_says_so() -> None:
    stale = row("claim:event:it", "unverified", "it") | {"evidence": {"stale": "the beat changed in revision 2", "was": "pass"}}
    (span,) = judged_spans(record(it={"type": "event"}), [stale])
    assert (span.state, span.rows[0]["says"]) == ("unverified", "stale: the beat changed in revision 2")


def test_a_negation_and_a_way_find_the_rows_of_what_they_name() -> None:
    assert state("negation", row("requirement:r", "pass", "r", check="beat"), by="/story/requirements/r") == "pass"
    assert state("route", row("navigability:path", "fail", "way"), by="/graph/relations/way") == "fail"


def test_the_audit_speaks_for_words_that_it_compares_and_for_faults_that_it_names() -> None:
    good = judged_spans(prompt_record(spec := world()), [r.model_dump(mode="json") for r in audit(spec).rows])
    assert {s.claim: s.state for s in good if s.claim in ("steel", "rolls")} == {"steel": "pass", "rolls": "unverified"}
    fault = {"problems": ["/claims/it/by: 'steel' asks for steel; what the claim names is not"]}
    faulty = {"id": "audit:claims", "check": "audit", "status": "fail", "evidence": fault}
    found = judged_spans(record(it={"type": "look"}, steel={"type": "property"}, blue={"type": "property"}), [faulty])
    assert [s.state for s in found] == ["fail", "unverified", "reading"]
    assert "asks for steel" in span_words(found[0])


def test_a_waiver_is_no_pass_whatever_rows_say() -> None:
    given = record(it={"type": "event", "waived": "told by no motion"})
    (span,) = judged_spans(given, [row("claim:event:it", "pass", "it")])
    assert (span.state, span.rows, span_words(span)) == ("waived", (), "waived: told by no motion")


def test_the_words_of_a_span_hold_measured_value_bound_unit_and_sentence() -> None:
    measured = row("beat:b", "pass", "b", says="it turns", measured=2.1, bound=0.5, comparison=">=", unit="rad")
    (span,) = judged_spans(record(it={"type": "event", "by": ["/story/beats/b"]}), [measured])
    assert span_words(span) == "event, passes. it turns (measured 2.1 rad, required >= 0.5 rad)"
    assert row_numbers({"measured": 3, "unit": "1"}) == "measured 3"
    assert row_numbers({"says": "nothing"}) == ""


def test_the_worst_span_is_shown_first_and_filler_never() -> None:
    spans = [JudgedSpan("a", "filler"), JudgedSpan("b", "pass", "b", "thing"), JudgedSpan("c", "pass", "c", "event")]
    assert first_shown(spans) == 2
    assert first_shown([*spans, JudgedSpan("d", "fail", "d", "thing")]) == 3
    assert first_shown(spans[:1]) is None


OF_A_BEAT = ("beat:driven:b", "beat:vacuous:b", "shots:visible:b", "shots:seen:b")


@pytest.mark.parametrize("row_id", OF_A_BEAT)
def test_every_row_about_the_beat_of_a_claim_counts(row_id: str) -> None:
    good = [row("claim:event:it", "pass", "it"), row("beat:b", "pass", "b")]
    assert state("event", *good, row(row_id, "fail", "b")) == "fail"
    assert state("event", *good, row(f"{row_id[:-1]}c", "fail", "c")) == "pass"


def test_causes_and_readers_of_a_claim_stand_in_its_note_and_what_fails_first() -> None:
    rows = [
        row("claim:event:it", "pass", "it", measured=0.0, bound=0.0, comparison="<="),
        row("beat:b", "pass", "b"),
        row("causal:a:b", "fail", "a", "b", measured=0.0, bound=1.0, comparison=">=", unit="links"),
        row("causal:b:c", "fail", "b", "c"),
        row("robustness:shaken:b", "pass", "shaken", "b"),
        row("review:it", "unverified", "it", mandatory=False),
        row("review:other", "fail", "other"),
    ]
    (span,) = judged_spans(record(it={"type": "event", "by": ["/story/beats/b"]}), rows)
    assert [r["id"] for r in span.rows] == ["causal:a:b", "review:it", "claim:event:it", "beat:b", "robustness:shaken:b"]
    assert "fail: so it came out (measured 0 links, required >= 1 links)" in span_words(span)
    kept = [r for r in rows if not r["id"].startswith("causal")]
    (read,) = judged_spans(record(it={"type": "event", "by": ["/story/beats/b"]}), kept)
    assert read.state == "pass", "a reader who sees nothing proves nothing"


def test_the_bound_of_a_band_is_said_to_be_one_of_its_ends() -> None:
    night = {"measured": 40.0, "bound": -6.0, "comparison": "in", "unit": "deg"}
    assert row_numbers(night) == "measured 40 deg, required a value of the band that ends at -6 deg"
    assert row_numbers({**night, "comparison": "<="}) == "measured 40 deg, required <= -6 deg"
    assert asked_words(">=", 0.5, "1") == ">= 0.5"


def test_readings_are_explained_where_they_stand() -> None:
    told = prompt_told({"prompt": {"readings": {"at first": ["/story/beats/a"]}}})["prompt"]
    assert told["readings"] == ["at first"]
    assert "no row measures" in told["readings_are"]
    assert "readings_are" not in prompt_told({"prompt": {"readings": {}}})["prompt"]


def test_a_text_that_is_too_short_to_tell_its_language_is_said_to_be_short() -> None:
    """`none with reviewed word lists` is of another language, or a mixed text."""
    lines = [
        reading_of(world(marked, prompt=without_marks(marked))).warnings
        for marked in (
            "[Ball](thing ball) [rolls](event roll)",
            "[Kula](thing ball) [toczy się](event roll) po podłodze i spada w końcu.",
        )
    ]
    assert "the language is unknown, since 2 words are too few to tell it" in lines[0][0]
    assert "the language is none with reviewed word lists" in lines[1][0]

"""The prompt on the report: every span with its meaning, its state in colour, line and words, its numbers and its picture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from worldagent.rendering import ReportPictures, matrix_page, report_pictures
from worldagent.tests.rendering.report.test_page import EVIL, Page, _record, candidate
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.plates import View

__all__ = ["candidate"]

Spans = list[dict[str, Any]]
CLAIMS: Spans = [
    {"text": "A "},
    {"text": "box", "claim": "box", "type": "thing", "by": ["/entities/a"]},
    {"text": " "},
    {"text": "rests", "claim": "rests", "type": "event", "by": ["/story/beats/rest"]},
    {"text": " "},
    {"text": "quietly", "claim": "quietly", "type": "look", "by": ["/look/sky"]},
    {"text": " "},
    {"text": "forever", "claim": "forever", "type": "time", "by": [], "waived": "no run lasts for ever"},
]


def record(spans: Spans = CLAIMS, **more: Any) -> dict[str, Any]:
    """A record of version 2."""
    prompt = {
        "spans": spans,
        "claimed": 0.62,
        "filler": 0.13,
        "waived": 0.25,
        "warnings": ["a noun was left out"],
        "read_by": "nobody",
    }
    row = {"id": "claim:event:rests", "check": "claim", "subject": ["rests"], "group": "temporal", "predicate": "p", "status": "fail", "mandatory": True,
           "measured": 1.0, "bound": 0.0, "comparison": "<=", "unit": "1", "evidence": {"explanation": "the wall rests as well"}}  # fmt: skip
    given = _record(prompt=prompt, clauses={})
    return {**given, "rows": [*given["rows"], row], **more}


def marks(page: Page) -> dict[str, Mapping[str, str | None]]:
    return {str(a["id"]): a for t, a in page.tags if t == "mark" and "id" in a}


def test_every_span_shows_its_meaning_its_state_and_its_row(candidate: Candidate) -> None:
    page = Page(matrix_page(record(), candidate.spec))
    found = marks(page)
    assert [a["class"] for a in found.values()] == ["t-thing s-unverified", "t-event s-fail", "t-look s-reading", "s-waived"]
    assert [a["data-sign"] for a in found.values()] == ["thing ?", "event ✕", "look ○", "waived –"]
    assert (
        found["c3"]["title"]
        == "event, fails. fail: the wall rests as well (measured 1, required <= 0); pass: speed <= 0.1 (measured 0.01 m/s, required <= 0.1 m/s)"
    )
    assert all(a["tabindex"] == "0" and a["aria-describedby"] == str(k).replace("c", "n") for k, a in found.items())
    notes = {a.get("id") for _, a in page.tags if str(a.get("class", "")).startswith("note")}
    assert notes == {"n1", "n3", "n5", "n7"}
    for words in (
        "62% claimed, 13% filler, 25% waived",
        "by nobody",
        "no run lasts for ever",
        "a noun was left out",
        "/story/beats/rest",
    ):
        assert words in page.words, words
    assert sum(a.get("class") == "filler" for t, a in page.tags if t == "span") == 5  # one is of the legend


def test_the_headline_says_who_read_the_prompt_and_version_1_that_nothing_judges_it(candidate: Candidate) -> None:
    told = record(verdict="accepted")
    assert "accepted, prompt read by nobody" in Page(matrix_page(told, candidate.spec)).words
    told["prompt"]["read_by"] = "person"
    words = Page(matrix_page(told, candidate.spec)).words
    assert "accepted, prompt" not in words
    assert "by a person" in words
    old = Page(matrix_page(_record(verdict="accepted"), candidate.spec))
    assert "physics accepted; prompt judged by clauses" in old.words
    assert "no words of this prompt are marked, and nothing judges them" in old.words
    assert "It rains" in old.words
    assert "mark" not in {t for t, _ in old.tags}


def test_the_worst_span_is_open_and_pointing_at_another_shows_that_one(candidate: Candidate) -> None:
    told = record()
    pictures = report_pictures(candidate, told["rows"], record=told)
    page = Page(text := matrix_page(told, candidate.spec, pictures=pictures))
    first = {a["id"] for _, a in page.tags if str(a.get("class", "")).endswith(" first")}
    assert first == {"n3", f"p{pictures.claims['rests']}"}
    assert ".read:has(#c1:hover) #n1" in text
    assert f".read:has(#c3:hover) #p{pictures.claims['rests']}" in text


def test_spans_get_the_picture_of_their_beat_as_it_comes_true(candidate: Candidate) -> None:
    told = record()
    found = report_pictures(candidate, told["rows"], record=told)
    assert found.shown[found.claims["rests"]][0] == "frame 4 (0.17 s), a marked"
    assert found.claims["box"] == found.claims["rests"]
    assert found.shown[found.claims["quietly"]][0] == "frame 0 (0.00 s)"
    late = report_pictures(candidate, told["rows"], record={**told, "events": None})
    assert late.shown[late.claims["rests"]][0] == "frame 8 (0.33 s), a marked"


def test_what_claims_quote_stays_text(candidate: Candidate) -> None:
    spans: Spans = [
        {"text": EVIL, "claim": EVIL, "type": "thing", "by": [EVIL]},
        {"text": EVIL, "claim": "x", "type": EVIL, "by": [], "waived": EVIL},
        {"text": EVIL},
    ]
    told = record(spans)
    told["prompt"] |= {"warnings": [EVIL], "read_by": EVIL}
    text = matrix_page(told, candidate.spec, pictures=ReportPictures(shown=[(EVIL, b"\xff\xd8")], claims={EVIL: 0}))
    page = Page(text)
    assert not {t for t, _ in page.tags} & {"script", "a", "iframe"}
    assert not [k for _, a in page.tags for k in a if k.startswith("on")]
    assert "\u202e" not in text
    assert "<" not in text.partition("<style>")[2].partition("</style>")[0]
    assert [a["class"] for a in marks(page).values()] == ["t-thing s-unverified", "s-waived"]


def test_a_prompt_of_twenty_thousand_characters_is_whole(candidate: Candidate) -> None:
    spans: Spans = [
        {"text": f"ball {k} ", "claim": f"c{k}", "type": "thing", "by": ["/entities/a"]}
        if k % 2
        else {"text": "and also the wide world around it "}
        for k in range(900)
    ]
    told = record(spans)
    text = matrix_page(told, candidate.spec)
    page = Page(text)
    assert len("".join(s["text"] for s in spans)) > 19_000
    assert len(marks(page)) == 450
    assert len(text) < 1_000_000


@pytest.mark.parametrize("text", ["كرة تسقط من الطاولة", "כדור נופל מהשולחן", "鋼球が棚から落ちる"])
def test_the_direction_of_the_writing_is_the_prompts(candidate: Candidate, text: str) -> None:
    page = Page(matrix_page(record([{"text": text, "claim": "it", "type": "thing", "by": ["/entities/a"]}]), candidate.spec))
    assert text in page.words
    assert next(a["dir"] for t, a in page.tags if t == "blockquote") == "auto"
    assert "bdi" in {t for t, _ in page.tags}


def test_a_plate_is_the_picture_of_its_body_where_there_is_one(candidate: Candidate, monkeypatch: pytest.MonkeyPatch) -> None:
    plates = {View("a", "only", k): np.full((9, 16, 3), 200, np.uint8) for k in (2, 5)}
    monkeypatch.setattr("worldagent.rendering.report.pictures.plate_pictures", lambda candidate: plates)
    told = record()
    found = report_pictures(candidate, told["rows"], record=told)
    assert found.shown[found.claims["rests"]][0] == "frame 5 (0.21 s), a in the light of the film"
    assert found.claims["box"] == found.claims["rests"]
    assert found.shown[found.claims["quietly"]][0] == "frame 0 (0.00 s)"


def test_the_note_of_a_span_has_every_row_of_its_claim_with_measured_value_and_bound(candidate: Candidate) -> None:
    told = record()
    more = [
        {**told["rows"][-1], "id": f"causal:c{k}:rest", "check": "causal", "subject": [f"c{k}", "rest"], "measured": k + 0.5}
        for k in range(12)
    ]
    text = matrix_page({**told, "rows": [*told["rows"], *more]}, candidate.spec)
    note = text.partition('id="n3"')[2].partition('<div id="n')[0]
    assert [f"measured {k + 0.5:g}, required &lt;= 0" in note for k in range(12)] == [True] * 12
    assert "more rows" not in note

"""The matrix report: complete, self-contained, and harmless whatever the agent wrote."""

from __future__ import annotations

import base64
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.rendering import PreviewRenderer, ReportPictures, highlight, matrix_page, report_pictures
from worldagent.testing.worlds.small_worlds import box, ground, make_candidate, world
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Correction, Row
from worldagent.worlds.spec import Beat, WorldSpec

VOID = {"meta", "img", "br"}
EVIL = "<script>alert(1)</script><img src=x onerror=alert(2)>\"' onmouseover=alert(3) \u202egnp.exe\u200b"


class Page(HTMLParser):
    """Elements, attributes and text of a page; fails on tags that do not nest."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] != "style":
            self.text.append(data)

    @property
    def words(self) -> str:
        return " ".join(self.text)


@pytest.fixture
def candidate(tmp_path: Path) -> Candidate:
    spec = world(
        {"ground": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="dynamic"), "wall": box(0.1, 1, 1, at=(0, -0.3, 0.5))},
        beats={"rest": Beat.model_validate({
            "text": "it rests", "owner": "rigid", "subject": "a", "frames": [2, 8], "causes": [],
            "predicate": {"kind": "speed", "entity": "a", "max": 0.1},
        })},
    )  # fmt: skip
    return make_candidate(tmp_path, spec, tracks={}, records={"kinetic_energy": 0.5, "potential_energy": 1.0})


def _rows() -> list[dict[str, Any]]:
    correction = Correction(cause="it sank", edit_class="scene", group="pose", action="raise it by 0.02 m")
    rows = [
        Row(
            id="contact:a:ground", check="contact", group="physical", predicate="surfaces stay apart", status="fail", artifact="x",
            measured=-0.0213, bound=0.0, comparison=">=", unit="m", entities=("a", "ground"), first_failing_entity="a",
            first_failing_frame=5, frames=(0, 9), corrections=(correction,), evidence={"explanation": "21 mm deep", "points": 2},
        ),
        Row(id="beat:rest", check="beat", group="temporal", predicate="speed <= 0.1", status="pass", artifact="x", measured=0.01, bound=0.1, comparison="<=", unit="m/s"),
        Row(id="scale:a", check="scale", group="spatial", predicate="size", status="unverified", mandatory=False),
    ]  # fmt: skip
    return [r.model_dump(mode="json") for r in rows]


def _record(**more: Any) -> dict[str, Any]:
    return {
        "verdict": "incomplete",
        "freeze": "f" * 64,
        "spec_digest": "5" * 64,
        "prompt_digest": "9" * 64,
        "cache_digest": "c" * 64,
        "rows": _rows(),
        "clauses": {"c1": {"text": "A box rests", "unmet": None}, "c2": {"text": "It rains", "unmet": "no water here"}},
        "approximations": [{"what": "collision skin", "effect": "hovers 1 mm"}],
        "weakenings": [
            {"revision": 3, "weakenings": ["/simulation/frames 48 -> 24"], "reason": "the prompt asks for one second"}
        ],
        "versions": {"mujoco": "4.0.0"},
        "environment": {"device": "linux-x86_64", "python": "CPython 3.11"},
        "events": {"beats": {"rest": 4}, "contacts": []},
        "seed": 7,
        **more,
    }


def test_everything_a_reader_needs_is_on_the_page(candidate: Candidate) -> None:
    record = _record()
    pictures = report_pictures(candidate, record["rows"])
    text = matrix_page(record, candidate.spec, pictures=pictures, problems=["a problem told"])
    words = Page(text).words
    for part in (
        "incomplete", "3 requirements", "1 fail", "1 unverified", "1 pass", "1 mandatory ones open", "a problem told",
        candidate.spec.prompt.split()[0], "It rains : no water here", "contact:a:ground", "-0.0213 m, required >= 0 m",
        "a frame 5", "0 to 9", "21 mm deep", "raise it by 0.02 m", "collision skin", "/simulation/frames 48 -> 24",
        "the prompt asks for one second", "mujoco", "linux-x86_64", "worldagent verify", "true at 4", "optional",
    ):  # fmt: skip
        assert part in words, part
    assert words.index("incomplete") < words.index("It rains") < words.index("contact:a:ground") < words.index("mujoco")


def test_the_page_is_whole_and_calls_nothing(candidate: Candidate) -> None:
    record = _record()
    text = matrix_page(record, candidate.spec, pictures=report_pictures(candidate, record["rows"]))
    page = Page(text)
    assert {t for t, _ in page.tags} & {"script", "link", "iframe", "object", "embed", "form", "a", "base"} == set()
    assert "http" not in re.sub(r'http-equiv|src="data:[^"]*"', "", text)
    policy = next(a["content"] for t, a in page.tags if a.get("http-equiv") == "Content-Security-Policy")
    assert policy is not None
    assert policy.startswith("default-src 'none'")
    pictures = [a for t, a in page.tags if t == "img"]
    assert len(pictures) == 3
    for picture in pictures:
        assert picture["alt"]
        kind, data = re.fullmatch(r"data:image/(png|jpeg);base64,(.*)", str(picture["src"])).groups()  # type: ignore[union-attr]
        assert base64.b64decode(data).startswith(b"\x89PNG" if kind == "png" else b"\xff\xd8")
    assert len(text) < 2_000_000
    assert all(f"prefers-color-scheme:{m}" in text or m == "light" for m in ("dark", "light"))
    assert "@media print" in text


def test_what_an_agent_wrote_stays_text(candidate: Candidate) -> None:
    spec: WorldSpec = candidate.spec.model_copy(update={"title": EVIL, "prompt": EVIL})
    row = {
        **_rows()[0],
        "id": EVIL,
        "predicate": EVIL,
        "first_failing_entity": EVIL,
        "unit": EVIL,
        "evidence": {EVIL: [EVIL], "explanation": EVIL},
    }
    row["corrections"] = [{"cause": EVIL, "action": EVIL, "group": EVIL}]
    record = _record(
        rows=[row],
        clauses={EVIL: {"text": EVIL, "unmet": EVIL, "static_because": EVIL}},
        approximations=[{"what": EVIL, "effect": EVIL}],
        weakenings=[{"revision": EVIL, "weakenings": [EVIL], "reason": EVIL}],
        versions={EVIL: EVIL},
        environment={},
        reason=EVIL,
        verdict=EVIL,
    )
    pictures = ReportPictures(rows={EVIL: (EVIL, b"\xff\xd8")})
    text = matrix_page(record, spec, pictures=pictures, problems=[EVIL])
    page = Page(text)
    assert {t for t, _ in page.tags} <= {
        "html", "head", "meta", "title", "style", "body", "header", "main", "section", "h1", "h2", "h3", "p", "span", "div", "ul", "ol",
        "li", "table", "thead", "tbody", "tr", "th", "td", "strong", "code", "details", "summary", "pre", "figure", "figcaption", "img",
        "blockquote", "i", "mark", "aside", "bdi",
    }  # fmt: skip
    assert not [k for _, a in page.tags for k in a if k.startswith("on")]
    assert [a["src"] for t, a in page.tags if t == "img"] == ["data:image/jpeg;base64,/9g="]
    assert "\u202e" not in text
    assert "\u200b" not in text
    assert "\\u202e" in text


def test_a_world_of_many_rows_is_cut_and_says_so(candidate: Candidate) -> None:
    passing = _rows()[1]
    rows = [{**passing, "id": f"beat:{k}"} for k in range(2000)] + _rows()
    text = matrix_page(_record(rows=rows), candidate.spec)
    assert "501 further rows, none worse" in text
    assert text.index("contact:a:ground") > 0


def test_a_page_about_nothing_simulated_has_no_pictures(candidate: Candidate) -> None:
    text = matrix_page(_record(events=None, approximations=[], weakenings=[], seed=None), candidate.spec)
    assert "<img" not in text
    assert "None: no edit made the specification easier" in text


# ---------------------------------------------------------------- pictures


def test_a_hidden_entity_is_shown_through_what_hides_it(candidate: Candidate) -> None:
    renderer = PreviewRenderer(candidate)
    plain = highlight(candidate, 5, [], renderer=renderer)
    marked = highlight(candidate, 5, ["a"], renderer=renderer)
    assert plain.shape == marked.shape == (315, 560, 3)
    red = (marked[..., 0] > 180) & (marked[..., 1] < 100)
    assert red.sum() > 100
    assert not ((plain[..., 0] > 180) & (plain[..., 1] < 100)).any()
    assert np.array_equal(highlight(candidate, 5, ["ghost"], renderer=renderer), plain)


def test_failing_rows_are_drawn_first_and_not_too_many(candidate: Candidate) -> None:
    failing = _rows()[0]
    rows = [{**failing, "id": f"contact:{k}", "status": "unverified"} for k in range(20)] + [failing]
    found = report_pictures(candidate, rows).rows
    assert "contact:a:ground" in found
    assert len(found) == 8
    assert found["contact:a:ground"][0] == "a, ground at frame 5 (0.21 s)"

"""Texts of strangers: nothing hidden, nothing that acts, nothing endless, and nothing lost that could be seen."""

from __future__ import annotations

import json
import unicodedata
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from worldagent.worlds.quoting import SHOWN_CHARACTERS, json_visible, markdown_inline, quoted, shown, visible

INVISIBLE = ("Cc", "Cf", "Cs", "Co", "Zl", "Zp")
JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)

QUIET = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
"""A busy machine is no finding."""


def hidden(text: str) -> list[str]:
    """By Unicode's own categories, which the code under test does not use."""
    return [c for c in text if unicodedata.category(c) in INVISIBLE and c not in "\t\n"]


# Format characters that show a mark of their own: Arabic and Kaithi number signs, hieroglyph joiners.
MARKED = {c for c in map(chr, range(0x110000)) if unicodedata.category(c) == "Cf"} - set(
    "\u00ad\u061c\u070f\u180e\u200b\u200c\u200d\u200e\u200f\ufeff\ufff9\ufffa\ufffb"
)
MARKED = {c for c in MARKED if not ("\u202a" <= c <= "\u206f" or c >= "\U0001bca0")}


@QUIET
@given(st.text())
def test_nothing_stays_hidden(text: str) -> None:
    assert [c for c in hidden(visible(text)) if c not in MARKED] == []
    assert [c for c in hidden(quoted(text)) if c not in MARKED] == []
    assert [c for c in hidden(markdown_inline(text)) if c not in MARKED] == []


@pytest.mark.parametrize(
    "code", [0, 7, 0x1B, 0x85, 0x9B, 0x202E, 0x2066, 0x200B, 0xFEFF, 0xE0041, 0xE0100, 0xFE01, 0x3164, 0xD800]
)
def test_every_known_trick_is_spelled_out(code: int) -> None:
    for made in (visible(chr(code)), quoted(chr(code)), markdown_inline(chr(code)), shown({chr(code): [chr(code)]})):
        assert chr(code) not in json.dumps(made, ensure_ascii=False)
        assert f"{code:x}" in json.dumps(made).lower()


@QUIET
@given(
    st.text(
        st.characters(
            categories=("L", "N", "P", "S", "Zs"), exclude_characters="\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0\ufffc\ufffd"
        )
    )
)
def test_what_can_be_seen_stays_as_it_is(text: str) -> None:
    assert visible(text) == text


@QUIET
@given(st.text())
def test_spelling_out_twice_changes_nothing(text: str) -> None:
    assert visible(visible(text)) == visible(text)


@QUIET
@given(st.text(max_size=400))
def test_a_quoted_text_is_one_line_that_ends_where_it_seems_to(text: str) -> None:
    made = quoted(text, most=100)
    assert "\n" not in made
    assert len(made) <= 100 * 10 + 40
    inner = made[1 : made.rindex("'")].replace("\\\\", "").replace("\\'", "")
    assert made.startswith("'")
    assert "'" not in inner


@QUIET
@given(st.text(max_size=400))
def test_markdown_from_a_stranger_has_no_structure(text: str) -> None:
    made = markdown_inline(text)
    assert "\n" not in made
    bare = made.replace("\\\\", "")
    for mark in "`*_[]<>#|":
        assert mark not in bare.replace(f"\\{mark}", "")


@QUIET
@given(JSON_VALUES)
def test_json_keeps_its_meaning_and_hides_nothing(value: Any) -> None:
    document = json.dumps(value, ensure_ascii=False)
    made = json_visible(document)
    assert json.loads(made) == value
    assert [c for c in hidden(made) if c not in MARKED] == []


def test_very_long_texts_are_cut_and_say_so() -> None:
    made = shown({"a": ["x" * (SHOWN_CHARACTERS + 5)], "n": 3, "t": (1.5, None, True)})
    assert made["a"][0].endswith(" ... (5 more characters)")
    assert (made["n"], made["t"]) == (3, [1.5, None, True])
    assert quoted("y" * 200).endswith(" ... (80 more characters)")

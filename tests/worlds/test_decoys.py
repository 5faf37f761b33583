"""Who is touched, or never is, is the body behind the verb, and no body that no claim speaks of stands in for it (R2, R156)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import small_spec
from worldagent.tests.worlds.audits.test_bindings import BALL, BLOCK, FALLS, ROLLS, said, told
from worldagent.worlds.claims import reading_of

BEHIND, FORM = "and what stands behind it is b3", "has its form and no claim speaks of it"
OTHER = "[tower](thing b2)"


def never(a: str, b: str) -> tuple[str, Any]:
    return "/story/requirements", {"no": {"text": "they touch", "predicate": {"kind": "contact", "a": a, "b": b}, "never": True}}


TOUCHES = {
    "never touches": f"A {BALL} {ROLLS} past a {OTHER}. It [never touches](negation no) the {BLOCK}.",
    "does not touch": f"A {OTHER} stands there. A {BALL} [does not touch](negation no) a {BLOCK}.",
    "is never touched by": f"A {OTHER} stands there. A {BALL} [is never touched](negation no) by a {BLOCK}.",
    "never bumps into": f"A {OTHER} stands there. A {BALL} [never bumps into](negation no) the {BLOCK}.",
}


@pytest.mark.parametrize("name", TOUCHES)
def test_a_touch_that_is_denied_is_of_the_body_behind_the_verb(name: str) -> None:
    assert BEHIND in said(TOUCHES[name], never("ball", "b2"))
    for pair in (("ball", "b3"), ("b3", "ball")):
        assert BEHIND not in said(TOUCHES[name], never(*pair))


def test_where_words_of_another_kind_stand_between_the_verdict_warns() -> None:
    marked = f"A {OTHER} stands there. A {BALL} [never comes](negation no) near the {BLOCK}."
    assert BEHIND not in said(marked, never("ball", "b2"))
    assert BEHIND in "".join(reading_of(told(marked, never("ball", "b2"))).warnings)
    assert BEHIND not in "".join(reading_of(told(marked, never("ball", "b3"))).warnings)


def form_lines(marked: str, requirement: tuple[str, Any], *, size: tuple[float, float, float] | None = None) -> str:
    crate: dict[str, Any] = small_spec()["entities"]["b1"] | {"pose": {"position": [2.0, 0, 0.1]}}
    if size is not None:
        crate |= {"dimensions": {"size": list(size)}, "parts": {"body": {"shape": {"kind": "box", "size": list(size)}}}}
    return "".join(w for w in reading_of(told(marked, ("/entities/crate", crate), requirement)).warnings if FORM in w)


def test_a_body_without_a_claim_that_has_the_form_of_one_that_is_spared_is_named() -> None:
    blocks = "[three](count b1 b2 b3) [blocks](thing b1 b2 b3)"
    marked = f"A {BALL} {ROLLS} past {blocks}. It [never touches](negation no) the last [block](thing b3 same_as=blocks)."
    assert "'never touches' is denied of 'b3', and crate " in form_lines(marked, never("ball", "b3"))
    assert form_lines(marked, never("ball", "b3"), size=(0.3, 0.2, 0.1)) == ""
    claimed = marked.replace("past", "past a [crate](thing crate) and")
    assert form_lines(claimed, never("ball", "b3")) == ""
    assert (
        form_lines(f"A {BALL} {ROLLS} into {blocks}, and a [block](thing b3 same_as=blocks) {FALLS}.", never("ball", "b3")) == ""
    )

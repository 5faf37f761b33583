"""A person reads a world in a browser: the prompt is hidden until it was chosen; answers reach the ledger."""

from __future__ import annotations

import pytest
from worldagent.tests.page.browser import Tab, needs_axe
from worldagent.tests.page.conftest import Made
from worldagent.tests.page.questioned import questioned
from worldagent.tests.server.fakes import PIXEL
from worldagent.tests.stories.small_run import PROMPT
from worldagent.worlds.reviews import Review


@pytest.fixture(autouse=True)
def without_job(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.server.page.reviews.rows_anew", lambda session, jobs: "job")


def opened(tab: Tab) -> None:
    tab.page.goto(f"{tab.url}/static/review.html#w")
    tab.page.get_by_role("heading", level=1, name="Review of a world").wait_for()


def test_a_person_chooses_the_prompt_then_answers_every_part(made: Made, tab: Tab) -> None:
    session = questioned(made, PIXEL)
    opened(tab)
    assert "5 things, 36 frames" in tab.page.content()
    assert tab.page.get_by_text("The last block falls off the shelf", exact=False).count() == 1, "in the list of prompts alone"
    tab.wait("document.images.length === 1 && document.images[0].naturalWidth === 1")
    tab.page.get_by_label(PROMPT).check()
    tab.page.get_by_role("button", name="Go on").click()
    parts = tab.page.get_by_role("group")
    parts.first.wait_for()
    assert parts.count() == 2
    parts.nth(0).get_by_label("shown", exact=True).check()
    parts.nth(1).get_by_label("contradicted").check()
    parts.nth(1).get_by_label("why").fill("<b>it stays</b>")
    tab.page.get_by_label("Your name").fill("Ann")
    tab.page.get_by_role("button", name="Record the answers").click()
    tab.page.get_by_role("heading", level=1, name="Recorded").wait_for()
    (review,) = session.ledger.reviews()
    assert (review.reader, review.name, review.choice) == ("person", "Ann", review.right)
    assert review.answers == {"c1": "shown", "c2": "contradicted"}
    assert review.because == {"c2": "<b>it stays</b>"}


def test_words_of_others_stand_there_as_text(made: Made, tab: Tab) -> None:
    session = questioned(made, PIXEL)
    digest = session.folder.read_json(session.folder.root / "reviews" / "current.json")["digest"]
    session.ledger.add_review(
        Review(digest, "model", "<img src=x>", {"c1": "shown"}, because={"c1": "<script>alert(1)</script>"})
    )
    opened(tab)
    tab.page.get_by_label("none of these").check()
    tab.page.get_by_role("button", name="Go on").click()
    tab.page.get_by_text("model <img src=x>: shown, <script>alert(1)</script>").wait_for()
    assert tab.page.locator("#main script").count() == 0


@needs_axe
def test_both_steps_are_accessible(made: Made, tab: Tab) -> None:
    questioned(made, PIXEL)
    opened(tab)
    assert tab.audit() == []
    tab.page.get_by_label(PROMPT).check()
    tab.page.get_by_role("button", name="Go on").click()
    tab.page.get_by_role("button", name="Record the answers").wait_for()
    assert tab.audit() == []


def test_where_nothing_is_asked_the_page_says_which_call_asks(made: Made, tab: Tab) -> None:
    made.world("w")
    tab.page.goto(f"{tab.url}/static/review.html#w")
    alert = tab.page.get_by_role("alert")
    alert.wait_for()
    assert "run_checks(scope='review')" in alert.inner_text()
    tab.troubles.clear()  # the browser reports the 409

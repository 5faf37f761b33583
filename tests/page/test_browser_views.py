"""Every view of the page in a real browser: what it shows, and that everybody can use it."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.page.browser import Served, Tab, needs_axe
from worldagent.tests.page.conftest import Made, row
from worldagent.tests.page.rich import pictured, rich_world
from worldagent.worlds.folder import WorldFolder

VIEWS = {
    "": "1 world",
    "#/jobs": "Ended",
    "#/w/w": "Acceptance",
    "#/w/w/requirements": "Requirements",
    "#/w/w/pictures": "3 pictures",
    "#/w/w/ledger": "Ledger",
    "#/w/w/revisions": "2 revisions",
    "#/w/none": "Not found",
}
"""Views by what follows the address, with a heading that each has alone."""
SIZES = ((320, 640), (768, 1024), (1280, 800), (3840, 2160))


@pytest.fixture
def rich(made: Made) -> WorldFolder:
    folder = rich_world(made)
    made.job("w")
    made.advance(3)
    return folder


def settled(tab: Tab, view: str) -> Any:
    """A view with all that it shows."""
    page = tab.go(view)
    page.get_by_role("heading", name=VIEWS[view], exact=True).wait_for()
    return page


@needs_axe
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_view_has_an_accessibility_violation(rich: WorldFolder, served: Served, browser: Any, scheme: str) -> None:
    tab = Tab(browser, served.url, scheme=scheme)
    found = {}
    for view in VIEWS:
        page = settled(tab, view)
        for details in page.locator("details").all()[:3]:
            details.locator("summary").click()
        found[view] = tab.audit()
    tab.close()
    assert found == {view: [] for view in VIEWS}


@needs_axe
def test_an_empty_workspace_says_how_to_connect(tab: Tab) -> None:
    page = tab.go("", "Worlds")
    page.get_by_role("heading", name="No world yet").wait_for()
    assert f"claude mcp add --transport http worldagent {tab.url}/mcp" in page.inner_text("main")
    assert tab.audit() == []


@pytest.mark.parametrize("size", SIZES, ids=lambda s: f"{s[0]}x{s[1]}")
def test_no_view_scrolls_sideways(rich: WorldFolder, served: Served, browser: Any, size: tuple[int, int]) -> None:
    tab = Tab(browser, served.url, size=size)
    for view in VIEWS:
        settled(tab, view)
        assert tab.page.evaluate("document.documentElement.scrollWidth") <= size[0], view
    tab.close()


def test_a_stale_verdict_is_never_shown_as_one_that_holds(rich: WorldFolder, tab: Tab) -> None:
    page = tab.go("", "Worlds")
    verdict = page.locator(".worlds .verdict")
    assert "stale – accepted, prompt read by nobody at revision 1, the specification was changed since" in verdict.inner_text()
    assert page.locator(".stages .is-stale .name").all_inner_texts() == ["accepted", "rendered"]
    page = tab.go("#/w/w", "Three blocks")
    text = page.get_by_role("region", name="Acceptance").inner_text()
    assert "stale – accepted, prompt read by nobody at revision 1" in text
    assert "67 % were claimed, 33 % were filler" in text
    assert "skin of 0.5 mm" in text


def test_requirements_can_be_filtered_searched_and_gone_back_from(rich: WorldFolder, tab: Tab) -> None:
    page = tab.go("#/w/w/requirements", "Three blocks")
    page.get_by_role("link", name="fail 2").click()
    tab.wait("document.querySelectorAll('.matrix tr:not(.group) td.c-status').length === 2")
    assert page.locator(".matrix .group").all_inner_texts() == ["spatial", "temporal"]
    assert page.locator(".matrix .c-measured").first.inner_text() == "−0.0021 m"
    assert page.locator(".matrix .c-bound").first.inner_text() == "≥ 0 m"
    assert page.locator(".matrix .c-first").first.inner_text() == "b1, frame 12"
    page.get_by_label("Find").fill("beat:fall")
    tab.wait("document.querySelectorAll('.matrix td.c-status').length === 1")
    assert page.evaluate("document.activeElement.name") == "q"
    page.get_by_label("Find").fill("")
    page.get_by_role("link", name="stale 1").click()
    tab.wait("document.querySelector('.matrix td.c-status')?.innerText.includes('stale')")
    assert "the pose of b1 changed in revision 2; it was pass" in page.inner_text(".matrix")
    page.go_back()
    tab.wait("document.querySelector('.matrix td.c-status')?.innerText.includes('fail')")


def test_a_row_opens_by_keyboard_and_shows_evidence_corrections_and_past(rich: WorldFolder, tab: Tab) -> None:
    page = tab.go("#/w/w/requirements?q=gap:ball", "Three blocks")
    page.locator(".matrix summary").focus()
    page.keyboard.press("Enter")
    page.get_by_text("why gap:ball:shelf came out so").wait_for()
    text = page.inner_text(".evidence")
    assert "raise gap:ball:shelf by 2 mm" in text
    assert "revision 1, full" in text
    assert "candidates/x/bake" in text


def test_words_of_a_world_are_text_and_never_act(made: Made, tab: Tab) -> None:
    evil = "<img src=x onerror=alert(1)><script>alert(2)</script>"
    folder = rich_world(made, title=evil)
    made.rows("w", row("gap:x", "fail", predicate=f"\u202e{evil}", first_failing_entity=evil, evidence={"explanation": evil}))
    (folder.pictures / "bake_abababab.jpg").rename(folder.pictures / "<svg onload=alert(3)>.jpg")
    made.job("w", kind="bake")
    for view in list(VIEWS)[:-1]:
        page = settled(tab, view)
        for summary in page.locator("summary").all()[:4]:
            summary.click()
        assert page.locator("main script, main img[src=x], main svg[onload]").count() == 0
    page = tab.go("#/w/w/requirements?q=gap:x")
    page.locator(".matrix summary").click()
    page.locator(".evidence").get_by_text(evil).wait_for()
    assert f"\\u202e{evil}" in page.inner_text(".matrix .said")
    assert page.inner_text("h1") == evil


def test_the_page_is_walked_by_keyboard_alone(rich: WorldFolder, tab: Tab) -> None:
    page = tab.go("", "Worlds")

    def focused() -> str:
        return str(page.evaluate("document.activeElement.innerText"))

    page.keyboard.press("Tab")
    assert focused() == "Skip to content"
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "main"
    for _ in range(12):
        page.keyboard.press("Tab")
        if focused() == "Three blocks":
            break
    assert focused() == "Three blocks"
    page.keyboard.press("Enter")
    page.get_by_role("navigation", name="Views of this world").wait_for()
    tab.wait("document.activeElement.tagName === 'H1'")
    assert page.title() == "Three blocks – worldagent"
    page.keyboard.press("Tab")
    assert focused() == "Overview"


def test_pictures_have_words_and_the_film_plays_by_ranges(rich: WorldFolder, tab: Tab) -> None:
    page = tab.go("#/w/w/pictures", "Three blocks")
    tab.wait("[...document.images].length === 3 && [...document.images].every(i => i.complete && i.naturalWidth > 0)")
    alts = {i.get_attribute("alt") for i in page.locator("main img").all()}
    assert "Preview, frame 1, view only, revision 1" in alts
    assert page.evaluate("document.images[0].naturalWidth") <= 360
    assert "of an earlier revision" in page.inner_text(".pictures")
    with page.expect_response(lambda r: r.url.split("?")[0].endswith("/film")) as response:
        tab.go("#/w/w", "Three blocks")
    assert response.value.status == 206
    tab.wait("document.querySelector('video').readyState >= 1")
    assert round(page.evaluate("document.querySelector('video').duration"), 1) == 0.3


def test_the_ledger_is_drawn_described_and_given_in_numbers(rich: WorldFolder, tab: Tab) -> None:
    page = tab.go("#/w/w/ledger", "Three blocks")
    chart = page.get_by_role("img", name="Energy [J] over time")
    chart.wait_for()
    assert "kinetic_energy: 0 at first, 1.1 at last, largest 1.1" in str(chart.get_attribute("aria-label"))
    assert chart.locator("path.line").count() == 3
    page.get_by_text("numbers").first.click()
    assert page.get_by_role("rowheader", name="11").first.is_visible()


def test_revisions_tell_hypotheses_and_patches(rich: WorldFolder, tab: Tab) -> None:
    page = tab.go("#/w/w/revisions", "Three blocks")
    newest = page.locator(".revisions > li").first
    newest.wait_for()
    assert "Revision 2" in newest.inner_text()
    assert "the camera stood too far away" in newest.inner_text()
    newest.locator("summary").click()
    assert "/shots/only/intent" in newest.locator("pre").inner_text()


def test_a_large_world_is_shown_in_pages(made: Made, tab: Tab) -> None:
    folder = made.world("w")
    pictured(folder, 300)
    made.rows("w", *(row(f"s:{k:04d}") for k in range(2000)))
    asked: list[str] = []
    tab.page.on("request", lambda r: asked.append(r.url) if "thumbnail" in r.url else None)
    page = tab.go("#/w/w/pictures", "Three blocks")
    tab.wait("document.querySelectorAll('.pictures li').length === 24")
    assert len(asked) <= 24
    page.get_by_role("link", name="Next").click()
    page.get_by_text("25–48 of 301").wait_for()
    page = tab.go("#/w/w/requirements?q=s:", "Three blocks")
    page.get_by_text("1–100 of 2000").wait_for()
    page.get_by_role("link", name="Next").click()
    page.get_by_text("101–200 of 2000").wait_for()
    assert page.locator(".matrix td.c-status").count() == 100

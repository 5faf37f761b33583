"""The page of a server that wants a token, and what a reader may not do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from worldagent.server.tokens import TokenBook
from worldagent.tests.page.browser import AXE, Served, Tab
from worldagent.tests.page.conftest import Made
from worldagent.tests.page.rich import rich_world


@pytest.fixture
def tokens(made: Made) -> dict[str, str]:
    book = TokenBook(made.root)
    return {scope: book.add(scope, scope) for scope in ("read", "write")}


@pytest.fixture
def asked(tokens: dict[str, str], served: Served, browser: Any) -> Iterator[Tab]:
    found = Tab(browser, served.url)
    yield found
    found.close()
    assert [t for t in found.troubles if "401" not in t] == []


def enter(tab: Tab, token: str) -> None:
    tab.page.get_by_label("Token").fill(token)
    tab.page.keyboard.press("Enter")


def test_the_form_says_what_was_wrong_and_lets_the_right_token_in(made: Made, asked: Tab, tokens: dict[str, str]) -> None:
    rich_world(made)
    page = asked.page
    page.goto(f"{asked.url}/#/w/w")
    page.get_by_role("heading", level=1, name="This server asks for a token").wait_for()
    assert page.evaluate("document.activeElement.name") == "token"
    if AXE.is_file():
        assert asked.audit() == []
    enter(asked, "not-the-token-of-this-server")
    page.get_by_role("alert").get_by_text("the token is unknown, revoked or expired").wait_for()
    assert page.evaluate("sessionStorage.length") == 0
    enter(asked, tokens["read"])
    page.get_by_role("heading", level=1, name="Three blocks").wait_for()
    page.locator(".connection.is-live").wait_for()
    assert tokens["read"] not in page.content()
    assert tokens["read"] not in page.url
    page.reload()
    page.get_by_role("heading", level=1, name="Three blocks").wait_for()
    page.get_by_role("button", name="Forget token").click()
    page.get_by_role("heading", level=1, name="This server asks for a token").wait_for()
    assert page.evaluate("sessionStorage.length") == 0


def test_pictures_film_and_proofs_are_fetched_with_the_token(made: Made, asked: Tab, tokens: dict[str, str]) -> None:
    rich_world(made)
    page = asked.page
    page.goto(f"{asked.url}/#/w/w")
    enter(asked, tokens["read"])
    asked.wait("document.querySelector('video')?.readyState >= 1 && document.querySelector('video').src.startsWith('blob:')")
    asked.wait("document.images[0].naturalWidth > 0")
    with page.expect_download() as saved:
        page.get_by_role("link", name="Bundle (zip)").click()
    assert saved.value.suggested_filename == "w_abababababababab.zip"
    assert saved.value.path().read_bytes() == b"PK"
    page.get_by_role("link", name="Pictures").first.click()
    asked.wait("document.images.length === 3 && [...document.images].every(i => i.src.startsWith('blob:') && i.naturalWidth > 0)")


@pytest.mark.parametrize("scope", ["read", "write"])
def test_only_a_write_token_can_cancel(made: Made, asked: Tab, tokens: dict[str, str], scope: str) -> None:
    made.world("w")
    made.advance(1)
    job = made.job("w")
    page = asked.page
    page.goto(f"{asked.url}/#/jobs")
    enter(asked, tokens[scope])
    page.get_by_role("progressbar", name="bake of w").wait_for()
    assert page.get_by_role("button", name="Cancel bake of w").count() == (scope == "write")
    status = page.evaluate(
        "([path, token]) => fetch(path, {method: 'POST', body: '{}', headers: {'Content-Type': 'application/json',"
        " Authorization: 'Bearer ' + token}}).then(r => r.status)",
        [f"/api/jobs/{job}/cancel", tokens[scope]],
    )
    assert status == (200 if scope == "write" else 403)
    assert made.jobs.get(job).ended == (scope == "write")
    asked.troubles = [t for t in asked.troubles if "403" not in t]


def test_a_token_that_is_revoked_locks_the_page_again(made: Made, asked: Tab, tokens: dict[str, str]) -> None:
    made.world("w")
    page = asked.page
    page.goto(asked.url)
    enter(asked, tokens["read"])
    page.get_by_role("link", name="Three blocks").wait_for()
    TokenBook(made.root).revoke("read")
    page.evaluate("location.hash = '#/w/w'")
    page.get_by_role("heading", level=1, name="This server asks for a token").wait_for()
    assert "Three blocks" not in page.inner_text("main")
    enter(asked, tokens["write"])
    page.get_by_role("heading", level=1, name="Three blocks").wait_for()

"""A person corrects a claim on the page: by the same way as an edit, audited, at the revision that was read."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient
from worldagent.server.http import http_app
from worldagent.server.tokens import TokenBook
from worldagent.tests.page.browser import Tab, needs_axe
from worldagent.tests.page.conftest import Made, row
from worldagent.tests.page.test_prompt import claimed
from worldagent.tests.stories.small_run import MARKED
from worldagent.workflow.session import Session
from worldagent.worlds.spec import Claim

PLACE = "/api/worlds/w/claims"


@pytest.fixture
def client(made: Made) -> Iterator[TestClient]:
    claimed(made, MARKED)
    with TestClient(http_app(made.root, tokens=TokenBook(made.root)), base_url="http://127.0.0.1:8931") as found:
        yield found


def asked(made: Made, claim: str, deed: str, **more: Any) -> dict[str, Any]:
    return {"revision": Session.open(made.root, "w").revision, "claim": claim, "deed": deed, **more}


def claims(made: Made) -> dict[str, Claim]:
    return dict(Session.open(made.root, "w").spec.claims)


REASON = {"reason": "it is an adjective, and no body of its own"}


def test_a_correction_is_a_revision_with_the_words_of_a_person(made: Made, client: TestClient) -> None:
    found = client.post(PLACE, json=asked(made, "three", "judge", type="count", by="b1 /entities/b2 b3"))
    assert found.status_code == 200, found.text
    assert found.json()["revision"] == 2
    assert claims(made)["three"].by == ["/entities/b1", "/entities/b2", "/entities/b3"]
    (latest, _) = Session.open(made.root, "w").ledger.revisions()
    assert latest["hypothesis"] == "a person corrected the claim of 'three' on the page"
    assert latest["patch"][0]["path"] == "/claims/three"


def test_types_are_changed_and_claims_waived_and_removed(made: Made, client: TestClient) -> None:
    client.post(PLACE, json=asked(made, "steel", "judge", type="look", by="ball", **REASON)).raise_for_status()
    assert claims(made)["steel"].type == "look"
    client.post(PLACE, json=asked(made, "steel", "waive", because="nobody sees of what it is", **REASON)).raise_for_status()
    assert claims(made)["steel"].waived == "nobody sees of what it is"
    client.post(PLACE, json=asked(made, "steel", "remove", **REASON)).raise_for_status()
    assert "steel" not in claims(made)


REFUSED: dict[str, tuple[dict[str, Any], int, str]] = {
    "less without a reason": ({"claim": "steel", "deed": "remove"}, 409, "give weakening_reason"),
    "what the audit finds": ({"claim": "three", "deed": "judge", "by": "b1 b2"}, 409, "the audit would fail: 'three' counts 3, by names 2"),
    "a number as filler": ({"claim": "three", "deed": "remove", **REASON}, 409, "is a number word and no claim takes it up"),
    "no such body": ({"claim": "ball", "deed": "judge", "by": "bal"}, 400, "did you mean 'ball'"),
    "no targets": ({"claim": "ball", "deed": "judge", "by": ""}, 400, "give by"),
    "a short reason": ({"claim": "steel", "deed": "waive", "because": "so", **REASON}, 400, "at least 10 characters"),
    "no such claim": ({"claim": "duck", "deed": "remove"}, 400, "there is no claim 'duck'"),
    "no such deed": ({"claim": "ball", "deed": "praise"}, 400, "must be one of judge, waive, remove"),
    "no such type": ({"claim": "ball", "deed": "judge", "type": "noun", "by": "ball"}, 400, "must be one of thing"),
    "another revision": ({"claim": "ball", "deed": "remove", "revision": 7}, 409, "at revision 1 by now"),
    "other keys": ({"claim": "ball", "deed": "remove", "status": "pass"}, 400, "a correction is a JSON object with the keys"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_refused_changes_nothing_and_says_why(made: Made, client: TestClient, what: str) -> None:
    given, status, text = REFUSED[what]
    found = client.post(PLACE, json=asked(made, **given) if "revision" not in given else given)
    assert (found.status_code, text in found.json()["error"]) == (status, True), found.text
    assert Session.open(made.root, "w").revision == 1


def test_a_form_of_another_site_and_a_token_that_reads_are_refused(made: Made, client: TestClient) -> None:
    body = asked(made, "steel", "remove", **REASON)
    assert client.post(PLACE, data=body).status_code == 415
    assert client.post(PLACE, content="[" * 50_000, headers={"Content-Type": "application/json"}).status_code == 400
    foreign = client.post(PLACE, json=body, headers={"Origin": "https://other.example"})
    assert foreign.status_code in (400, 403)
    token = TokenBook(made.root).add("reader", "read")
    with TestClient(http_app(made.root, tokens=TokenBook(made.root)), base_url="http://127.0.0.1:8931") as guarded:
        assert guarded.post(PLACE, json=body).status_code == 401
        assert guarded.post(PLACE, json=body, headers={"Authorization": f"Bearer {token}"}).status_code == 403
    assert "steel" in claims(made)


def test_a_person_corrects_a_claim_in_the_browser(made: Made, tab: Tab) -> None:
    claimed(made, MARKED)
    page = tab.go("#/w/w", "Three blocks")
    page.locator("mark[data-span=steel]").focus()
    page.get_by_role("button", name="Correct this claim").click()
    form = page.locator("form.correct")
    assert form.get_by_label("The claim of").input_value() == "steel"
    page.locator("mark[data-span=rolls]").hover()
    form.get_by_label("Judged by").fill("bal")
    form.get_by_role("button", name="Record the correction").click()
    alert = form.get_by_role("alert")
    alert.wait_for()
    assert "did you mean 'ball'" in alert.inner_text()
    assert form.get_by_label("Judged by").input_value() == "bal", "what was typed stays"
    tab.troubles.clear()  # the browser reports the 400
    form.get_by_label("It", exact=True).select_option("remove")
    form.get_by_label("Why less is asked").fill("the film shows no substance")
    form.get_by_role("button", name="Record the correction").click()
    tab.wait("document.getElementById('said').textContent === 'corrected, revision 2'")
    tab.wait("document.querySelectorAll('mark[data-span=steel]').length === 0")
    assert "steel" not in claims(made)


@needs_axe
@pytest.mark.parametrize("deed", ["judge", "waive"])
def test_the_form_is_accessible(made: Made, tab: Tab, deed: str) -> None:
    claimed(made, MARKED)
    page = tab.go("#/w/w", "Three blocks")
    page.get_by_text("To correct a claim").click()
    page.get_by_label("It", exact=True).select_option(deed)
    assert tab.audit() == []


def test_with_a_token_that_reads_the_marked_text_is_shown_instead(made: Made, tab: Tab) -> None:
    claimed(made, MARKED)
    made.rows("w", row("x"))
    token = TokenBook(made.root).add("reader", "read")
    tab.page.goto(f"{tab.url}/#/w/w")
    tab.page.get_by_label("Token").fill(token)
    tab.page.get_by_role("button", name="Open").click()
    tab.page.get_by_text("To correct a claim").click()
    assert "edit_spec(world='w', claims='...')" in tab.page.locator("#correcting").inner_text()
    assert tab.page.locator("form.correct").count() == 0
    tab.troubles.clear()  # the browser reports the 401

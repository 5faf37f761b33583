"""The prompt on the page: its spans with their rows and pictures, by pointer, keyboard and screen reader."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from worldagent.server.page.data import PageData
from worldagent.tests.page.browser import Served, Tab, needs_axe
from worldagent.tests.page.conftest import Made, row
from worldagent.tests.page.rich import pictured
from worldagent.tests.page.test_standing import FREEZE, frozen
from worldagent.tests.stories.small_run import MARKED, PROMPT, small_spec
from worldagent.tests.stories.version_1 import store_old
from worldagent.tools.edit_spec import edit_spec
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.plates import SEEDS, Plate, Plates, View
from worldagent.worlds.prompts.marks import parse_marks
from worldagent.worlds.provenance import recipes

WAIVED = MARKED.replace(" last ", ' [last](waived because="its place tells which is the last") ')


def claimed(made: Made, marked: str = WAIVED, prompt: str = PROMPT) -> WorldFolder:
    """A world of version 2 with rows about two of its claims."""
    edit_spec(made.context, world="w", prompt=prompt, spec=small_spec(), claims=marked)
    folder = WorldFolder.of(made.root, "w")
    told: dict[str, Any] = {"check": "claim", "group": "temporal", "unit": "1", "bound": 0.0, "comparison": "<="}
    made.rows(
        "w",
        row("claim:event:rolls", subject=("rolls",), measured=0.0, evidence={"explanation": "'rolls': ball rolls came true"}, **told),
        row("claim:event:falls_off", "fail", subject=("falls_off",), measured=1.0, evidence={"explanation": "b2 falls as well"}, **told),
        row("beat:roll", check="beat", group="temporal", subject=("roll",), measured=2.1, bound=0.5, unit="rad",
            evidence={"explanation": "ball turned", "first_true_frame": 1}),
    )  # fmt: skip
    pictured(folder)
    return folder


def prompt_of(made: Made) -> dict[str, Any]:
    data = PageData(made.root, lambda: made.jobs).world("w")["judged_prompt"]
    assert isinstance(data, dict)
    return data


def by_claim(spans: Sequence[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    return {s["claim"]: s for s in spans if "claim" in s}


def test_the_data_tells_the_state_rows_and_picture_of_every_span(made: Made) -> None:
    claimed(made)
    found = prompt_of(made)
    assert "".join(s["text"] for s in found["spans"]) == PROMPT
    spans = by_claim(found["spans"])
    states = {name: spans[name]["state"] for name in ("rolls", "falls_off", "ball", "last")}
    assert states == {"rolls": "pass", "falls_off": "fail", "ball": "unverified", "last": "waived"}
    assert (
        spans["rolls"]["words"]
        == "event, passes. pass: 'rolls': ball rolls came true (measured 0, required <= 0); pass: ball turned (measured 2.1 rad, required >= 0.5 rad)"
    )
    assert spans["rolls"]["picture"]["name"] == "preview_0001_00001_only.jpg"
    assert found["spans"][found["first"]]["claim"] == "falls_off"
    assert parse_marks(found["marked"], PROMPT)[0].targets == ("/entities/ball",)


def test_a_world_of_version_1_has_its_prompt_without_spans(made: Made) -> None:
    store_old(made.root)
    data = PageData(made.root, lambda: made.jobs).world("w")
    assert (data["judged_prompt"], data["prompt"]) == (None, PROMPT)


def test_the_verdict_has_the_same_words_in_list_and_overview(made: Made) -> None:
    folder = claimed(made)
    ledger = Ledger(folder.ledger_path)
    record = {"verdict": "accepted", "rows": [], "prompt": {"claimed": 0.6, "filler": 0.3, "waived": 0.1, "read_by": "client"}}
    ledger.add_acceptance("f" * 64, 1, "subject", "accepted", record)
    page = PageData(made.root, lambda: made.jobs)
    says = "accepted, prompt read by its own client alone"
    assert page.worlds()["worlds"][0]["verdict"]["says"] == says
    found = page.world("w")["acceptance"]
    assert found["says"] == says
    assert found["prompt"] == {"claimed": 0.6, "filler": 0.3, "waived": 0.1, "read_by": "its own client alone"}


@needs_axe
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_prompt_has_no_accessibility_violation(made: Made, served: Served, browser: Any, scheme: str) -> None:
    claimed(made)
    tab = Tab(browser, served.url, scheme=scheme)
    page = tab.go("#/w/w", "Three blocks")
    page.get_by_text("To correct a claim").click()
    found = tab.audit()
    tab.close()
    assert found == []


def test_pointing_and_the_keyboard_show_the_note_and_the_picture_of_a_span(made: Made, tab: Tab) -> None:
    claimed(made)
    page = tab.go("#/w/w", "Three blocks")
    note = page.get_by_role("group", name="The chosen span")
    assert "falls off: event, ✕ fails" in note.inner_text()
    page.locator("mark[data-span=rolls]").hover()
    tab.wait("document.querySelector('.note').innerText.includes('measured 2.1 rad, required ≥ 0.5 rad')")
    assert "preview_0001_00001" in str(note.locator("img").get_attribute("data-src"))
    page.locator("mark[data-span=three]").focus()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.dataset.span") == "blocks"
    tab.wait(
        "document.querySelector('.note').innerText.startsWith('Preview') && document.querySelector('.note').innerText.includes('blocks: thing, ? unverified')"
    )
    assert page.evaluate("document.activeElement.dataset.span") == "blocks"
    assert page.locator("mark[data-span=last]").get_attribute("title") == "waived: its place tells which is the last"


def plated(folder: WorldFolder) -> None:
    """A bake of the present settings with two plates of the ball."""
    spec = parse_spec(folder.read_json(folder.spec_path))
    ledger = frozen(folder)
    ledger.put_bake(FREEZE, ledger.revision(), "cache-1", {"failing": []})
    place = folder.candidate(FREEZE) / "bake" / "plates"
    plates = Plates(recipes(spec)["seen"], "cache-1", {}, (16, 9), 4)
    picture = np.full((SEEDS, 9, 16, 3), 200, np.uint8)
    for frame in (1, 20):
        plates = plates.added(place, View("ball", "only", frame), Plate(picture, picture))


def test_a_plate_stands_beside_a_span_where_the_present_bake_has_one(made: Made, tab: Tab) -> None:
    folder = claimed(made)
    plated(folder)
    spans = by_claim(prompt_of(made)["spans"])
    assert (spans["rolls"]["plate"]["plate"], spans["rolls"]["plate"]["frame"]) == (0, 1)
    assert "plate" not in spans["falls_off"]
    page = tab.go("#/w/w", "Three blocks")
    page.locator("mark[data-span=rolls]").hover()
    tab.wait("document.querySelector('.note img').naturalWidth === 16")
    assert "ball in the light of the film, frame 1" in page.locator(".note figcaption").inner_text()
    assert page.request.get(f"{tab.url}/api/worlds/w/plates/2").status == 404
    made.edit("w", ("/look/exposure", 1.5))
    assert "plate" not in by_claim(prompt_of(made)["spans"])["rolls"], "of another light"


def test_hostile_words_and_writing_from_right_to_left_stay_text(made: Made, tab: Tab) -> None:
    evil = "<img src=x onerror=alert(1)>"
    prompt = f"كرة تسقط {evil} \u202e end"
    claimed(made, f"[كرة](thing ball) تسقط {evil} \u202e end", prompt)
    page = tab.go("#/w/w", "Three blocks")
    quote = page.locator(".read blockquote")
    assert evil in quote.inner_text()
    assert "\\u202e" in quote.inner_text()
    assert quote.get_attribute("dir") == "auto"
    assert page.evaluate("getComputedStyle(document.querySelector('.read blockquote')).direction") == "rtl"
    assert page.locator("main img[src=x]").count() == 0


def test_a_prompt_of_twenty_thousand_characters_is_shown_and_answers_the_pointer(made: Made, tab: Tab) -> None:
    sentence = "A ball goes on along the shelf and then on. "
    prompt = sentence * 450
    marked = "A [ball](thing ball) goes on along the [shelf](thing shelf) and then on. "
    again = "A [ball](thing ball same_as=ball) goes on along the [shelf](thing shelf same_as=shelf) and then on. "
    claimed(made, marked + again * 449, prompt)
    page = tab.go("#/w/w", "Three blocks")
    assert page.locator("mark[data-span]").count() == 900
    last = page.locator("mark[data-span]").last
    last.hover()
    tab.wait("document.querySelector('mark[data-chosen]') === [...document.querySelectorAll('mark[data-span]')].at(-1)")

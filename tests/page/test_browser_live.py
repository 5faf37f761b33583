"""Changes while somebody watches: of jobs, worlds, verdicts, and the server itself."""

from __future__ import annotations

import pytest
from worldagent.tests.page.browser import Served, Tab
from worldagent.tests.page.conftest import Made, row
from worldagent.tests.page.rich import rich_world
from worldagent.tools.bake_sim import bake_sim
from worldagent.tools.place_object import place_object
from worldagent.tools.probe_sim import probe_sim


def test_a_job_is_followed_to_its_end_and_told_aloud(made: Made, tab: Tab) -> None:
    made.world("w")
    page = tab.go("", "Worlds")
    made.job("w")
    bar = page.get_by_role("progressbar", name="bake of w")
    for step in (2, 5, 8):
        made.advance(step)
        tab.wait(f"document.querySelector('progress')?.value === {step / 10}")
        assert f"step {step} of 10" in page.inner_text(".job-foot")
    made.advance(10)
    bar.wait_for(state="detached")
    assert page.locator("#said").inner_text() == "bake of w: done"
    page.get_by_role("link", name="Jobs").click()
    page.get_by_role("region", name="Ended").get_by_text("done").wait_for()


def test_a_job_is_cancelled_after_asking_once(made: Made, tab: Tab) -> None:
    made.world("w")
    made.advance(1)
    job = made.job("w")
    page = tab.go("#/jobs", "Jobs")
    page.get_by_role("button", name="Cancel bake of w").click()
    assert page.evaluate("document.activeElement.innerText") == "Cancel it"
    page.get_by_role("button", name="Keep running").click()
    assert not made.jobs.get(job).ended
    page.get_by_role("button", name="Cancel bake of w").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")
    page.get_by_role("region", name="Ended").get_by_text("cancelled").wait_for()
    assert made.jobs.get(job).state == "cancelled"


def test_a_world_appears_changes_and_goes_without_a_reload(made: Made, tab: Tab) -> None:
    page = tab.go("", "Worlds")
    page.get_by_role("heading", name="No world yet").wait_for()
    folder = rich_world(made)
    page.get_by_role("link", name="Three blocks").click()
    page.get_by_role("link", name="Requirements").click()
    tab.wait("document.querySelector('.matrix td.c-status') !== null")
    page.locator(".matrix summary").first.click()
    first = page.locator(".matrix code").first.inner_text()
    made.rows("w", row("gap:new", "fail", measured=-0.5))
    page.get_by_text("gap:new", exact=True).wait_for()
    still = page.locator("details[open] code").all_inner_texts()
    assert still == [first]
    folder.root.rename(made.root / ".away")
    page.get_by_text("there is no world 'w'").wait_for()
    tab.troubles = [t for t in tab.troubles if "404" not in t]


def test_what_is_typed_and_focused_stays_while_things_change(made: Made, tab: Tab) -> None:
    rich_world(made)
    page = tab.go("#/w/w/requirements", "Three blocks")
    page.get_by_label("Find").press_sequentially("gap")
    for k in range(3):
        made.rows("w", row(f"gap:extra{k}"))
        page.get_by_text(f"gap:extra{k}", exact=True).wait_for()
    assert page.evaluate("[document.activeElement.name, document.activeElement.value]") == ["q", "gap"]


def test_the_page_comes_back_after_the_server_was_restarted(made: Made, served: Served, tab: Tab) -> None:
    made.world("before")
    page = tab.go("", "Worlds")
    page.get_by_text("1 world", exact=True).wait_for()
    served.stop()
    page.get_by_text("not connected, trying again").first.wait_for()
    assert page.locator(".worlds > li").count() == 1
    made.world("after")
    served.start()
    page.get_by_text("2 worlds", exact=True).wait_for()
    page.locator(".connection.is-live").wait_for()
    assert page.locator("#said").inner_text() == "connected again"
    tab.troubles = [t for t in tab.troubles if "ERR_" not in t]


def test_a_tab_that_nobody_sees_gives_its_stream_back(made: Made, tab: Tab) -> None:
    page = tab.go("", "Worlds")
    turn = """hidden => {
        Object.defineProperty(document, "hidden", {value: hidden, configurable: true});
        document.dispatchEvent(new Event("visibilitychange"));
    }"""
    with page.expect_event("requestfailed", lambda r: r.url.endswith("/api/events")):
        page.evaluate(turn, True)
    made.world("meanwhile")
    with page.expect_request(lambda r: r.url.endswith("/api/events")):
        page.evaluate(turn, False)
    page.get_by_text("1 world", exact=True).wait_for()
    assert page.locator(".worlds > li").count() == 1


def followed(made: Made, tab: Tab, job: str) -> None:
    """A real job to its end, its progress seen on the way."""
    seen: set[float] = set()
    while not made.jobs.wait(job, 0.02).ended:
        seen.add(float(tab.page.evaluate("document.querySelector('progress')?.value ?? 0")))
    assert made.jobs.get(job).state == "done"
    assert len(seen - {0.0, 1.0}) >= 2


def stages(tab: Tab) -> list[str]:
    return list(tab.page.locator(".stages .is-done .name").all_inner_texts())


@pytest.mark.slow
def test_a_real_probe_is_watched_from_its_first_frame_to_its_rows(made: Made, tab: Tab) -> None:
    made.world("w")
    page = tab.go("#/w/w", "Three blocks")
    place_object(made.context, world="w")
    assert stages(tab) == ["specified", "audited"]
    followed(made, tab, str(probe_sim(made.context, world="w", wait_s=0).data["job_id"]))
    page.locator(".stages .is-done .name", has_text="frozen").wait_for()
    page.get_by_role("link", name="Contact sheet of the probe").wait_for()


@pytest.mark.slow
def test_a_real_bake_is_watched_after_its_probe(made: Made, tab: Tab) -> None:
    made.world("w")
    place_object(made.context, world="w")
    assert probe_sim(made.context, world="w", wait_s=240).data["passed"]
    page = tab.go("#/w/w", "Three blocks")
    assert stages(tab) == ["specified", "audited", "probed", "frozen"]
    followed(made, tab, str(bake_sim(made.context, world="w", wait_s=0).data["job_id"]))
    page.locator(".stages .is-done .name", has_text="baked").wait_for()
    page.get_by_role("link", name="Contact sheet of the bake").wait_for()

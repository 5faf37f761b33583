"""A verdict has the same words wherever it is told: what was judged of the prompt, and who read it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from worldagent.execution import JobStore
from worldagent.server.report import world_report
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.tools.inspect_world import inspect_world
from worldagent.tools.run_checks import _reply
from worldagent.workflow import jobs
from worldagent.workflow.context import ToolContext
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.verdicts import reader_words, verdict_words

SPANS = [{"text": "A "}, {"text": "ball", "claim": "ball", "type": "thing", "by": ["/entities/ball"]}]


def record(verdict: str = "accepted", read_by: str | None = "nobody") -> dict[str, Any]:
    prompt = {
        "spans": SPANS,
        "claimed": 0.8,
        "filler": 0.2,
        "waived": 0.0,
        "waivers": {},
        "warnings": ["a noun was left out"],
        "read_by": read_by,
    }
    return {"verdict": verdict, "rows": [], "clauses": {}, "approximations": [], **({"prompt": prompt} if read_by else {})}


WORDS = {
    "accepted, prompt read by nobody": record(),
    "accepted, prompt read by its own client alone": record(read_by="client"),
    "accepted": record(read_by="model"),
    "physics accepted; prompt judged by clauses": record(read_by=None),
    "incomplete": record("incomplete"),
}


@pytest.fixture
def context(tmp_path: Path) -> ToolContext:
    made = ToolContext(tmp_path, JobStore(tmp_path), lambda done, total, message: None, lambda: False)
    edit_spec(made, world="w", prompt=PROMPT, spec=small_spec())
    return made


@pytest.mark.parametrize("words", WORDS)
def test_overview_acceptance_report_and_reply_say_the_same(context: ToolContext, words: str) -> None:
    told = WORDS[words]
    folder = WorldFolder.of(context.workspace, "w")
    ledger = Ledger(folder.ledger_path)
    ledger.add_acceptance("f" * 64, 1, "subject", str(told["verdict"]), told)
    assert verdict_words(told) == words
    overview = inspect_world(context, world="w").data
    assert overview["last_verdict"] == {"verdict": told["verdict"], "revision": 1, "says": words}
    assert overview["summary"].endswith(f"last verdict at revision 1: {words}")
    found = inspect_world(context, world="w", part="acceptance").data
    assert found["summary"].startswith(f"{words}: revision 1")
    assert found["acceptance"]["says"] == words
    assert f"Latest verdict: {words}; revision 1" in world_report(folder, ledger)
    counts = {"pass": 3, "fail": 0, "unverified": 0, "mandatory_open": 0}
    reply = _reply("w", 1, {"verdict": told["verdict"], "says": words, "counts": counts}, "concise").data
    assert reply["summary"].startswith(f"{words}: 3 rows pass")


@pytest.mark.parametrize("words", [w for w, told in WORDS.items() if told["verdict"] == "accepted"])
def test_the_film_says_what_the_verdict_that_opened_it_says(words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The job of the film with its pictures left out: its words are those of the acceptance that it asked for."""
    film = tmp_path / "final.webm"
    film.write_bytes(b"film")
    spec = SimpleNamespace(simulation=SimpleNamespace(fps=24), look=SimpleNamespace(samples=2))
    folder = SimpleNamespace(candidate=lambda freeze: tmp_path, relative=lambda path: path.name)
    session = SimpleNamespace(spec=spec, folder=folder)
    candidate = SimpleNamespace(caches={})
    work = SimpleNamespace(session=session, freeze="f" * 64, candidate=lambda stage: candidate)
    monkeypatch.setattr(jobs, "open_work", lambda payload, present: work)
    monkeypatch.setattr(jobs, "require_acceptance", lambda session, freeze: {"record": WORDS[words]})
    monkeypatch.setattr(jobs, "film_sheet", lambda *args: "sheet.jpg")
    monkeypatch.setattr("worldagent.workflow.plates.require_seen", lambda *args: None)
    monkeypatch.setattr("worldagent.rendering.render_sequence", lambda *args, **more: [film])
    video = SimpleNamespace(path=film, codec="vp9", frames=1, width=64, height=64, note="")
    monkeypatch.setattr("worldagent.rendering.write_video", lambda *args: video)
    asked = SimpleNamespace(progress=lambda *args: None, check=lambda: None, cancelled=lambda: False)
    assert jobs.final({}, asked)["says"] == words  # type: ignore[arg-type]


def test_the_acceptance_tells_how_the_prompt_was_judged_without_its_spans(context: ToolContext) -> None:
    Ledger(WorldFolder.of(context.workspace, "w").ledger_path).add_acceptance("f" * 64, 1, "subject", "accepted", record())
    prompt = inspect_world(context, world="w", part="acceptance").data["acceptance"]["prompt"]
    assert (prompt["claimed"], prompt["warnings"], prompt["read_by"]) == (0.8, ["a noun was left out"], "nobody")
    assert "spans" not in prompt


@pytest.mark.parametrize(
    ("read_by", "words"),
    [
        ("nobody", "nobody"),
        ("client", "its own client alone"),
        ("model", "an independent model"),
        ("person", "a person"),
        ("<b>", "nobody"),
    ],
)
def test_readers_are_named_and_a_strange_one_is_nobody(read_by: str, words: str) -> None:
    assert reader_words({"read_by": read_by}) == words

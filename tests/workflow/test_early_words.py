"""Words of place that are not so at frame 0 are told before a probe."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.tests.stories.small_run import MARKED, PROMPT, small_spec
from worldagent.workflow.creation import create
from worldagent.workflow.early_words import unmet_at_start
from worldagent.workflow.session import Session
from worldagent.worlds.claim_marks import claims_from
from worldagent.worlds.patch import parse_spec


def _made(workspace: Path, word: str) -> Session:
    prompt, marked = (f"{t} A block is {p} the shelf." for t, p in ((PROMPT, word), (MARKED, f"[{word}](place shelf)")))
    marked = marked.replace("A block is", "A [block](thing b3 same_as=blocks) is").replace(
        "the shelf.", "the [shelf](thing shelf same_as=shelf)."
    )
    spec = small_spec()
    plain = {k: v for k, v in spec.items() if k != "claims"}
    spec["claims"] = claims_from(marked, parse_spec({**plain, "prompt": prompt}))
    session, _ = create(workspace, "w", prompt, spec)
    assert session.audit().passed, [r.evidence for r in session.audit().rows if r.status == "fail"]
    return session


@pytest.mark.parametrize(("word", "told"), [("under", True), ("on", False)])
def test_a_place_that_is_not_so_is_told_and_one_that_is_is_not(tmp_path: Path, word: str, told: bool) -> None:
    found = unmet_at_start(_made(tmp_path, word))
    assert bool(found) == told, found
    assert all(f.startswith("not so at frame 0: claim:place:") for f in found)


def test_nothing_is_told_while_the_audit_is_open(tmp_path: Path) -> None:
    session = _made(tmp_path, "under")
    session.spec = session.spec.model_copy(update={"claims": {}})
    assert unmet_at_start(session) == []

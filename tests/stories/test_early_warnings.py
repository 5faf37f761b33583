"""A client is told what will probably fail before it simulates: by edit_spec, by the audit, with the probe, by build_terrain."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tests.stories.test_landscape import LAND

PUSH = {
    "kind": "field", "field": {"kind": "attraction", "center": [9, 0, 0], "acceleration": 1e-3, "distance": 1, "exponent": 0}, "entities": ["b1"],
    "start": 1.2, "end": 1.3,
}  # fmt: skip
"""Too weak and too late to change a beat."""
UNOWNED = "/simulation/drivers/push: 0 beats are owned by field 'push'"


@pytest.fixture(autouse=True)
def _inline(monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)


def told(reply: dict[str, Any], start: str) -> int:
    """Number of warnings of a reply that begin so."""
    return sum(w.startswith(start) for w in reply["warnings"])


def test_a_warning_of_the_audit_comes_with_edits_the_audit_and_the_probe_until_it_is_mended(agent: Any) -> None:
    made = agent.call("edit_spec", world="w", prompt=PROMPT, spec=small_spec())
    assert told(made, UNOWNED) == 0
    edited = agent.call("edit_spec", world="w", patch=[{"op": "add", "path": "/simulation/drivers/push", "value": PUSH}])
    assert edited["audit"]["passed"], "a warning refuses nothing"
    assert told(edited, UNOWNED) == 1
    assert told(agent.call("run_checks", world="w", scope="audit"), UNOWNED) == 1
    assert told(agent.call("probe_sim", world="w", wait_s=200), UNOWNED) == 1
    mended = agent.call(
        "edit_spec",
        world="w",
        patch=[{"op": "remove", "path": "/simulation/drivers/push"}],
        hypothesis="the push does nothing: take it away",
    )
    assert told(mended, UNOWNED) == 0


@pytest.mark.parametrize(("required", "count"), [([], 1), (["lake"], 0)])
def test_a_lake_that_nobody_asked_for_is_told_with_the_answer_of_build_terrain(
    agent: Any, required: list[str], count: int
) -> None:
    land = {**LAND, "hydrology": {"required": required}}
    spec = {
        "title": "Land", "spec_version": "2", "terrains": {"land": land}, "simulation": {"frames": 12},
        "materials": {"stone": {"density": 2600, "substance": "stone"}},
    }  # fmt: skip
    agent.call("edit_spec", world="w", prompt="A hollow land.", spec=spec)
    built = agent.call("build_terrain", world="w", terrain="land", size=[80, 80], cells=40, wait_s=120)
    assert told(built, "/terrains/land/hydrology/required: ") == count

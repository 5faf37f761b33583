"""Worlds that a tester made with the tools alone and that were once judged wrongly: dishonest ones accepted, honest ones refused.

A world that is still judged wrongly comes into the folder with a strict `xfail` of its own and a line in `docs/threat-model.md`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.worlds.ledger import Ledger

FOLDER = Path(__file__).parent / "holes"
HONEST = ("still_world",)
"""Worlds that were refused once, and are accepted."""
CLOSED = {
    "beads_in_the_air": "support:derived:bead0",
    "contact_in_an_or": "beat:branches:hit",
    "heavy_core": "scale:hidden:wooden_block",
    "hovers_on_a_field": "support:derived:lamp",
    "hovers_on_a_force": "support:derived:lamp",
    "needle_under_a_corner": "support:balance:slab",
    "pair_that_bounces": "audit:bounds",
    "pair_without_friction": "audit:bounds",
    "pusher_of_no_beat": "beat:driven:push",
    "slab_beside_air": "support:derived:slab",
    "slide_to_a_point": "audit:reach",
    "spring_behind_a_latch": "beat:driven:push",
    "spring_that_drives": "beat:driven:push",
    "spring_to_a_point": "audit:reach",
    "squeezed_by_skins": "support:derived:lamp",
    "undrawn_rail": "beat:driven:push",
    "weld_to_a_point": "audit:reach",
}
"""Worlds that were accepted once, and the row that refuses each."""
STEPS = (("place_object", "static_passed"), ("probe_sim", "passed"), ("bake_sim", "passed"))
"""Tools between audit and acceptance, each with the field of its answer that says that it let the world through."""


def verdict(name: str, agent_of: Any, folder: Path) -> tuple[str, set[str]]:
    """Verdict of the acceptance of a world, or the tool that let it go no further; and the rows that fail."""
    world = json.loads((FOLDER / f"{name}.json").read_text())
    with pytest.MonkeyPatch.context() as patch, agent_of(folder) as agent:
        run_jobs_inline(patch)
        said = _said(agent, world)
    return said, {row.id for row in Ledger(folder / "w" / "ledger.sqlite").rows() if row.status == "fail"}


def _said(agent: Any, world: dict[str, Any]) -> str:
    if not agent.call("edit_spec", world="w", **world)["audit"]["passed"]:
        return "refused by edit_spec"
    for tool, passed in STEPS:
        answer = agent.result(tool, world="w")
        if answer.is_error or not json.loads(answer.content[0].text)[passed]:
            return f"refused by {tool}"
    return str(agent.call("run_checks", world="w", scope="acceptance")["verdict"])


def test_the_folder_holds_the_worlds_of_the_list_and_those_that_were_found() -> None:
    assert {path.stem for path in FOLDER.glob("*.json")} == {*HONEST, *CLOSED}
    assert len(CLOSED) >= 17


@pytest.mark.slow
@pytest.mark.parametrize("name", HONEST)
def test_an_honest_world_is_accepted(name: str, agent_of: Any, tmp_path: Path) -> None:
    assert verdict(name, agent_of, tmp_path) == ("accepted", set())


@pytest.mark.slow
@pytest.mark.parametrize("name", CLOSED)
def test_a_hole_stays_closed(name: str, agent_of: Any, tmp_path: Path) -> None:
    """By the row that closed it, and not because its prompt is marked badly."""
    said, failed = verdict(name, agent_of, tmp_path)
    assert said != "accepted"
    assert CLOSED[name] in failed
    assert "audit:claims" not in failed

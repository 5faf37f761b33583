"""Every gate refuses, says what is missing and which call comes next, and leaves the world as it was."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.ledger import Ledger

Patch = Callable[..., list[dict[str, Any]]]
REASON = "the prompt does not ask for it, as the user confirmed"


def test_probe_without_a_passing_audit_names_the_problem_and_the_tool(agent: Any) -> None:
    spec = small_spec()
    spec["claims"]["falls_off"]["by"] = ["/entities/b3"]
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    for tool in ("place_object", "probe_sim", "bake_sim"):
        text = agent.refused(tool, world="w")
        assert text.startswith("refused: ")
        assert "edit_spec" in text
        assert "/claims/falls_off/by" in text
    assert "audit" in agent.refused("run_checks", world="w", scope="acceptance")
    assert "audit" in agent.refused("render_shot", world="w", kind="preview")


def test_probe_with_failing_static_rows_names_row_value_and_bound(agent: Any) -> None:
    spec = small_spec()
    spec["entities"]["b2"]["pose"]["position"][0] += 0.01
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    assert not agent.call("place_object", world="w")["static_passed"]
    text = agent.refused("probe_sim", world="w")
    assert "static rows" in text
    assert "interpenetration" in text
    assert "measured -0.0" in text
    assert "place_object" in text
    assert "probe" in agent.refused("bake_sim", world="w")


def test_nothing_after_the_probe_opens_without_it(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=small_spec())
    unproved = agent.refused("bake_sim", world="w")
    assert "call probe_sim first" in unproved
    assert "no probe of this world has passed" in unproved
    assert "bake_sim" in agent.refused("run_checks", world="w", scope="acceptance")
    assert "run_checks(world, scope='acceptance')" in agent.refused("render_shot", world="w", kind="final")
    assert "probe_sim" in agent.refused("inspect_world", world="w", part="events")


def test_bake_after_a_failed_probe_names_what_it_left_open(failed: Any) -> None:
    text = failed.refused("bake_sim", world="w")
    assert "passing probe" in text
    assert "beat:fall" in text or "causal" in text


def test_every_later_edit_of_the_motion_closes_bake_acceptance_and_final(accepted: Any) -> None:
    accepted.edit(("/entities/ball/physics/linear_velocity/0", 1.05))
    unproved = accepted.refused("bake_sim", world="w")
    assert "passing probe of exactly these settings" in unproved
    assert "there changed /entities/ball/physics/linear_velocity" in unproved
    assert "complete bake of exactly these settings" in accepted.refused("run_checks", world="w", scope="acceptance")
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")


@pytest.mark.slow
def test_an_edit_of_the_story_closes_final_until_accepted_again(accepted: Any) -> None:
    accepted.edit(("/story/beats/fall/predicate/min", 0.2))
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")
    verdict = accepted.call("run_checks", world="w", scope="acceptance")
    assert verdict["verdict"] == "accepted"


@pytest.mark.slow
def test_a_beat_that_did_not_happen_leaves_the_candidate_incomplete_and_preserved(accepted: Any) -> None:
    accepted.edit(("/story/beats/fall/predicate/min", 0.5))
    verdict = accepted.call("run_checks", world="w", scope="acceptance")
    assert verdict["verdict"] == "incomplete"
    assert "beat:fall" in [r["id"] for r in verdict["open_rows"]]
    assert "edit_spec" in verdict["next"]
    row = accepted.call("inspect_world", world="w", part="row", row="beat:fall")["row"]
    assert row["corrections"]
    assert row["first_failing_entity"] == "b3"
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")
    freeze = verdict["freeze"]
    assert (accepted.workspace / "w" / "candidates" / freeze / "bake" / "rigid" / "frame_000035.npz").is_file()


# ---------------------------------------------------------------- the prompt and hand edits


def test_no_patch_changes_the_prompt(accepted: Any, patch: Patch) -> None:
    for change in (
        patch(("/prompt", "A ball.")),
        [{"op": "remove", "path": "/prompt"}],
        [{"op": "replace", "path": "", "value": {"prompt": "A ball."}}],
        [{"op": "move", "from": "/title", "path": "/prompt"}],
    ):
        assert "prompt is immutable" in accepted.refused("edit_spec", world="w", patch=change)
    assert "exists already" in accepted.refused("edit_spec", world="w", prompt="A ball.")
    assert "one of them" in accepted.refused("edit_spec", world="w", prompt=PROMPT, patch=patch(("/title", "x")))


def _by_hand(agent: Any, change: Callable[[dict[str, Any]], None]) -> Path:
    path: Path = agent.workspace / "w" / "world.json"
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))
    return path


def test_a_prompt_edited_by_hand_can_only_be_restored(accepted: Any) -> None:
    _by_hand(accepted, lambda d: d.update(prompt="A ball."))
    assert "on_hand_edit" in accepted.refused("place_object", world="w")
    assert "restore" in accepted.refused("edit_spec", world="w", on_hand_edit="adopt")
    assert accepted.call("edit_spec", world="w", on_hand_edit="restore")["restored"]
    assert accepted.call("inspect_world", world="w")["prompt"] == PROMPT


def test_a_hand_edit_is_noticed_and_adopted_as_a_revision(accepted: Any, patch: Patch) -> None:
    _by_hand(accepted, lambda d: d["entities"]["ball"]["physics"].update(mass=0.3))
    for tool, more in (("probe_sim", {}), ("inspect_world", {}), ("edit_spec", {"patch": patch(("/title", "x"))})):
        text = accepted.refused(tool, world="w", **more)
        assert "edited outside the server" in text
        assert "adopt" in text
        assert "restore" in text
    data = accepted.call("edit_spec", world="w", on_hand_edit="adopt")
    assert data["revision"] == 2
    assert data["changed"] == ["/entities/ball/physics/mass"]
    assert "motion" in data["stale"]
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")


def test_an_adopted_hand_edit_keeps_the_rules_of_repair(failed: Any) -> None:
    _by_hand(failed, lambda d: d["story"]["beats"].pop("fall"))
    assert "/story/beats/fall removed" in failed.refused("edit_spec", world="w", on_hand_edit="adopt")


def test_a_damaged_or_deleted_world_json_is_restored(accepted: Any) -> None:
    path: Path = accepted.workspace / "w" / "world.json"
    whole = path.read_text()
    path.write_text(whole[:200])
    assert "restore" in accepted.refused("inspect_world", world="w")
    accepted.call("edit_spec", world="w", on_hand_edit="restore")
    assert path.read_text() == whole
    path.unlink()
    accepted.call("edit_spec", world="w", on_hand_edit="restore")
    assert path.read_text() == whole


def test_the_expected_revision_guards_an_edit(accepted: Any, patch: Patch) -> None:
    text = accepted.refused("edit_spec", world="w", patch=patch(("/title", "x")), expected_revision=4)
    assert "at revision 1, not 4" in text
    assert accepted.edit(("/title", "x"), expected_revision=1)["revision"] == 2
    assert Ledger(accepted.workspace / "w" / "ledger.sqlite").revision() == 2


def test_a_world_recorded_without_a_newer_field_is_no_hand_edit(accepted: Any) -> None:
    """An earlier version of the program wrote fewer fields; their defaults say the same."""
    with sqlite3.connect(accepted.workspace / "w" / "ledger.sqlite") as db:
        (text,) = db.execute("SELECT spec FROM revisions ORDER BY n DESC LIMIT 1").fetchone()
        document = json.loads(text)
        for beat in document["story"]["beats"].values():
            beat.pop("margins", None)
        db.execute("UPDATE revisions SET spec=?", (json.dumps(document),))
        db.execute("DELETE FROM meta")
    db.close()
    assert accepted.call("inspect_world", world="w")["matrix"]["mandatory_open"] == 0


def test_acceptance_names_the_rows_of_the_matrix_that_it_does_not_count(loop: Any) -> None:
    """`numerical:promise` compares the bake with its probe, of which the fresh process reads nothing."""
    told = json.loads(loop.answers["accept"].content[0].text)
    rows = Ledger(loop.workspace / "w" / "ledger.sqlite").rows()
    assert told["not_counted"] == ["numerical:promise"]
    assert told["counts"]["pass"] + told["counts"]["not_applicable"] + len(told["not_counted"]) == len(rows)
    assert "numerical:promise" in told["summary"]
    assert told["revision"] == 1

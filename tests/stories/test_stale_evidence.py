"""An edit makes stale exactly what depends on it; the rest is kept, and what is stale is done again."""

from __future__ import annotations

from pathlib import Path
from threading import Barrier, Thread
from typing import Any

import pytest
from worldagent.tests.stories.small_run import small_spec
from worldagent.workflow.standing import standing
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger


def _files(folder: Path) -> dict[str, tuple[int, bytes]]:
    return {p.relative_to(folder).as_posix(): (p.stat().st_mtime_ns, p.read_bytes()) for p in folder.rglob("*") if p.is_file()}


def _stale(agent: Any) -> set[str]:
    return {r.id for r in Ledger(agent.workspace / "w" / "ledger.sqlite").rows() if r.evidence.get("stale")}


def test_moving_one_block_leaves_what_does_not_depend_on_it(accepted: Any) -> None:
    folder = accepted.workspace / "w"
    built, caches = _files(folder / "built"), _files(folder / "candidates")
    data = accepted.edit(("/entities/b3/pose/position/0", 0.2047))
    assert set(data["stale"]) == {
        "acceptance",
        "category",
        "claims",
        "contact",
        "final",
        "motion",
        "seen",
        "shots",
        "static:b3",
        "story",
    }
    stale = _stale(accepted)
    kept = {r.id for r in Ledger(folder / "ledger.sqlite").rows()} - stale
    assert {"scale:ball", "scale:b1", "interpenetration:b1:b2"} <= kept
    assert not [i for i in stale if i.startswith(("scale:", "interpenetration:")) and "b3" not in i and "scene" not in i]
    assert {"beat:fall", "causal:strike:fall", "category:rigid:energy:rigid", "numerical:finite:rigid"} & stale
    assert accepted.call("place_object", world="w")["built"] == []
    assert _files(folder / "built") == built
    assert {k: v for k, v in _files(folder / "candidates").items() if k in caches} == caches


@pytest.mark.slow
def test_another_shot_keeps_the_bake_and_asks_for_acceptance_again(accepted: Any) -> None:
    folder = accepted.workspace / "w"
    caches = _files(folder / "candidates")
    data = accepted.edit(("/shots/only/keys/a/position", [0.2, -1.25, 0.5]))
    assert data["stale"] == ["acceptance", "claims", "final", "seen", "shots"]
    assert all(i.startswith(("shots:", "delivery:", "claim:")) for i in _stale(accepted))
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")
    assert accepted.call("run_checks", world="w", scope="acceptance")["verdict"] == "accepted"
    after = _files(folder / "candidates")
    kept = {k for k in caches if "/plates/" not in k}
    assert {k for k in kept if after[k] != caches[k]} == {k for k in kept if k.endswith("candidate.json")}
    assert not accepted.call("inspect_world", world="w")["open_rows"]


SEEN = {f"shots:seen:{n}" for n in ("roll", "strike", "fall")}


@pytest.mark.parametrize(
    ("pointer", "value"),
    [("/look/sky", "overcast"), ("/materials/wood/appearance/color", [0.9, 0.05, 0.05]), ("/look/exposure", 0.5)],
)
def test_an_edit_of_the_look_says_which_rows_are_asked_anew_and_when(accepted: Any, pointer: str, value: Any) -> None:
    data = accepted.edit((pointer, value))
    assert data["stale"] == ["final", "seen"]
    assert set(data["stale_rows"]) == SEEN
    assert "before its first frame" in data["next"]
    assert "scope='probe'" not in data["next"]


def test_another_look_stales_only_what_is_seen_in_it(accepted: Any) -> None:
    rows = {r.id: r.status for r in Ledger(accepted.workspace / "w" / "ledger.sqlite").rows() if r.question == "shots:seen"}
    assert rows == dict.fromkeys(SEEN, "pass")
    data = accepted.edit(("/look/exposure", 0.5), ("/materials/wood/appearance/roughness", 0.9))
    assert data["stale"] == ["final", "seen"]
    assert _stale(accepted) == SEEN
    folder = WorldFolder.of(accepted.workspace, "w")
    assert standing(folder, Ledger(folder.ledger_path)).step("accepted").state == "done"
    started = accepted.call("render_shot", world="w", kind="final", width=64, height=64, samples=1, wait_s=0)
    assert started["job_id"]
    accepted.call("job", action="cancel", job_id=started["job_id"])


@pytest.mark.slow
def test_a_black_film_is_refused_and_the_rows_own_patch_makes_it_a_film(accepted: Any) -> None:
    accepted.edit(("/look/exposure", -10))
    assert _stale(accepted) == SEEN
    text = accepted.result("render_shot", world="w", kind="final", width=64, height=64, samples=1).content[0].text
    assert "would not show its story: 3 subjects" in text
    assert "too dark" in text
    judged = accepted.call("run_checks", world="w", scope="full", only=["shots"])
    assert {r["id"] for r in judged["open_rows"]} == SEEN
    patch = judged["open_rows"][0]["corrections"][0]["patch"]
    accepted.call("edit_spec", world="w", patch=patch, hypothesis="the film is black")
    assert accepted.call("render_shot", world="w", kind="final", width=64, height=64, samples=1)["frames"] == 36
    assert not _stale(accepted)


def test_another_picture_shape_asks_for_the_shot_checks_again(accepted: Any) -> None:
    assert "shots" in accepted.edit(("/look/width", 128))["stale"]


@pytest.mark.slow
def test_one_mass_after_acceptance_goes_round_the_loop_again(accepted: Any) -> None:
    before = accepted.call("inspect_world", world="w", part="acceptance")["acceptance"]
    data = accepted.edit(("/entities/b2/physics", {"category": "rigid", "mass": 0.05}))
    assert {"built:b2", "motion", "story", "acceptance"} <= set(data["stale"])
    assert not [a for a in data["stale"] if a.startswith(("built:", "static:")) and not a.endswith(":b2")]
    assert "beat:fall" in accepted.call("inspect_world", world="w", limit=200)["open_rows"]
    assert accepted.call("probe_sim", world="w")["passed"]
    assert accepted.call("bake_sim", world="w")["passed"]
    assert accepted.call("run_checks", world="w", scope="acceptance")["verdict"] == "accepted"
    after = accepted.call("inspect_world", world="w", part="acceptance")["acceptance"]
    assert after["cache_digest"] != before["cache_digest"]
    assert len(list((accepted.workspace / "w" / "candidates").iterdir())) == 2


@pytest.mark.slow
def test_a_later_candidate_changes_no_file_of_an_earlier_one(accepted: Any) -> None:
    """R129: another mass, probed; the accepted candidate and the files of another world stay as they are, byte for byte."""
    root = accepted.workspace
    (root / "notes.txt").write_text("mine")

    def kept() -> dict[str, bytes]:
        own = [p for p in (root / "w" / "candidates").rglob("*") if p.is_file() and p.name != "lock"]
        return {str(p.relative_to(root)): p.read_bytes() for p in [*own, root / "notes.txt"]}

    before = kept()
    assert len(before) > 36, "frames of the bake"
    accepted.edit(("/entities/b2/physics", {"category": "rigid", "mass": 0.05}))
    assert accepted.call("probe_sim", world="w")["passed"]
    after = kept()
    assert {k: after.get(k) for k in before} == before
    assert len({k.split("/")[2] for k in after if k.startswith("w/candidates/")}) == 2
    text = accepted.refused("edit_spec", world="w", prompt="Another prompt.", spec=small_spec())
    assert "prompt" in text


@pytest.mark.slow
def test_undoing_an_edit_finds_its_evidence_again(accepted: Any) -> None:
    accepted.edit(("/entities/b2/physics", {"category": "rigid", "mass": 0.05}))
    accepted.edit(("/entities/b2/physics", {"category": "rigid"}))
    assert accepted.call("run_checks", world="w", scope="acceptance")["verdict"] == "accepted"


def test_of_two_clients_that_edit_at_once_one_wins_and_nothing_is_lost(accepted: Any, agent_of: Any) -> None:
    rounds = 6
    with agent_of(accepted.workspace) as other:
        for k in range(rounds):
            revision = accepted.call("inspect_world", world="w")["revision"]
            barrier, answers = Barrier(2), []

            def work(
                agent: Any, name: str, k: int = k, revision: int = revision, barrier: Any = barrier, answers: Any = answers
            ) -> None:
                barrier.wait()
                change = [{"op": "add", "path": f"/story/requirements/{name}{k}", "value": REQUIREMENT}]
                answers.append(agent.result("edit_spec", world="w", patch=change, expected_revision=revision))

            threads = [Thread(target=work, args=pair) for pair in ((accepted, "one"), (other, "two"))]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            texts = [a.content[0].text for a in answers if a.is_error]
            assert len(texts) == 1, texts
            assert texts[0].startswith("refused: ")
            assert "read it again" in texts[0]
        requirements = accepted.call("inspect_world", world="w", part="spec", pointer="/story/requirements")["value"]
        assert len(requirements) == rounds
        assert accepted.call("inspect_world", world="w")["revision"] == 1 + rounds


REQUIREMENT = {"text": "t", "predicate": {"kind": "speed", "entity": "ball", "max": 50, "when": "always"}}


def test_two_clients_that_build_at_once_do_not_disturb_each_other(accepted: Any, agent_of: Any) -> None:
    import shutil

    with agent_of(accepted.workspace) as other:
        for _ in range(2):
            shutil.rmtree(accepted.workspace / "w" / "built")
            barrier, answers = Barrier(2), []

            def work(agent: Any, barrier: Any = barrier, answers: Any = answers) -> None:
                barrier.wait()
                answers.append(agent.result("place_object", world="w"))

            threads = [Thread(target=work, args=(a,)) for a in (accepted, other)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            assert not any(a.is_error for a in answers), [a.content[0].text for a in answers]


@pytest.mark.parametrize(
    ("pointer", "value", "rows"),
    [("/entities/b1/role", "dining table", {"scale:b1"}), ("/title", "Another title", set())],
    ids=["a role", "a title"],
)
def test_words_that_change_after_acceptance_close_the_film_as_inspect_says(
    accepted: Any, pointer: str, value: str, rows: set[str]
) -> None:
    """A role is judged (`scale:kind`), and a verdict prints what it is about: neither is about another specification."""
    assert accepted.call("inspect_world", world="w")["next"] == "render_shot(world='w', kind='final')"
    data = accepted.edit((pointer, value))
    assert {"acceptance", "final"} <= set(data["stale"])
    assert data["rows_now_stale"] > 0
    assert rows <= _stale(accepted)
    assert data["next"] == "run_checks(world='w', scope='acceptance')"
    told = accepted.call("inspect_world", world="w", part="acceptance")
    assert "this verdict is not about it" in told["warnings"][0]
    text = accepted.refused("render_shot", world="w", kind="final")
    assert f"about revision 1, and there changed since {pointer}" in text
    accepted.edit((pointer, small_spec()["entities"]["b1"]["role"] if "role" in pointer else small_spec()["title"]))
    assert "warnings" not in accepted.call("inspect_world", world="w", part="acceptance") or "stands" in str(
        accepted.call("inspect_world", world="w", part="acceptance")["warnings"]
    )


def test_an_edit_of_the_light_leaves_the_verdict_and_inspect_says_so(accepted: Any) -> None:
    accepted.edit(("/look/exposure", 0.5))
    told = accepted.call("inspect_world", world="w", part="acceptance")
    assert "the verdict stands" in told["warnings"][0]
    assert told["next"] == "render_shot(world='w', kind='final')"


def test_an_edit_that_takes_another_back_finds_the_step_that_is_open(accepted: Any) -> None:
    position = small_spec()["entities"]["b3"]["pose"]["position"]
    assert accepted.edit(("/entities/b3/pose/position/0", 0.2047))["next"].startswith("place_object")
    assert accepted.edit(("/entities/b3/pose/position", position))["next"] == "render_shot(world='w', kind='final')"

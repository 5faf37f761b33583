"""An agent with a shell: whatever it writes into the world folder, a verdict about something else does not follow."""

from __future__ import annotations

import json
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.execution import run_inline
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.verifiers.acceptance import REPLAY_INTERVALS, judge
from worldagent.verifiers.delivery.binding import replay_row
from worldagent.workflow.bundles import remember_refuted
from worldagent.worlds.baked import frame_digests
from worldagent.worlds.built import BuiltBody, BuiltEntity, load_built, save_built
from worldagent.worlds.cache import Cache, read_container, write_container
from worldagent.worlds.candidate import open_candidate
from worldagent.worlds.errors import EvidenceError, RefusedError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.ledger_file import put_seal

SEEDS = range(4)


def _sql(folder: Path, statement: str, *values: Any) -> None:
    with sqlite3.connect(folder / "ledger.sqlite") as db:
        db.execute(statement, values)
        db.execute("DELETE FROM meta")  # with a shell, the seals too
    db.close()


def _bake(folder: Path) -> Path:
    (found,) = (folder / "candidates").glob("*/bake/rigid")
    return found


def _record(folder: Path) -> Path:
    (found,) = (folder / "candidates").glob("*/candidate.json")
    return found


def _forge_frame(folder: Path, frame: int, *, digest: bool) -> None:
    """Lower the last block by a millimetre in one frame; with `digest`, record the forged frame's digest."""
    cache = Cache(_bake(folder))
    data = read_container(cache.path(frame))
    row = cache.index.bodies.index("b3/body")
    data["position"][row, 2] -= 1e-3
    found = write_container(cache.path(frame), data)
    if digest:
        digests = cache.digests()
        digests[frame] = found
        (cache.folder / "digests.txt").write_text("\n".join(digests) + "\n")


def _open(record: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {r["id"]: r for r in record["rows"] if r["mandatory"] and r["status"] in ("fail", "unverified")}


@pytest.mark.slow
def test_statuses_written_into_the_ledger_open_nothing(failed: Any) -> None:
    folder = failed.workspace / "w"
    with sqlite3.connect(folder / "ledger.sqlite") as db:
        for row_id, text in db.execute("SELECT id, row FROM matrix").fetchall():
            row = {**json.loads(text), "status": "pass"}
            db.execute("UPDATE matrix SET status='pass', row=? WHERE id=?", (json.dumps(row), row_id))
        db.execute("DELETE FROM history WHERE status='fail'")
        db.execute("DELETE FROM meta")
    db.close()
    assert failed.call("inspect_world", world="w")["matrix"]["mandatory_open"] == 0
    assert "passing probe" in failed.refused("bake_sim", world="w")
    assert "complete bake" in failed.refused("run_checks", world="w", scope="acceptance")
    assert "not accepted" in failed.refused("render_shot", world="w", kind="final")


def test_a_probe_flipped_in_the_ledger_with_its_seal_made_anew_opens_no_bake(failed: Any) -> None:
    folder = failed.workspace / "w"
    ledger = Ledger(folder / "ledger.sqlite")
    (known,) = ledger.freezes()
    detail = {**known["detail"], "failing": []}
    ledger.put_freeze(known["freeze"], known["revision"], passed=True, detail=detail)
    text = failed.refused("bake_sim", world="w")
    assert "beat:fall" in text
    assert "call probe_sim first" in text
    kept = {i: ("pass", last) for i, (_, last) in detail["rows"]["mandatory"].items()}
    ledger.put_freeze(known["freeze"], known["revision"], passed=True, detail=detail | {"rows": {"last": 35, "mandatory": kept}})
    assert "beat:fall" in failed.refused("bake_sim", world="w"), "the matrix says so too"
    kept.pop("beat:roll")
    ledger.put_freeze(known["freeze"], known["revision"], passed=True, detail=detail | {"rows": {"last": 35, "mandatory": kept}})
    assert "beat:roll" in failed.refused("bake_sim", world="w"), "a row that the specification demands is missing"


def _forge_acceptance(folder: Path, change: Callable[[list[dict[str, Any]]], list[dict[str, Any]]]) -> None:
    """Rewrite the rows of the acceptance, whose word stays, with its seal."""
    with sqlite3.connect(folder / "ledger.sqlite") as db:
        number, freeze, subject, text = db.execute("SELECT n, freeze, subject, record FROM acceptances").fetchone()
        record = json.loads(text)
        new = json.dumps(record | {"rows": change(record["rows"])}, sort_keys=True)
        db.execute("UPDATE acceptances SET record=? WHERE n=?", (new, number))
        put_seal(db, f"acceptance:{number}", freeze, subject, "accepted", new)
    db.close()


def _with_open(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{**r, "status": "fail"} if r["id"] == "beat:fall" else r for r in rows]


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (_with_open, "beat:fall: fail, measured"),
        (lambda rows: [r for r in rows if r["id"] != "beat:fall"], "beat:fall: missing, although the specification demands it"),
        (lambda rows: [r for r in rows if r["check"] != "navigability"], "navigability: no row of this check"),
        (lambda rows: [r for r in rows if r["id"] != "delivery:replay"], "delivery:replay: missing"),
    ],
)
def test_an_acceptance_whose_rows_are_open_or_missing_opens_no_film(accepted: Any, change: Any, named: str) -> None:
    """The word `accepted` and every seal stand in the ledger."""
    _forge_acceptance(accepted.workspace / "w", change)
    text = accepted.refused("render_shot", world="w", kind="final")
    assert named in text
    assert "run_checks(world, scope='acceptance')" in text


def test_an_acceptance_beside_a_matrix_with_an_open_row_opens_no_film(accepted: Any) -> None:
    ledger = Ledger(accepted.workspace / "w" / "ledger.sqlite")
    row = next(r for r in ledger.rows() if r.id == "beat:fall")
    ledger.put_rows([row.model_copy(update={"status": "fail"})], revision=1, stage="full")
    assert "beat:fall: fail" in accepted.refused("render_shot", world="w", kind="final")


@pytest.mark.slow
def test_an_edited_frame_is_found_refused_and_baked_again(accepted: Any) -> None:
    folder = accepted.workspace / "w"
    _forge_frame(folder, 30, digest=False)
    ended = accepted.result("render_shot", world="w", kind="final", width=64, height=64, samples=1)
    assert ended.is_error
    assert "frame 30 was altered since acceptance" in ended.content[0].text
    verdict = accepted.call("run_checks", world="w", scope="acceptance")
    assert verdict["verdict"] == "incomplete"
    row = next(r for r in verdict["open_rows"] if r["id"] == "delivery:digests:rigid")
    assert row["frame"] == 30
    assert accepted.call("bake_sim", world="w")["passed"]
    assert not _open(judge(folder))


def test_swapped_frames_are_found(copy: Path) -> None:
    cache = Cache(_bake(copy))
    first, second = cache.path(20), cache.path(21)
    spare = first.with_name("spare")
    first.rename(spare)
    second.rename(first)
    spare.rename(second)
    assert _open(judge(copy, replay=False))["delivery:digests:rigid"]["first_failing_frame"] == 20


@pytest.mark.parametrize("frame", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (6, 18, 35))])
def test_a_frame_forged_with_its_digest_is_found_by_replay(copy: Path, frame: int) -> None:
    _forge_frame(copy, frame, digest=True)
    for seed in SEEDS:
        assert _replayed(copy, seed).first_failing_frame == frame
    found = _open(judge(copy, seed=SEEDS[-1]))
    assert found["delivery:replay"]["first_failing_frame"] == frame
    assert "delivery:digests:rigid" not in found


def _times_fifty(folder: Path) -> int:
    """Multiply the contact impulses of the first blow by fifty and mend the digest; returns the frame."""
    cache = Cache(_bake(folder))
    frame = next(k for k in range(1, cache.index.frames) if len(cache.read(k)["event/time"]))
    data = cache.read(frame)
    data["contact/impulse"] = data["contact/impulse"] * 50.0
    cache.begin_digests([write_container(cache.path(frame), data) if k == frame else d for k, d in enumerate(cache.digests())])
    return frame


def _name_what_is_there(folder: Path, *, seals: bool) -> None:
    """Have the ledger name the cache that is on disk; with `seals`, as the program itself would write it."""
    ledger, freeze = Ledger(folder / "ledger.sqlite"), json.loads(_record(folder).read_text())["freeze"]
    candidate, known = open_candidate(WorldFolder(folder), freeze, "full"), ledger.bake(freeze)
    assert known is not None
    detail = known["detail"] | {"frame_digests": frame_digests(candidate.caches)}
    ledger.put_bake(freeze, known["revision"], candidate.digest, detail)
    if not seals:
        _sql(folder, "DELETE FROM refuted")


def _replayed(folder: Path, seed: int, intervals: int = REPLAY_INTERVALS) -> Any:
    """Verdict on the bake of a replay that draws with this seed."""
    candidate = open_candidate(WorldFolder(folder), json.loads(_record(folder).read_text())["freeze"], "full")
    return replay_row(candidate, seed, intervals, (), lambda *_: None)[0]


@pytest.mark.slow
def test_impulses_times_fifty_with_a_mended_digest_are_refused_at_every_acceptance(
    copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cache is not the one that its ledger names, whichever intervals are drawn."""
    run_jobs_inline(monkeypatch)
    frame = _times_fifty(copy)
    for _ in range(2):
        verdict = run_inline("worldagent.workflow.jobs:accept", {"folder": str(copy)})
        assert verdict["verdict"] == "incomplete"
        assert "delivery:cache" in [r["id"] for r in verdict["open_rows"]]
    row = _open(judge(copy, replay=False))["delivery:cache"]
    assert row["first_failing_frame"] == frame
    assert row["evidence"]["recorded"][:16] in row["evidence"]["explanation"]
    assert row["evidence"]["present"][:16] in row["evidence"]["explanation"]
    checked = run_inline("worldagent.workflow.jobs:check", {"folder": str(copy), "scope": "full"})
    assert "delivery:cache" in [r["id"] for r in checked["open_rows"]]
    assert run_inline("worldagent.workflow.jobs:bake", {"folder": str(copy)})["passed"]
    assert run_inline("worldagent.workflow.jobs:accept", {"folder": str(copy)})["verdict"] == "accepted"


@pytest.mark.slow
def test_a_failed_replay_stays_with_the_cache_whatever_is_drawn_later(copy: Path) -> None:
    """The ledger is made to name the forged cache, seals and all: only simulating again tells, and only once is needed."""
    frame = _times_fifty(copy)
    _name_what_is_there(copy, seals=True)
    rows = {seed: _replayed(copy, seed, intervals=1) for seed in range(12)}
    hit = next(seed for seed, row in rows.items() if row.status == "fail")
    miss = next(seed for seed, row in rows.items() if row.status == "pass")
    assert "delivery:replay" not in _open(judge(copy, seed=miss, intervals=1))
    ledger, found = Ledger(copy / "ledger.sqlite"), judge(copy, seed=hit, intervals=1)
    remember_refuted(ledger, found)
    remember_refuted(ledger, judge(copy, seed=hit, intervals=1))
    (kept,) = ledger.refuted(found["freeze"])
    assert (kept["digest"], kept["first_different_frame"]) == (found["cache_digest"], frame)
    row = _open(judge(copy, seed=miss, intervals=1))["delivery:replay"]
    assert row["first_failing_frame"] == frame
    assert kept["frames"] in [i["frames"] for i in row["evidence"]["intervals"]]
    assert _open(judge(copy, replay=False))["delivery:replay"]["first_failing_frame"] == frame
    candidate = open_candidate(WorldFolder(copy), found["freeze"], "full")
    ledger.put_bake(found["freeze"], 1, candidate.digest, {"frame_digests": frame_digests(candidate.caches)})
    assert ledger.refuted(found["freeze"]) == []


@pytest.mark.slow
def test_a_record_of_the_bake_without_its_seals_has_every_interval_simulated_again(copy: Path) -> None:
    _sql(copy, "DELETE FROM refuted")
    assert _open(judge(copy, replay=False)).keys() == {"delivery:cache"}
    found = judge(copy, intervals=1)
    assert not _open(found)
    row = next(r for r in found["rows"] if r["id"] == "delivery:replay")
    assert [i["frames"] for i in row["evidence"]["intervals"]] == [[0, 0], [0, 12], [12, 24], [24, 35]]
    _times_fifty(copy)
    _name_what_is_there(copy, seals=False)
    assert _open(judge(copy, seed=SEEDS[0], intervals=1)).keys() >= {"delivery:cache", "delivery:replay"}


@pytest.mark.slow
def test_a_folder_without_its_ledger_is_unverified_unless_all_of_it_is_simulated_again(copy: Path) -> None:
    (copy / "ledger.sqlite").unlink()
    row = _open(judge(copy, intervals=1))["delivery:cache"]
    assert (row["status"], row["measured"]) == ("unverified", None)
    assert not _open(judge(copy, intervals=10**6))
    assert not (copy / "ledger.sqlite").exists()


@pytest.mark.slow
@pytest.mark.parametrize("frame", [0, 12, 24])
def test_an_edited_checkpoint_is_found_by_replay(copy: Path, frame: int) -> None:
    path = _bake(copy) / "checkpoints" / f"{frame:06d}.bin"
    data = bytearray(path.read_bytes())
    # The last doubles of a state: velocities or warm starts of the last body.
    values = np.frombuffer(bytes(data[-80:]), dtype=np.float64).copy() + 1e-3
    data[-80:] = values.tobytes()
    path.write_bytes(bytes(data))
    assert "delivery:replay" in _open(judge(copy))


@pytest.mark.slow
def test_a_checkpoint_that_is_none_is_an_error_of_the_engine_or_evidence(copy: Path) -> None:
    path = _bake(copy) / "checkpoints" / "000012.bin"
    path.write_bytes(b"nothing")
    found = judge_or_error(copy)
    assert found != "accepted"
    path.unlink()
    assert "checkpoint" in judge_or_error(copy)


def judge_or_error(folder: Path) -> str:
    from worldagent.worlds.errors import WorldAgentError

    try:
        return str(judge(folder)["verdict"])
    except WorldAgentError as error:
        return str(error)


@pytest.mark.slow
def test_another_run_in_place_of_the_baked_one_is_found(copy: Path, failed_folder: Path) -> None:
    """The frames, digests and checkpoints of a whole other simulation, consistent in themselves."""
    from worldagent.simulation.schedule import run_frames

    folder = WorldFolder(copy)
    freeze = json.loads(_record(copy).read_text())["freeze"]
    candidate = open_candidate(folder, freeze, "full")
    ball = candidate.spec.entities["ball"]
    faster = ball.model_copy(update={"physics": ball.physics.model_copy(update={"linear_velocity": (1.02, 0.0, 0.0)})})
    spec = candidate.spec.model_copy(update={"entities": {**candidate.spec.entities, "ball": faster}})
    bake = _bake(copy)
    index = (bake / "index.json").read_text()
    shutil.rmtree(bake)
    run_frames(spec, candidate.built, bake.parent, frames=36)
    (bake / "index.json").write_text(index)
    found = _open(judge(copy))
    assert found["delivery:replay"]["first_failing_frame"] == 0


@pytest.mark.slow
def test_an_index_that_renames_bodies_is_found(copy: Path) -> None:
    path = _bake(copy) / "index.json"
    data = json.loads(path.read_text())
    data["bodies"] = [{"b1/body": "b2/body", "b2/body": "b1/body"}.get(b, b) for b in data["bodies"]]
    path.write_text(json.dumps(data))
    assert "delivery:replay" in _open(judge(copy))


def test_an_index_edited_after_acceptance_closes_final(accepted: Any) -> None:
    path = _bake(accepted.workspace / "w") / "index.json"
    path.write_text(path.read_text().replace('"fps": 24', '"fps": 25'))
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")


def test_a_weakened_specification_in_the_candidate_is_not_the_worlds(copy: Path) -> None:
    path = _record(copy)
    record = json.loads(path.read_text())
    record["spec"]["story"]["beats"]["fall"]["predicate"]["min"] = 0.01
    path.write_text(json.dumps(record))
    with pytest.raises(RefusedError, match="no candidate holds this specification"):
        judge(copy)


def test_a_decoy_record_cannot_have_a_weakened_candidate_judged(copy: Path) -> None:
    """One record holds the true specification but names the freeze of another whose specification is weakened."""
    path = _record(copy)
    decoy = copy / "candidates" / "0000000000000000" / "candidate.json"
    decoy.parent.mkdir()
    shutil.copy(path, decoy)
    record = json.loads(path.read_text())
    record["spec"]["story"]["beats"]["fall"]["predicate"]["min"] = 0.01
    path.write_text(json.dumps(record))
    with pytest.raises(RefusedError, match="no candidate holds this specification"):
        judge(copy)


def test_a_weakened_world_json_beside_the_candidate_is_refused(copy: Path) -> None:
    path = copy / "world.json"
    document = json.loads(path.read_text())
    document["simulation"]["limits"]["max_speed"] = 100.0
    path.write_text(json.dumps(document))
    with pytest.raises(RefusedError, match="no candidate holds this specification"):
        judge(copy)


def test_an_acceptance_of_something_else_does_not_open_final(accepted: Any) -> None:
    folder = accepted.workspace / "w"
    accepted.edit(("/story/beats/fall/predicate/min", 0.28))
    for subject in ("", "x", "0" * 64):
        _sql(
            folder,
            "INSERT INTO acceptances (freeze, revision, subject, verdict, record, at) "
            "SELECT freeze, 2, ?, 'accepted', record, at FROM acceptances LIMIT 1",
            subject,
        )
    assert accepted.call("inspect_world", world="w")["last_verdict"]["verdict"] == "accepted"
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")


def _heavier(path: Path) -> None:
    found = load_built(path)
    (body,) = found.bodies
    heavy = BuiltBody(body.name, body.pose, body.mass * 3, body.center, body.inertia * 3, body.volume)
    save_built(BuiltEntity(found.entity, (heavy,), found.parts, found.recipe), path)


def test_a_built_file_replaced_after_the_freeze_is_found(copy: Path) -> None:
    _heavier(next((copy / "built").glob("ball.*.zip")))
    with pytest.raises(EvidenceError, match="'ball' was altered since the freeze"):
        judge(copy)


@pytest.mark.slow
def test_a_built_file_replaced_before_the_probe_is_found_at_acceptance(accepted: Any) -> None:
    built = accepted.workspace / "w" / "built"
    _heavier(next(built.glob("ball.*.zip")))
    assert accepted.call("probe_sim", world="w")["passed"]
    accepted.call("bake_sim", world="w")
    answer = accepted.result("run_checks", world="w", scope="acceptance")
    assert answer.is_error
    assert "geometry of 'ball' is not what the specification gives" in answer.content[0].text
    assert accepted.call("place_object", world="w")["built"] == ["ball"]
    assert judge(accepted.workspace / "w", replay=False)["verdict"] == "accepted"


def test_a_link_out_of_the_folder_is_found(copy: Path, tmp_path: Path) -> None:
    (copy / "assets" / "far.obj").symlink_to(tmp_path)
    assert _open(judge(copy, replay=False))["delivery:independent"]["evidence"]["links"] == ["assets/far.obj"]


def test_a_missing_frame_is_found(copy: Path) -> None:
    Cache(_bake(copy)).path(17).unlink()
    assert judge_or_error(copy) != "accepted"

"""The tool job, and what the replies of long tools say about jobs."""

import os
import signal
import sqlite3
import time
from contextlib import closing
from dataclasses import replace

import pytest
from worldagent.execution import BULK, INTERACTIVE, JobStore, Terms
from worldagent.tests.execution.conftest import LONG_S
from worldagent.tools.job import job
from worldagent.workflow import jobs as entries
from worldagent.workflow import waiting
from worldagent.workflow.job_kinds import KINDS, again
from worldagent.worlds.errors import InputError

E = "execution_entries:"
TERRAIN = "build_terrain(world='w', terrain='isle', entity='ground')"


@pytest.fixture
def gate(context, tmp_path):
    """A job that runs until the test opens its gate; the gate."""
    path = tmp_path / "gate"
    yield path
    path.touch()
    for left in context.jobs.list(state=["queued", "running"], limit=100):
        assert context.jobs.wait(left.id, LONG_S).ended


def _gated(context, gate, world="w", kind="bake", **payload):
    return context.jobs.submit(kind, world, {"gate": str(gate), **payload}, entry=E + "gated", terms=Terms(exclusive=True))


def _until(condition):
    deadline = time.monotonic() + LONG_S
    while not (value := condition()):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return value


def test_status_of_a_running_job_tells_what_it_does_and_the_next_call(context, gate):
    made = _gated(context, gate)
    _until(lambda: context.jobs.get(made.id).message)
    data = job(context, "status", job_id=made.id).data
    assert data["state"] == "running"
    assert data["progress"] == 0.5
    assert data["message"] == "at the gate"
    assert data["summary"].startswith("bake of w is running, 50 % after ")
    assert data["next"] == f"job(action='wait', job_id={made.id!r})"
    assert "log" not in data


def test_detail_adds_times_caps_and_use(context, gate):
    made = _gated(context, gate, kind="other", scope="full")
    gate.touch()
    context.jobs.wait(made.id, LONG_S)
    data = job(context, "status", job_id=made.id, detail=True).data
    assert data["asked"] == {"gate": str(gate), "scope": "full"}
    assert data["peak_memory_gb"] > 0
    assert data["cpu_s"] >= 0
    assert data["submitted"] <= data["started"] <= data["ended"]
    assert (context.workspace / data["log"]).is_file()


def test_a_queued_job_says_how_many_are_ahead_and_why_it_waits(context, gate):
    running, first, second = (_gated(context, gate) for _ in range(3))
    data = job(context, "status", job_id=second.id).data
    assert data["message"] == f"1 job ahead; world busy with bake {running.id}"
    assert job(context, "status", job_id=first.id).data["message"] == f"world busy with bake {running.id}"


def test_the_time_left_is_told_in_words_and_seconds(context, gate):
    made = _gated(context, gate)
    _until(lambda: context.jobs.get(made.id).message)
    for left, words in ((0.2, "1 s"), (40.4, "40 s"), (89, "89 s"), (200, "3 min"), (5000, "83 min"), (9000, "2 h 30 min")):
        seen = replace(context.jobs.get(made.id), left_s=left, message="frame 120 of 240")
        data = waiting.job_data(seen, context.jobs)
        assert data["message"] == f"frame 120 of 240, about {words} left"
        assert data["left_s"] == pytest.approx(left)


def test_wait_ends_with_the_job_and_gives_its_result(context, gate, told):
    made = _gated(context, gate, kind="other")
    _until(lambda: context.jobs.get(made.id).message == "at the gate")
    before = time.monotonic()
    waited = job(context, "wait", job_id=made.id, wait_s=0.6).data
    assert waited["state"] == "running"
    assert time.monotonic() - before < 10
    gate.touch()
    assert job(context, "wait", job_id=made.id, wait_s=200).data["result"] == {"through": True}
    assert any(message == "other: at the gate" for _, _, message in told)


def test_no_call_waits_longer_than_clients_do(monkeypatch):
    monkeypatch.delenv(waiting.ENV_WAIT, raising=False)
    assert waiting.patience(240.0) == waiting.WAIT_MAX_S < 60
    assert waiting.patience(5.0) == 5.0
    monkeypatch.setenv(waiting.ENV_WAIT, "200")
    assert waiting.patience(240.0) == 200.0


def test_a_wait_that_was_cut_short_says_so_and_by_what(context, gate, monkeypatch):
    monkeypatch.setenv(waiting.ENV_WAIT, "0.2")
    made = _gated(context, gate)
    assert job(context, "wait", job_id=made.id, wait_s=0.1).data["warnings"] == []
    (told,) = job(context, "wait", job_id=made.id, wait_s=200).data["warnings"]
    assert "waited 0.2 s of wait_s=200" in told
    assert waiting.ENV_WAIT in told


def test_a_waiting_call_gives_a_sign_of_life_where_nothing_moves(context, gate, told, monkeypatch):
    monkeypatch.setattr(waiting, "POLL_S", 0.02)
    monkeypatch.setattr(waiting, "SIGN_S", 0.1)
    made = _gated(context, gate)
    _until(lambda: context.jobs.get(made.id).message)
    waiting.follow(context, made, 1.0)
    assert len(told) >= 4
    assert len(told) < 30  # but not at every look


def test_a_client_that_goes_away_stops_waiting_and_not_the_job(context, gate):
    made = _gated(context, gate)
    gone = replace(context, cancelled=lambda: True)
    assert job(gone, "wait", job_id=made.id, wait_s=60).data["state"] in ("queued", "running")
    assert not context.jobs.get(made.id).ended


def test_lists_are_paged_and_filtered(context, gate):
    running = _gated(context, gate)
    queued = [_gated(context, gate, world="v") for _ in range(4)]
    context.jobs.request_cancel(queued[0].id)
    data = job(context, "list", limit=2).data
    assert [j["job_id"] for j in data["jobs"]] == [queued[3].id, queued[2].id]
    assert data["total"] == 5
    assert data["next_offset"] == 2
    rest = job(context, "list", limit=3, offset=2).data
    assert [j["job_id"] for j in rest["jobs"]] == [queued[1].id, queued[0].id, running.id]
    assert "next_offset" not in rest
    assert rest["next"] == f"job(action='wait', job_id={running.id!r})"
    with pytest.raises(InputError, match="offset is 0 to 4"):
        job(context, "list", offset=5)
    chosen = job(context, "list", states=["running", "cancelled"]).data
    assert {j["job_id"] for j in chosen["jobs"]} == {running.id, queued[0].id}
    assert job(context, "list", world="v", states=["queued"]).data["total"] == 3


def test_a_missing_or_unknown_id_gets_the_known_ones(context, gate):
    made = _gated(context, gate)
    with pytest.raises(InputError, match=rf"needs job_id; the newest are {made.id} \(bake, "):
        job(context, "wait")
    with pytest.raises(InputError, match=rf"no job 'job_none' in this workspace; the newest are {made.id} \(bake, "):
        job(context, "status", job_id="job_none")


def test_cancel_answers_with_the_end_and_the_call_that_goes_on(context, gate):
    made = _gated(context, gate)
    data = job(context, "cancel", job_id=made.id).data
    assert data["state"] == "cancelled"
    assert data["next"] == "bake_sim(world='w')"
    assert data["summary"] == "bake of w: cancelled; the next call goes on from the last checkpoint of the bake"


def test_a_lost_job_offers_the_exact_next_call(context, gate):
    made = _gated(context, gate, kind="check", scope="full", only=["beat"])
    running = _until(lambda: (row := context.jobs.get(made.id)).task_pid and row)
    os.kill(running.pid, signal.SIGKILL)
    data = _until(lambda: (found := job(context, "status", job_id=made.id).data)["state"] == "lost" and found)
    assert data["next"] == "run_checks(world='w', scope='full', only=['beat'])"
    assert "gone" in data["error"]["message"]


@pytest.mark.parametrize(
    ("kind", "payload", "call"),
    [
        ("probe", {}, "probe_sim(world='w')"),
        ("bake", {}, "bake_sim(world='w')"),
        ("terrain", {"terrain": "isle", "entity": "ground", "size": None, "hypothesis": ""}, TERRAIN),
        ("accept", {"revision": 3}, "run_checks(world='w', scope='acceptance')"),
        ("check", {"scope": "probe", "only": None}, "run_checks(world='w', scope='probe')"),
        ("final", {"width": 64, "height": None, "samples": 4}, "render_shot(world='w', kind='final', width=64, samples=4)"),
    ],
)
def test_every_kind_names_the_call_that_does_its_work_again(context, gate, kind, payload, call):
    made = _gated(context, gate, kind=kind, **payload)
    assert again(made).call == ""
    for state in ("lost", "cancelled"):
        assert again(replace(made, state=state)).call == call


def test_every_entry_of_the_jobs_has_a_kind_and_looks_come_before_films():
    assert set(KINDS) == set(entries.__all__)
    assert KINDS["check"].priority == INTERACTIVE > KINDS["probe"].priority > KINDS["final"].priority == BULK


def test_a_queued_job_is_started_by_whoever_looks_after_a_restart(context, gate):
    """The server and the worker that would have started it are gone: nothing runs, one job waits."""
    first, queued = _gated(context, gate), _gated(context, gate)
    running = _until(lambda: (row := context.jobs.get(first.id)).task_pid and row)
    os.kill(running.pid, signal.SIGKILL)
    with closing(sqlite3.connect(context.workspace / ".worldagent" / "jobs.db")) as connection:
        assert connection.execute("SELECT state FROM jobs WHERE id = ?", (queued.id,)).fetchone() == ("queued",)
    restarted = replace(context, jobs=JobStore(context.workspace, slots=1))
    listed = {j["job_id"]: j["state"] for j in _until(lambda: _lost(restarted, first.id))}
    assert listed == {first.id: "lost", queued.id: "running"}


def _lost(context, job_id):
    found = job(context, "list").data["jobs"]
    return found if any(j["job_id"] == job_id and j["state"] == "lost" for j in found) else None

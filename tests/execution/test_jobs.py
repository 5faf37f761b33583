"""Jobs: submission, results, errors, progress, order. Own choices unless a test says otherwise."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from worldagent.execution import Cancelled, JobStore, Terms, result_of, run_inline
from worldagent.execution.table import JobTable
from worldagent.tests.execution.conftest import LONG_S
from worldagent.worlds.errors import EngineError, InputError, LimitError, RefusedError, SpecError
from worldagent.worlds.limits import CAPS

E = "execution_entries:"


def test_a_job_runs_in_another_process_and_its_result_comes_back(store):
    job = store.submit("echo", "isle", {"x": [1, 2.5, None]}, entry=E + "echo")
    done = store.wait(job.id, LONG_S)
    assert done.state == "done"
    result = result_of(done)
    assert result["payload"] == {"x": [1, 2.5, None]}
    assert result["pid"] not in (os.getpid(), done.pid)
    assert result["job"] == job.id
    assert result["workspace"] == str(store.workspace)
    assert done.created <= done.started <= done.finished
    assert store.log_path(done).is_file()


def test_the_worker_is_no_child_of_the_submitter(store, tmp_path, until):
    """A client that kills its server's process tree, by parent or by group, must not meet the worker."""
    job = store.submit("gated", None, {"gate": str(tmp_path / "gate")}, entry=E + "gated")
    running = until(lambda: (row := store.get(job.id)).task_pid and row)
    family = {os.getsid(pid) for pid in (running.pid, running.task_pid)}
    assert family == {running.pid}
    stat = Path(f"/proc/{running.pid}/stat").read_text().rpartition(")")[2].split()
    assert int(stat[1]) != os.getpid()
    (tmp_path / "gate").touch()
    assert store.wait(job.id, LONG_S).state == "done"


def test_a_job_survives_the_submitting_process_being_killed(store, tmp_path, until):
    script = (
        "import sys, pathlib, time; from worldagent.execution import JobStore\n"
        "job = JobStore(pathlib.Path(sys.argv[1])).submit('g', None, {'gate': sys.argv[2]}, entry='execution_entries:gated')\n"
        "print(job.id, flush=True); time.sleep(60)"
    )
    command = [sys.executable, "-c", script, str(tmp_path), str(tmp_path / "gate")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as server:
        job_id = server.stdout.readline().strip()
        until(lambda: store.get(job_id).message == "at the gate")
        os.killpg(server.pid, signal.SIGKILL)
    assert store.get(job_id).state == "running"
    (tmp_path / "gate").touch()
    assert result_of(store.wait(job_id, LONG_S)) == {"through": True}


def test_a_restarted_server_sees_running_jobs(store, tmp_path, until):
    job = store.submit("gated", "isle", {"gate": str(tmp_path / "gate")}, entry=E + "gated")
    until(lambda: store.get(job.id).progress_done == 1)
    again = JobStore(tmp_path, slots=2)
    (seen,) = again.list(world="isle", state="running")
    assert seen.id == job.id
    (tmp_path / "gate").touch()
    assert again.wait(job.id, LONG_S).state == "done"


def test_the_same_key_gives_the_same_job_while_queued_running_or_done(store, tmp_path):
    payload = {"gate": str(tmp_path / "gate")}
    first = store.submit("gated", "isle", payload, entry=E + "gated", terms=Terms(key="abc"))
    assert store.submit("gated", "isle", payload, entry=E + "gated", terms=Terms(key="abc")).id == first.id
    assert store.submit("gated", "other", payload, entry=E + "gated", terms=Terms(key="abc")).id != first.id
    (tmp_path / "gate").touch()
    store.wait(first.id, LONG_S)
    assert store.submit("gated", "isle", payload, entry=E + "gated", terms=Terms(key="abc")).id == first.id


def test_a_failed_job_is_run_anew(store):
    first = store.submit("bad", "isle", {"what": "spec"}, entry=E + "raises", terms=Terms(key="abc"))
    assert store.wait(first.id, LONG_S).state == "failed"
    second = store.submit("bad", "isle", {"what": "spec"}, entry=E + "raises", terms=Terms(key="abc"))
    assert second.id != first.id


@pytest.mark.parametrize(
    ("what", "error", "kind", "text"),
    [
        ("spec", "SpecError", SpecError, "mass -1 kg must be > 0"),
        ("zero", "ZeroDivisionError", EngineError, "ZeroDivisionError: division by zero"),
        ("nan", "EngineError", EngineError, "not plain JSON data"),
    ],
)
def test_an_entry_fails_alike_in_a_job_and_inline(store, what, error, kind, text):
    job = store.wait(store.submit("bad", None, {"what": what}, entry=E + "raises").id, LONG_S)
    assert job.state == "failed"
    assert job.error["type"] == error
    assert "Traceback" not in job.error["message"]
    assert "Traceback" in store.log_path(job).read_text()
    with pytest.raises(kind, match=text) as in_job:
        result_of(job)
    with pytest.raises(kind, match=text) as inline:
        run_inline(E + "raises", {"what": what})
    assert str(in_job.value) == str(inline.value)
    assert type(in_job.value) is type(inline.value)


def test_an_entry_that_exits_has_failed(store):
    job = store.wait(store.submit("bad", None, {"what": "exit"}, entry=E + "raises").id, LONG_S)
    assert (job.state, job.error["type"]) == ("failed", "SystemExit")


def test_progress_is_visible_and_never_falls(store, tmp_path, until):
    job = store.submit("count", None, {"steps": 3, "gates": str(tmp_path / "gate")}, entry=E + "counting")
    seen = []
    for step in range(1, 5):
        message = f"step {step}" if step < 4 else "a step back"
        until(lambda message=message: seen.append(store.get(job.id)) or seen[-1].message == message)
        (tmp_path / f"gate{step}").touch()
    seen.append(store.wait(job.id, LONG_S))
    numbers = [row.progress_done for row in seen]
    assert numbers == sorted(numbers)
    assert {1, 2, 3} <= set(numbers)
    assert seen[-1].progress_done == seen[-1].progress_total == 3
    assert seen[-1].message == "a step back"


def test_a_job_knows_how_long_one_like_it_took(store, tmp_path, until):
    def start(name):
        payload = {"steps": 4, "gates": str(tmp_path / name)}
        return store.submit("count", "w", payload, entry=E + "stepped")

    def go_on(job, name, step):
        until(lambda: store.get(job.id).message == f"step {step}")
        (tmp_path / f"{name}{step}").touch()

    first = start("a")
    for step in range(5):
        go_on(first, "a", step)
    assert store.wait(first.id, LONG_S).state == "done"
    pace = JobTable(store.workspace).latest_pace(first)
    assert len(pace) == 21
    assert pace == sorted(pace)
    assert pace[-1] > 0
    assert JobTable(store.workspace).latest_pace(replace(first, world="another")) is None
    assert JobTable(store.workspace).latest_pace(replace(first, payload={**first.payload, "only": ["causal"]})) is None
    told = []
    for name in "bcd":  # who looks late finds a job in which nothing has moved for long, and that is not like the first
        job = start(name)
        told.append(
            until(lambda job=job: (row := store.get(job.id)).message == "step 0" and row).left_s
        )  # the rate needs two steps
        for step in range(5):
            go_on(job, name, step)
        assert store.wait(job.id, LONG_S).state == "done"
    assert max(left or 0 for left in told) > 0


def test_progress_inline_goes_to_the_caller_and_cancel_comes_from_it(tmp_path):
    seen = []
    run_inline(E + "counting", {"steps": 2}, on_progress=seen.append)
    assert [p.done for p in seen] == [1, 2, 2]
    with pytest.raises(Cancelled):
        run_inline(E + "cooperative", {"tidied": str(tmp_path / "tidied")}, cancel_asked=lambda: True)


def test_exclusive_jobs_of_one_world_run_one_after_another_and_others_beside(tmp_path):
    store, gate = JobStore(tmp_path, slots=4), str(tmp_path / "gate")
    jobs = [
        store.submit(
            "alone", world, {"inside": str(tmp_path / world), "gate": gate}, entry=E + "alone", terms=Terms(exclusive=True)
        )
        for world in ("a", "a", "a", "b")
    ]
    assert [job.state for job in jobs] == ["running", "queued", "queued", "running"]
    (tmp_path / "gate").touch()
    ended = [store.wait(job.id, LONG_S) for job in jobs]
    assert [job.state for job in ended] == ["done"] * 4
    first, second, third = ended[:3]
    assert first.finished <= second.started
    assert second.finished <= third.started


def test_no_more_jobs_run_than_there_are_slots_and_priority_goes_first(tmp_path):
    store = JobStore(tmp_path, slots=1)
    gate = {"gate": str(tmp_path / "gate")}
    first, low, high = (store.submit("g", None, gate, entry=E + "gated", terms=Terms(priority=p)) for p in (0, 0, 5))
    assert [store.get(job.id).state for job in (first, low, high)] == ["running", "queued", "queued"]
    (tmp_path / "gate").touch()
    first, low, high = (store.wait(job.id, LONG_S) for job in (first, low, high))
    assert first.finished <= high.started
    assert high.finished <= low.started


def test_many_cores_do_not_mean_as_many_jobs(tmp_path, monkeypatch):
    monkeypatch.setattr("worldagent.execution.jobs.core_count", lambda: 3)
    assert JobStore(tmp_path).slots == 3
    monkeypatch.setattr("worldagent.execution.jobs.core_count", lambda: 128)
    assert JobStore(tmp_path).slots == CAPS["running_jobs"].value == 16


def test_a_worker_that_ends_starts_the_next_job_without_any_server(tmp_path, until):
    store = JobStore(tmp_path, slots=1)
    jobs = [store.submit("echo", None, {}, entry=E + "echo") for _ in range(3)]

    def states():
        with closing(sqlite3.connect(tmp_path / ".worldagent" / "jobs.db", timeout=3)) as connection:
            return {state for (state,) in connection.execute("SELECT state FROM jobs")}

    until(lambda: states() == {"done"})
    assert len({result_of(store.get(job.id))["pid"] for job in jobs}) == 3


def test_processes_that_submit_at_the_same_time_lose_nothing(tmp_path):
    script = (
        "import sys, pathlib, json; from worldagent.execution import JobStore, Terms\n"
        "s = JobStore(pathlib.Path(sys.argv[1]), slots=2)\n"
        "own = [s.submit('e', 'w', {'k': k}, entry='execution_entries:echo') for k in range(6)]\n"
        "one = [s.submit('e', 'w', {'k': k}, entry='execution_entries:echo', terms=Terms(key=f'k{k}')) for k in range(4)]\n"
        "print(json.dumps([[j.id for j in own], [j.id for j in one]]))"
    )
    servers = [
        subprocess.Popen([sys.executable, "-c", script, str(tmp_path)], stdout=subprocess.PIPE, text=True) for _ in range(2)
    ]
    outputs = []
    for server in servers:
        with server:
            outputs.append(json.loads(server.stdout.read()))
        assert server.returncode == 0
    store = JobStore(tmp_path, slots=2)
    (own_a, one_a), (own_b, one_b) = outputs
    assert one_a == one_b
    ids = {*own_a, *own_b, *one_a}
    assert len(ids) == 16
    assert {job.id for job in store.list(limit=100)} == ids
    ended = [store.wait(job_id, LONG_S) for job_id in sorted(ids)]
    assert {job.state for job in ended} == {"done"}
    assert len({(result_of(job)["pid"], job.id) for job in ended}) == 16
    for job in ended:
        others = [o for o in ended if o.started < job.started < o.finished]
        assert len(others) < 2


def test_code_outside_the_package_is_refused(store, monkeypatch):
    for entry in ("os:system", "subprocess:run", "worldagentx.jobs:run", "numpy.f2py:main"):
        with pytest.raises(RefusedError, match="outside"):
            store.submit("x", None, {}, entry=entry)
    for entry in ("worldagent.execution", "worldagent..x:f", "../x:f", "worldagent.x:f;g", ""):
        with pytest.raises(InputError):
            store.submit("x", None, {}, entry=entry)
    for entry in ("worldagent.execution.launch:subprocess", "worldagent.execution.processes:nothing"):
        with pytest.raises(InputError, match="no function"):
            run_inline(entry, {})
    with pytest.raises(RefusedError, match="outside"):
        run_inline("worldagent.execution.job:dataclass", {})
    monkeypatch.delenv("WORLDAGENT_TEST_ENTRIES")
    with pytest.raises(RefusedError, match="outside"):
        store.submit("x", None, {}, entry=E + "echo")
    assert store.list() == ()


def test_a_row_that_names_foreign_code_is_not_run(store, monkeypatch):
    """The worker checks for itself: jobs.db is a file that others may write."""
    job = store.submit("echo", None, {}, entry=E + "echo", terms=Terms(key="k"))
    store.wait(job.id, LONG_S)
    with closing(sqlite3.connect(store.workspace / ".worldagent" / "jobs.db")) as connection, connection:
        connection.execute("UPDATE jobs SET entry = 'os:abort', state = 'queued', pid = NULL, finished = NULL")
    ended = store.wait(job.id, LONG_S)
    assert (ended.state, ended.error["type"]) == ("failed", "RefusedError")


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "../up"},
        {"world": ""},
        {"payload": {"x": float("inf")}},
        {"payload": {"x": object()}},
        {"terms": Terms(exclusive=True), "world": None},
    ],
)
def test_arguments_out_of_range_are_named(store, change):
    arguments = {"kind": "echo", "world": "w", "payload": {}, "entry": E + "echo", **change}
    with pytest.raises(InputError):
        store.submit(**arguments)


@pytest.mark.parametrize("change", [{"key": "k" * 201}, {"wall_s": 0.0}, {"memory_bytes": 1000}])
def test_terms_out_of_range_are_named(change):
    with pytest.raises(InputError, match=next(iter(change))):
        Terms(**change)


def test_ids_that_are_none_are_refused(store):
    known = store.submit("echo", None, {}, entry=E + "echo")
    for job_id in ("job_000000000000", "../jobs", ""):
        with pytest.raises(InputError, match=rf"no job .*; the newest are {known.id} \(echo"):
            store.get(job_id)
    assert store.wait(known.id, LONG_S).state == "done"


def test_a_large_payload_is_refused_with_cap_and_size(store):
    with pytest.raises(LimitError, match="4000000"):
        store.submit("echo", None, {"x": "y" * 4_000_001}, entry=E + "echo")


def test_lists_are_paged_newest_first(tmp_path):
    store = JobStore(tmp_path, slots=1)
    jobs = [store.submit("echo", f"w{k % 2}", {}, entry=E + "echo") for k in range(4)]
    assert [job.id for job in store.list(limit=2, offset=1)] == [jobs[2].id, jobs[1].id]
    assert [job.id for job in store.list(world="w0")] == [jobs[2].id, jobs[0].id]
    for job in jobs:
        assert store.wait(job.id, LONG_S).state == "done"


def test_waiting_ends_at_its_time_with_the_job_as_it_stands(store, tmp_path):
    job = store.submit("gated", None, {"gate": str(tmp_path / "gate")}, entry=E + "gated")
    before = time.monotonic()
    assert not store.wait(job.id, 0.2).ended
    assert time.monotonic() - before < 5
    with pytest.raises(EngineError, match="not done"):
        result_of(store.get(job.id))

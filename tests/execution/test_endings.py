"""Jobs that end otherwise than by themselves: cancelled, killed, over a cap."""

import os
import signal
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from worldagent.execution import Cancelled, Terms, machine_memory, memory_cap, result_of, wall_cap
from worldagent.execution.processes import is_alive, start_time
from worldagent.execution.schema import VERSION
from worldagent.execution.table import JobTable
from worldagent.tests.execution.conftest import LONG_S
from worldagent.worlds.errors import EngineError, InputError, LimitError

E = "execution_entries:"


def _running(store, until, entry, payload, *, at, **options):
    job = store.submit("task", "isle", payload, entry=E + entry, terms=Terms(**options))
    return until(lambda: (row := store.get(job.id)).progress_done >= at and row)


def test_a_cooperative_entry_stops_by_itself_and_tidies_up(store, tmp_path, until, in_time):
    def attempt(k):
        job = _running(store, until, "cooperative", {"tidied": str(tmp_path / f"tidied{k}")}, at=1)
        store.request_cancel(job.id)
        ended = store.wait(job.id, LONG_S)
        assert ended.state == "cancelled"
        with pytest.raises(Cancelled):
            result_of(ended)
        took = ended.finished - ended.cancel_requested
        assert (tmp_path / f"tidied{k}").exists() or took > 1.0
        return took

    in_time(attempt, 1.0)  # before the first signal


@pytest.mark.parametrize("deaf", [False, True])
def test_cancel_ends_native_code_within_two_seconds(store, until, in_time, deaf):
    """Brief: 2 s also where the entry never asks and, if deaf, ignores SIGTERM while it holds the interpreter lock."""

    def attempt(_):
        job = _running(store, until, "native_loop", {"deaf": deaf}, at=2)
        beats = {store.get(job.id).heartbeat}
        until(lambda: beats.add(store.get(job.id).heartbeat) or len(beats) >= 3)  # it says that it lives all the while
        store.request_cancel(job.id)
        ended = store.wait(job.id, LONG_S)
        assert ended.state == "cancelled"
        assert not is_alive(job.task_pid, job.task_started)
        return ended.finished - ended.cancel_requested

    in_time(attempt, 2.0)


def _children(tmp_path):
    return {name: str(tmp_path / name) for name in ("child", "grandchild")}


def _pids(tmp_path):
    return [int((tmp_path / name).read_text()) for name in ("child", "grandchild")]


def test_cancel_ends_children_that_ignore_sigterm_and_grandchildren_in_their_own_session(store, until, in_time, tmp_path):
    def attempt(k):
        folder = tmp_path / str(k)
        folder.mkdir()
        job = _running(store, until, "leaves_children", _children(folder), at=1)
        pids = _pids(folder)
        assert all(start_time(pid) for pid in pids)
        assert os.getsid(pids[1]) == pids[1]
        store.request_cancel(job.id)
        ended = store.wait(job.id, LONG_S)
        assert ended.state == "cancelled"
        assert [start_time(pid) for pid in pids] == [None, None]
        return ended.finished - ended.cancel_requested

    in_time(attempt, 2.0)


def test_a_job_that_ends_leaves_no_process_behind(store, tmp_path):
    job = store.submit("task", None, {**_children(tmp_path), "returns": True}, entry=E + "leaves_children")
    assert store.wait(job.id, LONG_S).state == "done"
    assert [start_time(pid) for pid in _pids(tmp_path)] == [None, None]


def test_a_killed_worker_leaves_no_process_of_its_task_behind(store, until, tmp_path):
    job = _running(store, until, "leaves_children", _children(tmp_path), at=1)
    os.kill(job.pid, signal.SIGKILL)
    until(lambda: start_time(job.pid) is None)
    assert store.get(job.id).state == "lost"
    until(lambda: [start_time(pid) for pid in _pids(tmp_path)] == [None, None])


def test_a_queued_job_is_cancelled_at_once_and_an_ended_one_stays(store, tmp_path):
    gate = {"gate": str(tmp_path / "gate")}
    first, second = (store.submit("g", "w", gate, entry=E + "gated", terms=Terms(exclusive=True)) for _ in range(2))
    assert store.request_cancel(second.id).state == "cancelled"
    (tmp_path / "gate").touch()
    assert store.wait(first.id, LONG_S).state == "done"
    assert store.request_cancel(first.id).state == "done"


def test_a_job_cancelled_while_it_starts_does_not_run(store, tmp_path):
    job = store.submit("c", None, {"tidied": str(tmp_path / "tidied")}, entry=E + "cooperative")
    store.request_cancel(job.id)
    assert store.wait(job.id, LONG_S).state == "cancelled"


def test_a_killed_worker_is_lost_and_takes_its_task_along(store, until):
    job = _running(store, until, "native_loop", {}, at=2, key="k")
    os.kill(job.pid, signal.SIGKILL)
    until(lambda: start_time(job.pid) is None)
    ended = store.get(job.id)
    assert ended.state == "lost"
    assert "gone" in ended.error["message"]
    until(lambda: not is_alive(job.task_pid, job.task_started))
    with pytest.raises(EngineError, match="gone"):
        result_of(ended)
    again = store.submit("task", "isle", {}, entry=E + "native_loop", terms=Terms(key="k"))
    assert again.id != job.id


def test_a_killed_task_is_lost_at_once(store, until):
    job = _running(store, until, "native_loop", {}, at=2)
    os.kill(job.task_pid, signal.SIGKILL)
    ended = store.wait(job.id, LONG_S)
    assert ended.state == "lost"
    assert "SIGKILL" in ended.error["message"]


def test_a_native_crash_is_lost_with_a_trace_in_the_log(store):
    job = store.wait(store.submit("dies", None, {"signal": "SIGSEGV"}, entry=E + "dies").id, LONG_S)
    assert job.state == "lost"
    assert "SIGSEGV" in job.error["message"]
    assert "execution_entries.py" in store.log_path(job).read_text()


def test_a_worker_told_to_end_ends_its_task(store, until):
    job = _running(store, until, "native_loop", {}, at=2)
    os.kill(job.pid, signal.SIGTERM)
    ended = store.wait(job.id, LONG_S)
    assert ended.state == "lost"
    assert not is_alive(job.task_pid, job.task_started)


def test_a_reused_pid_is_not_mistaken_for_the_worker(store, until):
    job = _running(store, until, "native_loop", {}, at=2)
    with closing(sqlite3.connect(store.workspace / ".worldagent" / "jobs.db", timeout=3)) as connection, connection:
        connection.execute("UPDATE jobs SET pid_started = '1'")
    assert store.get(job.id).state == "lost"
    assert is_alive(job.pid, job.pid_started)  # not ours to kill, by that start time
    until(lambda: not is_alive(job.task_pid, job.task_started))
    until(lambda: not is_alive(job.pid, job.pid_started))  # it learns that the job was taken away


def test_a_worker_that_lives_but_is_silent_is_killed_and_lost(store, until, monkeypatch):
    monkeypatch.setattr("worldagent.execution.table.STALE_S", 1.2)
    job = _running(store, until, "native_loop", {}, at=2)
    os.kill(job.pid, signal.SIGSTOP)
    ended = until(lambda: (row := store.get(job.id)).ended and row)
    assert ended.state == "lost"
    assert "silent" in ended.error["message"]
    assert not is_alive(job.pid, job.pid_started)
    assert not is_alive(job.task_pid, job.task_started)


def test_a_worker_that_was_silent_and_speaks_again_is_not_lost(store, until):
    """Both stood still, as in a container that was paused: who looks first must not kill the other."""
    job = _running(store, until, "native_loop", {}, at=2)
    frozen = replace(job, heartbeat_clock=job.heartbeat_clock - 100)
    assert store._table.recover(frozen) is False
    assert store.get(job.id).state == "running"
    assert is_alive(job.pid, job.pid_started)


def test_a_worker_that_reports_while_it_is_given_up_keeps_its_task(store, until, tmp_path):
    job = _running(store, until, "leaves_children", _children(tmp_path), at=1)
    claimed = replace(
        job, pid=None, pid_started=None, task_pid=None, task_started=None, heartbeat_clock=job.heartbeat_clock - 100
    )
    assert store._table.recover(claimed) is False
    until(lambda: store.get(job.id).heartbeat > job.heartbeat + 0.5)  # what was killed is gone by now
    assert all(start_time(pid) for pid in _pids(tmp_path))


def test_a_cancelled_job_whose_worker_is_gone_is_cancelled(store, until):
    job = _running(store, until, "native_loop", {}, at=2)
    os.kill(job.pid, signal.SIGSTOP)
    store.request_cancel(job.id)
    os.kill(job.pid, signal.SIGKILL)
    assert store.wait(job.id, LONG_S).state == "cancelled"


def test_only_one_of_two_ends_counts(store, until):
    """Every change of state names the state it starts from."""
    job = _running(store, until, "native_loop", {}, at=2)
    table = JobTable(store.workspace)
    assert not table.register(job.id, os.getpid())
    assert not table.finish(job.id, os.getpid(), "done", result="{}")
    store.request_cancel(job.id)
    assert store.wait(job.id, LONG_S).state == "cancelled"
    assert not table.finish(job.id, job.pid, "done", result="{}")
    assert not table.beat(job.id, job.pid, None)


def test_the_wall_time_cap_ends_a_job_and_names_the_cap(store):
    job = store.wait(store.submit("n", None, {}, entry=E + "native_loop", terms=Terms(wall_s=0.5)).id, LONG_S)
    assert job.state == "failed"
    with pytest.raises(LimitError, match=r"wall_s = 0\.5 s\. Knob: WORLDAGENT_JOB_WALL_S_N "):
        result_of(job)


def test_the_memory_cap_ends_a_job_and_names_cap_and_peak(store):
    job = store.submit("h", None, {"bytes": 2**28}, entry=E + "hungry", terms=Terms(memory_bytes=2**27))
    ended = store.wait(job.id, LONG_S)
    assert ended.state == "failed"
    with pytest.raises(LimitError, match=r"held 0\.\d\d GB of memory, its cap is memory_bytes = 0\.13 GB"):
        result_of(ended)
    assert "WORLDAGENT_JOB_MEMORY_GB" in ended.error["message"]
    assert ended.peak_bytes > 2**27


def test_what_a_job_used_is_recorded(store, until):
    job = _running(store, until, "native_loop", {}, at=2)
    seen = until(lambda: (row := store.get(job.id)).peak_bytes and row)
    assert seen.peak_bytes > 2**20
    stat, least = Path(f"/proc/{job.task_pid}/stat"), 0.2 * os.sysconf("SC_CLK_TCK")
    until(lambda: not stat.exists() or sum(map(int, stat.read_text().rpartition(")")[2].split()[11:13])) > least)
    store.request_cancel(job.id)
    ended = store.wait(job.id, LONG_S)
    assert 0.1 < ended.cpu_s < 60
    assert ended.peak_bytes >= seen.peak_bytes


def test_caps_come_from_the_environment(monkeypatch):
    assert memory_cap() == int(0.85 * machine_memory()) == memory_cap(2**60)
    assert memory_cap(2**30) == 2**30
    assert wall_cap("bake", 7.0) == 7.0
    monkeypatch.setenv("WORLDAGENT_JOB_MEMORY_GB", "2.5")
    monkeypatch.setenv("WORLDAGENT_JOB_WALL_S", "60")
    monkeypatch.setenv("WORLDAGENT_JOB_WALL_S_BAKE", "120")
    assert memory_cap() == 2_500_000_000
    assert (wall_cap("bake", 7.0), wall_cap("probe", 7.0)) == (120, 60)
    monkeypatch.setenv("WORLDAGENT_JOB_MEMORY_GB", "much")
    with pytest.raises(InputError, match="'much'"):
        memory_cap()


def test_the_file_of_another_layout_is_refused(store):
    store.list()
    with closing(sqlite3.connect(store.workspace / ".worldagent" / "jobs.db")) as connection:
        connection.execute("PRAGMA user_version = 99")
    with pytest.raises(InputError, match="layout 99"):
        JobTable(store.workspace)
    with closing(sqlite3.connect(store.workspace / ".worldagent" / "jobs.db")) as connection:
        connection.execute(f"PRAGMA user_version = {VERSION}")

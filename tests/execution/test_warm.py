"""Warm workers: forked by a process that has loaded the engines, equal to cold ones in all that matters."""

import fcntl
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from worldagent.execution import Terms, fingerprint, nursery, result_of, warm
from worldagent.execution.fingerprint import source_stamp, surroundings
from worldagent.execution.processes import start_time
from worldagent.execution.schema import FOLDER
from worldagent.execution.table import JobTable
from worldagent.tests.execution.conftest import LONG_S
from worldagent.worlds.errors import RefusedError

E = "execution_entries:"
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="warm workers are for Linux")


def _pid(workspace):
    """The nursery that has the lock of a workspace."""
    lines = (workspace / FOLDER / warm.LOG).read_text().splitlines()
    found = [re.search(r"nursery (\d+): loaded", line) for line in lines]
    return next((int(match[1]) for match in found if match), None)


@pytest.fixture
def switched_on(monkeypatch):
    monkeypatch.setenv("WORLDAGENT_WARM", "1")
    monkeypatch.setattr(warm, "ANSWER_S", LONG_S)  # on a busy machine a nursery answers late, and a job starts cold


@pytest.fixture
def nursed(store, switched_on, until):
    """A store whose nursery waits with the test entries loaded."""
    assert store.warm_up("execution_entries")
    pid = until(lambda: (store.workspace / FOLDER / warm.SOCKET).exists() and _pid(store.workspace))
    yield store
    if start_time(pid) is not None:
        os.kill(pid, signal.SIGKILL)
        until(lambda: start_time(pid) is None)


def _see(store, **options):
    job = store.submit("see", None, {}, entry=E + "surroundings", terms=Terms(**{"warm": True, **options}))
    return result_of(store.wait(job.id, LONG_S))


def test_a_warm_job_is_forked_by_the_nursery_and_sees_what_a_cold_one_sees(nursed, monkeypatch):
    monkeypatch.setenv("WORLDAGENT_DEVICE", "cuda:7")  # set after the nursery started
    cold, hot = _see(nursed, warm=False), _see(nursed)
    assert (cold.pop("nursery"), hot.pop("nursery")) == (False, True)
    assert hot == cold
    assert hot["device"] == "cuda:7"
    assert hot["cwd"] == str(nursed.workspace)
    assert hot["threads"] == 1


def test_a_warm_worker_is_detached_killed_and_cancelled_like_any(nursed, until):
    job = nursed.submit("loop", None, {"deaf": True}, entry=E + "native_loop", terms=Terms(warm=True))
    running = until(lambda: (row := nursed.get(job.id)).progress_done == 2 and row)
    assert os.getsid(running.task_pid) == running.pid
    assert Path(f"/proc/{running.pid}/comm").read_text().strip() == "worldagent-jobs"
    os.kill(_pid(nursed.workspace), signal.SIGKILL)  # the nursery is no single point of failure
    until(lambda: not warm.is_there(nursed.workspace))
    nursed.request_cancel(job.id)
    assert nursed.wait(job.id, LONG_S).state == "cancelled"


def test_without_an_answer_a_job_starts_cold_and_a_nursery_with_it(store, switched_on, until):
    assert _see(store)["nursery"] is False
    pid = until(lambda: _pid(store.workspace))
    until(lambda: (store.workspace / FOLDER / warm.SOCKET).exists())
    assert _see(store)["nursery"] is True
    os.kill(pid, signal.SIGKILL)
    until(lambda: start_time(pid) is None)
    assert (store.workspace / FOLDER / warm.SOCKET).exists()  # a dead socket stands in nobody's way
    assert _see(store)["nursery"] is False
    again = until(lambda: (new := _pid(store.workspace)) != pid and new)
    os.kill(again, signal.SIGKILL)


def test_a_hung_nursery_costs_some_seconds_and_no_job(nursed, monkeypatch):
    monkeypatch.setattr(warm, "ANSWER_S", 0.2)
    pid = _pid(nursed.workspace)
    os.kill(pid, signal.SIGSTOP)
    try:
        assert _see(nursed)["nursery"] is False
    finally:
        os.kill(pid, signal.SIGCONT)
    listed = nursed.list()
    assert [job.state for job in listed] == ["done"]


@pytest.mark.parametrize("name", ["OMP_NUM_THREADS", "CUDA_VISIBLE_DEVICES", "PYTHONHASHSEED", "MUJOCO_GL"])
def test_what_libraries_read_while_they_load_must_be_equal(nursed, monkeypatch, name):
    monkeypatch.setenv(name, "1")
    assert _see(nursed)["nursery"] is False


def test_limits_of_the_asking_process_must_be_equal():
    script = (
        "import os; from worldagent.execution.fingerprint import surroundings; print(surroundings());"
        "os.sched_setaffinity(0, {min(os.sched_getaffinity(0))}); one = surroundings(); os.umask(0o077); two = surroundings();"
        "import resource; resource.setrlimit(resource.RLIMIT_CORE, (0, 0)); resource.setrlimit(resource.RLIMIT_NOFILE, (99, 99));"
        "print(one); print(two); print(surroundings())"
    )
    printed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    assert printed[0] == surroundings()
    assert len(set(printed)) == (4 if len(os.sched_getaffinity(0)) > 1 else 3)


def test_changed_source_ends_the_nursery(store, switched_on, monkeypatch, until, tmp_path):
    """An installation of its own: other tests run beside, whose nurseries look at that of all."""
    installed = tmp_path / "lib" / "site-packages"
    installed.mkdir(parents=True)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([os.environ["PYTHONPATH"], str(installed)]))
    assert store.warm_up("execution_entries")
    pid = until(lambda: (store.workspace / FOLDER / warm.SOCKET).exists() and _pid(store.workspace))
    assert _see(store)["nursery"] is True
    (installed / "another").mkdir()
    assert _see(store)["nursery"] is False
    until(lambda: start_time(pid) is None)
    # The cold job may have started another one.
    until(lambda: (new := _pid(store.workspace)) == pid or (new and not os.kill(new, signal.SIGKILL)))


def test_a_source_file_that_changed_is_another_source(monkeypatch, tmp_path):
    source = tmp_path / "worldagent" / "execution" / "fingerprint.py"
    source.parent.mkdir(parents=True)
    source.write_text("one")
    monkeypatch.setattr(fingerprint, "__file__", str(source))
    before, stat = source_stamp(), source.stat()
    os.utime(source, ns=(stat.st_atime_ns, stat.st_mtime_ns + 1))
    assert source_stamp() != before
    os.utime(source, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert source_stamp() == before
    (source.parent / "more.py").touch()
    assert source_stamp() != before


def test_one_nursery_serves_a_workspace(nursed, until):
    pid = _pid(nursed.workspace)
    late = [warm.start_nursery(nursed.workspace, "execution_entries") for _ in range(3)]
    for process in late:
        assert process.wait(LONG_S) == 0
    assert _see(nursed)["nursery"] is True
    assert start_time(pid) is not None
    with (nursed.workspace / FOLDER / warm.LOCK).open("ab") as lock, pytest.raises(BlockingIOError):
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_a_worker_does_not_hold_the_lock_of_a_nursery_that_ended(nursed, until, tmp_path):
    job = nursed.submit("g", None, {"gate": str(tmp_path / "gate")}, entry=E + "gated", terms=Terms(warm=True))
    until(lambda: nursed.get(job.id).progress_done == 1)
    os.kill(_pid(nursed.workspace), signal.SIGKILL)
    until(lambda: not warm.is_there(nursed.workspace))
    (tmp_path / "gate").touch()
    assert nursed.wait(job.id, LONG_S).state == "done"


def test_an_idle_nursery_and_one_whose_workspace_is_gone_end(monkeypatch, tmp_path):
    monkeypatch.setattr(nursery, "LOOK_S", 0.01)
    JobTable(tmp_path)
    with (tmp_path / FOLDER / warm.LOCK).open("ab") as lock:
        monkeypatch.setattr(nursery, "make_sure", lambda: None)
        made = nursery.Nursery(tmp_path, "execution_entries", lock)
        monkeypatch.setattr(nursery, "IDLE_S", 0.05)
        assert made.run() == "idle for 0 s"
        assert (tmp_path / FOLDER / warm.SOCKET).exists()
        made.close()
        assert not (tmp_path / FOLDER / warm.SOCKET).exists()
        made = nursery.Nursery(tmp_path, "execution_entries", lock)
        monkeypatch.setattr(nursery, "IDLE_S", 60)
        shutil.rmtree(tmp_path / FOLDER)
        assert made.run() == "the workspace is gone"
        made.close()


def test_a_process_with_threads_may_not_fork_workers(tmp_path, until):
    """Dr.Jit starts a thread while it loads: a module that wants it gets no nursery, and its jobs start cold."""
    script = (
        "import threading; from worldagent.execution import nursery\n"
        "threading.Thread(target=threading.Event().wait, daemon=True).start()\n"
        "try: nursery.make_sure()\n"
        "except nursery.Unfit as reason: print(reason)"
    )
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1 threads are left after loading"


def test_a_nursery_loads_code_of_this_package_only(store, switched_on):
    for module in ("os", "numpy.linalg"):
        with pytest.raises(RefusedError):
            store.warm_up(module)
    with pytest.raises(nursery.Unfit, match="WARM"):
        nursery.load("worldagent.execution.job")


def test_senseless_requests_leave_the_nursery_alone(nursed):
    for request in ({}, [], {"do": "start"}, {"do": "start", "module": 3, "surroundings": None}, "x" * 10_000):
        answer = warm.send(nursed.workspace, request)
        assert answer is None or answer["served"] is False
    assert _see(nursed)["nursery"] is True


def test_a_row_that_names_foreign_code_is_not_run_warm_either(nursed):
    """The worker checks for itself; and one such row stands in nobody's way."""
    done = nursed.wait(nursed.submit("echo", None, {}, entry=E + "echo", terms=Terms(warm=True)).id, LONG_S)
    with closing(sqlite3.connect(nursed.workspace / FOLDER / "jobs.db")) as connection, connection:
        connection.execute("UPDATE jobs SET entry = 'os:abort', state = 'queued', pid = NULL, finished = NULL")
    ended = nursed.wait(done.id, LONG_S)
    assert (ended.state, ended.error["type"]) == ("failed", "RefusedError")
    assert _see(nursed)["nursery"] is True


def test_off_means_cold(store, monkeypatch):
    monkeypatch.setenv("WORLDAGENT_WARM", "0")
    assert store.warm_up("execution_entries") is False
    assert _see(store)["nursery"] is False
    assert not (store.workspace / FOLDER / warm.LOCK).exists()


def test_no_module_reads_the_environment_while_it_loads():
    """Modules that a nursery has loaded must not depend on variables that a later request hands over."""
    root = Path(nursery.__file__).parent.parent
    at_import = re.compile(r"^[^\s#\"'].*os\.(environ|getenv)", re.MULTILINE)
    floors = ("physics", "worlds", "execution", "geometry", "construction", "simulation", "verifiers", "rendering", "tools")
    found = [str(p) for floor in floors for p in (root / floor).rglob("*.py") if at_import.search(p.read_text())]
    assert found == []


def test_engines_compute_the_same_bytes_in_warm_and_cold_workers(store, switched_on, until):
    """BLAS with its threads, Warp, MuJoCo and Mitsuba, in forks of a process that has loaded all but the last."""
    entries = "engine_entries"

    def run(entry, *, warm):
        return result_of(store.wait(store.submit("c", None, {}, entry=f"{entries}:{entry}", terms=Terms(warm=warm)).id, LONG_S))

    cold = run("computed", warm=False)
    store.warm_up(entries)
    pid = until(lambda: (store.workspace / FOLDER / warm.SOCKET).exists() and _pid(store.workspace))
    try:
        assert set(run("loaded", warm=True).values()) == {True}
        assert run("computed", warm=True) == cold
        assert run("computed", warm=True) == cold
    finally:
        os.kill(pid, signal.SIGKILL)


ASKER = """
import sys, time
from pathlib import Path
from worldagent.execution import warm
warm.start_nursery(Path(sys.argv[1]), "execution_entries").wait()
print("asked", flush=True)
time.sleep(600)
"""
"""A process that starts a nursery, as a server does, and waits."""


def _of_workspace(workspace):
    """Processes that name a workspace in their command line: nurseries, and who asked for them."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if str(workspace).encode() in words:
                found.append(int(entry.name))
    return found


@pytest.fixture
def asking(store, switched_on, until):
    """Starts processes that ask for a nursery of the store's workspace, and ends them."""
    made = []
    JobTable(store.workspace)

    def start():
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", ASKER, str(store.workspace)],
            stdout=subprocess.PIPE,
            env={**os.environ, "WORLDAGENT_WARM": "1"},
        )
        made.append(process)
        assert process.stdout.readline() == b"asked\n"
        until(lambda: (store.workspace / FOLDER / warm.SOCKET).exists() and _pid(store.workspace))
        return process

    yield start
    for process in made:
        process.kill()
        process.wait()
        process.stdout.close()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_nursery_ends_with_the_one_that_asked_for_it_however_that_ended(asking, store, until, number):
    before = _of_workspace(store.workspace)
    assert before == []
    server = asking()
    assert len(_of_workspace(store.workspace)) == 2, "the one who asked, and the nursery"
    server.send_signal(number)
    server.wait(LONG_S)
    until(lambda: _of_workspace(store.workspace) == [])
    assert "all who asked have ended" in (store.workspace / FOLDER / warm.LOG).read_text()
    assert not (store.workspace / FOLDER / warm.SOCKET).exists()


def test_a_nursery_stays_while_another_that_asked_lives(asking, store, until):
    server = asking()
    warm.keep(store.workspace, "execution_entries")  # this process asks, too
    pid = _pid(store.workspace)
    server.kill()
    server.wait(LONG_S)
    assert _see(store)["nursery"] is True
    assert start_time(pid) is not None
    os.kill(pid, signal.SIGKILL)
    until(lambda: start_time(pid) is None)


def test_a_job_that_runs_outlives_the_nursery_and_the_one_that_asked(asking, store, until, tmp_path):
    server = asking()
    job = store.submit("g", None, {"gate": str(tmp_path / "gate")}, entry=E + "gated", terms=Terms(warm=True))
    until(lambda: store.get(job.id).progress_done == 1)
    nursed, worker = _pid(store.workspace), store.get(job.id).pid
    server.kill()
    server.wait(LONG_S)
    assert start_time(worker) is not None
    (tmp_path / "gate").touch()
    assert store.wait(job.id, LONG_S).state == "done"
    if start_time(nursed) is not None:
        os.kill(nursed, signal.SIGKILL)


def test_a_nursery_whose_asker_has_ended_before_it_serves_does_not_stay(monkeypatch, tmp_path):
    monkeypatch.setattr(nursery, "LOOK_S", 0.01)
    monkeypatch.setattr(nursery, "make_sure", lambda: None)
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    JobTable(tmp_path)
    with (tmp_path / FOLDER / warm.LOCK).open("ab") as lock:
        made = nursery.Nursery(tmp_path, "execution_entries", lock, gone.pid)
        assert made.run() == "all who asked have ended"
        made.close()

"""Files that stay on disk: rows of older layouts, old jobs, logs."""

import sqlite3
import time
from contextlib import closing
from threading import Thread, current_thread

import pytest
from worldagent.execution import JobStore, Terms, damage, jobs, launch, pruning, result_of
from worldagent.execution.logs import KEPT_HEAD, KEPT_TAIL, LOG_BYTES_MAX, trim_log
from worldagent.execution.schema import _COLUMNS_OF_2, _COLUMNS_OF_3, VERSION, JobFile
from worldagent.execution.table import JobTable
from worldagent.tests.execution.conftest import LONG_S

E = "execution_entries:"


def _older_layout(path, version):
    """The file as an earlier version wrote it."""
    dropped = _COLUMNS_OF_3 if version == 2 else _COLUMNS_OF_2 + _COLUMNS_OF_3
    with closing(sqlite3.connect(path)) as connection, connection:
        if version == 1:
            connection.execute("DROP INDEX jobs_served")
            connection.execute("DROP INDEX jobs_ended")
        for column in dropped:
            connection.execute(f"ALTER TABLE jobs DROP COLUMN {column.split()[0]}")
        connection.execute(f"PRAGMA user_version = {version}")


@pytest.mark.parametrize("version", [1, 2])
def test_rows_of_layouts_before_stay_and_go_on(tmp_path, version):
    store = JobStore(tmp_path, slots=1)
    gate = {"gate": str(tmp_path / "gate")}
    (tmp_path / "gate").touch()
    done = store.wait(store.submit("g", "w", gate, entry=E + "gated", terms=Terms(key="k")).id, LONG_S)
    waiting = JobTable(tmp_path)
    _older_layout(waiting.path, version)
    with closing(sqlite3.connect(waiting.path)) as connection, connection:
        connection.execute(
            "INSERT INTO jobs (id, kind, world, entry, payload, state, exclusive, priority, created, log)"
            " VALUES ('job_0123456789ab', 'echo', 'w', ?, '{}', 'queued', 0, 0, ?, '.worldagent/logs/job_0123456789ab.log')",
            (E + "echo", time.time()),
        )
    again = JobStore(tmp_path, slots=1)
    found = again.get(done.id)
    with closing(sqlite3.connect(waiting.path)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (VERSION,)
    assert (found.state, found.result, found.warm) == ("done", {"through": True}, False)
    assert (found.peak_bytes is None) == (version == 1)
    assert again.submit("g", "w", gate, entry=E + "gated", terms=Terms(key="k")).id == done.id
    ended = again.wait("job_0123456789ab", LONG_S)
    assert result_of(ended)["job"] == "job_0123456789ab"
    assert ended.cpu_s is not None


def _ended(file, number, *, days, world="w", kind="bake", state="done"):
    job_id = f"job_{number:012x}"
    log = f".worldagent/logs/{job_id}.log"
    (file.workspace / log).touch()
    finished = time.time() - days * 86400.0
    with file.open() as connection:
        connection.execute(
            "INSERT INTO jobs (number, id, kind, world, entry, payload, state, exclusive, priority, created, finished, log)"
            " VALUES (?, ?, ?, ?, 'x:f', '{}', ?, 1, 0, 0, ?, ?)",
            (number, job_id, kind, world, state, finished, log),
        )
    return job_id


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(pruning, "KEPT_MAX", 6)
    monkeypatch.setattr(pruning, "KEPT_MIN", 3)
    monkeypatch.setattr(pruning, "EVERY", 1)


def _left(file):
    with file.open() as connection:
        return [row["id"] for row in connection.execute("SELECT id FROM jobs ORDER BY number")]


def test_old_jobs_go_with_their_logs_and_the_newest_stay(tmp_path, small):
    file = JobFile(tmp_path)
    ids = [_ended(file, k, days=90 - k, state="failed") for k in range(1, 11)]
    assert pruning.prune(file) == 7
    assert _left(file) == ids[-3:]
    assert sorted(p.stem for p in (tmp_path / ".worldagent" / "logs").iterdir()) == ids[-3:]


def test_beyond_the_count_jobs_go_before_their_age_unless_they_just_ended(tmp_path, small):
    file = JobFile(tmp_path)
    ids = [_ended(file, k, days=1.0, state="cancelled") for k in range(1, 9)] + [_ended(file, 9, days=0.0, state="failed")]
    fresh = [_ended(file, k, days=0.001, state="failed") for k in range(10, 18)]
    assert pruning.prune(file) == 8
    assert _left(file) == [ids[-1], *fresh]


def test_the_newest_done_job_of_each_kind_and_world_and_unended_ones_stay(tmp_path, small):
    file = JobFile(tmp_path)
    kept = [
        _ended(file, 1, days=900, kind="bake"),
        _ended(file, 2, days=900, kind="probe"),
        _ended(file, 3, days=900, world="v"),
        _ended(file, 4, days=900, state="queued", kind="final"),
        _ended(file, 5, days=900, state="running", kind="final"),
    ]
    gone = _ended(file, 6, days=900, state="lost")
    new = [_ended(file, k, days=0, state="failed", kind="check") for k in range(7, 11)]
    pruning.prune(file)
    assert _left(file) == [*kept, *new]
    assert gone not in _left(file)


def test_an_old_result_that_is_asked_for_is_given_though_it_is_forgotten_meanwhile(tmp_path, small, monkeypatch):
    store = JobStore(tmp_path)
    file = JobFile(tmp_path)
    old = _ended(file, 1, days=900)
    with file.open() as connection:
        connection.execute("UPDATE jobs SET key = 'same' WHERE id = ?", (old,))
    for number in range(2, 10):
        _ended(file, number, days=0, state="done")
    monkeypatch.setattr(jobs, "prune", lambda table: None)  # another process forgets it, after it was found
    monkeypatch.setattr(launch, "claim", lambda table, slots: [pruning.prune(table)][1:])
    found = store.submit("bake", "w", {}, entry="worldagent.x:f", terms=Terms(key="same"))
    assert (found.id, found.state) == (old, "done")
    assert old not in _left(file)


def test_of_two_that_meet_a_damaged_list_neither_moves_the_new_one_aside(tmp_path, monkeypatch):
    path = JobFile(tmp_path).path
    path.write_bytes(b"no database at all, but some text instead of it" * 100)
    error = sqlite3.DatabaseError("file is not a database")
    other = Thread(target=lambda: damage.set_aside(path, error) and JobFile(tmp_path))
    look = damage._damaged

    def look_and_stand_still(found):
        bad = look(found)
        if current_thread() is not other:
            other.start()
            other.join(0.5)
        return bad

    monkeypatch.setattr(damage, "_damaged", look_and_stand_still)
    damage.set_aside(path, error)
    other.join()
    assert len(list(path.parent.glob("jobs.damaged-*.db"))) == 1
    assert _left(JobFile(tmp_path)) == []


def test_a_clock_that_jumps_ahead_empties_nothing(tmp_path, small):
    file = JobFile(tmp_path)
    ids = [_ended(file, k, days=0, state="failed") for k in range(1, 4)]
    assert pruning.prune(file, now=time.time() + 1e9) == 0
    assert _left(file) == ids


def test_a_log_that_grew_too_large_keeps_its_beginning_and_end(store):
    lines = LOG_BYTES_MAX // 1000 + 2000
    job = store.wait(store.submit("chat", None, {"lines": lines}, entry=E + "chatty").id, LONG_S)
    assert job.state == "done"
    log = store.log_path(job)
    assert log.stat().st_size <= LOG_BYTES_MAX
    text = log.read_text()
    assert text.startswith("0 xxx")
    assert "bytes cut" in text
    assert text.endswith("the last word\n")


def test_a_small_log_is_left_alone_and_a_large_one_goes_on_behind_its_end(tmp_path):
    log = tmp_path / "log"
    log.write_bytes(b"short")
    assert not trim_log(log)
    assert not trim_log(tmp_path / "none")
    with log.open("ab") as writer:
        writer.write(b"y" * (LOG_BYTES_MAX + 1))
        writer.flush()
        assert trim_log(log)
        size = log.stat().st_size
        assert KEPT_HEAD + KEPT_TAIL < size < KEPT_HEAD + KEPT_TAIL + 200
        writer.write(b"more")
        writer.flush()
        assert log.stat().st_size == size + 4

"""Whose turn it is: priorities, turns between worlds, caps of the queue, what a queued job waits for."""

import sqlite3
from contextlib import closing, contextmanager
from threading import Thread, current_thread
from types import SimpleNamespace

import pytest
from worldagent.execution import BULK, INTERACTIVE, NORMAL, JobStore, queue
from worldagent.execution.queue import AGE_S, claim, insert
from worldagent.execution.table import JobTable
from worldagent.execution.terms import Terms
from worldagent.tests.execution.conftest import LONG_S
from worldagent.worlds.errors import LimitError


@pytest.fixture
def table(tmp_path):
    return JobTable(tmp_path)


def add(table, world, *, priority=NORMAL, exclusive=True, kind="task"):
    return insert(table, kind, world, "worldagent.x:f", "{}", terms=Terms(exclusive=exclusive, priority=priority)).id


def served(table, slots=1):
    """Worlds in the order in which their jobs are claimed, each ended before the next claim."""
    order = []
    while claimed := claim(table, slots):
        for job_id in claimed:
            order.append(table.read(job_id).world)
            assert table.finish(job_id, None, "done", result="{}")
    return order


def test_worlds_take_turns_however_many_jobs_one_of_them_has(table):
    for _ in range(5):
        add(table, "flood")
    first, second = add(table, "calm"), add(table, "other")
    order = served(table)
    assert set(order[:3]) == {"flood", "calm", "other"}
    assert order[3:] == ["flood"] * 4
    assert table.read(first).state == table.read(second).state == "done"


def test_a_world_with_fewer_running_jobs_goes_first(table):
    for _ in range(3):
        add(table, "flood", exclusive=False)
    add(table, "calm", exclusive=False)
    claimed = [table.read(job_id).world for job_id in claim(table, 2)]
    assert claimed == ["flood", "calm"]


def test_priority_comes_before_turns(table):
    add(table, "calm", priority=BULK)
    add(table, "flood", priority=NORMAL)
    add(table, "flood", priority=NORMAL)
    assert served(table) == ["flood", "flood", "calm"]


def test_a_world_that_waits_unserved_passes_urgent_work_of_others(table):
    """Own choice: nothing starves, whatever the others' priority."""
    bake = add(table, "calm", priority=BULK)
    with closing(sqlite3.connect(table.path)) as connection, connection:
        connection.execute("UPDATE jobs SET created = created - ?", (AGE_S * (NORMAL + 1),))
    add(table, "flood", priority=NORMAL)
    assert claim(table, 1) == (bake,)


def test_a_clock_that_fell_ages_nobody(table):
    add(table, "calm", priority=BULK)
    with closing(sqlite3.connect(table.path)) as connection, connection:
        connection.execute("UPDATE jobs SET created = created + 1e6")
    urgent = add(table, "flood", priority=NORMAL)
    assert claim(table, 1) == (urgent,)


def test_interactive_work_runs_beside_full_slots_but_only_one_more(table):
    add(table, "a", priority=BULK)
    assert len(claim(table, 1)) == 1
    add(table, "b", priority=BULK)
    looks = [add(table, world, priority=INTERACTIVE) for world in ("c", "d")]
    assert claim(table, 1) == (looks[0],)
    assert claim(table, 1) == ()


def test_the_queue_of_a_world_and_of_a_workspace_is_capped(table, monkeypatch):
    monkeypatch.setattr(queue, "QUEUED_PER_WORLD", 2)
    monkeypatch.setattr(queue, "QUEUED_PER_WORKSPACE", 3)
    newest = [add(table, "w") for _ in range(2)][-1]
    with pytest.raises(LimitError, match=rf"queued_jobs_per_world: 2 jobs of world 'w' wait already, the cap is 2.*{newest}"):
        add(table, "w")
    add(table, "v")
    with pytest.raises(LimitError, match=r"queued_jobs: 3 jobs of this workspace wait already, the cap is 3\."):
        add(table, "u")
    assert len(table.read_all(state="queued")) == 3


def test_a_client_of_a_full_world_leaves_room_for_others_and_can_still_join(tmp_path, monkeypatch):
    monkeypatch.setattr(queue, "QUEUED_PER_WORLD", 1)
    store = JobStore(tmp_path, slots=1)
    entry = "execution_entries:gated"
    gate = {"gate": str(tmp_path / "gate")}
    running, queued = (store.submit("g", "w", gate, entry=entry, terms=Terms(key=key, exclusive=True)) for key in "ab")
    assert store.submit("g", "w", gate, entry=entry, terms=Terms(key="b", exclusive=True)).id == queued.id
    with pytest.raises(LimitError, match="Nothing was queued"):
        store.submit("g", "w", gate, entry=entry, terms=Terms(key="c", exclusive=True))
    other = store.submit("g", "v", gate, entry=entry, terms=Terms(exclusive=True))
    assert other.state == "queued"
    (tmp_path / "gate").touch()
    for job in (running, queued, other):
        assert store.wait(job.id, LONG_S).state == "done"


def test_a_queued_job_tells_what_it_waits_for(tmp_path):
    store = JobStore(tmp_path, slots=1)
    gate = {"gate": str(tmp_path / "gate")}
    options = {"entry": "execution_entries:gated", "terms": Terms(exclusive=True)}
    running = store.submit("bake", "w", gate, **options)
    same, other = store.submit("check", "w", gate, **options), store.submit("check", "v", gate, **options)
    assert store.standing(running) is None
    assert store.standing(same).waits_for == f"world busy with bake {running.id}"
    standing = store.standing(other)
    assert standing.waits_for == f"1 running: bake {running.id} of 'w'"
    assert standing.ahead == 0  # the world that is not served yet comes first
    assert store.standing(same).ahead == 1
    (tmp_path / "gate").touch()
    for job in (running, same, other):
        assert store.wait(job.id, LONG_S).state == "done"


def test_a_job_that_starts_while_it_is_looked_at_does_not_wait_for_itself(table, monkeypatch):
    job = table.read(add(table, "w"))
    other = Thread(target=claim, args=(table, 1))
    looks = table.open

    class Between:
        """A connection; another process claims the job between its first look and the next."""

        def __init__(self, connection):
            self._connection, self._looks = connection, 0

        def execute(self, statement, *values):
            self._looks += statement.lstrip().startswith("SELECT")
            if self._looks == 2 and other.ident is None:
                other.start()
                other.join(0.5)  # it waits for the reader
            return self._connection.execute(statement, *values)

    @contextmanager
    def opened():
        with looks() as connection:
            yield connection if current_thread() is other else Between(connection)

    monkeypatch.setattr(table, "open", opened)
    assert queue.standing(table, job) == (0, "its start")
    other.join()
    assert table.read(job.id).state == "running"


def test_the_order_is_found_by_indexes(table):
    """A workspace remembers a thousand jobs: a look at all of them for every queued one would hold the file for seconds."""
    with table.open() as connection:
        plan = connection.execute(f"EXPLAIN QUERY PLAN {queue._QUEUED}", {"now": 0, "age_s": AGE_S}).fetchall()
    steps = [str(row["detail"]) for row in plan]
    assert not [step for step in steps if step.startswith("SCAN")]
    assert any("jobs_served" in step for step in steps)
    assert any("jobs_ended" in step for step in steps)


def test_a_job_starts_when_its_place_is_free_not_when_it_was_asked_for(table, monkeypatch):
    """A job that waits for the lock while another one ends has not begun before that end."""
    clock = [1.0]
    monkeypatch.setattr(queue, "time", SimpleNamespace(time=lambda: clock[0], monotonic=lambda: clock[0]))
    waiting = add(table, "w")
    locked = table.transaction

    @contextmanager
    def late():
        with locked() as connection:
            clock[0] = 2.0
            yield connection

    monkeypatch.setattr(table, "transaction", late)
    assert claim(table, 1) == (waiting,)
    assert table.read(waiting).started == 2.0

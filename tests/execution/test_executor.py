"""Pieces of work spread over processes."""

import os
from pathlib import Path

import pytest
from worldagent.execution import Cancelled, ExecutorLocal, JobContext, result_of
from worldagent.execution.processes import start_time
from worldagent.tests.execution.conftest import LONG_S
from worldagent.worlds.errors import EngineError, InputError, RefusedError, SpecError

E = "execution_entries:"


def _context(report=lambda progress: None, cancel_asked=lambda: False):
    return JobContext(job_id="job_test", report=report, cancel_asked=cancel_asked)


def test_results_keep_the_order_of_the_items_and_workers_are_bounded():
    seen = []
    results = ExecutorLocal(2).map(E + "square", [{"x": k} for k in range(20)], _context(report=seen.append))
    assert [result["square"] for result in results] == [k * k for k in range(20)]
    assert os.getpid() not in {result["pid"] for result in results}
    assert len({result["pid"] for result in results}) <= 2
    assert [progress.done for progress in seen] == list(range(1, 21))


def test_no_items_give_no_results():
    assert ExecutorLocal(2).map(E + "square", [], _context()) == []


def test_an_item_larger_than_a_pipe_goes_both_ways():
    text = "é" * 300_000
    (result,) = ExecutorLocal(1).map(E + "reflect", [{"text": text}], _context())
    assert result == {"text": text}


def test_an_error_of_a_piece_is_raised_as_itself():
    with pytest.raises(SpecError, match="x -1 must be >= 0"):
        ExecutorLocal(2).map(E + "square", [{"x": 1}, {"x": -1}, {"x": 2}], _context())


def test_a_crash_of_a_piece_names_piece_and_signal():
    with pytest.raises(EngineError, match="piece 0 was killed by SIGSEGV"):
        ExecutorLocal(1).map(E + "crash", [{}], _context())


def test_cancel_ends_pieces_in_native_code(tmp_path, until):
    marks = [tmp_path / "a", tmp_path / "b"]
    started = lambda: all(mark.exists() and mark.read_text() for mark in marks)  # noqa: E731
    with pytest.raises(Cancelled):
        ExecutorLocal(2).map(E + "mark_and_hang", [{"mark": str(mark)} for mark in marks], _context(cancel_asked=started))
    for mark in marks:
        assert start_time(int(mark.read_text())) is None


def test_a_killed_job_takes_its_pieces_along(store, tmp_path, until):
    mark = tmp_path / "mark"
    payload = {"workers": 1, "fn": E + "mark_and_hang", "items": [{"mark": str(mark)}]}
    job = store.submit("map", None, payload, entry=E + "mapped")
    pid = int(until(lambda: mark.exists() and Path(mark).read_text()))
    os.kill(store.get(job.id).task_pid, 9)
    assert store.wait(job.id, LONG_S).state == "lost"
    until(lambda: start_time(pid) is None)


def test_a_job_maps_over_processes(store):
    payload = {"workers": 2, "fn": E + "square", "items": [{"x": 3}, {"x": 4}]}
    job = store.wait(store.submit("map", None, payload, entry=E + "mapped").id, LONG_S)
    assert [result["square"] for result in result_of(job)["results"]] == [9, 16]
    assert (job.progress_done, job.progress_total) == (2, 2)


def test_wrong_arguments_are_refused():
    with pytest.raises(InputError, match="workers 0"):
        ExecutorLocal(0)
    with pytest.raises(RefusedError):
        ExecutorLocal(1).map("os:abort", [{}], _context())

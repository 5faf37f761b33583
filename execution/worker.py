"""The worker: a detached process that watches over one job.

    python -P -m worldagent.execution.worker --workspace W --job ID

It forks away from whoever started it (own session, no parent), takes charge of the job's row, and forks the task
that runs the entry, in a process group of its own. Since the worker runs no foreign code, it says every second
that it lives and obeys a cancel within 2 s, whatever native code does in the task. It alone writes the row.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sqlite3
import sys
import time
from pathlib import Path

from .context import Board
from .job import Job
from .launch import pump, settle
from .processes import OWN_NAMES, adopt_orphans, call_myself
from .table import JobTable
from .task import run_task
from .watch import TICK_S, UNREACHABLE_S, Ending, Watch

__all__ = ["main", "serve"]


def _finish(table: JobTable, job: Job, ending: Ending) -> None:
    result = json.dumps(ending.result) if ending.result is not None else None
    deadline = time.monotonic() + UNREACHABLE_S
    while True:
        try:
            table.finish(
                job.id, os.getpid(), ending.state, result=result, error=ending.error, usage=ending.usage, pace=ending.pace
            )
        except sqlite3.OperationalError as error:
            sys.stderr.write(f"worker: jobs.db: {error}\n")
            if time.monotonic() > deadline:
                raise
            time.sleep(TICK_S)
        else:
            return


def _work(table: JobTable, job_id: str) -> None:
    worker = os.getpid()
    if not table.register(job_id, worker):
        return  # taken for lost because this start took too long, or started twice
    job = table.read(job_id)
    if job.cancel_requested is not None:
        _finish(table, job, Ending("cancelled"))
        return
    board = Board()
    reading, writing = os.pipe()
    task = os.fork()
    if task == 0:
        os.close(reading)
        run_task(job, table.workspace, board, writing, worker)
    os.close(writing)
    with contextlib.suppress(OSError):
        os.setpgid(task, task)  # the task does so too; whoever comes first
    watch = Watch(table, job, board, reading, task)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, watch.tell)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    table.record_task(job_id, worker, task)
    ending = watch.run()
    if ending is not None:
        _finish(table, job, ending)


def serve(workspace: Path, job_id: str, slots: int | None) -> None:
    """Detach from the parent, do the job, start the next. Runs in a fork of its own; the caller's process ends here."""
    table = JobTable(workspace)
    if os.fork() != 0:
        os._exit(0)  # whoever started this has nothing to wait for, and no child that a kill of its tree would find
    os.setsid()
    call_myself(OWN_NAMES[0])
    adopt_orphans()
    _work(table, job_id)
    pump(table, slots=slots)
    settle()


def main(arguments: list[str]) -> None:
    """Serve the job that the command line names."""
    options = dict(zip(arguments[::2], arguments[1::2], strict=True))
    slots = int(options["--slots"]) if "--slots" in options else None
    serve(Path(options["--workspace"]), options["--job"], slots)


if __name__ == "__main__":
    main(sys.argv[1:])

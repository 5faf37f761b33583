"""The task: the process forked by the worker that runs the entry. It knows no database, only board and pipe."""

from __future__ import annotations

import contextlib
import faulthandler
import json
import os
import signal
import sys
import traceback
from pathlib import Path
from typing import Any, NoReturn

from .context import Board, JobContext
from .entries import checked_result, error_of, load_entry
from .job import Cancelled, Job
from .processes import TAG, call_myself, die_with_parent

__all__ = ["run_task"]

POLITENESS = 10
"""Added to the niceness of a task: a bake takes the cores that are free, and a server beside it keeps answering."""


def run_task(job: Job, workspace: Path, board: Board, pipe: int, worker: int) -> NoReturn:
    """Run the entry, write its outcome to the pipe as one line of JSON, and end the process.

    The outcome is `{"state": ..., "result" or "error": ...}`. The process ends without the interpreter's shutdown,
    since native libraries may hang there; threads that the entry left behind end with it.
    """
    code = 1
    try:
        _settle_in(job, worker)
        outcome = _outcome(job, workspace, board)
        with os.fdopen(pipe, "wb") as stream:
            stream.write(json.dumps(outcome).encode() + b"\n")
        code = 0
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _settle_in(job: Job, worker: int) -> None:
    os.setpgid(0, 0)
    call_myself("worldagent-task")
    os.environ[TAG] = job.id
    die_with_parent(worker)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, signal.SIG_DFL)
    faulthandler.enable()
    with contextlib.suppress(OSError):
        os.nice(POLITENESS)


def _outcome(job: Job, workspace: Path, board: Board) -> dict[str, Any]:
    context = JobContext(job_id=job.id, report=board.write, cancel_asked=board.cancel_asked, workspace=str(workspace))
    try:
        result = checked_result(job.entry, load_entry(job.entry)(job.payload, context))
    except Cancelled:
        return {"state": "cancelled"}
    except BaseException as error:  # whatever ends an entry, SystemExit included, must reach the row
        traceback.print_exc()
        return {"state": "failed", "error": error_of(error)}
    return {"state": "done", "result": result}

"""Start workers for the jobs whose turn it is.

There is no daemon: whoever touches the queue moves it. `pump` runs when a job is submitted, looked at, or waited
for, and when a worker ends. Claiming is atomic, so it does not matter how many processes pump at once. A job that may
start warm is given to the workspace's nursery if one waits; otherwise it starts cold, and a nursery with it.
"""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

from ..worlds.errors import EngineError
from ..worlds.limits import CAPS
from .job import Job
from .processes import core_count
from .queue import claim
from .table import JobTable

__all__ = ["pump", "settle", "start", "warm_up"]

_starting: list[subprocess.Popen[bytes]] = []
_starting_lock = threading.Lock()


def pump(table: JobTable, *, slots: int | None = None) -> int:
    """Start queued jobs up to `slots` running ones (default: cores); how many were started."""
    slots = min(core_count(), CAPS["running_jobs"].value) if slots is None else slots
    _reap()
    claimed = claim(table, slots)
    for job_id in claimed:
        try:
            _spawn(table, job_id, slots)
        except OSError as error:
            described = {"type": EngineError.__name__, "message": f"the worker process could not be started: {error}"}
            table.finish(job_id, None, "failed", error=described)
    return len(claimed)


def start(table: JobTable, job: Job, *, slots: int | None = None) -> Job:
    """Start the job if it is its turn, otherwise leave it queued; its row afterwards."""
    pump(table, slots=slots)
    return job if job.ended else table.read(job.id)  # an old one may be forgotten at any moment


def warm_up(workspace: Path, module: str) -> bool:
    """Have a nursery with this module's engines loaded wait for jobs; whether one waits or loads now."""
    if sys.platform != "linux":
        return False
    from .warm import is_on, is_there, keep, start_nursery

    if not is_on():
        return False
    try:
        if is_there(workspace):
            keep(workspace, module)
            return True
        process = start_nursery(workspace, module)
    except OSError:  # jobs start cold
        return False
    with _starting_lock:
        _starting.append(process)
    return True


def _spawn(table: JobTable, job_id: str, slots: int) -> None:
    job = table.read(job_id)
    module = job.entry.partition(":")[0]
    if job.warm and _spawn_warm(table, job_id, module, slots):
        return
    # -P: the workspace is the current folder and must not become a place to import from.
    command = [sys.executable, "-P", "-m", f"{__package__}.worker"]
    command += ["--workspace", str(table.workspace), "--job", job_id, "--slots", str(slots)]
    with table.log_path(job).open("ab") as log:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, cwd=table.workspace, start_new_session=True
        )
    with _starting_lock:
        _starting.append(process)
    if job.warm:
        warm_up(table.workspace, module)


def _spawn_warm(table: JobTable, job_id: str, module: str, slots: int) -> bool:
    if sys.platform != "linux":
        return False
    from .warm import ask, is_on

    try:
        return is_on() and ask(table.workspace, module, job_id, slots)
    except OSError:
        return False


def _reap() -> None:
    """Collect the first processes of earlier starts: they fork the worker and end at once."""
    with _starting_lock:
        _starting[:] = [process for process in _starting if process.poll() is None]


def settle(timeout_s: float = 5.0) -> None:
    """Wait until every start of this process has forked its worker [s]; before the process ends."""
    with _starting_lock:
        for process in _starting:
            process.wait(timeout=timeout_s)
        _starting.clear()

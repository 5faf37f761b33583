"""Start a job and answer within the client's patience: with its result, or with its id and progress."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

from ..execution import Job, JobStore, Terms, memory_cap, result_of, wall_cap
from ..worlds.errors import EngineError, WorldAgentError
from ..worlds.folder import WorldFolder
from ..worlds.ledger import Ledger
from ..worlds.limits import CAPS
from .answers import call
from .context import ToolContext
from .job_kinds import ENTRIES, KINDS, again
from .session import Session

__all__ = ["ENV_WAIT", "cut_short", "duration", "ended_data", "follow", "job_data", "patience", "progress_text", "start_and_wait"]

ENV_WAIT = "WORLDAGENT_WAIT_MAX_S"
"""Environment variable: the longest that a call waits for a job, whatever `wait_s` it was given [s]."""
WAIT_MAX_S = 50.0
"""Default of it: Claude Desktop and clients of the SDK cut calls at 60 s, and a call that is cut tells its model nothing."""
_EDITING = frozenset(("interior", "placing", "terrain"))
"""Kinds of jobs that make a revision themselves, which their results name."""
POLL_S = 0.5
SIGN_S = 4.0
"""A waiting call tells its progress at least so often [s]."""


def patience(wait_s: float) -> float:
    """Time that a call that was given `wait_s` waits [s]."""
    try:
        longest = float(os.environ.get(ENV_WAIT) or WAIT_MAX_S)
    except ValueError:
        longest = WAIT_MAX_S
    return min(wait_s, longest)


def cut_short(wait_s: float) -> list[str]:
    """Warning of a call that was to wait for longer than calls wait here; none where it waited as long as it was asked to."""
    longest = patience(wait_s)
    if longest >= wait_s:
        return []
    return [f"waited {longest:g} s of wait_s={wait_s:g}: no call waits longer here ({ENV_WAIT}); the job goes on, wait again"]


def duration(seconds: float) -> str:
    """A time [s] as a person says it: `20 s`, `12 min`, `2 h 5 min`."""
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"


def progress_text(job: Job, jobs: JobStore | None = None) -> str:
    """Present activity of a job and about how long it will take; with `jobs`, the reason why a queued one waits."""
    standing = jobs.standing(job) if jobs is not None and job.state == "queued" else None
    if standing is not None:
        ahead = f"{standing.ahead} job{'s' * (standing.ahead != 1)} ahead; " if standing.ahead else ""
        return f"{ahead}{standing.waits_for}"
    if job.state != "running":
        return ""
    left = "" if job.left_s is None else f", about {duration(job.left_s)} left"
    return f"{job.message or 'starting'}{left}"


def _fraction(job: Job) -> float | None:
    if job.state == "done":
        return 1.0
    return round(min(1.0, job.progress_done / job.progress_total), 3) if job.progress_total else None


def job_data(job: Job, jobs: JobStore | None = None, *, detail: bool = False) -> dict[str, Any]:
    """A job for the model; with `jobs`, what a queued one waits for; with `detail`, its times, caps and what it used."""
    data: dict[str, Any] = {
        "job_id": job.id,
        "kind": job.kind,
        "world": job.world,
        "state": job.state,
        "progress": _fraction(job),
        "message": "" if job.ended else progress_text(job, jobs),
        "seconds": round(max(0.0, (job.finished or time.time()) - job.started), 1) if job.started else 0.0,
    }
    if job.state == "running" and job.left_s is not None:
        data["left_s"] = round(job.left_s, 1)
    if job.error:
        data["error"] = job.error
    if detail:
        data |= _details(job)
    then = again(job).call if job.ended else call("job", action="wait", job_id=job.id)
    return {**data, "next": then} if then else data


def _details(job: Job) -> dict[str, Any]:
    times = {"submitted": job.created, "started": job.started, "ended": job.finished, "last_sign_of_life": job.heartbeat}
    return {
        **{name: _clock(value) for name, value in times.items() if value is not None},
        "asked": {k: v for k, v in job.payload.items() if k not in ("folder", "stamp") and v is not None},
        "priority": job.priority,
        "progress_done": job.progress_done,
        "progress_total": job.progress_total,
        "peak_memory_gb": None if job.peak_bytes is None else round(job.peak_bytes / 1e9, 3),
        "cpu_s": job.cpu_s,
        "cap_memory_gb": None if job.memory_bytes is None else round(job.memory_bytes / 1e9, 1),
        "cap_s": job.wall_s,
        "log": job.log,
    }


def _clock(seconds: float) -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))


def ended_data(job: Job) -> dict[str, Any]:
    """Result of a job that has ended, as `start_and_wait` returns it.

    Raises:
        WorldAgentError: The job failed with it, or was cancelled.
    """
    if job.state == "lost":
        what = again(job)
        raise EngineError(
            f"{(job.error or {}).get('message', 'lost')}. Next: {what.call}{what.keeps and f', which {what.keeps}'}"
        )
    return {"job_id": job.id, **_of_revision(job), **result_of(job)}


def _of_revision(job: Job) -> dict[str, Any]:
    """The revision for which a job was asked, and a warning where its world has moved on since."""
    asked, folder = job.payload.get("revision"), job.payload.get("folder")
    if asked is None or folder is None or job.kind in _EDITING:
        return {}
    path = WorldFolder(Path(folder)).ledger_path
    try:
        latest = Ledger(path).revision() if path.is_file() else asked
    except WorldAgentError:  # its ledger is damaged: the result says what it was about
        latest = asked
    if latest == asked:
        return {"revision": asked}
    moved = f"this is about revision {asked}: the world has moved on to revision {latest} since"
    return {"revision": asked, "warnings": [moved]}


def _turn(context: ToolContext, session: Session, kind: str, key: str, *, reuse: bool) -> str:
    """The key of the latest such job where it counts, else the next free one."""
    latest = context.jobs.latest(kind, session.folder.id, f"{key}#")
    if latest is None:
        return f"{key}#1"
    done = latest.state == "done" and not reuse
    return f"{key}#{int(str(latest.key).rpartition('#')[2]) + done}"


def follow(context: ToolContext, job: Job, wait_s: float) -> Job:
    """The job when it has ended or `wait_s` are over; its progress goes to the client meanwhile."""
    deadline = time.monotonic() + wait_s
    told, told_at = None, 0.0
    while not job.ended and (left := deadline - time.monotonic()) > 0 and not context.cancelled():
        job = context.jobs.wait(job.id, min(POLL_S, left))
        news = (job.state, job.progress_done, job.message)
        if not job.ended and (news != told or time.monotonic() - told_at > SIGN_S):
            context.progress(
                job.progress_done, job.progress_total, f"{job.kind}: {progress_text(job, context.jobs) or job.state}"
            )
            told, told_at = news, time.monotonic()
    return job


def start_and_wait(
    context: ToolContext,
    session: Session,
    kind: str,
    payload: dict[str, Any],
    *,
    wait_s: float,
    key: str,
    reuse: bool = True,
) -> dict[str, Any]:
    """Submit `worldagent.workflow.jobs:<kind>` and wait at most `wait_s` seconds, or as long as clients let a call wait.

    A running job of the same key is joined; the result of a done one is given again only with `reuse`.

    Returns the result (with `job_id`), or the job's state when it takes longer. The job goes on either way.

    Raises:
        LimitError: too many jobs wait already.
        WorldAgentError: the job failed with it.
    """
    began = time.time()
    job = context.jobs.submit(
        kind,
        session.folder.id,
        {"folder": str(session.folder.root), "revision": session.revision, "stamp": session.stamp(), **payload},
        entry=f"{ENTRIES}:{kind}",
        # The stamp tells a world from an earlier one of the same name whose jobs the workspace still remembers.
        terms=Terms(
            key=_turn(context, session, kind, f"{key}:{session.stamp()}", reuse=reuse),
            exclusive=KINDS[kind].alone,
            priority=KINDS[kind].priority,
            wall_s=wall_cap(kind, min(KINDS[kind].wall_s, CAPS["job_seconds"].value)),
            memory_bytes=memory_cap(CAPS["job_memory_bytes"].value),
            warm=True,
        ),
    )
    longest = patience(wait_s)
    if context.handover is not None:
        longest = min(longest, context.handover.patience_s)
    job = follow(context, job, longest)
    if not job.ended:
        if context.handover is not None:
            context.handover.job_id = job.id
            return job_data(job, context.jobs)
        return {**job_data(job, context.jobs), "warnings": cut_short(wait_s)}
    data = ended_data(job)
    if job.finished is not None and job.finished < began:
        note = f"nothing changed since job {job.id}: this is its result; nothing was run again"
        data["warnings"] = [*data.get("warnings", ()), note]
    return data

"""Floor 2: durable jobs in detached worker processes, progress, cancel, and work spread over processes.

Knows nothing of what worlds contain. Importing it is cheap: no numpy, no pydantic.
"""

from __future__ import annotations

from .context import JobContext
from .executor import Executor, ExecutorLocal
from .inline import run_inline
from .job import ENDED_STATES, JOB_STATES, Cancelled, Job, JobState, Progress, result_of
from .jobs import JobStore

__all__ = [
    "ENDED_STATES",
    "JOB_STATES",
    "Cancelled",
    "Executor",
    "ExecutorLocal",
    "Job",
    "JobContext",
    "JobState",
    "JobStore",
    "Progress",
    "result_of",
    "run_inline",
]

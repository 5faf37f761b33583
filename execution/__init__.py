"""Floor 2: durable jobs in detached worker processes, progress and cancel.

Knows nothing of what worlds contain. Importing it is cheap: no numpy, no pydantic.
"""

from __future__ import annotations

from .caps import memory_cap, wall_cap
from .collecting import seldom_collected
from .context import JobContext
from .inline import run_inline
from .job import BULK, ENDED_STATES, INTERACTIVE, JOB_STATES, NORMAL, Cancelled, Job, JobState, Progress, result_of
from .jobs import JobStore
from .one_core import ONE_THREAD, one_core
from .parts import Part, Tell
from .processes import core_count, die_with_parent, in_task
from .queue import Standing
from .terms import Terms
from .usage import machine_memory

__all__ = [
    "BULK",
    "ENDED_STATES",
    "INTERACTIVE",
    "JOB_STATES",
    "NORMAL",
    "ONE_THREAD",
    "Cancelled",
    "Job",
    "JobContext",
    "JobState",
    "JobStore",
    "Part",
    "Progress",
    "Standing",
    "Tell",
    "Terms",
    "core_count",
    "die_with_parent",
    "in_task",
    "machine_memory",
    "memory_cap",
    "one_core",
    "result_of",
    "run_inline",
    "seldom_collected",
    "wall_cap",
]

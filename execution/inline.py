"""Run an entry in this process, for tests and short work: same results, same errors, no row, no caps."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..worlds.errors import EngineError, WorldAgentError
from .context import JobContext
from .entries import as_json, checked_result, error_of, load_entry
from .job import Progress

__all__ = ["run_inline"]


def run_inline(
    entry: str,
    payload: dict[str, Any],
    *,
    workspace: Path | None = None,
    on_progress: Callable[[Progress], None] | None = None,
    cancel_asked: Callable[[], bool] | None = None,
) -> dict[str, Any]:
    """Result of an entry, as `result_of` would give it for a job.

    Raises:
        Cancelled: `cancel_asked` said so and the entry obeyed.
        WorldAgentError: What the entry raised; EngineError for any other exception.
    """
    context = JobContext(
        job_id="job_inline",
        report=on_progress or (lambda progress: None),
        cancel_asked=cancel_asked or (lambda: False),
        workspace=str(workspace.resolve()) if workspace is not None else None,
    )
    plain = json.loads(as_json(payload, "the payload"))
    try:
        return checked_result(entry, load_entry(entry)(plain, context))
    except WorldAgentError:
        raise
    except Exception as error:
        raise EngineError("{type}: {message}".format(**error_of(error))) from error

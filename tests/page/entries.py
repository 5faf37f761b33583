"""A job whose progress the test sets: it reports the number that stands in a file, and ends at 10."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from worldagent.execution import JobContext


def steady(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Report what the file says until it says 10."""
    file = Path(payload["file"])
    while True:
        context.check()
        done = float(file.read_text() or 0) if file.is_file() else 0.0
        context.progress(done, 10.0, f"step {done:.0f} of 10")
        if done >= 10:
            return {}
        time.sleep(0.02)

"""Folders for simulated worlds that a suite changes copies of: kept for the process, and gone with it."""

from __future__ import annotations

import atexit
import tempfile
from functools import cache
from pathlib import Path

__all__ = ["kept_folder"]


@cache
def _root() -> Path:
    made = tempfile.TemporaryDirectory(prefix="worldagent-defects-")
    atexit.register(made.cleanup)
    return Path(made.name)


def kept_folder(name: str) -> Path:
    """An empty folder that lives as long as the process."""
    return Path(tempfile.mkdtemp(prefix=f"{name}-", dir=_root()))

"""The workspace of a command that names none."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["ENV_WORKSPACE", "default_workspace"]

ENV_WORKSPACE = "WORLDAGENT_WORKSPACE"
"""Environment variable: root of all worlds where no command names another."""


def default_workspace() -> Path:
    """`$WORLDAGENT_WORKSPACE`, or `worldagent` in the home folder."""
    named = os.environ.get(ENV_WORKSPACE)
    return Path(named) if named else Path.home() / "worldagent"

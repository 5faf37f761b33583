"""Limits of this server that are both kept and told to clients; those of worlds stand in `worlds/limits.py`."""

from __future__ import annotations

__all__ = ["MAX_FILE_BYTES", "MAX_SESSIONS"]

MAX_SESSIONS = 512
"""Sessions of HTTP at one time."""
MAX_FILE_BYTES = 8_000_000
"""Largest file that is sent as a resource [bytes]."""

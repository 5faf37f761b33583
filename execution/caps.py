"""Caps of memory and time that a job gets where its submitter names none of its own: defaults and environment."""

from __future__ import annotations

import os

from ..worlds.errors import InputError
from .usage import machine_memory

__all__ = ["ENV_MEMORY", "ENV_WALL", "memory_cap", "wall_cap"]

ENV_MEMORY = "WORLDAGENT_JOB_MEMORY_GB"
"""Cap of the resident memory of one job [GB = 1e9 bytes]."""
ENV_WALL = "WORLDAGENT_JOB_WALL_S"
"""Cap of the running time of one job [s]; with `_BAKE`, `_FINAL`, ... behind it, of that kind only."""
MEMORY_SHARE = 0.85
"""Part of the machine's memory that one job may take: what is beyond belongs to the system and the server."""
MEMORY_LEAST = 2**26


def _number(name: str) -> float | None:
    text = os.environ.get(name)
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 < value < 1e12:
        raise InputError(f"{name}={text!r} in the server's environment must be a number > 0; correct or unset it")
    return value


def memory_cap(most: int | None = None) -> int:
    """Cap of the resident memory of a job [bytes]: the one that the environment names, else a share of the machine's, at `most`.

    Raises:
        InputError: The environment variable holds no positive number.
    """
    named = _number(ENV_MEMORY)
    share = int(MEMORY_SHARE * machine_memory())
    return max(MEMORY_LEAST, int(named * 1e9) if named is not None else min(share, most or share))


def wall_cap(kind: str, default_s: float) -> float:
    """Cap of the running time of a job of this kind [s]; errors as `memory_cap`."""
    return _number(f"{ENV_WALL}_{kind.upper()}") or _number(ENV_WALL) or default_s

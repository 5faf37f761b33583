"""On which terms a job runs: what it may use, what it excludes, when its turn comes."""

from __future__ import annotations

from dataclasses import dataclass

from ..worlds.errors import InputError

__all__ = ["NAME_MAX", "Terms", "check_name"]

NAME_MAX = 200
_LEAST_MEMORY = 2**26


def check_name(name: str, text: str | None) -> None:
    """Refuse a name that is empty or too long.

    Raises:
        InputError: It is.
    """
    if text is not None and not 1 <= len(text) <= NAME_MAX:
        raise InputError(f"{name} must have 1 to {NAME_MAX} characters, it has {len(text)}")


@dataclass(frozen=True)
class Terms:
    """Terms of one job.

    Raises:
        InputError: A value is out of range.
    """

    key: str | None = None
    """Idempotency key. A job of the same kind, world, and key that is queued, running, or done is returned instead;
    one that failed, was cancelled, or got lost is run anew."""
    exclusive: bool = False
    """True if it writes its world: such jobs of one world run one after another."""
    priority: int = 0
    """Higher starts first: `BULK`, `NORMAL` or `INTERACTIVE`. Of equal ones the worlds take turns."""
    wall_s: float | None = None
    """Cap of its running time [s]."""
    memory_bytes: int | None = None
    """Cap of the resident memory of all its processes together [bytes], measured a few times a second; what GPUs hold
    does not count."""
    warm: bool = False
    """True if it may start in a process that has the engines of its entry's module loaded, where one waits (see
    `JobStore.warm_up`). The module names them in its `WARM`."""

    def __post_init__(self) -> None:
        check_name("key", self.key)
        if self.wall_s is not None and not self.wall_s > 0:
            raise InputError(f"wall_s {self.wall_s} must be > 0 s")
        if self.memory_bytes is not None and not self.memory_bytes >= _LEAST_MEMORY:
            raise InputError(f"memory_bytes {self.memory_bytes} must be >= {_LEAST_MEMORY} (64 MiB)")

"""Words of the register for a value that is looser than its default."""

from __future__ import annotations

__all__ = ["times"]


def times(value: float, usual: float) -> str:
    """The value over its default, and the default."""
    return f"{value / usual:.3g} times the default of {usual:g}"

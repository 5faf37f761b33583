"""Findings of the audit: where something is wrong, and the edit that mends it."""

from __future__ import annotations

from typing import Any, NamedTuple

__all__ = ["Problem", "removed", "replaced"]


class Problem(NamedTuple):
    """One finding: where, what to do, and the edit that would do it where there is only one."""

    pointer: str
    text: str
    patch: dict[str, Any] | None = None


def replaced(pointer: str, value: Any) -> dict[str, Any]:
    """The edit that puts `value` at `pointer`."""
    return {"op": "replace", "path": pointer, "value": value}


def removed(pointer: str) -> dict[str, Any]:
    """The edit that takes away what stands at `pointer`."""
    return {"op": "remove", "path": pointer}

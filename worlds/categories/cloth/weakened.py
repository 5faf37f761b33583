"""Edits of cloth that ask for less and that no direction of a number tells (R157)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

__all__ = ["weakenings"]


def weakenings(place: str, old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Layers that pass through each other, and bodies that the cloth passes through, in words.

    Args:
        place: pointer of the physics.
        old: the physics before the edit, as JSON without nulls.
        new: the physics after it.
    """
    if old["self_collision"] and not new.get("self_collision", True):
        yield f"{place}/self_collision taken away"
    for other in sorted(set(new.get("ignores", ())) - set(old["ignores"])):
        yield f"{place}/ignores {other}"

"""Edits that only build on: new entities with what belongs to them, while nothing that was there changes.

Such an edit repairs nothing, so that the rules of repair (R111-R113) ask it for no hypothesis while only static rows fail: who sets up a scene
places one thing after the other, and the table may come after the lamp that is to stand on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["only_builds_on"]

OF_ENTITIES = ("graph", "simulation", "interiors", "assemblies")
"""Parts of a specification in which what is new must name a new entity."""
FREE = ("entities", "materials")
"""Collections that may grow by anything new."""


def only_builds_on(before: Mapping[str, Any], after: Mapping[str, Any]) -> bool:
    """True if one document is the other with new entities, their materials, memberships and relations.

    Args:
        before: a specification as JSON.
        after: the specification after the edit.
    """
    new = set(after.get("entities", {})) - set(before.get("entities", {}))
    if not new:
        return False
    return all(
        _grown(before.get(key, {}), value, free=key in FREE, names=new if key in OF_ENTITIES else frozenset())
        if key in FREE + OF_ENTITIES
        else before.get(key) == value
        for key, value in after.items()
    ) and set(before) <= set(after)


def _grown(before: Any, after: Any, *, free: bool, names: set[str] | frozenset[str]) -> bool:
    """True if everything of `before` stands in `after`, and what is new may be there."""
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        kept = set(before) <= set(after) and all(_grown(before[k], after[k], free=False, names=names) for k in before)
        return kept and all(free or _mentions(after[k], names) for k in set(after) - set(before))
    if isinstance(before, list) and isinstance(after, list):
        rest = iter(after)
        added = [a for a in after if a not in before]
        return all(b in rest for b in before) and all(_mentions(a, names) for a in added)
    return bool(before == after)


def _mentions(value: Any, names: set[str] | frozenset[str]) -> bool:
    """True if a new entity is named anywhere in a value."""
    if isinstance(value, str):
        return value in names
    if isinstance(value, Mapping):
        return any(_mentions(v, names) for v in value.values())
    return isinstance(value, Sequence) and any(_mentions(v, names) for v in value)

"""Predicates told of others: the same of another body, or with roles swapped."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ...worlds.predicates import atoms_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...worlds.spec import SpecModel

__all__ = ["mapped", "told_of"]

WHO = ("entity", "a", "b", "on", "other", "target")
"""Fields of an atom that name entities."""


def mapped(predicate: SpecModel, change: Callable[[SpecModel], SpecModel]) -> SpecModel:
    """The predicate with every atom changed."""
    if atoms_of(predicate) == [predicate]:
        return change(predicate)
    changes: dict[str, object] = {}
    for name in type(predicate).model_fields:
        value = getattr(predicate, name)
        if hasattr(value, "model_fields_set"):
            changes[name] = mapped(value, change)
        elif isinstance(value, list) and value and hasattr(value[0], "model_fields_set"):
            changes[name] = [mapped(v, change) for v in value]
    return predicate.model_copy(update=changes)


def told_of(predicate: SpecModel, body: str, other: str) -> SpecModel:
    """The predicate with another entity in the place of one."""
    return mapped(predicate, partial(_renamed, body, other))


def _renamed(body: str, other: str, atom: SpecModel) -> SpecModel:
    return atom.model_copy(update={n: other for n in WHO if getattr(atom, n, None) == body})

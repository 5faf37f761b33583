"""Small worlds of version 2: bodies of `small_worlds.py`, a prompt, and claims of its spans."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...worlds.spec import WorldSpec

__all__ = ["claimed"]


def claimed(spec: WorldSpec, prompt: str, claims: Mapping[str, tuple[str, str, list[str]]]) -> WorldSpec:
    """The world with a prompt whose spans are claimed.

    Args:
        spec: of version 1, without clauses.
        prompt: all of it.
        claims: by id: quote, type, and the pointers that it is judged by.
    """
    document: dict[str, Any] = spec.model_dump(mode="json")
    document.pop("clauses", None)
    made = {name: {"quote": quote, "type": of, "by": by} for name, (quote, of, by) in claims.items()}
    return WorldSpec.model_validate({**document, "spec_version": "2", "prompt": prompt, "claims": made})

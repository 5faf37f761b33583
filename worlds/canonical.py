"""Canonical JSON (RFC 8785) and hashes over it."""

from __future__ import annotations

import hashlib
import json
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel

__all__ = ["canonical_json", "digest_of", "source_digest", "spec_digest"]


def canonical_json(value: Any) -> bytes:
    """RFC 8785 bytes of a JSON value; models are dumped first. Numbers are doubles, as the RFC has them."""
    import rfc8785

    if isinstance(value, BaseModel):
        value = value.model_dump(mode="json")
    return rfc8785.dumps(value)


def _plain(value: Any) -> Any:
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json")
    raise TypeError(f"{type(value).__name__} is not JSON")


def digest_of(*values: Any) -> str:
    """SHA-256 over sorted compact JSON of the values, hex: for recipes, which no other program reads."""
    state = hashlib.sha256()
    for value in values:
        state.update(json.dumps(value, sort_keys=True, separators=(",", ":"), default=_plain).encode())
        state.update(b"\x00")
    return state.hexdigest()


def spec_digest(spec: BaseModel) -> str:
    """SHA-256 of a specification's RFC 8785 bytes, hex: what other programs can reproduce."""
    return hashlib.sha256(canonical_json(spec)).hexdigest()


@lru_cache(maxsize=64)
def source_digest(folder: Path) -> str:
    """SHA-256 over the Python files of a producer's folder: part of what its artifacts derive from."""
    state = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        state.update(path.relative_to(folder).as_posix().encode())
        state.update(path.read_bytes())
    return state.hexdigest()

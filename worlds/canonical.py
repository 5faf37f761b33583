"""Canonical JSON (RFC 8785) and hashes over it."""

from __future__ import annotations

import hashlib
import json
import math
import re
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel

__all__ = ["canonical_json", "digest_of", "source_changed", "source_digest", "spec_digest"]


def canonical_json(value: Any) -> bytes:
    """RFC 8785 bytes of a JSON value; models are dumped first. Numbers are doubles, as the RFC has them."""
    import rfc8785

    if isinstance(value, BaseModel):
        value = value.model_dump(mode="json")
    try:
        # The standard encoder writes these very bytes, many times faster, where numbers and keys are ordinary.
        text = json.dumps(_ordinary(value), sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
        return _MARKED.sub(r"\1", text).encode()
    except (_UnusualError, UnicodeEncodeError):
        return rfc8785.dumps(value)


def _number(value: float) -> str:
    import rfc8785

    return rfc8785.dumps(value).decode()


class _UnusualError(Exception):
    """Something that Python and ECMAScript write or sort differently."""


def _ordinary(value: Any) -> Any:
    """The value with whole floats as integers, and marked texts for floats that Python writes with an exponent.

    Raises:
        _UnusualError: a number that the RFC does not allow, a key that is not ASCII, a mark in a key or text, or no JSON at all.
    """
    kind = type(value)
    if kind is bool or value is None:
        return value
    if kind is str:
        if _MARK in value:
            raise _UnusualError
        return value
    if kind is float:
        if value.is_integer():
            value, kind = int(value), int
        elif _PLAIN_LEAST <= abs(value) < _PLAIN_LARGEST:
            return value
        elif math.isfinite(value):
            return _MARK + _number(value)
    if kind is int and -_WHOLE_LARGEST <= value <= _WHOLE_LARGEST:
        return value
    if kind is dict and all(type(key) is str and key.isascii() and _MARK not in key for key in value):
        return {key: _ordinary(item) for key, item in value.items()}
    if kind is list or kind is tuple:
        return [_ordinary(item) for item in value]
    raise _UnusualError


_PLAIN_LEAST, _PLAIN_LARGEST = 1e-4, 1e16
"""Between these Python writes a float without an exponent, as ECMAScript does between 1e-6 and 1e21."""
_MARK = "\x00"
_MARKED = re.compile(r'"\\u0000([^"]*)"')
_WHOLE_LARGEST = 2**53 - 1
"""Largest integer of the RFC."""


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
def source_digest(*folders: Path) -> str:
    """SHA-256 over the Python files of a producer's folders: part of what its artifacts derive from."""
    state = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.rglob("*.py")):
            state.update(path.relative_to(folder).as_posix().encode())
            state.update(path.read_bytes())
    return state.hexdigest()


def source_changed(*folders: Path) -> bool:
    """True where a producer's files are others than when `source_digest` first read them: the program changed under this process."""
    return source_digest.__wrapped__(*folders) != source_digest(*folders)

"""Canonical JSON (RFC 8785) and hashes over it."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from .documents import document_of

__all__ = ["Encoded", "canonical_json", "digest_of", "source_changed", "source_digest", "spec_digest"]


def canonical_json(value: Any) -> bytes:
    """RFC 8785 bytes of a JSON value; models are dumped first. Numbers are doubles, as the RFC has them."""
    import rfc8785

    if isinstance(value, BaseModel):
        value = value.model_dump(mode="json")
    marked: list[float] = []
    try:
        # The standard encoder writes these very bytes, many times faster, where numbers and keys are ordinary.
        plain = _ordinary(value, marked)
        text = json.dumps(plain, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
        if text.count(_WRITTEN_MARK) == len(marked):
            return _MARKED.sub(r"\1", text).encode()
    except (_UnusualError, UnicodeEncodeError):
        pass
    return rfc8785.dumps(value)


def _number(value: float) -> str:
    import rfc8785

    return rfc8785.dumps(value).decode()


class _UnusualError(Exception):
    """Something that Python and ECMAScript write or sort differently."""


def _ordinary(value: Any, marked: list[float]) -> Any:
    """The value with whole floats as integers, and marked texts for floats that Python writes with an exponent.

    Args:
        value: JSON.
        marked: takes the floats that are marked texts now; where the whole text has more marks, it has some of its own.

    Raises:
        _UnusualError: a number that the RFC does not allow, a key that is not ASCII, or no JSON at all.
    """
    kind = type(value)
    if kind in _LEAVES:
        return value
    if kind is float:
        if value.is_integer():
            value, kind = int(value), int
        elif _PLAIN_LEAST <= abs(value) < _PLAIN_LARGEST:
            return value
        elif math.isfinite(value):
            marked.append(value)
            return _MARK + _number(value)
    if kind is int and -_WHOLE_LARGEST <= value <= _WHOLE_LARGEST:
        return value
    if kind is dict and _are_ascii(value):
        return {key: item if type(item) in _LEAVES else _ordinary(item, marked) for key, item in value.items()}
    if kind is list or kind is tuple:
        return [item if type(item) in _LEAVES else _ordinary(item, marked) for item in value]
    raise _UnusualError


def _are_ascii(keys: Mapping[Any, Any]) -> bool:
    try:
        return all(map(str.isascii, keys))
    except TypeError:  # a key that is no text
        return False


_PLAIN_LEAST, _PLAIN_LARGEST = 1e-4, 1e16
"""Between these Python writes a float without an exponent, as ECMAScript does between 1e-6 and 1e21."""
_LEAVES = frozenset((str, bool, type(None)))
_MARK, _WRITTEN_MARK = "\x00", "\\u0000"
_MARKED = re.compile(r'"\\u0000([^"]*)"')
_WHOLE_LARGEST = 2**53 - 1
"""Largest integer of the RFC."""


def _plain(value: Any) -> Any:
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json")
    raise TypeError(f"{type(value).__name__} is not JSON")


class Encoded(bytes):
    """Sorted compact JSON of a value, for values that stand in many digests."""

    @classmethod
    def of(cls, value: Any) -> Encoded:
        """The bytes of a value; models are dumped."""
        return cls(_RECIPE.encode(value).encode())


_RECIPE = json.JSONEncoder(sort_keys=True, separators=(",", ":"), default=_plain)


def digest_of(*values: Any) -> str:
    """SHA-256 over sorted compact JSON of the values, hex: for recipes, which no other program reads."""
    state = hashlib.sha256()
    for value in values:
        state.update(value if type(value) is Encoded else Encoded.of(value))
        state.update(b"\x00")
    return state.hexdigest()


def spec_digest(spec: BaseModel) -> str:
    """SHA-256 of a specification's RFC 8785 bytes, hex: what other programs can reproduce."""
    return hashlib.sha256(canonical_json(document_of(spec))).hexdigest()


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

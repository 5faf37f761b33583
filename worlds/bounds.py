"""Bounds of JSON that comes from outside, held before anything is done with it; and values in short, for error texts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from .errors import InputError
from .limits import CAPS, check_cap

__all__ = ["Extent", "check_document", "extent", "shown"]

MAX_INTEGER_BITS = 1024
"""No field takes a larger number; Python refuses to print integers of more than 4,300 digits."""
TEXT_PER_VALUE = 64
"""Characters that count as one value."""


class Extent(NamedTuple):
    """Size of a JSON value."""

    values: int
    """Members, items and the value itself; long text counts as several."""
    depth: int
    """Levels of objects and arrays."""


def extent(value: Any, *, most: float = math.inf, what: str, finite: bool = False) -> Extent:
    """Count a JSON value, not much further than `most` values.

    Args:
        value: the value.
        most: where to stop.
        what: what it is, for the text.
        finite: also refuse NaN and infinities. A specification's own types tell where they stand.

    Raises:
        InputError: a number is no number or beyond all fields, or a text is no Unicode (a lone surrogate).
    """
    count, deepest = 0, -1
    stack: list[tuple[Any, int]] = [((value,), 0)]
    while stack and count <= most:
        at, depth = stack.pop()
        deepest = max(deepest, depth)
        if isinstance(at, dict):
            count += sum(_text(key, what) for key in at if len(key) >= TEXT_PER_VALUE or not key.isascii())
        count += len(at)
        for item in () if count > most else at.values() if isinstance(at, dict) else at:
            if isinstance(item, float):
                if finite and not math.isfinite(item):
                    raise InputError(f"{what} holds {item}; give finite numbers only")
            elif isinstance(item, str):
                count += _text(item, what)
            elif isinstance(item, dict | list | tuple):
                stack.append((item, depth + 1))
            elif isinstance(item, int) and item.bit_length() > MAX_INTEGER_BITS:
                raise InputError(f"{what} holds {shown(item)}; no field takes more than {MAX_INTEGER_BITS}")
    return Extent(count, deepest)


def _text(text: str, what: str) -> int:
    if not text.isascii():
        try:
            text.encode()
        except UnicodeEncodeError as error:
            raise InputError(f"{what} holds a text that is no Unicode: {shown(text)}; send well-formed UTF-8") from error
    return len(text) // TEXT_PER_VALUE


def check_document(value: Any, what: str) -> None:
    """Refuse a JSON value that no specification needs.

    Raises:
        LimitError: too many values, levels or entities.
        InputError: as `extent`.
    """
    entities = value.get("entities") if isinstance(value, dict) else None
    if isinstance(entities, dict):
        check_cap("entities", len(entities), what=what)
    found = extent(value, most=CAPS["spec_values"].value, what=what)
    check_cap("spec_values", found.values, what=what)
    check_cap("spec_depth", found.depth, what=what)


def shown(value: Any, characters: int = 80) -> str:
    """The first characters of `repr(value)`, without writing all of it."""
    text = _start(value, characters + 1)
    return text if len(text) <= characters else text[: characters - 3] + "..."


def _start(value: Any, room: int) -> str:
    if isinstance(value, str | bytes):
        return repr(value[:room])
    if isinstance(value, int) and value.bit_length() > MAX_INTEGER_BITS:
        return f"an integer of {value.bit_length()} bits"
    if not isinstance(value, dict | list | tuple):
        return repr(value)
    pairs, text = isinstance(value, Mapping), "{" if isinstance(value, Mapping) else "["
    for key in value:
        if len(text) > room:
            return text
        text += ", " if len(text) > 1 else ""
        text += f"{_start(key, room)}: " if pairs else _start(key, room - len(text))
        text += _start(value[key], room - len(text)) if pairs else ""
    return text + ("}" if pairs else "]")

"""Entries: the functions that jobs may call, named as `package.module:function`.

Only functions of this package can be named, so that a job row or a tool argument cannot run foreign code. Tests
name the top-level modules of their own entries, comma-separated, in the environment variable
WORLDAGENT_TEST_ENTRIES; nothing else may set it.
"""

from __future__ import annotations

import importlib
import json
import os
import re
from collections.abc import Callable
from types import FunctionType
from typing import Any

from ..worlds.errors import EngineError, InputError, LimitError, RefusedError, WorldAgentError
from ..worlds.storage import storage_failure

__all__ = ["JSON_BYTES_MAX", "as_json", "check_entry", "check_module", "checked_result", "error_of", "load_entry"]

JSON_BYTES_MAX = 4_000_000
"""Cap of a payload and of a result [bytes]: own choice; arrays go to files, rows carry paths."""

_ENTRY = re.compile(r"(?P<package>[A-Za-z_]\w*)(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*", re.ASCII)
_MESSAGE_MAX = 8000


def _allowed_packages() -> set[str]:
    extra = os.environ.get("WORLDAGENT_TEST_ENTRIES", "")
    return {__name__.partition(".")[0], *(name.strip() for name in extra.split(",") if name.strip())}


def check_entry(entry: str) -> str:
    """Return `entry` if it names a function of this package.

    Raises:
        InputError: It is not of the form `package.module:function`.
        RefusedError: It names code outside this package.
    """
    match = _ENTRY.fullmatch(entry)
    if match is None:
        raise InputError(f"entry {entry!r} is not of the form 'worldagent.module:function'")
    if match["package"] not in _allowed_packages():
        raise RefusedError(f"entry {entry!r} lies outside 'worldagent.'; jobs run functions of this package only")
    return entry


def check_module(module: str) -> str:
    """Return `module` if it is one that may hold entries.

    Raises:
        InputError: It is no dotted name.
        RefusedError: It lies outside this package.
    """
    return check_entry(f"{module}:f").partition(":")[0]


def load_entry(entry: str) -> Callable[..., Any]:
    """Import the function that `entry` names.

    Raises:
        InputError: The form is wrong, or the name is no function of that module's package.
        RefusedError: It names code outside this package.
    """
    module_name, _, name = check_entry(entry).partition(":")
    function = getattr(importlib.import_module(module_name), name, None)
    if not isinstance(function, FunctionType):
        raise InputError(f"entry {entry!r}: module {module_name!r} has no function {name!r}")
    if function.__module__.partition(".")[0] not in _allowed_packages():
        raise RefusedError(f"entry {entry!r} is a function of {function.__module__!r}, outside 'worldagent.'")
    return function


def as_json(value: Any, what: str) -> str:
    """Strict, compact JSON of `value`; `what` names it in errors.

    Raises:
        InputError: Not plain data, or a number is not finite.
        LimitError: More than JSON_BYTES_MAX.
    """
    try:
        text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    except (TypeError, ValueError) as error:
        raise InputError(f"{what} is not plain JSON data: {error}; use finite numbers, text, lists, and dicts") from error
    if len(text) > JSON_BYTES_MAX:
        raise LimitError(f"{what} is {len(text)} bytes of JSON, the cap is {JSON_BYTES_MAX}; write a file, pass its path")
    return text


def checked_result(entry: str, result: Any) -> dict[str, Any]:
    """`result` written as JSON and read again, as a caller in another process gets it.

    Raises:
        EngineError: The result is no dict of plain data.
        LimitError: More than JSON_BYTES_MAX.
    """
    if not isinstance(result, dict):
        raise EngineError(f"entry {entry!r} returned {type(result).__name__}, not a dict")
    try:
        plain: dict[str, Any] = json.loads(as_json(result, f"the result of {entry!r}"))
    except LimitError:
        raise
    except InputError as error:
        raise EngineError(str(error)) from error
    return plain


def error_of(error: BaseException) -> dict[str, str]:
    """`type` and `message` of an exception, as a job row keeps them.

    A subclass that a floor above made of one of worldagent's errors is named by that error.
    """
    error = storage_failure(error) or error
    name = type(error).__name__
    if isinstance(error, WorldAgentError):
        name = next((kind.__name__ for kind in type(error).__mro__ if kind.__module__ == WorldAgentError.__module__), name)
    return {"type": name, "message": str(error)[:_MESSAGE_MAX]}

"""Validity of JSON-RPC messages, and the error that answers an invalid one.

The SDK lets much of it pass or drops it in silence, in another way on each transport. Here one rule holds for all: strict
JSON (RFC 8259: no NaN, no lone surrogate, UTF-8), one object, of JSON-RPC 2.0. Text that is no JSON is answered with -32700,
JSON that is no message with -32600 (JSON-RPC 2.0, section 5.1), both with the request's id where it can be told.
"""

from __future__ import annotations

import re
from typing import Any

import pydantic_core
from mcp.types import ErrorData, JSONRPCError
from mcp_types import jsonrpc_message_adapter
from mcp_types.jsonrpc import INVALID_REQUEST, PARSE_ERROR
from pydantic import ValidationError

__all__ = ["EDGE", "MESSAGE_BYTES", "defect_of", "too_long"]

MESSAGE_BYTES = 4 * 1024 * 1024
"""Largest message [bytes]: the SDK's cap of an HTTP body, so that both transports take the same."""
EDGE = 2048
"""Bytes of each end of a message that is too long in which its id is looked for."""
_ID = rb'"id"\s*:\s*(-?\d{1,18}|"[^"\\\x00-\x1f]{1,128}")\s*'
_ID_AHEAD = re.compile(rb'\s*\{(?:\s*"(?:jsonrpc|method)"\s*:\s*"[^"\\]*"\s*,)*\s*' + _ID + rb"[,}]")
_ID_BEHIND = re.compile(_ID + rb'(?:,\s*"jsonrpc"\s*:\s*"2\.0"\s*)?\}\s*$')


def too_long(ends: bytes, size: int) -> JSONRPCError:
    """The answer to a message of `size` bytes of which only the ends were kept."""
    found = _ID_AHEAD.match(ends) or _ID_BEHIND.search(ends)
    name = pydantic_core.from_json(found.group(1)) if found else None
    return _error(
        name,
        INVALID_REQUEST,
        f"message of {size} bytes, at most {MESSAGE_BYTES} are read; split it: create the world with a part of the "
        "specification and add the rest by patches",
    )


def defect_of(line: bytes) -> JSONRPCError | None:
    """Error that answers an invalid message; None for valid ones, and for those that need no answer."""
    if not line or line.isspace():
        return None
    try:
        decoded = pydantic_core.from_json(line, allow_inf_nan=False)
    except ValueError as error:
        return _error(None, PARSE_ERROR, f"no JSON: {error}")
    if not isinstance(decoded, dict):
        what = "a batch; send one message at a time" if isinstance(decoded, list) else f"a JSON {type(decoded).__name__}"
        return _error(None, INVALID_REQUEST, f"a message is one JSON object, this is {what}")
    name = decoded.get("id")
    known = isinstance(name, str | int) and not isinstance(name, bool)
    if "method" in decoded and "id" in decoded and not known:
        return _error(None, INVALID_REQUEST, f"the id of a request is a string or an integer, not {_shown(name)}")
    try:
        jsonrpc_message_adapter.validate_python(decoded, by_name=False)
    except ValidationError:
        if "method" not in decoded and ("result" in decoded or "error" in decoded):
            return None
        wrong = "; ".join(_wrong(decoded)) or "it is neither a request nor a notification"
        return _error(name if known else None, INVALID_REQUEST, f"no JSON-RPC 2.0 message: {wrong}")
    return None


def _wrong(decoded: dict[str, Any]) -> list[str]:
    found = []
    if decoded.get("jsonrpc") != "2.0":
        found.append(f"jsonrpc is {_shown(decoded.get('jsonrpc'))}, not '2.0'")
    if not isinstance(decoded.get("method"), str):
        found.append(f"method is {_shown(decoded.get('method'))}, not a string")
    if not isinstance(decoded.get("params", {}), dict):
        found.append(f"params is {_shown(decoded['params'])}, not an object")
    return found


def _shown(value: Any) -> str:
    if isinstance(value, dict | list):
        return "an object" if isinstance(value, dict) else "an array"
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _error(name: str | int | None, code: int, message: str) -> JSONRPCError:
    return JSONRPCError(jsonrpc="2.0", id=name, error=ErrorData(code=code, message=message))

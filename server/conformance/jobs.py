"""Entries of the fixtures' jobs: they run in worker processes like every other job."""

from __future__ import annotations

import time
from typing import Any

from ...execution import JobContext
from ...worlds.errors import RefusedError
from ..extensions.inputs import ask

__all__ = ["break_protocol", "confirm", "fail", "greet_later", "multiply", "sleep"]

_TICK_S = 0.05


def sleep(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Take `seconds` [s], with progress."""
    seconds, begin = float(payload["seconds"]), time.monotonic()
    while (passed := time.monotonic() - begin) < seconds:
        context.check()
        context.progress(passed, seconds, f"{payload['label']}: {passed:.1f} of {seconds:g} s")
        time.sleep(_TICK_S)
    return {"label": payload["label"], "seconds": seconds}


def fail(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """End with an error of the tool."""
    raise RefusedError("this job always fails; it is a fixture")


def break_protocol(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """End with what becomes an error of the protocol."""
    return {"code": -32603, "message": "this job always breaks the protocol; it is a fixture"}


def confirm(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Ask before something is deleted (nothing is)."""
    answers = ask(context, {"confirm": _form(f"Delete {payload['filename']}?", "confirm", "boolean")})
    agreed = answers["confirm"].get("action") == "accept" and bool(answers["confirm"].get("content", {}).get("confirm"))
    return {"filename": payload["filename"], "deleted": agreed}


def multiply(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Ask two questions at a time."""
    answers = ask(context, {"first": _form("First name?", "name", "string"), "second": _form("Second name?", "name", "string")})
    return {"names": [str(answers[key].get("content", {}).get("name", "")) for key in ("first", "second")]}


def greet_later(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Greet who was asked for before the job began."""
    return {"greeting": f"Hello, {payload['name']}!"}


def _form(message: str, field: str, kind: str) -> dict[str, Any]:
    schema = {"type": "object", "properties": {field: {"type": kind}}, "required": [field]}
    return {"method": "elicitation/create", "params": {"message": message, "requestedSchema": schema}}

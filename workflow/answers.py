"""Replies: a stable head (summary, warnings, next), pages, and a size that clients take whole."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from ..worlds.errors import InputError
from .rows import Detail, shaped

__all__ = [
    "HEAD_SCHEMA",
    "MAX_CHARACTERS",
    "answer",
    "call",
    "fitted",
    "job_answer",
    "paged",
    "rows_answer",
    "size_of",
    "weaker_told",
]

MAX_CHARACTERS = 20_000
"""Largest reply: clients cut or refuse longer ones, each in its own way."""
PAGE_CHARACTERS = 6500
"""Target size of a page: some clients cut at 10 KiB."""
HEAD_SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {
        "summary": {"type": "string", "description": "What happened, in a sentence"},
        "warnings": {"type": "array", "items": {"type": "string"}, "description": "What to know before going on"},
        "next": {"type": "string", "description": "The call to make now"},
    },
    "additionalProperties": True,
}
"""Output schema of every tool that returns data."""


def answer(data: Mapping[str, Any], summary: str, next_call: str, warnings: Sequence[str] = ()) -> dict[str, Any]:
    """Data with its head in front; warnings of the data come along."""
    told = [*(str(w) for w in data.get("warnings", ())), *warnings]
    rest = {k: v for k, v in data.items() if k not in ("summary", "warnings", "next")}
    return {"summary": summary, "warnings": told, "next": next_call, **rest}


def call(tool: str, **arguments: Any) -> str:
    """A tool call as text."""
    return f"{tool}({', '.join(f'{k}={v!r}' for k, v in arguments.items() if v is not None)})"


def size_of(value: Any) -> int:
    """Characters of a value as compact JSON."""
    return len(json.dumps(value, separators=(",", ":"), ensure_ascii=False, default=str))


def paged(items: Sequence[Any], offset: int, limit: int, *, room: int = PAGE_CHARACTERS) -> tuple[list[Any], dict[str, Any]]:
    """One page of items, and where it lies: `total`, and `next_offset` where there are more.

    A page ends at `limit` items or when its room is used up, but holds at least one.

    Raises:
        InputError: the offset is past the end.
    """
    if offset and offset >= len(items):
        raise InputError(
            f"offset {offset} is past the end: there are {len(items)} items, so offset is 0 to {max(0, len(items) - 1)}"
        )
    page: list[Any] = []
    for item in items[offset : offset + limit]:
        room -= size_of(item)
        if page and room < 0:
            break
        page.append(item)
    end = offset + len(page)
    return page, {
        "total": len(items),
        **({"offset": offset} if offset else {}),
        **({"next_offset": end} if end < len(items) else {}),
    }


def rows_answer(world: str, data: Mapping[str, Any], detail: Detail, summary: str, next_call: str) -> dict[str, Any]:
    """An answer whose `open_rows` are said as asked for, with how to read what is left out."""
    found = list(data.get("open_rows", ()))
    told = shaped(found, detail, world=world)
    total = int(data.get("open_total", len(found)))
    rest = {k: v for k, v in data.items() if k not in ("open_rows", "open_total", "more_open_rows")}
    said = {**rest, "open_rows": told}
    if total > len(told):
        left = [r["id"] for r in found[len(told) :]] + list(data.get("more_open_rows", ()))
        more = call("inspect_world", world=world, part="matrix", status="open", offset=len(told))
        said["more_open_rows"] = f"{total - len(told)} more open rows ({', '.join(left[:3])}, ...): {more}"
    return answer(said, summary, next_call)


def weaker_told(outcome: Mapping[str, Any]) -> list[str]:
    """Warnings of an edit that makes something easier, which the acceptance prints."""
    return [f"recorded as a weakening edit, printed with the acceptance: {w}" for w in outcome.get("weakenings_recorded", ())[:5]]


def job_answer(data: Mapping[str, Any]) -> dict[str, Any]:
    """The state of a job that has not ended, with what its work was estimated to take until some of it is measured; without one, nothing of it."""
    progress, estimate = data.get("progress"), data.get("estimate_s")
    share = "" if progress is None else f", {100 * progress:.0f} %"
    awaited = estimate and not progress and data["seconds"] < estimate
    whole = f"; {data.get('estimate_of', 'all of it')} was estimated at about {estimate:g} s beforehand" if awaited else ""
    message = f": {data['message']}" if data.get("message") else ""
    summary = f"{data['kind']} of {data['world']} is {data['state']}{share} after {data['seconds']:g} s{whole}{message}"
    known = {k: v for k, v in data.items() if estimate is not None or k not in ("estimate_s", "estimate_of")}
    return answer(known, summary, call("job", action="wait", job_id=data["job_id"]))


def fitted(data: dict[str, Any], cap: int = MAX_CHARACTERS) -> dict[str, Any]:
    """Data within the cap: the longest lists and texts are cut, and `truncated` says which and how to get more."""
    if size_of(data) <= cap:
        return data
    told: dict[str, Any] = json.loads(json.dumps(data, default=str))
    notes: list[str] = []
    for _ in range(60):
        over = size_of(told) - (cap - 1000)
        if over <= 0:
            break
        notes.append(_cut_longest(told, over))
    told["truncated"] = list(dict.fromkeys(notes))[:8]
    told["warnings"] = [
        *told.get("warnings", ()),
        f"this reply was cut to {cap} characters (see truncated); ask for less at a time with limit, offset, pointer or entities",
    ]
    return told


def _cut_longest(node: Any, over: int, path: str = "") -> str:
    """Shorten the largest list or text below a node by about `over` characters; says what was done."""
    items = list(node.items() if isinstance(node, dict) else enumerate(node))
    key, value = max(items, key=lambda item: size_of(item[1]))
    where = f"{path}/{key}"
    if isinstance(value, str):
        node[key] = f"{value[: max(100, len(value) - over - 20)]}..."
        return f"{where}: text of {len(value)} characters cut"
    if isinstance(value, list) and len(value) > 1 and max(map(size_of, value)) < 0.8 * size_of(value):
        kept = max(1, int(len(value) * (1 - min(0.9, over / size_of(value)))) - 1)
        del value[kept:]
        return f"{where}: list cut short, its first items are shown"
    if isinstance(value, dict) and len(value) > 1 and max(map(size_of, value.values())) < 0.5 * size_of(value):
        names = list(value)
        for name in names[max(1, int(len(names) * (1 - min(0.9, over / size_of(value)))) - 1) :]:
            del value[name]
        return f"{where}: object cut short, its first members are shown"
    if isinstance(value, dict | list) and value:
        return _cut_longest(value, over, where)
    node[key] = None
    return f"{where}: left out"

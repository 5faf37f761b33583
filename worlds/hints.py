"""Hints for callers: closest names, and problems of a specification with the fields that stand there."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

from .bounds import shown
from .errors import InputError

__all__ = ["did_you_mean", "given", "patch_problem", "spec_problem"]

OPERATIONS = ("add", "remove", "replace", "move", "copy", "test")
_TAGS = ("kind", "category", "engine")
"""Members by which unions are told apart."""
_NAMED = 20
_CHARACTERS = 300


def did_you_mean(name: object, known: Iterable[str], *, cutoff: float = 0.6) -> str:
    """`; did you mean 'x'?` where a known name is close, else nothing."""
    folded = {k.lower(): k for k in known}
    close = difflib.get_close_matches(str(name)[:200].lower(), folded, n=1, cutoff=cutoff)
    return f"; did you mean {folded[close[0]]!r}?" if close else ""


def spec_problem(document: Any, item: Mapping[str, Any]) -> tuple[str, str]:
    """(JSON pointer, message) of one validation problem: what is there, what may stand there, the closest name.

    Args:
        document: what was validated.
        item: one of pydantic's errors. Its place also names the members of unions, which no pointer does.
    """
    pointer = _place(document, item)
    parent, _, key = pointer.rpartition("/")
    kind, got = item["type"], given(item.get("input"))
    if kind == "extra_forbidden":
        known = _fields(document, parent)
        there = f"; fields: {', '.join(list(known)[:_NAMED])}" if known else ""
        return pointer, f"there is no field {shown(key)}{did_you_mean(key, known)}{there} (got {got})"
    if kind == "union_tag_invalid":
        allowed = [t.strip(" '") for t in str(item["ctx"]["expected_tags"]).split(",")]
        tag = str(item["ctx"]["tag"])
        return pointer, f"{shown(tag)} is no {_union(pointer)}{did_you_mean(tag, allowed)}; allowed: {', '.join(allowed)}"
    if kind == "literal_error":
        allowed = str(item["ctx"]["expected"]).replace(" or ", ", ").replace("'", "").split(", ")
        return pointer, f"{got} is not allowed{did_you_mean(item['input'], allowed)}; allowed: {', '.join(allowed)}"
    line = _fields(document, parent).get(key)
    expected = f"; expected: {line}" if line else ""
    if kind == "missing":
        return pointer, f"is missing{expected}"
    return pointer, f"{item['msg'][:_CHARACTERS]} (got {got}){expected}"


def given(value: Any) -> str:
    """Value that stands there, in words; clients write NaN and infinities as null, since JSON has no such numbers."""
    return "null, as which JSON gives NaN and infinity, too" if value is None else shown(value)


def _place(document: Any, item: Mapping[str, Any]) -> str:
    """The pointer of a problem."""
    steps: list[str] = []
    node, entered = document, True
    loc = item["loc"]
    for number, token in enumerate(loc):
        # A driver of kind `field` has a member of that name, too: right after the driver itself comes its kind.
        tagged = entered and isinstance(node, Mapping) and token in (node.get(t) for t in _TAGS)
        entered = False
        if tagged and number < len(loc) - 1:
            continue
        here = isinstance(node, Mapping) and token in node
        if here or (isinstance(node, list) and isinstance(token, int) and token < len(node)):
            node, entered = node[token], True
            steps.append(str(token))
        elif number == len(loc) - 1 and item["type"] == "missing":
            steps.append(str(token))
    return "/" + "/".join(steps)


def _fields(document: Any, pointer: str) -> dict[str, str]:
    """Fields that the schema has at a pointer, each with its line; empty where it has none."""
    from .schema_words import described

    try:
        part = described(pointer or "World", document)
    except InputError:
        return {}
    if "options" in part:
        node = document
        for token in [t for t in pointer.split("/") if t]:
            node = node[int(token)] if isinstance(node, list) and token.isdigit() else node.get(token, {})
            if not isinstance(node, Mapping | list):
                return {}
        if not isinstance(node, Mapping):
            return {}
        otherwise = "rigid" if part["union"] == "Physics" else ""
        part = part["options"].get(str(node.get("kind", node.get("category", node.get("engine", otherwise)))), {})
    found: dict[str, str] = part.get("fields", {})
    # A union that the schema does not name is told by what holds it: its fields are not those asked for.
    return {} if pointer.rpartition("/")[2] in found else found


def _union(pointer: str) -> str:
    """Name of the union at a pointer, as in "kind of Driver", for messages."""
    from .schema_words import described

    try:
        return f"kind of {described(pointer).get('union', 'thing')}"
    except InputError:
        return "known kind"


def patch_problem(document: Any, operation: Mapping[str, Any], error: Exception) -> str:
    """Why one operation of a patch cannot be applied, and what was probably meant."""
    kind, path = operation.get("op"), operation.get("path")
    if kind not in OPERATIONS:
        return f"op {shown(kind)} is unknown{did_you_mean(kind, OPERATIONS)}; allowed: {', '.join(OPERATIONS)}"
    if not isinstance(path, str) or not path.startswith("/"):
        return f"path {shown(path)} must be a JSON pointer from the root of world.json, such as '/entities/ball/pose'"
    if kind in ("add", "replace", "test") and "value" not in operation:
        return f"{kind} needs a value"
    node, walked = document, ""
    for token in path.split("/")[1:]:
        key = token.replace("~1", "/").replace("~0", "~")
        if isinstance(node, Mapping) and key not in node:
            names = ", ".join(list(node)[:_NAMED]) or "nothing"
            hint = did_you_mean(key, node)
            return f"there is no {shown(key)} at {walked or '/'}{hint} There is: {names}. 'add' makes a new member"
        if isinstance(node, list) and not (key.isdigit() and int(key) < len(node)):
            return f"{shown(key)} is no index of the list at {walked}, which has {len(node)} items; '-' appends with 'add'"
        if not isinstance(node, Mapping | list):
            return f"there is nothing below {walked}, which is {shown(node)}"
        node = node[key] if isinstance(node, Mapping) else node[int(key)]
        walked += f"/{token}"
    return str(error)[:_CHARACTERS]

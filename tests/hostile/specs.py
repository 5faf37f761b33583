"""Specifications and patches drawn from the schema: valid, nearly valid and broken, with path payloads and absurd numbers."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.spec import WorldSpec

__all__ = ["NUMBERS", "PATHS", "broken", "full_spec", "leaves", "patch", "rewritten", "schema", "sentence"]

PATHS = (
    "../../canary.txt",
    "../../../../../../../../etc/passwd",
    "/etc/passwd",
    "..%2f..%2fcanary.txt",
    "..%252fcanary.txt",
    "..\\..\\canary.txt",
    "\\\\server\\share\\x.obj",
    "C:\\Windows\\win.ini",
    "~/canary.txt",
    "~root/x",
    "file:///etc/passwd",
    "http://127.0.0.1:9/x.obj",
    "canary.txt\0.obj",
    "\0",
    "a/" * 3000 + "x.obj",
    "x" * 5000 + ".obj",
    "assets/../../../canary.obj",
    "link_out.obj",
    "link_out/canary.obj",
    "../canary.obj",
    "..",
    ".",
    "",
    "\uff0e\uff0e/\uff0e\uff0e/canary.txt",
    "\u2024\u2024/canary.txt",
    "\u2215etc\u2215passwd",
    "con.obj",
    "-rf",
    "$(touch canary.txt)",
    "`id`",
    "%00",
    "world.json\n",
    "ledger.sqlite",
    "/proc/self/environ",
    "/dev/zero",
)
"""Texts that lead where a path must never lead."""

NUMBERS: tuple[Any, ...] = (
    0, -0.0, 1, -1, 1e-300, 5e-324, 1e-12, 1e9, -1e9, 1e9 + 1, 1e17, 1e300, 1.7976931348623157e308, 2**31, 2**53, 2**63, 10**40,
    0.1, 3.141592653589793, 1e-9, 240, 20000, 60, True, None, "1", [], {},
)  # fmt: skip


@cache
def schema() -> dict[str, Any]:
    """JSON Schema of a world."""
    return WorldSpec.model_json_schema()


def _resolved(node: Any) -> Any:
    while isinstance(node, dict) and "$ref" in node:
        node = schema()["$defs"][node["$ref"].rpartition("/")[2]]
    return node


def sentence(draw: random.Random, node: Any = None, depth: int = 0) -> Any:
    """A value that the schema describes, or nearly."""
    node = _resolved(schema() if node is None else node)
    if not isinstance(node, dict) or depth > 14:
        return None
    for choice in ("anyOf", "oneOf"):
        if choice in node:
            return sentence(draw, draw.choice(node[choice]), depth + 1)
    if "const" in node:
        return node["const"]
    if "enum" in node:
        return draw.choice(node["enum"])
    kind = node.get("type")
    if kind == "object":
        return _object(draw, node, depth)
    if kind == "array":
        if "prefixItems" in node:
            return [sentence(draw, item, depth + 1) for item in node["prefixItems"]]
        count = max(node.get("minItems", 0), draw.choice([0, 1, 2, 3]))
        return [sentence(draw, node.get("items"), depth + 1) for _ in range(min(count, node.get("maxItems", 9)))]
    if kind == "string":
        return draw.choice(["ball", "b1", "wood", "rigid", "floor", "roll", "a", "world", "x" * draw.choice([1, 60, 70])])
    if kind in ("number", "integer"):
        low = node.get("minimum", node.get("exclusiveMinimum", -10))
        high = node.get("maximum", node.get("exclusiveMaximum", 10))
        value = draw.choice([low, high, draw.uniform(low, min(high, low + 1)), draw.uniform(low, high), 1])
        return int(value) if kind == "integer" else value
    return draw.choice([True, False]) if kind == "boolean" else None


def _object(draw: random.Random, node: Mapping[str, Any], depth: int) -> Any:
    found = {}
    for name, child in node.get("properties", {}).items():
        if name in node.get("required", ()) or draw.random() < 0.35:
            found[name] = sentence(draw, child, depth + 1)
    more = node.get("additionalProperties", next(iter(node.get("patternProperties", {}).values()), None))
    if isinstance(more, dict):
        for _ in range(draw.choice([0, 1, 2])):
            found[draw.choice(["ball", "b1", "b2", "b3", "floor", "new", "c1", "rigid", "x"])] = sentence(draw, more, depth + 1)
    return found


def leaves(value: Any, pointer: str = "") -> Iterator[tuple[str, Any]]:
    """JSON pointer and value of every member and item at any level."""
    yield pointer, value
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in pairs:
        token = str(key).replace("~", "~0").replace("/", "~1")
        yield from leaves(item, f"{pointer}/{token}")


def broken(draw: random.Random, document: Any) -> Any:
    """A document with one to three values exchanged for others: numbers, paths, wrong types, other parts of it."""
    for _ in range(draw.choice([1, 1, 2, 3])):
        places = [pointer for pointer, _ in leaves(document) if pointer]
        if not places:
            return document
        value = draw.choice(
            [draw.choice(NUMBERS), draw.choice(PATHS), sentence(draw), draw.choice([v for _, v in leaves(document)])]
        )
        document = rewritten(document, draw.choice(places), value)
    return document


def rewritten(document: Any, pointer: str, value: Any) -> Any:
    """A document with another value at a pointer."""
    if not pointer:
        return value
    token, _, rest = pointer[1:].partition("/")
    key = token.replace("~1", "/").replace("~0", "~")
    inner = f"/{rest}" if rest else ""
    if isinstance(document, list):
        return [rewritten(item, inner, value) if k == int(key) else item for k, item in enumerate(document)]
    return {k: rewritten(item, inner, value) if k == key else item for k, item in document.items()}


def patch(draw: random.Random, document: Any) -> list[Any]:
    """JSON Patch by grammar, its operations mostly in form."""
    known = [pointer for pointer, _ in leaves(document)]
    values = [
        lambda: draw.choice(NUMBERS),
        lambda: draw.choice(PATHS),
        lambda: sentence(draw),
        lambda: dict(leaves(document))[draw.choice(known)],
    ]

    def place() -> str:
        base = draw.choice(known)
        return draw.choice([base, base, f"{base}/x", f"{base}/-", f"{base}/0", f"{base}/~1..~1..", draw.choice(PATHS), ""])

    found: list[Any] = []
    for _ in range(draw.choice([1, 1, 2, 3, 6])):
        operation: dict[str, Any] = {
            "op": draw.choice(["add", "replace", "remove", "move", "copy", "test", "add", "replace"]),
            "path": place(),
        }
        if operation["op"] in ("add", "replace", "test"):
            operation["value"] = draw.choice(values)()
        if operation["op"] in ("move", "copy"):
            operation["from"] = place()
        if draw.random() < 0.06:
            operation = broken(draw, operation)
        found.append(operation)
    return found


def full_spec() -> dict[str, Any]:
    """The small world with every optional member written out."""
    return WorldSpec.model_validate({"prompt": PROMPT, **small_spec()}).model_dump(mode="json", exclude_none=True)

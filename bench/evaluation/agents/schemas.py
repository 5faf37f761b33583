"""Values drawn at random from a JSON schema: arguments that look valid."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["drawn"]

DEPTH = 5
"""Levels below which only what is required is drawn."""
WORDS = ("ball", "floor", "wall", "water", "rigid", "main", "one", "w")


def drawn(schema: Mapping[str, Any], rng: random.Random, *, root: Mapping[str, Any] | None = None, depth: int = 0) -> Any:
    """One value that a schema allows, as far as types, choices and bounds say.

    Args:
        schema: of the value.
        rng: draws.
        root: the whole schema, for references.
        depth: of the value in the whole.
    """
    whole = schema if root is None else root
    if "$ref" in schema:
        return drawn(_referred(str(schema["$ref"]), whole), rng, root=whole, depth=depth + 1)
    for choice in ("anyOf", "oneOf"):
        if schema.get(choice):
            return drawn(rng.choice(list(schema[choice])), rng, root=whole, depth=depth)
    if "const" in schema:
        return schema["const"]
    if schema.get("enum"):
        return rng.choice(list(schema["enum"]))
    kind = schema.get("type", "object" if "properties" in schema else "string")
    return _of_kind(rng.choice(list(kind)) if isinstance(kind, list) else kind, schema, rng, whole, depth)


def _of_kind(kind: str, schema: Mapping[str, Any], rng: random.Random, root: Mapping[str, Any], depth: int) -> Any:
    if kind == "object":
        return _object(schema, rng, root, depth)
    if kind == "array":
        fewest, most = int(schema.get("minItems", 0)), int(schema.get("maxItems", schema.get("minItems", 0) + 2))
        firsts: Sequence[Any] = schema.get("prefixItems", ())
        items = schema.get("items") or {}
        count = max(fewest, len(firsts)) if depth > DEPTH else rng.randint(fewest, max(fewest, min(most, fewest + 3)))
        return [drawn(firsts[k] if k < len(firsts) else items, rng, root=root, depth=depth + 1) for k in range(count)]
    if kind == "integer":
        low = int(schema.get("minimum", schema.get("exclusiveMinimum", -1) + 1))
        return rng.randint(low, int(schema.get("maximum", low + 100)))
    if kind == "number":
        least = float(schema.get("minimum", schema.get("exclusiveMinimum", 0.0)))
        return round(rng.uniform(least, float(schema.get("maximum", schema.get("exclusiveMaximum", least + 10.0)))), 3)
    if kind == "boolean":
        return rng.random() < 0.5
    return None if kind == "null" else rng.choice(WORDS)


def _object(schema: Mapping[str, Any], rng: random.Random, root: Mapping[str, Any], depth: int) -> dict[str, Any]:
    properties, required = schema.get("properties", {}), set(schema.get("required", ()))
    share = 0.4 if depth <= DEPTH else 0.0
    found = {k: drawn(v, rng, root=root, depth=depth + 1) for k, v in properties.items() if k in required or rng.random() < share}
    more = schema.get("additionalProperties")
    if not properties and isinstance(more, Mapping) and depth <= DEPTH:
        found |= {rng.choice(WORDS): drawn(more, rng, root=root, depth=depth + 1) for _ in range(rng.randint(0, 2))}
    return found


def _referred(place: str, root: Mapping[str, Any]) -> Mapping[str, Any]:
    found: Any = root
    for word in place.removeprefix("#/").split("/"):
        found = found[word]
    return dict(found)

"""Parts of the schema for `inspect_world`: its index, one part, several, or a whole example."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..worlds.errors import InputError
from .answers import MAX_CHARACTERS, answer, size_of

__all__ = ["schema"]

EXAMPLE = Path(__file__).resolve().parent.parent / "skills" / "world-building" / "examples" / "two_blocks.json"
SPARE = 500
"""Characters of a reply beside the parts of the schema that it tells."""


def schema(pointer: str) -> dict[str, Any]:
    """The schema of a specification: its index, one part, or a whole example."""
    from ..worlds.schema_words import described

    if pointer == "example":
        from ..worlds.claim_marks import marked_claims
        from ..worlds.patch import parse_spec

        example = json.loads(EXAMPLE.read_text())
        claims = marked_claims(parse_spec(example))
        rest = {k: v for k, v in example.items() if k not in ("prompt", "claims", "spec_version")}
        return answer(
            {"part": "schema", "prompt": example["prompt"], "claims": claims, "spec": rest},
            "a whole small world that is accepted: pass prompt, claims and spec to edit_spec",
            "edit_spec(world=..., prompt=..., spec=..., claims=...) with your own",
        )
    if "," in pointer:
        return _schemas([p.strip() for p in pointer.split(",") if p.strip()])
    found = described(pointer)
    if pointer in ("", "/", "World"):
        then = "inspect_world(part='schema', pointer='Entity, Driver, Relation'), any names at once; pointer='example'"
        return answer({"part": "schema", **found}, "the top level of a specification; capitals name parts to ask for", then)
    about = found.get("type") or f"{found['union']}: one of these, told apart by its kind"
    return answer(
        {"part": "schema", "pointer": pointer, **found},
        f"{about}; [3 x number] is a list of three, {{id: X}} an object of X by id",
        "inspect_world(part='schema', pointer='NAME, NAME')",
    )


def _schemas(pointers: Sequence[str]) -> dict[str, Any]:
    """Several parts of the schema in one reply, as many as fit it; names that are none are told beside them.

    Raises:
        InputError: none of the names is one.
    """
    from ..worlds.schema_words import described

    parts: dict[str, Any] = {}
    left, unknown = list[str](), list[str]()
    for name in dict.fromkeys(pointers):
        try:
            described(name)
            left.append(name)
        except InputError as error:
            unknown.append(str(error).partition(" Parts:")[0])
    if not left:
        described(pointers[0])
    while left and (not parts or size_of([parts, left, described(left[0])]) < MAX_CHARACTERS - SPARE):
        parts |= {(name := left.pop(0)): described(name)}
    rest = (
        f"inspect_world(part='schema', pointer='{', '.join(left)}')" if left else "edit_spec(world=..., ...) with what they say"
    )
    about = f"{len(parts)} parts of the schema" + (f"; {len(left)} more do not fit one reply" if left else "")
    return answer({"part": "schema", "parts": parts}, about, rest, warnings=unknown)

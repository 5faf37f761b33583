"""Worlds that the engine ran, with claims about them: the rows of the check, and the problems of the audit."""

from __future__ import annotations

import dataclasses
import json
from functools import lru_cache
from pathlib import Path
from typing import Any

from worldagent.testing.defects._films import Film, film_of
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.verifiers.claims.check import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.canonical import canonical_json
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec


@lru_cache(maxsize=48)
def film(world: str) -> Film:
    return film_of(event_world(world))


@lru_cache(maxsize=16)
def _film_of(document: bytes) -> Film:

    return film_of(parse_spec(json.loads(document)))


def claimed(spec: WorldSpec, claims: dict[str, Any], *, beats: Any = None, requirements: Any = None, **more: Any) -> WorldSpec:
    """The world with a story and claims; the prompt is what the claims quote. Beats are (subject, predicate) or whole."""
    document = spec.model_dump(mode="json")
    last = spec.simulation.frames - 1

    def beat(given: Any) -> dict[str, Any]:
        if isinstance(given, dict):
            return {"text": "it happens", "owner": "rigid", "frames": [0, last], **given}
        return {
            "text": "it happens",
            "owner": "rigid",
            "subject": given["entity"] if isinstance(given, dict) else given[0],
            "frames": [0, last],
            "predicate": given[1],
        }

    document["story"] = {
        "beats": {k: beat(v) for k, v in (beats or {}).items()},
        "requirements": {k: {"text": "it holds", **v} for k, v in (requirements or {}).items()},
    }
    document["spec_version"] = "2"
    document["prompt"] = more.pop("prompt", None) or ", ".join(c["quote"] for c in claims.values()) + "."
    document["claims"] = claims
    return parse_spec({**document, **more})


def candidate_of(folder: Path, world: str | WorldSpec, claims: dict[str, Any], **more: Any) -> Candidate:
    ran = film(world) if isinstance(world, str) else _film_of(canonical_json(world))
    return dataclasses.replace(ran, spec=claimed(ran.spec, claims, **more)).candidate(folder)


def rows(folder: Path, world: str | WorldSpec, claims: dict[str, Any], **more: Any) -> dict[str, Row]:
    """Rows by claim, or by claim and type where a claim has several."""
    return {r.subject[0]: r for r in check(candidate_of(folder, world, claims, **more)) if r.subject}

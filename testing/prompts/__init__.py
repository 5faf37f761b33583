"""Prompts in twelve languages: 150 with their spans marked, written without sight of the gate, and 500 strangers that no shipped world is about.

Also 198 English verbs with the kinds of event that a reader lets each stand for.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

__all__ = ["Marked", "Span", "Stranger", "Verb", "honest", "placed", "strangers", "verbs"]

SpanType = Literal[
    "thing", "count", "quantity", "property", "event", "order", "negation", "place", "time", "weather", "look", "route"
]


class Span(NamedTuple):
    """A part of a prompt that says something about the world."""

    quote: str
    nth: int
    """Which of the equal substrings, from 1."""
    type: SpanType


class Marked(NamedTuple):
    """A prompt with its spans; what no span covers is filler."""

    id: str
    language: str
    text: str
    gloss: str
    """Meaning in English."""
    spans: tuple[Span, ...]


class Stranger(NamedTuple):
    """A prompt alone."""

    id: str
    language: str
    text: str


class Verb(NamedTuple):
    """A verb, with the kinds of event that it stands for."""

    verb: str
    kinds: frozenset[str]
    """Those that everybody would take it for; none where no kind of the plan is meant."""
    also: frozenset[str]
    """Those that it may be used for."""
    seen: bool
    """True where the seeds of the lexicon were chosen with a view to it; the others were written before they were first looked up."""


def _read(name: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((Path(__file__).parent / f"{name}.json").read_text(encoding="utf-8"))
    return found


@cache
def honest() -> tuple[Marked, ...]:
    """Everyday prompts with their spans, in the order in which they were written."""
    made = []
    for item in _read("honest"):
        spans = tuple(Span(**span) for span in item.pop("spans"))
        made.append(Marked(**item, spans=spans))
    return tuple(made)


@cache
def strangers() -> tuple[Stranger, ...]:
    """Prompts about other worlds than the shipped ones."""
    return tuple(Stranger(**item) for item in _read("strangers"))


@cache
def verbs() -> tuple[Verb, ...]:
    """Verbs of the prompts and of their English glosses, then such as are not in them."""
    return tuple(Verb(item["verb"], frozenset(item["kinds"]), frozenset(item["also"]), item["seen"]) for item in _read("verbs"))


def placed(prompt: Marked) -> tuple[tuple[int, int, SpanType], ...]:
    """Start, end and type of every span of a prompt."""
    made: list[tuple[int, int, SpanType]] = []
    for span in prompt.spans:
        start = -1
        for _ in range(span.nth):
            start = prompt.text.index(span.quote, start + 1)
        made.append((start, start + len(span.quote), span.type))
    return tuple(made)

"""Kinds of things, from `kinds.json`: which open, and measures of each kind with bounds and sources (R87, R88)."""

from __future__ import annotations

import json
import re
from functools import lru_cache
from pathlib import Path
from typing import Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field

__all__ = [
    "KINDS",
    "MEASURES",
    "OPENINGS",
    "VARIANTS",
    "Kind",
    "Limit",
    "Variant",
    "function_of",
    "head_noun",
    "kind_of",
    "variant_of",
]

FILE = Path(__file__).with_suffix(".json")
MEASURES = (
    "level",
    "height",
    "length",
    "width",
    "longest",
    "middle",
    "least",
    "leaf_width",
    "leaf_height",
    "rise",
    "rises",
    "going",
)
"""Names of measures; `measures.py` takes them."""
_STOPS = re.compile(
    r"[,.;:(/]|\b(?:of|in|on|at|for|from|to|with|without|by|that|which|who|whose|and|or|under|over|beside|behind|between|into|as|is|are|standing|hinged)\b"
)
_WORD = re.compile(r"[a-z]+(?:'s|s')?")
_FALSE_HEADS = frozenset(("left", "right", "upper", "lower", "one", "two", "first", "second", "third"))


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Limit(_Data):
    """Bounds of one measure of a kind."""

    measure: Literal[
        "level", "height", "length", "width", "longest", "middle", "least", "leaf_width", "leaf_height", "rise", "rises", "going"
    ]
    called: str
    """In the words of the row: `height of the seat`."""
    low: float | None = None
    """[m]"""
    high: float | None = None
    """[m]"""
    source: str = Field(min_length=8)


class Kind(_Data):
    """One kind of thing."""

    name: str
    generators: tuple[str, ...] = ()
    nouns: tuple[str, ...] = ()
    """Last words of roles by which things that no generator made are told."""
    other: tuple[str, ...] = ()
    """Words before such a noun that make another thing of it: a flower bed."""
    limits: tuple[Limit, ...]


class Variant(_Data):
    """Words of a role that make another kind of it: a toy chair, a child's chair, a giant one."""

    name: str
    words: tuple[str, ...]
    least: float
    """Least size, as share of the usual one [1]."""
    most: float
    source: str


class Function(_Data):
    """Angle that is enough for joints of some things."""

    generators: tuple[str, ...]
    joint: str
    """End of the joint's id."""
    angle: float
    """[rad]"""
    source: str


class _Openings(_Data):
    generators: tuple[str, ...]
    """Things whose joints with a range open something."""
    other_joints: tuple[str, ...]
    """Ends of ids of their joints that open nothing."""
    nouns: tuple[str, ...]
    """Last words of roles of what opens."""
    functions: tuple[Function, ...]


class _Table(_Data):
    openings: _Openings
    variants: tuple[Variant, ...]
    kinds: tuple[Kind, ...]


_TABLE = _Table.model_validate(json.loads(FILE.read_text("utf-8")))
OPENINGS, VARIANTS = _TABLE.openings, _TABLE.variants
KINDS = {k.name: k for k in _TABLE.kinds}
_BY_GENERATOR = {g: k for k in _TABLE.kinds for g in k.generators}
_BY_NOUN = {n: k for k in _TABLE.kinds for n in k.nouns}


class _Role(NamedTuple):
    head: str
    words: frozenset[str]


@lru_cache(maxsize=4096)
def _read(role: str) -> _Role:
    text = role.lower()
    words = _WORD.findall(text)
    first = _WORD.findall(_STOPS.split(text, maxsplit=1)[0])
    heads = [w for w in first if w not in _FALSE_HEADS]
    return _Role(heads[-1] if heads else "", frozenset(w.removesuffix("'s").removesuffix("s'") for w in words))


def head_noun(role: str) -> str:
    """Last word before the first preposition, conjunction or mark of a role in English; empty where there is none."""
    return _read(role).head


def function_of(generator: str | None, joint: str) -> Function | None:
    """Function of a joint of a generated thing, where that asks for less than others."""
    return next((f for f in OPENINGS.functions if generator in f.generators and joint.endswith(f.joint)), None)


def kind_of(generator: str | None, role: str) -> Kind | None:
    """Kind of a thing: by the generator that made it, else by the last word of its role."""
    if generator is not None:
        return _BY_GENERATOR.get(generator)
    found = _BY_NOUN.get(head_noun(role))
    return None if found is None or _read(role).words & set(found.other) else found


def variant_of(role: str) -> Variant | None:
    """Variant that a role names, if it does."""
    words = _read(role).words
    return next((v for v in VARIANTS if words & set(v.words)), None)

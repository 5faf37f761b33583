"""Rubrics of the judge as versioned data, and what counts as an answer to them (S16).

An answer is read strictly: a JSON object with exactly the names that were asked for and values that the rubric allows, or for a
yes-or-no question exactly one of the two words. Anything else is no score, and never becomes a number.
"""

from __future__ import annotations

import hashlib
import json
import re
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["Rubric", "Rubrics", "read_scores", "rubrics"]

FILE = Path(__file__).with_name("rubrics.json")
FENCED = re.compile(r"\A```(?:json)?\s*\n(.*)\n```\Z", re.DOTALL)
"""A whole answer in one fence of code, as many models write JSON."""
LONGEST = 4000
"""Letters of an answer that are read at all."""


class Rubric(BaseModel):
    """A question to a judge, and the values of each score."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    ask: str
    """Text with places in braces."""
    scores: Annotated[dict[str, tuple[float, ...]], Field(min_length=1)]


class Rubrics(BaseModel):
    """All rubrics of one version."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    version: str
    origin: str
    sampled: str
    """Sentence before each question: length, number and times of the frames that are shown."""
    causal_beat: Rubric
    causal_link: Rubric
    shots: Rubric
    composition: Rubric
    production: Rubric

    @property
    def digest(self) -> str:
        """SHA-256 over all words and values, independent of layout."""
        return hashlib.sha256(json.dumps(self.model_dump(mode="json"), sort_keys=True).encode()).hexdigest()


@lru_cache(maxsize=1)
def rubrics() -> Rubrics:
    """The rubrics that come with the package."""
    return Rubrics.model_validate_json(FILE.read_text(encoding="utf-8"))


def read_scores(rubric: Rubric, answer: str) -> dict[str, float] | None:
    """Scores that an answer gives, by name; None where it is none."""
    text = answer.strip()
    if not 0 < len(text) <= LONGEST:
        return None
    if set(rubric.scores) == {"yes"}:
        words = [w for w in re.findall(r"[a-z]+", text.lower()) if w in ("yes", "no")]
        return {"yes": float(words[0] == "yes")} if len(words) == 1 else None
    fenced = FENCED.match(text)
    try:
        found = json.loads(fenced.group(1) if fenced else text, object_pairs_hook=_once, parse_constant=_refused)
    except (ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or found.keys() != rubric.scores.keys():
        return None
    values = {name: _value(value, rubric.scores[name]) for name, value in found.items()}
    return None if None in values.values() else {n: v for n, v in values.items() if v is not None}


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object whose names stand once."""
    if len({name for name, _ in pairs}) < len(pairs):
        raise ValueError("a name stands twice")
    return dict(pairs)


def _refused(word: str) -> Any:
    raise ValueError(f"{word} is no number")


def _value(value: Any, allowed: tuple[float, ...]) -> float | None:
    """A number that the rubric allows; true and false are none."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if number and value in allowed else None

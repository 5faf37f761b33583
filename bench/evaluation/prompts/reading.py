"""Prompts of the benchmark: their schema, and the sets that stand beside this module.

The paper describes thirteen long prompts, sixty-five beats and their questions, and prints none of them (S16). The sets here are ours,
fixed before any world of them was made. What decides a score is part of the data: beats for Caus, questions for Comp, requirements for whoever
compares a world with its prompt.
"""

from __future__ import annotations

import hashlib
import json
from itertools import combinations
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ....worlds.categories.registry import CATEGORIES
from ....worlds.errors import InputError

__all__ = [
    "BESIDES",
    "CAPABILITIES",
    "COUPLINGS",
    "SETS",
    "BenchPrompt",
    "PromptBeat",
    "PromptQuestion",
    "PromptRequirement",
    "PromptSet",
    "load_prompts",
    "load_set",
]

FOLDER = Path(__file__).parent
SETS = ("agenticsimbench", "small")
"""Sets that come with the package: the benchmark, and one small prompt per capability."""
COUPLINGS = tuple("+".join(pair) for pair in combinations(sorted(CATEGORIES), 2))
"""Pairs of categories of matter that act on each other, both names in alphabetical order."""
BESIDES = ("terrain", "rooms", "routes", "joints", "ropes", "wind", "fire")
"""Capabilities that are neither a category of matter nor a pair of them."""
CAPABILITIES = (*sorted(CATEGORIES), *COUPLINGS, *BESIDES)
"""Words by which a prompt says what a world of it needs."""

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=40)]
Sentence = Annotated[str, Field(min_length=8, max_length=300)]


class _Frozen(BaseModel):
    """Data that nothing changes after reading, without fields that the schema does not name."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class PromptBeat(_Frozen):
    """One causal beat, to be judged from pictures alone."""

    id: Name
    text: Sentence


class PromptQuestion(_Frozen):
    """A yes-or-no question about something that the prompt asks for and a film has to show."""

    id: Name
    kind: Literal["entity", "region"]
    question: Annotated[str, Field(min_length=8, max_length=200, pattern=r"\?$")]


class PromptRequirement(_Frozen):
    """One thing that the prompt asks for, read from the prompt alone."""

    id: Name
    text: Sentence


class BenchPrompt(_Frozen):
    """A prompt with all that judges need to know about it."""

    id: Name
    text: Annotated[str, Field(min_length=20, max_length=2000)]
    """The prompt as an agent gets it."""
    setting: Literal["outdoor", "interior"]
    capabilities: Annotated[tuple[str, ...], Field(min_length=1)]
    """Words of `CAPABILITIES`; of a small prompt the first is the one that it is there for."""
    duration_s: Annotated[float, Field(gt=0, le=60)]
    """Length of the sequence that the events need [s]."""
    beats: Annotated[tuple[PromptBeat, ...], Field(min_length=1, max_length=5)]
    """In causal order."""
    composition: Annotated[tuple[PromptQuestion, ...], Field(min_length=1)]
    requirements: Annotated[tuple[PromptRequirement, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _names_are_known_and_unique(self) -> BenchPrompt:
        strange = sorted(set(self.capabilities) - set(CAPABILITIES))
        if strange:
            raise ValueError(f"prompt {self.id!r}: capabilities {strange} are none of {', '.join(CAPABILITIES)}")
        for what in ("beats", "composition", "requirements"):
            ids = [item.id for item in getattr(self, what)]
            twice = sorted({name for name in ids if ids.count(name) > 1})
            if twice:
                raise ValueError(f"prompt {self.id!r}: ids {twice} stand twice among its {what}")
        return self


class PromptSet(_Frozen):
    """Prompts that are run and scored together."""

    name: Name
    version: str
    """Changes with any word that an agent or a judge reads."""
    origin: str
    """Who wrote the prompts, and what they compare with."""
    beats_at_least: Annotated[int, Field(ge=1, le=5)]
    """Least number of beats of each prompt; five in the benchmark, whose causal score needs five."""
    prompts: Annotated[tuple[BenchPrompt, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _prompts_are_unique_and_have_their_beats(self) -> PromptSet:
        ids = [prompt.id for prompt in self.prompts]
        if len(set(ids)) < len(ids):
            raise ValueError(f"set {self.name!r}: ids of prompts stand twice")
        for prompt in self.prompts:
            if len(prompt.beats) < self.beats_at_least:
                raise ValueError(
                    f"prompt {prompt.id!r} has {len(prompt.beats)} beats; the set asks for at least {self.beats_at_least}"
                )
        return self

    @property
    def digest(self) -> str:
        """SHA-256 over all that the set says, independent of layout."""
        return hashlib.sha256(json.dumps(self.model_dump(mode="json"), sort_keys=True).encode()).hexdigest()


def load_set(name: str) -> PromptSet:
    """A set that comes with the package, by name, or any other by the path of its JSON file.

    Raises:
        InputError: There is no such set.
    """
    path = FOLDER / f"{name}.json" if name in SETS else Path(name)
    if not path.is_file():
        raise InputError(
            f"no set of prompts {name!r}; there are {', '.join(SETS)}, or give the path of a JSON file of the same schema"
        )
    return PromptSet.model_validate_json(path.read_text(encoding="utf-8"))


def load_prompts(name: str) -> dict[str, BenchPrompt]:
    """Prompts of a set by id, in their order (see `load_set`)."""
    return {prompt.id: prompt for prompt in load_set(name).prompts}

"""The guide of one prompt, from the skills: its words marked, kinds of event for its verbs, sections, materials and a worked example.

Each skill names its words, and which of its sections and examples they call for, in `guide.json`. A start for whoever builds: nothing is judged by it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from ..worlds.errors import InputError
from ..worlds.predicates.registry import PREDICATES
from ..worlds.prompts.descriptions import meanings
from ..worlds.prompts.languages import language_of
from ..worlds.prompts.lexicon import events_in, is_stance, kinds_meant
from ..worlds.prompts.proposals import proposal_text
from ..worlds.prompts.units import folded, units_of, word_count
from .answers import answer, call, size_of
from .material_rows import essentials
from .table_entries import sections_of

__all__ = ["CHARACTERS", "prompt_guide"]

CHARACTERS = 15_000
"""Most characters of the whole answer as compact JSON."""
LONGEST_PROMPT = 20_000
MARKED = 2_000
"""Characters of marked text; of a longer prompt its beginning."""
EXAMPLE = 4_200
"""Characters of the worked example."""
EVENTS = 8
"""Verbs that are told of."""
KINDS = 4
"""Kinds of event of one verb."""
MATERIALS = 8
"""Materials that are told of."""
ALIKE = 4
"""Letters that a verb begins with as a kind of event does that is called after it; such a kind comes first."""
SKILLS_TOLD = 4
"""Skills of the prompt's own words whose sections are told, beside those of every world."""
VERB = 3
"""Own choice: a verb of the story counts as so many other words: what happens decides more than what is there."""
OWN_SHARE = 0.65
"""[1] Share of the room for sections that skills get which words of the prompt call for; what every world needs gets the rest."""
ENDING = 3
"""Letters by which a word may be longer than an entry of a list: endings of English and German."""
BASE = ("world-building", "rigid-bodies")
"""Skills of every world, after those that its words call for."""
MANY = 4
"""Own choice: a section for which so many different words call is told before others of its skill."""
OFF_BALANCE = ("tips", "topples")
"""Kinds of event of what goes, gets or throws out of balance."""
SKILLS = Path(__file__).resolve().parent.parent / "skills"
_DEFAULT = ("world-building", "examples/two_blocks.json")


class _Guide(NamedTuple):
    """`guide.json` of one skill."""

    words: tuple[str, ...]
    sections: Mapping[str, tuple[str, ...]]
    """By heading the words that call for it; none: always."""
    examples: Mapping[str, tuple[str, ...]]
    matter: bool
    """It is about matter with a solver of its own: its things count as verbs do, for they decide what is simulated."""


class _Called(NamedTuple):
    """A skill that a prompt calls for."""

    name: str
    because: tuple[str, ...]
    """Words of the prompt."""


def prompt_guide(prompt: str) -> dict[str, Any]:
    """The guide of a prompt, in `CHARACTERS` at most.

    Raises:
        InputError: the prompt is empty or too long.
    """
    if not word_count(prompt) or len(prompt) > LONGEST_PROMPT:
        raise InputError(
            f"the prompt has {len(prompt)} characters and {word_count(prompt)} words; give 1 word to {LONGEST_PROMPT} characters of it, verbatim"
        )
    words = [folded(u.text) for u in units_of(prompt)]
    called = _called(words, {w for quote, _ in events_in(prompt) for w in folded(quote).split()})
    told = [c for c in called if c.name not in BASE][:SKILLS_TOLD]
    data: dict[str, Any] = {
        "part": "guide",
        "marked": proposal_text(prompt[:MARKED]),
        "skills": {c.name: list(c.because[:6]) for c in called},
        **_events(prompt),
        "materials": _materials(prompt, words),
        "rules": json.loads((SKILLS / "world-building" / "rules.json").read_text("utf-8")),
        "example": _example(words, [c.name for c in called if c in told or c.name in BASE]),
    }
    doubts = _doubts(prompt, called)
    fields = call("inspect_world", part="schema", pointer="Entity, Relation, Region, Driver, SolverInstance, Shot")
    then = f"{fields} for their fields; edit_spec(world=..., prompt=..., spec=..., claims=...): claims is `marked` with a target for each type"
    said = f"what the skills say of this prompt: {', '.join(c.name for c in told) or 'bodies alone'}"
    # With the place of every section in `more`, where most of them then are.
    bare = {**data, "sections": {}, "more": _sections(words, told, 0)[1]}
    data["sections"], data["more"] = _sections(words, told, CHARACTERS - size_of(answer(bare, said, then, doubts)))
    return answer(data, said, then, doubts)


def _doubts(prompt: str, called: list[_Called]) -> list[str]:
    language = language_of(prompt)
    found = []
    if not called:
        found.append(
            f"no word of it calls for a skill by its lists (English, German): choose by {call('inspect_world', part='guide')}"
        )
    if language != "en":
        found.append(f"the language is {language or 'unknown'}: verbs are looked up in English alone")
    if len(prompt) > MARKED:
        found.append(f"only its first {MARKED} characters are marked; edit_spec proposes spans of all of it at creation")
    return found


# ---------------------------------------------------------------- skills


@cache
def _guides() -> Mapping[str, _Guide]:
    found = {}
    for path in sorted(SKILLS.glob("*/guide.json")):
        data = json.loads(path.read_text("utf-8"))
        found[path.parent.name] = _Guide(
            tuple(w for told in data["words"].values() for w in told.split()),
            {k: tuple(v.split()) for k, v in data["sections"].items()},
            {k: tuple(v.split()) for k, v in data["examples"].items()},
            data.get("matter", False),
        )
    return found


def _meant(entry: str, word: str) -> bool:
    """True where a word of the prompt is an entry of a list, but for its ending; an entry with `*` begins compounds too."""
    if entry.endswith("*"):
        return word.startswith(entry[:-1])
    return word.startswith(entry) and len(word) - len(entry) <= ENDING


def _among(entries: tuple[str, ...], words: list[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(w for w in words if any(_meant(e, w) for e in entries)))


def _called(words: list[str], verbs: set[str]) -> list[_Called]:
    """Skills by how many words of the prompt call for them, verbs and matter first."""
    guides = _guides()
    found = [_Called(name, _among(guide.words, words)) for name, guide in guides.items()]

    def weight(c: _Called) -> int:
        return sum(VERB if w in verbs or guides[c.name].matter else 1 for w in c.because)

    return sorted((c for c in found if c.because), key=lambda c: -weight(c))


def _wanted(name: str, words: list[str]) -> list[str]:
    """Sections of a skill: those that words call for, then those of every prompt, in the order of its list."""
    sections = _guides()[name].sections
    own = [h for h, entries in sections.items() if entries and _among(entries, words)]
    return [*own, *(h for h, entries in sections.items() if not entries)]


def _sections(words: list[str], called: list[_Called], room: int) -> tuple[dict[str, str], list[str]]:
    """Texts of sections by `skill/SKILL.md#heading`, as many as there is room for, and the places of what is left out."""
    own = {c.name: len(c.because) * (VERB if _guides()[c.name].matter else 1) for c in called if c.name not in BASE}
    groups = [(own, int(room * OWN_SHARE) if own else 0), (dict.fromkeys(BASE, 1), room)]
    texts = {f"{name}/SKILL.md#{h}": _text(name, h) for names, _ in groups for name in names for h in _wanted(name, words)}
    told: dict[str, str] = {}
    for weights, most in groups:
        spare, rest = min(most, room - size_of(told)), sum(weights.values())
        # Sections that much of the prompt speaks of come before each skill gets its share.
        much = [(_calls(p.partition("/")[0], p, words), p) for p in texts if p.partition("/")[0] in weights]
        for _, place in sorted(((c, p) for c, p in much if c >= MANY), key=lambda one: -one[0]):
            cost = size_of({place: texts[place]})
            if cost <= spare:
                told[place], spare = texts[place], spare - cost
        for name, weight in weights.items():
            share, rest = spare * weight // rest, rest - weight
            for place in (p for p in texts if p.startswith(f"{name}/") and p not in told):
                cost = size_of({place: texts[place]})
                if cost <= share:
                    told[place] = texts[place]
                    share, spare = share - cost, spare - cost
    # What no skill's own share had room for may fit into what the others left.
    for place, text in texts.items():
        if place not in told and size_of({**told, place: text}) <= room:
            told[place] = text
    return told, [place for place in texts if place not in told]


def _calls(name: str, place: str, words: list[str]) -> int:
    """Number of words of the prompt that call for a section."""
    return len(_among(_guides()[name].sections.get(place.partition("#")[2], ()), words))


def _text(name: str, heading: str) -> str:
    """A section of a skill without its heading."""
    return sections_of((SKILLS / name / "SKILL.md").read_text("utf-8"))[heading].partition("\n")[2]


# ---------------------------------------------------------------- words


def _events(prompt: str) -> dict[str, Any]:
    """Verbs of the prompt with kinds of event that fit, and what each kind is true of."""
    verbs: dict[str, list[str]] = {}
    events = sorted(k for k in PREDICATES if PREDICATES[k].event)
    for quote, kinds in events_in(prompt):
        if is_stance(quote):
            continue
        called = [k for k in events if k[:ALIKE] == quote[:ALIKE].casefold()]
        own = called + [k for k in events if k in kinds and k not in called]
        if _loses_balance(prompt, quote):
            own = list(OFF_BALANCE)
        verbs.setdefault(quote, (own or [k for k in events if kinds_meant([k]) & kinds])[:KINDS])
    verbs = dict(list(verbs.items())[:EVENTS])
    told = dict.fromkeys(k for kinds in verbs.values() for k in kinds)
    return {"events": verbs, "kinds": {k: PREDICATES[k].gloss for k in told}}


def _loses_balance(prompt: str, quote: str) -> bool:
    """True where a verb that means a fire elsewhere, like *goes out*, stands before *of balance*."""
    return re.search(rf"\b{re.escape(quote)}\s+of\s+(its\s+)?balance\b", prompt, re.IGNORECASE) is not None


def _materials(prompt: str, words: list[str]) -> dict[str, dict[str, Any]]:
    """Materials that the prompt names, with rows of the table: density [kg/m^3] and friction, each [least, typical, largest]."""
    terms = [m.term for m in meanings(prompt, language_of(prompt), "material")]
    told = essentials([*words, *terms])
    return dict(list(told.items())[:MATERIALS])


# ---------------------------------------------------------------- example


def _example(words: list[str], called: list[str]) -> dict[str, Any]:
    """The recorded world that most words of the prompt call for, or else the first of the first skill, as much of it as there is room for."""
    known = [(name, file, len(_among(e, words))) for name in called for file, e in _guides()[name].examples.items()]
    asked = [one for one in known if one[2] or (one[0] == called[0] and one[0] not in BASE)]
    name, file, _ = max(asked, key=lambda one: one[2], default=(*_DEFAULT, 0))
    world = _world((SKILLS / name / file).read_text("utf-8"))
    told: dict[str, Any] = {"file": f"{name}/{file}", "prompt": world["prompt"]}
    left = []
    for member, value in _parts(world):
        if size_of({**told, member: value}) <= EXAMPLE:
            told[member] = value
        else:
            left.append(member)
    return {**told, "left_out": left} if left else told


def _world(text: str) -> dict[str, Any]:
    """A whole specification; of an example that is a list of calls, that of its first with what later ones add, and the calls."""
    data: dict[str, Any] = json.loads(text)
    if "calls" not in data:
        return data
    first = data["calls"][0]["arguments"]
    world = {"entities": {}, "story": {"beats": {}}, "prompt": first["prompt"], **first["spec"]}
    for operation in (o for c in data["calls"][1:] for o in c["arguments"].get("patch", ())):
        *path, last = operation["path"].split("/")[1:]
        if last != "-" and len(path) < 3:
            holder = world
            for token in path:
                holder = holder.setdefault(token, {})
            holder[last] = operation.get("value")
    return world | {"calls": [f"{c['tool']}({', '.join(c['arguments'])}): {c['why']}" for c in data["calls"]]}


def _parts(world: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Pointers of a world and what stands there, what is hardest to guess first."""
    if "calls" in world:
        yield "calls", world["calls"]
    yield from ((f"/terrains/{n}", t) for n, t in world.get("terrains", {}).items())
    yield "/simulation", world["simulation"]
    entities = sorted(world["entities"].items(), key=lambda item: -size_of(item[1].get("physics", {})))
    yield from ((f"/entities/{n}", e) for n, e in entities[:1])
    yield from ((f"/story/beats/{n}", b) for n, b in world["story"]["beats"].items())
    alone = {e["role"]: n for n, e in reversed(entities)}.values()  # of those with one role the first
    yield from ((f"/entities/{n}", e) for n, e in entities[1:] if n in alone)
    yield from ((f"/materials/{n}", m) for n, m in world.get("materials", {}).items())
    yield "/graph", world.get("graph", {})
    yield "/shots", world.get("shots", {})
    yield from ((f"/entities/{n}", e) for n, e in entities[1:] if n not in alone)

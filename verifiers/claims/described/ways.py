"""Words of a way against routes that are proven, and motions that go them (`claim:route:<claim>`).

- A `connects` relation is open: what the row of the relation finds. Words of *walk*ing ask for one that a person can take.
- A beat or requirement comes true, and while it does the centre of its subject goes *down* or *up* by a tenth of its size at least, or, of words
  that lead *into*, *off* or *along* something, moves by half of its size, of those of *walk*ing on the level. Own choices: less is a wobble.
- Of a region alone: something claimed comes into it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.claim_targets import named_in
from ....worlds.predicates import Reaches, entities_of
from ....worlds.spec import Connects
from ....worlds.walkers import carrier_words
from ...categories.registry import judge_of
from ...predicates.evaluators import beat_times, evaluate
from ...routes.navigability import way_finding
from ...rows.findings import Finding
from .answers import Answer, finding_of
from .bounds import MOVES, RISES
from .places import things_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word
    from ....worlds.spec import WorldSpec

__all__ = ["judge"]


def judge(candidate: Candidate, name: str, words: list[Word]) -> Finding:
    """The finding on whether the way is open, or gone."""
    spec, quote = candidate.spec, candidate.spec.claims[name].quote
    open_ways = list(_relations(candidate, name))
    unknown = [f for f in open_ways if f.status == "unverified"]
    if unknown:
        return Finding("unverified", f"{quote!r}: {unknown[0].text}")
    answers = [Answer(quote, f.status == "pass", f.text, float(f.status != "pass"), 0.0, "<=") for f in open_ways]
    answers += _walked(spec, name, words)
    for key in named_in(spec, name, "graph/regions"):
        if key in spec.graph.regions:
            answers.append(_reached(candidate, name, quote, key))
    for beat in named_in(spec, name, "story/beats"):
        if beat in spec.story.beats:
            outcome = beat_times(candidate).outcome(beat)
            if outcome.status == "unverified":
                return Finding("unverified", f"{quote!r}: {outcome.explanation}")
            first, last = spec.story.beats[beat].frames
            answers += [
                _gone(candidate, w, spec.story.beats[beat].subject, (first, last), done=outcome.status == "pass") for w in words
            ]
    for key in named_in(spec, name, "story/requirements"):
        requirement = spec.story.requirements.get(key)
        if requirement is not None:
            frames = requirement.frames or (0, spec.simulation.frames - 1)
            found = evaluate(candidate, requirement.asked, frames)
            if found.status == "unverified":
                return Finding("unverified", f"{quote!r}: {found.explanation}")
            bodies = entities_of(requirement.predicate)[:1]
            answers += [_gone(candidate, w, b, frames, done=found.status == "pass") for w in words for b in bodies]
    if not answers:
        return Finding(
            "not_applicable", f"{quote!r} names no way, region, beat or requirement that a motion could be measured on"
        )
    action = "let it go that way, or name the beat, region or connects relation of the way"
    return finding_of(quote, answers, group="story", action=action, pointers=("/story/beats", "/graph/relations"))


def _relations(candidate: Candidate, name: str) -> Iterator[Finding]:
    for key, relation in _ways(candidate.spec, name):
        yield way_finding(candidate, key, relation)


def _ways(spec: WorldSpec, name: str) -> Iterator[tuple[str, Connects]]:
    """The `connects` relations that a claim names."""
    for key in named_in(spec, name, "graph/relations"):
        relation = spec.graph.relations.get(key)
        if isinstance(relation, Connects):
            yield key, relation


def _walked(spec: WorldSpec, name: str, words: list[Word]) -> Iterator[Answer]:
    """Answers of words of walking to relations: a person takes the way."""
    for word in (w for w in words if w.term == "walk"):
        for key, relation in _ways(spec, name):
            text = f"{key!r} is a way for {'a person' if relation.carrier == 'walker' else carrier_words(relation)}, {word.text!r} asks for a person's"
            yield Answer(word.text, relation.carrier == "walker", text, float(relation.carrier != "walker"), 0.0, "<=")


def _reached(candidate: Candidate, name: str, quote: str, region: str) -> Answer:
    for thing in things_of(candidate.spec, name):
        outcome = evaluate(candidate, Reaches(entity=thing, region=region), (0, candidate.last_frame))
        if outcome.status == "pass":
            return Answer(quote, True, f"{thing!r} comes into {region!r} at frame {outcome.first_true_frame}", 0.0, 0.0, "<=")
    return Answer(quote, False, f"nothing of its sentence ever comes into {region!r}", 1.0, 0.0, "<=")


def _gone(candidate: Candidate, word: Word, body: str, frames: tuple[int, int], *, done: bool) -> Answer:
    """The answer to whether a body goes as a word says while its beat runs."""
    if not done:
        return Answer(word.text, False, f"what it is judged by does not come true, see its own row ({body!r})", 1.0, 0.0, "<=")
    first, last = frames[0], min(frames[1], candidate.last_frame)
    way = judge_of(candidate.spec, body).centers(candidate, body)[first : last + 1]
    way = way[np.isfinite(way).all(axis=1)]
    if not len(way):
        return Answer(word.text, False, f"nothing of {body!r} is there over frames {first}..{last}", 1.0, 0.0, "<=")
    size = float(np.linalg.norm(candidate.spec.entities[body].dimensions.size))
    moved = float(np.linalg.norm(way - way[0], axis=1).max())
    down, up = float(way[0, 2] - way[:, 2].min()), float(way[:, 2].max() - way[0, 2])
    level = float(np.linalg.norm((way - way[0])[:, :2], axis=1).max())
    measures = {"down": (down, RISES * size), "up": (up, RISES * size), "walk": (level, MOVES * size)}
    value, bound = measures.get(word.term, (moved, MOVES * size))
    text = (
        f"{body!r} goes {value:.3g} m {word.term if word.term in ('down', 'up') else 'along'}, {word.text!r} asks for {bound:.3g}"
    )
    return Answer(word.text, value >= bound, text, float(value < bound), 0.0, "<=")

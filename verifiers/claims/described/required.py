"""Words of place that a requirement stands for: its predicate must entail the word, and hold of something of the sentence.

*on*: `rests_on`; *against*: `contact`; *on* and *in*: a field of a landscape in one of its zones (forest on the wet side), which is the agent's
reading of the place. Any word: `reaches` and `stays_in`, whose region is the agent's reading of the word, as
a region that a claim names itself. What only compares heights, or bounds a
distance, says of no place where it is: what stands on a thing is as near to it as what stands beside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ....worlds.predicates import (
    Contact,
    Count,
    LandscapeField,
    Not,
    Or,
    Reaches,
    RestsOn,
    StaysIn,
    atoms_of,
    describe_predicate,
    entities_of,
)
from ....worlds.spec import HeightField, SpecModel
from ...predicates.evaluators import evaluate
from ...rows.findings import Finding
from .answers import Answer

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word

__all__ = ["required"]

ANY: tuple[type, ...] = (Reaches, StaysIn)
ENTAILING: Mapping[str, tuple[type, ...]] = {
    "on": (RestsOn, LandscapeField, *ANY),
    "in": (LandscapeField, *ANY),
    "against": (Contact, *ANY),
}
"""Predicates that entail a word, where not regions alone."""


def required(
    candidate: Candidate, names: Sequence[str], words: Sequence[Word], things: Sequence[str], naming: str
) -> list[Answer] | Finding:
    """Answers to words by requirements, or that one cannot be judged.

    Args:
        candidate: what is judged.
        names: of requirements.
        words: of the claim.
        things: bodies of its sentence.
        naming: how to name the thing behind the word.
    """
    story, answers = candidate.spec.story.requirements, list[Answer]()
    for word in words:
        fit = [n for n in names if not story[n].never and _entails(story[n].predicate, word.term)]
        if not fit:
            shown = describe_predicate(story[names[0]].asked)
            text = f"requirement {names[0]!r} measures {shown}, which does not say {word.text!r}: {naming}"
            answers.append(Answer(word.text, False, text, 0.0, 1.0))
        for name in fit:
            about = entities_of(story[name].predicate)
            if not set(about) & set(things) and not _of_lands(candidate, story[name].predicate, things):
                text = f"requirement {name!r} is about {', '.join(about)}, and no thing of the sentence: {naming}"
                answers.append(Answer(word.text, False, text, 0.0, 1.0))
                continue
            outcome = evaluate(candidate, story[name].asked, story[name].frames or (0, candidate.spec.simulation.frames - 1))
            if outcome.status == "unverified":
                return Finding("unverified", f"{word.text!r}: {outcome.explanation}")
            ok = outcome.status == "pass"
            answers.append(Answer(word.text, ok, f"requirement {name!r}: {outcome.explanation}", float(ok), 1.0))
    return answers


def _entails(predicate: SpecModel, term: str) -> bool:
    """True where a predicate cannot hold without some atom that entails a word; False below a `not` and a count without `min`."""
    if isinstance(predicate, Not) or (isinstance(predicate, Count) and not (predicate.min or 0) > 0):
        return False
    if isinstance(predicate, Or):
        return all(_entails(branch, term) for branch in predicate.of)
    inner = [getattr(predicate, name, None) for name in ("predicate", "goal")] + list(getattr(predicate, "of", None) or ())
    children = [child for child in inner if isinstance(child, SpecModel)]
    if children:
        return any(_entails(child, term) for child in children)
    if isinstance(predicate, LandscapeField) and (predicate.zone is None or predicate.min is None):
        return False
    return isinstance(predicate, ENTAILING.get(term, ANY))


def _of_lands(candidate: Candidate, predicate: SpecModel, things: Sequence[str]) -> bool:
    """True if a predicate is about landscapes alone, and so is the sentence: of its things one is the ground of such a landscape, or none is a body."""
    shapes = [p.shape for n in things for p in candidate.spec.entities[n].parts.values() if isinstance(p.shape, HeightField)]
    files = [shape.file for shape in shapes if shape.file is not None]
    atoms = [a for a in atoms_of(predicate) if isinstance(a, LandscapeField)]
    whole = len(atoms) == len(atoms_of(predicate))
    return whole and all(not things or any(f.startswith(f"{a.terrain}-") for f in files) for a in atoms)

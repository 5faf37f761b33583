"""Words of place against measured poses (`claim:place:<claim>`): some thing of the same sentence is where the words say, at some frame.

What it is that stands there is found by the sentence: any thing claimed in it that is not the place itself. Where the claim names relations of
the graph, each word must be one that their kinds entail, and their own bodies are measured; a region must hold the thing; a requirement must be
of a predicate that entails the word, and hold. Of what *lies* somewhere only frames at which it is still count, of what *comes to rest* the last.

*on*, *in*, *under*, *above*, *beside*, *between*, *edge*: see `standing.py`; *against*, *behind*, *in front of*: `facing.py`. *indoors*: what is still closes a ray upward, or three of four
level ones; *outdoors*: none closes the one upward.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ....geometry.triangles import ray_hits
from ....worlds.claim_targets import named_in
from ....worlds.errors import EvidenceError, InputError
from ....worlds.poses import POSES, pose_said
from ....worlds.predicates import Reaches
from ....worlds.prompts.marks import occurrence
from ....worlds.spec import Adjacent, Contains, Fastened, Interacts, Supports
from ...predicates.evaluators import evaluate
from ...rows.findings import Finding
from .answers import Answer, finding_of
from .bounds import WALLS
from .facing import against
from .placed import Place, apart
from .posed import SAYS, frames_of, pose_answers, posed_things
from .postures import untold, why_not
from .required import required
from .rests import SENTENCE, rest_said, still_at
from .standing import TESTS, near, touching

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word
    from ....worlds.poses import Pose
    from ....worlds.spec import WorldSpec

__all__ = ["judge", "things_of"]

ENTAILED: dict[str, tuple[type, ...]] = {
    "on": (Supports, Fastened, Interacts),
    "in": (Contains,),
    "beside": (Adjacent,),
    "under": (Supports, Contains, Adjacent, Interacts, Fastened),
    "above": (Supports, Contains, Adjacent, Interacts, Fastened),
    "edge": (Supports, Contains, Adjacent),
    "between": (Adjacent, Contains),
    "against": (Adjacent, Interacts, Fastened, Supports),
    "behind": (Adjacent,),
    "front": (Adjacent,),
    "indoors": (Contains,),
    "outdoors": (Contains,),
}
"""Kinds of relation that may stand for a word."""
ON_AS: Mapping[str, Callable[[Place, str], bool]] = {"lean": against, "hang": touching}
"""Rules of *on* beside a posture: a ladder leans on its wall, and a picture hangs on it, whatever bears them."""
MUTUAL = (Adjacent, Interacts, Fastened)
"""Kinds of relation whose ends say nothing of who is where: the sentence does."""
DOWNWARD = frozenset(("under",))
MEASURED = frozenset(("under", "above", "edge", "against", "behind", "front"))
"""Words that no kind of relation entails by itself: its bodies are measured."""


def judge(candidate: Candidate, name: str, words: list[Word]) -> Finding:
    """The finding on whether something of the sentence is where the words say."""
    spec, quote = candidate.spec, candidate.spec.claims[name].quote
    relations = [n for n in named_in(spec, name, "graph/relations") if n in spec.graph.relations]
    regions = [n for n in named_in(spec, name, "graph/regions") if n in spec.graph.regions]
    grounds = [n for n in named_in(spec, name, "entities") if n in spec.entities]
    asked = [n for n in named_in(spec, name, "story/requirements") if n in spec.story.requirements]
    posed, words = [w for w in words if w.term in POSES], [w for w in words if w.term not in POSES]
    pointers = [f"/graph/relations/{r}" for r in relations] or [f"/entities/{g}/pose" for g in grounds] or ["/graph/regions"]
    action = "put it where the words say, or name the relation, region or body that they are about"
    if relations or regions or grounds or any(w.term in ("indoors", "outdoors") for w in words):
        answers = [_answer(candidate, name, w, relations, regions, grounds) for w in words]
        answers += _postures(candidate, name, words, relations, regions, grounds) if posed else []
    elif asked and words:
        naming = _naming(spec, name, words[0])
        found = required(candidate, asked, words, things_of(spec, name), naming)
        if isinstance(found, Finding):
            return found
        answers, pointers = found, [f"/claims/{name}/by", *(f"/story/requirements/{r}" for r in asked)]
        if any(not a.ok and a.text.endswith(naming) for a in found):
            action = naming
    else:
        answers = []
    if posed and not (relations or regions or grounds):
        answers = [*answers, *pose_answers(candidate, name, things_of(spec, name), ())]
    if not answers and posed and (relations or regions or grounds or asked):
        return Finding("not_applicable", f"{quote!r}: nothing of its sentence is a body, whose posture is measured")
    if not answers:
        return Finding(
            "not_applicable", f"{quote!r} names land alone; rows of `terrain` and of the thing judge what was built and is seen"
        )
    if any(a.ok is False for a in answers) and _misnamed(spec, name, grounds):
        pointers, action = [f"/claims/{name}/by"], _naming(spec, name, (words or posed)[0])
    return finding_of(quote, answers, group="placement", action=action, pointers=pointers, entities=grounds)


def _postures(
    candidate: Candidate, name: str, words: list[Word], relations: list[str], regions: list[str], grounds: list[str]
) -> list[Answer]:
    """Answers to a posture where no word of place is measured between the same bodies at the same frame."""
    spec = candidate.spec
    if not relations and not regions and any(w.term in TESTS for w in words):
        return []
    posed = pose_said(spec, name)
    # What stands in a row is what the place names; what hangs from a beam is not the beam.
    things = things_of(spec, name, grounds if posed is not None and posed.pose in ("hang", "lean") else ())
    if relations:
        ends = [(r.a, r.b) for r in map(spec.graph.relations.__getitem__, relations)]
        behind = _behind(spec, name)
        turned = [isinstance(spec.graph.relations[k], MUTUAL) and b in behind for k, (_, b) in zip(relations, ends, strict=True)]
        pairs = [(b, a) if t else (a, b) for (a, b), t in zip(ends, turned, strict=True)]
        things, grounds = [thing for _, thing in pairs], [place for place, _ in pairs if place in spec.entities]
    return pose_answers(candidate, name, [t for t in things if t in spec.entities], grounds)


def _answer(candidate: Candidate, name: str, word: Word, relations: list[str], regions: list[str], grounds: list[str]) -> Answer:
    """One word, by what the claim names: relations first, then regions, then bodies."""
    spec = candidate.spec
    for key in relations:
        relation = spec.graph.relations[key]
        if not isinstance(relation, ENTAILED[word.term]):
            kinds = " or ".join(k.__name__.lower() for k in ENTAILED[word.term])
            return Answer(word.text, False, f"{key!r} is {relation.kind}, {word.text!r} asks for {kinds}", 0.0, 1.0)
        ends = relation.a, relation.b
        if word.term in MEASURED and all(e in spec.entities for e in ends):
            if (word.term in DOWNWARD and isinstance(relation, Supports)) or (
                isinstance(relation, MUTUAL) and relation.b in _behind(spec, name)
            ):
                ends = ends[::-1]
            return _first(candidate, name, word, [ends[1]], [ends[0]])
        if word.term == "beside" and (far := _far_apart(candidate, ends)) is not None:
            return Answer(word.text, False, far, 0.0, 1.0)
    if relations:
        return Answer(word.text, True, f"{', '.join(relations)} says so, and its own row judges it", 1.0, 1.0)
    things = things_of(spec, name, grounds)
    if word.term in ("indoors", "outdoors"):
        return _housed(candidate, word, [t for t in things if t in candidate.solids] or grounds)
    if regions:
        return _in_regions(candidate, word, things, regions)
    found = _first(candidate, name, word, things, grounds)
    if found.ok is False and _misnamed(spec, name, grounds):
        text = (
            f"the claim names {', '.join(grounds)}, which stands before {word.text!r} in the prompt: {_naming(spec, name, word)}"
        )
        return found._replace(text=text)
    return found


def _far_apart(candidate: Candidate, ends: tuple[str, str]) -> str | None:
    """Why two things are not beside each other, whatever gap their relation allows: it has no scale of its own; None where they may be."""
    a, b = ends
    if a not in candidate.solids or b not in candidate.solids:
        return None
    place = Place(candidate, [b], 0)
    one, two = place.box(a), place.box(b)
    if near(one, two):
        return None
    return f"{a!r} and {b!r} are {apart(one, two):.3g} m apart at frame 0, farther than the geometric mean of their lengths"


# ---------------------------------------------------------------- the sentence


def _start(spec: WorldSpec, claim: str) -> int:
    """Where the words of a claim begin; -1 where they are not in the prompt."""
    try:
        return occurrence(spec.prompt, spec.claims[claim].quote, spec.claims[claim].nth)[0]
    except InputError:
        return -1


def _sentence(spec: WorldSpec, claim: str) -> int:
    """Number of the sentence of a claim; -1 where its words are not in the prompt."""
    ends, start = [0, *(m.end() for m in SENTENCE.finditer(spec.prompt))], _start(spec, claim)
    return -1 if start < 0 else sum(e <= start for e in ends)


def _behind(spec: WorldSpec, name: str) -> list[str]:
    """Bodies of the first thing that is claimed behind a claim in its sentence: what a word of place before it speaks of."""
    start, things = _start(spec, name), list[tuple[int, str]]()
    for other, claim in spec.claims.items():
        if claim.type in ("thing", "count") and claim.waived is None and _sentence(spec, other) == _sentence(spec, name):
            things += [(at, other) for at in (_start(spec, other),) if at > start]
    return [n for n in named_in(spec, min(things)[1], "entities") if n in spec.entities] if things else []


def _misnamed(spec: WorldSpec, name: str, grounds: Sequence[str]) -> bool:
    """True where a claim of place names a thing that stands before it in its sentence, and another one stands behind it."""
    behind = _behind(spec, name)
    before = {
        n
        for other, claim in spec.claims.items()
        if claim.type in ("thing", "count")
        and _sentence(spec, other) == _sentence(spec, name)
        and _start(spec, other) < _start(spec, name)
        for n in named_in(spec, other, "entities")
    }
    return bool(grounds and behind) and not set(grounds) & set(behind) and set(grounds) <= before


def _naming(spec: WorldSpec, name: str, word: Word) -> str:
    """Tells the mark of a claim of place: by the thing behind its word."""
    quote, behind = spec.claims[name].quote, _behind(spec, name)
    ids = " ".join(behind[:3]) if behind else "ID"
    return f"a mark of place names the thing that stands behind {word.text!r}: [{quote}](place {ids})"


def things_of(spec: WorldSpec, name: str, but: Sequence[str] = ()) -> list[str]:
    """Bodies of the things claimed in the sentence of a claim, or in the whole prompt where there is none; not those of the place."""
    found: list[list[str]] = [[], []]
    for other, claim in spec.claims.items():
        if claim.type in ("thing", "count") and claim.waived is None:
            bodies = [n for n in named_in(spec, other, "entities") if n in spec.entities and n not in but]
            found[0 if _sentence(spec, other) == _sentence(spec, name) else 1] += bodies
    return list(dict.fromkeys(found[0] or found[1]))


def _first(candidate: Candidate, name: str, word: Word, things: list[str], grounds: list[str]) -> Answer:
    """The first thing and frame at which a word holds, of those that the verb of its sentence is about."""
    if word.term not in TESTS:
        raise EvidenceError(f"no rule for {word.term}")
    if word.term == "between" and len(grounds) < 2:
        return Answer(
            word.text, False, "a claim of `between` names two bodies, so that what lies between them can be measured", 0.0, 1.0
        )
    rest, posed = rest_said(candidate.spec, name), pose_said(candidate.spec, name)
    test = TESTS[word.term] if posed is None or word.term != "on" else ON_AS.get(posed.pose, TESTS["on"])
    where, frames, passing = f"{word.term} {', '.join(grounds)}", frames_of(candidate, name), list[str]()
    open_: list[str] = []
    for frame in frames:
        place = Place(candidate, grounds, frame)
        for thing in (t for t in posed_things(candidate.spec, posed, things) if t in candidate.solids):
            if not test(place, thing):
                continue
            is_there = f"{thing!r} is {where} at frame {frame}"
            why = None if posed is None else _unposed(place, posed.pose, word, thing)
            if why is not None and posed is not None:
                passing.append(f"{is_there} and does not {posed.pose} there: {why}")
            elif rest is not None and not still_at(candidate, thing, grounds, frame):
                passing.append(f"{is_there} and not at rest there")
            elif posed is not None and (unknown := untold(place, posed.pose, thing)) is not None:
                open_.append(f"{is_there}, but {unknown}")
            else:
                return Answer(
                    word.text, True, is_there if posed is None else f"{is_there} and {SAYS[posed.pose]} there", 1.0, 1.0
                )
    if open_:
        return Answer(word.text, None, open_[0])
    text = f"none of {', '.join(things[:4]) or 'no thing of the sentence'} is {where} at frames {', '.join(map(str, frames))}"
    told = "comes to rest" if rest == "comes" else SAYS[posed.pose] if posed is not None else "lies" if rest else ""
    return Answer(
        word.text,
        False,
        (passing[0] if passing else text) + (f"; the prompt says that it {told} there" if told else ""),
        0.0,
        1.0,
    )


def _unposed(place: Place, pose: Pose, word: Word, thing: str) -> str | None:
    """Why a thing that is where a word says has not the posture that stands beside it; None where it has.

    What hangs over or above a place may jut out from what bears it, unless that is the place itself; Romance words for leaning say of what is upon
    something that it is borne by it.
    """
    if pose == "hang" and word.term == "above" and not any(place.touches(thing, g) for g in place.grounds):
        return None
    if pose == "lean" and word.term not in ("on", "against"):
        return None
    return why_not(place, pose, thing)


def _in_regions(candidate: Candidate, word: Word, things: list[str], regions: list[str]) -> Answer:
    """The answer to whether some thing comes into one of the regions."""
    for thing, region in itertools.product(things, regions):
        outcome = evaluate(candidate, Reaches(entity=thing, region=region), (0, candidate.last_frame))
        if outcome.status == "pass":
            return Answer(word.text, True, f"{thing!r} is in {region!r} at frame {outcome.first_true_frame}", 1.0, 1.0)
    return Answer(word.text, False, f"none of {', '.join(things[:4])} is ever in {', '.join(regions)}", 0.0, 1.0)


# ---------------------------------------------------------------- indoors


UP, LEVEL = np.array([[0.0, 0.0, 1.0]]), np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])


def _housed(candidate: Candidate, word: Word, things: list[str]) -> Answer:
    """The answer to whether what is still stands above a thing, or around it."""
    found = list(_closed(candidate, things))
    if not found:
        raise EvidenceError("no body stands where indoors or outdoors could be told")
    above, around = any(a for a, _ in found), max(n for _, n in found)
    inside = above or around >= WALLS
    text = f"{'something still' if above else 'nothing'} is above it, and {around} of 4 level ways meet walls"
    ok = inside if word.term == "indoors" else not above
    return Answer(word.text, ok, text, float(around), float(WALLS), ">=" if word.term == "indoors" else "<=")


def _closed(candidate: Candidate, things: list[str]) -> Iterator[tuple[bool, int]]:
    """For each thing, whether the way up is closed at frame 0, and how many level ways are."""
    still = [n for n in candidate.solids if candidate.spec.entities[n].motion == "static" and n not in things]
    for thing in things:
        center = candidate.center(thing, 0)
        corners = [_triangles(candidate, n) for n in still]
        known = np.concatenate(corners) if corners else np.empty((0, 3, 3))
        yield _meets(known, center, UP[0]), sum(_meets(known, center, d) for d in LEVEL)


def _triangles(candidate: Candidate, body: str) -> F64:
    return np.concatenate([candidate.surface(body, p.part, 0)[p.render.faces] for p in candidate.entity(body).parts])


def _meets(corner: F64, origin: F64, way: F64) -> bool:
    """True where a ray meets a triangle."""
    return bool(np.isfinite(ray_hits(corner, origin[None], way[None])).any())

"""Words of place against measured poses (`claim:place:<claim>`): some thing of the same sentence is where the words say, at some frame.

What it is that stands there is found by the sentence: any thing claimed in it that is not the place itself. Where the claim names relations of
the graph, each word must be one that their kinds entail, and their own bodies are measured; a region must hold the thing.

- *on*: it touches the place, and its centre is above the lowest point of that.
- *in*: its centre lies in the box of the place.
- *under*, *above*: the line between the centres is within 45 degrees of the vertical, or its centre is over or under the box. Logan, G. D. and
  Sadler, D. D. (1996), A computational analysis of the apprehension of spatial relations, in Language and Space: such regions are called good.
- *beside*: they overlap in height and stand no farther apart than the larger is long.
- *between*: its centre projects between those of two places, nearer to their line than half their distance.
- *edge*: it is within its own size of a side of the place's box, as seen from above.
- *indoors*: what is still closes a ray upward, or three of four level ones; *outdoors*: none closes the one upward.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.claim_targets import named_in
from ....worlds.errors import EvidenceError, InputError
from ....worlds.predicates import Reaches
from ....worlds.prompts.marks import occurrence
from ....worlds.spec import Adjacent, Contains, Fastened, Interacts, Supports
from ...predicates.evaluators import evaluate
from ...rows.findings import Finding
from ...scene.surfaces import surfaces_of
from ...shots.views import samples
from .answers import Answer, finding_of
from .bounds import NEAR, TOUCHING, WALLS

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word
    from ....worlds.spec import WorldSpec

__all__ = ["TESTS", "judge", "things_of"]

LOOKS = 9
"""Own choice: frames at which a place is looked at; the first, the last and between."""
ENTAILED: dict[str, tuple[type, ...]] = {
    "on": (Supports, Fastened, Interacts),
    "in": (Contains,),
    "beside": (Adjacent,),
    "under": (Supports, Contains, Adjacent, Interacts, Fastened),
    "above": (Supports, Contains, Adjacent, Interacts, Fastened),
    "edge": (Supports, Contains, Adjacent),
    "between": (Adjacent, Contains),
    "indoors": (Contains,),
    "outdoors": (Contains,),
}
"""Kinds of relation that may stand for a word."""
DOWNWARD = frozenset(("under",))
_SENTENCE = re.compile(r"[.!?…;。！？；]")


def judge(candidate: Candidate, name: str, words: list[Word]) -> Finding:
    """The finding on whether something of the sentence is where the words say."""
    spec, quote = candidate.spec, candidate.spec.claims[name].quote
    relations = [n for n in named_in(spec, name, "graph/relations") if n in spec.graph.relations]
    regions = [n for n in named_in(spec, name, "graph/regions") if n in spec.graph.regions]
    grounds = [n for n in named_in(spec, name, "entities") if n in spec.entities]
    if not (relations or regions or grounds) and not any(w.term in ("indoors", "outdoors") for w in words):
        return Finding(
            "not_applicable", f"{quote!r} names land alone; rows of `terrain` and of the thing judge what was built and is seen"
        )
    answers = [_answer(candidate, name, w, relations, regions, grounds) for w in words]
    # Of several words one may only bind, as `in` of `in the middle of the shelf, on top`: the place is where one says, and none is denied.
    action = "put it where the words say, or name the relation, region or body that they are about"
    pointers = [f"/graph/relations/{r}" for r in relations] or [f"/entities/{g}/pose" for g in grounds] or ["/graph/regions"]
    return finding_of(quote, answers, group="placement", action=action, pointers=pointers, entities=grounds)


def _answer(candidate: Candidate, name: str, word: Word, relations: list[str], regions: list[str], grounds: list[str]) -> Answer:
    """One word, by what the claim names: relations first, then regions, then bodies."""
    spec = candidate.spec
    test = TESTS.get(word.term)
    for key in relations:
        relation = spec.graph.relations[key]
        if not isinstance(relation, ENTAILED[word.term]):
            kinds = " or ".join(k.__name__.lower() for k in ENTAILED[word.term])
            return Answer(word.text, False, f"{key!r} is {relation.kind}, {word.text!r} asks for {kinds}", 0.0, 1.0)
        if (
            relation.a in spec.entities
            and relation.b in spec.entities
            and test is not None
            and word.term not in ("on", "in", "beside", "between")
        ):
            ends = (
                (relation.a, relation.b) if word.term in DOWNWARD and isinstance(relation, Supports) else (relation.b, relation.a)
            )
            return _first(candidate, word, [ends[0]], [ends[1]], test)
    if relations:
        return Answer(word.text, True, f"{', '.join(relations)} says so, and its own row judges it", 1.0, 1.0)
    things = things_of(spec, name, grounds)
    if word.term in ("indoors", "outdoors"):
        return _housed(candidate, word, [t for t in things if t in candidate.solids] or grounds)
    if regions:
        return _in_regions(candidate, word, things, regions)
    return _first(candidate, word, things, grounds, test)


def things_of(spec: WorldSpec, name: str, but: Sequence[str] = ()) -> list[str]:
    """Bodies of the things claimed in the sentence of a claim, or in the whole prompt where there is none; not those of the place."""
    ends = [0, *(m.end() for m in _SENTENCE.finditer(spec.prompt)), len(spec.prompt)]

    def sentence(claim: str) -> int:
        try:
            start, _ = occurrence(spec.prompt, spec.claims[claim].quote, spec.claims[claim].nth)
        except InputError:
            return -1
        return sum(e <= start for e in ends)

    found: list[list[str]] = [[], []]
    for other, claim in spec.claims.items():
        if claim.type in ("thing", "count") and claim.waived is None:
            bodies = [n for n in named_in(spec, other, "entities") if n in spec.entities and n not in but]
            found[0 if sentence(other) == sentence(name) else 1] += bodies
    return list(dict.fromkeys(found[0] or found[1]))


def _frames(candidate: Candidate) -> list[int]:
    return samples((0, candidate.last_frame), LOOKS)


def _first(
    candidate: Candidate, word: Word, things: list[str], grounds: list[str], test: Callable[[_Place, str], bool] | None
) -> Answer:
    """The first thing and frame at which a word holds."""
    if test is None:
        raise EvidenceError(f"no rule for {word.term}")
    if word.term == "between" and len(grounds) < 2:
        return Answer(
            word.text, False, "a claim of `between` names two bodies, so that what lies between them can be measured", 0.0, 1.0
        )
    for frame in _frames(candidate):
        place = _Place(candidate, grounds, frame)
        for thing in things:
            if thing in candidate.solids and test(place, thing):
                return Answer(word.text, True, f"{thing!r} is {word.term} {', '.join(grounds)} at frame {frame}", 1.0, 1.0)
    looked = f"at frames {', '.join(map(str, _frames(candidate)))}"
    text = f"none of {', '.join(things[:4]) or 'no thing of the sentence'} is {word.term} {', '.join(grounds)} {looked}"
    return Answer(word.text, False, text, 0.0, 1.0)


def _in_regions(candidate: Candidate, word: Word, things: list[str], regions: list[str]) -> Answer:
    """The answer to whether some thing comes into one of the regions."""
    for thing, region in itertools.product(things, regions):
        outcome = evaluate(candidate, Reaches(entity=thing, region=region), (0, candidate.last_frame))
        if outcome.status == "pass":
            return Answer(word.text, True, f"{thing!r} is in {region!r} at frame {outcome.first_true_frame}", 1.0, 1.0)
    return Answer(word.text, False, f"none of {', '.join(things[:4])} is ever in {', '.join(regions)}", 0.0, 1.0)


# ---------------------------------------------------------------- geometry at one frame


class _Place:
    """Boxes and centres of bodies at a frame."""

    def __init__(self, candidate: Candidate, grounds: list[str], frame: int) -> None:
        self.candidate, self.frame = candidate, frame
        self.grounds = [g for g in grounds if g in candidate.solids]

    def box(self, body: str) -> F64:
        """Least and greatest corner [m], shape (2, 3)."""
        points = self.candidate.vertices(body, self.frame)
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def center(self, body: str) -> F64:
        """Centre of mass [m]."""
        return self.candidate.center(body, self.frame)

    def gap(self, a: str, b: str) -> float:
        """Distance of their surfaces [m]."""
        return surfaces_of(self.candidate).gap(a, b, self.frame).distance


def _on(place: _Place, thing: str) -> bool:
    gap = TOUCHING * place.candidate.spec.simulation.limits.contact_gap
    high = place.center(thing)[2]
    return any(
        high > place.box(g)[0, 2] and _apart(place.box(g), place.box(thing)) <= gap and place.gap(thing, g) <= gap
        for g in place.grounds
    )


def _in(place: _Place, thing: str) -> bool:
    center = place.center(thing)
    return any(bool(((center >= b[0]) & (center <= b[1])).all()) for b in map(place.box, place.grounds))


def _vertical(place: _Place, thing: str, *, above: bool) -> bool:
    center = place.center(thing)
    for ground in place.grounds:
        box, way = place.box(ground), center - place.center(ground)
        way = way if above else -way
        over = bool(((center[:2] >= box[0, :2]) & (center[:2] <= box[1, :2])).all())
        beyond = center[2] >= box[1, 2] if above else center[2] <= box[0, 2]
        if way[2] > 0.0 and ((over and beyond) or way[2] >= np.linalg.norm(way[:2])):
            return True
    return False


def _beside(place: _Place, thing: str) -> bool:
    own = place.box(thing)
    for ground in place.grounds:
        box = place.box(ground)
        level = own[0, 2] <= box[1, 2] and box[0, 2] <= own[1, 2]
        reach = NEAR * max(float(np.ptp(own, axis=0).max()), float(np.ptp(box, axis=0).max()))
        if level and _apart(own, box) <= reach and not (_in(place, thing) and _on(place, thing)):
            return True
    return False


def _between(place: _Place, thing: str) -> bool:
    center = place.center(thing)
    for a, b in itertools.combinations(place.grounds, 2):
        start, way = place.center(a), place.center(b) - place.center(a)
        length = float(np.linalg.norm(way))
        share = float((center - start) @ way) / max(length**2, 1e-12)
        if 0.0 < share < 1.0 and np.linalg.norm(center - start - share * way) <= 0.5 * length:
            return True
    return False


def _edge(place: _Place, thing: str) -> bool:
    own, center = place.box(thing), place.center(thing)
    reach = float(np.ptp(own, axis=0)[:2].max())
    for box in map(place.box, place.grounds):
        near = np.minimum(np.abs(center[:2] - box[0, :2]), np.abs(box[1, :2] - center[:2])).min() <= reach
        if near and _apart(own, box) <= reach:
            return True
    return False


def _apart(a: F64, b: F64) -> float:
    """Distance of two boxes [m]; 0 where they meet."""
    return float(np.linalg.norm(np.maximum(np.maximum(a[0] - b[1], b[0] - a[1]), 0.0)))


TESTS: dict[str, Callable[[_Place, str], bool]] = {
    "on": _on,
    "in": _in,
    "under": partial(_vertical, above=False),
    "above": partial(_vertical, above=True),
    "beside": _beside,
    "between": _between,
    "edge": _edge,
}
"""Rules of words about a thing at a frame."""

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
    """True where a ray meets a triangle: Moeller, T. and Trumbore, B. (1997), Fast, minimum storage ray/triangle intersection."""
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    p = np.cross(way, b)
    det = (a * p).sum(axis=1)
    inverse = 1.0 / np.where(np.abs(det) < 1e-12, np.inf, det)
    s = origin - corner[:, 0]
    u = (s * p).sum(axis=1) * inverse
    q = np.cross(s, a)
    v, t = q @ way * inverse, (b * q).sum(axis=1) * inverse
    return bool(((np.abs(det) >= 1e-12) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-6)).any())

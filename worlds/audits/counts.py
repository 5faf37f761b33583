"""Claims of a count against what they name: so many separate bodies, and every event about them told of all (R131, R155).

A count names entities, parts of an entity that claims of things name as well, a beat or requirement that counts who does something, or a
number of the specification. How many there are, and how many of them do it, is measured in `verifiers/claims/counts.py`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ..claims import named_in, targets_of
from ..errors import InputError
from ..predicates import And, Count, entities_of
from ..problems import Problem
from ..prompts.languages import language_of
from ..prompts.numbers import number_in
from ..prompts.quotes import occurrence
from ..prompts.shares import sides_behind
from ..repeats import is_repeat
from ..slices import geometry_slice
from ..spec import Beat, Claim, Requirement, SpecModel, WorldSpec
from .repeats import repeat_problems

__all__ = ["Counted", "count_problems", "counted_of", "countings_of"]

_NO_COUNTS = (
    "/simulation/seed",
    "/simulation/solvers",
    "/simulation/limits",
    "/simulation/fps",
    "/simulation/frames",
    "/simulation/order",
)
"""Whole numbers of the specification that count nothing that is to be seen."""
_STORY = ("story/beats", "story/requirements")


class Counted(NamedTuple):
    """Things that a claim counts, and the number of its words."""

    number: float | None
    """That its words state, of all sides together; None where they are not understood."""
    units: tuple[str, ...]
    """Pointers of the things that it counts: of entities, or of parts of them."""
    bodies: tuple[str, ...]
    """Entities among them."""
    stories: tuple[tuple[str, str], ...]
    """Beats and requirements that count for it: (group, id)."""
    sides: int = 1
    """To each of which its words give their number: 2 where they say `on each side`."""

    @property
    def asked(self) -> float | None:
        """The number that there have to be."""
        return self.number if self.number is not None else (float(len(self.units)) if self.units else None)


def counted_of(spec: WorldSpec, name: str) -> Counted:
    """Everything that a claim of a count names."""
    units: dict[str, None] = {}
    for pointer in targets_of(spec.claims, name):
        keys = pointer.strip("/").split("/")
        if keys[0] == "entities" and (len(keys) == 2 or (len(keys) == 4 and keys[2] == "parts")):
            units[pointer] = None
    bodies = dict.fromkeys(u.split("/")[2] for u in units)
    stories = tuple((group, n) for group in _STORY for n in named_in(spec, name, group))
    claim, language = spec.claims[name], language_of(spec.prompt)
    number = number_in(claim.quote, language)
    try:
        end = occurrence(spec.prompt, claim.quote, claim.nth)[1]
    except InputError:
        end = len(spec.prompt)  # a quote that is not in the prompt is told by itself
    sides = sides_behind(spec.prompt, end, language)
    return Counted(None if number is None else sides * number, tuple(units), tuple(bodies), stories, sides)


def countings_of(predicate: SpecModel) -> list[Count]:
    """Counts without which a predicate cannot hold."""
    if isinstance(predicate, Count):
        return [predicate]
    return [found for member in predicate.of for found in countings_of(member)] if isinstance(predicate, And) else []


def count_problems(spec: WorldSpec, name: str, claim: Claim, leaves: Mapping[str, float | None]) -> Iterator[Problem]:
    """Problems of one claim of a count.

    Args:
        spec: the specification.
        name: of the claim.
        claim: itself.
        leaves: whole numbers of the specification that its pointers lead to, by pointer.
    """
    if is_repeat(spec, name):
        yield from repeat_problems(spec, name, claim, leaves)
        return
    found, place = counted_of(spec, name), f"/claims/{name}/by"
    own = {p: v for p, v in leaves.items() if not p.startswith(_NO_COUNTS)}
    if own.keys() != leaves.keys():
        text = f"{claim.quote!r} is judged by {min(leaves.keys() - own.keys())}, a setting that counts nothing of what is to be seen: "
        yield Problem(place, text + "name the entities, or a number of the thing itself, as the pieces of its pattern")
    yield from _told_by(spec, claim, found, place)
    number = found.number
    if found.stories or (number is not None and any(leaf is not None and leaf == number for leaf in own.values())):
        return
    if number is not None and len(found.units) != number:
        named = ", ".join(u.removeprefix("/entities/") for u in found.units[:4])
        text = f"{claim.quote!r} counts {number:g}{_shared(found)}, by names {len(found.units)} ({named}); name exactly {number:g} separate entities"
        yield Problem(place, text)
        return
    yield from _parts(spec, claim, found, place)
    like = _alike(spec, found.bodies)
    if like:
        text = f"{claim.quote!r} counts {len(found.bodies)}, but {', '.join(like[:3])} has the same shape and material: name it too, or take it away"
        yield Problem(place, text)
    yield from _more(spec, name, claim, set(found.bodies), place)
    yield from _partly_told(spec, name, claim, set(found.bodies))
    yield from _untold(spec, name, claim, set(found.bodies))


def _shared(found: Counted) -> str:
    """Why the number is more than the one that stands there."""
    return f" ({(found.number or 0) / found.sides:g} on each of {found.sides} sides)" if found.sides > 1 else ""


def _told_by(spec: WorldSpec, claim: Claim, found: Counted, place: str) -> Iterator[Problem]:
    """Beats and requirements that are to count and do not, or another number."""
    for group, key in found.stories:
        told = getattr(spec.story, group.split("/")[1]).get(key)
        if told is None:
            continue
        counts = countings_of(told.predicate)
        if not counts:
            yield Problem(
                place, f"{claim.quote!r} is a count: {key!r} counts nobody; give it a `count` predicate over all of them"
            )
        elif found.number is not None and not any(c.min == found.number for c in counts):
            text = f"{claim.quote!r} counts {found.number:g}, {key!r} asks for at least {counts[0].min or 0:g}; give it min {found.number:g}"
            yield Problem(f"/{group}/{key}/predicate", text)


def _parts(spec: WorldSpec, claim: Claim, found: Counted, place: str) -> Iterator[Problem]:
    """Parts of one body that are counted and that no claim of a thing names."""
    named = {p for n, c in spec.claims.items() if c.type == "thing" and c.waived is None for p in targets_of(spec.claims, n)}
    lost = [u for u in found.units if "/parts/" in u and u not in named]
    if lost:
        text = f"{claim.quote!r} counts {lost[0].removeprefix('/entities/')}, a part of one body: count separate entities, or name the parts in the claim of the thing too"
        yield Problem(place, text)


def _alike(spec: WorldSpec, bodies: tuple[str, ...]) -> list[str]:
    """Entities beside the counted ones of the very same shape and material."""
    known = [n for n in bodies if n in spec.entities]
    forms = [geometry_slice(spec, n) for n in known]
    others = {n for other, c in spec.claims.items() if c.type in ("thing", "count") for n in named_in(spec, other, "entities")}
    return [n for n in spec.entities if n not in others and n not in known and geometry_slice(spec, n) in forms]


def _more(spec: WorldSpec, name: str, claim: Claim, bodies: set[str], place: str) -> Iterator[Problem]:
    """Claims of things that name the counted bodies and more, where no other count has those and nothing tells them apart."""
    counts = [set(named_in(spec, n, "entities")) for n, c in spec.claims.items() if c.type == "count" and n != name]
    for other, thing in spec.claims.items():
        named = set(named_in(spec, other, "entities"))
        if thing.type != "thing" or thing.waived is not None or not bodies or not bodies < named or named in counts:
            continue
        if not _singled(spec, bodies, named - bodies, {name, other}):
            text = f"{claim.quote!r} counts {len(bodies)} and {thing.quote!r} names {len(named)} ({', '.join(sorted(named - bodies)[:3])} too): name the same, or claim what the {len(bodies)} do"
            yield Problem(place, text)


def _singled(spec: WorldSpec, bodies: set[str], rest: set[str], but: set[str]) -> bool:
    """True where a claim speaks of the counted bodies and of none of the rest."""
    for other, claim in spec.claims.items():
        if other in but or claim.waived is not None or claim.same_as in but:
            continue
        told = set(named_in(spec, other, "entities"))
        told |= {e for b in named_in(spec, other, _STORY[0]) if b in spec.story.beats for e in _about(spec.story.beats[b])}
        if told & bodies and not told & rest:
            return True
    return False


def _partly_told(spec: WorldSpec, name: str, claim: Claim, bodies: set[str]) -> Iterator[Problem]:
    """Events about some of the counted bodies and not about all of them, unless another count is of just those."""
    single = {n for o, c in spec.claims.items() if c.type == "thing" for n in named_in(spec, o, "entities") if len(c.by) == 1}
    counts = [set(named_in(spec, n, "entities")) for n, c in spec.claims.items() if c.type == "count" and n != name]
    for other, event in spec.claims.items():
        if event.type != "event" or event.waived is not None:
            continue
        told = {e for b in named_in(spec, other, _STORY[0]) if b in spec.story.beats for e in _about(spec.story.beats[b])}
        left = bodies - told - single
        if told & (bodies - single) and left and told & bodies not in counts:
            text = f"{event.quote!r} is told of {', '.join(sorted(told & bodies)[:3])} and not of {', '.join(sorted(left)[:3])}, of {claim.quote!r}: add a "
            text += "beat about them, use a `count` predicate over all, or claim single ones by spans of their own "
            text += "(in marked text [the last one](thing ID same_as=CLAIM), CLAIM being that of them all); halves of one verb make one claim: name all "
            text += "its beats at one half, and mark the other [um](event same_as=CLAIM)"
            yield Problem(f"/claims/{other}/by", text)


def _untold(spec: WorldSpec, name: str, claim: Claim, bodies: set[str]) -> Iterator[Problem]:
    """Counted bodies that can move and of which no claim says anything, in a prompt whose events are all judged."""
    judged = {o: c for o, c in spec.claims.items() if c.waived is None and c.type not in ("thing", "count")}
    moving = sorted(n for n in bodies & set(spec.entities) if spec.entities[n].motion == "dynamic")
    waived = any(c.type == "event" and c.waived is not None for c in spec.claims.values())
    if waived or not moving or not any(c.type == "event" for c in judged.values()):
        return
    story: Mapping[str, Mapping[str, Beat | Requirement]] = dict(
        zip(_STORY, (spec.story.beats, spec.story.requirements), strict=True)
    )
    asked = [group[n] for o in judged for place, group in story.items() for n in named_in(spec, o, place) if n in group]
    told = {e for a in asked for e in (_about(a) if isinstance(a, Beat) else entities_of(a.predicate))}
    told |= {n for o in judged for n in named_in(spec, o, "entities")}
    relations = [
        spec.graph.relations[r] for o in judged for r in named_in(spec, o, "graph/relations") if r in spec.graph.relations
    ]
    if (told | {end for r in relations for end in (r.a, r.b)}) & set(moving):
        return
    text = f"nothing that is claimed says what becomes of {claim.quote!r} ({', '.join(moving[:3])}): name a beat about them for the words of what happens to them, "
    yield Problem(f"/claims/{name}/by", text + "or claim where they stand by a relation or requirement")


def _about(beat: Beat) -> tuple[str, ...]:
    return (beat.subject, *entities_of(beat.predicate))

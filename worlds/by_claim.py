"""Two worlds of one prompt compared by claim, never by pointer: where the one asks less than the other (R157).

Whoever starts anew chooses new ids: what a claim binds is compared with what the claim of the same words binds in the other world, its
bodies, beats and requirements under one name. Where one of them has no claims, only what holds for the whole of a world is compared.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from .aligned import HELD, matched_claims, named_alike, renamed
from .bound_fields import natures
from .claims import named_in
from .holding import holding_weakenings
from .kinds_said import kinds_said_otherwise
from .patch import differences, entity_weakenings
from .predicates import entities_of
from .predicates.registry import interval_tightens
from .spec import WorldSpec
from .weakened import directed_weakenings, physical_weakenings, relation_weakenings
from .weakened_story import story_weakenings

__all__ = ["easier_by_claim"]

Document = dict[str, Any]
_PAIRS = "/simulation/contacts"
"""A pair that comes or goes is judged as a whole."""


def easier_by_claim(before: WorldSpec, after: WorldSpec, said: Collection[str] = ()) -> list[str]:
    """Where `after` is easier to satisfy than `before`, in words; ids are those of `before`.

    Args:
        before: specification of a world whose rows failed.
        after: that of another world of nearly the same prompt.
        said: entities of `before` on which a row failed that their roles ask.
    """
    if not before.claims or not after.claims:
        return list(_everywhere(before, after))
    matches = matched_claims(before, after)
    names = named_alike(before, after, matches)
    aligned = WorldSpec.model_validate(renamed(after, names, before))
    return [*_claims(before, after, matches), *_bound(before, aligned), *kinds_said_otherwise(before, aligned, said)]


# ---------------------------------------------------------------- the claims themselves


def _claims(before: WorldSpec, after: WorldSpec, matches: Mapping[str, str | None]) -> Iterator[str]:
    for mine, theirs in matches.items():
        claim, told = before.claims[mine], f"claim of {before.claims[mine].quote!r}"
        if claim.waived is not None:
            continue
        if theirs is None:
            yield f"{told} dropped: these words are filler"
            continue
        other = after.claims[theirs]
        if other.waived is not None:
            yield f"{told} waived: {other.waived}"
        elif other.type != claim.type:
            yield f"{told} is {other.type}, was {claim.type}"
        else:
            for group, noun in (("story/beats", "beats"), ("story/requirements", "requirements")):
                was, now = len(named_in(before, mine, group)), len(named_in(after, theirs, group))
                if now < was:
                    yield f"{told} is judged by {now} {noun}, before by {was}"


# ---------------------------------------------------------------- what they bind


def _bound(before: WorldSpec, after: WorldSpec) -> Iterator[str]:
    """Lines of beats, requirements, relations, bodies and physics that claims of `before` bind, both under one name."""
    old, new = (spec.model_dump(mode="json", exclude_none=True) for spec in (before, after))
    bound = {group: _named(before, group) for group in ("entities", "story/beats", "story/requirements", "graph/relations")}
    rate = before.simulation.fps / after.simulation.fps
    mine, theirs = Document(), Document()
    for kind in ("beats", "requirements"):
        was, now = old["story"][kind], new["story"][kind]
        mine[kind] = {n: was[n] for n in bound[f"story/{kind}"] if n in was and n in now}
        theirs[kind] = {n: _in_time_of(was[n], now[n], rate) for n in mine[kind]}
    yield from story_weakenings(mine, theirs)
    relations = old["graph"]["relations"], new["graph"]["relations"]
    for name in (n for n in bound["graph/relations"] if n in relations[0] and n in relations[1]):
        yield from relation_weakenings(f"/graph/relations/{name}", relations[0][name], relations[1][name])
    bodies = [n for n in _bodies(before, bound) if n in old["entities"] and n in new["entities"]]
    old["entities"] = {n: old["entities"][n] for n in bodies}
    yield from entity_weakenings(old["entities"], new["entities"])
    nature = natures(before)
    own = tuple(place for n in bodies for place in (f"/entities/{n}", *nature[n]))
    yield from _of_physics(before, after, old, new, own)
    yield from holding_weakenings(before, after, bodies)


def _everywhere(before: WorldSpec, after: WorldSpec) -> Iterator[str]:
    """Lines of what holds for the whole of a world."""
    old, new = (spec.model_dump(mode="json", exclude_none=True) for spec in (before, after))
    old |= {"entities": {}, "simulation": {**old["simulation"], "couplings": {}}}
    yield from _of_physics(before, after, old, new, ())


def _of_physics(before: WorldSpec, after: WorldSpec, old: Document, new: Document, own: tuple[str, ...]) -> Iterator[str]:
    """Lines of fields of the simulation that belong to no member of a collection, and of what stands at pointers and below them."""
    held = tuple(f"/{group}/" for group in HELD)
    whole = before.model_dump(mode="json"), after.model_dump(mode="json")

    def compared(place: str) -> bool:
        if place.rpartition("/")[0] == _PAIRS:
            return bool(own)
        everywhere = place.startswith("/simulation/") and not place.startswith(held)
        bound = any(place == at or place.startswith(f"{at}/") for at in own) or (bool(own) and place.startswith(f"{_PAIRS}/"))
        return (everywhere or bound) and all(_leads(document, place) for document in whole)

    places = list(filter(compared, differences(*whole)))
    yield from directed_weakenings(old, new, places)
    yield from physical_weakenings(before, after, old, new, places)


def _leads(document: Document, pointer: str) -> bool:
    """True where there is such a field, whatever its value: engines and kinds of joint have different ones."""
    at: Any = document
    for token in pointer.split("/")[1:]:
        if not isinstance(at, dict) or token not in at:
            return False
        at = at[token]
    return True


def _named(spec: WorldSpec, group: str) -> list[str]:
    """Members of a collection that claims are judged by."""
    judged = (name for name, claim in spec.claims.items() if claim.waived is None)
    return list(dict.fromkeys(member for name in judged for member in named_in(spec, name, group)))


def _bodies(spec: WorldSpec, bound: Mapping[str, list[str]]) -> list[str]:
    """Bodies that claims, or what they are judged by, speak of."""
    beats = [spec.story.beats[n] for n in bound["story/beats"] if n in spec.story.beats]
    asked = [spec.story.requirements[n] for n in bound["story/requirements"] if n in spec.story.requirements]
    found = [*bound["entities"], *(b.subject for b in beats)]
    found += [n for p in (*(b.predicate for b in beats), *(r.predicate for r in asked)) for n in entities_of(p)]
    return list(dict.fromkeys(found))


def _in_time_of(old: Document, new: Document, rate: float) -> Document:
    """A beat or requirement whose frames begin, or end where the end is judged, with those of another; only how long they are is compared.

    Args:
        rate: frames per second of the other over those of this one.
    """
    if not old.get("frames") or not new.get("frames"):
        return new
    (first, last), more = old["frames"], round((new["frames"][1] - new["frames"][0]) * rate)
    frames = [last - more, last] if interval_tightens(old["predicate"]) == "end" else [first, first + more]
    return {**new, "frames": frames}

"""Scenery: things made by generators of which nothing is asked. To take one out, or to make it static, eases no requirement (R157)."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping

from .references import references
from .spec import SpecModel, WorldSpec

__all__ = ["of_scenery", "scenery"]

_ALONG = re.compile(r"/simulation/solvers/[^/]+/members/|/interiors/[^/]+/entities/|/look/lamps/")
"""Where a thing is named only since it is there."""
_HELD = re.compile(r"/graph/relations/([^/]+)/(a|b)$|/simulation/joints/([^/]+)/(parent|child)$|/entities/([^/]+)/asset/bodies/")
"""Where a thing is named beside another one."""
_LINE = re.compile(
    r"/entities/(?P<entity>[^/ ]+) removed$|/entities/(?P<still>[^/ ]+)/motion dynamic -> static$"
    r"|/graph/relations/(?P<gone>[^/ ]+) \(supports\) removed$"
    r"|/graph/relations/(?P<held>[^/:]+): overlap of (?P<a>\S+) and (?P<b>\S+) declared intended$"
)


def scenery(spec: WorldSpec) -> set[str]:
    """Things made by generators, and their further bodies, that no claim, story, shot, driver, pair or other thing names."""
    made = {n for n, e in spec.entities.items() if e.asset is not None}
    found = made | {b for n in made for b in _bodies(spec, n)}
    named = list(_named(spec))
    while True:
        out = {name for name, others in named if name in found and not others <= found}
        if not out:
            return found
        found -= out


def _bodies(spec: WorldSpec, name: str) -> set[str]:
    asset = spec.entities[name].asset
    return set() if asset is None else {b for b in asset.bodies if b in spec.entities}


def _named(spec: WorldSpec) -> Iterator[tuple[str, set[str]]]:
    """Every naming of an entity: with the others without which it is none of scenery; a name of nobody where it is asked about."""
    asked = {""}
    holders: Mapping[str, Mapping[str, SpecModel]] = {"relations": spec.graph.relations, "joints": spec.simulation.joints}
    for pointer in (p for claim in spec.claims.values() for p in claim.by):
        _, group, key, *rest = (*pointer.split("/"), "", "")
        holder = holders.get(key, {})
        if group == "entities":
            yield key, asked
        elif rest[0] in holder:
            yield from ((name, asked) for _, target, name in references(holder[rest[0]], "") if target in ("entity", "node"))
    for place, target, name in references(spec, ""):
        if target not in ("entity", "node") or _ALONG.match(place):
            continue
        beside = _HELD.match(place)
        yield name, asked if beside is None else _others(spec, beside)


def _others(spec: WorldSpec, beside: re.Match[str]) -> set[str]:
    """Who else has to be of the scenery: what stands on something else leaves that as it was."""
    relation, end, joint, side, whole = beside.groups()
    if relation is not None:
        held = spec.graph.relations[relation]
        if held.kind not in ("supports", "fastened"):
            return {""}
        return set() if held.kind == "supports" and end == "b" else {held.b if end == "a" else held.a}
    if joint is not None:
        tied = spec.simulation.joints[joint]
        return {str(tied.child if side == "parent" else tied.parent)}
    return {str(whole)}


def of_scenery(line: str, before: WorldSpec, after: WorldSpec, free: Collection[str]) -> bool:
    """True of a line about an edit that takes scenery out, or makes it static as it stands.

    Args:
        line: a weakening, in words.
        before: the specification before the edit.
        after: the one after it.
        free: scenery of `before` that no failing row names.
    """
    found = _LINE.match(line)
    if found is None:
        return False
    told: Mapping[str, str | None] = found.groupdict()
    if told["gone"] is not None:
        relation = before.graph.relations[told["gone"]]
        return relation.b in free and relation.b not in after.entities
    names = {n for k in ("entity", "still", "a", "b") if (n := told[k]) is not None}
    return names <= set(free)

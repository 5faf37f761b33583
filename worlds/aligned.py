"""Two specifications of one prompt side by side: which claim is which, and one of them under the names of the other (R157).

Claims are matched by the words of the prompt that they share. What matched claims are judged by is the same thing, body or beat
whatever its id; what belongs to it, as its material, its joints and its solver, follows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from typing import Any

from .claims import named_in, reading_of
from .prompts.units import folded, units_of
from .references import references
from .spec import WorldSpec

__all__ = ["Names", "matched_claims", "named_alike", "renamed"]

GROUPS = ("entities", "terrains", "story/beats", "story/requirements", "graph/relations", "graph/regions", "materials")
"""Collections whose members claims name, or that follow from them."""
HELD = ("simulation/solvers", "simulation/joints", "simulation/contacts", "simulation/couplings", "simulation/drivers")
"""Collections whose members are known by the bodies that they name."""
_TARGETS: Mapping[str, tuple[str, ...]] = {
    "entity": ("entities",),
    "node": ("entities", "graph/regions", "terrains"),
    "region": ("graph/regions",),
    "beat": ("story/beats",),
    "solver": ("simulation/solvers",),
    "joint": ("simulation/joints",),
    "material": ("materials",),
    "owner": ("simulation/solvers", "simulation/drivers"),
}
"""Collections in which a reference is looked up, by its target."""

Names = dict[str, dict[str, str]]
"""Ids of the one specification by those of the other, by collection."""


def matched_claims(before: WorldSpec, after: WorldSpec) -> dict[str, str | None]:
    """For every claim of the one specification the claim of the other that takes up most of its words; None where they are filler."""
    same = _same_units(before.prompt, after.prompt)
    theirs = {unit: name for name, units in _units_of_claims(after).items() for unit in units}
    found: dict[str, str | None] = {}
    for name, units in _units_of_claims(before).items():
        shared = [theirs[same[u]] for u in units if same.get(u) in theirs]
        kind = before.claims[name].type
        found[name] = max(dict.fromkeys(shared), key=lambda n: (shared.count(n), after.claims[n].type == kind), default=None)
    return found


def _units_of_claims(spec: WorldSpec) -> dict[str, list[int]]:
    units = units_of(spec.prompt)
    spans = [s for s in reading_of(spec).spans if s.claim is not None]
    return {str(s.claim): [k for k, u in enumerate(units) if s.start <= u.start and u.end <= s.end] for s in spans}


def _same_units(one: str, other: str) -> dict[int, int]:
    """Units of a prompt by their number, with those of another that are the same word at the same place."""
    a, b = ([folded(u.text) for u in units_of(text)] for text in (one, other))
    if a == b:
        return {k: k for k in range(len(a))}
    blocks = SequenceMatcher(None, a, b, autojunk=False).get_matching_blocks()
    return {block.a + k: block.b + k for block in blocks for k in range(block.size)}


# ---------------------------------------------------------------- pairs


class _Pairs:
    """Ids that mean the same, one to one."""

    def __init__(self) -> None:
        self.names: Names = {group: {} for group in (*GROUPS, *HELD)}
        self._taken: dict[str, set[str]] = {group: set() for group in self.names}

    def put(self, group: str, old: str, new: str) -> bool:
        """True where two ids mean the same now; not where one of them means another already."""
        known = self.names[group]
        if new not in known and old not in self._taken[group]:
            known[new] = old
            self._taken[group].add(old)
        return known.get(new) == old

    def put_all(self, group: str, old: Sequence[str], new: Sequence[str]) -> None:
        """As `put`, of lists: equal ids first, the others in order."""
        for name in [n for n in old if n in new]:
            self.put(group, name, name)
        left = [n for n in old if n not in self._taken[group]]
        for one, other in zip(left, [n for n in new if n not in self.names[group]], strict=False):
            self.put(group, one, other)


def named_alike(before: WorldSpec, after: WorldSpec, matches: Mapping[str, str | None]) -> Names:
    """Ids of `before` by those of `after`, as far as matched claims say that they mean the same."""
    pairs = _Pairs()
    # Claims of one body say most surely which it is; those of order name what others name, in their own order.
    known = sorted(
        ((a, b) for a, b in matches.items() if b is not None),
        key=lambda ab: (before.claims[ab[0]].type == "order", len(before.claims[ab[0]].by)),
    )
    for mine, theirs in known:
        for group in GROUPS:
            pairs.put_all(group, named_in(before, mine, group), named_in(after, theirs, group))
    for new, old in list(pairs.names["story/beats"].items()):
        _beat(pairs, before, after, old, new)
    for new, old in list(pairs.names["story/requirements"].items()):
        requirements = before.story.requirements.get(old), after.story.requirements.get(new)
        if None not in requirements:
            _bodies(pairs, *(r.predicate for r in requirements if r is not None))
    for new, old in pairs.names["graph/relations"].items():
        _sides(pairs, before, after, old, new)
    _matter(pairs, before, after)
    for group in HELD:
        _held(pairs, group, before, after)
    return pairs.names


def _beat(pairs: _Pairs, before: WorldSpec, after: WorldSpec, old: str, new: str) -> None:
    """Bodies and causes of two beats that mean the same."""
    one, other = before.story.beats.get(old), after.story.beats.get(new)
    if one is None or other is None:
        return
    pairs.put("entities", one.subject, other.subject)
    _bodies(pairs, one.predicate, other.predicate)
    pairs.put_all("story/beats", one.causes, other.causes)


def _sides(pairs: _Pairs, before: WorldSpec, after: WorldSpec, old: str, new: str) -> None:
    """Pairs of what two relations that mean the same hold between, where its id is the same in both."""
    one, other = before.graph.relations.get(old), after.graph.relations.get(new)
    if one is None or other is None:
        return
    for mine, theirs in ((one.a, other.a), (one.b, other.b)):
        if mine == theirs:
            for group in (g for g in _TARGETS["node"] if mine in _members(before, g) and mine in _members(after, g)):
                pairs.put(group, mine, mine)


def _bodies(pairs: _Pairs, one: Any, other: Any) -> None:
    """Pairs of entities and regions that two predicates name at the same place."""
    theirs = {place: value for place, target, value in references(other, "") if target in ("entity", "region")}
    for place, target, value in references(one, ""):
        if target in ("entity", "region") and place in theirs:
            pairs.put(_TARGETS[target][0], value, theirs[place])


def _matter(pairs: _Pairs, before: WorldSpec, after: WorldSpec) -> None:
    """Materials of bodies that are the same."""
    for new, old in pairs.names["entities"].items():
        one, other = before.entities.get(old), after.entities.get(new)
        if one is not None and other is not None:
            pairs.put("materials", one.material, other.material)
            for part in (p for p in one.parts if p in other.parts):
                mine, theirs = one.parts[part].material, other.parts[part].material
                if mine and theirs:
                    pairs.put("materials", mine, theirs)


def _held(pairs: _Pairs, group: str, before: WorldSpec, after: WorldSpec) -> None:
    """Members of a collection that name most of the same bodies."""
    entities = pairs.names["entities"]
    bodies = {n: set(_entities(item)) for n, item in _members(before, group).items()}
    for new, item in _members(after, group).items():
        mine = {entities[n] for n in _entities(item) if n in entities}
        free = [old for old in bodies if old not in pairs.names[group].values() and mine & bodies[old]]
        best = max(free, key=lambda old: (len(mine & bodies[old]), old == new), default=None)
        if best is not None:
            pairs.put(group, best, new)


def _members(spec: WorldSpec, group: str) -> dict[str, Any]:
    at: Any = spec
    for token in group.split("/"):
        at = getattr(at, token)
    return dict(at)


def _entities(item: Any) -> Iterator[str]:
    return (value for _, target, value in references(item, "") if target in ("entity", "node"))


# ---------------------------------------------------------------- other names


def renamed(spec: WorldSpec, names: Names, other: WorldSpec) -> dict[str, Any]:
    """A specification as JSON under other names, claims left out.

    Args:
        spec: of any version.
        names: new ids by old ones, by collection.
        other: whose ids mean something else unless `names` gives them: members that have one get another.
    """
    told = {group: dict(names.get(group, {})) for group in (*GROUPS, *HELD)}
    for group, known in told.items():
        used = {*_members(other, group), *known.values()}
        for name in _members(spec, group):
            if name not in known and name in used:
                known[name] = _free(name, {*used, *_members(spec, group)})
                used.add(known[name])
    document = spec.model_dump(mode="json")
    document.pop("claims", None)
    for pointer, target, value in references(spec, ""):
        new = next((told[g][value] for g in _TARGETS.get(target, ()) if value in told[g]), value)
        *path, last = pointer.split("/")[1:]
        at: Any = document
        for token in path:
            at = at[int(token)] if isinstance(at, list) else at.get(token, {})
        if isinstance(at, list):
            at[int(last)] = new
        elif last in at:
            at[last] = new
    for beat in document["story"]["beats"].values():
        beat["margins"] = _keys(beat.get("margins") or {}, told["story/beats"])
    for group, known in told.items():
        *path, last = group.split("/")
        at = document
        for token in path:
            at = at[token]
        at[last] = _keys(at[last], known)
    return document


def _keys(members: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    return {names.get(k, k): v for k, v in members.items()}


def _free(name: str, used: set[str]) -> str:
    """An id that is not used yet."""
    return next(n for k in range(2, len(used) + 3) if (n := f"{name[:55]}_{k}") not in used)

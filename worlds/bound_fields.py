"""Who speaks of what in a specification: fields that are bound, and bodies that nothing speaks of (R156, R157).

A beat, a requirement or a claim that names a body binds the quantities of nature on which its motion depends. Sizes, friction and
restitution are bound by claims of quantities and of properties other than material and colour that point at them alone: rows judge a body of another form as it is, and how it rubs and
bounces is what a repair changes.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

from .prompts.descriptions import WordKind, meanings
from .prompts.languages import language_of
from .prompts.units import units_of
from .references import references
from .vocabulary import SpecModel

if TYPE_CHECKING:
    from .spec import WorldSpec
    from .spec.claims import Claim

__all__ = ["Bound", "binders_of", "bound_fields", "dressing", "natures", "spoken_of"]

_SIZED = ("quantity", "property")
"""Types of claims that may be about the size of a body, or how it rubs."""
_MATTER: tuple[WordKind, ...] = ("material", "colour")
"""Kinds of words that say of what a thing is."""
_RUBS = ("friction", "rolling_friction", "restitution")
"""Fields that only such a claim binds."""
_PERMIT = "fastened"
"""Kind of relation that asks nothing: it allows an overlap."""


class Bound(NamedTuple):
    """Beats, requirements and claims that bind what stands at a JSON pointer and below it, by pointer."""

    all: Mapping[str, Mapping[str, None]]
    told: Mapping[str, Mapping[str, None]]
    """By claims of quantities and properties alone."""


def bound_fields(spec: WorldSpec) -> Bound:
    """Everybody that binds fields of a specification."""
    found: dict[str, dict[str, None]] = {}
    measured: dict[str, dict[str, None]] = {}
    nature, language = natures(spec), language_of(spec.prompt)

    def bind(places: Iterable[str], who: str, *, told: bool = False) -> None:
        for place in places:
            found.setdefault(place, {})[who] = None
            if told:
                measured.setdefault(place, {})[who] = None

    for holder, noun in ((spec.story.beats, "beat"), (spec.story.requirements, "requirement")):
        for key, item in holder.items():
            for name in _named(spec, [item.predicate]):
                bind(nature.get(name, ()), f"{noun} {key!r}")
    for key, claim in _claims(spec):
        for place in claim.by:
            name = _entity_at(place)
            told = claim.type in _SIZED and not (place == f"/entities/{name}" and _of_matter(claim, language))
            if place != f"/entities/{name}" or told:
                bind([place], f"claim {key!r}", told=told)
            if place == f"/entities/{name}":
                bind(nature.get(name, ()), f"claim {key!r}")
    return Bound(found, measured)


def _of_matter(claim: Claim, language: str | None) -> bool:
    """True if a claim says of what a thing is or which colour it has, and nothing else: it leaves its size alone."""
    words = [m.word for kind in _MATTER for m in meanings(claim.quote, language, kind)]
    return claim.type == "property" and sum(len(units_of(word)) for word in words) == len(units_of(claim.quote))


def binders_of(bound: Bound, pointer: str) -> tuple[str, ...]:
    """Who binds the field at a JSON pointer: whoever speaks of it, of what holds it, or of a part of it.

    Args:
        bound: of `bound_fields`.
        pointer: of a field.
    """
    tokens = pointer.split("/")
    binding = bound.told if tokens[-1] in _RUBS else bound.all
    above = [who for k in range(2, len(tokens) + 1) for who in binding.get("/".join(tokens[:k]), ())]
    below = [who for place, named in binding.items() if place.startswith(f"{pointer}/") for who in named]
    return tuple(dict.fromkeys((*above, *below)))


def dressing(spec: WorldSpec) -> list[str]:
    """Entities that no claim speaks of, nor any beat, requirement, relation or driver that a claim names.

    In worlds of version 1 every beat, requirement, driver, clause and relation that asks something speaks for itself. What joints or
    ropes tie to a body that something speaks of belongs to it.
    """
    spoken = spoken_of(spec)
    return [name for name in spec.entities if name not in spoken]


def spoken_of(spec: WorldSpec, *, types: Collection[str] | None = None) -> set[str]:
    """Entities that are no dressing.

    Args:
        spec: of any version.
        types: of claims that point at the bodies themselves; then beats and what else claims name speaks of none.
    """
    if types is not None:
        pointers = [p for _, claim in _claims(spec) if claim.type in types for p in claim.by]
        asking = []
    elif spec.spec_version == "2":
        pointers = [p for _, claim in _claims(spec) for p in claim.by]
        asking = list(_members(spec, pointers))
    else:
        story, graph = spec.story, spec.graph
        holders = (story.beats, story.requirements, story.robustness, graph.regions, spec.simulation.drivers)
        asking = [*(item for holder in holders for item in holder.values())]
        asking += [r for r in graph.relations.values() if r.kind != _PERMIT]
        pointers = [p for clause in spec.clauses.values() for p in clause.met_by]
    spoken = {*_named(spec, asking), *(_entity_at(p) for p in pointers)}
    tied: dict[str, set[str]] = {}
    for joint in spec.simulation.joints.values():
        _tie(tied, _named(spec, [joint]))
    for name, entity in spec.entities.items():
        if entity.generator is not None:
            _tie(tied, (name, *_named(spec, [entity.generator])))
    todo = list(spoken)
    while todo:
        more = tied.get(todo.pop(), set()) - spoken
        spoken |= more
        todo += more
    return spoken


def _members(spec: WorldSpec, pointers: Iterable[str]) -> Iterator[SpecModel]:
    """Members of the collections of a specification that pointers lead to or into, and that name bodies."""
    plan = spec.simulation
    holders: Mapping[str, Mapping[str, SpecModel]] = {
        "story/beats": spec.story.beats, "story/requirements": spec.story.requirements, "graph/relations": spec.graph.relations,
        "graph/regions": spec.graph.regions, "simulation/drivers": plan.drivers, "simulation/joints": plan.joints,
    }  # fmt: skip
    for pointer in pointers:
        group, name = "/".join(pointer.split("/")[1:3]), "".join(pointer.split("/")[3:4])
        if name in holders.get(group, ()):
            yield holders[group][name]


def natures(spec: WorldSpec) -> dict[str, list[str]]:
    """Places of the quantities of nature of every entity: its own, those of its materials, pairs and joints, and of its solver's walls."""
    found: dict[str, list[str]] = {}
    for name, entity in spec.entities.items():
        materials = dict.fromkeys((entity.material, *(p.material for p in entity.parts.values() if p.material)))
        own = (f"/entities/{name}/{field}" for field in ("physics", "breakable", "material", "parts"))
        found[name] = [*own, *(f"/materials/{m}" for m in materials)]
    plan = spec.simulation
    for holder, items in (("contacts", plan.contacts), ("joints", plan.joints), ("solvers", plan.solvers)):
        for key, item in items.items():
            for name in _named(spec, [item]):
                if name in found:
                    found[name].append(f"/simulation/{holder}/{key}")
    return found


def _claims(spec: WorldSpec) -> Iterator[tuple[str, Claim]]:
    """Claims that are not waived; a specification of version 1 has none."""
    return ((key, claim) for key, claim in spec.claims.items() if claim.waived is None)


def _named(spec: WorldSpec, models: Iterable[SpecModel]) -> Iterator[str]:
    """Entities that models name, those of joints too."""
    for model in models:
        for _, target, name in references(model, ""):
            if target in ("entity", "node"):
                yield name
            elif target == "joint" and name in spec.simulation.joints:
                yield from _named(spec, [spec.simulation.joints[name]])


def _entity_at(pointer: str) -> str:
    """Entity that a JSON pointer leads to or into; empty where it leads elsewhere."""
    tokens = pointer.split("/")
    return tokens[2] if tokens[1] == "entities" else ""


def _tie(tied: dict[str, set[str]], names: Iterable[str]) -> None:
    ends = set(names)
    for name in ends:
        tied.setdefault(name, set()).update(ends)

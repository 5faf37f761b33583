"""Claims of a negation against what they name: a requirement that the server negates, of something that could happen (R131, R154, R155).

What cannot move does not fall, and what has no bonds does not break: to deny that says nothing of the motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..claims import named_in
from ..predicates import Count, atoms_of
from ..predicates.registry import is_invariant
from ..problems import Problem, removed, replaced
from ..spec import Claim, SpecModel, WorldSpec

__all__ = ["negation_problems"]

_MOVES: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("crosses", "reaches", "tilts", "topples", "speed", "displacement"), ("entity",)),
    **dict.fromkeys(("falls", "rises", "spins", "stops", "slows", "swings", "jumps", "drifts"), ("entity",)),
    **dict.fromkeys(
        ("rolls", "slides", "tips", "lands", "bounces", "goes_uphill", "comes_loose", "opens", "closes"), ("entity",)
    ),
    **dict.fromkeys(("hits", "rests_against", "jams", "floats", "bobs", "sinks", "splashes"), ("entity",)),
    **dict.fromkeys(("pushes", "pulls", "lifts", "lowers", "throws"), ("entity", "other")),
}
"""By kind, fields that name whoever has to move for it."""
_EITHER = ("contact", "separation")
"""Kinds for which one of the two has to move."""
_JOINTS: Mapping[str, tuple[str, ...]] = {
    "opens": ("hinge", "slide"),
    "closes": ("hinge", "slide"),
    "swings": ("hinge", "ball", "spring"),
    "comes_loose": ("hinge", "slide", "ball", "weld", "spring"),
}
"""By kind, joints one of which has to hold the entity."""
_ROPED = ("swings", "comes_loose")
"""Kinds that a rope that is tied to the entity will do for."""


def negation_problems(spec: WorldSpec, name: str, claim: Claim) -> Iterator[Problem]:
    """Problems of one claim of a negation."""
    named = {n: spec.story.requirements[n] for n in named_in(spec, name, "story/requirements") if n in spec.story.requirements}
    for key, requirement in named.items():
        place = f"/story/requirements/{key}"
        if not requirement.never:
            text = f"{claim.quote!r} is a negation: give {key!r} the predicate of what must not happen and never: true, the server negates it"
            yield Problem(f"{place}/never", text, {"op": "add", "path": f"{place}/never", "value": True})
        elif not requirement.mandatory:
            text = f"{key!r} is optional; a negation of the prompt is mandatory"
            yield Problem(f"{place}/mandatory", text, replaced(f"{place}/mandatory", True))
        elif requirement.frames is not None and requirement.frames != (0, spec.simulation.frames - 1):
            text = f"{key!r} looks at frames {list(requirement.frames)} alone; a negation holds over all frames, leave frames out"
            yield Problem(f"{place}/frames", text, removed(f"{place}/frames"))
        elif is_invariant(requirement.predicate):
            text = f"{key!r} negates {requirement.predicate.kind}, which tells of a state; give the event that must not happen"
            yield Problem(f"{place}/predicate", text)
        else:
            why = never_could(spec, requirement.predicate)
            if why is not None:
                text = f"{claim.quote!r} denies what cannot happen: {why}"
                yield Problem(f"{place}/predicate", text)


def never_could(spec: WorldSpec, predicate: SpecModel) -> str | None:
    """Why nothing that a predicate asks for could happen in a world, whatever moves how; None where something could."""
    if isinstance(predicate, Count):
        if (predicate.min or 0) > len(predicate.entities):
            return f"{predicate.min:g} of {len(predicate.entities)} entities cannot do it"
        reasons = [_lacks(spec, a, n) for n in predicate.entities for a in atoms_of(predicate.predicate)]
        return reasons[0] if reasons and all(reasons) else None
    reasons = [_lacks(spec, a, None) for a in atoms_of(predicate)]
    every = getattr(predicate, "kind", "") == "or"
    found = [r for r in reasons if r]
    return found[0] if found and (not every or len(found) == len(reasons)) else None


def _lacks(spec: WorldSpec, atom: SpecModel, each: str | None) -> str | None:
    """Words on something that an atom needs and a world lacks: somebody who moves, bonds, a joint; None where nothing does."""
    kind = str(getattr(atom, "kind", ""))

    def named(field: str) -> str | None:
        value = getattr(atom, field, None)
        return each if value == "each" else value

    for field in _MOVES.get(kind, ()):
        entity = spec.entities.get(named(field) or "")
        if entity is not None and entity.motion == "static":
            return f"{named(field)!r} is static and {kind} asks that it moves; let it be dynamic"
    if kind in _EITHER:
        pair = [spec.entities.get(named(f) or "") for f in ("a", "b")]
        if all(e is not None and e.motion == "static" for e in pair):
            return f"{named('a')!r} and {named('b')!r} are both static; let one of them move"
    name = named("entity")
    owner = spec.entities.get(name or "")
    if kind in ("cracks", "breaks") and owner is not None and owner.physics.shape == "solid" and owner.breakable is None:
        return f"{name!r} has no pieces into which it could break; give it `breakable`"
    if kind in _JOINTS and owner is not None and not _held(spec, str(name), kind):
        return f"no joint holds {name!r}, which {kind} asks for ({', '.join(_JOINTS[kind])})"
    return None


def _held(spec: WorldSpec, entity: str, kind: str) -> bool:
    joints = spec.simulation.joints.values()
    if any(j.kind in _JOINTS[kind] and entity in (j.child, j.parent) for j in joints):
        return True
    ropes = (e.generator for e in spec.entities.values() if e.generator is not None)
    return kind in _ROPED and any(entity in (r.attach_start, r.attach_end) for r in ropes)

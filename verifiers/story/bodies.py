"""Bodies of a predicate: whom a beat speaks of, and who does what in a compound one.

An `and` of two falls is a promise about two bodies: each is asked whether a cause brought it about. Of an `or` one branch that came true is
enough, of a `count` as many of its entities as it asks for. What rests, stays or does no more than so much needs no cause.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...worlds.errors import EvidenceError
from ...worlds.predicates import And, Count, Not, Or, atoms_of, entities_of
from ...worlds.predicates.registry import PREDICATES, is_invariant
from ..predicates.combine import substitute
from ..predicates.evaluators import evaluate
from ..support.moved import MOVED_BY, MOVING_KINDS

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Beat, SpecModel, WorldSpec

__all__ = [
    "Deeds",
    "acting_atoms",
    "deeds_of",
    "involved",
    "moved_bodies",
    "moves_by_declaration",
    "spoken_bodies",
    "standing_atoms",
]


def involved(spec: WorldSpec, beat: Beat) -> list[str]:
    """Entities that the beat speaks of, with those that carry its regions and joints."""
    names = [beat.subject, *entities_of(beat.predicate)]
    for atom in atoms_of(beat.predicate):
        region = spec.graph.regions.get(getattr(atom, "region", None) or "")
        joint = spec.simulation.joints.get(getattr(atom, "joint", None) or "")
        names += [
            n for n in (getattr(region, "relative_to", None), getattr(joint, "child", None), getattr(joint, "parent", None)) if n
        ]
    return [n for n in dict.fromkeys(names) if n in spec.entities]


def spoken_bodies(spec: WorldSpec, beat: Beat) -> tuple[str, ...]:
    """Those of them that solvers move, liquids and grains among them."""
    return tuple(n for n in involved(spec, beat) if spec.entities[n].motion == "dynamic")


@dataclass(frozen=True)
class Deeds:
    """Part of a compound predicate that came true: bodies, the atoms that tell of each, and how many of them it needs."""

    least: int
    """Number of the bodies that have to do it."""
    atoms: dict[str, tuple[SpecModel, ...]]
    """Atoms that tell of each body."""

    def lacking(self, brought: Callable[[str, SpecModel], bool]) -> tuple[str, ...]:
        """Bodies of which nothing was brought about, where those of which something was are too few.

        Args:
            brought: takes a body and an atom that tells of it.
        """
        idle = tuple(body for body, atoms in self.atoms.items() if not any(brought(body, atom) for atom in atoms))
        return idle if len(self.atoms) - len(idle) < self.least else ()


def deeds_of(candidate: Candidate, beat: Beat) -> list[Deeds]:
    """Deeds that a compound predicate tells of and that came true over the beat's frames; none for a predicate about one body.

    Raises:
        EvidenceError: a branch of an `or`, or an entity of a `count`, cannot be judged.
    """
    if len(atoms_of(beat.predicate)) == 1 and not any(isinstance(p, Count) for p in _nested(beat.predicate)):
        return []
    own: dict[str, tuple[SpecModel, ...]] = {}
    choices = []
    for deeds in _within(candidate, beat.predicate, beat.frames):
        if deeds.least == len(deeds.atoms):
            for body, atoms in deeds.atoms.items():
                own[body] = (*own.get(body, ()), *atoms)
        else:
            choices.append(deeds)
    return [*(Deeds(1, {body: atoms}) for body, atoms in own.items()), *choices]


def standing_atoms(predicate: SpecModel, body: str) -> Iterator[SpecModel]:
    """Atoms that an `and` joins and that tell of a body where or how it is, and not that something happens to it: `rests_on` beside `stops`."""
    if isinstance(predicate, And):
        for member in predicate.of:
            yield from standing_atoms(member, body)
    elif getattr(predicate, "entity", None) == body and not _happens(predicate, str(getattr(predicate, "kind", ""))):
        yield predicate


def acting_atoms(predicate: SpecModel) -> Iterator[SpecModel]:
    """Atoms that say that something happens, `each` of a count replaced by every one of its entities; none below a `not` or a lasting state."""
    kind = str(getattr(predicate, "kind", ""))
    if isinstance(predicate, Not) or is_invariant(predicate):
        return
    if isinstance(predicate, Count):
        if predicate.min is not None:
            for name in predicate.entities:
                yield from acting_atoms(substitute(predicate.predicate, name))
        return
    inner = [*getattr(predicate, "of", ()), *(p for n in ("predicate", "goal") if (p := getattr(predicate, n, None)) is not None)]
    for member in inner:
        yield from acting_atoms(member)
    if not inner and _happens(predicate, kind):
        yield predicate


def moved_bodies(spec: WorldSpec, beat: Beat) -> tuple[str, ...]:
    """The subject of a beat and every other body of its predicate that does something, or to which something is done, that solvers move."""
    names = [beat.subject]
    for atom in acting_atoms(beat.predicate):
        kind = str(getattr(atom, "kind", ""))
        names += [getattr(atom, "entity", ""), getattr(atom, "other", "") if kind in MOVED_BY else ""]
    return tuple(n for n in dict.fromkeys(names) if n == beat.subject or _free(spec, n))


def _nested(predicate: SpecModel) -> Iterator[SpecModel]:
    """The predicate and, where it holds one other, that and so on."""
    yield predicate
    if (inner := getattr(predicate, "predicate", None)) is not None:
        yield from _nested(inner)


def _within(candidate: Candidate, predicate: SpecModel, frames: tuple[int, int]) -> Iterator[Deeds]:
    if isinstance(predicate, And):
        for member in predicate.of:
            yield from _within(candidate, member, frames)
    elif isinstance(predicate, Or):
        came = [p for p in predicate.of if _true(candidate, p, frames)]
        yield from _one_of([list(_within(candidate, p, frames)) for p in came])
    elif isinstance(predicate, Count):
        if predicate.min is not None and not is_invariant(predicate.predicate):
            each = {name: substitute(predicate.predicate, name) for name in predicate.entities}
            true = {name: p for name, p in each.items() if _true(candidate, p, frames)}
            atoms = {name: tuple(_deeds(candidate, p, name)) for name, p in true.items()}
            told = {name: a for name, a in atoms.items() if a}
            if told:
                yield Deeds(min(len(told), max(1, round(predicate.min))), told)
    elif isinstance(predicate, Not) or is_invariant(predicate):
        return
    else:
        inner = [p for name in ("predicate", "goal") if (p := getattr(predicate, name, None)) is not None]
        for member in inner:
            yield from _within(candidate, member, getattr(predicate, "frames", None) or frames)
        if not inner:
            yield from _of_atom(candidate, predicate)


def _true(candidate: Candidate, predicate: SpecModel, frames: tuple[int, int]) -> bool:
    outcome = evaluate(candidate, predicate, frames)
    if outcome.status == "unverified":
        raise EvidenceError(outcome.explanation)
    return outcome.status == "pass"


def _one_of(branches: list[list[Deeds]]) -> Iterator[Deeds]:
    """Deeds of branches of which any is enough; none where a branch that came true tells of no deed."""
    if len(branches) == 1:
        yield from branches[0]
    elif all(branches):
        merged: dict[str, tuple[SpecModel, ...]] = {}
        for deeds in (d for branch in branches for d in branch):
            for body, atoms in deeds.atoms.items():
                merged[body] = (*merged.get(body, ()), *atoms)
        if merged:
            yield Deeds(1, merged)


def _of_atom(candidate: Candidate, atom: SpecModel) -> Iterator[Deeds]:
    """Bodies that an atom says to do something; a contact happens to two, and it is enough that one of them is moved."""
    spec, kind = candidate.spec, str(getattr(atom, "kind", ""))
    if kind == "contact":
        pair = [n for n in (getattr(atom, "a", ""), getattr(atom, "b", "")) if _free(spec, n)]
        if pair:
            yield Deeds(1, dict.fromkeys(pair, (atom,)))
        return
    for name in (getattr(atom, "entity", ""), getattr(atom, "other", "") if kind in MOVED_BY else ""):
        if name and _free(spec, name) and _happens(atom, kind):
            yield Deeds(1, {name: (atom,)})


def _deeds(candidate: Candidate, predicate: SpecModel, name: str) -> Iterator[SpecModel]:
    """Atoms below a predicate that tell of a deed of a body."""
    for atom in atoms_of(predicate):
        if any(name in deeds.atoms for deeds in _of_atom(candidate, atom)):
            yield atom


def _free(spec: WorldSpec, name: str) -> bool:
    return name in spec.entities and spec.entities[name].motion == "dynamic"


def _happens(atom: SpecModel, kind: str) -> bool:
    """True where an atom says that something happens to its body, and not only that it does no more than so much."""
    info = PREDICATES.get(kind)
    if is_invariant(atom) or info is None or not (info.event or kind == "speed" or kind in MOVING_KINDS):
        return False
    return not {"min", "max"} <= set(type(atom).model_fields) or (getattr(atom, "min", None) or 0.0) > 0.0


def moves_by_declaration(spec: WorldSpec, name: str) -> bool:
    """True if the specification gives the entity a velocity at frame 0."""
    physics = spec.entities[name].physics
    speeds = [getattr(physics, n, ()) for n in ("linear_velocity", "angular_velocity")]
    return any(any(v) for v in speeds) or bool(getattr(physics, "currents", None))

"""Unusual things of a candidate that its verdict prints beside the result: nothing forbids them, and a viewer would not expect them (R68, R123)."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import combinations
from typing import TYPE_CHECKING

from ...worlds.materials import material_table
from ...worlds.predicates import Contact, atoms_of
from .frictions import friction_lines
from .scene import gravity_lines, pusher_lines

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Material, WorldSpec

__all__ = ["LIVELY", "unusual"]

LIVELY = 0.95
"""[1] Own choice: from this restitution on two bodies keep nine tenths of its energy in a bounce; the best rubber balls are below."""


def unusual(candidate: Candidate) -> list[str]:
    """Sentences about gravity, restitution, friction, contacts of any strength and bodies on paths that push others."""
    spec = candidate.spec
    found = [f"{what}: {effect}" for what, effect in gravity_lines(spec)]
    lively = _lively_materials(candidate)
    found += [*_lively(spec, lively), *friction_lines(spec, bouncing={n for pair in lively for n in pair}), *_faint(spec)]
    return [*found, *(f"{what}: {effect}" for what, effect in pusher_lines(candidate))]


def _lively(spec: WorldSpec, materials: Collection[tuple[str, str]]) -> Iterator[str]:
    """Sentences about pairs of materials, and of bodies, that lose next to nothing when they bounce off each other."""
    for one, other in sorted(materials):
        value = min(spec.materials[n].restitution for n in (one, other))
        whose = f"material {one!r} has" if one == other else f"materials {one!r} and {other!r} have together"
        yield f"{whose} a restitution of {value:g}: two bodies of {'it' if one == other else 'them'} bounce off each other almost for ever"
    for pair in spec.simulation.contacts.values():
        if pair.restitution is not None and pair.restitution >= LIVELY:
            yield f"{pair.a!r} and {pair.b!r} meet with a restitution of {pair.restitution:g}: they bounce off each other almost for ever"


def _lively_materials(candidate: Candidate) -> set[tuple[str, str]]:
    """Materials of which two bodies can meet, whose restitution together, the smaller one, is lively and not the table's for both."""
    spec = candidate.spec
    own = {frozenset((p.a, p.b)) for p in spec.simulation.contacts.values() if p.restitution is not None}
    lively = {n for n, m in spec.materials.items() if m.restitution >= LIVELY}
    made = {n: {p.material or e.material for p in e.parts.values() if p.collides} & lively for n, e in spec.entities.items()}
    made = {n: materials for n, materials in made.items() if materials}
    still = {n for n in made if spec.entities[n].motion == "static"}
    several = {n for n in made if n not in still and _is_several(candidate, n)}
    pairs = [(a, b) for a, b in combinations(sorted(made), 2) if not {a, b} <= still and frozenset((a, b)) not in own]
    pairs += [(n, n) for n in sorted(several)]
    met = {(min(m, k), max(m, k)) for a, b in pairs for m in made[a] for k in made[b]}
    return {(m, k) for m, k in met if not (_of_table(spec.materials[m]) and _of_table(spec.materials[k]))}


def _is_several(candidate: Candidate, entity: str) -> bool:
    """True if bodies of one entity can meet each other: grains, pieces, or what a generator made of several."""
    known = candidate.spec.entities[entity]
    loose = known.physics.shape == "loose" or known.breakable is not None
    return loose or (entity in candidate.solids and len(candidate.entity(entity).bodies) > 1)


def _of_table(material: Material) -> bool:
    """True if a material's restitution is that of its row of the table of materials."""
    row = None if material.of is None else material_table().materials.get(material.of)
    figure = None if row is None else row.figures.get("restitution")
    return figure is not None and figure.holds(material.restitution)


def _faint(spec: WorldSpec) -> Iterator[str]:
    """Beats and requirements that a touch of any strength meets."""
    for noun, group in (("beat", spec.story.beats), ("requirement", spec.story.requirements)):
        for name, told in group.items():
            if getattr(told, "never", False):
                continue
            for atom in atoms_of(told.predicate):
                if isinstance(atom, Contact) and atom.min_impulse == 0.0:
                    yield f"{noun} {name!r} is met by any touch of {atom.a!r} and {atom.b!r}, however faint: its min_impulse is 0"

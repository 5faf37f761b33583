"""Unusual things of a candidate that its verdict prints beside the result: nothing forbids them, and a viewer would not expect them (R68, R123)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...worlds.predicates import Contact, atoms_of
from .scene import gravity_lines, pusher_lines

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec

__all__ = ["LIVELY", "unusual"]

LIVELY = 0.95
"""[1] Own choice: from this restitution on a body keeps nine tenths of its energy in a bounce; the best rubber balls are below."""


def unusual(candidate: Candidate) -> list[str]:
    """Sentences about gravity, restitution, contacts of any strength and bodies on paths that push others."""
    spec = candidate.spec
    found = [f"{what}: {effect}" for what, effect in gravity_lines(spec)]
    found += [*_lively(spec), *_faint(spec)]
    return [*found, *(f"{what}: {effect}" for what, effect in pusher_lines(candidate))]


def _lively(spec: WorldSpec) -> Iterator[str]:
    """Materials of bodies, and pairs, that lose next to nothing when they bounce."""
    used = {p.material or e.material for e in spec.entities.values() for p in e.parts.values() if p.collides}
    for name in sorted(used & spec.materials.keys()):
        if spec.materials[name].restitution >= LIVELY:
            yield f"material {name!r} has a restitution of {spec.materials[name].restitution:g}: what is made of it bounces almost for ever"
    for pair in spec.simulation.contacts.values():
        if pair.restitution is not None and pair.restitution >= LIVELY:
            yield f"{pair.a!r} and {pair.b!r} meet with a restitution of {pair.restitution:g}: they bounce off each other almost for ever"


def _faint(spec: WorldSpec) -> Iterator[str]:
    """Beats and requirements that a touch of any strength meets."""
    for noun, group in (("beat", spec.story.beats), ("requirement", spec.story.requirements)):
        for name, told in group.items():
            if getattr(told, "never", False):
                continue
            for atom in atoms_of(told.predicate):
                if isinstance(atom, Contact) and atom.min_impulse == 0.0:
                    yield f"{noun} {name!r} is met by any touch of {atom.a!r} and {atom.b!r}, however faint: its min_impulse is 0"

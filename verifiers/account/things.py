"""The things of a candidate by form, size, colour and letter, most important first; alike ones are told together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.errors import EvidenceError
from ..categories.registry import judged
from .colours import colour_word
from .courses import Course, course_of
from .forms import Form, form_of, joined_form
from .wording import letters, number, place, sizes

if TYPE_CHECKING:
    from ...worlds.arrays import F64
    from ...worlds.built import BuiltEntity, BuiltPart
    from ...worlds.candidate import Candidate

__all__ = ["Group", "things_of"]

SECOND_COLOUR = 0.2
"""Own choice: share of the surface from which on a second colour is named."""
KEPT_BY = {"static": "fixed", "kinematic": "moved by a driver", "dynamic": ""}


@dataclass(frozen=True)
class Group:
    """Things that are alike in form, size, colour and in what holds them; one thing most often."""

    members: tuple[str, ...]
    """Entities, in the order in which they move first, then by place."""
    form: Form
    colour: str
    held: str
    about: str
    """Amount and mass of each."""
    courses: dict[str, Course]
    letter: str = ""

    def label(self, entity: str) -> str:
        """Word, letter and, among several, number: `box A`, `ball B3`."""
        return f"{self.form.word} {self.letter}{self.members.index(entity) + 1 if len(self.members) > 1 else ''}"

    @property
    def title(self) -> str:
        """Label of all: `box A`, `ball B1 to B3`."""
        count = len(self.members)
        return f"{self.form.word} {self.letter}" + (f"1 to {self.letter}{count}" if count > 1 else "")

    @property
    def energy(self) -> float:
        """Greatest kinetic energies of the members together [J]."""
        return sum(c.energy for c in self.courses.values())

    @property
    def moves(self) -> bool:
        """True if a member leaves its place."""
        return any(c.first is not None for c in self.courses.values())

    def line(self) -> str:
        """Form, sizes, colour, and place at the first frame."""
        several = len(self.members) > 1
        told = [sizes(self.form.sizes), self.colour, self.about, self.held]
        where = [place(self.courses[m].start) for m in (self.members[0], self.members[-1])]
        at = f"at {where[0]}" if not several else f"from {where[0]} to {where[1]}"
        return f"{self.title}: {'each ' if several else ''}{', '.join(t for t in (*told, at) if t)}"


def things_of(candidate: Candidate) -> list[Group]:
    """All things, those that move most first, then the largest; letters in this order.

    Raises:
        EvidenceError: something is not built, or what is recorded is damaged.
    """
    kinds: dict[tuple[str, ...], list[tuple[str, Form, Course]]] = {}
    for entity in judged(candidate.spec):
        form = _form(candidate, entity)
        course = course_of(candidate, entity, max(form.sizes, default=0.0))
        held = KEPT_BY[candidate.spec.entities[entity].motion]
        key = (form.word, sizes(form.sizes), _colour(candidate, entity), held, _about(candidate, entity))
        kinds.setdefault(key, []).append((entity, form, course))
    groups = []
    for (_, _, colour, held, about), found in kinds.items():
        found.sort(key=lambda f: _order(f[2]))
        groups.append(Group(tuple(e for e, _, _ in found), found[0][1], colour, held, about, {e: c for e, _, c in found}))
    groups.sort(
        key=lambda g: (
            not g.moves,
            g.held == KEPT_BY["static"],
            -float(f"{g.energy:.2e}"),
            tuple(-s for s in g.form.sizes),
            g.line(),
        )
    )
    return [Group(**{**vars(g), "letter": letters(k)}) for k, g in enumerate(groups)]


def _order(course: Course) -> tuple[float, ...]:
    first = np.inf if course.first is None else course.first
    return (first, *(round(float(v), 3) for v in course.start), *(round(float(v), 3) for v in course.end))


def _form(candidate: Candidate, entity: str) -> Form:
    """Form of an entity as it is built."""
    built, own = candidate.entity(entity), candidate.spec.entities[entity]
    noun = judged(candidate.spec)[entity].noun
    if own.physics.shape == "loose":
        return Form(noun, ())
    if built.bonds is not None:
        return joined_form(_points(built))
    if own.generator is not None:
        return _chain(built)
    if any(piece.kind == "heightfield" for part in built.parts for piece in part.collision):
        return Form("ground", _extents(built))
    if len(built.parts) == 1:
        found = form_of(built.parts[0].render)
        return Form(noun, found.sizes) if noun else found
    return Form(noun or "object", _extents(built))


def _parts(built: BuiltEntity) -> str:
    """Forms of the parts of an object of several, counted."""
    if len(built.parts) == 1 or len(built.bodies) > 1:
        return ""
    forms = [form_of(p.render).word for p in built.parts]
    counts = [f"{forms.count(w)} x {w}" for w in sorted(set(forms), key=lambda w: (-forms.count(w), w))]
    return f"of {' and '.join(counts)}"


def _points(built: BuiltEntity) -> F64:
    """Visible vertices in the entity's frame, shape (n, 3)."""
    frames = {b.name: b.pose for b in built.bodies}
    found: F64 = np.concatenate([frames[p.body].apply(p.render.vertices) for p in built.parts])
    return found


def _extents(built: BuiltEntity) -> tuple[float, ...]:
    return tuple(sorted((float(v) for v in np.ptp(_points(built), axis=0)), reverse=True))


def _chain(built: BuiltEntity) -> Form:
    """A rope: thickness and length along its bodies."""
    links = [sorted(np.ptp(p.render.vertices, axis=0)) for p in built.parts]
    thick = float(max(link[0] for link in links))
    return Form("rope", (thick, float(sum(link[2] - thick for link in links)) + thick))


def _colour(candidate: Candidate, entity: str) -> str:
    """Words for the one or two colours that cover most of it."""
    materials = candidate.spec.materials
    covered: dict[str, float] = {}
    for part in candidate.entity(entity).parts:
        word = colour_word(materials[part.material].appearance)
        covered[word] = covered.get(word, 0.0) + _area(part)
    ranked = sorted(covered, key=lambda w: (-round(covered[w], 9), w))[:2]
    total = sum(covered.values())
    return " and ".join(w for k, w in enumerate(ranked) if k == 0 or covered[w] > SECOND_COLOUR * total)


def _area(part: BuiltPart) -> float:
    corners = part.render.vertices[part.render.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * float(np.linalg.norm(cross, axis=1).sum())


def _about(candidate: Candidate, entity: str) -> str:
    """Parts; height as it stands at the first frame; amount of matter, or mass of what may move; whether it is breakable."""
    judge, built = judged(candidate.spec)[entity], candidate.entity(entity)
    told = []
    if candidate.spec.entities[entity].physics.shape != "loose":
        told += [w for w in (_parts(built), f"{number(float(np.ptp(candidate.vertices(entity, 0)[:, 2])))} m high") if w]
    try:
        amount = judge.amount(candidate, entity)
        if amount:
            told.append(amount)
        elif candidate.spec.entities[entity].motion == "dynamic":
            told.append(f"{number(float(judge.mass(candidate, entity)[0]))} kg")
    except EvidenceError:
        pass
    if built.bonds is not None:
        told.append(f"breakable into {len(built.bodies)} pieces")
    return ", ".join(told)

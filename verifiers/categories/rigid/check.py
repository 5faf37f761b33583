"""Rigid bodies (R103, R104). The paper names records for them but no check (S11); ours are the questions of `questions.py`, per instance.

Laws of motion on the instance's ledgers (`ledgers/balance.py`) are in `laws.py`, of contact in `contacts.py`, `bounces.py`, `rebounds.py` and `impacts.py`;
`books.py` holds the records against the ledgers. Friction and restitution are judged where frames decide them: a body that slides straight
for a whole frame, a ball that hits once in one. Elsewhere impulses bound them, and what returns more than it got shows in the energy.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.predicates import Crosses, Displacement, Reaches, StaysIn, entities_of
from ....worlds.spec import BoxRegion, CylinderRegion, SphereRegion
from ...ledgers import motion
from ...ledgers.balance import books_of
from ...rows.corrections import bake_again, correction, halve_step, separate
from ...rows.findings import Finding
from ..container import answers
from . import books, laws
from .bounces import restitution
from .bounds import ESCAPE, MASS_NOISE
from .contacts import contacts, friction
from .energy import energy
from .fields import fields
from .impacts import impact_energy
from .joints import joints
from .links import owners
from .questions import CATEGORY
from .rebounds import rebounds

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ....worlds.arrays import F64
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ...ledgers.balance import Books
    from ..container import Function

__all__ = ["category_rows", "of_movers"]


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """The rows of one instance; `unverified` where a record is missing."""
    return answers(candidate, solver, {question: of_movers(FUNCTIONS[question.id]) for question in CATEGORY})


def of_movers(function: Function) -> Function:
    """The function, `not_applicable` where the instance holds no rigid body but ground: by the plan, and by the index of its cache."""

    def ask(candidate: Candidate, solver: str, cache: Cache) -> Finding:
        members = [candidate.spec.entities[m] for m in candidate.spec.simulation.solvers[solver].members]
        if not cache.index.bodies and all(e.motion == "static" or e.physics.category == "elastic" for e in members):
            return Finding("not_applicable", f"no rigid member of {solver!r} moves")
        return function(candidate, solver, cache)

    return ask


def by_books(law: Callable[[Books], Finding]) -> Function:
    """A law of the instance's ledgers as a function of its cache; to halve the step may mend what fails."""

    def ask(candidate: Candidate, solver: str, cache: Cache) -> Finding:
        found = law(books_of(candidate, cache))
        if found.status != "fail":
            return found
        return replace(found, hints=(*found.hints, halve_step(candidate, solver, "the step is too long for what happens")))

    return ask


def _bodies(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    entities = candidate.spec.entities
    still = [n for n in owners(cache) if n not in entities or entities[n].motion == "static"]
    if still:
        text = f"the cache moves {still[0]}, which is declared static or not at all"
        again = bake_again("the cache is of another specification")
        return Finding("fail", text, entities=(still[0],), entity=still[0], frame=0, hints=(again,))
    return _constant(solver, cache, "body_count", float(len(cache.index.bodies)), 0.0, "1")


def _mass(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    entities = candidate.spec.entities
    # Of bodies on authored paths only mass and energy are in the records.
    free = [b for b in cache.index.bodies if (e := entities.get(b.split("/", 1)[0])) is None or e.motion != "kinematic"]
    built = sum(candidate.body(*b.split("/", 1)).mass for b in free)
    return _constant(solver, cache, "mass", built, MASS_NOISE * max(built, 1e-12), "kg")


def _constant(solver: str, cache: Cache, record: str, expected: float, noise: float, unit: str) -> Finding:
    """A record against what was built, at every frame."""
    series: F64 = cache.series(f"record/{record}")
    off, names = np.abs(series - expected), owners(cache)
    wrong, finite = ~(off <= noise), bool(np.isfinite(series).all())
    frame = int(np.argmax(wrong)) if wrong.any() else None
    named = "" if unit == "1" else f" {unit}"
    text = f"{record} is {expected:.9g}{named} at all {len(series)} frames"
    if frame is not None:
        text = f"{record} is {series[frame]:.9g}{named} at frame {frame}, built were {expected:.9g}{named}"
    hints = (
        correction(
            "the engine lost or added a body",
            "step",
            "look at the engine's warnings before that frame; halve the step",
            pointers=(f"/simulation/solvers/{solver}/settings/step",),
        ),
    )
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=0.0 if frame is None else float(off.max()) if finite else None,
        bound=noise,
        unit=unit,
        entities=tuple(dict.fromkeys(names)),
        frame=frame,
        entity=names[0] if frame is not None and names else None,
        hints=hints,
        evidence={"expected": expected, "record": f"record/{record}"},
    )


def _escape(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Distance of every body from the middle of the scene, along each axis."""
    low, high = motion.scene_box(candidate)
    middle, extent = (low + high) / 2, float((high - low).max())
    bound = ESCAPE * extent / 2
    sent = _sent_away(candidate, middle, bound)
    worst, culprit, at, checked = 0.0, None, None, []
    for name in dict.fromkeys(owners(cache)):
        if name in sent:
            continue
        checked.append(name)
        away = np.abs(motion.centers(candidate, name) - middle).max(axis=1)
        outside = ~(away <= bound)
        if outside.any() and (at is None or int(np.argmax(outside)) < at):
            culprit, at = name, int(np.argmax(outside))
        worst = max(worst, float(np.nanmax(away, initial=0.0)))
    text = f"bodies stay within {worst:.3g} m of the middle of the scene ({extent:.3g} m large)"
    if culprit is not None:
        text = f"{culprit} is more than {bound:.3g} m from the middle of the scene from frame {at} on (at most {worst:.3g} m)"
    evidence = {"middle": middle, "extent": extent, "sent_away": sorted(sent)}
    found = Finding("pass", text, worst, bound, "m", entities=tuple(checked), evidence=evidence)
    if culprit is None:
        return found
    hints = (
        separate(culprit),
        halve_step(candidate, solver, "contacts are resolved too late"),
        correction("nothing holds it", "placement", f"put a support under {culprit}", pointers=(f"/entities/{culprit}/pose",)),
    )
    return replace(found, status="fail", entity=culprit, frame=at, hints=hints)


def _sent_away(candidate: Candidate, middle: F64, bound: float) -> set[str]:
    """Entities that a predicate of the story sends beyond the box: a far region or plane, a large displacement."""
    story, regions = candidate.spec.story, candidate.spec.graph.regions
    predicates = [b.predicate for b in story.beats.values()] + [r.predicate for r in story.requirements.values()]
    found: set[str] = set()
    for predicate in predicates:
        goal: F64 | None = None
        if isinstance(predicate, Reaches | StaysIn):
            region = regions.get(predicate.region)
            if isinstance(region, BoxRegion) and region.relative_to is None:
                goal = (np.array(region.min) + np.array(region.max)) / 2
            elif isinstance(region, CylinderRegion | SphereRegion) and region.relative_to is None:
                goal = np.array(region.center)
        elif isinstance(predicate, Crosses):
            goal = np.array(predicate.point)
        far = goal is not None and bool((np.abs(goal - middle) > bound).any())
        if isinstance(predicate, Displacement):
            far = predicate.min is not None and predicate.min > bound
        if far:
            found |= set(entities_of(predicate))
    return found


FUNCTIONS: Mapping[str, Function] = {
    "category:rigid:bodies": _bodies,
    "category:rigid:mass": _mass,
    "category:rigid:joints": joints,
    "category:rigid:energy": energy,
    "category:rigid:escape": _escape,
    "category:rigid:records": by_books(books.records),
    "category:rigid:work": by_books(books.work),
    "category:rigid:momentum": by_books(laws.momentum),
    "category:rigid:motion": by_books(laws.motion),
    "category:rigid:spin": by_books(laws.spin),
    "category:rigid:turning": by_books(laws.turning),
    "category:rigid:driven": by_books(laws.driven),
    "category:rigid:contacts": by_books(contacts),
    "category:rigid:friction": by_books(friction),
    "category:rigid:restitution": by_books(restitution),
    "category:rigid:rebounds": by_books(rebounds),
    "category:rigid:impact_energy": by_books(impact_energy),
    "category:rigid:fields": by_books(fields),
}
"""By id of the question."""

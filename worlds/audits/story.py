"""Audit of what happens when: beats, their evidence, relations and shots lie in the sequence and follow from one another (R14-R16, R24, R28, R29)."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..categories.registry import CATEGORIES
from ..channels import names_written
from ..drivers import deed, in_secret, to_declare, undeclared
from ..errors import EvidenceError
from ..fields import acting_on
from ..predicates import Contact, NoContact, PairEvent, Predicate, atoms_of, entities_of
from ..predicates.registry import PREDICATES, is_invariant
from ..problems import Problem, removed, replaced
from ..references import cycle_in, kinds_of, mentions_joint
from ..spec import FieldDriver, SpecModel, Supports, WorldSpec
from ..writers import writers_of

__all__ = [
    "STARTED",
    "coverage_of",
    "evidence_problems",
    "graph_problems",
    "shot_problems",
    "story_problems",
    "tells_of_change",
    "uncaused",
]

STARTED = 1e-3
"""[m/s] and [rad/s] Own choice: a body given less than this at frame 0 is at rest."""


def _changed_by(spec: WorldSpec, solver: str) -> set[str]:
    """Entities that a solver moves or otherwise changes."""
    instance = spec.simulation.solvers[solver]
    others = (name for c in CATEGORIES.values() if isinstance(instance, c.instances) for name in c.changes(spec, solver))
    return {*instance.members, *others}


def story_problems(spec: WorldSpec) -> list[Problem]:
    """R14-R16, R28: beats in range, owned, checkable, causally ordered."""
    plan, beats, problems = spec.simulation, spec.story.beats, []
    for name, beat in beats.items():
        place = f"/story/beats/{name}"
        problems += _ends_late(spec, place, beat.frames)
        members = _changed_by(spec, beat.owner) if beat.owner in plan.solvers else None
        driver = plan.drivers.get(beat.owner)
        if members is not None and beat.subject not in members:
            problems.append(Problem(f"{place}/owner", f"solver {beat.owner!r} does not move {beat.subject!r}"))
        acts_on = acting_on(spec, driver) if isinstance(driver, FieldDriver) else None
        if (acts_on is not None and beat.subject not in acts_on) or (
            driver is not None and getattr(driver, "entity", beat.subject) != beat.subject
        ):
            problems.append(Problem(f"{place}/owner", f"driver {beat.owner!r} does not act on {beat.subject!r}"))
        for cause in beat.causes:
            if cause in beats and beats[cause].frames[0] > beat.frames[1]:
                problems.append(
                    Problem(f"{place}/causes", f"cause {cause!r} starts at frame {beats[cause].frames[0]}, after this beat ends")
                )
        for cause in beat.margins:
            if cause not in beat.causes:
                text = f"the margin names {cause!r}, which is not among the causes"
                problems.append(Problem(f"{place}/margins/{cause}", text, removed(f"{place}/margins/{cause}")))
        problems += _unsaid(spec, name)
        problems += _own_start(spec, name)
        if beat.subject not in entities_of(beat.predicate) and not mentions_joint(beat.predicate, plan.joints, beat.subject):
            problems.append(Problem(f"{place}/predicate", f"the predicate says nothing about the subject {beat.subject!r}"))
    cycle = cycle_in({n: list(b.causes) for n, b in beats.items()})
    if cycle:
        problems.append(Problem(f"/story/beats/{cycle[0]}/causes", f"causes form a cycle {' -> '.join(cycle)}"))
    if not any(b.mandatory for b in beats.values()) and not any(r.mandatory for r in spec.story.requirements.values()):
        problems.append(
            Problem("/story/beats", "no mandatory beat or requirement: nothing would prove the prompt; add at least one")
        )
    return problems + _in_secret(spec)


def _in_secret(spec: WorldSpec) -> list[Problem]:
    """R28: drivers of which the story says nothing, on things of which the prompt speaks."""
    return [
        Problem(
            f"/simulation/drivers/{name}",
            f"driver {name!r} acts on {body!r}, which the prompt names, from {start:g} s on, and no beat tells of it: let a beat own it "
            f"(owner {name}), or take it away",
            removed(f"/simulation/drivers/{name}"),
        )
        for name, (body, start) in in_secret(spec).items()
    ]


def _unsaid(spec: WorldSpec, name: str) -> list[Problem]:
    """A driver that is sure to act on the subject of an outcome before it can come true, and that no beat which leads there owns.

    An outcome that is true at frame 0 is none, so it comes true at frame 1 or at the first of its frames.
    """
    beat, plan = spec.story.beats[name], spec.simulation
    try:
        helper = undeclared(spec, name, max(1, beat.frames[0]) / plan.fps) if beat.mandatory else None
    except EvidenceError:
        return []  # a joint that is not there: the references tell of it
    if helper is None:
        return []
    owns, field = ("no beat that leads to it is owned by", "causes") if beat.causes else ("no beat is owned by", "owner")
    text = f"{deed(spec, helper, beat.subject)}, before {name} can come true, and {owns} {helper}"
    return [Problem(f"/story/beats/{name}/{field}", f"{text}: {to_declare(spec, helper, name)}")]


def _own_start(spec: WorldSpec, name: str) -> list[Problem]:
    """An effect whose subject starts with a velocity of its own, of which no beat without causes tells: it would move without them."""
    beat = spec.story.beats[name]
    physics = spec.entities[beat.subject].physics if beat.subject in spec.entities else None
    if not beat.causes or not beat.mandatory or physics is None or not CATEGORIES[physics.category].starts_alone:
        return []
    speeds = [math.hypot(*getattr(physics, field, (0.0,))) for field in ("linear_velocity", "angular_velocity")]
    first = [b for b in spec.story.beats.values() if not b.causes]
    if max(speeds) < STARTED or any(beat.subject in (b.subject, *entities_of(b.predicate)) for b in first):
        return []
    text = (
        f"{beat.subject} starts with {speeds[0]:g} m/s and {speeds[1]:g} rad/s of its own, so that it moves without {', '.join(beat.causes)}: "
        f"give that start a beat without causes about {beat.subject}, or take the velocity away"
    )
    return [Problem(f"/entities/{beat.subject}/physics", text)]


def tells_of_change(spec: WorldSpec) -> list[str]:
    """Pointers of the beats and requirements that tell of a change, and of the drivers that act; a medium at rest brings nothing about."""
    story, drivers = spec.story, spec.simulation.drivers
    found = [f"/story/beats/{n}" for n, b in story.beats.items() if not is_invariant(b.predicate)]
    found += [f"/story/requirements/{n}" for n, r in story.requirements.items() if not is_invariant(r.asked)]
    at_rest = [n for n, d in drivers.items() if isinstance(d, FieldDriver) and d.field.kind == "drag"]
    return found + [f"/simulation/drivers/{n}" for n in drivers if n not in at_rest]


def uncaused(spec: WorldSpec) -> str | None:
    """Why an acceptance would find no cause to judge, and what to add; None where it finds one, or nothing can happen."""
    beats = spec.story.beats
    if any(b.causes for b in beats.values()):
        return None
    if not beats and not spec.simulation.drivers and all(e.motion == "static" for e in spec.entities.values()):
        return None
    change = tells_of_change(spec)
    if not change and (beats or spec.story.requirements):
        return (
            "no beat names causes: an acceptance asks for none where all that the story tells holds from frame 0 on and nothing moves; if "
            "something is to happen, give it a beat and name its cause"
        )
    text = "no beat names causes, and without one an acceptance stays incomplete"
    text += f" ({', '.join(change[:4])} {'tell' if len(change) > 1 else 'tells'} of a change): " if change else ": "
    if len(beats) < 2:
        return (
            text
            + "add a beat of what starts the event (owned by its driver, if it has one) and name it in the `causes` of the event's"
        )
    first, *_, last = sorted(beats, key=lambda n: beats[n].frames)
    return text + f'say which beat brings about which, such as "causes": ["{first}"] in /story/beats/{last}, if that is so'


def evidence_problems(spec: WorldSpec) -> list[Problem]:
    """R29: what predicates read is written by an engine in use."""
    problems = []
    solvers = spec.simulation.solvers
    channels = frozenset().union(*(names_written(writers_of(spec, name)) for name in solvers))
    if spec.simulation.cloth:
        channels |= {"position", "quaternion"}  # sheets have no bodies, but predicates of poses measure their vertices
    for place, predicate in _said(spec):
        own = {str(getattr(a, "kind", "")) for a in atoms_of(predicate) if _by_its_own(spec, a)}
        missing = [c for k in kinds_of(predicate) if k not in own for c in PREDICATES[k].channels if c not in channels]
        if missing:
            problems.append(Problem(place, f"no engine in use writes {sorted(set(missing))}"))
    return [*problems, *_without_bodies(spec), *_without_record(spec)]


def _by_its_own(spec: WorldSpec, atom: SpecModel) -> bool:
    """True of an event that a category meets by a definition of its own, whose evidence its own engine writes."""
    entity = spec.entities.get(str(getattr(atom, "entity", "")))
    return entity is not None and getattr(atom, "kind", "") in CATEGORIES[entity.physics.category].meets


def _said(spec: WorldSpec) -> list[tuple[str, Predicate]]:
    """Every predicate of the story and where it stands."""
    said = [(f"/story/beats/{n}/predicate", b.predicate) for n, b in spec.story.beats.items()]
    return said + [(f"/story/requirements/{n}/predicate", r.asked) for n, r in spec.story.requirements.items()]


def _without_record(spec: WorldSpec) -> list[Problem]:
    """Contacts that no record can tell."""
    problems = []
    for place, predicate in _said(spec):
        for atom in atoms_of(predicate):
            if isinstance(atom, Contact | NoContact):
                pairs = dict.fromkeys((a, b) for a in _meant(atom.a, predicate) for b in _meant(atom.b, predicate) if a != b)
                told = (text for pair in pairs for c in CATEGORIES.values() if (text := c.unrecorded(spec, *pair)))
                problems += [Problem(place, f"{atom.kind}: {text}") for text in list(told)[:1]]
            elif isinstance(atom, PairEvent):
                known = [spec.entities[n].physics.category for n in (atom.entity, atom.other) if n in spec.entities]
                told = (CATEGORIES[c].unstruck for c in known if atom.kind == "hits")
                problems += [Problem(place, f"{atom.kind}: {text}") for text in told if text][:1]
    return problems


def _meant(name: str, predicate: SpecModel) -> tuple[str, ...]:
    return entities_of(predicate) if name == "each" else (name,)


def _without_bodies(spec: WorldSpec) -> list[Problem]:
    """Loose matter is many: nothing is asked of its one place, surface or contact."""
    problems = []
    for place, predicate in _said(spec):
        for atom in atoms_of(predicate):
            kind = str(getattr(atom, "kind", ""))
            matter = getattr(atom, PREDICATES[kind].matter, None) if PREDICATES[kind].matter else None
            for entity in entities_of(atom) if PREDICATES[kind].bodily else ():
                if entity == matter:
                    continue
                category = CATEGORIES[spec.entities[entity].physics.category] if entity in spec.entities else None
                itself = kind in category.meets and entity == getattr(atom, "entity", entity) if category is not None else False
                if category is not None and category.asked and not itself:
                    text = f"{kind} asks for a body, and {entity!r} is {category.name}: ask {category.asked}"
                    problems.append(Problem(place, text))
    return problems


def graph_problems(spec: WorldSpec) -> list[Problem]:
    """Support is acyclic and carried by something; relations lie in the sequence."""
    relations, problems = spec.graph.relations, []
    below: dict[str, list[str]] = {}
    for name, relation in relations.items():
        place = f"/graph/relations/{name}"
        if relation.a == relation.b:
            problems.append(Problem(place, f"{relation.a!r} is related to itself"))
        if isinstance(relation, Supports):
            below.setdefault(relation.b, []).append(relation.a)
        frames = getattr(relation, "frames", None)
        if frames is not None:
            problems += _ends_late(spec, place, frames)
    cycle = cycle_in(below)
    if cycle:
        problems.append(
            Problem(
                "/graph/relations",
                f"support runs in a circle: {' on '.join(cycle)}; one of them must stand on something else",
            )
        )
    return problems


def shot_problems(spec: WorldSpec, coverage: Mapping[str, tuple[str, ...]]) -> list[Problem]:
    """R24: shots lie in the sequence and every observed beat has one."""
    problems = []
    for name, shot in spec.shots.items():
        place = f"/shots/{name}"
        problems += _ends_late(spec, place, shot.frames)
        if not shot.covers and not shot.subjects:
            problems.append(Problem(f"{place}/covers", "the shot covers no beat and names no subject"))
        for key, camera in shot.keys.items():
            if not shot.frames[0] <= camera.frame <= shot.frames[1]:
                problems.append(
                    Problem(f"{place}/keys/{key}/frame", f"frame {camera.frame} lies outside the shot {list(shot.frames)}")
                )
    for name, beat in spec.story.beats.items():
        if beat.observe and beat.mandatory and not coverage[name]:
            problems.append(
                Problem("/shots", f"beat {name!r} (frames {list(beat.frames)}) is covered by no shot that overlaps it")
            )
    return problems


def coverage_of(spec: WorldSpec) -> dict[str, tuple[str, ...]]:
    """Shots that overlap each beat's frames and cover it."""
    return {
        name: tuple(
            s for s, shot in spec.shots.items()
            if shot.frames[0] <= beat.frames[1] and shot.frames[1] >= beat.frames[0] and name in shot.covers
        )
        for name, beat in spec.story.beats.items()
    }  # fmt: skip


def _last(spec: WorldSpec) -> int:
    """The last frame."""
    return spec.simulation.frames - 1


def _ends_late(spec: WorldSpec, place: str, frames: tuple[int, int]) -> list[Problem]:
    """The problem of an interval that ends after the sequence, with the edit that ends it there unless it lies wholly beyond."""
    last, pointer = _last(spec), f"{place}/frames"
    if frames[1] <= last:
        return []
    clip = replaced(pointer, [frames[0], last]) if frames[0] <= last else None
    return [Problem(pointer, f"frames {list(frames)} end after the last frame {last}", clip)]

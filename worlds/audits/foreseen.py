"""Warnings of the audit about things that will probably fail once they are simulated, though nothing in the specification is wrong."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from ..categories.registry import CATEGORIES, shape_of
from ..drivers import acts_from, in_secret, since
from ..errors import EvidenceError
from ..predicates import atoms_of
from ..predicates.registry import is_invariant
from ..problems import Problem
from ..spec import Beat, PathDriver, WorldSpec
from .pairs import materials_of
from .turning import turning_in_place

__all__ = ["SCREEN_STEP", "foreseen"]

SCREEN_STEP = 0.2
"""[1] Largest move on the picture per frame, in widths: the bound of `shots:motion`."""
LIVELY = 0.05
"""[1] Own choice: a body that keeps less of its speed rises by less than a four hundredth of what it fell."""
NARROWEST = 5.0
"""[deg] Narrowest vertical field of view of a camera."""


def foreseen(spec: WorldSpec) -> list[Problem]:
    """Warnings of the categories, then of drivers that no beat owns, states that are to bring something about, bodies that turn in place, subjects
    too fast for any camera and bounces off what gives none."""
    found = [p for category in CATEGORIES.values() for p in category.warnings(spec)]
    return [
        *found, *_unowned(spec), *_states_as_causes(spec), *turning_in_place(spec), *_too_fast(spec), *_dead_bounces(spec),
    ]  # fmt: skip


def _unowned(spec: WorldSpec) -> Iterator[Problem]:
    """Drivers that no beat owns, a medium at rest and those that are refused aside: beats that need one of them fail."""
    beats = spec.story.beats
    owners = {b.owner for b in beats.values()} | in_secret(spec).keys()
    for name, driver in spec.simulation.drivers.items() if beats else ():
        if name in owners or (driver.kind == "field" and driver.field.kind == "drag"):
            continue
        try:
            bodies = acts_from(spec, name)[1]
        except EvidenceError:
            continue  # a joint that is not there: the references tell of it
        told = ", ".join(bodies[:3]) or "nothing"
        yield Problem(
            f"/simulation/drivers/{name}",
            f"0 beats are owned by {driver.kind} {name!r}, which acts on {told} {since(spec, name)}; 1 is wanted: causal:untold runs the world "
            f"again without it and fails every beat that does not come then. Give it a beat (owner {name}), or take it away",
        )


def _states_as_causes(spec: WorldSpec) -> Iterator[Problem]:
    """Beats that last from frame 0 on without causes and are named as a cause: where they come true, `beat:vacuous` fails."""
    beats = spec.story.beats
    for name, beat in beats.items():
        effects = [n for n, other in beats.items() if name in other.causes]
        if effects and not beat.causes and beat.frames[0] == 0 and is_invariant(beat.predicate):
            yield Problem(
                f"/story/beats/{name}",
                f"{name!r} lasts from frame 0 on and has no causes: it is an initial state, which brings nothing about, and {', '.join(effects)} "
                f"{'names' if len(effects) == 1 else 'name'} it as a cause, so beat:vacuous:{name} fails where it comes true. Take it out of these "
                f"causes, and name the event that starts them: a release, a push, a body that arrives",
            )


def _dead_bounces(spec: WorldSpec) -> Iterator[Problem]:
    """Beats in which a rigid body bounces, though no rigid body that is there gives it any restitution."""
    if any(shape_of(e) == "deforming" for e in spec.entities.values()):
        return  # off what deforms a body bounces without
    for name, beat in spec.story.beats.items():
        for bouncer in dict.fromkeys(
            getattr(a, "entity", "") for a in atoms_of(beat.predicate) if getattr(a, "kind", "") == "bounces"
        ):
            if bouncer not in spec.entities or shape_of(spec.entities[bouncer]) != "solid":
                continue
            others = [n for n, e in spec.entities.items() if n != bouncer and shape_of(e) == "solid"]
            best = max((_restitution(spec, bouncer, other) for other in others), default=1.0)
            if best < LIVELY:
                own = max((spec.materials[m].restitution for m in materials_of(spec, bouncer)), default=0.0)
                yield Problem(
                    f"/story/beats/{name}",
                    f"{bouncer!r} is to bounce, and with nothing that is there it has a restitution of {LIVELY:g} or more (the largest is "
                    f"{best:g}): a pair has the smaller one of its two materials, its own is {own:g}, and what a material does not say is 0. "
                    f"Give the material it falls on a restitution, or the pair: simulation.contacts {{a: {bouncer!r}, b: ..., restitution: ...}}",
                )


def _restitution(spec: WorldSpec, a: str, b: str) -> float:
    """Largest restitution that two bodies can have with one another."""
    own = next(
        (p.restitution for p in spec.simulation.contacts.values() if {p.a, p.b} == {a, b} and p.restitution is not None), None
    )
    if own is not None:
        return own
    sides = [materials_of(spec, name) for name in (a, b)]
    return max(
        (min(spec.materials[m].restitution, spec.materials[n].restitution) for m in sides[0] for n in sides[1]), default=1.0
    )


def _too_fast(spec: WorldSpec) -> Iterator[Problem]:
    """Subjects of observed beats that go too far per frame for a picture in which they are large enough."""
    for name, beat in spec.story.beats.items():
        entity = spec.entities.get(beat.subject)
        if entity is None or not (beat.mandatory and beat.observe):
            continue
        speed, fps, share = _declared_speed(spec, beat), spec.simulation.fps, spec.simulation.limits.visible_pixels
        aspect = spec.look.width / spec.look.height
        a, b, c = entity.dimensions.size
        # No shadow of a box is larger than this, and the picture's width times height is at most shadow / share.
        width = math.sqrt(math.sqrt((a * b) ** 2 + (b * c) ** 2 + (c * a) ** 2) / share * aspect)
        least = speed / fps / SCREEN_STEP
        if least <= width:
            continue
        # A camera that goes along travels by at most that share of its distance.
        farthest = width / aspect / (2.0 * math.tan(math.radians(NARROWEST) / 2.0))
        shots = [s for s in spec.shots.values() if name in s.covers]
        if shots and all(s.follow == beat.subject for s in shots) and least <= farthest:
            continue
        fewest = math.ceil(speed / (SCREEN_STEP * width))
        if least <= farthest:
            along = f"Let its shot follow {beat.subject} from {least:.3g} to {farthest:.3g} m away with a narrow fov_deg, or take"
        else:
            along = "Take"
        yield Problem(
            f"/story/beats/{name}",
            f"{beat.subject!r} goes {speed / fps:.3g} m per frame ({speed:.3g} m/s at {fps} frames/s), and fills {share:g} of a picture at most "
            f"{width:.3g} m wide: it would cross {speed / fps / width:.2g} of its width per frame, allowed is {SCREEN_STEP:g} (shots:motion). {along} "
            f"at least {fewest} frames/s, or a larger or slower subject",
        )


def _declared_speed(spec: WorldSpec, beat: Beat) -> float:
    """Speed that a beat's subject has by what is declared [m/s]: at frame 0, along a path, or as the beat itself asks."""
    found = (
        [math.hypot(*getattr(spec.entities[beat.subject].physics, "linear_velocity", (0.0,)))] if beat.frames[0] <= 1 else [0.0]
    )
    for atom in atoms_of(beat.predicate):
        if getattr(atom, "kind", "") == "speed" and getattr(atom, "entity", "") == beat.subject:
            found.append(getattr(atom, "min", None) or 0.0)
    for driver in spec.simulation.drivers.values():
        if isinstance(driver, PathDriver) and driver.entity == beat.subject:
            keys = sorted(driver.keys.values(), key=lambda k: k.time)
            found += [
                math.dist(one.pose.position, two.pose.position) / (two.time - one.time)
                for one, two in pairwise(keys)
                if two.time > one.time
            ]
    return max(found)

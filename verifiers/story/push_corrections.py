"""Corrections of a push that does not come about: by how the two bodies part, or that they do not meet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ...worlds.predicates import PairEvent, atoms_of
from ..predicates.events.bounds import BLOW_LEAST, PUSH_TIME
from ..predicates.events.course import course_of
from ..rows.corrections import correction, pointer
from .bounds import AFTER_FRAMES, DROPPED, FREE_BOUNCE, HEAVY, MOST_FASTER, OUTRUNS, SPARE
from .offers import faster, let_meet

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction
    from ...worlds.spec import SpecModel, WorldSpec
    from ..predicates.outcome import Outcome

__all__ = ["pushing"]


def pushing(
    candidate: Candidate, predicate: SpecModel, entity: str, outcome: Outcome, details: Mapping[str, Any]
) -> list[Correction] | None:
    """Corrections for a body that does not push another one long enough; None where something else is asked.

    Args:
        candidate: what was judged.
        predicate: what is asked.
        entity: of which it fails.
        outcome: what it came to.
        details: numbers of the outcome.
    """
    asked = [a for a in atoms_of(predicate) if isinstance(a, PairEvent) and a.kind == "pushes" and a.entity == entity]
    other = details.get("other")
    if not asked or not isinstance(other, str) or other not in candidate.spec.entities:
        return None
    if details.get("untouched"):
        return _apart(candidate, entity, other)
    if "pushed_speed" not in details:
        return None
    return _short(candidate, entity, other, float(outcome.bound or 0.0), details)


def _apart(candidate: Candidate, entity: str, other: str) -> list[Correction]:
    why = f"{entity} and {other} do not touch in these frames"
    return [
        let_meet(pointer("entities", entity, "pose", "position"), why),
        faster(entity, f"{why}: perhaps it does not reach {other} in time", entity),
    ]


def _short(candidate: Candidate, entity: str, other: str, least: float, found: Mapping[str, Any]) -> list[Correction]:
    """By how the two part: the other drops away, outruns what pushes it, or the push spends itself."""
    spec, knock = candidate.spec, f"{entity} pushes {other} for {found['lasted_s']:.3g} s and {found['way']:.3g} m only"
    told = [*_edge(candidate, entity, other, least, found, knock)]
    outruns = found["pushed_speed"] - found["pusher_speed"] > max(BLOW_LEAST, OUTRUNS * abs(found["pusher_speed"]))
    if outruns and not told:
        told += _bounces(spec, entity, other, found, knock)
    told += _heavier(candidate, entity, other, found, knock) + _driven_on(
        spec, entity, other, least, found, knock, faster=not outruns
    )
    story = f"where the words say a blow (knocks, strikes), ask for `hits` of {entity} and {other}: it needs no way and no time"
    return [
        *told,
        correction(f"a knock is no push: {PUSH_TIME:g} s without a break are asked", "story", story, pointers=("/story/beats",)),
    ]


def _edge(candidate: Candidate, entity: str, other: str, least: float, found: Mapping[str, Any], knock: str) -> list[Correction]:
    """Start farther from the edge over which the pushed body drops away."""
    course = course_of(candidate, other)
    after = min(found["until"] + AFTER_FRAMES, candidate.last_frame)
    drop = float(course.heights[found["onset"]] - course.heights[after])
    if drop < DROPPED * course.size:
        return []
    more = SPARE * max(least - found["way"], PUSH_TIME * max(found["pushed_speed"], found["pusher_speed"]))
    action = f"start {other} and {entity} {more:.3g} m farther from the edge, so that the push has its way before {other} drops"
    return [
        correction(
            f"{knock}: {other} goes over an edge: it drops {drop:.3g} m by frame {after}",
            "placement",
            action,
            pointers=(pointer("entities", other, "pose", "position"), pointer("entities", entity, "pose", "position")),
        )
    ]


def _bounces(spec: WorldSpec, entity: str, other: str, found: Mapping[str, Any], knock: str) -> list[Correction]:
    """Keep the pushed body from leaping ahead: no bounce between the two, or a rubbing floor under it."""
    away = f"{knock}: {other} leaps ahead at {found['pushed_speed']:.3g} m/s, {entity} follows at {found['pusher_speed']:.3g} m/s"
    key = next((k for k, p in spec.simulation.contacts.items() if {p.a, p.b} == {entity, other}), f"{entity}_{other}"[:60])
    bounce = _restitution(spec, entity, other)
    if bounce > 0.0:
        place = pointer("simulation", "contacts", key)
        known = key in spec.simulation.contacts
        operation = {"op": "add", "path": f"{place}/restitution", "value": 0.0} if known else {
            "op": "add", "path": place, "value": {"a": entity, "b": other, "restitution": 0.0}
        }  # fmt: skip
        why = (
            ""
            if bounce <= FREE_BOUNCE
            else "; say in its `reason` what lies between the two (a label, felt), for their materials bounce more"
        )
        return [
            correction(
                f"{away}: the two bounce apart with a restitution of {bounce:g}",
                "contact",
                f"give the pair {entity} and {other} a restitution of 0 (simulation.contacts){why}",
                pointers=(place,),
                patch=(operation,) if bounce <= FREE_BOUNCE else (),
            )
        ]
    return [
        correction(
            f"{away}: nothing holds {other} back",
            "contact",
            f"let {other} rub more on what carries it than {entity} does: a pair of simulation.contacts with more friction for {other}",
            pointers=("/simulation/contacts",),
        )
    ]


def _restitution(spec: WorldSpec, a: str, b: str) -> float:
    """Largest restitution of a pair: its own, else the smaller one of two materials of colliding parts."""
    own = [p.restitution for p in spec.simulation.contacts.values() if {p.a, p.b} == {a, b} and p.restitution is not None]
    if own:
        return own[0]
    sides = [
        [
            spec.materials[m].restitution
            for p in spec.entities[n].parts.values()
            if p.collides and (m := p.material or spec.entities[n].material) in spec.materials
        ]
        for n in (a, b)
    ]
    return min(max(side, default=0.0) for side in sides)


def _heavier(candidate: Candidate, entity: str, other: str, found: Mapping[str, Any], knock: str) -> list[Correction]:
    """More mass for what pushes, where it is not much heavier than the other already."""
    if candidate.spec.entities[entity].motion != "dynamic":
        return []
    masses = [course_of(candidate, n).mass for n in (entity, other)]
    if masses[0] >= HEAVY * masses[1]:
        return []
    action = (
        f"make {entity}, {masses[0]:.3g} kg, heavier than {other}, {masses[1]:.3g} kg: it then keeps its speed when they meet"
    )
    spent = f"{knock}, and by then goes on at {found['pusher_speed']:.3g} m/s"
    return [correction(spent, "mass", action, pointers=(pointer("entities", entity, "physics", "mass"),))]


def _driven_on(
    spec: WorldSpec, entity: str, other: str, least: float, found: Mapping[str, Any], knock: str, *, faster: bool
) -> list[Correction]:
    """Keep what pushes going: a longer path, more speed by the missing time and way, or a force."""
    acting = [
        pointer("simulation", "drivers", n) for n, d in spec.simulation.drivers.items() if getattr(d, "entity", None) == entity
    ]
    spent = f"{knock}, and by then goes on at {found['pusher_speed']:.3g} m/s"
    if spec.entities[entity].motion != "dynamic":
        action = f"let the path of {entity} go on behind {other} for at least {PUSH_TIME:g} s and {least:.3g} m after they meet, no faster than {other} yields"
        return [correction(spent, "drivers", action, pointers=acting)]
    force = correction(
        f"{spent}: nothing drives it on",
        "drivers",
        f"let a `force` driver act on {entity} from before they meet, which the story tells of, and keep it in touch with {other}",
        pointers=acting or ("/simulation/drivers",),
    )
    if not faster:
        return [force]
    physics, place = spec.entities[entity].physics, pointer("entities", entity, "physics")
    factor = _factor(found, least)
    patch = []
    for field in ("linear_velocity", "angular_velocity"):  # what rolls would slide at first with another spin
        given = getattr(physics, field, None)
        if factor is not None and given is not None and any(given):
            patch.append({"op": "add", "path": f"{place}/{field}", "value": [round(factor * c, 6) for c in given]})
    by = f"{factor:.2g} times" if factor is not None else "more of"
    action = (
        f"raise the start speed of {entity}: a push against friction lasts as its speed and goes as the square, {by} it is needed"
    )
    return [
        correction(
            f"{spent}: the push spends itself", "initial_state", action, pointers=(f"{place}/linear_velocity",), patch=patch
        ),
        force,
    ]


def _factor(found: Mapping[str, Any], least: float) -> float | None:
    """Factor on the start speed, from the missing time and way; None where the push did not begin, or lacks too much for a guess."""
    if not found["lasted_s"] or not found["way"]:
        return None
    factor = SPARE * max(PUSH_TIME / found["lasted_s"], math.sqrt(least / found["way"]))
    return factor if 1.0 < factor <= MOST_FASTER else None

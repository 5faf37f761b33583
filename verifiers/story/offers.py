"""Corrections of the story's rows with a patch that applies, and edits of drivers that several of them offer."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ...worlds.drivers import acts_from, behind
from ...worlds.errors import EvidenceError
from ...worlds.spec import PathDriver
from ..rows.corrections import correction, owning_up, pointer

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from ...worlds.spec import WorldSpec

__all__ = [
    "acting",
    "driver_offers",
    "earlier",
    "faster",
    "let_meet",
    "offered",
    "owning",
    "take_away",
    "untold_offers",
]


def offered(
    spec: WorldSpec, cause: str, group: str, action: str, *, pointers: Iterable[str], patch: Iterable[dict[str, Any]]
) -> Correction:
    """A correction whose patch applies to the specification; without the patch where it does not.

    The action says so where the patch makes the specification easier to satisfy.

    Args:
        spec: what was judged.
        cause: the supposed cause of the failure.
        group: parameter group of the edit.
        action: the edit in words.
        pointers: fields to look at first.
        patch: RFC 6902 operations.
    """
    return owning_up(correction(cause, group, action, pointers=pointers, patch=patch), spec)


def acting(spec: WorldSpec, entity: str) -> list[str]:
    """Drivers that act on an entity, but for media at rest, which bring nothing about."""
    found = []
    for name, driver in spec.simulation.drivers.items():
        try:
            acted = acts_from(spec, name)[1]
        except EvidenceError:
            continue  # its joint is not in the plan: the audit tells
        if entity in acted and not (driver.kind == "field" and driver.field.kind == "drag"):
            found.append(name)
    return found


def earlier(spec: WorldSpec, driver: str, by: float) -> tuple[dict[str, Any], ...]:
    """Patch that lets a driver act `by` [s] earlier; empty where that would be before frame 0, and for a path, whose keys are the author's."""
    given = spec.simulation.drivers[driver]
    fields = [n for n in ("time", "start", "end") if getattr(given, n, None) is not None]
    if isinstance(given, PathDriver) or not fields or given.begins < by:
        return ()
    places = [(pointer("simulation", "drivers", driver, n), getattr(given, n)) for n in fields]
    return tuple({"op": "replace", "path": place, "value": round(float(value) - by, 6)} for place, value in places)


def driver_offers(spec: WorldSpec, driver: str, cause: str, effect: str) -> tuple[Correction, ...]:
    """Corrections of an effect that a driver brings about in place of its cause.

    A driver that owns no beat is taken away. One that does is named by that beat, where the story then has no ring of causes.
    """
    place, causes = pointer("simulation", "drivers", driver), pointer("story", "beats", effect, "causes")
    owned = [n for n, b in spec.story.beats.items() if b.owner == driver]
    told = f"driver {driver} acts on {spec.story.beats[effect].subject}, or releases it, by its own clock"
    if not owned:
        return (take_away(spec, told, place, effect),)
    index = spec.story.beats[effect].causes.index(cause)
    fresh = [n for n in owned if effect not in behind(spec, n) and n not in spec.story.beats[effect].causes]
    if not fresh:
        why = f"let driver {driver}, which owns {owned[0]}, act on {spec.story.beats[effect].subject} only after {cause}"
        return (correction(told, "drivers", why, pointers=(place,)),)
    named = f"name {fresh[0]}, which driver {driver} owns, among the causes of {effect} in place of {cause}"
    patch = [{"op": "replace", "path": f"{causes}/{index}", "value": fresh[0]}]
    if cause in spec.story.beats[effect].margins:
        patch.append({"op": "remove", "path": pointer("story", "beats", effect, "margins", cause)})
    return (offered(spec, told, "story", named, pointers=(causes, place), patch=patch),)


def untold_offers(spec: WorldSpec, driver: str, beat_id: str) -> tuple[Correction, ...]:
    """Corrections of a beat that needs a driver of which the story does not tell: tell of it, or take it away."""
    beats, place = spec.story.beats, pointer("simulation", "drivers", driver)
    causes = pointer("story", "beats", beat_id, "causes")
    why = f"{beat_id} needs {driver}, and no beat that leads to it tells so"
    owned = [n for n, b in beats.items() if b.owner == driver and beat_id not in behind(spec, n)]
    if owned:
        name = f"name {owned[0]}, which {driver} owns, among the causes of {beat_id}"
        patch = ({"op": "add", "path": f"{causes}/-", "value": owned[0]},)
        return (offered(spec, why, "story", name, pointers=(causes, place), patch=patch),)
    body = next(iter(acts_from(spec, driver)[1]), "what it acts on")
    return (
        correction(why, "story", owning(driver, beat_id, body), pointers=("/story/beats", causes)),
        take_away(spec, why, place, beat_id),
    )


def take_away(spec: WorldSpec, cause: str, place: str, beat_id: str, *, silent: bool = True) -> Correction:
    """Take away what helps a beat along, by its pointer; without a patch where the story speaks of it (`silent` false)."""
    group, name = place.split("/")[-2:]
    action = f"take {name} away (remove {place}); {beat_id} must then come by what the story tells"
    patch = ({"op": "remove", "path": place},) if silent else ()
    return offered(spec, cause, group, action, pointers=(place,), patch=patch)


def owning(driver: str, beat_id: str, body: str) -> str:
    """Action that lets a driver own a beat about a body before the one that it leads to."""
    return f"let {driver} own a beat that leads to {beat_id}: a first beat about {body}, named in the causes of what follows"


def faster(entity: str, cause: str, what: str = "what hits it") -> Correction:
    """Raise the speed of an entity, or of what hits it."""
    place = pointer("entities", entity, "physics", "linear_velocity")
    return correction(cause, "initial_state", f"raise the speed of {what}", pointers=(place,))


def let_meet(place: str, cause: str) -> Correction:
    """Bring the paths of bodies together."""
    return correction(cause, "placement", "bring their paths together", pointers=(place,))

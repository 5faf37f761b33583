"""When drivers act and on what, by the specification alone."""

from __future__ import annotations

from .claim_targets import named_in
from .errors import EvidenceError
from .fields import acting_on
from .predicates.registry import is_invariant
from .spec import DetachDriver, FieldDriver, ForceDriver, MotorDriver, PathDriver, ReleaseDriver, WorldSpec

__all__ = ["acts_from", "behind", "deed", "in_secret", "since", "to_declare", "undeclared", "untold"]


def acts_from(spec: WorldSpec, driver_id: str) -> tuple[float, tuple[str, ...]]:
    """When a driver acts first [s], and on which entities.

    Raises:
        EvidenceError: its joint is not in the plan.
    """
    plan, driver = spec.simulation, spec.simulation.drivers[driver_id]
    if isinstance(driver, FieldDriver):
        return driver.begins, acting_on(spec, driver)
    if not isinstance(driver, MotorDriver | DetachDriver):
        return driver.begins, (driver.entity,)
    joint = plan.joints.get(driver.joint)
    if joint is None:
        raise EvidenceError(f"joint {driver.joint!r} of driver {driver_id!r} is not in the simulation plan")
    return driver.begins, tuple(e for e in (joint.child, joint.parent) if e is not None)


def since(spec: WorldSpec, driver_id: str) -> str:
    """From when on a driver acts, in words: a field may blow in the preroll already, before frame 0."""
    start = getattr(spec.simulation.drivers[driver_id], "start", 0.0)
    return f"from {start:g} s on, before frame 0" if start < 0.0 else f"from {acts_from(spec, driver_id)[0]:g} s on"


def deed(spec: WorldSpec, driver_id: str, entity: str) -> str:
    """Deed of a driver on an entity, in words."""
    if isinstance(spec.simulation.drivers[driver_id], ReleaseDriver):
        return f"release {driver_id} lets {entity} go at {acts_from(spec, driver_id)[0]:g} s"
    return f"driver {driver_id} acts on {entity} {since(spec, driver_id)}"


def to_declare(spec: WorldSpec, driver_id: str, beat_id: str, body: str | None = None) -> str:
    """Advice on how the story can say that a driver leads to a beat: by a first beat that it could own, else by a new one about a body."""
    beats, acted = spec.story.beats, acts_from(spec, driver_id)[1]
    subject = beats[beat_id].subject
    first = [n for n in behind(spec, beat_id)[1:] if beats[n].subject in acted and not beats[n].causes]
    own = [n for n in first if beats[n].owner in spec.simulation.solvers]
    if not beats[beat_id].causes and body in (None, subject):
        own = [beat_id]
    if own:
        return f"let {driver_id} own beat {own[0]} (/story/beats/{own[0]}/owner), or take {driver_id} away"
    return (
        f"give {driver_id} a beat of its own (owner {driver_id}, subject {body or subject}) and name it in the causes of {beat_id} or of a beat "
        f"that leads to it, or take {driver_id} away"
    )


def behind(spec: WorldSpec, beat_id: str) -> list[str]:
    """A beat and all that lead to it by their causes."""
    beats = spec.story.beats
    found, left = [beat_id], list(beats[beat_id].causes)
    while left:
        name = left.pop()
        if name in beats and name not in found:
            found.append(name)
            left += beats[name].causes
    return found


def untold(spec: WorldSpec, beat_id: str) -> tuple[str, ...]:
    """Drivers of which no beat that leads to a beat tells; of a beat without causes, those that no beat owns.

    A medium at rest is none: it brings nothing about.
    """
    beats = spec.story.beats
    owners = {beats[n].owner for n in (behind(spec, beat_id) if beats[beat_id].causes else beats)}
    drivers = spec.simulation.drivers.items()
    return tuple(n for n, d in drivers if n not in owners and not (d.kind == "field" and d.field.kind == "drag"))


def undeclared(spec: WorldSpec, beat_id: str, until: float, bodies: tuple[str, ...] = ()) -> str | None:
    """A driver that acts on a body of an outcome before `until` [s] without owning a beat that leads to it; None where none does.

    An event without causes that a solver owns may start by any driver that some beat owns. Paths are judged by themselves.

    Args:
        spec: the specification.
        beat_id: the outcome.
        until: when it comes true [s].
        bodies: those asked about; default its subject, unless its own driver starts it.
    """
    beat = spec.story.beats[beat_id]
    if is_invariant(beat.predicate) and not beat.causes:
        return None
    if not bodies:
        if not beat.causes and beat.owner in spec.simulation.drivers:
            return None
        bodies = (beat.subject,)
    for name in untold(spec, beat_id):
        if isinstance(spec.simulation.drivers[name], PathDriver):
            continue
        start, entities = acts_from(spec, name)
        if set(bodies) & set(entities) and start < until:
            return name
    return None


def in_secret(spec: WorldSpec) -> dict[str, tuple[str, float]]:
    """Forces, motors, releases and detachments that no beat owns and that act within the film on a moving thing that the prompt names.

    What lets go at frame 0 only begins the film. A beat has one owner, so that it tells of all motors that drive the same body at the same time,
    as those of two wheels. Fields, paths and sources are judged by themselves.

    Returns:
        the first such entity and the time [s], by driver.
    """
    plan, found = spec.simulation, {}
    owners = {b.owner for b in spec.story.beats.values()}
    things = [n for n, c in spec.claims.items() if c.type == "thing" and c.waived is None]
    named = {
        e for n in things for e in named_in(spec, n, "entities") if e in spec.entities and spec.entities[e].motion != "static"
    }
    for name, driver in plan.drivers.items() if named else ():
        if name in owners or not isinstance(driver, ForceDriver | MotorDriver | ReleaseDriver | DetachDriver):
            continue
        try:
            start, entities = acts_from(spec, name)
        except EvidenceError:
            continue  # a joint that is not there: the references tell of it
        at_once = start <= 0.0 and isinstance(driver, ReleaseDriver | DetachDriver)
        body = next((e for e in entities if e in named), None)
        told = isinstance(driver, MotorDriver) and any(_together(spec, name, other) for other in owners)
        if body is not None and not at_once and not told and start < plan.frames / plan.fps:
            found[name] = (body, start)
    return found


def _together(spec: WorldSpec, motor_id: str, other_id: str) -> bool:
    """True if two motors drive joints of one moving body during the same interval."""
    plan = spec.simulation
    motor, other = plan.drivers[motor_id], plan.drivers.get(other_id)
    if not isinstance(motor, MotorDriver) or not isinstance(other, MotorDriver) or other.joint not in plan.joints:
        return False
    shared = set(acts_from(spec, motor_id)[1]) & set(acts_from(spec, other_id)[1])
    moving = any(e in spec.entities and spec.entities[e].motion != "static" for e in shared)
    return moving and (motor.start, motor.end) == (other.start, other.end)

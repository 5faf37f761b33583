"""Who brings a beat about: a solver, from causes or from a start that the story owns (R97, R156)?

Row `beat:driven:<id>` fails

- an outcome that follows an authored path, or a part of which does, which is staged;
- an outcome on whose bodies a driver acts that no beat leading to it owns;
- an outcome without causes whose owner is a force that adds next to nothing to the velocity with which its subject starts;
- an outcome whose bodies a loaded spring, a body on a path or a driver helps along, also through others, of which no beat leading to it
  tells (`agency.py`);
- a beat without causes that nothing of the story starts. What starts it is a driver that some beat owns, a velocity that the
  specification gives at frame 0 to an entity of the beat, or weight: an entity of the beat that moves from frame 0 on, without a rest
  up to the frame at which the beat comes true. A lasting state without causes needs no start.

A trigger on a path (a beat without causes that its path driver owns and that others follow from) has no row.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.candidate import Candidate
from ...worlds.drivers import acts_from, deed, to_declare, undeclared
from ...worlds.errors import EvidenceError
from ...worlds.predicates import entities_of
from ...worlds.predicates.registry import is_invariant
from ...worlds.spec import ForceDriver, PathDriver
from ..categories.registry import judge_of
from ..predicates.evaluators import beat_times
from ..rows.answers import row_of
from ..rows.corrections import correction, set_value
from ..rows.findings import Finding
from .agency import Help, helped
from .bodies import acting_atoms, involved, moved_bodies, moves_by_declaration
from .bounds import OWNED
from .chains import PAUSE
from .offers import owning, take_away
from .questions import DRIVEN

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...worlds.requirements import Correction, Row, Status
    from ...worlds.spec import Beat, WorldSpec

__all__ = ["check_driven"]


class _Start(NamedTuple):
    """Start of a beat: what brings it about, or why nothing does."""

    status: Status
    text: str
    kind: str
    """Kind of the trigger or fault: `path`, `unsaid`, `helped`, `late`, `idle`, `none`; or `causes`, `state`, `driver`, `velocity`, `weight`, `unknown`."""
    first: str | None = None
    driver: str | None = None
    help: Help | None = None


def check_driven(candidate: Candidate, beat_id: str) -> list[Row]:
    """The row of one beat; none for a trigger on a path."""
    beat, plan = candidate.spec.story.beats[beat_id], candidate.spec.simulation
    followed = any(beat_id in b.causes for b in candidate.spec.story.beats.values())
    owner = plan.drivers.get(beat.owner)
    if isinstance(owner, PathDriver) and not beat.causes and followed:
        return []  # an authored input: a trigger, not an outcome; a path from which nothing follows is an outcome
    start = _start(candidate, beat_id, beat)
    found = Finding(
        start.status,
        start.text,
        entity=start.first,
        frame=0,
        hints=tuple(_hints(candidate.spec, beat_id, beat, start)) if start.status == "fail" else (),
        evidence={
            "owner": beat.owner,
            "trigger": start.kind,
            **({"driver": start.driver} if start.driver else {}),
            **({"helper": start.help._asdict()} if start.help else {}),
            "pointers": [f"/story/beats/{beat_id}/owner"],
        },
        extra=[beat.model_dump(mode="json"), sorted(_authored(candidate.spec)), start.kind],
    )
    question = replace(DRIVEN, mandatory=beat.mandatory)
    return [row_of(candidate, question, (beat_id,), found, entities=(beat.subject,), artifact="world.json")]


def _authored(spec: WorldSpec) -> set[str]:
    """Entities whose motion is keyframed."""
    paths = {d.entity for d in spec.simulation.drivers.values() if isinstance(d, PathDriver)}
    return {n for n, e in spec.entities.items() if e.motion == "kinematic"} | paths


def _start(candidate: Candidate, beat_id: str, beat: Beat) -> _Start:
    spec, bodies = candidate.spec, moved_bodies(candidate.spec, beat)
    staged = _staged(spec, beat_id, beat)
    if staged is not None:
        return staged
    owned = None
    if beat.owner in spec.simulation.drivers and not beat.causes:
        owned = _owned(candidate, beat_id, beat)
        if owned.status == "pass":
            bodies = tuple(n for n in bodies if n != beat.subject and n not in acts_from(spec, beat.owner)[1])
        if owned.status != "pass" or not bodies:
            return owned
    until = _comes(candidate, beat_id, seen=True)
    helper = undeclared(spec, beat_id, until / spec.simulation.fps, bodies)
    if helper is not None:
        owns = "no beat that leads to it is owned by" if beat.causes else "no beat is owned by"
        body = next(n for n in bodies if n in acts_from(spec, helper)[1])
        text = f"{deed(spec, helper, body)}, before {beat_id} comes true, and {owns} {helper}"
        return _Start("fail", text, "unsaid", body, helper)
    try:
        help_ = helped(candidate, beat_id, until, bodies)
    except EvidenceError as error:
        return _Start("unverified", f"whether something else helps {beat_id} along is not known: {error}", "unknown")
    if help_ is not None:
        return _Start("fail", _help_text(help_, beat_id), "helped", help_.body, help=help_)
    if owned is not None:
        return owned
    if beat.causes:
        return _Start("pass", f"{beat.subject} is moved by a solver, from {', '.join(beat.causes)}", "causes")
    if is_invariant(beat.predicate):
        return _Start("pass", f"a lasting state of {beat.subject}, which needs no start", "state")
    return _started(candidate, beat_id, beat)


def _help_text(found: Help, beat_id: str) -> str:
    first, *later = found.through
    way = f", which passes it on to {' and on to '.join(map(repr, later))}" if later else ""
    deed = f"does {found.work:.3g} J of work on {first!r}"
    if found.friction is not None:
        deed = f"bears {first!r} where its surface would rub, and spares it {found.work:.3g} J"
    return (
        f"{found.helper} {deed} by the time {beat_id} comes true, {found.share:.2g} times the kinetic "
        f"energy that {first!r} ever had, from frame {found.frame} on{way}; no beat that leads to {beat_id} tells of it"
    )


def _staged(spec: WorldSpec, beat_id: str, beat: Beat) -> _Start | None:
    entities, authored = spec.entities, _authored(spec)
    told = [entities_of(beat.predicate), *(entities_of(atom) for atom in acting_atoms(beat.predicate))]
    moving = [[n for n in names if n in entities and entities[n].motion != "static"] for names in told]
    culprits = [beat.subject] if beat.subject in authored else next((m for m in moving if m and set(m) <= authored), [])
    if not culprits:
        return None
    paths = {d.entity: name for name, d in spec.simulation.drivers.items() if isinstance(d, PathDriver)}
    driver = paths.get(culprits[0])
    how = f"path driver {driver}" if driver else "an authored motion"
    part = "beat" if culprits[0] == beat.subject else "its part in beat"
    return _Start("fail", f"{culprits[0]} follows {how}, so {part} {beat_id} is staged", "path", culprits[0], driver)


def _owned(candidate: Candidate, beat_id: str, beat: Beat) -> _Start:
    """A beat without causes that a driver owns: that driver must have acted by the time."""
    spec = candidate.spec
    try:
        time, _ = acts_from(spec, beat.owner)
    except EvidenceError as error:
        return _Start("unverified", str(error), "unknown")
    first = beat_times(candidate).first(beat_id)
    at = f"driver {beat.owner} acts from {time:g} s on"
    if first is not None and time * spec.simulation.fps > first + 1e-9:
        text = f"{beat_id} comes true at frame {first}, before its driver acts: {at}, which is frame {time * spec.simulation.fps:.3g}"
        return _Start("fail", text, "late", beat.subject, beat.owner)
    weak = _idle_force(candidate, beat_id, beat)
    if weak is not None:
        return _Start("fail", weak, "idle", beat.subject, beat.owner)
    return _Start("pass", f"{at} and owns {beat_id}", "driver", None, beat.owner)


def _idle_force(candidate: Candidate, beat_id: str, beat: Beat) -> str | None:
    """Why a force that owns a beat does not bring it about: its subject starts with a velocity, to which the force adds next to nothing."""
    spec, driver = candidate.spec, candidate.spec.simulation.drivers[beat.owner]
    physics = spec.entities[beat.subject].physics
    speed = float(np.linalg.norm(getattr(physics, "linear_velocity", (0.0, 0.0, 0.0))))
    if (
        not isinstance(driver, ForceDriver)
        or driver.entity != beat.subject
        or speed == 0.0
        or beat.subject not in candidate.built
    ):
        return None
    until = min(driver.end, _comes(candidate, beat_id) / spec.simulation.fps)
    mass = sum(b.mass for b in candidate.entity(beat.subject).bodies)
    given, had = float(np.linalg.norm(driver.force)) * max(0.0, until - driver.start), mass * speed
    if given >= OWNED * had:
        return None
    return (
        f"{beat.subject} starts with {speed:.3g} m/s, a momentum of {had:.3g} N s, to which {beat.owner} adds {given:.3g} N s by the time {beat_id} "
        "comes true: an initial state, not the force, brings it about"
    )


def _comes(candidate: Candidate, beat_id: str, *, seen: bool = False) -> int:
    """Frame at which a beat comes true; where it does not, the last of its interval.

    `seen`: no later than the last frame that is simulated. In a run that goes on the beat may yet come true before what acts later.
    """
    first = beat_times(candidate).outcome(beat_id).first_true_frame
    if first is not None:
        return first
    last = candidate.spec.story.beats[beat_id].frames[1]
    return min(last, candidate.last_frame) if seen else last


def _started(candidate: Candidate, beat_id: str, beat: Beat) -> _Start:
    """The start of an event that names no causes: a driver, a velocity, or weight."""
    spec, names, frame = candidate.spec, involved(candidate.spec, beat), _comes(candidate, beat_id)
    owned = {b.owner: n for n, b in spec.story.beats.items()}
    unsaid = None
    for driver, declared in spec.simulation.drivers.items():
        if declared.kind == "field" and declared.field.kind == "drag":
            continue  # a medium at rest brings nothing about
        try:
            time, acted = acts_from(spec, driver)
        except EvidenceError as error:
            return _Start("unverified", str(error), "unknown")
        if time * spec.simulation.fps > frame or not set(acted) & set(names):
            continue
        if driver in owned:
            return _Start(
                "pass", f"driver {driver}, which beat {owned[driver]} owns, acts from {time:g} s on", "driver", None, driver
            )
        unsaid = unsaid or driver
    sent = next((n for n in names if moves_by_declaration(spec, n)), None)
    if sent is not None:
        return _Start(
            "pass", f"an initial state: {sent} starts with the velocity that the specification gives it", "velocity", sent
        )
    outcome = beat_times(candidate).outcome(beat_id)
    if outcome.status == "unverified":
        return _Start("unverified", f"whether it starts by itself is not known: {outcome.explanation}", "unknown")
    try:
        falls = next((n for n in names if spec.entities[n].motion == "dynamic" and _goes_from_start(candidate, n, frame)), None)
    except EvidenceError as error:
        return _Start("unverified", str(error), "unknown")
    if falls is not None:
        text = f"an initial state: {falls} is in motion from frame 0 up to frame {frame} without a rest, by its weight and what touches it there"
        return _Start("pass", text, "weight", falls)
    text = f"beat {beat_id!r} has no cause and nothing that the story owns starts it"
    if unsaid is not None:
        text += (
            f": {deed(spec, unsaid, next(n for n in names if n in acts_from(spec, unsaid)[1]))}, and no beat is owned by {unsaid}"
        )
    else:
        text += f": no driver acts on {', '.join(names[:4])} by frame {frame}, none of them starts with a velocity, and none moves from frame 0 on"
    return _Start("fail", text, "none", beat.subject, unsaid)


def _goes_from_start(candidate: Candidate, name: str, frame: int) -> bool:
    """True if an entity moves from frame 0 on and does not rest, `PAUSE` long, before `frame`."""
    moves = judge_of(candidate.spec, name).moving(candidate, name)[: frame + 1]
    if not moves[:2].any():  # what is let go at frame 0 has no speed there yet
        return False
    still = np.concatenate([[0], np.cumsum(~moves[1:])])
    pause = max(1, round(PAUSE * candidate.spec.simulation.fps))
    return not bool((still[pause:] - still[:-pause] >= pause).any()) if len(still) > pause else True


def _hints(spec: WorldSpec, beat_id: str, beat: Beat, found: _Start) -> list[Correction]:
    place = f"/story/beats/{beat_id}"
    if found.kind == "path":
        driver = f"/simulation/drivers/{found.driver}" if found.driver else "/simulation/drivers"
        action = f"make {found.first} dynamic and bring it about by contact, a force, a motor or a release"
        pointers = (f"/entities/{found.first}/motion", driver)
        return [correction("a keyframed path moves the outcome itself", "drivers", action, pointers=pointers)]
    if found.kind == "unsaid" and found.driver is not None:
        pointers = (f"/simulation/drivers/{found.driver}", f"{place}/causes")
        cause = "a driver moves the outcome itself, and the story does not say so"
        silent = all(b.owner != found.driver for b in spec.story.beats.values())
        told = correction(cause, "drivers", to_declare(spec, found.driver, beat_id, found.first), pointers=pointers)
        return [told, take_away(spec, cause, pointers[0], beat_id, silent=silent)]
    if found.help is not None:
        return list(_without_help(spec, found.help, beat_id))
    if found.kind == "idle":
        owner = next((n for n, s in spec.simulation.solvers.items() if beat.subject in s.members), None)
        cause = "the driver that owns it does next to nothing to what moves already"
        place, patch = f"{place}/owner", () if owner is None else set_value(f"{place}/owner", owner)
        told = correction(cause, "story", f"let the solver own it: owner {owner}", pointers=(place,), patch=patch)
        weaker = f"/simulation/drivers/{found.driver}/force"
        return [told, correction(cause, "drivers", f"give {found.driver} the force that brings it about", pointers=(weaker,))]
    if found.kind == "late":
        pointers = (f"/simulation/drivers/{found.driver}", f"{place}/owner")
        action = f"let {found.driver} act before {beat_id} comes true, or let what does start it own the beat"
        return [correction("the driver that owns it acts too late to bring it about", "drivers", action, pointers=pointers)]
    hints = [
        correction(
            "the story does not say what brings it about",
            "story",
            f"name the beat that leads to {beat_id} in its causes",
            pointers=(f"{place}/causes",),
        ),
        correction(
            "what starts it is not in the story",
            "story",
            f"let the driver that starts it own the beat{f': owner {found.driver}' if found.driver else ''}",
            pointers=(f"{place}/owner",),
        ),
        correction(
            "nothing starts it",
            "initial_state",
            f"give {beat.subject}, or what meets it, a start velocity; or place it where it falls from frame 0 on",
            pointers=(f"/entities/{beat.subject}/physics/linear_velocity", f"/entities/{beat.subject}/pose"),
        ),
    ]
    return hints[1:] + hints[:1] if found.driver else hints


def _without_help(spec: WorldSpec, found: Help, beat_id: str) -> Iterator[Correction]:
    cause = "something that the story is silent about helps the outcome along"
    if found.pointer.startswith("/entities/"):
        name = found.pointer.split("/")[2]
        told = f"tell of it: a first beat about {name}, named in the causes of {beat_id} or of a beat that leads to it"
        yield correction(cause, "story", told, pointers=("/story/beats", f"/story/beats/{beat_id}/causes"))
        yield correction(cause, "initial_state", f"let {name} start elsewhere, or at rest", pointers=(found.pointer,))
        return
    kind, name = found.pointer.split("/")[-2:]
    if found.friction is not None:
        rub = f"give {name} the dry friction of the surfaces that it guides along each other, {found.friction:.3g} N"
        place = f"{found.pointer}/friction"
        yield correction(cause, "joints", rub, pointers=(place,), patch=set_value(place, float(f"{found.friction:.4g}")))
    silent = kind != "drivers" or all(b.owner != name for b in spec.story.beats.values())
    yield take_away(spec, cause, found.pointer, beat_id, silent=silent)
    if found.friction is not None:
        return
    told = (
        owning(name, beat_id, found.through[0])
        if kind == "drivers"
        else f"tell of it: a first beat about {found.through[0]}, owned by the driver that lets {name} act (a release, or the detach of what "
        f"holds it), named in the causes of {beat_id}"
    )
    yield correction(cause, "story", told, pointers=("/story/beats", f"/story/beats/{beat_id}/causes"))

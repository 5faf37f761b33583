"""The five phases of a run (R77, S12), found from the run itself and not from fixed frame numbers.

- preroll: the scene before anything acts. Covered by `simulation.preroll`, or by a frame 0 at which nothing moves but
  what the specification sets in motion there (a start velocity, a driver).
- activation: the first frame at which a driver acts, or a body, grains or cloth are faster than the scene's start speed.
- first contact: the first new contact after activation between entities that did not touch before: bodies, grains and bodies, cloth
  and solids (`story/phase_contacts.py`). Where there is none and the specification asks for none (no contact predicate, no `interacts`
  relation, no cause between different bodies), or where those who should meet touch from frame 0 on, as a lift and its load do, it does
  not apply; one that nothing asks for within `SPAN` of the end starts no response.
- peak response: frame of the largest kinetic energy from the first contact on; from activation where none is asked for and no bodies
  meet. What then goes on evenly to the end (`STEADY`), as in a stream, is at its peak from the frame on where that begins. What has most
  at the last frame is at its peak there when it goes on rightly, as a fall does.
- early settling: the first frame after the peak at which the kinetic energy is below `SETTLED` of it, or the last
  frame when it fell all through the last `FALLING` seconds, or when what moves there goes on rightly (`story/phase_ends.py`): a flight, a
  slide, a spin, a splash, what a driver keeps moving. Else the end of the last beat, unless the energy of bodies grows from nowhere.

Where no rigid body can move, what counts is the matter of the other instances: their largest speed and kinetic energy as recorded.
Where bodies could move and none does, the kinetic energy is that of grains and cloth.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.begun import unfinished
from ...worlds.drivers import acts_from
from ...worlds.errors import EvidenceError
from ...worlds.predicates.registry import is_invariant
from ...worlds.requirements import Correction, Row
from ...worlds.settled import settling
from ..categories.registry import judge_of
from ..ledgers import motion
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, halve_any_step, longer, set_value
from ..rows.findings import Finding
from .beat_corrections import still_moves
from .offers import let_meet
from .phase_contacts import asks_for_contact, carried_from_the_start, first_contact, promises
from .phase_ends import SPAN, ending
from .questions import PHASES_SHOWN

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Entity

__all__ = ["FALLING", "PHASES", "SETTLED", "START_SPEED", "Course", "Phases", "check", "find_phases"]

PHASES = ("preroll", "activation", "first_contact", "peak_response", "early_settling")
START_SPEED = 0.05
"""Own choice: a body is active when faster than this share of sqrt(g L), L the scene's vertical or smallest extent."""
SETTLED = 0.2
"""Own choice: settling has begun when the kinetic energy is below this share of its peak."""
FALLING = 0.25
"""[s] or has fallen for this long up to the end of the run."""
STEADY = 0.05
"""Own choice: share of the kinetic energy by which it may vary over that time where a stream carries bodies on evenly."""
NAMED = 3
"""Pairs that should meet and do not, named in a row."""
SMALL = 1e-3
"""[m/s] Least start speed, for tiny scenes and without gravity."""


class Course(Enum):
    """Course of the response to the first contact at the end of the run."""

    SETTLES = "settles"
    CARRIED_ON = "is carried on evenly, as by a stream"
    GOES_ON = "goes on by physics: a flight, a slide, a spin"
    GROWS = "gains energy from nowhere"


@dataclass(frozen=True)
class Phases:
    """Frame at which each phase is reached; None where the run does not show it."""

    preroll: int | None
    activation: int | None
    first_contact: int | None
    peak_response: int | None
    early_settling: int | None
    last_frame: int
    notes: dict[str, str] = field(default_factory=dict)
    """Sentence on each phase: how it was found, or why not."""
    entities: dict[str, str] = field(default_factory=dict)
    """Who marks each phase."""
    start_speed: float = 0.0
    """[m/s] above which a body counts as active."""
    touchless: bool = False
    """True if first contact does not apply: nothing new touches, and nothing in the specification asks for it."""
    course: Course | None = None
    """Motion at the end of the response; None where the run does not show it."""

    def applicable(self) -> tuple[str, ...]:
        """Phases that such a run has, in order."""
        return tuple(p for p in PHASES if p != "first_contact" or not self.touchless)

    def missing(self) -> tuple[str, ...]:
        """Phases that the run does not cover, in order."""
        return tuple(p for p in self.applicable() if getattr(self, p) is None)


def find_phases(candidate: Candidate) -> Phases:
    """Locate the phases in a probe or a bake.

    Raises:
        EvidenceError: nothing is simulated, or a channel is missing.
    """
    if not candidate.caches:
        raise EvidenceError("no simulated frames: probe first")
    last = candidate.last_frame
    names = sorted({b.split("/", 1)[0] for c in candidate.rigid_caches.values() for b in c.index.bodies}) or list(
        _matter(candidate)
    )
    threshold = _start_speed(candidate)
    notes, who = {}, {}
    moved, starter, how = _activation(candidate, names, threshold)
    activation, loose = moved, [n for n in _loose(candidate) if n not in names]
    if loose and moved != 0:
        first, other, told = _activation(candidate, loose, threshold)
        if first is not None and (moved is None or first < moved):
            activation, starter, how = first, other, told
    notes["activation"] = how
    if starter:
        who["activation"] = starter
    preroll = _preroll(candidate, names, activation, threshold, notes)
    asked, met = asks_for_contact(candidate), None
    if activation is not None:
        met = first_contact(candidate, activation, moved)
        notes["first_contact"] = _unmet(candidate, activation) if met is None else met.text
    if met is not None:
        who["first_contact"] = met.mover
    contact = None if met is None else met.frame
    still = bool(loose) and all((_speeds(candidate, n) <= threshold).all() for n in names)
    energy = _kinetic(candidate, loose if still else [])
    carried = carried_from_the_start(candidate, activation) if asked and activation is not None and met is None else ""
    touchless = activation is not None and contact is None and (not asked or bool(carried))
    # What sand or a sheet touches unasked is no blow that a response follows; nor is what meets unasked as the run ends.
    late = met is not None and met.frame > last - max(1, round(SPAN * candidate.spec.simulation.fps))
    unasked = touchless or (met is not None and not asked and (met.pressed or late))
    if touchless:
        notes["first_contact"] = carried or f"{notes['first_contact']}, and no beat, relation or cause asks for one"
    start = activation if unasked else contact
    peak, settling, course = (None, None, None) if start is None else _response(candidate, energy, start, notes, unasked=unasked)
    return Phases(preroll, activation, contact, peak, settling, last, notes, who, threshold, touchless, course)


def _start_speed(candidate: Candidate) -> float:
    low, high = motion.scene_box(candidate)
    gravity = float(np.linalg.norm(candidate.spec.simulation.gravity))
    extent = float(np.median(high - low))
    return max(SMALL, START_SPEED * min(1.0, float(np.sqrt(gravity * extent))))


def _matter(candidate: Candidate) -> dict[str, Cache]:
    """Instance of each entity that is no rigid body and moves by an engine."""
    others = [c for n, c in candidate.caches.items() if n not in candidate.spec.simulation.rigid]
    return {member: cache for cache in others for member in candidate.spec.simulation.solvers[cache.index.solver].members}


def _loose(candidate: Candidate) -> list[str]:
    """Grains, flying particles and cloth: what moves and meets others beside bodies."""
    return [n for n in _matter(candidate) if judge_of(candidate.spec, n).meets]


def _speeds(candidate: Candidate, name: str) -> F64:
    return judge_of(candidate.spec, name).fastest(candidate, name)


def _activation(candidate: Candidate, names: list[str], threshold: float) -> tuple[int | None, str, str]:
    """First frame at which anything acts or moves, who, and how it was found."""
    plan = candidate.spec.simulation
    best, starter, how = None, "", "nothing moves"
    for driver in plan.drivers:
        time, entities = acts_from(candidate.spec, driver)
        frame = int(np.floor(time * plan.fps + 1e-9))
        if frame <= candidate.last_frame and (best is None or frame < best):
            best, starter, how = frame, (entities or ("",))[0], f"driver {driver} acts at {time:.3f} s"
    for name in names:
        fast = np.flatnonzero(~(_speeds(candidate, name) <= threshold))
        if len(fast) and (best is None or fast[0] < best):
            best, starter, how = int(fast[0]), name, f"{name} moves faster than {threshold:.3g} m/s"
    return best, starter, how


def _preroll(
    candidate: Candidate, names: list[str], activation: int | None, threshold: float, notes: dict[str, str]
) -> int | None:
    """Frame 0 when the scene is known to be at rest there, but for what the specification itself sets in motion."""
    plan = candidate.spec.simulation
    if plan.preroll > 0:
        notes["preroll"] = f"{plan.preroll:g} s simulated before frame 0"
        return 0
    if settled := [n for n in names if n in settling(candidate.spec)]:
        notes["preroll"] = f"{len(settled)} settled before frame 0"
    stray = [n for n in names if not _speeds(candidate, n)[0] <= threshold and not _sent(candidate, n)]
    if stray:
        notes["preroll"] = f"{stray[0]} moves at frame 0 without being told to, and simulation.preroll is 0"
        return None
    if settled:
        return 0
    notes["preroll"] = (
        "quiet throughout" if activation is None else f"nothing but the specified start moves before frame {activation}"
    )
    return 0


def _sent(candidate: Candidate, name: str) -> bool:
    """True if the specification gives the entity a velocity at frame 0 or a driver."""
    entity = candidate.spec.entities[name]
    return _thrown(entity) or any(name in acts_from(candidate.spec, d)[1] for d in candidate.spec.simulation.drivers)


def _thrown(entity: Entity) -> bool:
    """True if the specification gives it a velocity at frame 0."""
    speeds = [getattr(entity.physics, n, ()) for n in ("linear_velocity", "angular_velocity")]
    return any(any(v) for v in speeds) or bool(getattr(entity.physics, "currents", None))


def _unmet(candidate: Candidate, activation: int) -> str:
    """That nothing met, and who should have."""
    pairs = sorted({" and ".join(sorted(p.entities)) for p in promises(candidate.spec)})
    told = f" between {'; '.join(pairs[:NAMED])}" if pairs else ""
    return f"no new contact{told} after frame {activation}"


def _kinetic(candidate: Candidate, loose: list[str]) -> F64:
    """Kinetic energy of bodies [J], shape (frames,); of all matter where there are none, of the `loose` where no body moves."""
    total = np.zeros(candidate.frame_count)
    for cache in candidate.rigid_caches.values():
        total += motion.kinetic_energy(candidate, cache)[: candidate.frame_count].sum(axis=1)
    matter = _matter(candidate)
    bodies = any(c.index.bodies for c in candidate.rigid_caches.values())
    counted = [matter[n] for n in loose] if bodies else list(matter.values())
    for cache in {id(c): c for c in counted}.values():
        total += cache.series("record/kinetic_energy")[: candidate.frame_count]
    if not np.isfinite(total).all():
        raise EvidenceError(f"kinetic energy is not finite at frame {int(np.argmax(~np.isfinite(total)))}")
    return total


def _steady(candidate: Candidate, energy: F64, start: int) -> int | None:
    """First frame from which on bodies that nothing meets keep their kinetic energy; None where they gain to the end."""
    last = candidate.last_frame
    near = np.abs(energy - energy[last]) <= STEADY * energy[last]
    apart = np.flatnonzero(~near[: last + 1])
    first = max(start, int(apart[-1]) + 1 if len(apart) else 0)
    return first if last - first >= max(1, round(FALLING * candidate.spec.simulation.fps)) else None


def _response(
    candidate: Candidate, energy: F64, start: int, notes: dict[str, str], *, unasked: bool
) -> tuple[int | None, int | None, Course | None]:
    """Frames of the peak and of the settling of the response that starts at a frame, and how it ends."""
    last = candidate.last_frame
    peak = start + int(np.argmax(energy[start : last + 1]))
    notes["peak_response"] = f"kinetic energy {energy[peak]:.3g} J"
    if peak == last and unasked and (steady := _steady(candidate, energy, start)) is not None:
        notes["peak_response"] = f"carried on evenly from frame {steady} to the last, with {energy[last]:.3g} J"
        notes["early_settling"] = notes["peak_response"]
        return steady, last, Course.CARRIED_ON
    goes = ending(candidate, energy, start)
    if peak == last:
        notes["peak_response"] = f"kinetic energy is largest at the last frame {last}" + (
            "" if goes is None else f": {goes.text}"
        )
        if goes is None or not goes.goes_on:
            return None, None, None if goes is None else Course.GROWS
    elif goes is not None and not goes.goes_on and not set(candidate.caches) - set(candidate.rigid_caches):
        # A swing that grows is slow at its ends too. Of other matter not all that it exchanges is in these sums.
        notes["early_settling"] = goes.text
        return peak, None, Course.GROWS
    if (settled := _settled(candidate, energy, peak)) is not None:
        frame, notes["early_settling"] = settled
        return peak, frame, Course.SETTLES
    if goes is not None and goes.goes_on:
        notes["early_settling"] = goes.text
        return peak, last, Course.GOES_ON
    end = max((b.frames[1] for b in candidate.spec.story.beats.values()), default=None)
    if end is not None and peak <= end <= last:
        notes["early_settling"] = f"the last beat ends at frame {end}"
        return peak, end, Course.SETTLES
    share = energy[last] / energy[peak]
    notes["early_settling"] = f"kinetic energy is still {share:.0%} of its peak at the last frame {last}"
    return peak, None, None


def _settled(candidate: Candidate, energy: F64, peak: int) -> tuple[int, str] | None:
    """Frame at which the kinetic energy shows that the response settles, and how; None where it does not."""
    last, span = candidate.last_frame, max(1, round(FALLING * candidate.spec.simulation.fps))
    quiet = np.flatnonzero(energy[peak:] <= SETTLED * energy[peak])
    if len(quiet):
        return peak + int(quiet[0]), f"kinetic energy below {SETTLED:.0%} of its peak"
    if last - peak >= span and bool((np.diff(energy[last - span : last + 1]) <= 0).all()):
        return last, f"kinetic energy has fallen for {FALLING:g} s"
    return None


@guarded(PHASES_SHOWN)
def check(candidate: Candidate) -> list[Row]:
    """Row `probe:phases`: all five phases lie within the simulated frames."""
    phases = find_phases(candidate)
    extra = None if phases.activation is None and _meant_to_rest(candidate) else candidate.spec.simulation.frames
    return [row_of(candidate, PHASES_SHOWN, (), _finding(candidate, phases), extra=extra)]


def _finding(candidate: Candidate, phases: Phases) -> Finding:
    """Finding on the phases that are shown; `not_applicable` where everything is meant to rest, and does."""
    measures = {"start_speed": phases.start_speed, "notes": phases.notes}
    if phases.activation is None and _meant_to_rest(candidate):
        text = f"nothing is driven or thrown, every beat asks for rest, and no body exceeds {phases.start_speed:.3g} m/s: no phase to cover"
        return Finding("not_applicable", text, evidence=measures)
    missing, applicable, who = phases.missing(), phases.applicable(), tuple(phases.entities.values())
    frames = {p: getattr(phases, p) for p in PHASES}
    measures |= {"phases": frames, "entities": phases.entities}
    counts = float(len(applicable) - len(missing)), float(len(applicable))
    if not missing:
        text = ", ".join(f"{p.replace('_', ' ')} at frame {frames[p]}" for p in applicable)
        text += f"; {phases.notes['first_contact']}" if phases.touchless else ""
        text += f"; {phases.notes['early_settling']}" if phases.course is Course.GOES_ON else ""
        return Finding("pass", text, *counts, evidence=measures, entities=who)
    why = phases.notes.get(missing[0], "the phase before it is missing")
    grows, more = phases.course is Course.GROWS, _more_frames(candidate, phases)
    return Finding(
        "unverified" if unfinished(candidate) else "fail",
        f"no {missing[0].replace('_', ' ')} within frames 0..{phases.last_frame}: {why}",
        *counts,
        entity=next(iter(reversed(who)), None),
        frame=phases.last_frame,
        hints=tuple(_blown_up() if grows else _hints(candidate, missing[0], more)),
        evidence={**measures, "missing": list(missing), "more_frames": more, "grows": int(grows)},
        entities=who,
    )


def _meant_to_rest(candidate: Candidate) -> bool:
    """True if the specification sets nothing in motion and asks for nothing but lasting states."""
    spec = candidate.spec
    thrown = any(_thrown(e) for e in spec.entities.values())
    return not thrown and not spec.simulation.drivers and all(is_invariant(b.predicate) for b in spec.story.beats.values())


def _more_frames(candidate: Candidate, phases: Phases) -> int:
    """Frames to add: up to the last beat's end where the probe stops short of it, else one second."""
    end = max((b.frames[1] for b in candidate.spec.story.beats.values()), default=0)
    second = candidate.spec.simulation.fps
    return max(end - phases.last_frame, second if end <= phases.last_frame else 1)


def _goes_on(candidate: Candidate) -> bool:
    """True if anything still moves at the end, or a driver or beat is yet to come; waiting brings nothing else."""
    spec, last = candidate.spec, candidate.last_frame
    bodies = [n for n, e in spec.entities.items() if e.motion != "static"]
    due = any(b.frames[1] > last for b in spec.story.beats.values())
    later = any(d.begins * spec.simulation.fps > last for d in spec.simulation.drivers.values())
    return due or later or still_moves(candidate, bodies)


def _blown_up() -> list[Correction]:
    return [halve_any_step("energy grows at the end and no driver feeds it: the solver may diverge", "; more frames do not help")]


def _hints(candidate: Candidate, phase: str, more: int) -> list[Correction]:
    if phase == "preroll":
        return [
            correction(
                "bodies move from frame 0 on without being told to: the scene is not at rest",
                "interval",
                "give it 0.5 s of preroll to settle",
                pointers=("/simulation/preroll",),
                patch=set_value("/simulation/preroll", 0.5),
            ),
            correction("bodies start in the air or overlap", "placement", "put them on their supports", pointers=("/entities",)),
        ]
    planned = candidate.spec.simulation.frames
    total = candidate.last_frame + 1 + more
    wait = correction(
        "the run is too short" if phase != "activation" else "nothing acts within the run",
        "interval",
        f"simulate {more} more frames, to frame {total - 1}",
        pointers=("/simulation/frames",),
        patch=longer(candidate.spec, total) if total > planned and _goes_on(candidate) else (),
    )
    act = correction(
        "nothing sets the scene in motion",
        "drivers",
        "let a driver act earlier, or give a body a start velocity",
        pointers=("/simulation/drivers",),
    )
    meet = let_meet("/entities", "the bodies that should meet pass each other")
    if phase == "first_contact":
        due = any(b.frames[1] > candidate.last_frame for b in candidate.spec.story.beats.values())
        return [wait, meet] if due else [meet, wait]
    return [act, wait] if phase == "activation" else [wait]

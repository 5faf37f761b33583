"""Corrections of a beat or requirement that fails, from the measured values."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.candidate import Candidate
from ...worlds.predicates import atoms_of, entities_of
from ...worlds.predicates.registry import is_invariant
from ..categories.fracture.corrections import breaking
from ..categories.registry import judged
from ..predicates.evaluators import evaluate
from ..predicates.outcome import Outcome, vector
from ..rows.corrections import correction, halve_any_step, longer, set_value
from .bounds import MORE, SETTLING_FRAMES, STARTED
from .offers import faster, let_meet, offered
from .push_corrections import pushing

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from ...worlds.spec import SpecModel

__all__ = ["corrections_of", "happens_at", "still_moves"]

LASTING = frozenset({"flutters"})
"""Kinds that an interval as a whole makes true, not one of its frames."""


def corrections_of(
    candidate: Candidate, predicate: SpecModel, outcome: Outcome, pointer: str, frames: tuple[int, int]
) -> list[Correction]:
    """Ranked corrections from what was measured.

    Args:
        candidate: what was judged.
        predicate: what is asked.
        outcome: its outcome.
        pointer: place of the beat or requirement in the specification.
        frames: its interval.
    """
    if outcome.status != "fail":
        return []
    entity = outcome.first_failing_entity or next(iter(entities_of(predicate)), None)
    details = dict(outcome.details)
    if isinstance(details.get("nearest"), dict):
        details |= details["nearest"]
    if details.get("non_finite"):
        return [halve_any_step("the solver diverged", " and look at the contacts before the first frame that is not finite")]
    found = _timing(candidate, predicate, outcome, pointer, frames)
    if outcome.unit == "cycles":
        found += _longer(candidate, outcome, pointer)
    judge = None if entity is None else judged(candidate.spec).get(entity)
    if entity is None or judge is None:
        return found
    found += judge.beat_corrections(candidate, entity, outcome, details)
    if judge.body:  # where it starts and how fast decides where it goes
        broken = breaking(candidate, predicate, entity, outcome, details, pointer)
        short = pushing(candidate, predicate, entity, outcome, details) if broken is None else None
        found += broken or short or _aim(candidate, entity, outcome, details)
    return found


def _timing(
    candidate: Candidate, predicate: SpecModel, outcome: Outcome, pointer: str, frames: tuple[int, int]
) -> list[Correction]:
    late = happens_at(candidate, predicate, frames)
    found = []
    if late is not None:
        gap = late - frames[1] if late > frames[1] else frames[0] - late
        when = "after the interval ends" if late > frames[1] else "before it begins"
        moved = [*_moved(frames, late)]
        found.append(
            offered(
                candidate.spec,
                f"it does happen, at frame {late}, {gap} frames {when}",
                "story",
                f"plan the beat for frames {moved}, or bring it about {gap} frames {'earlier' if late > frames[1] else 'later'}",
                pointers=(f"{pointer}/frames",),
                patch=({"op": "replace", "path": f"{pointer}/frames", "value": moved},),
            )
        )
    if late is None and _under_way(candidate, predicate, outcome):
        nearest = outcome.details.get("largest_frame", outcome.details.get("frame"))
        more = max(1, candidate.spec.simulation.fps)
        total = candidate.spec.simulation.frames + more
        found.append(
            offered(
                candidate.spec,
                f"it was nearest at frame {nearest}, and the run ends at frame {candidate.last_frame}: perhaps it is still under way",
                "interval",
                f"simulate {more} more frames, to frame {total - 1}, and see whether it comes true",
                pointers=("/simulation/frames", f"{pointer}/frames"),
                patch=longer(candidate.spec, total),
            )
        )
    return found


def _longer(candidate: Candidate, outcome: Outcome, pointer: str) -> list[Correction]:
    """More frames for what goes to and fro fast enough, but not as often as asked."""
    plan, (first, until) = candidate.spec.simulation, outcome.frames
    if not outcome.value or outcome.bound is None or until <= first:
        return []
    last, rate = plan.frames - 1, outcome.value * plan.fps / (until - first)
    end = first + math.ceil(MORE * outcome.bound / rate * plan.fps)
    cause = f"the interval is short: at {rate:.3g} Hz {outcome.bound:g} cycles take {end - first} frames with some to spare"
    if end > last:
        return [
            correction(
                cause,
                "interval",
                f"simulate to frame {end}, and let the interval last as long",
                pointers=("/simulation/frames", f"{pointer}/frames"),
                patch=(*longer(candidate.spec, end + 1), {"op": "replace", "path": f"{pointer}/frames", "value": [first, end]}),
            )
        ]
    frames = [first, end]
    return [
        offered(
            candidate.spec,
            cause,
            "story",
            f"plan it for frames {frames}",
            pointers=(f"{pointer}/frames",),
            patch=({"op": "add", "path": f"{pointer}/frames", "value": frames},),
        )
    ]


def happens_at(candidate: Candidate, predicate: SpecModel, frames: tuple[int, int]) -> int | None:
    """Frame outside its interval at which an event comes true; None where it does not, or is a state that lasts.

    None also where an interval that reaches to that frame would not make it true: of what is asked `when=end` only the last counts.
    """
    if is_invariant(predicate) or frames == (0, candidate.last_frame):
        return None
    if any(getattr(a, "kind", "") in LASTING for a in atoms_of(predicate)):
        return None
    at = evaluate(candidate, predicate, (0, candidate.last_frame)).first_true_frame
    if at is None or frames[0] <= at <= frames[1]:
        return None
    return at if evaluate(candidate, predicate, _moved(frames, at)).status == "pass" else None


def _moved(frames: tuple[int, int], at: int) -> tuple[int, int]:
    """The interval that reaches to a frame outside of it."""
    return min(frames[0], at), max(frames[1], at)


def _under_way(candidate: Candidate, predicate: SpecModel, outcome: Outcome) -> bool:
    """True if an event came nearest where the run ends."""
    nearest = outcome.details.get("largest_frame", outcome.details.get("frame"))
    if not isinstance(nearest, int) or outcome.comparison == "" or getattr(predicate, "when", "") == "end":
        return False
    angle = outcome.details.get("largest_angle")
    if isinstance(angle, float) and outcome.bound and angle < STARTED * outcome.bound:
        return False
    return nearest >= candidate.last_frame - SETTLING_FRAMES and still_moves(candidate, entities_of(predicate))


def still_moves(candidate: Candidate, names: Iterable[str]) -> bool:
    """True if any of these bodies still comes on at the end; what is no body may."""
    spec, last = candidate.spec, candidate.last_frame
    bodies = [n for n in names if n in spec.entities and spec.entities[n].physics.shape == "solid"]
    first, drift = max(0, last - SETTLING_FRAMES), spec.simulation.limits.support_drift
    ways = [float(np.linalg.norm(candidate.center(n, last) - candidate.center(n, first))) for n in bodies]
    return not ways or max(ways) > drift


def _too_fast(candidate: Candidate, entity: str, after: int) -> Correction:
    """Correction for an entity that goes through a region between two frames and is in it at neither."""
    way = float(np.linalg.norm(candidate.center(entity, after + 1) - candidate.center(entity, after)))
    return correction(
        f"{entity} goes through the region between frames {after} and {after + 1}, {way:.3g} m apart",
        "story",
        f"give the region at least {MORE * way:.2g} m along its way (a weakening), or ask for `contact`, which is noted at every step",
        pointers=("/graph/regions",),
    )


def _aim(candidate: Candidate, entity: str, outcome: Outcome, details: dict[str, object]) -> list[Correction]:
    """Corrections for a body that does not get where it is asked to, by what was measured."""
    offset, distance, angle = (details.get(n) for n in ("offset", "distance", "largest_angle"))
    if isinstance(after := details.get("passes_after_frame"), int):
        return [_too_fast(candidate, entity, after)]
    if isinstance(offset, list) and isinstance(distance, float) and distance:
        return _nearer(candidate, entity, [-float(c) for c in offset], distance)
    if outcome.unit == "N s" and outcome.bound and outcome.value is not None and outcome.comparison == ">=":
        return _harder(entity, outcome.value, outcome.bound)
    if isinstance(angle, float) and outcome.bound:
        return _farther_over(entity, angle, outcome.bound)
    start, speed = f"/entities/{entity}/pose/position", f"/entities/{entity}/physics/linear_velocity"
    told = f"measured {_number(outcome.value)} against {_number(outcome.bound)} {outcome.unit}"
    action = f"change {entity}'s start speed or what drives it; {told}"
    return [correction("start conditions do not bring it about", "initial_state", action, pointers=(speed, start))]


def _nearer(candidate: Candidate, entity: str, shift: list[float], distance: float) -> list[Correction]:
    """Move the start by what is missing along the world's axes [m], or change speed and direction."""
    start, speed = f"/entities/{entity}/pose/position", f"/entities/{entity}/physics/linear_velocity"
    words = f"{vector(np.array(shift))} m along the world's axes"
    position = candidate.spec.entities[entity].pose.position
    value = [round(p + s, 6) for p, s in zip(position, shift, strict=True)]
    action = f"move its start by {words}; where a throw or slope magnifies the start, by less"
    aim = f"aim {entity} so that it arrives {words} from there"
    return [
        correction(f"{entity} misses by {distance:.3g} m", "placement", action, pointers=(start,), patch=set_value(start, value)),
        correction("its speed or direction is off", "initial_state", aim, pointers=(speed,)),
    ]


def _harder(entity: str, impulse: float, asked: float) -> list[Correction]:
    """Make an impact stronger than the measured impulse [N s]."""
    place, weak = f"/entities/{entity}", "the impact is too weak"
    faster = f"raise the closing speed: {f'{asked / impulse:.2g} times the' if impulse > 0 else 'more'} impulse is needed"
    heavier = f"make {entity} or what hits it heavier"
    return [
        correction(weak, "initial_state", faster, pointers=(f"{place}/physics/linear_velocity",)),
        correction(weak, "mass", heavier, pointers=(f"{place}/physics/mass",)),
        let_meet(f"{place}/pose/position", "they may not meet at all"),
    ]


def _farther_over(entity: str, angle: float, asked: float) -> list[Correction]:
    """Make a body turn farther than the measured angle [rad]."""
    place = f"/entities/{entity}"
    weak = f"{entity} turns {angle:.2g} of {asked:.2g} rad: the push is too weak or too low"
    closer = f"bring what hits {entity} closer and higher up"
    return [
        faster(entity, weak),
        correction("nothing reaches it, or too low", "placement", closer, pointers=(f"{place}/pose/position",)),
        correction(
            "it is too heavy or too wide to fall",
            "dimensions",
            f"make {entity} more slender",
            pointers=(f"{place}/dimensions",),
        ),
    ]


def _number(value: float | None) -> str:
    return "nothing" if value is None else f"{value:.4g}"

"""Evaluators of predicates about surfaces and forces between entities.

Touching in the past tense comes from the contact log of the solver; resting, support and separation come from the
visible surfaces. The log of a sleeping body is empty, so where both bodies sleep or are static, surfaces decide there too. Cloth, grains
and liquids are in no log of contacts: what they and a solid gave each other over a frame, friction included, is in their own record.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import clearance_series
from ...worlds.arrays import F64
from ...worlds.categories.registry import shape_of
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Contact, NoContact, RestsOn, Separation, Supported
from ..categories.registry import pressed
from ..ledgers import motion
from ..scene.parts import Track
from ..scene.surfaces import Surfaces, surfaces_of
from .outcome import Comparison, Outcome, Series, Truth, band, judge

if TYPE_CHECKING:
    from .scope import Scope

__all__ = ["contact", "no_contact", "rests_on", "separation", "supported"]


class _Missed(NamedTuple):
    """The number that decides an outcome, where there are several."""

    value: float
    bound: float
    comparison: Comparison
    unit: str

    @property
    def margin(self) -> float:
        """By how much it is met; negative where it is missed."""
        return self.value - self.bound if self.comparison == ">=" else self.bound - self.value

    def outcome(
        self,
        scope: Scope,
        pair: tuple[str, str],
        text: str,
        truth: NDArray[np.bool_],
        first: int | None,
        failing: int | None,
        details: dict[str, Any],
    ) -> Outcome:
        """The outcome of a pair of entities that it decides.

        Args:
            scope: what is judged.
            pair: the two; the first one fails.
            text: the finding in words.
            truth: whether it holds at each frame of the interval.
            first: frame at which it first comes true.
            failing: frame at which it fails; None where it passes.
            details: evidence.
        """
        ok = failing is None
        return Outcome(
            "pass" if ok else "fail",
            scope.frames,
            self.unit,
            text,
            value=self.value,
            bound=self.bound,
            comparison=self.comparison,
            truth=truth,
            margin=self.margin,
            first_true_frame=first,
            first_failing_entity=None if ok else pair[0],
            first_failing_frame=failing,
            failing=() if ok else pair,
            details=details,
        )


def _clearance(surfaces: Surfaces, a: str, b: str, frames: NDArray[np.intp], skip_above: float = np.inf) -> F64:
    """Signed clearance of two entities at some frames [m]; NaN at and after a broken pose.

    Raises:
        EvidenceError: an entity is unknown or the two are the same.
    """
    for name in (a, b):
        motion.require_motion(surfaces.candidate, name)
    if a == b:
        raise EvidenceError(f"{a!r} cannot be compared with itself")
    broken = min(surfaces.broken.get(n, surfaces.frames) for n in (a, b))
    good = frames < broken
    result = np.full(len(frames), np.nan)
    result[good] = np.inf
    for i in surfaces.parts_of[a]:
        for j in surfaces.parts_of[b]:
            one, two = surfaces.parts[i], surfaces.parts[j]
            tracks: list[Track] = [surfaces.track(p.entity, p.body).take(frames[good]) for p in (one, two)]
            values = _series(surfaces, (i, j), tracks, frames[good], skip_above)
            result[good] = np.minimum(result[good], values)
    return result


def _series(surfaces: Surfaces, parts: tuple[int, int], tracks: list[Track], frames: NDArray[np.intp], skip_above: float) -> F64:
    """Clearance of two parts at some frames [m]; deforming ones have another shape at each."""
    shapes = surfaces.shapes
    if not shapes.soft & set(parts):
        one, two = (surfaces.parts[k].solid for k in parts)
        return clearance_series(one, tracks[0], two, tracks[1], skip_above=skip_above)
    found = np.empty(len(frames))
    for place, frame in enumerate(frames.tolist()):
        one, two = (shapes.solid(k, frame) for k in parts)
        at = np.array([place])
        found[place] = clearance_series(one, tracks[0].take(at), two, tracks[1].take(at), skip_above=skip_above)[0]
    return found


def _still(scope: Scope, entity: str) -> Truth:
    """Where nothing would be logged for the entity although it may touch: it sleeps or is static."""
    if scope.candidate.spec.entities[entity].motion == "static":
        return np.ones(scope.length, dtype=bool)
    return motion.asleep(scope.candidate, entity)[scope.window]


def _touched(scope: Scope, a: str, b: str) -> tuple[Truth, F64]:
    """Truth of a touch of the two since the last frame, and its impulse [N s], per frame of the interval."""
    for name in (a, b):
        if not _loose(scope, name):  # of loose matter the record below is the evidence
            motion.require_motion(scope.candidate, name)
    recorded = pressed(scope.candidate, a, b)
    if recorded is not None:
        return recorded[scope.window] != 0.0, recorded[scope.window]
    touched, impulse = np.zeros(scope.length, dtype=bool), np.zeros(scope.length)
    for cache in motion.caches_with(scope.candidate, a, b):
        pair = sorted((cache.index.colliders.index(a), cache.index.colliders.index(b)))
        log = cache.ragged("contact/pair", "contact/impulse")
        for i, frame in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
            rows = np.flatnonzero((log[frame]["contact/pair"] == pair).all(axis=1))
            touched[i] |= bool(len(rows))
            impulse[i] += float(log[frame]["contact/impulse"][rows].sum())
    silent = np.flatnonzero(_still(scope, a) & _still(scope, b) & ~touched)
    if len(silent):
        surfaces = surfaces_of(scope.candidate)
        gap = surfaces.contact_gap(a, b)
        distance = _clearance(surfaces, a, b, silent + scope.frames[0], 2 * gap)
        touched[silent] = distance <= gap
    return touched, impulse


def _loose(scope: Scope, entity: str) -> bool:
    """True of matter that is many particles, which has no surface of its own.

    Raises:
        EvidenceError: no such entity.
    """
    known = scope.candidate.spec.entities.get(entity)
    if known is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    return shape_of(known) == "loose"


def contact(scope: Scope, p: Contact) -> Outcome:
    """Measured: summed normal impulse, or how far they stay apart where none is asked for.

    First true: when they have touched and the sum has reached `min_impulse`.
    """
    touched, impulse = _touched(scope, p.a, p.b)
    if not np.isfinite(impulse).all():
        frame = scope.frames[0] + int(np.argmax(~np.isfinite(impulse)))
        return _not_finite(scope, p.a, frame)
    summed = np.cumsum(impulse)
    reached = np.flatnonzero(np.maximum.accumulate(touched) & (summed >= p.min_impulse))
    ok = len(reached) > 0
    total = float(summed[-1])
    details: dict[str, Any] = {"touched_frames": int(touched.sum()), "impulse": total}
    if touched.any():
        first = scope.frames[0] + int(np.argmax(touched))
        text = f"{p.a} and {p.b} first touch at frame {first}, {total:.4g} N s in all (needed {p.min_impulse:g})"
        details["first_touch"] = first
    elif _loose(scope, p.a) or _loose(scope, p.b):
        text = f"{p.a} and {p.b} never touch"
    else:
        distance, frame = _closest(scope, p.a, p.b)
        text = f"{p.a} and {p.b} never touch; nearest {distance:.3g} m at frame {frame}"
        details |= {"nearest_gap": distance, "frame": frame}
    missed = _Missed(total, p.min_impulse, ">=", "N s")
    if not ok and total >= p.min_impulse:
        # No impulse is asked for, and yet they never touch: the distance is what is missed.
        missed = _Missed(0.0, 1.0, ">=", "frame")
        if "nearest_gap" in details:
            gap, distance = surfaces_of(scope.candidate).contact_gap(p.a, p.b), float(details["nearest_gap"])
            missed = _Missed(distance, gap, "<=", "m") if distance > gap else missed
    first_true = scope.frames[0] + int(reached[0]) if ok else None
    return missed.outcome(scope, (p.a, p.b), text, touched, first_true, None if ok else scope.frames[1], details)


def no_contact(scope: Scope, p: NoContact) -> Outcome:
    """Measured: summed normal impulse, which must be absent; of touches without impulse the number of frames."""
    touched, impulse = _touched(scope, p.a, p.b)
    if not np.isfinite(impulse).all():
        return _not_finite(scope, p.a, scope.frames[0] + int(np.argmax(~np.isfinite(impulse))))
    total, hit = float(impulse.sum()), bool(touched.any())
    frame = scope.frames[0] + int(np.argmax(touched)) if hit else None
    text = f"{p.a} and {p.b} touch first at frame {frame}, {total:.4g} N s in all" if hit else f"{p.a} and {p.b} never touch"
    missed = _Missed(float(touched.sum()), 0.0, "<=", "frame") if hit and total <= 0.0 else _Missed(total, 0.0, "<=", "N s")
    first_true = None if touched.all() else scope.frames[0] + int(np.argmin(touched))
    return missed.outcome(scope, (p.a, p.b), text, ~touched, first_true, frame, {"touched_frames": int(touched.sum())})


def _not_finite(scope: Scope, entity: str, frame: int) -> Outcome:
    return Outcome(
        "fail",
        scope.frames,
        "N s",
        f"contact impulse of {entity} is not finite at frame {frame}",
        first_failing_entity=entity,
        first_failing_frame=frame,
        failing=(entity,),
        details={"non_finite": True},
    )


def _closest(scope: Scope, a: str, b: str) -> tuple[float, int]:
    """Least clearance of the two in the interval [m] and its frame."""
    surfaces = surfaces_of(scope.candidate)
    distance = _clearance(surfaces, a, b, np.arange(scope.frames[0], scope.frames[1] + 1))
    if np.isnan(distance).all():
        return float("nan"), scope.frames[0]
    at = int(np.nanargmin(distance))
    return float(distance[at]), scope.frames[0] + at


def rests_on(scope: Scope, p: RestsOn) -> Outcome:
    """Measured: speed of the fastest point; where that is as asked and `on` does not carry the entity, how far it is away.

    "Above it at the contact" is a contact normal that rises: the clearance shrinks when the entity is lowered.
    """
    for name in (p.entity, p.on):
        motion.require_motion(scope.candidate, name)
    surfaces = surfaces_of(scope.candidate)
    if p.entity == p.on:
        raise EvidenceError(f"{p.entity!r} cannot rest on itself")
    speed = motion.fastest_points(scope.candidate, p.entity)[scope.window]
    carried = surfaces.carries(p.on, p.entity)[scope.window]
    margin = np.where(
        np.isnan(speed), np.nan, np.where(carried, p.max_speed - speed, np.minimum(-p.max_speed, p.max_speed - speed))
    )

    def tell(i: int) -> str:
        frame = scope.frames[0] + i
        text = f"{p.entity}'s fastest point moves at {speed[i]:.3g} m/s at frame {frame} (allowed {p.max_speed:g})"
        if carried[i]:
            return f"{p.on} carries {p.entity}; {text}"
        gap = surfaces.gap(p.entity, p.on, frame).distance
        allowed = surfaces.contact_gap(p.entity, p.on)
        if gap > allowed:
            return f"{p.entity} is {gap:.3g} m away from {p.on} (contact: up to {allowed:g} m); {text}"
        return f"{p.entity} touches {p.on} from the side or from below ({gap:.3g} m); {text}"

    def detail(i: int) -> dict[str, object]:
        return {"carried_frames": int(carried.sum()), "carried": bool(carried[i])}

    side: tuple[float, Comparison] = (p.max_speed, "<=")
    outcome = judge(Series(scope.frames, speed, margin, "m/s", p.entity, lambda i: side, tell, detail), p.when)
    if outcome.status == "pass" or outcome.value is None or outcome.value > p.max_speed:
        return outcome
    # It is slow enough: what is missed is that it is carried.
    gap = surfaces.gap(p.entity, p.on, int(outcome.details["frame"])).distance
    allowed = surfaces.contact_gap(p.entity, p.on)
    missed = _Missed(gap, allowed, "<=", "m") if gap > allowed else _Missed(0.0, 1.0, ">=", "1")
    return replace(
        outcome, value=missed.value, bound=missed.bound, comparison=missed.comparison, unit=missed.unit, margin=missed.margin
    )


def supported(scope: Scope, p: Supported) -> Outcome:
    """Measured: 1 where a chain of bodies that carry each other leads down to a static or kinematic one, else 0."""
    motion.require_motion(scope.candidate, p.entity)
    surfaces = surfaces_of(scope.candidate)
    held = _held(surfaces, p.entity)[scope.window]
    broken = surfaces.broken.get(p.entity, surfaces.frames)
    number = held.astype(float)
    number[np.arange(scope.frames[0], scope.frames[1] + 1) >= broken] = np.nan
    below = [n for n in surfaces.neighbours[p.entity] if surfaces.carries(n, p.entity)[scope.window].any()]

    def tell(i: int) -> str:
        frame = scope.frames[0] + i
        if held[i]:
            return (
                f"{p.entity} is supported at {int(held.sum())} of {len(held)} frames ({', '.join(below) or 'nothing'} carries it)"
            )
        nearest = _nearest_below(surfaces, p.entity, frame)
        return f"nothing supports {p.entity} at frame {frame}{nearest}; supported at {int(held.sum())} of {len(held)} frames"

    side: tuple[float, Comparison] = (1.0, ">=")
    series = Series(scope.frames, number, number - 0.5, "1", p.entity, lambda i: side, tell, lambda i: {"carried_by": below})
    outcome = judge(series, p.when)
    return replace(outcome, margin=None if outcome.margin is None else outcome.margin * 2)


def _held(surfaces: Surfaces, entity: str) -> Truth:
    """Frames at which the entity hangs on ground, shape (frames,): the least fixed point over what carries what."""
    motions = {n: e.motion for n, e in surfaces.candidate.spec.entities.items()}
    known: dict[str, Truth] = {}
    todo = [entity]
    below: dict[str, list[str]] = {}
    while todo:
        name = todo.pop()
        if name in known:
            continue
        known[name] = np.full(surfaces.frames, motions[name] != "dynamic")
        if motions[name] == "dynamic":
            below[name] = [n for n in surfaces.neighbours[name] if surfaces.carries(n, name).any()]
            todo += below[name]
    changed = True
    while changed:
        changed = False
        for name, carriers in below.items():
            for carrier in carriers:
                better = known[name] | (known[carrier] & surfaces.carries(carrier, name))
                if (better != known[name]).any():
                    known[name], changed = better, True
    return known[entity]


def _nearest_below(surfaces: Surfaces, entity: str, frame: int) -> str:
    others = [n for n in surfaces.neighbours[entity] if frame < min(surfaces.broken.get(m, surfaces.frames) for m in (n, entity))]
    if not others:
        return ""
    gaps = {n: surfaces.gap(entity, n, frame).distance for n in others}
    nearest = min(gaps, key=lambda n: gaps[n])
    return f" ({nearest} is nearest, {gaps[nearest]:.3g} m away)"


def separation(scope: Scope, p: Separation) -> Outcome:
    """Measured: signed clearance of the visible surfaces, negative when they overlap."""
    for name in (p.a, p.b):
        motion.require_motion(scope.candidate, name)
    frames = np.arange(scope.frames[0], scope.frames[1] + 1)
    distance = _clearance(surfaces_of(scope.candidate), p.a, p.b, frames)
    margin, side = band(distance, p.min, p.max)

    def tell(i: int) -> str:
        low, high = float(np.min(distance)), float(np.max(distance))
        return f"{p.a} and {p.b} are {distance[i]:.4g} m apart at frame {frames[i]} (range {low:.4g} to {high:.4g} m)"

    return judge(Series(scope.frames, distance, margin, "m", p.a, side, tell), p.when)

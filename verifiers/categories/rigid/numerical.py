"""Numerical health of rigid instances, on probes and full sequences (R105, R106, S6)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...contact.step_travel import step_travel
from ...ledgers import motion
from ...ledgers.balance import books_of
from ...ledgers.exchanged import both_ways
from ...ledgers.fields import feels_fields
from ...rows.corrections import bake_again, correction, double_iterations, halve_step, pointer, separate, set_value
from ...rows.findings import Finding
from ...scene import initial_state
from ..container import rows_about
from ..questions import COUNTERS, COUNTS, FINITE, ITERATIONS, SPEED, TRAVEL
from .books import energy_scale
from .bounds import CAPPED, GROWTH, QUATERNION_NOISE, SLACK, SLOW, SPIKE, USUAL_TOLERANCE
from .check import of_movers
from .corrections import closer_masses
from .links import owners
from .numerical_state import counters, events, frozen, resting, spike
from .questions import NUMERICAL
from .rows import Law

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction, Row
    from ...rows.questions import Question
    from ..container import Function

__all__ = ["numerical_rows"]

BODY_CHANNELS = ("position", "quaternion", "velocity", "angular_velocity", "asleep")


def numerical_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of one instance; `unverified` where it has no cache."""
    asked = {question: of_movers(FUNCTIONS[question.id]) for question in NUMERICAL}
    own = {question: of_movers(function) for question, function in SHARED.items()}
    return rows_about(candidate, solver, {FINITE: _finite, **own, **asked})


# ---------------------------------------------------------------- numbers and names


def _finite(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    total = 0
    for k in range(cache.index.frames):
        for name, array in sorted(cache.read(k).items()):
            if array.dtype.kind != "f":
                continue
            bad = ~np.isfinite(array)
            total += array.size
            if not bad.any():
                continue
            row = int(np.argwhere(bad)[0][0]) if array.ndim else 0
            entity = owners(cache)[row] if name in BODY_CHANNELS and row < len(cache.index.bodies) else None
            text = f"{name} of {entity or 'the instance'} is {array[bad].flat[0]} at frame {k} ({int(bad.sum())} numbers there)"
            hints = (halve_step(candidate, solver, "the solver diverged"), separate(entity))
            return Finding("fail", text, float(bad.sum()), 0.0, "numbers", entity, k, hints, {"channel": name})
    return Finding("pass", f"{total} numbers are finite", 0.0, 0.0, "numbers")


def _counts(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    index = cache.index
    expected = dict.fromkeys(BODY_CHANNELS, len(index.bodies)) | {"joint": len(index.joints), "driver/active": len(index.drivers)}
    planned = {
        f"{n}/{b.name}"
        for n in candidate.spec.simulation.rigid[solver].members
        if n in candidate.built and candidate.spec.entities[n].motion != "static" and n not in candidate.deformables
        for b in candidate.entity(n).bodies
    }
    soft = {f"{n}/{p.part}" for n in candidate.deformables if n in candidate.built for p in candidate.entity(n).parts}
    planned |= soft & {
        f"{n}/{p}" for n, p in (d.split("/", 1) for d in soft) if n in candidate.spec.simulation.rigid[solver].members
    }
    held = {*index.bodies, *index.deformables}
    missing, alien = planned - held, held - planned
    if missing or alien or not held:
        name = next(iter(sorted(missing or alien)), "")
        text = f"{len(missing)} moving bodies are not in the cache and {len(alien)} in it are not planned, e.g. {name!r}"
        return Finding("fail", text, float(len(missing) + len(alien)), 0.0, "bodies", name.split("/")[0] or None, 0)
    named = _misnamed(candidate, solver, cache)
    if named:
        return Finding("fail", named, 1.0, 0.0, "lists", None, 0, (bake_again("the index does not fit the plan"),))
    for k in range(index.frames):
        frame = cache.read(k, expected)
        for channel, count in expected.items():
            if len(frame[channel]) != count:
                text = f"{channel} has {len(frame[channel])} rows at frame {k}, the index names {count}"
                hints = (bake_again("the cache does not fit its index"),)
                return Finding("fail", text, float(len(frame[channel])), float(count), "rows", None, k, hints, comparison="==")
    return Finding("pass", f"{len(index.bodies)} bodies at every frame", float(len(index.bodies)), float(len(planned)), "bodies")


def _misnamed(candidate: Candidate, solver: str, cache: Cache) -> str:
    """Sentence on the first list of names in the index that is not as planned; empty where all are."""
    plan, index = candidate.spec.simulation, cache.index
    members = plan.rigid[solver].members
    joints = {n for n, j in plan.joints.items() if j.kind in ("hinge", "slide") and j.child in members}
    for what, held, wanted in (
        ("bodies", index.bodies, set(index.bodies)),
        ("colliders", index.colliders, set(members)),
        ("joints", index.joints, joints),
        ("drivers", index.drivers, set(index.drivers) & set(plan.drivers)),
    ):
        if len(set(held)) != len(held):
            return f"the index names one of its {what} twice"
        if set(held) != wanted:
            return f"{what} of the index and of the plan differ by {sorted(set(held) ^ wanted)[:3]}"
    return ""


# ---------------------------------------------------------------- states


def _quaternion(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    with np.errstate(invalid="ignore", over="ignore"):
        off = np.abs(np.linalg.norm(cache.series("quaternion"), axis=2) - 1.0)
    return _largest(cache, Law(QUATERNION_NOISE, "1", "deviation of |q| from 1"), off)


def _speed(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    with np.errstate(invalid="ignore", over="ignore"):
        speed = np.linalg.norm(cache.series("velocity"), axis=2)
    limit = candidate.spec.simulation.limits.max_speed
    found = _largest(cache, Law(limit, "m/s", "speed"), speed)
    peak: F64 = cache.series("record/max_speed")
    between = ~(peak <= limit)
    if found.status == "pass" and between.any():
        k = int(np.argmax(between))
        text = f"speed reaches {peak[k]:.3g} m/s between frames {k - 1} and {k} (limit {limit:g} m/s)"
        found = Finding("fail", text, float(np.nanmax(peak)), limit, "m/s", None, k)
    return _blown_up(candidate, solver, found)


def _travel(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    limits, fps = candidate.spec.simulation.limits, cache.index.fps
    names = tuple(dict.fromkeys(owners(cache)))
    with np.errstate(invalid="ignore", over="ignore"):
        tracks = np.stack([motion.centers(candidate, n) for n in names], axis=1)
        step = np.linalg.norm(np.diff(tracks, axis=0, prepend=tracks[:1]), axis=2)
    law = Law((limits.max_speed + SLACK) / fps, "m", "travel in one frame")
    return _blown_up(candidate, solver, _largest(cache, law, step, names))


def _blown_up(candidate: Candidate, solver: str, found: Finding) -> Finding:
    """The finding with the corrections of a simulation that blows up."""
    step = halve_step(candidate, solver, "the step is too long: contacts or joints are too stiff for it")
    return replace(found, hints=(separate(found.entity), step))


def _largest(cache: Cache, law: Law, values: F64, names: tuple[str, ...] = ()) -> Finding:
    """The finding about the largest value, (frames, bodies) or by names; one that is not a number is over every bound."""
    if values.size == 0:
        raise EvidenceError(f"instance {cache.index.solver!r} moves no body")
    values = np.where(np.isnan(values), np.inf, values)
    return law.judge(names or tuple(owners(cache)), values, np.ones(values.shape, dtype=bool), shift=0)


def _growth(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    plan = candidate.spec.simulation
    kinetic, potential, work = (cache.series(f"record/{n}") for n in ("kinetic_energy", "potential_energy", "driver_work"))
    weight = sum(candidate.body(*b.split("/", 1)).mass for b in cache.index.bodies) * float(np.linalg.norm(plan.gravity))
    if both_ways(candidate.spec, solver) or feels_fields(candidate.spec, solver):
        outside = books_of(candidate, cache).outside
        work = work + outside.work + outside.doubt
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        gain = np.diff(kinetic + potential - work, prepend=(kinetic + potential - work)[0])
        speed = np.linalg.norm(cache.series("velocity"), axis=2)
        ratio = np.ones_like(speed)
        ratio[1:] = speed[1:] / np.maximum(speed[:-1], SLOW)
    gains = ~(gain <= plan.limits.energy_growth * energy_scale(kinetic, potential, weight))
    found = _largest(cache, Law(GROWTH, "1", "speed-up in one frame"), np.where(gains[:, None], ratio, 0.0))
    between = spike(candidate, solver, cache) if found.status == "pass" else None
    if between is not None:
        k, peak, seen = between
        text = f"something reaches {peak:.3g} m/s within frame {k}, whose ends and ways show at most {seen:.3g} m/s"
        found = Finding("fail", text, peak / seen, SPIKE, "1", None, k)
    return _blown_up(candidate, solver, found)


# ---------------------------------------------------------------- the engine's own records


def _overflow(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    series: F64 = cache.series("record/overflows")
    wrong = ~(series == 0)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    total = float(series.sum()) if np.isfinite(series).all() else None
    text = "no engine warning" if frame is None else f"{total or 0:g} engine warnings, first at frame {frame}"
    hints = (
        separate(None),
        correction(
            "too many contacts for the engine's buffers",
            "shape",
            "use fewer or simpler collision parts where many touch",
            pointers=("/entities",),
        ),
    )
    return Finding("pass" if frame is None else "fail", text, total, 0.0, "warnings", None, frame, hints)


def _iterations(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    capped, steps = cache.series("record/iterations_capped"), cache.series("record/steps")
    total = float(steps.sum())
    if not np.isfinite(total) or not np.isfinite(capped).all():
        return Finding("fail", "step counts are not finite", frame=int(np.argmax(~np.isfinite(steps + capped))))
    if total <= 0:
        raise EvidenceError(f"instance {solver!r} records no solver steps")
    share = float(capped.sum()) / total
    over = np.cumsum(capped) > CAPPED * total
    exact = float(getattr(candidate.spec.simulation.solvers[solver].settings, "tolerance", USUAL_TOLERANCE))
    hints = (
        *(_less_exactly(solver, exact) if exact < USUAL_TOLERANCE else ()),
        double_iterations(candidate, solver, "the contact solver does not converge"),
        closer_masses("very unequal masses in contact", "touching"),
    )
    return Finding(
        "pass" if share <= CAPPED else "fail",
        f"{share:.2%} of {total:.0f} steps ended at the iteration cap",
        share,
        CAPPED,
        "1",
        None,
        int(np.argmax(over)) if over.any() else None,
        hints,
        {"tolerance": exact},
    )


def _less_exactly(solver: str, exact: float) -> tuple[Correction, ...]:
    """A search that ends sooner: the last digits of forces along a cord or chain come slowly, and say nothing."""
    place = pointer("simulation", "solvers", solver, "settings", "tolerance")
    wanted = float(f"{min(USUAL_TOLERANCE, 10.0 * exact):.6g}")
    action = f"raise the tolerance from {exact:g} to {wanted:g}; {USUAL_TOLERANCE:g} is usual"
    cause = "forces are searched for more exactly than they are found, as along a cord"
    return (correction(cause, "step", action, pointers=(place,), patch=set_value(place, wanted)),)


SHARED: Mapping[Question, Function] = {
    SPEED: _speed,
    TRAVEL: _travel,
    COUNTS: _counts,
    ITERATIONS: _iterations,
    COUNTERS: counters,
    **initial_state.STARTS,
}
"""Questions that other categories are asked too."""
FUNCTIONS: Mapping[str, Function] = {
    "numerical:quaternion": _quaternion,
    "numerical:growth": _growth,
    "numerical:overflow": _overflow,
    "numerical:step_travel": step_travel,
    "numerical:events": events,
    "numerical:frozen": frozen,
    "numerical:resting": resting,
}
"""By id of the question."""

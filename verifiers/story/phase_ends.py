"""What rightly goes on when a run ends: flights, slides, spins, splashes, and what a driver keeps moving (R77, S12).

A motion goes on by physics when the mechanical energy of all matter does not grow without a source. Looked at is the last third of
the response, `SPAN` at least: its largest energy is not above the largest before by more than `GROWTH` of the run's largest
kinetic energy. Work of drivers on bodies is taken off as recorded; a driver that acts within that time on anything else is a source.

Energy is kinetic and of gravity, computed from poses and velocities; of springs, liquids, grains, cloth and elastic bodies as
recorded. Without these records nothing is known, and nothing goes on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.drivers import acts_from
from ...worlds.errors import EvidenceError
from ..ledgers import motion

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec

__all__ = ["GROWTH", "SPAN", "Ending", "ending"]

SPAN = 0.25
"""[s] Own choice: least time at the end over which a motion must keep its energy."""
GROWTH = 0.05
"""Own choice: share of the largest kinetic energy by which the energy may grow: frames show an impact or a turn unevenly."""
TOLD = 0.05
"""Share of the kinetic energy at the end from which on an entity is named."""
NAMED = 3
"""Entities named in a sentence."""
MATTER = {"liquid": "flows or splashes on", "particles": "run or fly on", "cloth": "waves on", "elastic": "wobbles on"}


class Ending(NamedTuple):
    """How a run ends."""

    goes_on: bool
    """Whether the motion at the end needs no source that is not there."""
    text: str


def ending(candidate: Candidate, kinetic: F64, start: int) -> Ending | None:
    """How the last third goes, `SPAN` seconds at least; None where the run is too short after `start`, a beat is still to come, or energy is not known.

    Args:
        candidate: what was run.
        kinetic: kinetic energy that counts as response [J], shape (frames,).
        start: first frame of the response.
    """
    last, span = candidate.last_frame, max(1, round(SPAN * candidate.spec.simulation.fps))
    if last - start < span or any(b.frames[1] > last for b in candidate.spec.story.beats.values()):
        return None
    energy = _mechanical(candidate)
    if energy is None or not np.isfinite(energy).all():
        return None
    span = max(span, (last - start) // 3)
    since, seconds = last - span, span / candidate.spec.simulation.fps
    gain = float(energy[since : last + 1].max() - energy[start : since + 1].max())
    scale = float(kinetic[: last + 1].max())
    feeding = _feeding(candidate, since)
    if gain > GROWTH * scale and not feeding:
        text = f"energy grows by {gain:.3g} J over the last {seconds:.3g} s and no driver feeds it; {GROWTH * scale:.3g} J is allowed"
        return Ending(False, text)
    told = _told(candidate, span, float(kinetic[last]), feeding)
    change = f"energy {gain / scale:+.1%} of the largest kinetic energy over the last {seconds:.3g} s" if scale > 0 else "at rest"
    return Ending(True, f"goes on at the end: {told}; {change}")


def _record(cache: Cache, name: str, frames: int) -> F64 | None:
    try:
        return np.asarray(cache.series(f"record/{name}"), dtype=np.float64)[:frames]
    except EvidenceError:
        return None


def _mechanical(candidate: Candidate) -> F64 | None:
    """Mechanical energy of all matter less the work of drivers [J], shape (frames,); None where a record is missing."""
    spec, frames = candidate.spec, candidate.frame_count
    total = np.zeros(frames)
    stored = any(j.kind in ("spring", "rope") or getattr(j, "stiffness", 0.0) for j in spec.simulation.joints.values())
    for name, cache in candidate.caches.items():
        rigid = name in candidate.rigid_caches
        soft = rigid and any(b.split("/", 1)[0] in candidate.deforming for b in cache.index.bodies)
        if rigid and not stored and not soft:
            total += _of_bodies(candidate, cache)
        else:
            kept = ("elastic_kinetic_energy", "elastic_potential_energy", "strain_energy") if soft else ()
            for record in ("kinetic_energy", "potential_energy", *kept):
                value = _record(cache, record, frames)
                if value is None:
                    return None
                total += value
        for record, sign in (("stretch_energy", 1.0), ("bending_energy", 1.0), ("driver_work", -1.0)):
            value = _record(cache, record, frames)
            total += 0.0 if value is None else sign * value
    return total


def _of_bodies(candidate: Candidate, cache: Cache) -> F64:
    """Kinetic energy of bodies and that of gravity [J], shape (frames,)."""
    frames, gravity = candidate.frame_count, np.array(candidate.spec.simulation.gravity)
    energy: F64 = motion.kinetic_energy(candidate, cache)[:frames].sum(axis=1)
    for name in dict.fromkeys(b.split("/", 1)[0] for b in cache.index.bodies):
        energy = energy - motion.entity_mass(candidate, name) * (motion.centers(candidate, name)[:frames] @ gravity)
    return energy


def _feeding(candidate: Candidate, since: int) -> dict[str, tuple[str, ...]]:
    """Drivers that can do work after a frame, and on what. A release and a medium at rest do none."""
    spec, fps = candidate.spec, candidate.spec.simulation.fps
    found = {}
    for name, driver in spec.simulation.drivers.items():
        if driver.kind in ("release", "outflow") or (driver.kind == "field" and driver.field.kind == "drag"):
            continue
        start, entities = acts_from(spec, name)
        end = getattr(driver, "end", None)
        if driver.kind == "path":
            end = max(k.time for k in driver.keys.values())
        if driver.kind == "detach":
            end = start
        if start * fps <= candidate.last_frame and (end is None or end * fps >= since):
            found[name] = entities
    return found


def _told(candidate: Candidate, span: int, kinetic: float, feeding: dict[str, tuple[str, ...]]) -> str:
    """What moves at the end, and how."""
    ways: dict[str, list[str]] = {}
    for name, way in _ways(candidate, span, kinetic):
        driver = next((d for d, acted in feeding.items() if name in acted), None)
        ways.setdefault(f"is driven on by {driver}" if driver else way, []).append(name)
    return "; ".join(
        f"{', '.join(names[:NAMED])}{f' and {len(names) - NAMED} more' if len(names) > NAMED else ''} {way}"
        for way, names in ways.items()
    ) or "nothing that counts"  # fmt: skip


def _ways(candidate: Candidate, span: int, kinetic: float) -> Iterator[tuple[str, str]]:
    """Entities with a share of the kinetic energy at the end, and how they go on."""
    spec, last = candidate.spec, candidate.last_frame
    joined = {e for j in spec.simulation.joints.values() for e in (j.parent, j.child) if e}
    for solver, cache in candidate.caches.items():
        if solver not in candidate.rigid_caches:
            value = _record(cache, "kinetic_energy", candidate.frame_count)
            if value is not None and value[last] > TOLD * kinetic:
                yield from ((m, MATTER[c]) for m, c in _members(spec, cache.index.solver) if c in MATTER)
            continue
        touched = _touched(cache, last - span + 1, last)
        energy, owners = motion.kinetic_energy(candidate, cache)[last], [b.split("/", 1)[0] for b in cache.index.bodies]
        for name in dict.fromkeys(owners):
            own = float(energy[[o == name for o in owners]].sum())
            if own <= TOLD * kinetic or own <= 0.0:
                continue
            speed = float(np.linalg.norm(motion.velocities(candidate, name)[last]))
            spins = 0.5 * motion.entity_mass(candidate, name) * speed**2 < 0.5 * own
            yield (
                name,
                MATTER["elastic"] if name in candidate.deforming
                else "swings or turns on" if name in joined
                else "spins on" if spins
                else "slides or rolls on" if name in touched
                else "flies on",
            )  # fmt: skip


def _members(spec: WorldSpec, solver: str) -> list[tuple[str, str]]:
    return [(m, spec.entities[m].physics.category) for m in spec.simulation.solvers[solver].members]


def _touched(cache: Cache, first: int, last: int) -> set[str]:
    """Entities in contacts of some frames."""
    log = cache.ragged("contact/pair", "contact/impulse")
    return {cache.index.colliders[int(i)] for f in range(first, last + 1) for i in np.ravel(log[f]["contact/pair"])}

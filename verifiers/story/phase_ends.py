"""Motions that rightly go on when a run ends: flights, slides, spins, splashes, and what a driver keeps moving (R77, S12).

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
from ...worlds.quoting import listed
from ..categories.registry import judge_of_instance

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["GROWTH", "SPAN", "Ending", "ending"]

SPAN = 0.25
"""[s] Own choice: least time at the end over which a motion must keep its energy."""
GROWTH = 0.05
"""Own choice: share of the largest kinetic energy by which the energy may grow: frames show an impact or a turn unevenly."""
NAMED = 3
"""Entities named in a sentence."""


class Ending(NamedTuple):
    """End of a run."""

    goes_on: bool
    """True if the motion at the end needs no source that is not there."""
    text: str


def ending(candidate: Candidate, kinetic: F64, start: int) -> Ending | None:
    """Motion of the last third, `SPAN` seconds at least; None where the run is too short after `start`, a beat is still to come, or energy is not known.

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
    # Of hardly any kinetic energy a share says nothing.
    share = f"{gain / scale:+.1%} of the largest kinetic energy" if scale > abs(gain) else f"{gain:+.3g} J"
    change = f"energy {share} over the last {seconds:.3g} s" if scale > 0 else "at rest"
    return Ending(True, f"goes on at the end: {told}; {change}")


def _mechanical(candidate: Candidate) -> F64 | None:
    """Mechanical energy of all matter less the work of drivers [J], shape (frames,); None where a record is missing."""
    spec = candidate.spec
    found = [judge_of_instance(spec, solver).mechanical_energy(candidate, solver) for solver in candidate.caches]
    known = [energy for energy in found if energy is not None]
    return None if len(known) < len(found) else np.sum(known, axis=0)


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
    """Sentence about the entities that move at the end, and how."""
    ways: dict[str, list[str]] = {}
    spec = candidate.spec
    for name, way in (w for s in candidate.caches for w in judge_of_instance(spec, s).endings(candidate, s, span, kinetic)):
        driver = next((d for d, acted in feeding.items() if name in acted), None)
        ways.setdefault(f"is driven on by {driver}" if driver else way, []).append(name)
    return "; ".join(
        f"{listed(names, NAMED)} {way}" for way, names in ways.items()
    ) or "nothing that counts"  # fmt: skip

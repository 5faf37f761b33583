"""Time until which two specifications move a group of instances alike: what an edit leaves as it was (R6, R115).

Sound by default: whatever is not known to act later acts from the start. Which fields of a driver act later, its model says
(`matter.DriverBase.alike_until`); everything else that an instance reads has to be equal.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .bake_plan import groups_of
from .drivers import acts_from
from .errors import EvidenceError
from .settled import settling_terms
from .slices import motion_slice

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["Settings", "alike_until", "frames_alike", "settings_until"]


@dataclass(frozen=True)
class Settings:
    """All that decides the motion of a run, but for the engines."""

    spec: WorldSpec
    contents: Mapping[str, str]
    """Digest of the geometry of every entity."""

    @cached_property
    def motion(self) -> dict[str, Any]:
        """Slice of the specification from which the motion follows."""
        return motion_slice(self.spec)


def alike_until(one: Settings, two: Settings, names: tuple[str, ...], reads: tuple[str, ...] = ()) -> float:
    """Time until which a group of instances moves the same to the byte in two runs [s]; 0 where that is not known.

    Args:
        one: settings of the first run.
        two: settings of the second run.
        names: the group, in the order of `groups_of`.
        reads: instances whose frames the group reads; how long these are alike is not asked here.
    """
    if names not in groups_of(one.spec) or names not in groups_of(two.spec):
        return 0.0
    if _fixed(one, names, reads) != _fixed(two, names, reads):
        return 0.0
    ours, theirs = one.spec.simulation.drivers, two.spec.simulation.drivers
    found = math.inf
    for key in ours.keys() | theirs.keys():
        mine, other = ours.get(key), theirs.get(key)
        if mine != other and (_acts_on(one.spec, key, names) or _acts_on(two.spec, key, names)):
            first, second = (mine, other) if mine is not None else (other, mine)
            found = min(found, 0.0 if first is None else first.alike_until(second))
    return found


def frames_alike(seconds: float, fps: int) -> float:
    """Frames, the first included, that end no later than a time [s]; infinite where it is."""
    if math.isinf(seconds):
        return math.inf
    last = math.floor(seconds * fps) + 1  # one too far where rounding took it there
    while last / fps > seconds:
        last -= 1
    return last + 1 if seconds > 0 else 0


def settings_until(spec: WorldSpec, seconds: float, without: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Everything that decides the motion up to a time [s] in a run without some drivers: what acts later is left out."""
    whole = motion_slice(spec)
    drivers = {}
    for key, driver in spec.simulation.drivers.items():
        # The kind of a field makes other matter of it from the start.
        later = driver.later - {"field"} if driver.begins - driver.slack >= seconds else frozenset()
        unread = driver.absent if key in without else frozenset()
        drivers[key] = driver.model_dump(mode="json", exclude=set(later | unread))
    plan = {k: v for k, v in whole["plan"].items() if k not in ("frames", "drivers")}
    return {**whole, "plan": {**plan, "drivers": drivers}, "settling": settling_terms(spec)}


def _fixed(settings: Settings, names: tuple[str, ...], reads: tuple[str, ...]) -> dict[str, Any]:
    """Everything that a group may read but drivers and the number of frames: loose matter of other instances is out of its reach."""
    spec, whole = settings.spec, settings.motion
    plan = {k: v for k, v in whole["plan"].items() if k not in ("frames", "drivers", "order", "solvers", "couplings")}
    members = {m for n in names for m in spec.simulation.solvers[n].members}
    met = {n for n, e in spec.entities.items() if e.physics.shape != "loose" or n in members}
    used = {m for n in met for e in (spec.entities[n],) for m in (e.material, *(p.material for p in e.parts.values()))}
    return {
        "plan": plan,
        "solvers": {n: whole["plan"]["solvers"][n] for n in (*names, *reads)},
        "couplings": {k: c for k, c in whole["plan"]["couplings"].items() if {c["source"], c["target"]} & set(names)},
        "entities": {n: e for n, e in whole["entities"].items() if n in met},
        "contents": {n: settings.contents.get(n) for n in met},
        "materials": {k: m for k, m in whole["materials"].items() if k in used},
        "fastened": whole.get("fastened"),
        "settling": settling_terms(spec),
    }


def _acts_on(spec: WorldSpec, driver: str, names: tuple[str, ...]) -> bool:
    """True if a driver may act on a member of some instances."""
    if driver not in spec.simulation.drivers:
        return False
    try:
        reached = set(acts_from(spec, driver)[1])
    except EvidenceError:
        return True
    return any(reached & set(spec.simulation.solvers[n].members) for n in names)

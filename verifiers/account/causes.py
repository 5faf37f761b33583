"""Gravity, drivers by what they do, velocities at the start, and joints, each in a line."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.drivers import acts_from
from ..ledgers import motion
from .courses import MOVING
from .wording import number, place, seconds, towards

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from .things import Group

__all__ = ["driver_lines", "gravity_words", "joint_lines", "start_lines"]

Label = Callable[[str], str]


def gravity_words(candidate: Candidate) -> str:
    """Strength and direction of gravity."""
    pull = np.array(candidate.spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(pull))
    return f"gravity {number(strength)} m/s^2 {towards(pull)}" if strength > 0.0 else "no gravity"


def start_lines(candidate: Candidate, groups: list[Group]) -> list[str]:
    """One line per thing that moves at the first frame already, in the order of the things."""
    return [
        f"at the start {g.label(e)} already moves with {number(c.start_speed)} m/s towards {towards(c.start_way)}"
        for g in groups
        for e, c in g.courses.items()
        if c.start_speed > MOVING and candidate.spec.entities[e].motion == "dynamic"
    ]


def driver_lines(candidate: Candidate, label: Label) -> list[str]:
    """One line per driver, those that act first first."""
    found = []
    for name, driver in candidate.spec.simulation.drivers.items():
        begin, entities = acts_from(candidate.spec, name)
        on = sorted(label(e) for e in entities)
        whom = f"{on[0]} and {len(on) - 1} more" if len(on) > 2 else " and ".join(on)
        end = getattr(driver, "end", None)
        until = "" if end is None else f" to {seconds(end)}"
        found.append((begin, f"{seconds(begin)}{until} s: {_deed(candidate, driver, whom)}"))
    return [line for _, line in sorted(found)]


def _deed(candidate: Candidate, driver: Any, whom: str) -> str:
    """Deed of a driver in words; of one that has no words here, its kind."""
    deeds: dict[str, Callable[[], str]] = {
        "release": lambda: f"{whom}, held until then, is let go",
        "path": lambda: f"{whom} is moved along a path of {number(_length(candidate, driver.entity))} m",
        "force": lambda: f"a force pushes {whom}: {_force(driver)}",
        "motor": lambda: (
            f"a motor drives {whom} at {number(driver.velocity)} rad/s or m/s, {number(driver.max_effort)} N m or N at most"
        ),
        "detach": lambda: f"what joins {whom} is opened",
        "inflow": lambda: f"{whom} flows in at {place(np.array(driver.pose.position))} with {_flow(driver)}",
        "outflow": lambda: f"{whom} is taken away at {place(np.array(driver.pose.position))}{_down_to(driver)}",
        "waves": lambda: f"waves {number(driver.height)} m high, every {number(driver.period)} s, are made in {whom}",
        "emitter": lambda: f"{whom} come out at {place(np.array(driver.pose.position))}, {number(driver.rate)} per second",
        "field": lambda: f"{_field(driver.field)} acts on {whom or 'nothing'}",
    }
    return deeds.get(driver.kind, lambda: f"a driver of kind {driver.kind} acts on {whom}")()


def _flow(driver: Any) -> str:
    """Speed of an inflow, and the level that it holds."""
    speed = f"{number(driver.flow_speed)} m/s"
    return speed if driver.level is None else f"at most {speed} while it stands lower than {number(driver.level)} m"


def _down_to(driver: Any) -> str:
    return "" if driver.level is None else f" while it stands higher than {number(driver.level)} m"


def _length(candidate: Candidate, entity: str) -> float:
    """Way of the centre of mass over the run [m]."""
    steps = np.diff(motion.centers(candidate, entity), axis=0)
    return float(np.linalg.norm(steps, axis=1).sum())


def _force(driver: Any) -> str:
    force, torque = (np.array(v, dtype=np.float64) for v in (driver.force, driver.torque))
    told = [f"{number(float(np.linalg.norm(force)))} N towards {towards(force)}"] if force.any() else []
    told += [f"{number(float(np.linalg.norm(torque)))} N m about {towards(torque)}"] if torque.any() else []
    return ", ".join(told) or "0 N"


def _field(field: Any) -> str:
    words: dict[str, Callable[[], str]] = {
        "wind": lambda: (
            f"wind of {number(float(np.linalg.norm(field.velocity)))} m/s towards {towards(np.array(field.velocity, dtype=np.float64))}"
        ),
        "turbulence": lambda: f"turbulent air of {number(field.speed)} m/s",
        "vortex": lambda: f"whirling air of {number(field.speed)} m/s about {place(np.array(field.center))}",
        "drag": lambda: f"a medium at rest of {number(field.density)} kg/m^3",
        "attraction": lambda: (
            f"{'attraction to' if field.acceleration >= 0 else 'repulsion from'} {place(np.array(field.center))}"
        ),
    }
    return words.get(field.kind, lambda: f"a field of kind {field.kind}")()


def joint_lines(candidate: Candidate, label: Label) -> Iterator[str]:
    """One line per joint, alike ones counted."""
    counted: dict[str, int] = {}
    kinds = {"hinge": "turns on a hinge at", "slide": "slides along", "ball": "swivels at", "weld": "is fixed to"}
    for joint in candidate.spec.simulation.joints.values():
        how = kinds.get(joint.kind)
        if how is None:
            how = "hangs by a rope on" if getattr(joint, "rope", False) else "is held by a spring on"
        other = "a fixed point" if joint.parent is None else label(joint.parent)
        line = f"{label(joint.child)} {how} {other}"
        counted[line] = counted.get(line, 0) + 1
    for line, count in sorted(counted.items()):
        yield line + (f" ({count} times)" if count > 1 else "")

"""Corrections that only liquids have; those that others share are in `verifiers/rows/corrections.py`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.errors import EvidenceError
from ...rows.corrections import correction, halve_step, pointer, set_value

if TYPE_CHECKING:
    from ....worlds.requirements import Correction
    from ....worlds.spec import WavesDriver
    from .declared import Declared
    from .frames import Liquid

__all__ = [
    "ease",
    "give_room",
    "hold_all",
    "let_pass",
    "lower_waves",
    "move_opening",
    "refine",
    "rounded_down",
    "shorter_step",
    "squeezed",
    "widen_opening",
]

HELD = 0.9
"""[1] Own choice: a mean step of at least this share of `max_step` was held by it."""
LEAST_CFL = {"dfsph": 0.05, "flip": 0.1}
"""Least `cfl` that settings allow."""


def refine(liquid: Liquid | Declared, cause: str, wanted: float | None = None) -> Correction:
    """Resolve the liquid more finely: with half the spacing, or with a wanted one [m]."""
    value = rounded_down(0.5 * liquid.spacing if wanted is None else wanted)
    places = [pointer("entities", m, "physics", "resolution") for m in liquid.members]
    patch = tuple(step for place in places for step in set_value(place, value))
    action = f"lower resolution from {liquid.spacing:g} m to {value:.3g} m"
    return correction(cause, "resolution", action, pointers=places[:1], patch=patch)


def shorter_step(liquid: Liquid, cause: str, frame: int | None = None) -> Correction:
    """Shorten the step that ran: by `max_step` where that held it, else by `cfl`, which did.

    Args:
        liquid: what was judged.
        cause: why.
        frame: at which; default the longest step of all frames.
    """
    settings, ran = liquid.plan.settings, _ran(liquid, frame)
    if ran is None or ran >= HELD * settings.max_step:
        return halve_step(liquid.candidate, liquid.solver, cause)
    place, lower = (
        pointer("simulation", "solvers", liquid.solver, "settings", "cfl"),
        max(LEAST_CFL[liquid.plan.engine], 0.5 * settings.cfl),
    )
    where = "at most" if frame is None else f"at frame {frame}"
    action = f"lower cfl from {settings.cfl:g} to {lower:g}: steps ran at {ran:.3g} s {where}, which max_step, {settings.max_step:g} s, does not hold"
    if lower >= settings.cfl:  # cfl is as low as it may be
        return halve_step(liquid.candidate, liquid.solver, cause, in_force=ran)
    return correction(cause, "step", action, pointers=(place,), patch=set_value(place, lower))


def _ran(liquid: Liquid, frame: int | None) -> float | None:
    """Mean step of a frame, or the longest of all frames [s]; None where none is recorded."""
    try:
        steps = liquid.record("step")
    except EvidenceError:
        return None
    ran = steps[1:] if frame is None else steps[frame : frame + 1]
    ran = ran[np.isfinite(ran) & (ran > 0.0)]
    return float(ran.max()) if len(ran) else None


def rounded_down(value: float) -> float:
    """The value with three digits, never more than it is: a spacing that a rule asks for satisfies that rule."""
    if value <= 0.0:
        return value
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / unit * (1.0 + 1e-9)) * unit:.3g}")


def squeezed(liquid: Liquid, names: Sequence[str], where: list[float]) -> Correction:
    """Give liquid that two bodies squeeze out from between them more layers to flow in: a finer spacing."""
    cause = f"{names[0]} and {names[1]} squeeze it out from between them about {where}, less than two spacings apart"
    return refine(liquid, cause, 0.7 * liquid.spacing)


def let_pass(entities: Iterable[str], cause: str, where: list[float], least: float) -> Correction:
    """Close a way about a point [m], or make it so wide that liquid passes it: at least so many metres."""
    places = [pointer("entities", e, "parts") for e in dict.fromkeys(entities)]
    return correction(cause, "shape", f"close the way about {where}, or widen it to at least {least:.3g} m", pointers=places)


def widen_opening(driver: str, least: float) -> Correction:
    """Widen the opening of an inflow or outflow to so many metres."""
    place = pointer("simulation", "drivers", driver, "size")
    return correction("the opening is too narrow", "drivers", f"widen {driver} to {least:.3g} m", pointers=(place,))


def move_opening(driver: str, depth: float, entity: str | None) -> Correction:
    """Move the opening of an inflow out of the entity that it is so deep in [m], or out of the domain's side."""
    action = f"move the opening of {driver} by at least {depth:.3g} m out of {entity or 'the side'}"
    place = pointer("simulation", "drivers", driver, "pose")
    return correction("the source is inside a solid", "drivers", action, pointers=(place,))


def lower_waves(name: str, driver: WavesDriver) -> Correction:
    """Lower the waves to 0.7 of their height."""
    place, lower = pointer("simulation", "drivers", name, "height"), float(f"{0.7 * driver.height:.3g}")
    return correction(
        "the waves break", "drivers", f"lower height to {lower:g} m", pointers=(place,), patch=set_value(place, lower)
    )


def hold_all(liquid: Liquid) -> Correction:
    """Let the domain hold all of the liquid, or let it flow out where that is counted."""
    place = pointer("simulation", "solvers", liquid.solver, "settings", "domain")
    action = "let the domain hold all of it, or give an outflow"
    return correction("liquid leaves where nothing counts it", "domain", action, pointers=(place,))


def give_room(liquid: Liquid, where: list[float]) -> Correction:
    """Give the liquid room about a point [m], or keep it out."""
    places = [pointer("entities", m, "parts") for m in liquid.members]
    cause = "liquid is caught between surfaces that leave it no room"
    return correction(cause, "placement", f"give it room about {where}, or keep liquid out", pointers=places)


def ease(liquid: Liquid, cause: str, action: str, *fields: str, settings: tuple[str, ...] = ()) -> Correction:
    """Change fields of the physics of the liquid's members, and settings of its instance."""
    places = [pointer("simulation", "solvers", liquid.solver, "settings", name) for name in settings]
    places += [pointer("entities", m, "physics", name) for name in fields for m in liquid.members]
    return correction(cause, "liquid", action, pointers=places)

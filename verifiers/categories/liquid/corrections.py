"""Corrections that only liquids have; those that others share are in `verifiers/rows/corrections.py`."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ...rows.corrections import correction, pointer, set_value

if TYPE_CHECKING:
    from ....worlds.requirements import Correction
    from ....worlds.spec import WavesDriver
    from .declared import Declared
    from .frames import Liquid

__all__ = ["ease", "give_room", "hold_all", "let_pass", "lower_waves", "move_opening", "refine", "rounded_down", "widen_opening"]


def refine(liquid: Liquid | Declared, cause: str, wanted: float | None = None) -> Correction:
    """Resolve the liquid more finely: with half the spacing, or with a wanted one [m]."""
    value = rounded_down(0.5 * liquid.spacing if wanted is None else wanted)
    places = [pointer("entities", m, "physics", "resolution") for m in liquid.members]
    patch = tuple(step for place in places for step in set_value(place, value))
    action = f"lower resolution from {liquid.spacing:g} m to {value:.3g} m"
    return correction(cause, "resolution", action, pointers=places[:1], patch=patch)


def rounded_down(value: float) -> float:
    """The value with three digits, never more than it is: a spacing that a rule asks for satisfies that rule."""
    if value <= 0.0:
        return value
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / unit * (1.0 + 1e-9)) * unit:.3g}")


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

"""Lines of the approximation register about steam where hot matter meets water (R68)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....physics.boiling import STEAM_DENSITY
from ....worlds.categories.gas.steam_facts import contact_reach, hot_matter, steams_of

if TYPE_CHECKING:
    from ....worlds.spec import WorldSpec

__all__ = ["steam_lines"]


def steam_lines(spec: WorldSpec, name: str) -> list[tuple[str, str]]:
    """Simplification and effect of each line about the steam of an instance."""
    found = []
    for key, driver in sorted(steams_of(spec, name).items()):
        water, held = _listed(driver.water), hot_matter(spec, {key: driver})
        gas = spec.entities[driver.entity].physics
        drops = getattr(gas, "soot_density", 0.0) / STEAM_DENSITY
        found += [
            (
                f"{water} keeps the water that {key!r} makes steam of, and is not warmed or stirred by it",
                "omitted reaction: no bubbles, no falling level; row kept tells the share, which is at most a twentieth",
            ),
            (
                f"{_listed([h.entity for h in held])} cools as a whole by what it gives to {key!r}",
                "no crust or cold skin forms at the water, behind which steam would come more slowly; its motion, strength and look stay those of its own temperature",
            ),
            (
                f"{key!r} boils water at a flat still surface (film boiling: Berenson 1961, Bromley 1950)",
                "moving water takes up to twice as much; no explosion of water that is enclosed",
            ),
            (
                f"contact for {key!r} is told within {contact_reach(spec, driver):.3g} m, the support of a kernel over the particles",
                "an area finer than that is smoothed; measured on spheres and planes within 5 %",
            ),
            (
                f"steam of {key!r} comes over the water in balls of {driver.radius:g} m, and the gas passes through {water}",
                "no bubble rises through the water, and none condenses there; each kg takes 1.68 m^3 and weighs as warm air",
            ),
            (
                f"{drops:.0%} of the steam of {key!r} is seen as drops from the start",
                "the figure is declared; drops neither grow nor evaporate",
            ),
        ]
        solids = [h for h in held if not h.liquid]
        if solids:
            found.append(
                (
                    f"{_listed([h.entity for h in solids])} has {driver.temperature:g} K for {key!r} alone",
                    "nothing else knows of its heat: it does not glow, and warms no air",
                )
            )
    return found


def _listed(names: list[str]) -> str:
    return ", ".join(repr(n) for n in names)

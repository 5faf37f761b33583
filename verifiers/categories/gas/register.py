"""Lines of the approximation register about gases (R68)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.categories.gas.carrying import carries
from ....worlds.categories.gas.facts import dusts_of, emissions_of
from .register_of_fire import burning_lines
from .steam_lines import steam_lines

if TYPE_CHECKING:
    from ....worlds.spec import GasInstance, WorldSpec

__all__ = ["gas_lines"]

FELT = 0.01
"""Own choice: Boussinesq's approximation is told from this difference of temperatures on, as a share of the ambient one."""


def gas_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of every instance of a gas."""
    found: list[tuple[str, str]] = []
    for name, instance in spec.simulation.gas.items():
        for member in instance.members:
            physics = spec.entities[member].physics
            if physics.category == "gas":
                found += _of_gas(member, physics.temperature, physics.resolution, instance)
                found += _of_fire(member, physics.fuel, instance)
        found += _of_box(name, instance, carries(spec, name))
        found += burning_lines(spec, name)
        found += _of_source(spec, name)
    return [{"what": what, "effect": effect} for what, effect in found]


def _of_gas(member: str, temperature: float, cell: float, instance: GasInstance) -> list[tuple[str, str]]:
    """Simplification and effect of each line about one gas."""
    settings = instance.settings
    found = [
        (
            f"eddies of {member!r} smaller than two cells of {cell:g} m are not simulated",
            "it mixes with the air within a cell; finer curls are lost",
        ),
        (
            f"soot, drops or dust of {member!r} move with the gas",
            "nothing settles, clumps, sticks to walls, condenses or evaporates",
        ),
    ]
    if settings.diffusivity == 0.0:
        what = f"{member!r} gives off no heat, to walls or by radiation"
        found.append((what, "it cools by mixing with the air alone, and rises longer than real smoke"))
    apart = abs(temperature / settings.ambient_temperature - 1.0)
    if not settings.expands and apart > FELT:
        what = f"the density of {member!r} differs in buoyancy alone (Boussinesq)"
        found.append((what, f"{apart:.0%} of its volume and inertia are neglected at its source"))
    return found


def _of_source(spec: WorldSpec, name: str) -> list[tuple[str, str]]:
    """Simplification and effect of each line about how gas comes."""
    found = [
        (
            f"{member!r} appears within the shape of its source",
            "no jet, nozzle or flame is simulated; its first speed is what the room that it takes asks for",
        )
        for member in sorted({d.entity for d in emissions_of(spec, name).values()})
    ]
    for key, driver in sorted(dusts_of(spec, name).items()):
        found += [
            (
                f"{key!r} raises {driver.per_energy:g} kg of dust per joule of an impact, whatever is hit",
                "the figure is declared, and dust never runs out; sliding and rolling raise none",
            ),
            (
                f"dust of {key!r} comes with its air within {driver.radius:g} m of an impact over {1 / spec.simulation.fps:.3g} s",
                "no grain flies by itself; half the impulse times the closing speed counts as energy, also of what bounces",
            ),
        ]
    return [*found, *steam_lines(spec, name)]


def _of_fire(member: str, fuel: str | None, instance: GasInstance) -> list[tuple[str, str]]:
    """Simplification and effect of each line about what burns."""
    if fuel is None:
        return []
    wood = [
        (
            f"{member!r} is the gas that hot wood gives off, at the declared rate",
            "no wood is heated to make what its emission lets out",
        )
    ]
    return [
        *(wood if fuel == "wood" else []),
        (
            f"{fuel} of {member!r} burns in one step as fast as it mixes with air (eddy dissipation)",
            "no flame is finer than a cell, no chemistry slows it, and it always burns fully",
        ),
        (
            f"light of the flames of {member!r} leaves the box at once",
            "thick soot takes none of it up again, and it warms nothing but solids and cloth that may burn",
        ),
        (
            f"all gas of {member!r} has the heat capacity and weight of air, and walls take no heat",
            "flames are up to a fifth too hot",
        ),
        (
            f"an ignition of {member!r} gives no heat",
            "the energy of a spark or pilot flame is left out",
        ),
    ]


def _of_box(name: str, instance: GasInstance, carrying: bool) -> list[tuple[str, str]]:
    """Simplification and effect of each line about one box."""
    settings = instance.settings
    found = [
        (
            f"bodies stand in the way of the gas of {name!r} and do not feel it",
            "omitted reaction: nothing that stands in its way is blown away or lifted"
            + (", and what it carries does not stand in its way" if carrying else ""),
        ),
    ]
    if "open" in settings.domain.sides:
        what = f"gas that leaves {name!r} through an open side is gone, and air of {settings.ambient_temperature:g} K comes in"
        found.append((what, "it is counted as escaped and never comes back"))
    if "closed" in settings.domain.sides:
        found.append((f"closed sides of {name!r} are smooth walls", "the gas slips along them, seen or not"))
    if settings.follows:
        what = f"the gas of {name!r} is solved in a part of its box that follows it; the air beyond flows on cells four times as wide"
        found.append(
            (
                what,
                "frames hold air at rest there; 1 % of the soot of a column lies elsewhere than in the whole box after 4 s, of smoke that meets a ball 2 % and, once eddies have grown, 12 % (measured)",
            )
        )
    if settings.confinement > 0.0:
        what = f"vorticity confinement of {settings.confinement:g} spins the gas of {name!r}"
        found.append((what, "it puts energy in that no law gives, so that curls stay alive"))
    if settings.viscosity == 0.0:
        what = f"the gas of {name!r} has no viscosity but what its scheme has"
        found.append((what, "layers at walls are as thick as a cell"))
    return found

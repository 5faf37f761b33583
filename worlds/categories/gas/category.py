"""Gases: smoke, steam, hot air, fire."""

from __future__ import annotations

from ...parameters import DRIVER, PHYSICS, SETTINGS, GroupInfo, parameters
from ..caps import GAS_CAPS
from ..category import Audit, CategorySpec
from ..shared import DOMAIN, OPENING, RESOLUTION, SIDES, STEPS, TEMPERATURE
from .audit import gas_problems
from .burning import flammable_parts
from .carrying import coupling_problems
from .channels import CHANNELS, DIMENSIONS, writers
from .facts import gas_counts, gas_seconds
from .medium import gas_medium
from .models import DustDriver, EmissionDriver, GasInstance, GasPhysics, IgnitionDriver, SteamDriver
from .predicates import PREDICATES

__all__ = ["GAS"]

GAS = CategorySpec(
    name="gas",
    shape=GasPhysics.shape,
    covers="smoke, steam, dust, hot air and fire on a grid, which solids stand in the way of and wind blows; it drags along what a coupling lets it carry",
    physics=GasPhysics,
    instances=(GasInstance,),
    drivers=(EmissionDriver, IgnitionDriver, DustDriver, SteamDriver),
    predicates=PREDICATES,
    asked="gas_density_in, gas_temperature_in, plume_height, gas_arrives, light_through, heat_release or gas_clears of it, burnt_share of what burns in it; it burns, rises, drifts, spreads, fills",
    meets=("rises", "drifts", "spreads", "fills"),
    groups=(GroupInfo("gas", "solver", "viscosity, conduction, confinement, ambient temperature and drag coefficient of gases"),),
    parameters=(
        *TEMPERATURE,
        *RESOLUTION,
        *parameters(PHYSICS, "soot_density", "initial_state", "repair", "how dark and heavy it is at its source", physical=True),
        *parameters(
            PHYSICS, "fuel fuel_share", "initial_state", "repair", "what burns, and how hot; rows hold its heat", physical=True
        ),
        *parameters(
            DRIVER,
            "center radius per_energy bodies hot water temperature heat_capacity",
            "drivers",
            "repair",
            "drivers stand in the register",
        ),
        *DOMAIN,
        *SIDES,
        *STEPS,
        *parameters(SETTINGS, "scheme courant", "step", "repair", "rows hold the motion against laws"),
        *parameters(SETTINGS, "expands confinement follows", "gas", "repair", "an approximation that stands in the register"),
        *parameters(
            SETTINGS,
            "viscosity diffusivity ambient_temperature coefficient",
            "gas",
            "repair",
            "how it flows, gives off heat and drags what it carries",
            physical=True,
        ),
        *OPENING,
    ),
    channels=CHANNELS,
    dimensions=DIMENSIONS,
    changes=flammable_parts,
    writers=writers,
    knobs={"gas": ("resolution",)},
    coupling=coupling_problems,
    medium=gas_medium,
    caps=GAS_CAPS,
    estimate=gas_counts,
    audit=Audit(
        "gases",
        "gases have a box each that holds and resolves their source, something that makes it, and a way out",
        gas_problems,
    ),
    seconds=gas_seconds,
)

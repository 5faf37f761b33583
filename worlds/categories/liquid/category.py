"""Liquids."""

from __future__ import annotations

from ...parameters import DRIVER, PHYSICS, SETTINGS, GroupInfo, parameters
from ..caps import LOOSE_CAPS
from ..category import Audit, CategorySpec
from ..loose import counts
from ..resting import LOOSE_SHARE
from ..shared import DOMAIN, LINEAR_VELOCITY, OPENING, RESOLUTION, SIDES, STEPS, TEMPERATURE
from .audit import liquid_problems, liquid_warnings
from .channels import CHANNELS, DIMENSIONS, writers
from .events import EVENTS
from .facts import liquid_estimate, liquid_seconds
from .models import DfsphInstance, FlipInstance, InflowDriver, LiquidPhysics, OutflowDriver, WavesDriver
from .predicates import PREDICATES
from .recipe import liquid_recipes

__all__ = ["LIQUID"]

LIQUID = CategorySpec(
    name="liquid",
    shape=LiquidPhysics.shape,
    covers="free-surface liquids as particles or on a grid, inflows and outflows, waves of a spectrum; dfsph pushes bodies and is pushed by them",
    physics=LiquidPhysics,
    instances=(DfsphInstance, FlipInstance),
    drivers=(InflowDriver, OutflowDriver, WavesDriver),
    predicates=(*PREDICATES, *EVENTS),
    asked="liquid_arrives, liquid_volume_in, liquid_level_at or liquid_speed of it, submerged_fraction or reaches of what it meets; it pushes, it stops",
    meets=("pushes", "stops"),
    groups=(GroupInfo("liquid", "solver", "viscosity, surface tension, heat of liquids, friction and roughness of walls"),),
    parameters=(
        *parameters(
            PHYSICS,
            "viscosity surface_tension conductivity heat_capacity activation",
            "liquid",
            "repair",
            "how it flows and gives off heat",
            physical=True,
        ),
        *parameters(
            f"{PHYSICS}/currents",
            ". * */line */speeds */width",
            "initial_state",
            "repair",
            "the state at frame 0 and what holds it",
        ),
        *LINEAR_VELOCITY,
        *TEMPERATURE,
        *RESOLUTION,
        *DOMAIN,
        *SIDES,
        *STEPS,
        *parameters(
            SETTINGS,
            "cfl density_error divergence_error viscosity_error pressure_error volume_correction flip_ratio transfer "
            "particles_per_cell",
            "step",
            "repair",
            "rows hold the motion against laws",
        ),
        *parameters(SETTINGS, "wall_friction roughness", "liquid", "repair", "how walls slow it", physical=True),
        *OPENING,
        *parameters(
            DRIVER,
            "round spectrum height period level gauge depth direction spreading peakedness components generate absorb zone",
            "drivers",
            "repair",
            "drivers stand in the register",
        ),
    ),
    channels=CHANNELS,
    dimensions=DIMENSIONS,
    writers=writers,
    knobs={"dfsph": ("resolution",), "flip": ("resolution",)},
    caps=LOOSE_CAPS,
    estimate=lambda spec: counts(spec, (liquid_estimate(spec, name) for name in spec.simulation.liquid)),
    audit=Audit(
        "liquids", "liquids are members of a liquid instance that resolves them, and its domain holds them", liquid_problems
    ),
    warnings=liquid_warnings,
    recipes=liquid_recipes,
    rest_way=lambda spec, name: LOOSE_SHARE * spec.entities[name].physics.flow_cell,
    seconds=liquid_seconds,
)

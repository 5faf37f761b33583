"""Grains and flying particles."""

from __future__ import annotations

from ...parameters import DRIVER, PHYSICS, SETTINGS, GroupInfo, parameters
from ..caps import LOOSE_CAPS
from ..category import Audit, CategorySpec
from ..loose import counts
from ..shared import DOMAIN, ELASTIC_MODULI, LINEAR_VELOCITY, OPENING, STEPS
from .audit import particle_problems, particle_warnings
from .channels import CHANNELS
from .events import EVENTS
from .facts import particle_estimate, particle_seconds, rest_way
from .models import BallisticInstance, DemInstance, EmitterDriver, ParticlePhysics
from .predicates import PREDICATES

__all__ = ["PARTICLES"]

PARTICLES = CategorySpec(
    name="particles",
    shape=ParticlePhysics.shape,
    covers="grains with friction, rolling resistance and cohesion that push bodies and are pushed; sparks, rain, dust that fly alone",
    physics=ParticlePhysics,
    instances=(DemInstance, BallisticInstance),
    drivers=(EmitterDriver,),
    predicates=(*PREDICATES, *EVENTS),
    asked="particle_count_in, particle_volume_in, pile_height, run_out or particles_settled of it, reaches or speed of what it meets",
    groups=(GroupInfo("grains", "solver", "rolling resistance, cohesion, packing and life of particles"),),
    parameters=(
        *parameters(PHYSICS, "rolling cohesion packing", "grains", "repair", "how grains hold together", physical=True),
        *parameters(PHYSICS, "on_hit life life_spread", "grains", "repair", "what becomes of particles"),
        *parameters(PHYSICS, "law", "mass", "repair", "who moves them; ownership is audited"),
        *parameters(PHYSICS, "radius radius_spread", "resolution", "repair", "rows hold it against what it must resolve"),
        *parameters(PHYSICS, "count", "initial_state", "repair", "the state at frame 0 and what holds it"),
        *ELASTIC_MODULI,
        *LINEAR_VELOCITY,
        *DOMAIN,
        *STEPS,
        *parameters(SETTINGS, "step_share", "step", "repair", "rows hold the motion against laws"),
        *OPENING,
        *parameters(DRIVER, "speed_spread cone", "drivers", "repair", "drivers stand in the register"),
    ),
    channels=CHANNELS,
    knobs={"dem": ("radius",)},
    caps=LOOSE_CAPS,
    estimate=lambda spec: counts(spec, (particle_estimate(spec, name) for name in spec.simulation.particles)),
    seconds=particle_seconds,
    warnings=particle_warnings,
    rest_way=rest_way,
    audit=Audit(
        "particles", "particles are members of an engine of their law, which holds them in its domain", particle_problems
    ),
)

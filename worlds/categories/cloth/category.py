"""Cloth."""

from __future__ import annotations

import math

from ...parameters import PHYSICS, SETTINGS, GroupInfo, parameters
from ..caps import CLOTH_CAPS
from ..category import Audit, CategorySpec
from ..shared import DAMPING, LINEAR_VELOCITY, PINS, STEPS
from .audit import cloth_problems, has_sheets, mass_problems
from .channels import CHANNELS, DIMENSIONS, writers
from .contacts import unrecorded
from .couplings import coupling_problems
from .events import EVENTS
from .facts import cloth_counts, cloth_seconds, rest_way
from .models import ClothInstance, ClothPhysics
from .predicates import PREDICATES
from .weakened import weakenings

__all__ = ["CLOTH"]

CLOTH = CategorySpec(
    name="cloth",
    shape=ClothPhysics.shape,
    covers="sheets and open meshes with real stiffness, pins, self-collision, wind; with a coupling they push bodies and are pushed",
    physics=ClothPhysics,
    instances=(ClothInstance,),
    predicates=(*PREDICATES, *EVENTS),
    groups=(GroupInfo("cloth", "solver", "stiffness, strength, thickness, drag of cloth, what it passes through"),),
    parameters=(
        *parameters(PHYSICS, "tear", "cloth", "repair", "its strength is compared, endless where it cannot tear"),
        *parameters(
            PHYSICS,
            "tear/strength",
            "cloth",
            "repair",
            "weaker cloth tears more easily, stronger holds",
            physical=True,
            eases=("torn",),
            absent=math.inf,
        ),
        *parameters(
            PHYSICS,
            "stretch_stiffness weft_stiffness shear_stiffness bend_stiffness",
            "cloth",
            "repair",
            "softer bodies give way more, stiffer ones hold",
            physical=True,
            eases=("deflection", "strain"),
        ),
        *parameters(PHYSICS, "thickness drag skin_drag", "cloth", "repair", "how it meets air and bodies", physical=True),
        *parameters(PHYSICS, "flat", "cloth", "repair", "the shape that it wants"),
        *parameters(PHYSICS, "self_collision", "cloth", "either", "false: layers pass through each other"),
        *parameters(PHYSICS, "ignores", "cloth", "either", "what it passes through"),
        *parameters(PHYSICS, "max_stretch", "limits", "harder_down", "allowed deformation"),
        *parameters(PHYSICS, "area_density", "mass", "repair", "what it weighs", physical=True),
        *DAMPING,
        *LINEAR_VELOCITY,
        *PINS,
        *parameters(PHYSICS, "pins/*/edge pins/*/radius", "joints", "repair", "the state at frame 0 and what holds it"),
        *STEPS,
        *parameters(SETTINGS, "integrator", "step", "repair", "rows hold the motion against laws"),
        *parameters(SETTINGS, "margin", "contact", "repair", "rows hold the motion against laws"),
    ),
    channels=CHANNELS,
    dimensions=DIMENSIONS,
    writers=writers,
    caps=CLOTH_CAPS,
    estimate=cloth_counts,
    seconds=cloth_seconds,
    audit=Audit(
        "cloth",
        "cloth is made of sheets or meshes that resolve its thickness, and its pins hold it",
        cloth_problems,
        also=has_sheets,
    ),
    masses=mass_problems,
    coupling=coupling_problems,
    unrecorded=unrecorded,
    unstruck="no record tells when and how fast a sheet begins to touch a body: ask contact with min_impulse, or pushes",
    rest_way=rest_way,
    weakenings=weakenings,
)

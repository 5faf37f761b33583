"""Elastic bodies, which instances of rigid bodies move."""

from __future__ import annotations

from dataclasses import replace

from ...parameters import PHYSICS, GroupInfo, parameters
from ..category import Audit, CategorySpec
from ..resting import two_skins
from ..shared import DAMPING, ELASTIC_MODULI, LINEAR_VELOCITY, PINS, RESOLUTION
from .audit import elastic_problems
from .channels import CHANNELS, DIMENSIONS, writers
from .events import EVENTS
from .facts import elastic_seconds
from .models import ElasticPhysics
from .predicates import PREDICATES
from .unmet import unmet_warnings

__all__ = ["ELASTIC"]

ELASTIC = CategorySpec(
    name="elastic",
    shape=ElasticPhysics.shape,
    covers="elastic bodies on lattices of quadratic cells, pinned or free, two-way contact with rigid and elastic bodies, yielding",
    physics=ElasticPhysics,
    predicates=(*PREDICATES, *EVENTS),
    groups=(GroupInfo("stiffness", "solver", "elastic constants and yield strain of deforming bodies"),),
    parameters=(
        *(replace(p, eases=("deflection", "strain")) if p.pointer.endswith("young_modulus") else p for p in ELASTIC_MODULI),
        *parameters(PHYSICS, "yield_strain", "stiffness", "repair", "where it stays bent", physical=True),
        *parameters(PHYSICS, "max_strain recovery", "limits", "harder_down", "allowed deformation"),
        *DAMPING,
        *LINEAR_VELOCITY,
        *PINS,
        *parameters(PHYSICS, "pins/*/size", "joints", "repair", "the state at frame 0 and what holds it"),
        *RESOLUTION,
    ),
    channels=CHANNELS,
    dimensions=DIMENSIONS,
    writers=writers,
    audit=Audit(
        "elastic",
        "elastic bodies are held by pins alone, and steps and skins of their instance fit their cells",
        elastic_problems,
    ),
    warnings=unmet_warnings,
    seconds=elastic_seconds,
    rest_way=two_skins,
    starts_alone=True,
)

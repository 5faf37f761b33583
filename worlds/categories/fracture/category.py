"""Breakable bodies: rigid bodies whose contract says how they break."""

from __future__ import annotations

from ...parameters import BREAKABLE, GroupInfo, Parameter, Way, parameters
from ..caps import PIECES
from ..category import Audit, CategorySpec
from .audit import eased, fracture_problems
from .channels import CHANNELS, DIMENSIONS, writers
from .events import EVENTS
from .falls import fall_warnings
from .predicates import PREDICATES

__all__ = ["FRACTURE"]

FRACTURE = CategorySpec(
    name="fracture",
    shape="solid",
    contract="breakable",
    predicates=(*PREDICATES, *EVENTS),
    groups=(
        GroupInfo("bonds", "solver", "strength, stiffness and toughness of what holds the pieces of breakable bodies together"),
    ),
    parameters=(
        Parameter(BREAKABLE, "shape", Way("either", "what breaks, or no longer does")),
        *parameters(BREAKABLE, "pattern fixed", "shape", "repair", "how it is cut and held"),
        *parameters(
            f"{BREAKABLE}/pattern",
            "kind pieces seed around clustering size joint along offset grain slenderness along_grain point radial rings irregularity",
            "shape",
            "repair",
            "how it is cut and held",
        ),
        *parameters(BREAKABLE, "bond", "bonds", "either", "what breaks, or no longer does"),
        *parameters(
            BREAKABLE,
            "bond/tension bond/shear bond/toughness bond/friction",
            "bonds",
            "repair",
            "weaker bonds break more easily, stronger ones hold",
            physical=True,
            eases=("broken", "breach", "debris"),
        ),
        *parameters(BREAKABLE, "bond/crumble", "bonds", "harder_down", "how deep pieces may lie in one another"),
        *parameters(
            BREAKABLE,
            "bond/young_modulus bond/poisson_ratio bond/contact_time",
            "bonds",
            "repair",
            "how a load is shared among bonds",
        ),
    ),
    channels=CHANNELS,
    dimensions=DIMENSIONS,
    writers=writers,
    caps=(PIECES,),
    warnings=fall_warnings,
    eased=eased,
    audit=Audit(
        "fracture",
        "breakable entities are free rigid bodies, cut no finer than skins and caps allow, and bear their own weight",
        fracture_problems,
    ),
)

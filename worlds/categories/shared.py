"""Fields that several categories have in common, with the group and the direction that they have in all of them."""

from __future__ import annotations

from ..parameters import DRIVER, PHYSICS, POSE, SETTINGS, parameters

__all__ = [
    "DAMPING",
    "DOMAIN",
    "ELASTIC_MODULI",
    "LINEAR_VELOCITY",
    "OPENING",
    "PINS",
    "RESOLUTION",
    "SIDES",
    "STEPS",
    "TEMPERATURE",
]

_START = "the state at frame 0 and what holds it"
_LAWS = "rows hold the motion against laws"
LINEAR_VELOCITY = parameters(PHYSICS, "linear_velocity", "initial_state", "repair", _START)
TEMPERATURE = parameters(PHYSICS, "temperature", "initial_state", "repair", _START)
PINS = parameters(PHYSICS, "pins pins/* pins/*/center pins/*/to", "joints", "repair", _START)
DAMPING = parameters(PHYSICS, "damping", "mass", "repair", "its loss stands in the energy rows")
RESOLUTION = parameters(PHYSICS, "resolution", "resolution", "repair", "rows hold it against what it must resolve")
ELASTIC_MODULI = (
    *parameters(PHYSICS, "young_modulus", "stiffness", "repair", "softer bodies give way more, stiffer ones hold", physical=True),
    *parameters(PHYSICS, "poisson_ratio", "stiffness", "repair", "how it yields across", physical=True),
)
DOMAIN = parameters(
    f"{SETTINGS}/domain", ". center size", "domain", "repair", "where loose matter is followed; what leaves is counted"
)
SIDES = parameters(SETTINGS, "domain/sides", "domain", "repair", "whether it leaves there; what leaves is counted")
STEPS = (
    *parameters(SETTINGS, "max_step iterations exchange", "step", "repair", _LAWS),
    *parameters(SETTINGS, "device", "step", "repair", "where it runs"),
)
OPENING = (
    *parameters(f"{DRIVER}/pose", POSE, "drivers", "repair", "drivers stand in the register"),
    *parameters(DRIVER, "size rate speed", "drivers", "repair", "drivers stand in the register"),
)

"""Umbrellas and what they stand in."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import circle
from .turning import hollow, ring, solid, stacked

__all__ = ["GENERATORS"]


class UmbrellaStandParameters(Parameters):
    """An upright vessel for umbrellas and sticks, with a rolled rim and a foot."""

    height: float = Field(default=0.55, ge=0.35, le=0.8, description="[m]")
    diameter: float = Field(default=0.24, ge=0.16, le=0.36, description="at the rim [m]")
    taper: float = Field(default=0.85, ge=0.6, le=1.0, description="diameter of the foot over that of the rim")
    wall: float = Field(default=0.004, ge=0.003, le=0.015, description="thickness [m]")
    material: str = material("mild_steel", "brass", "copper", "terracotta", "porcelain", "oak")


def _umbrella_stand(p: UmbrellaStandParameters, rng: np.random.Generator) -> Made:
    body, r, foot = Body("umbrella stand", p.material), p.diameter / 2, p.taper * p.diameter / 2
    base, rim = 0.03, 0.02
    share, high = float(rng.uniform(0.6, 0.75)), p.height - rim
    outer = [(foot, base), (foot + share * (r - foot), base + share * (high - base)), (r, high)]
    body.turned("foot", solid([(foot + p.wall, 0.0), (foot + p.wall, base)]), segments=24)
    body.turned("wall", hollow(outer, p.wall, 2 * p.wall), segments=24)
    body.turned("rim", ring(r - p.wall, high, p.height, 2 * p.wall), segments=24)
    made = Made.of(body)
    clear = 1.3 * (foot - p.wall)
    made.places["inside"] = Place((0, 0, base + 2 * p.wall), (clear, clear))
    return made


class UmbrellaParameters(Parameters):
    """A rolled umbrella, upright on its tip with the handle above; it does not stand by itself."""

    length: float = Field(default=0.9, ge=0.5, le=1.1, description="over all [m]")
    roll: float = Field(default=0.06, ge=0.04, le=0.09, description="diameter of the rolled cloth [m]")
    crook: bool = Field(default=True, description="a bent handle; false: a straight one")
    metal: str = material("mild_steel", "aluminium_alloy", "brass", of="shaft and tip")
    handle: str = material("bamboo", "walnut", "abs", of="the handle")
    material: str = material("nylon_fabric", "polyester", "cotton")


def _umbrella(p: UmbrellaParameters, rng: np.random.Generator) -> Made:
    body, long, r = Body("umbrella", p.material), p.length, p.roll / 2
    tip, top = 0.07 * long, float(rng.uniform(0.66, 0.7)) * long
    waist = float(rng.uniform(0.8, 0.9))
    body.turned("tip", solid([(0.0035, 0.0), (0.005, tip)]), segments=12, material=p.metal)
    stacked(
        body,
        "roll",
        [(0.3 * r, tip), (0.7 * r, 0.45 * top), (waist * r, 0.75 * top), (r, 0.97 * top), (0.45 * r, top)],
        segments=16,
    )
    grip, bend = 0.78 * long, 0.045
    body.cylinder("shaft", (0, 0, top), (0, 0, grip), 0.006, material=p.metal)
    if p.crook:
        straight = long - bend - 0.011
        arch = [(bend * (1 - math.cos(a)), 0.0, straight + bend * math.sin(a)) for a in np.linspace(0, 1.1 * math.pi, 9)]
        body.sweep("handle", [(0, 0, grip), *arch], circle(0.011, 8), material=p.handle)
    else:
        body.turned("handle", solid([(0.012, grip), (0.016, 0.5 * (grip + long)), (0.013, long)]), segments=16, material=p.handle)
    return Made.of(body)


GENERATORS = (
    Generator(
        "umbrella_stand", "umbrella stand, an upright vessel", UmbrellaStandParameters, _umbrella_stand, ("umbrella", "stick", "hall", "entrance"),
    ),
    Generator(
        "umbrella", "rolled umbrella, upright on its tip", UmbrellaParameters, _umbrella, ("parasol", "rain", "hall"), stands=False,
    ),
)  # fmt: skip

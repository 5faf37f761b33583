"""Cannons."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .wheels import Axle, facets, spoked

__all__ = ["GENERATORS"]

SIDES = 24
"""Flat sides of a barrel."""
GAP = 0.001
"""[m] Between bodies: two skins of half a millimetre."""


class CannonParameters(Parameters):
    """A smooth-bore cannon that looks to the front (-y): barrel with a bore and trunnions, on a carriage with wheels that turn."""

    length: float = Field(default=2.2, ge=0.8, le=4.0, description="of the barrel [m]")
    bore: float = Field(default=0.14, ge=0.05, le=0.65, description="diameter of the bore [m]; the ball is some per cent smaller")
    wheel: float = Field(default=0.45, ge=0.2, le=0.8, description="radius of a wheel, less where two would touch [m]")
    spokes: int = Field(default=10, ge=6, le=12, description="of a wheel")
    drag: float = Field(
        default=0.06, ge=0.0, le=0.4, description="friction of the wheels on their axles, over the weight that they bear"
    )
    metal: str = material("cast_iron", "bronze", of="barrel")
    tyre: str = material("mild_steel", "cast_iron", of="tyres")
    material: str = material("oak", "ash", "beech")


def _outline(p: CannonParameters, back: float, front: float) -> tuple[list[tuple[float, float]], float]:
    """Outline of the barrel as (radius, offset along y), and its radius about the trunnions; the mouth is at -`front`."""
    half, wall = p.bore / 2, 0.5 * p.bore + 0.035
    breech, band, neck = half + wall, half + 0.85 * wall, half + 0.5 * wall
    mouth, zone = half + 0.68 * wall, 0.16 * p.length
    outline = [
        (0.0, back), (0.55 * breech, back), (breech, back - 0.03 * p.length), (breech, zone), (band, zone - 0.02 * p.length),
        (band, -zone), (neck, 0.1 * p.length - front), (mouth, 0.05 * p.length - front), (mouth, -front), (half, -front),
        (half, back - 1.2 * p.bore - 0.05), (0.0, back - 1.2 * p.bore - 0.05),
    ]  # fmt: skip
    return outline, band


def _cannon(p: CannonParameters, rng: np.random.Generator) -> Made:
    back, front = 0.44 * p.length, 0.56 * p.length
    outline, band = _outline(p, back, front)
    breech = max(r for r, _ in outline)
    pin, flat = 0.8 * band * math.tan(math.pi / SIDES), band * math.cos(math.pi / SIDES)
    pin = min(pin, 0.07 * p.length)
    cheek, inner = 0.05 + 0.25 * p.bore, breech + 0.012
    outer, long = inner + cheek, 0.34 * p.length
    reach = min(p.wheel, 0.45 * (0.8 * long + 0.62 * back))
    low = reach * math.cos(math.pi / facets(p.spokes))
    beam = 0.1 * reach + 0.02
    axle_top = low + beam
    bed = 0.03 + 0.1 * p.bore
    height = axle_top + bed + breech + 0.03 + pin
    body = Body("cannon carriage", p.material)
    made = Made.of(body)
    ends = {"front": -0.8 * long, "back": 0.62 * back}
    body.box("bed", (-outer, -long, axle_top), (outer, back, axle_top + bed))
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * inner, s * outer))
        body.box(f"cheek_{side}", (a, -long, axle_top + bed), (b, 0.6 * long, height - pin - GAP))
    barrel = made.bodies["barrel"] = Body("barrel", p.metal)
    axis = Axle((0, 0, height), "y")
    axis.ring(barrel, "tube", outline, segments=SIDES, spin=math.pi / SIDES)
    for s, side in ((-1, "left"), (1, "right")):
        barrel.cylinder(f"trunnion_{side}", (s * flat, 0, height), (s * (outer - 0.005), 0, height), pin)
    knob = 0.3 * p.bore + 0.02
    axis.ring(
        barrel,
        "knob",
        [(0, back), (0.5 * knob, back), (knob, back + knob), (0.5 * knob, back + 2 * knob), (0, back + 2 * knob)],
        segments=12,
    )
    # The trunnion lies on the cheek, a gap above it, where an iron strap would hold it down.
    made.joints["barrel"] = Joint("barrel", "weld", (0.5 * (inner + outer), 0, height - pin))
    made.places["bed"] = Place((0, 0.8 * back, axle_top + bed), (outer, 0.3 * back), clearance=0.03)
    weight = 9.81 * (7100 * math.pi * (0.8 * breech**2 - p.bore**2 / 4) * p.length + 700 * 2 * outer * p.length * 2 * bed) / 4
    for name, y in ends.items():
        body.box(f"axle_{name}", (-outer, y - beam, low - beam), (outer, y + beam, axle_top))
        for s, side in ((-1, "left"), (1, "right")):
            key = f"wheel_{name}_{side}"
            wheel = made.bodies[key] = Body("wheel", p.material)
            width = 0.16 * reach + 0.02
            center = (s * (outer + GAP + 0.75 * width), y, low)
            spoked(wheel, Axle(center, "x"), reach, width, p.spokes, wood=p.material, tyre=p.tyre)
            drag = p.drag * weight * reach
            made.joints[key] = Joint(key, "hinge", (s * outer, y, low), axis=(1, 0, 0), damping=0.01, friction=round(drag, 6))
    return made


GENERATORS = (
    Generator("cannon", "cannon with a bore and trunnions on a carriage whose wheels turn", CannonParameters, _cannon,
              ("gun", "bombard", "artillery", "carriage", "siege", "castle", "medieval", "cannonball", "mortar", "fire")),
)  # fmt: skip

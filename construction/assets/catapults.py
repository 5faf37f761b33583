"""Catapults."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .wheels import Axle

__all__ = ["GENERATORS"]


class CatapultParameters(Parameters):
    """A catapult that throws towards the front (-y): frame on wheels, arm on a hinge with a cup, a padded stop."""

    length: float = Field(default=1.6, ge=0.6, le=3.5, description="of the frame along y [m]")
    width: float = Field(default=0.5, ge=0.4, le=0.7, description="of the frame over its length")
    arm: float = Field(default=0.85, ge=0.6, le=1.0, description="length of the arm over that of the frame")
    stop_deg: float = Field(default=78.0, ge=72.0, le=85.0, description="turn of the arm until its stop [degrees]")
    metal: str = material("mild_steel", "cast_iron", of="fittings")
    material: str = material("oak", "ash", "larch")


def _catapult(p: CatapultParameters, rng: np.random.Generator) -> Made:
    body = Body("catapult", p.material)
    made = Made.of(body)
    half, beam = p.length / 2, 0.055 * p.length
    x = p.width * p.length / 2
    wheel = 0.14 * p.length
    low = wheel * math.cos(math.pi / 16)
    top = low + 1.4 * beam
    base = low - 0.2 * beam
    inner = x - beam
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * x, s * inner))
        body.box(f"side_{side}", (a, -half, base), (b, half, top))
    for k, y in enumerate((-half, half - beam, 0.14 * p.length), start=1):
        body.box(f"cross_{k}", (-inner, y, base), (inner, y + beam, top - 0.2 * beam if k < 3 else base + 0.6 * beam))
    hinge_y, hinge_z, drum = -0.12 * p.length, top + 0.9 * beam, 0.75 * beam
    arm = made.bodies["arm"] = Body("catapult arm", p.material)
    gap = 0.003
    Axle((0, hinge_y, hinge_z), "x").ring(
        arm,
        "bundle",
        [(0, -inner + gap), (drum, -inner + gap), (drum, inner - gap), (0, inner - gap)],
        segments=16,
        spin=math.pi / 16,
        material="linen",
    )
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * x, s * inner))
        body.box(f"bearing_{side}", (a, hinge_y - 1.2 * beam, top), (b, hinge_y + 1.2 * beam, top + 2.0 * beam))
        c, d = sorted((s * x, s * (x + 0.01)))
        body.cylinder(
            f"washer_{side}",
            (c if s < 0 else d, hinge_y, hinge_z),
            (d if s < 0 else c, hinge_y, hinge_z),
            0.8 * beam,
            material=p.metal,
        )
    flat = drum * math.cos(math.pi / 16)
    end = hinge_y + min(p.arm * p.length, half - hinge_y + 0.1 * p.length)
    w, h = 0.42 * beam, 0.42 * beam
    arm.hull(
        "beam",
        [(u, y, hinge_z + z) for y, g in ((hinge_y + flat, 1.0), (end, 0.75)) for u in (-w * g, w * g) for z in (-h * g, h * g)],
    )
    cup = 0.075 * p.length
    y = end - cup
    _uprights(body, p, (x, inner, beam), (hinge_y, hinge_z), top, 0.8 * (y - cup - hinge_y))
    bottom = hinge_z + h * (1 - 0.25 * (y - 0.6 * cup - hinge_y - flat) / (end - hinge_y - flat))
    shape = [(0, 0), (0.6 * cup, 0), (cup, 0.65 * cup), (0.86 * cup, 0.65 * cup), (0.5 * cup, 0.14 * cup), (0, 0.14 * cup)]
    arm.turned("cup", shape, (0, y, bottom), segments=20)
    made.places["cup"] = Place((0, y, bottom + 0.14 * cup), (0.6 * cup, 0.6 * cup), body="arm")
    made.joints["arm"] = Joint(
        "arm", "hinge", (0, hinge_y, hinge_z), axis=(1, 0, 0), range=(0.0, math.radians(p.stop_deg)), damping=0.2, friction=0.5
    )
    for end_name, wy in (("front", -0.36 * p.length), ("back", 0.36 * p.length)):
        for s, side in ((-1, "left"), (1, "right")):
            name = f"wheel_{end_name}_{side}"
            _disc(made, name, (s * (x + 0.012 + 0.5 * beam), wy, low), wheel, 0.8 * beam, p)
            _axle(body, f"axle_{end_name}_{side}", (s * x, wy, low), s * (0.011 + 0.1 * beam), 0.25 * beam, p)
    return made


def _uprights(
    body: Body, p: CatapultParameters, sizes: tuple[float, float, float], hinge: tuple[float, float], top: float, tall: float
) -> None:
    """Posts with braces before the bearings, and a beam with a buffer at which the arm stops short."""
    x, inner, beam = sizes
    y, stop = hinge[0] - 1.2 * beam, math.radians(p.stop_deg)
    high, low = top + tall - 0.2 * beam, top + tall - 1.2 * beam
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * x, s * inner))
        body.box(f"post_{side}", (a, y - beam, top), (b, y, top + tall))
        foot = max(y - beam - 0.45 * tall, -p.length / 2 + 0.02)
        head = top + 1.9 * (y - beam - foot)
        line = [(foot, top), (foot + beam, top), (y - beam, head), (y - beam, head - 1.2 * beam)]
        body.hull(f"brace_{side}", [(u, v, z) for u in (a + 0.15 * beam, b - 0.15 * beam) for v, z in line])
    body.box("stop", (-inner, y - beam, low), (inner, y, high))
    reach = hinge[0] + (low - hinge[1]) / math.tan(stop) - 0.5 * beam / math.sin(stop)
    body.hull("buffer", [(u, v, z) for u in (-0.3 * inner, 0.3 * inner) for v in (y, y + 0.6 * (reach - y)) for z in (low, high)])
    pad = [
        (y + 0.6 * (reach - y), low),
        (reach - 0.1 * beam, low),
        (reach - 0.1 * beam, low + 0.3 * beam),
        (y + 0.6 * (reach - y), high),
    ]
    body.hull("pad", [(u, v, z) for u in (-0.3 * inner, 0.3 * inner) for v, z in pad], material="leather")


def _axle(body: Body, name: str, foot: tuple[float, float, float], reach: float, radius: float, p: CatapultParameters) -> None:
    """A stub that ends a millimetre before the wheel that turns on it."""
    x, y, z = foot
    body.cylinder(name, foot, (x + reach, y, z), radius, material=p.metal)


def _disc(made: Made, name: str, center: tuple[float, float, float], radius: float, width: float, p: CatapultParameters) -> None:
    """A wheel of boards with a hub, a flat side down."""
    wheel = made.bodies[name] = Body("wheel", p.material)
    axle = Axle(center, "x")
    spin, w = -math.pi / 2 + math.pi / 16, width / 2
    band = 0.04 * radius
    outer = radius - band
    axle.ring(wheel, "disc", [(0, -w), (outer, -w), (outer, w), (0, w)], segments=16, spin=spin)
    axle.ring(wheel, "tyre", [(outer, -w), (radius, -w), (radius, w), (outer, w)], segments=16, spin=spin, material=p.metal)
    away = math.copysign(1.0, center[0])
    cap = sorted((away * w, away * (w + 0.12 * radius)))
    axle.ring(
        wheel, "cap", [(0, cap[0]), (0.25 * radius, cap[0]), (0.25 * radius, cap[1]), (0, cap[1])], segments=12, material=p.metal
    )
    made.joints[name] = Joint(name, "hinge", center, axis=(1, 0, 0), damping=0.005, friction=0.01)


GENERATORS = (
    Generator("catapult", "catapult on wheels with an arm on a hinge, and a cup", CatapultParameters, _catapult,
              ("mangonel", "siege", "castle", "trebuchet", "medieval", "machine", "throw")),
)  # fmt: skip

"""Coils of rope and hanging chains."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made
from .profiles import circle

__all__ = ["GENERATORS"]

STEPS = 12
"""Chords of a turn."""


class RopeCoilParameters(Parameters):
    """A rope coiled flat in layers, its end lying out to the right; it keeps its form."""

    diameter: float = Field(default=0.4, ge=0.2, le=0.8, description="of the coil [m]")
    rope: float = Field(default=0.022, ge=0.01, le=0.04, description="diameter of the rope [m]")
    turns: int = Field(default=3, ge=2, le=4, description="turns of a layer")
    layers: int = Field(default=2, ge=1, le=3, description="layers")
    material: str = material("linen", "cotton", "nylon_fabric", "polyester")


def _rope_coil(p: RopeCoilParameters, rng: np.random.Generator) -> Made:
    body = Body("rope coil", p.material)
    # Layers begin anywhere in a turn and spiral in by up to one turn more; the innermost must still go round a hole.
    r = min(p.rope, p.diameter / (2.2 * (p.turns + 2.0))) / 2
    pitch, profile = 2.16 * r, circle(r, 8)
    half = max(v for _, v in profile)
    for layer in range(p.layers):
        z = (2 * layer + 1) * half
        turn = 0.0 if layer == 0 else 2 * math.pi / STEPS * int(rng.integers(STEPS))
        wide = p.diameter / 2 - r - pitch * turn / (2 * math.pi)
        count = p.turns * STEPS
        path = []
        for k in range(count + 1):
            a, reach = turn + 2 * math.pi * k / STEPS, wide - pitch * k / STEPS
            path.append((reach * math.cos(a), reach * math.sin(a), z))
        if layer == 0:
            long = float(rng.uniform(0.5, 0.9)) * p.diameter
            path = [
                (wide + 0.06 * long, -long, z),
                (wide + 0.12 * long, -0.6 * long, z),
                (wide + 0.02 * long, -0.25 * long, z),
                *path,
            ]
        body.sweep(f"layer_{layer + 1}", path, profile)
    return Made.of(body)


class ChainParameters(Parameters):
    """Links that hang in each other, each a body; the uppermost may be fixed."""

    links: int = Field(default=8, ge=2, le=16, description="links")
    length: float = Field(default=0.06, ge=0.02, le=0.2, description="of a link, outside [m]")
    width: float = Field(default=0.62, ge=0.55, le=0.75, description="of a link over its length")
    wire: float = Field(default=0.15, ge=0.1, le=0.17, description="thickness of the wire over the length of a link")
    fixed: bool = Field(default=True, description="the uppermost link does not move")
    material: str = material("mild_steel", "cast_iron", "brass", "gold")


def _chain(p: ChainParameters, rng: np.random.Generator) -> Made:
    # The wire of the next link has 1.1 mm of room on either side in the hole of a link.
    r = min(p.wire * p.length / 2, (p.width * p.length / 2 - 1.1e-3) / 3)
    profile = circle(r, 8)
    reach = max(math.hypot(u, v) for u, v in profile)
    high, wide = p.length / 2 - r, p.width * p.length / 2 - r
    straight = high - wide
    # A bow has a flat chord at its end; thick wire on a short one comes nearer to the chords beside it, which slope by 36 degrees.
    corner = wide * math.sin(math.pi / 10) - reach * math.tan(math.pi / 10)
    gap = max(1.2e-3, (reach + 1.2e-3 - corner * math.sin(math.pi / 5)) / math.cos(math.pi / 5) - reach)
    pitch = 2 * (straight + wide * math.cos(math.pi / 10)) - 2 * reach - gap
    bows = [(wide * math.cos(a), straight + wide * math.sin(a)) for a in np.linspace(0, math.pi, 6)]
    loop = [*bows, *((-u, -v) for u, v in bows)]
    made, turn = Made({}), float(rng.uniform(0, math.pi))
    for number in range(p.links):
        body = Body("chain link", p.material, motion="static" if number == 0 and p.fixed else None)
        z = (p.links - 1 - number) * pitch + straight + wide * math.cos(math.pi / 10) + reach
        a = turn + number * math.pi / 2
        body.sweep("link", [(u * math.cos(a), u * math.sin(a), z + v) for u, v in loop], profile, closed=True)
        made.bodies["" if number == 0 else f"link_{number + 1}"] = body
    return made


GENERATORS = (
    Generator("rope_coil", "coil of rope with a loose end, stiff", RopeCoilParameters, _rope_coil, ("rope", "cord", "ship", "barn", "cable", "hose")),
    Generator(
        "chain", "hanging chain of loose links", ChainParameters, _chain, ("links", "hang", "metal", "anchor", "necklace"), stands=False,
    ),
)  # fmt: skip

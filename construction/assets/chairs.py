"""Chairs and stools."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place

__all__ = ["GENERATORS"]


class ChairParameters(Parameters):
    """A wooden chair: splayed legs, a seat, a leaning back with slats."""

    width: float = Field(default=0.44, ge=0.36, le=0.6, description="of the seat along x [m]")
    depth: float = Field(default=0.42, ge=0.34, le=0.55, description="of the seat along y [m]")
    seat: float = Field(default=0.45, ge=0.35, le=0.55, description="height of the seat [m]")
    height: float = Field(default=0.88, ge=0.7, le=1.15, description="to the top of the back [m]")
    lean_deg: float = Field(default=8.0, ge=0.0, le=15.0, description="of the back from upright [degrees]")
    leg: float = Field(default=0.036, ge=0.025, le=0.06, description="side of a leg [m]")
    slats: int = Field(default=4, ge=2, le=7, description="upright slats of the back")
    stretchers: bool = Field(default=True, description="rails between the legs near the ground")
    material: str = material("beech", "oak", "birch", "walnut", "pine", "ash")


def _chair(p: ChairParameters, rng: np.random.Generator) -> Made:
    body = Body("chair", p.material)
    thick, leg = 0.02, p.leg
    under = p.seat - thick
    body.box("seat", (-p.width / 2, -p.depth / 2, under), (p.width / 2, p.depth / 2, p.seat))
    x, front, back = p.width / 2 - leg / 2, -p.depth / 2 + leg / 2, p.depth / 2 - leg / 2
    splay = float(rng.uniform(0.0, 0.02))
    for number, (sx, y, sy) in enumerate(((-1, front, -1), (1, front, -1), (1, back, 1), (-1, back, 1)), start=1):
        body.taper(
            f"leg_{number}", (sx * (x + splay), y + sy * splay, 0), (sx * x, y, under), (0.75 * leg, 0.75 * leg), (leg, leg)
        )
    if p.stretchers:
        low, high = 0.3 * under, 0.3 * under + 0.03
        for side, name in ((-1, "left"), (1, "right")):
            _between(body, f"stretcher_{name}", p, side, low, high, splay)
    lean = math.tan(math.radians(p.lean_deg))
    top, run = p.height - p.seat, (p.height - p.seat) * lean
    for sx, name in ((-1, "left"), (1, "right")):
        body.taper(f"post_{name}", (sx * x, back, p.seat), (sx * x, back + run, p.height), (leg, leg), (leg, leg))
    inner, crest = x - leg / 2, 0.07
    _leaning(body, "crest", (-inner, inner), back, lean, (p.seat + top - crest, p.height), 0.02, p)
    rail = p.seat + 0.25 * top
    _leaning(body, "rail", (-inner, inner), back, lean, (rail - 0.02, rail + 0.02), 0.02, p)
    wide = 0.45 * 2 * inner / p.slats
    for number in range(p.slats):
        middle = -inner + 2 * inner * (number + 0.5) / p.slats
        _leaning(
            body,
            f"slat_{number + 1}",
            (middle - wide / 2, middle + wide / 2),
            back,
            lean,
            (rail + 0.02, p.height - crest),
            0.012,
            p,
        )
    made = Made.of(body)
    made.places["seat"] = Place((0, -leg / 2, p.seat), (p.width - 2 * leg, p.depth - 2 * leg), p.height - p.seat)
    return made


def _leaning(
    body: Body,
    name: str,
    across: tuple[float, float],
    back: float,
    lean: float,
    levels: tuple[float, float],
    thick: float,
    p: ChairParameters,
) -> None:
    """A board of the back, parallel to its posts."""
    body.hull(
        name,
        [(x, back + (z - p.seat) * lean + s * thick / 2, z) for x in across for z in levels for s in (-1, 1)],
    )


def _between(body: Body, name: str, p: ChairParameters, side: int, low: float, high: float, splay: float) -> None:
    """A stretcher between the inner faces of the front and the back leg of a side."""
    under = p.seat - 0.02
    x = side * (p.width / 2 - p.leg / 2)

    def face(z: float) -> float:
        share = z / under
        half = (0.75 + 0.25 * share) * p.leg / 2
        return p.depth / 2 - p.leg / 2 + splay * (1 - share) - half

    middle = x + side * splay * (1 - 0.5 * (low + high) / under)
    body.hull(name, [(middle + s * 0.008, e * face(z), z) for s in (-1, 1) for e in (-1, 1) for z in (low, high)])


class StoolParameters(Parameters):
    """A stool with a round seat on splayed legs."""

    diameter: float = Field(default=0.34, ge=0.26, le=0.45, description="of the seat [m]")
    seat: float = Field(default=0.46, ge=0.3, le=0.8, description="height of the seat [m]")
    legs: int = Field(default=4, ge=3, le=4, description="legs")
    leg: float = Field(default=0.034, ge=0.025, le=0.05, description="diameter of a leg [m]")
    splay: float = Field(default=0.05, ge=0.0, le=0.1, description="of a foot outwards from its head [m]")
    material: str = material("beech", "oak", "birch", "pine")


def _stool(p: StoolParameters, rng: np.random.Generator) -> Made:
    body = Body("stool", p.material)
    under, radius = p.seat - 0.035, p.diameter / 2
    body.turned(
        "seat",
        [
            (0, under),
            (radius - 0.01, under),
            (radius, under + 0.01),
            (radius, p.seat - 0.008),
            (radius - 0.008, p.seat),
            (0, p.seat),
        ],
        segments=40,
    )
    head, turn = radius - p.leg, float(rng.uniform(0, 2 * math.pi))
    for number in range(p.legs):
        angle = turn + 2 * math.pi * number / p.legs
        c, s = math.cos(angle), math.sin(angle)
        foot = head + p.splay
        body.taper(
            f"leg_{number + 1}", (foot * c, foot * s, 0), (head * c, head * s, under), (0.8 * p.leg, 0.8 * p.leg), (p.leg, p.leg)
        )
    made = Made.of(body)
    made.places["seat"] = Place((0, 0, p.seat), (1.2 * radius, 1.2 * radius))
    return made


GENERATORS = (
    Generator("chair", "wooden chair with a slatted back", ChairParameters, _chair, ("seat", "dining", "kitchen", "furniture")),
    Generator("stool", "stool with a round seat", StoolParameters, _stool, ("seat", "bar", "workshop", "furniture")),
)

"""Benches and pews."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import pick
from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import arc, rounded

__all__ = ["GENERATORS"]


class BenchParameters(Parameters):
    """A bench: slats on ends of timber or of cast iron, with or without a back."""

    width: float = Field(default=1.5, ge=0.8, le=2.4, description="along x [m]")
    depth: float = Field(default=0.42, ge=0.34, le=0.55, description="of the seat along y [m]; one sits looking to -y")
    seat: float = Field(default=0.45, ge=0.38, le=0.5, description="height of the seat [m]")
    height: float = Field(default=0.85, ge=0.72, le=1.0, description="to the top of the back [m]")
    back: bool = Field(default=True, description="slats to lean against")
    ends: Literal["varied", "timber", "iron"] = Field(default="varied", description="on which the slats lie")
    metal: str = material("cast_iron", "mild_steel", of="ends of iron")
    material: str = material("oak", "teak", "larch", "pine", "cedar")


def _bench(p: BenchParameters, rng: np.random.Generator) -> Made:
    ends, body = pick(p.ends, rng, "timber", "iron"), Body("bench", p.material)
    made, board = Made.of(body), 0.03
    y, tilt = p.depth / 2, math.radians(float(rng.uniform(8, 16)))
    pieces = 2 if p.width < 1.7 else 3
    outer = p.width / 2 - (0.06 if ends == "timber" else 0.1)
    for number in range(pieces):
        a = -outer + 2 * outer * number / (pieces - 1)
        _timber_end(body, p, number + 1, a, tilt) if ends == "timber" else _iron_end(body, p, number + 1, a, tilt)
    slats = int(rng.integers(4, 7))
    pitch = (p.depth - 0.01) / slats
    for number in range(slats):
        b = -y + 0.01 + pitch * number
        rim = [(u + b + pitch / 2, v + p.seat - board / 2) for u, v in rounded(pitch - 0.012, board, 0.006, 2)]
        body.prism(f"slat_{number + 1}", rim, -p.width / 2, p.width / 2, axis="x")
    if p.back:
        rails = int(rng.integers(2, 4))
        low, high = p.seat + 0.14, p.height - 0.01
        wide = 0.62 * (high - low) / rails
        for number in range(rails):
            z = low + (high - low - wide) * number / max(1, rails - 1)
            corners = [
                (x, y + 0.02 + (h - p.seat) * math.tan(tilt) - d, h)
                for x in (-p.width / 2, p.width / 2) for h in (z, z + wide) for d in (0.0, 0.022)
            ]  # fmt: skip
            body.hull(f"back_slat_{number + 1}", corners)
    made.places["seat"] = Place((0, -y + 0.01 + pitch * (slats // 2 + 0.5), p.seat), (p.width, 0.5 * p.depth))
    return made


def _timber_end(body: Body, p: BenchParameters, number: int, x: float, tilt: float) -> None:
    """A trestle at an x [m]: two legs, a bearer on them, and a post of the back behind."""
    y, under, half = p.depth / 2, p.seat - 0.03, 0.035
    for name, b, out in (("front", -y + 0.05, -0.02), ("rear", y - 0.05, 0.1 if p.back else 0.02)):
        body.taper(f"leg_{name}_{number}", (x, b + out, 0), (x, b, under - 0.07), (0.05, 0.05), (0.07, 0.06))
    lean = math.tan(tilt) if p.back else 0.0

    def back(z: float) -> float:
        return y + 0.02 + (z - p.seat) * lean

    ends = ((-y + 0.015, under - 0.05), (-y + 0.035, under - 0.07), (-y + 0.015, under), (back(under - 0.07), under - 0.07))
    body.hull(f"bearer_{number}", [(x + s * half, b, z) for s in (-1, 1) for b, z in (*ends, (back(under), under))])
    if p.back:
        corners = [(back(under - 0.07), under - 0.07), (back(under - 0.07) + 0.06, under - 0.07)]
        corners += [(back(p.height), p.height), (back(p.height) + 0.045, p.height)]
        body.hull(f"post_{number}", [(x + s * half, b, z) for s in (-1, 1) for b, z in corners])


def _iron_end(body: Body, p: BenchParameters, number: int, x: float, tilt: float) -> None:
    """An end of bent flat iron at an x [m]: a rear bar from foot to back, a front bar from foot over the seat and the arm beside it."""
    y, under, flat = p.depth / 2, p.seat - 0.03, 0.008
    rear = y + 0.02 + flat / 2 / math.cos(tilt)
    bar = [(-0.02, -flat / 2), (0.02, -flat / 2), (0.02, flat / 2), (-0.02, flat / 2)]
    lean = math.tan(tilt)
    path = [
        (rear + 0.1, 0.004),
        (rear + 0.1, 0.02),
        (rear + 0.05, 0.12),
        (rear - 0.015, 0.6 * under),
        (rear - 0.02, under - 0.02),
    ]
    path += [(rear + (z - p.seat) * lean, z) for z in (p.seat + 0.03, p.height)] if p.back else [(rear - 0.02, under - 0.001)]
    body.sweep(f"rear_bar_{number}", [(x, b, z) for b, z in path], bar, material=p.metal)
    side = x + (0.04 if x <= 0 else -0.04)
    front = -y + 0.014
    curve = [(front - 0.04, 0.004), (front - 0.04, 0.02), (front + 0.01, 0.12), (front - 0.01, under - 0.05)]
    bend = arc((front + 0.03, under - 0.044), 0.04, math.pi, math.pi / 2, 4)
    body.sweep(
        f"front_bar_{number}", [(side, b, z) for b, z in (*curve, *bend[1:], (rear + 0.02, under - 0.004))], bar, material=p.metal
    )
    for name, a, b, z in (("rear", x, rear + 0.1, 0.0), ("front", side, front - 0.04, 0.0)):
        body.box(f"foot_{name}_{number}", (a - 0.02, b - 0.025, z), (a + 0.02, b + 0.025, z + 0.004), material=p.metal)


class PewParameters(Parameters):
    """A pew: a long seat between two carved ends, with a leaning back and a ledge for books behind it."""

    width: float = Field(default=2.4, ge=1.0, le=4.0, description="along x [m]")
    seat: float = Field(default=0.45, ge=0.4, le=0.48, description="height of the seat [m]")
    depth: float = Field(default=0.4, ge=0.35, le=0.46, description="of the seat along y [m]; one sits looking to -y")
    height: float = Field(default=0.9, ge=0.8, le=1.05, description="to the top of the back [m]")
    end: float = Field(default=0.045, ge=0.03, le=0.07, description="thickness of the ends [m]")
    heads: Literal["varied", "scroll", "square", "pointed"] = Field(default="varied", description="shape of the ends")
    ledge: bool = Field(default=True, description="a ledge for books at the back")
    material: str = material("oak", "pine", "walnut", "ash")


def _pew(p: PewParameters, rng: np.random.Generator) -> Made:
    body, heads = Body("pew", p.material), pick(p.heads, rng, "scroll", "square", "pointed")
    made, inner, lean = Made.of(body), p.width / 2 - p.end, math.tan(math.radians(float(rng.uniform(8, 13))))
    front, rear = -p.depth / 2, p.depth / 2
    rise = (p.height - p.seat) * lean
    end = _end(p, heads, front - 0.02, rear + rise + 0.05)
    for name, sign in (("left", -1), ("right", 1)):
        low, high = sorted((sign * inner, sign * p.width / 2))
        body.prism(f"end_{name}", end, low, high, axis="x")
    under = p.seat - 0.03
    rim = [(front, under), (rear - 0.03 * lean, under), (rear, p.seat), (front + 0.01, p.seat), (front, p.seat - 0.012)]
    body.prism("seat", rim, -inner, inner, axis="x")
    body.box("apron", (-inner, front + 0.03, p.seat - 0.12), (inner, front + 0.05, p.seat - 0.03))
    supports = max(0, round(p.width / 1.2) - 1)
    for number in range(supports):
        a = -inner + 2 * inner * (number + 1) / (supports + 1)
        body.prism(
            f"support_{number + 1}", [(front + 0.06, 0.0), (rear - 0.02, 0.0), (rear - 0.02, p.seat - 0.03), (front + 0.05, p.seat - 0.03)],
            a - 0.016, a + 0.016, axis="x",
        )  # fmt: skip

    def plane(z: float, depth: float) -> tuple[float, float]:
        return (rear + (z - p.seat) * lean + depth, z)

    low, high = p.seat - 0.03, p.height - 0.035
    body.hull("back", [(x, *plane(z, d)) for x in (-inner, inner) for z in (low, high) for d in (0.0, 0.022)])
    crest = [
        plane(high, -0.012),
        plane(high, 0.034),
        plane(p.height - 0.01, 0.038),
        plane(p.height, 0.028),
        plane(p.height, -0.004),
    ]
    body.prism("crest", [*crest, plane(p.height - 0.01, -0.016)], -inner, inner, axis="x")
    if p.ledge:
        z = p.seat + 0.6 * (p.height - p.seat)
        b = plane(z, 0.022)[0]
        body.hull(
            "ledge",
            [
                (x, *q)
                for x in (-inner, inner)
                for q in (plane(z, 0.022), plane(z + 0.018, 0.022), (b + 0.16, z), (b + 0.16, z + 0.018))
            ],
        )
        body.box("ledge_lip", (-inner, b + 0.16, z), (inner, b + 0.175, z + 0.04))
        made.places["ledge"] = Place((0, b + 0.085, z + 0.018), (2 * inner - 0.02, 0.13), p.height - z)
    made.places["seat"] = Place((0, 0, p.seat), (2 * inner - 0.02, p.depth - 0.06))
    return made


def _end(p: PewParameters, kind: str, front: float, rear: float) -> list[tuple[float, float]]:
    """Outline (y, z) of a pew's end: broad foot, waist, an arm before the back, and its head [m]."""
    arm, top = p.seat + 0.2, p.height + 0.04
    foot = [(front - 0.02, 0.0), (rear + 0.02, 0.0), (rear + 0.02, 0.08), (rear, 0.1)]
    fore = [(front + 0.05, arm - 0.1), (front + 0.04, 0.5 * p.seat), (front, 0.1), (front - 0.02, 0.08)]
    depth = rear - front
    if kind == "square":
        head = [
            (rear, top),
            (front + 0.62 * depth, top),
            (front + 0.5 * depth, arm + 0.02),
            (front + 0.02, arm),
            (front + 0.02, arm - 0.03),
        ]
    elif kind == "pointed":
        head = [
            (rear, top - 0.06),
            (front + 0.78 * depth, top + 0.1),
            (front + 0.55 * depth, top - 0.06),
            (front + 0.5 * depth, arm),
            (front, arm - 0.01),
            (front, arm - 0.05),
        ]
    else:
        scroll = arc((front + 0.045, arm - 0.05), 0.05, 0.45 * math.pi, 1.35 * math.pi, 7)
        swan = [
            (front + depth * (0.85 - 0.55 * s), top - (top - arm - 0.01) * (3 * s * s - 2 * s**3))
            for s in (0.0, 0.25, 0.5, 0.75, 1.0)
        ]
        head = [(rear, top - 0.02), (rear - 0.02, top), *swan, *scroll]
    return [*foot, *head, *fore]


GENERATORS = (
    Generator(
        "bench", "bench of slats on ends of timber or iron, with or without a back", BenchParameters, _bench,
        ("seat", "garden", "park", "hall", "street", "furniture"),
    ),
    Generator(
        "pew", "church pew with shaped ends and a ledge for books", PewParameters, _pew, ("church", "chapel", "bench", "seat", "furniture"),
    ),
)  # fmt: skip

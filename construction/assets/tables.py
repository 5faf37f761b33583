"""Tables and desks."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import rounded

__all__ = ["GENERATORS"]


class TableParameters(Parameters):
    """A four-legged table with aprons under its top."""

    width: float = Field(default=1.4, ge=0.5, le=3.0, description="along x [m]")
    depth: float = Field(default=0.8, ge=0.4, le=1.2, description="along y [m]")
    height: float = Field(default=0.74, ge=0.35, le=1.1, description="to the upper side of the top [m]")
    top: float = Field(default=0.028, ge=0.015, le=0.06, description="thickness of the top [m]")
    leg: float = Field(default=0.06, ge=0.03, le=0.12, description="side of a leg where it meets the top [m]")
    taper: float = Field(default=0.7, ge=0.4, le=1.0, description="side of a leg's foot over that of its head")
    overhang: float = Field(default=0.03, ge=0.0, le=0.1, description="of the top beyond the legs [m]")
    apron: float = Field(default=0.09, ge=0.04, le=0.15, description="height of the rails under the top [m]")
    corners: Literal["square", "round"] = Field(default="square", description="of the top")
    material: str = material("oak", "beech", "walnut", "pine", "ash", "maple")


def _table(p: TableParameters, rng: np.random.Generator) -> Made:
    body = Body("table", p.material)
    under = p.height - p.top
    if p.corners == "round":
        body.prism("top", rounded(p.width, p.depth, min(0.12, 0.2 * p.depth), 6), under, p.height)
    else:
        body.box("top", (-p.width / 2, -p.depth / 2, under), (p.width / 2, p.depth / 2, p.height))
    x, y = p.width / 2 - p.overhang - p.leg / 2, p.depth / 2 - p.overhang - p.leg / 2
    apron = min(p.apron, 0.4 * under)
    foot = p.taper * p.leg
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        head = (sx * x, sy * y)
        body.box(
            f"head_{number}",
            (head[0] - p.leg / 2, head[1] - p.leg / 2, under - apron),
            (head[0] + p.leg / 2, head[1] + p.leg / 2, under),
        )
        body.taper(f"leg_{number}", (*head, 0.0), (*head, under - apron), (foot, foot), (p.leg, p.leg))
    thick = 0.022
    for number, side in enumerate((-1, 1), start=1):
        inner = x - p.leg / 2
        body.box(f"rail_{number}", (-inner, side * y - thick / 2, under - apron), (inner, side * y + thick / 2, under))
        inner = y - p.leg / 2
        body.box(f"rail_{number + 2}", (side * x - thick / 2, -inner, under - apron), (side * x + thick / 2, inner, under))
    made = Made.of(body)
    made.places["top"] = Place((0, 0, p.height), (p.width, p.depth))
    return made


class RoundTableParameters(Parameters):
    """A round table on a turned column with splayed feet."""

    diameter: float = Field(default=0.9, ge=0.4, le=1.6, description="of the top [m]")
    height: float = Field(default=0.74, ge=0.4, le=1.1, description="to the upper side of the top [m]")
    top: float = Field(default=0.028, ge=0.015, le=0.05, description="thickness of the top [m]")
    column: float = Field(default=0.1, ge=0.06, le=0.16, description="diameter of the column [m]")
    feet: int = Field(default=4, ge=3, le=6, description="feet around the column")
    material: str = material("oak", "beech", "walnut", "mahogany", "cherry_wood")


def _round_table(p: RoundTableParameters, rng: np.random.Generator) -> Made:
    body = Body("round table", p.material)
    under, radius, reach = p.height - p.top, p.column / 2, 0.42 * p.diameter
    body.turned("top", [(0, under), (p.diameter / 2, under), (p.diameter / 2, p.height), (0, p.height)], segments=48)
    low, neck = 0.06, 0.25 * under
    waist = float(rng.uniform(0.65, 0.85)) * radius
    profile = [
        (0, low),
        (radius, low),
        (radius, low + neck),
        (waist, low + neck + 0.03),
        (0.9 * radius, 0.6 * under),
        (waist, 0.85 * under),
    ]
    body.turned("column", [*profile, (1.6 * radius, under), (0, under)], segments=64)
    side = 1.2 * radius * math.sin(math.pi / max(p.feet, 4))
    for number in range(p.feet):
        turn = 2 * math.pi * number / p.feet
        points = [
            (r, s * w / 2, z)
            for r, w, zs in ((radius, side, (low + 0.005, low + 0.075)), (reach, 0.7 * side, (0.0, 0.035)))
            for s in (-1, 1)
            for z in zs
        ]
        body.hull(f"foot_{number + 1}", [_turned(q, turn) for q in points])
    made = Made.of(body)
    made.places["top"] = Place((0, 0, p.height), (0.7 * p.diameter, 0.7 * p.diameter))
    return made


def _turned(point: tuple[float, float, float], angle: float) -> tuple[float, float, float]:
    c, s = math.cos(angle), math.sin(angle)
    return (c * point[0] - s * point[1], s * point[0] + c * point[1], point[2])


GENERATORS = (
    Generator(
        "table", "four-legged table with tapered legs and rails", TableParameters, _table,
        ("desk", "dining", "workbench", "coffee", "side", "furniture", "kitchen", "office"),
    ),
    Generator(
        "round_table", "round table on a turned column", RoundTableParameters, _round_table, ("cafe", "pedestal", "bistro", "furniture"),
    ),
)  # fmt: skip
